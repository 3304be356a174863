//! Exposure of a film to a picture without lens and rays: the light of each pixel falls on the same pixel of the film.
//!
//! An ideal lens does the same, apart from the size on the film. At f-number N the irradiance is pi / (4 N^2) times the radiance,
//! equal all over the frame. The exposure of a layer by a color is the integral of the color's spectrum times the layer's
//! response. Traced scenes estimate this integral by drawing wavelengths. A picture has too many pixels for an integral each, so
//! the exposures of the channels are tabulated. The table runs over the two smaller values of a color relative to the largest,
//! because twice the color is twice the light. Colors beyond sRGB have a table over their direction from white and their depth
//! toward the spectral locus.

mod wide;

use rayon::prelude::*;
use spectra_core::LossCounts;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::params::Faults;
use spectra_core::spectral::Channel;
use spectra_core::stage::{ColorModel, Still};
use spectra_render::Rendering;
use spectra_scene::Scene;
use std::f64::consts::PI;
use wide::Wide;

/// F-number of the ideal lens.
pub(crate) const F_NUMBER: f64 = spectra_scene::NO_LENS_F_NUMBER;
/// Luminance of white in a picture that is developed, cd/m2.
pub(crate) const WHITE_CD_M2: f64 = 5000.0;

/// Number of points along each side of the table, denser toward 0 (see [`value`]). Each cell of the table in which the `smooth`
/// model looks up its coefficients gets two points.
const SIDE: usize = 129;
/// Largest relative error that a table may have: relative to the exposure of the channel, or to a hundredth of that of the most
/// exposed channel if this is larger. It equals 0.004 in log10 exposure. The bundled models stay within 0.002, on average within
/// 0.0001.
const TOLERANCE: f64 = 1e-2;
/// Number of colors that a table is tested with.
const JUDGES: usize = 256;
/// Number of channels that are interpolated together.
const LANES: usize = 4;
/// Number of pixels in a task of one thread.
const PIXELS_A_TASK: usize = 1 << 14;

/// Source of the light of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightFrom {
    /// Rays through the lens.
    #[default]
    Rays,
    /// The pixels of the scene's flat picture, imaged by an ideal lens; no ray is traced.
    Pixels,
}

/// Exposes the scene's film to the scene's picture, without its lens.
///
/// # Errors
/// The source is not a flat picture, or its file is broken; the film has more pixels than the picture, or another shape.
pub fn expose(scene: &Scene) -> Result<Rendering, Faults> {
    let Some(still) = scene.source.still() else {
        let fault = scene.params.fault("source.kind", "only a flat picture can be exposed without a lens");
        return Err(fault.hint("use `kind: picture` without `depth`, or name a lens").into());
    };
    expose_still(scene, &still?)
}

/// Exposes the scene's film to pixels that were read before, as [`expose`] does.
///
/// # Errors
/// The film has more pixels than the picture, or another shape.
pub fn expose_still(scene: &Scene, still: &Still) -> Result<Rendering, Faults> {
    let size = scene.imager.size();
    let [across, down] = [size.width_mm / f64::from(size.width_px), size.height_mm / f64::from(size.height_px)];
    let aspects =
        [size.width_mm / size.height_mm, f64::from(still.width_px) * still.pixel_aspect / f64::from(still.height_px)];
    // Allows for widths and heights that are rounded to whole pixels.
    let slack = 0.51 / f64::from(size.width_px.min(size.height_px)) + 1e-6;
    let is_smaller = size.width_px <= still.width_px && size.height_px <= still.height_px;
    if !is_smaller || (aspects[0] / aspects[1] - 1.0).abs() > slack {
        let text = format!(
            "{} x {} pixels of {:.4} x {:.4} mm cannot take a picture of {} x {} pixels without a lens",
            size.width_px, size.height_px, across, down, still.width_px, still.height_px
        );
        let fault = scene.params.fault("imager.resolution", text);
        return Err(fault.hint("write the resolution of the picture, or a smaller one of the same shape").into());
    }
    let factor = still.scale * PI / (4.0 * F_NUMBER * F_NUMBER) * scene.exposure_time_s();
    let mut colors = Colors::new(&*still.model, &scene.channels, factor);
    if still.rgb.par_iter().any(|rgb| rgb.iter().any(|v| *v < 0.0)) {
        colors.take_wide();
    }
    let mut planes = colors.planes(still, &size);
    let gray = colors.integrals([spectra_scene::MID_GRAY; 3]).into_iter().map(|v| v as f32).collect::<Vec<_>>();
    // For a picture that is exposed as taken, the meter sees its mid gray.
    let meters = scene.meter_channels();
    for film in scene.films.iter().filter(|film| scene.uses_source_exposure(film)) {
        for at in film.channels.clone().filter(|at| meters.contains(at)) {
            planes[at].fill(gray[at]);
        }
    }
    let channels = scene.channels.iter().zip(planes).map(|(channel, values)| ExposureChannel {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        values,
    });
    Ok(Rendering {
        mid_gray: Some(gray),
        exposure: ExposureFrame { size, channels: channels.collect() },
        layers: Vec::new(),
        rays: 0,
        losses: LossCounts::default(),
        detected: 0,
        partial: false,
        samples: 0,
        noise: None,
        estimators: Vec::new(),
        warnings: Vec::new(),
        ledger: None,
        ghost_noise: None,
        glare: None,
        diffraction: None,
    })
}

