//! `kind: rays`: a drawing of rays through the lens.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_analysis::draw::{DrawingBackground, DrawnRay, Fans, SectionView, Sheet};
use spectra_analysis::fan::largest_field_rad;
use spectra_color::RgbSpace;
use spectra_core::RayBatch;
use spectra_core::params::{Faults, Length, Params, Positive, Whole};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::Emit;
use spectra_glass::DispersionError;
use spectra_lens::Section;
use spectra_plot::{Canvas, Format};
use spectra_scene::{FileContent, Output, Scene, Shot};
use spectra_spectrum::Observer;
use spectra_tracer::Indices;

/// A figure of the light's path through the lens, in addition to the picture.
///
/// The figure is a section of the lens with rays of the scene's own light: the rays of a beam in their colors, or fans over the field for a
/// source that shines everywhere. Use it in papers and pages that explain a picture, or to see what a lens does to the light of a prism.
///
/// # Example
/// ```yaml
/// {kind: rays, size: [1200, 400], rays: 9, ground: light}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RaysParams {
    /// Width and height of the figure in pixels, each 64 to 8192.
    #[serde(default = "size")]
    size: [Whole<64, 8192>; 2],
    /// Width of the region shown, mm if bare; fitted to the lens if absent.
    view: Option<Positive<Length>>,
    /// Number of rays across the beam for each wavelength, 1 to 1001.
    #[serde(default = "across")]
    rays: Whole<1, 1001>,
    /// Number of wavelengths over a continuous spectrum, 1 to 4001.
    #[serde(default = "wavelengths")]
    wavelengths: Whole<1, 4001>,
    /// Brightness of the colors: `full` (the default; all equal) or `true` (relative to the brightest).
    #[serde(default)]
    intensity: Intensity,
    /// Background of the figure: `dark` (the default) or `light`.
    #[serde(default)]
    ground: On,
    /// File format of the figure: `png` (the default) or `svg`.
    #[serde(default)]
    format: As,
    /// Whether the image plane is drawn and ends the rays.
    #[serde(default)]
    screen: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Intensity {
    #[default]
    Full,
    True,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum On {
    #[default]
    Dark,
    Light,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum As {
    #[default]
    Png,
    Svg,
}

fn size() -> [Whole<64, 8192>; 2] {
    [Whole::known(800), Whole::known(600)]
}

fn across() -> Whole<1, 1001> {
    Whole::known(1)
}

fn wavelengths() -> Whole<1, 4001> {
    Whole::known(64)
}

spectra_core::register!(spectra_scene::OutputEntry, "rays": RaysParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    Ok(Box::new(Rays(params.parse()?)))
}

struct Rays(RaysParams);

impl Output for Rays {
    fn kind(&self) -> &'static str {
        "rays"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["-rays", if self.0.format == As::Svg { ".svg" } else { ".png" }]
    }

    fn content(&self) -> FileContent {
        FileContent::Figure
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let figure = &self.0;
        let canvas = drawn(shot.scene, figure).map_err(|e| WriteFault::Format(e.to_string()))?;
        let format = if figure.format == As::Svg { Format::Svg } else { Format::Png };
        Ok(out.write_all(&canvas.to_bytes(format, 1.0)?)?)
    }
}

/// Draws the path of a scene's light through the lens.
fn drawn(scene: &Scene, figure: &RaysParams) -> Result<Canvas, DispersionError> {
    let rays = match scene.source.emit().filter(|emit| emit.is_directed()) {
        Some(emit) => beam(scene, emit, figure)?,
        None => fans(scene, figure)?,
    };
    let [width, height] = figure.size.map(|side| f64::from(side.get_u32()));
    let sheet = Sheet {
        width,
        height: Some(height),
        ground: if figure.ground == On::Light { DrawingBackground::Light } else { DrawingBackground::Dark },
        width_mm: figure.view.map(|view| view.mm()),
        view: SectionView { section: Section::Y },
        caption: String::new(),
        image: figure.screen,
    };
    Ok(sheet.draw(&scene.lens, &rays))
}

/// Draws the path of a scene's light through the lens on a white background, for a page.
///
/// # Errors
/// Fails if a medium has no refractive index at the wavelength of a ray.
pub(crate) fn on_paper(scene: &Scene) -> Result<Canvas, DispersionError> {
    let figure = RaysParams {
        size: [Whole::known(1100), Whole::known(420)],
        view: None,
        rays: Whole::known(7),
        wavelengths: wavelengths(),
        intensity: Intensity::Full,
        ground: On::Light,
        format: As::Svg,
        screen: true,
    };
    drawn(scene, &figure)
}

/// Wavelengths that a screen can show, nm.
const VISIBLE_NM: [f64; 2] = [390.0, 710.0];
/// Field angles drawn for a source that is not a beam, as fractions of the largest that passes.
const PARTS: [f64; 3] = [0.0, 0.6, 0.95];
/// Largest field angle that is tried, degrees.
const WIDEST_DEG: f64 = 85.0;

/// Traces a beam's own rays: for each spectral line, and for wavelengths over its continuum.
fn beam(scene: &Scene, emit: &dyn Emit, figure: &RaysParams) -> Result<Vec<DrawnRay>, DispersionError> {
    let spectrum = scene.source.spectrum();
    let visible = |nm: f64| (VISIBLE_NM[0]..=VISIBLE_NM[1]).contains(&nm);
    let lines = spectrum.lines.iter().enumerate().filter(|(_, line)| visible(line.wavelength_nm));
    let lines: Vec<(f64, u32)> = lines.map(|(at, line)| (line.wavelength_nm, at as u32)).collect();
    let continuum = spectrum.continuum.iter().any(|v| *v > 0.0);
    let step = (VISIBLE_NM[1] - VISIBLE_NM[0]) / f64::from(figure.wavelengths.get_u32());
    let wavelengths =
        (0..figure.wavelengths.get_u32()).filter(|_| continuum).map(|k| VISIBLE_NM[0] + step * (f64::from(k) + 0.5));
    let wavelengths = wavelengths.map(|nm| (nm, spectra_core::batch::CONTINUUM));
    let mut drawn = Vec::new();
    // Lines and continuum have no common unit: each is relative to its own brightest.
    for group in [lines, wavelengths.collect()] {
        let first = drawn.len();
        for (wavelength_nm, line) in group {
            let n = figure.rays.size();
            let mut rays = RayBatch::new(n);
            rays.restart(n);
            let c = rays.columns_mut();
            c.wavelength_nm.fill(wavelength_nm);
            c.line.fill(line);
            let across: Vec<f64> = (0..n).map(|k| (k as f64 + 0.5) / n as f64).collect();
            emit.place(&mut rays, &vec![0.5; n], &across);
            let tracer = scene.lens.tracer(Indices::At(wavelength_nm))?;
            for k in 0..n {
                let [position, direction] =
                    [rays.positions(), rays.directions()].map(|columns| DVec3::from_array(columns.map(|c| c[k])));
                let path = tracer.path(position, direction, wavelength_nm);
                drawn.push(DrawnRay { path, wavelength_nm, strength: rays.weights()[k] * brightness(wavelength_nm) });
            }
        }
        let brightest = drawn[first..].iter().map(|r| r.strength).fold(0.0, f64::max);
        for ray in &mut drawn[first..] {
            ray.strength =
                if figure.intensity == Intensity::True && brightest > 0.0 { ray.strength / brightest } else { 1.0 };
        }
    }
    Ok(drawn)
}

/// Returns how bright a screen shows one unit of light of a wavelength: the largest channel of its linear sRGB.
fn brightness(wavelength_nm: f64) -> f64 {
    let rgb = RgbSpace::srgb().from_xyz(Observer::cie_1931_2deg().at(wavelength_nm));
    rgb.into_iter().fold(0.0, f64::max)
}

/// Traces fans of rays over the field, for a source that shines everywhere.
fn fans(scene: &Scene, figure: &RaysParams) -> Result<Vec<DrawnRay>, DispersionError> {
    let object_mm = scene.source.distance_mm();
    let largest = largest_field_rad(&scene.lens, Section::Y, object_mm, f64::to_radians(WIDEST_DEG))?.unwrap_or(0.0);
    let lines = [spectra_glass::lines::F_PRIME, spectra_glass::lines::E, spectra_glass::lines::C_PRIME];
    let fans = Fans {
        fields_deg: PARTS.iter().map(|part| part * largest.to_degrees()).collect(),
        object_mm,
        rays: figure.rays.size().max(3),
        wavelengths_nm: lines.map(|line| line.wavelength_nm).to_vec(),
    };
    fans.trace(&scene.lens, Section::Y)
}
