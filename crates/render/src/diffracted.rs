//! Exposure spread by the edge of the aperture.

use glam::DVec3;
use spectra_core::frame::ExposureChannel;
use spectra_core::spectral::{Channel, SpectralPower};
use spectra_core::{Isa, RayBatch};
use spectra_diffraction::{Account, Light, Polygon, Pupil, Spread, View, Wave, Waves, brightest_star};
use spectra_scene::Scene;

/// What diffraction did to a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Diffracted {
    /// The channel.
    pub channel: String,
    /// Part of its light that it brings beside the frame.
    pub left: f64,
    /// Part of the light of a pixel in the middle of the frame that stays in it.
    pub stays: f64,
    /// Pixels whose star is drawn out to the edge of the frame.
    pub stars: usize,
}

/// Why it is not known what the stop of a scene does to light; `None` where it is.
pub(crate) fn fault(scene: &Scene) -> Option<String> {
    if scene.render.diffraction == Some(true) { Pupil::new(&scene.lens).err() } else { None }
}

/// What of the median of a frame the brightest star has where it leaves the pixels around its light, in the channel that has most.
/// `None` where that is not known.
pub(crate) fn star(scene: &Scene, planes: &[ExposureChannel], recorded: &[usize], isa: Isa) -> Option<f64> {
    let seen = Seen { scene, pupil: &Pupil::new(&scene.lens).ok()?, waves: None, isa };
    let one = |number: &usize| {
        let (channel, plane) = (scene.channels.get(*number)?, planes.get(*number)?);
        brightest_star(scene.imager.size(), &light(scene.source.spectrum(), channel)?, &seen, &plane.values)
    };
    recorded.iter().filter_map(one).reduce(f64::max)
}

/// Spreads the recorded planes of a frame.
pub(crate) fn spread(
    scene: &Scene,
    planes: &mut [ExposureChannel],
    recorded: &[usize],
    isa: Isa,
) -> Result<Vec<Diffracted>, String> {
    let size = scene.imager.size();
    let pupil = Pupil::new(&scene.lens)?;
    let one = |number: &usize| -> Option<Diffracted> {
        let (channel, plane) = (scene.channels.get(*number)?, planes.get_mut(*number)?);
        let light = light(scene.source.spectrum(), channel)?;
        let waves = Waves::new(&scene.lens, light.mean_mm() * 1e6);
        let seen = Seen { scene, pupil: &pupil, waves, isa };
        let Account { left, stays, stars } = Spread::new(size, light, &seen)?.apply(&mut plane.values);
        Some(Diffracted { channel: channel.name.clone(), left, stays, stars })
    };
    Ok(recorded.iter().filter_map(one).collect())
}

/// What a channel sees of the light of a source, by wavelength.
fn light(source: &SpectralPower, channel: &Channel) -> Option<Light> {
    let grid = source.grid;
    let continuum = grid.wavelengths_nm().zip(&source.continuum).zip(&channel.response);
    let continuum = continuum.map(|((nm, power), response)| [nm, power * response.abs() * grid.step_nm]);
    let lines = source
        .lines
        .iter()
        .map(|line| [line.wavelength_nm, line.power * grid.interpolate(&channel.response, line.wavelength_nm).abs()]);
    Light::of(&continuum.chain(lines).collect::<Vec<_>>())
}

/// The lens as places of the frame see it.
struct Seen<'a> {
    scene: &'a Scene,
    pupil: &'a Pupil,
    waves: Option<Waves<'a>>,
    isa: Isa,
}

impl View for Seen<'_> {
    fn opening(&self, at: [f64; 2]) -> Option<Polygon> {
        let (point, axes) = place(self.scene, at, self.isa)?;
        self.pupil.seen_from(point, axes)
    }

    fn wave(&self, at: [f64; 2], opening: &Polygon) -> Option<Wave> {
        let (point, axes) = place(self.scene, at, self.isa)?;
        self.waves.as_ref()?.seen_from(point, axes, opening)
    }
}

/// A place of the frame, and the axes of the frame there, in the frame of the image plane.
fn place(scene: &Scene, [column, row]: [f64; 2], isa: Isa) -> Option<(DVec3, [DVec3; 2])> {
    let size = scene.imager.size();
    let pixel = |at: f64, count: u32| (at.max(0.0) as u32).min(count - 1);
    let (i, j) = (pixel(column, size.width_px), pixel(row, size.height_px));
    let tag = j * size.width_px + i;
    // The place, and the sides of its pixel.
    let u = [column - f64::from(i), 0.0, 1.0, 0.5, 0.5];
    let v = [row - f64::from(j), 0.5, 0.5, 0.0, 1.0];
    let points: Vec<DVec3> = match scene.imager.launch() {
        Some(launch) => {
            let mut rays = RayBatch::new(u.len());
            rays.restart(u.len());
            rays.columns_mut().tag.fill(tag);
            launch.place(&mut rays, &u, &v, isa);
            let [x, y, z] = rays.positions();
            (0..u.len()).map(|k| DVec3::new(x[k], y[k], z[k])).collect()
        }
        None => u.iter().zip(v).map(|(u, v)| size.point_of(tag, *u, v)).map(|(x, y)| DVec3::new(x, y, 0.0)).collect(),
    };
    // Columns run against x.
    let axes = [(points[1] - points[2]).try_normalize()?, (points[4] - points[3]).try_normalize()?];
    Some((points[0], axes))
}
