//! The color model `smooth`: each color becomes a smooth reflectance, lit by the illuminant.
//!
//! The model is that of W. Jakob and J. Hanika, "A low-dimensional function space for efficient spectral upsampling", Computer
//! Graphics Forum 38(2), 147 (2019). A reflectance is a sigmoid of a quadratic in the wavelength, s(x) = 1/2 + x / (2 sqrt(1 +
//! x^2)). Its three coefficients are solved for the color that it has under D65. Following M. Pharr, W. Jakob and G. Humphreys for
//! unbounded light ("Physically Based Rendering", 4th edition, 4.6.6), a color is first scaled to a largest value of 1/2 and its
//! spectrum scaled back. Thus no color is too bright, a gray is the illuminant times a number, and twice the color is twice the
//! spectrum. The price is that the reflectance of a bright, saturated color exceeds 1.
//!
//! Coefficients are stored in a table over the two smaller values relative to the largest. Newton's method fills it when the first
//! model is made. Between pixels of a picture, the color is interpolated and not the coefficients, which have no limit toward black.
//!
//! Colors outside sRGB, which have negative values, have a separate table ([`wide`]) up to 0.001 from the spectral locus.

mod reflectance;
mod solver;
mod table;
mod wide;

use reflectance::{Coefficients, quadratic, sigmoid};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::Isa;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::Vectorized;
use spectra_core::math::floor_index;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::{Grid, Line, SpectralPower};
use spectra_core::stage::{ColorGamut, ColorModel};
use spectra_spectrum::illuminant;
use table::{LEVEL, SIDE, Table, cell, mix};
use wide::WideTable;

/// Each color becomes a smooth reflectance, lit by the illuminant.
///
/// This is the default model, for pictures of lit objects. Each color becomes the reflectance s(a + b t + c t^2), with the
/// sigmoid s(x) = 1/2 + x / (2 sqrt(1 + x^2)) and t running over the band; a, b and c are the numbers that give the color
/// under D65. The light of the color is that reflectance times the illuminant. Grays therefore have the spectrum of the
/// illuminant itself, lines included, and colors change under fluorescent or sodium light as real ones do.
///
/// A color is first scaled to a largest value of 1/2 and its spectrum scaled back, so that no color is too bright; as a
/// result, the reflectance of a bright, saturated color can exceed 1.
///
/// Colors outside sRGB, as in pictures of wide gamut, keep their luminance and hue up to 0.001 in xy from the spectral
/// locus. Colors nearer to it, and colors that no light can have, are moved toward D65 onto that boundary and keep their
/// luminance.
///
/// # Example
/// ```yaml
/// {kind: smooth}
/// ```
/// # References
/// - W. Jakob and J. Hanika, "A low-dimensional function space for efficient spectral upsampling", Computer Graphics
///   Forum 38(2), 147 (2019).
/// - M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering", 4th edition, 4.6.6.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SmoothParams {}

spectra_core::register!(color "smooth" (default): SmoothParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn ColorModel>, Faults> {
    let SmoothParams {} = params.parse()?;
    let light = context.illuminant.cloned().unwrap_or_else(|| daylight().to_power(&context.grid));
    Ok(Box::new(Smooth::new(light)))
}

/// Returns D65, the light under which a reflectance has exactly the color of its RGB values.
fn daylight() -> spectra_spectrum::Emission {
    illuminant("D65").expect("D65 is bundled")
}

/// The color model `smooth` for one illuminant.
struct Smooth {
    light: SpectralPower,
    lines_nm: Vec<f64>,
    table: &'static Table,
}

impl Smooth {
    fn new(light: SpectralPower) -> Self {
        let lines_nm = light.lines.iter().map(|l| l.wavelength_nm).collect();
        Self { light, lines_nm, table: Table::of_srgb() }
    }
}

impl Smooth {
    /// Returns the power of the illuminant: per nm in its continuum, or that of a line.
    #[inline(always)]
    fn power(&self, wavelength_nm: f64, line: u32) -> f64 {
        if line == CONTINUUM {
            self.light.grid.interpolate(&self.light.continuum, wavelength_nm)
        } else {
            self.light.lines.get(line as usize).map_or(0.0, |l| l.power)
        }
    }
}

impl ColorModel for Smooth {
    fn lines_nm(&self) -> &[f64] {
        &self.lines_nm
    }

    fn gamut(&self) -> ColorGamut {
        ColorGamut::Real
    }

    /// Returns the color itself, so that a place between two pixels gets a mixture of their colors.
    fn coefficients(&self, linear_srgb: [f64; 3]) -> [f32; 3] {
        linear_srgb.map(|v| v as f32)
    }

    fn spectrum(&self, linear_srgb: [f64; 3]) -> SpectralPower {
        let (scale, coefficients) = look_up(self.table, linear_srgb);
        let reflectance = |nm: f64| scale * sigmoid(quadratic(coefficients, nm));
        let light = &self.light;
        let mut continuum = light.continuum.clone();
        Isa::detect().run(Reflect { grid: light.grid, scale, coefficients, light: &mut continuum });
        SpectralPower {
            grid: light.grid,
            continuum,
            lines: light.lines.iter().map(|l| Line { power: l.power * reflectance(l.wavelength_nm), ..*l }).collect(),
        }
    }

    fn evaluate(&self, coefficients: &[[f32; 3]], wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]) {
        let isa = Isa::detect();
        let mut looked = Looked::new();
        for (k, weight) in weight.chunks_mut(CHUNK).enumerate() {
            let r = k * CHUNK..k * CHUNK + weight.len();
            let (colors, wavelength_nm, line) = (&coefficients[r.clone()], &wavelength_nm[r.clone()], &line[r]);
            isa.run(Evaluate { model: self, looked: &mut looked, colors, wavelength_nm, line, weight });
        }
    }
}