/// Lookup of the channels' exposures by a color.
struct Colors<'a> {
    model: &'a dyn ColorModel,
    channels: &'a [Channel],
    factor: f64,
    /// Exposures of the channels for each largest value, row and column, [`LANES`] at a time; empty if a table is not accurate
    /// enough.
    points: Vec<[f32; LANES]>,
    /// Value at each point of a side, and one over the step to the next.
    values: Vec<[f32; 2]>,
    /// Table for colors beyond sRGB, if the picture has any and the table is accurate enough.
    wide: Option<Wide>,
}

/// Returns the relative value at point `i` of a side.
fn value(i: usize) -> f64 {
    let s = i as f64 / (SIDE - 1) as f64;
    s * s
}

impl<'a> Colors<'a> {
    /// Tabulates the exposures of `channels`, which are `factor` times the integrals over the model's spectra.
    fn new(model: &'a dyn ColorModel, channels: &'a [Channel], factor: f64) -> Self {
        let step = |i: usize| if i + 1 < SIDE { value(i + 1) - value(i) } else { 1.0 };
        let values = (0..SIDE).map(|i| [value(i) as f32, (1.0 / step(i)) as f32]).collect();
        let mut colors = Self { model, channels, factor, points: Vec::new(), values, wide: None };
        let row = |at: usize| -> Vec<[f32; LANES]> {
            let (largest, row) = (at / SIDE, at % SIDE);
            let color = |column: usize| {
                let mut color = [1.0; 3];
                color[(largest + 1) % 3] = value(row);
                color[(largest + 2) % 3] = value(column);
                color
            };
            let lanes = |all: &[f64]| std::array::from_fn(|l| all.get(l).map_or(0.0, |v| *v as f32));
            let of = |column: usize| colors.integrals(color(column)).chunks(LANES).map(lanes).collect::<Vec<_>>();
            (0..SIDE).flat_map(of).collect()
        };
        colors.points = (0..3 * SIDE).into_par_iter().flat_map_iter(row).collect();
        if colors.worst() > TOLERANCE {
            colors.points = Vec::new();
        }
        colors
    }

    /// Adds the table for colors beyond sRGB.
    fn take_wide(&mut self) {
        self.wide = Wide::new(self).filter(|wide| wide.worst(self) <= TOLERANCE);
    }

    /// Computes the exposure of each channel by a color by integration.
    fn integrals(&self, color: [f64; 3]) -> Vec<f64> {
        let light = self.model.spectrum(color);
        self.channels.iter().map(|channel| self.factor * light.seen_by(&channel.response)).collect()
    }

    /// Returns the largest error of the table against integrals, over dark, bright, gray and saturated colors.
    fn worst(&self) -> f64 {
        let off = |i: usize| {
            // Additive recurrences with irrational steps fill a cube evenly (the three-dimensional relative of the plastic
            // number).
            let at = |step: f64| (0.5 + i as f64 * step).fract();
            let [a, b, c] = [at(0.819_172_513_396_164_4), at(0.671_043_606_703_789_2), at(0.549_700_477_901_970_1)];
            let color = [[a, b, c], [a * a, b * b, c * c], [8.0 * a * a * a, 8.0 * b * b * b, c * c * c]][i % 3];
            let color = color.map(|v| v as f32);
            let mut found = vec![0.0; self.channels.len()];
            self.at(color, &mut found);
            self.off(color, &found)
        };
        (0..JUDGES).into_par_iter().map(off).reduce(|| 0.0, f64::max)
    }

