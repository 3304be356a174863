//! Spreads the exposure by diffraction at the edge of the aperture.
//!
//! Diffraction comes after the light is summed: exposure is linear, and the sums of rays stay as they are. [`spectra_diffraction`] has the
//! model; this module shows it the lens from each place of the frame and the light of each channel.
//!
//! Unless the scene decides, diffraction is on if the stars of lamps can be seen, as [`crate::star_trial`] finds.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::frame::ExposureChannel;
use spectra_core::params::Fault;
use spectra_core::spectral::{Channel, SpectralPower};
use spectra_diffraction::{ChannelLight, LensView, Polygon, Pupil, Spread, SpreadReport, Wavefront, Wavefronts};
use spectra_scene::Scene;

/// What diffraction did to one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Diffracted {
    /// Name of the channel.
    pub channel: String,
    /// Fraction of the channel's light that diffraction moves outside the frame.
    pub left: f64,
    /// Fraction of the light of a pixel in the middle of the frame that stays in that pixel.
    pub stays: f64,
    /// Number of pixels whose star is drawn out to the edge of the frame.
    pub stars: usize,
}

/// Explains why the diffraction at the stop cannot be computed, if the scene asks for it; `None` if it can.
pub(crate) fn fault(scene: &Scene) -> Option<Fault> {
    if scene.render.diffraction == Some(true) { Pupil::new(&scene.lens).err() } else { None }
}

/// Returns the largest fraction of a pixel's light that its star brings to another pixel, where the star leaves the core, in the channel
/// with this number. `None` if it cannot be computed.
pub(crate) fn star_of_pixel(scene: &Scene, channel: usize) -> Option<f64> {
    let seen = SceneLensView { scene, pupil: &Pupil::new(&scene.lens).ok()?, waves: None };
    spectra_diffraction::star_of_pixel(
        scene.imager.size(),
        &light(scene.source.spectrum(), scene.channels.get(channel)?)?,
        &seen,
    )
}

/// Spreads the recorded planes of a frame by diffraction, in place, and returns what it did to each channel.
pub(crate) fn spread(
    scene: &Scene,
    planes: &mut [ExposureChannel],
    recorded: &[usize],
) -> Result<Vec<Diffracted>, Fault> {
    let size = scene.imager.size();
    let pupil = Pupil::new(&scene.lens)?;
    let one = |number: &usize| -> Option<Diffracted> {
        let (channel, plane) = (scene.channels.get(*number)?, planes.get_mut(*number)?);
        let light = light(scene.source.spectrum(), channel)?;
        let waves = Wavefronts::new(&scene.lens, light.mean_mm() * 1e6);
        let seen = SceneLensView { scene, pupil: &pupil, waves };
        let SpreadReport { left, stays, stars } = Spread::new(size, light, &seen)?.apply(&mut plane.values);
        Some(Diffracted { channel: channel.name.clone(), left, stays, stars })
    };
    Ok(recorded.iter().filter_map(one).collect())
}

/// Returns the light of a source as the channel sees it, by wavelength; `None` if the channel sees none.
fn light(source: &SpectralPower, channel: &Channel) -> Option<ChannelLight> {
    let grid = source.grid;
    let continuum = grid.wavelengths_nm().zip(&source.continuum).zip(&channel.response);
    let continuum = continuum.map(|((nm, power), response)| [nm, power * response.abs() * grid.step_nm]);
    let lines = source
        .lines
        .iter()
        .map(|line| [line.wavelength_nm, line.power * grid.interpolate(&channel.response, line.wavelength_nm).abs()]);
    ChannelLight::of(&continuum.chain(lines).collect::<Vec<_>>())
}

/// The lens as seen from points of the frame.
struct SceneLensView<'a> {
    scene: &'a Scene,
    pupil: &'a Pupil<'a>,
    waves: Option<Wavefronts<'a>>,
}

impl LensView for SceneLensView<'_> {
    fn opening(&self, at: [f64; 2]) -> Option<Polygon> {
        let (point, axes) = place(self.scene, at)?;
        self.pupil.seen_from(point, axes)
    }

    fn wave(&self, at: [f64; 2], opening: &Polygon) -> Option<Wavefront> {
        let (point, axes) = place(self.scene, at)?;
        self.waves.as_ref()?.seen_from(point, axes, opening)
    }
}

/// Returns a point of the frame and the two axes of the frame there, in the coordinates of the image plane.
fn place(scene: &Scene, [column, row]: [f64; 2]) -> Option<(DVec3, [DVec3; 2])> {
    let size = scene.imager.size();
    let pixel = |at: f64, count: u32| (at.max(0.0) as u32).min(count - 1);
    let (i, j) = (pixel(column, size.width_px), pixel(row, size.height_px));
    let tag = j * size.width_px + i;
    // The point itself, and the four sides of its pixel.
    let u = [column - f64::from(i), 0.0, 1.0, 0.5, 0.5];
    let v = [row - f64::from(j), 0.5, 0.5, 0.0, 1.0];
    let points: Vec<DVec3> = match scene.imager.launch() {
        Some(launch) => {
            let mut rays = RayBatch::new(u.len());
            rays.restart(u.len());
            rays.columns_mut().tag.fill(tag);
            launch.place(&mut rays, &u, &v);
            let [x, y, z] = rays.positions();
            (0..u.len()).map(|k| DVec3::new(x[k], y[k], z[k])).collect()
        }
        None => u.iter().zip(v).map(|(u, v)| size.point_of(tag, *u, v)).map(|(x, y)| DVec3::new(x, y, 0.0)).collect(),
    };
    // Columns count opposite to x.
    let axes = [(points[1] - points[2]).try_normalize()?, (points[4] - points[3]).try_normalize()?];
    Some((points[0], axes))
}