fn is_beyond_srgb([r, g, b]: [f64; 3]) -> bool {
    (r < 0.0) | (g < 0.0) | (b < 0.0)
}

/// Returns the scale and the coefficients of the spectrum of any color; a color without luminance, or with NaN, is black.
fn look_up(table: &Table, linear_srgb: [f64; 3]) -> (f64, Coefficients) {
    if is_beyond_srgb(linear_srgb) {
        return WideTable::get().look_up(linear_srgb).unwrap_or_default();
    }
    table.look_up(linear_srgb)
}

/// Multiplies light on a grid by a scaled reflectance.
struct Reflect<'a> {
    grid: Grid,
    scale: f64,
    coefficients: Coefficients,
    light: &'a mut [f64],
}

impl Vectorized for Reflect<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { grid: Grid { start_nm, step_nm, .. }, scale, coefficients, light } = self;
        for (i, light) in light.iter_mut().enumerate() {
            *light *= scale * sigmoid(quadratic(coefficients, start_nm + step_nm * i as f64));
        }
    }
}

/// Marks a wavelength outside the band of the illuminant.
const BESIDE: u32 = u32::MAX;

/// Number of rays processed side by side.
const CHUNK: usize = 64;
type Each<T> = [T; CHUNK];

/// Results of the table look-ups for a chunk of rays: positions of their colors in the table, and the values there.
struct Looked {
    /// Scale of the spectrum.
    scale: Each<f64>,
    /// Index of the first of the four table points around the color; `along` is the color's position between them, along rows and along
    /// columns, 0 to 1.
    point: Each<u32>,
    along: [Each<f64>; 2],
    /// Three coefficients at each of the four points.
    corners: [[Each<f32>; 3]; 4],
    /// Power of the illuminant at the grid points before and behind the wavelength; `between` is the wavelength's position between them,
    /// 0 to 1.
    lit: [Each<f64>; 2],
    between: Each<f64>,
}

impl Looked {
    fn new() -> Self {
        Self {
            scale: [0.0; CHUNK],
            point: [0; CHUNK],
            along: [[0.0; CHUNK]; 2],
            corners: [[[0.0; CHUNK]; 3]; 4],
            lit: [[0.0; CHUNK]; 2],
            between: [0.0; CHUNK],
        }
    }
}

/// Multiplies the weights of up to [`CHUNK`] rays by their spectra. The result equals [`look_up`] for each ray; steps that need no table
/// run in vectors. Colors outside sRGB, which are few, are looked up one by one.
struct Evaluate<'a> {
    model: &'a Smooth,
    looked: &'a mut Looked,
    colors: &'a [[f32; 3]],
    wavelength_nm: &'a [f64],
    line: &'a [u32],
    weight: &'a mut [f64],
}