    /// Returns the largest error of the exposures `found` for a color, relative as in [`TOLERANCE`].
    fn off(&self, color: [f32; 3], found: &[f32]) -> f64 {
        let exact = self.integrals(color.map(f64::from));
        let most = exact.iter().fold(0.0_f64, |a, b| a.max(*b));
        let differs = |(found, exact): (&f32, &f64)| (f64::from(*found) - exact).abs() / exact.max(0.01 * most);
        found.iter().zip(&exact).map(differs).fold(0.0, f64::max)
    }

    /// Looks up the exposure of each channel by a color; integrates where there is no table.
    #[inline]
    fn at(&self, rgb: [f32; 3], to: &mut [f32]) {
        if rgb.iter().any(|v| *v < 0.0) && self.wide.as_ref().is_some_and(|wide| wide.at(rgb, to)) {
            return;
        }
        if self.points.is_empty() || rgb.iter().any(|v| *v < 0.0) {
            let exact = self.integrals(rgb.map(f64::from));
            to.iter_mut().zip(exact).for_each(|(to, v)| *to = v as f32);
            return;
        }
        let largest = match rgb {
            [r, g, b] if r >= g && r >= b => 0,
            [_, g, b] if g >= b => 1,
            _ => 2,
        };
        let most = rgb[largest];
        if most <= 0.0 {
            to.fill(0.0);
            return;
        }
        let cell = |v: f32| {
            let x = v / most;
            let i = ((x.sqrt() * (SIDE - 1) as f32) as usize).min(SIDE - 2);
            let [low, per_step] = self.values[i];
            (i, ((x - low) * per_step).clamp(0.0, 1.0))
        };
        let (row, along_rows) = cell(rgb[(largest + 1) % 3]);
        let (column, along_columns) = cell(rgb[(largest + 2) % 3]);
        let count = to.len().div_ceil(LANES);
        let first = ((largest * SIDE + row) * SIDE + column) * count;
        let (upper, lower) = (&self.points[first..][..2 * count], &self.points[first + SIDE * count..][..2 * count]);
        for (k, to) in to.chunks_mut(LANES).enumerate() {
            let (u0, u1, l0, l1) = (upper[k], upper[count + k], lower[k], lower[count + k]);
            let got: [f32; LANES] = std::array::from_fn(|l| {
                let a = u0[l] + (u1[l] - u0[l]) * along_columns;
                let b = l0[l] + (l1[l] - l0[l]) * along_columns;
                most * (a + (b - a) * along_rows)
            });
            to.copy_from_slice(&got[..to.len()]);
        }
    }

    /// Returns a plane for each channel, with as many pixels as the film has.
    fn planes(&self, still: &Still, size: &FrameSize) -> Vec<Vec<f32>> {
        if [still.width_px, still.height_px] == [size.width_px, size.height_px] {
            return self.of_pixels(&still.rgb);
        }
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        let rows: Vec<Vec<f32>> = (0..height).into_par_iter().map(|row| self.row(still, size, row)).collect();
        let plane = |k: usize| rows.iter().flat_map(|row| &row[k * width..][..width]).copied().collect();
        (0..self.channels.len()).map(plane).collect()
    }

    /// Returns a plane for each channel with its exposure by each of these pixels.
    fn of_pixels(&self, pixels: &[[f32; 3]]) -> Vec<Vec<f32>> {
        let mut planes: Vec<Vec<f32>> = self.channels.iter().map(|_| vec![0.0; pixels.len()]).collect();
        let mut pieces: Vec<Vec<&mut [f32]>> = pixels.chunks(PIXELS_A_TASK).map(|_| Vec::new()).collect();
        for plane in &mut planes {
            pieces.iter_mut().zip(plane.chunks_mut(PIXELS_A_TASK)).for_each(|(piece, part)| piece.push(part));
        }
        pieces.par_iter_mut().zip(pixels.par_chunks(PIXELS_A_TASK)).for_each(|(piece, pixels)| {
            let mut got = vec![0.0; piece.len()];
            for (i, rgb) in pixels.iter().enumerate() {
                self.at(*rgb, &mut got);
                piece.iter_mut().zip(&got).for_each(|(part, v)| part[i] = *v);
            }
        });
        planes
    }

    /// Returns a row of a film that has fewer pixels than the picture, one channel after another. Each pixel gets the mean of the
    /// light that falls on it.
    fn row(&self, still: &Still, size: &FrameSize, row: usize) -> Vec<f32> {
        let (width, count) = (size.width_px as usize, self.channels.len());
        let covered = |i: usize, of: u32, parts: u32| {
            let step = f64::from(of) / f64::from(parts);
            let (from, to) = (i as f64 * step, (i as f64 + 1.0) * step);
            let last = (to.ceil() as usize).min(of as usize);
            (from as usize..last).map(move |at| (at, (to.min(at as f64 + 1.0) - from.max(at as f64)) / step))
        };
        let mut sums = vec![0.0_f64; count * width];
        let mut got = vec![0.0; count];
        for (line, high) in covered(row, still.height_px, size.height_px) {
            let pixels = &still.rgb[line * still.width_px as usize..][..still.width_px as usize];
            for column in 0..width {
                for (at, wide) in covered(column, still.width_px, size.width_px) {
                    self.at(pixels[at], &mut got);
                    for (k, v) in got.iter().enumerate() {
                        sums[k * width + column] += high * wide * f64::from(*v);
                    }
                }
            }
        }
        sums.into_iter().map(|v| v as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::params::SourceFile;
    use spectra_core::registry::{self, Context};
    use spectra_core::spectral::BAND;
    use spectra_core::stage::Film;
    use spectra_plugins as _;
    use spectra_scene::{FileResources, yaml};
    use std::path::Path;

    /// The tables of the picture models are accurate enough for three layers and a meter.
    #[test]
    fn tables_hold_what_the_integrals_are() {
        let resources = FileResources::beside(Path::new(""));
        let context = Context::new(&resources, BAND);
        let parse = |text: &str, path: &str| {
            let node = yaml::parse(SourceFile::new("t.yaml", text)).expect("YAML");
            spectra_core::params::Params::stage(node, path).expect("a stage")
        };
        let film = parse("{kind: stock, stock: kodak-vision3-250d-5207, metering: average}", "film");
        let film = registry::build::<dyn Film>(&film, &context).expect("a film");
        let channels = film.channels();
        assert_eq!(channels.len(), 4);
        for model in ["smooth", "primaries", "gaussians"] {
            let built = registry::build::<dyn ColorModel>(&parse(model, "color"), &context).expect("a model");
            let colors = Colors::new(&*built, &channels, 1.0);
            println!("{model}: within {:.1e}, tabulated: {}", colors.worst(), !colors.points.is_empty());
            assert!(!colors.points.is_empty() && colors.worst() < 3e-3, "{model} falls back to integrals");
            // Colors that the table is not tested with: near the edge between two thirds, and of a single value.
            for rgb in [[0.3_f32, 0.299, 0.02], [0.0, 7.0, 0.0], [0.2, 0.2, 0.2], [1e-6, 2e-6, 1e-7]] {
                let (mut found, exact) = (vec![0.0; 4], colors.integrals(rgb.map(f64::from)));
                colors.at(rgb, &mut found);
                let most = exact.iter().fold(0.0_f64, |a, b| a.max(*b));
                for (found, exact) in found.iter().zip(&exact) {
                    assert!(
                        (f64::from(*found) - exact).abs() <= 3e-3 * exact.max(0.01 * most),
                        "{model} {rgb:?}: {found} {exact}"
                    );
                }
            }
            let mut nothing = vec![1.0; 4];
            colors.at([0.0; 3], &mut nothing);
            assert_eq!(nothing, [0.0; 4]);
            // A model that reaches beyond sRGB has a table there; a color without luminance is black.
            let mut colors = colors;
            colors.take_wide();
            assert_eq!(colors.wide.is_some(), model == "smooth");
            if let Some(wide) = &colors.wide {
                println!("{model}, beyond sRGB: within {:.1e}", wide.worst(&colors));
                assert!(wide.worst(&colors) < 5e-3);
            }
            for none in [[0.1, -0.5, 0.1], [-1.0; 3]] {
                colors.at(none, &mut nothing);
                assert_eq!(nothing, [0.0; 4]);
            }
        }
    }
}