impl Vectorized for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { model, looked, colors, wavelength_nm, line, weight } = self;
        let len = weight.len().min(CHUNK);
        let (colors, wavelength_nm, line, weight) =
            (&colors[..len], &wavelength_nm[..len], &line[..len], &mut weight[..len]);
        let Looked { scale, point, along, corners, lit, between } = looked;
        let (grid, continuum) = (model.light.grid, &model.light.continuum[..]);
        let (last, top) = ((grid.count - 2) as f64, (grid.count - 1) as f64);
        let mut shade = [0_u32; CHUNK];
        for i in 0..len {
            let p = (wavelength_nm[i] - grid.start_nm) / grid.step_nm;
            let inside = (p >= 0.0) & (p <= top);
            let (at, below) = floor_index(if inside { p } else { 0.0 }, last);
            between[i] = if inside { p - below } else { 0.0 };
            shade[i] = if inside { at } else { BESIDE };
        }
        for i in 0..len {
            let [r, g, b] = colors[i].map(f64::from).map(|v| if v > 0.0 { v } else { 0.0 });
            let (is_red, is_green) = ((r >= g) & (r >= b), g >= b);
            let (largest, most, next, last) = if is_red {
                (0, r, g, b)
            } else if is_green {
                (1, g, b, r)
            } else {
                (2, b, r, g)
            };
            let (row, along_rows) = cell(next, most);
            let (column, along_columns) = cell(last, most);
            scale[i] = most / LEVEL;
            point[i] = (largest * SIDE as u32 + row) * SIDE as u32 + column;
            (along[0][i], along[1][i]) = (along_rows, along_columns);
        }
        for i in 0..len {
            let at = point[i] as usize;
            let points = &model.table.points[at..at + SIDE + 2];
            for (corner, at) in corners.iter_mut().zip([0, 1, SIDE, SIDE + 1]) {
                for (column, value) in corner.iter_mut().zip(points[at]) {
                    column[i] = value;
                }
            }
            [lit[0][i], lit[1][i]] = if (line[i] == CONTINUUM) & (shade[i] != BESIDE) {
                let pair = &continuum[shade[i] as usize..][..2];
                [pair[0], pair[1]]
            } else {
                // A line, or a wavelength outside the band: the same power on both sides.
                [model.power(wavelength_nm[i], line[i]); 2]
            };
        }
        let beyond: Option<Each<f64>> = colors.iter().any(|color| is_beyond_srgb(color.map(f64::from))).then(|| {
            let mut kept = [0.0; CHUNK];
            kept[..len].copy_from_slice(weight);
            kept
        });
        let [p00, p01, p10, p11] = corners;
        for i in 0..len {
            let mixed = std::array::from_fn(|k| {
                let [a, b, c, d] = [p00[k][i], p01[k][i], p10[k][i], p11[k][i]].map(f64::from);
                mix([a, b, c, d], along[0][i], along[1][i])
            });
            let power = lit[0][i] + (lit[1][i] - lit[0][i]) * between[i];
            weight[i] *= power * scale[i] * sigmoid(quadratic(mixed, wavelength_nm[i]));
        }
        let Some(kept) = beyond else { return };
        for i in 0..len {
            let color = colors[i].map(f64::from);
            if is_beyond_srgb(color) {
                let (scale, coefficients) = WideTable::get().look_up(color).unwrap_or_default();
                let power = lit[0][i] + (lit[1][i] - lit[0][i]) * between[i];
                weight[i] = kept[i] * (power * scale * sigmoid(quadratic(coefficients, wavelength_nm[i])));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::solver::Solver;
    use super::table::value;
    use super::*;
    use spectra_color::{RealGamut, RgbSpace, chromaticity};
    use spectra_core::spectral::BAND;
    use spectra_spectrum::Observer;

    fn model() -> Smooth {
        Smooth::new(daylight().to_power(&BAND))
    }

    /// Newton's method reaches every color of the table, including the boundary of sRGB.
    #[test]
    fn every_color_is_solved() {
        let (solver, table) = (Solver::new(), Table::of_srgb());
        let mut worst = 0.0_f64;
        for largest in 0..3 {
            for row in 0..SIDE {
                for column in 0..SIDE {
                    let mut color = [LEVEL; 3];
                    color[(largest + 1) % 3] = LEVEL * value(row);
                    color[(largest + 2) % 3] = LEVEL * value(column);
                    let (rgb, _) = solver.color(table.look_up(color).1);
                    worst = rgb.iter().zip(color).fold(worst, |w, (a, b)| w.max((a - b).abs()));
                }
            }
        }
        println!("largest difference in linear RGB at the points of the table: {worst:e}");
        // The remaining difference comes from the table's single precision.
        assert!(worst < 1e-6, "{worst:e}");
    }

    /// Batches of any length give bit by bit the values that the table gives for each color alone.
    #[test]
    fn side_by_side_is_as_alone() {
        let model = model();
        let mut state = 3_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let many = 3 * CHUNK + 5;
        let mut colors: Vec<[f32; 3]> =
            (0..many).map(|_| [0, 1, 2].map(|_| (draw() * if draw() < 0.2 { 40.0 } else { 1.0 }) as f32)).collect();
        colors[..7].copy_from_slice(&[
            [0.0; 3],
            [1.0; 3],
            [0.0, 0.0, 1.0],
            [0.5, 0.5, 0.0],
            [f32::NAN, 0.2, 0.1],
            [-0.1, 0.3, 0.3],
            [1e-30, 1e-31, 0.0],
        ]);
        let nm: Vec<f64> = (0..many).map(|_| 340.0 + 500.0 * draw()).collect();
        let mut weight = vec![1.5; many];
        model.evaluate(&colors, &nm, &vec![CONTINUUM; many], &mut weight);
        for i in 0..many {
            let (scale, color) = look_up(model.table, colors[i].map(f64::from));
            let power = model.light.grid.interpolate(&model.light.continuum, nm[i]);
            let want = 1.5 * (power * scale * sigmoid(quadratic(color, nm[i])));
            assert_eq!(weight[i].to_bits(), want.to_bits(), "{:?} at {}: {} {want}", colors[i], nm[i], weight[i]);
        }
    }

    #[test]
    fn grey_is_the_illuminant_and_brightness_has_no_end() {
        let model = model();
        let light = daylight().to_power(&BAND);
        for level in [0.18, 1.0, 20.0] {
            let grey = model.spectrum([level; 3]);
            assert!(grey.continuum.iter().zip(&light.continuum).all(|(g, l)| (g / l / level - 1.0).abs() < 1e-12));
        }
        let (one, seven) = (model.spectrum([0.9, 0.3, 0.1]), model.spectrum([6.3, 2.1, 0.7]));
        assert!(one.continuum.iter().zip(&seven.continuum).all(|(a, b)| (b / a / 7.0 - 1.0).abs() < 1e-12));
        for nothing in [[0.0; 3], [f64::NAN; 3], [-1.0, -2.0, 0.0], [f64::NAN, -1.0, 0.0]] {
            assert!(model.spectrum(nothing).is_dark());
        }
    }

    /// Rays get the values of the spectrum, on lines too, and spectra are continuous from one third of the table to the next.
    #[test]
    fn rays_see_the_spectrum() {
        let mut light = daylight().to_power(&BAND);
        light.lines.push(Line { wavelength_nm: 546.07, power: 3.0 });
        let model = Smooth::new(light);
        for rgb in [[0.2, 0.7, 0.05], [0.5, 0.5, 0.1], [0.5, 0.500_001, 0.1], [0.0, 0.0, 1.0], [3.0, 0.0, 2.0]] {
            let spectrum = model.spectrum(rgb);
            let color = model.coefficients(rgb);
            let mut weight = [1.0, 2.0, 1.0];
            model.evaluate(&[color; 3], &[450.0, 620.0, 546.07], &[CONTINUUM, CONTINUUM, 0], &mut weight);
            let want = [spectrum.continuum[100], 2.0 * spectrum.continuum[270], spectrum.lines[0].power];
            for (got, want) in weight.iter().zip(want) {
                // The color passes through single precision twice.
                assert!((got / want - 1.0).abs() < 1e-5, "{rgb:?}: {weight:?} {want}");
            }
        }
        let (a, b) = (model.spectrum([0.5, 0.5, 0.1]), model.spectrum([0.5, 0.500_001, 0.1]));
        assert!(a.continuum.iter().zip(&b.continuum).all(|(a, b)| (a / b - 1.0).abs() < 1e-4));
    }

    /// Every real color keeps its luminance and its place in xy, no spectrum is negative, and spectra do not jump at the boundary of sRGB.
    #[test]
    fn colors_beyond_srgb_are_themselves() {
        let (model, observer) = (model(), Observer::cie_1931_2deg());
        let white = observer.xyz_of_power(&model.spectrum([1.0; 3]))[1];
        let (mut worst, mut farthest) = (0.0_f64, 0.0_f64);
        for i in 0..360 {
            for depth in [1e-9, 0.2, 0.55, 0.85, 0.97, 1.0] {
                let rgb = RealGamut::color(f64::from(i) / 90.0 + 0.003, depth);
                let spectrum = model.spectrum(rgb);
                assert!(spectrum.continuum.iter().all(|v| *v >= 0.0));
                let xyz = observer.xyz_of_power(&spectrum).map(|v| v / white);
                let wanted = RgbSpace::srgb().to_xyz(rgb);
                let [got, xy] = [xyz, wanted].map(|xyz| chromaticity(xyz).expect("light"));
                worst = worst.max((xyz[1] / wanted[1] - 1.0).abs());
                farthest = farthest.max((got[0] - xy[0]).abs().max((got[1] - xy[1]).abs()));
            }
            let turn = f64::from(i) / 90.0 + 0.003;
            let [inside, outside] = [-1e-7, 1e-7].map(|depth| {
                let border = RealGamut::color(turn, 0.0);
                model.spectrum(border.map(|v| v - depth * if v.abs() < 1e-9 { 1.0 } else { 0.0 }))
            });
            let most = inside.continuum.iter().fold(0.0_f64, |a, b| a.max(*b));
            let jump = inside.continuum.iter().zip(&outside.continuum).fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()));
            assert!(jump < 0.02 * most, "{turn}: {}", jump / most);
        }
        println!("luminance within {worst:.1e}, xy within {farthest:.1e}");
        assert!(worst < 1e-2 && farthest < 5e-3, "{worst} {farthest}");
        assert!(model.spectrum([0.1, -0.5, 0.2]).is_dark());
    }
}
