//! `kind: chart`: a test chart that the program draws.

use crate::chart::{self, Chart, Ink};
use crate::frame::{Edge, PlanePlacement, Width};
use crate::palette::Palette;
use crate::plane_source::{Places, PlaneSource, Texture};
use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::{RgbSpace, Transfer};
use spectra_core::Isa;
use spectra_core::params::{Deferred, Faults, Length, Luminance, Params, Positive, Quantity};
use spectra_core::registry::{Context, StageOf, build as build_stage};
use spectra_core::spectral::{Line, SpectralPower};
use spectra_core::stage::{ColorModel, Source};
use spectra_spectrum::{Observer, Reflectance, SpectrumError, find_reflectance_in};

/// A test chart drawn by the program: resolution, color patches, gray card, star.
///
/// The chart is a flat, Lambertian sheet perpendicular to the axis. It is sharp at any magnification, since it is drawn, not
/// sampled. Its height follows from its width. The charts are:
///
/// - `resolution`: stars, slanted edges, wedges, line groups, circles, grays and color patches;
/// - `color-checker`: the 24 patches of a ColorChecker on a black frame, with their measured reflectances;
/// - `gray-card`: uniform gray of 18 % reflectance; `white`: uniform white of reflectance 1;
/// - `grid`: white lines on black, for distortion and lateral color;
/// - `siemens`: one Siemens star of 72 cycles with tone patches in the corners;
/// - `slanted-edge`: 7 x 5 squares of 4:1 contrast, turned by 5 degrees, for the MTF over the field;
/// - `star-field`: stars as tiny disks on black, placed by `seed`;
/// - `step-wedge`: 21 gray steps of density 0.15, in both directions;
/// - `text`: lines of text in decreasing sizes, black on white and white on black.
///
/// `luminance` sets how bright a perfect white on the chart would be, and `illuminant` in what light.
///
/// # Example
/// ```yaml
/// {kind: chart, chart: resolution, distance: 2 m, width: 1.5 m, illuminant: D65, luminance: 300 cd/m2}
/// ```
/// ```yaml
/// kind: chart
/// chart: color-checker
/// distance: 1.5 m
/// width: 60 cm
/// illuminant: iso-7589-studio-tungsten
/// color: {kind: fraunhofer, R: "C'", G: e, B: g}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ChartParams {
    /// Name of the chart: `resolution`, `color-checker`, `gray-card` and so on; `patches` shows your own `reflectances`.
    chart: String,
    /// Patches of `chart: patches`: a table beside the scene whose columns are reflectances, or a list of reflectances by name.
    reflectances: Option<OwnReflectances>,
    /// Distance of the chart from the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the chart, mm if bare; the height follows. `fill` makes it 2 % wider than what the frame sees there through
    /// this lens; parts that do not fit into the shape of the frame are cut off.
    width: Width,
    /// Light beyond the chart: `black` (none), `clamp` (continues the border) or `mirror` (mirrors the chart). `black` if left
    /// out, with a warning if the frame sees it. With `clamp` and `mirror` light is traced backward only.
    edge: Option<Edge>,
    /// Light that falls on the chart: the name of a spectrum, a file beside the scene, or an expression such as
    /// `blackbody:3200`.
    #[serde(default = "daylight")]
    illuminant: String,
    /// Luminance of a perfect white on the chart, cd/m2 if bare.
    #[serde(default = "luminance")]
    luminance: Positive<Luminance>,
    /// Color model that turns RGB into a spectrum. If left out, patches have their measured reflectances; if given, every ink
    /// has this model's spectrum for its sRGB color.
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
    /// Seed of charts with random parts (`star-field`), 0 or more.
    #[serde(default)]
    seed: u64,
}

/// `reflectances` as written in a scene.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
enum OwnReflectances {
    /// A table with one reflectance per column.
    Table(String),
    /// A list of reflectances by name.
    Names(Vec<String>),
}

/// Largest number of patches with the user's reflectances.
const MAX_PATCHES: usize = 1000;

fn daylight() -> String {
    "D65".to_owned()
}

fn luminance() -> Positive<Luminance> {
    Positive::from_bare(100.0)
}

spectra_core::register!(source "chart": ChartParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let mut faults = Faults::new();
    let named = |name: &str, width_mm: Option<f64>, seed: u64| {
        chart::chart(name, width_mm, seed).map_err(|error| {
            let (message, hint) = error.parts();
            params.fault("chart", message).hint(hint)
        })
    };
    let Some(p) = faults.take(params.parse::<ChartParams>()) else {
        // Whatever else is wrong, an unknown chart or light is reported at the same time.
        let text = |key: &str| params.get(key).and_then(|node| node.as_str());
        faults.take(
            text("chart")
                .filter(|name| *name != chart::OWN_PATCHES)
                .map_or(Ok(()), |name| named(name, None, 0).map(|_| ())),
        );
        faults.take(text("illuminant").map_or(Ok(()), |name| white::illuminant(name, params, context).map(|_| ())));
        return Err(faults);
    };
    let light = faults.take(white::illuminant(&p.illuminant, params, context));
    let own = faults.take(own_reflectances(&p, params, context)).unwrap_or_default();
    let distance_mm = p.distance.mm();
    let drawn = |width_mm: f64| match p.chart.as_str() {
        chart::OWN_PATCHES => Ok(chart::own_patches(own.len() as u16, width_mm)),
        name => named(name, Some(width_mm), p.seed),
    };
    // The aspect ratio does not depend on the width, so draw the chart at any width first.
    let chart = faults.take(drawn(distance_mm)).and_then(|any| {
        let aspect = any.width_mm() / any.height_mm();
        let width_mm = faults.take(p.width.mm(aspect, distance_mm, [0.0; 2], context.view, params))?;
        faults.take(drawn(width_mm))
    });
    let spectra = match (&light, &chart) {
        (Some(light), Some(chart)) => {
            let inner = Context { illuminant: Some(light), ..*context };
            faults.take(match p.color {
                Some(node) => node
                    .params()
                    .and_then(|color| build_stage::<dyn ColorModel>(&color, &inner))
                    .map(|model| by_model(chart, &own, light, &*model)),
                None => measured(chart, &own, light, params, &inner),
            })
        }
        _ => None,
    };
    let (Some(chart), Some((spectra, white))) = faults.into_result((chart, spectra))? else {
        return Err(Faults::new());
    };
    if p.edge.is_none() && !p.width.is_fill() {
        let (width_mm, height_mm) = (chart.width_mm(), chart.height_mm());
        let placed = PlanePlacement { width_mm, height_mm, distance_mm, center_mm: [0.0; 2] };
        placed.warn_unless_filled("the chart", params, context);
    }
    let scale = p.luminance.cd_per_m2() / white::luminance_cd_m2(&white);
    let spectra: Vec<SpectralPower> = spectra.iter().map(|s| s.scaled(scale)).collect();
    let palette = Palette::new(context.grid, &spectra);
    let texture =
        ChartTexture { edge: p.edge.unwrap_or_default(), ..ChartTexture::new(chart, palette, &spectra, white) };
    Ok(Box::new(PlaneSource { texture, distance_mm }))
}

/// Reads the user's reflectances for `chart: patches`.
fn own_reflectances(p: &ChartParams, params: &Params, context: &Context<'_>) -> Result<Vec<Reflectance>, Faults> {
    let is_own = p.chart == chart::OWN_PATCHES;
    let stated = match (&p.reflectances, is_own) {
        (None, false) => return Ok(Vec::new()),
        (Some(_), false) => {
            let fault = params.fault("reflectances", format!("the chart `{}` has its own patches", p.chart));
            return Err(fault.hint("write `chart: patches`").into());
        }
        (None, true) => {
            let fault = params.fault("chart", "`patches` needs `reflectances`");
            return Err(fault
                .hint("write `reflectances: my-paints.csv`, a table with `wavelength_nm` and one column per patch")
                .into());
        }
        (Some(stated), true) => stated,
    };
    let find = |key: &str, name: &str| {
        find_reflectance_in(name, context.resources).map_err(|e| e.faults(|text| params.fault(key, text)))
    };
    let mut faults = Faults::new();
    let mut found = Vec::new();
    match stated {
        OwnReflectances::Table(name) => match find_reflectance_in(name, context.resources) {
            Err(SpectrumError::Ambiguous { columns, .. }) => {
                for column in columns {
                    found.extend(faults.take(find("reflectances", &format!("{name}#{column}"))));
                }
            }
            _ => found.extend(faults.take(find("reflectances", name))),
        },
        OwnReflectances::Names(names) => {
            for (i, name) in names.iter().enumerate() {
                found.extend(faults.take(find(&format!("reflectances[{i}]"), name)));
            }
        }
    }
    if faults.is_empty() && !(1..=MAX_PATCHES).contains(&found.len()) {
        let fault = params.fault("reflectances", format!("{} reflectances are given", found.len()));
        faults.push(fault.hint(format!("write 1 to {MAX_PATCHES} reflectances")));
    }
    faults.into_result(found)
}

/// The spectra of the inks, and the spectrum of a perfect white.
type Inks = (Vec<SpectralPower>, SpectralPower);

/// Returns the spectra of the inks as measured, under the light. Colors without a measured spectrum use the default model.
fn measured(
    chart: &Chart,
    own: &[Reflectance],
    light: &SpectralPower,
    params: &Params,
    context: &Context<'_>,
) -> Result<Inks, Faults> {
    let mut model = None;
    let mut spectra = Vec::new();
    for ink in chart.inks() {
        spectra.push(match ink {
            Ink::Gray(reflectance) => light.scaled(*reflectance),
            Ink::Patch(name) => lit(light, &patch(name, params)?),
            // The chart has as many patches as there are reflectances. If one was faulty, the chart is never used.
            Ink::Own(i) => own.get(usize::from(*i)).map_or_else(|| light.scaled(0.0), |r| lit(light, r)),
            Ink::Rgb(encoded) => {
                if model.is_none() {
                    model = Some(build_stage::<dyn ColorModel>(&params.default_stage("color"), context)?);
                }
                let Some(model) = &model else { return Err(Faults::new()) };
                // The model's white and the light have the same chromaticity; give them the same luminance.
                let of_white = white::luminance_cd_m2(&model.spectrum([1.0; 3]));
                let scale = white::luminance_cd_m2(light) / of_white;
                model.spectrum(encoded.map(|v| Transfer::Srgb.decode(v))).scaled(scale)
            }
        });
    }
    Ok((spectra, light.clone()))
}

/// Returns the spectra that one color model gives for the sRGB colors of the inks.
fn by_model(chart: &Chart, own: &[Reflectance], light: &SpectralPower, model: &dyn ColorModel) -> Inks {
    let spectra = chart
        .inks()
        .iter()
        .map(|ink| match ink {
            Ink::Gray(reflectance) => model.spectrum([*reflectance; 3]),
            Ink::Rgb(encoded) => model.spectrum(encoded.map(|v| Transfer::Srgb.decode(v))),
            Ink::Patch(name) => {
                let found = spectra_spectrum::find_reflectance(&column(name));
                model.spectrum(found.map_or([0.0; 3], |r| linear_srgb(&r, light)))
            }
            Ink::Own(i) => model.spectrum(own.get(usize::from(*i)).map_or([0.0; 3], |r| linear_srgb(r, light))),
        })
        .collect();
    (spectra, model.spectrum([1.0; 3]))
}

/// Returns the color of a patch in linear sRGB, where white is a perfect reflector under D65. Components are negative for colors
/// outside sRGB.
fn linear_srgb(reflectance: &Reflectance, light: &SpectralPower) -> [f64; 3] {
    let daylight = spectra_spectrum::find_emission("D65").map_or_else(|_| light.clone(), |e| e.to_power(&light.grid));
    let observer = Observer::cie_1931_2deg();
    let white = observer.xyz_of_power(&daylight)[1];
    let xyz = observer.xyz_of_power(&lit(&daylight, reflectance)).map(|v| v / white);
    RgbSpace::srgb().from_xyz(xyz)
}

/// Returns the name of a patch's column in the bundled table: `neutral 5 (.70 D)` is `neutral-5`.
fn column(name: &str) -> String {
    let plain = name.split(" (").next().unwrap_or(name);
    // The table calls the white and black patches by their color alone.
    let plain = if plain.starts_with("white") || plain.starts_with("black") { &plain[..5] } else { plain };
    format!("colorchecker#{}", plain.replace(' ', "-"))
}

fn patch(name: &str, params: &Params) -> Result<Reflectance, Faults> {
    spectra_spectrum::find_reflectance(&column(name))
        .map_err(|e| params.fault("chart", format!("patch `{name}`: {e}")).into())
}

fn lit(light: &SpectralPower, reflectance: &Reflectance) -> SpectralPower {
    SpectralPower {
        grid: light.grid,
        continuum: light.grid.wavelengths_nm().zip(&light.continuum).map(|(w, p)| p * reflectance.at(w)).collect(),
        lines: light.lines.iter().map(|l| Line { power: l.power * reflectance.at(l.wavelength_nm), ..*l }).collect(),
    }
}

struct ChartTexture {
    chart: Chart,
    palette: Palette,
    mean: SpectralPower,
    /// Spectrum of a perfect white on the chart.
    white: SpectralPower,
    peak_over_mean: f64,
    edge: Edge,
}

impl ChartTexture {
    fn new(chart: Chart, palette: Palette, spectra: &[SpectralPower], white: SpectralPower) -> Self {
        let mut areas = chart.areas().to_vec();
        // An ink too small to be counted may still be hit by rays: a tiny area keeps the density positive.
        areas.iter_mut().for_each(|a| *a = a.max(1e-6));
        let mean = palette.mean(&areas);
        let peak = spectra.iter().map(white::luminance_cd_m2).fold(0.0, f64::max);
        let average = white::luminance_cd_m2(&mean);
        let peak_over_mean = if average > 0.0 { peak / average } else { 1.0 };
        Self { chart, palette, mean, white, peak_over_mean, edge: Edge::Black }
    }

    /// Finds the inks at up to [`CHUNK`] points, also beyond the border.
    fn folded_ink(&self, x_mm: &[f64], y_mm: &[f64], inks: &mut [u16], isa: Isa) {
        let [x, y] = [(x_mm, self.chart.width_mm()), (y_mm, self.chart.height_mm())].map(|(places, side)| {
            let mut folded = [0.0_f64; CHUNK];
            for (out, at) in folded.iter_mut().zip(places) {
                *out = self.edge.place(at + 0.5 * side, side).map_or(f64::NAN, |at| at - 0.5 * side);
            }
            folded
        });
        self.chart.ink_at_batch(&x[..x_mm.len()], &y[..y_mm.len()], inks, isa);
    }
}

/// Number of points that are looked up together.
const CHUNK: usize = 256;

impl Texture for ChartTexture {
    fn shine(&self, at: Places<'_>, weight: &mut [f64], isa: Isa) {
        let mut inks = [0_u16; CHUNK];
        for start in (0..weight.len()).step_by(CHUNK) {
            let end = (start + CHUNK).min(weight.len());
            let inks = &mut inks[..end - start];
            let (x_mm, y_mm) = (&at.x_mm[start..end], &at.y_mm[start..end]);
            if self.edge == Edge::Black {
                self.chart.ink_at_batch(x_mm, y_mm, inks, isa);
            } else {
                self.folded_ink(x_mm, y_mm, inks, isa);
            }
            let part = Places { x_mm, y_mm, wavelength_nm: &at.wavelength_nm[start..end], line: &at.line[start..end] };
            isa.run(self.palette.shine(inks, part, &mut weight[start..end]));
        }
    }

    fn draw(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let (width, height) = (self.chart.width_mm(), self.chart.height_mm());
        ((u - 0.5) * width, (v - 0.5) * height, width * height)
    }

    fn is_bounded(&self) -> bool {
        self.edge == Edge::Black
    }

    fn spectrum(&self) -> &SpectralPower {
        &self.mean
    }

    fn white(&self) -> &SpectralPower {
        &self.white
    }

    fn peak_over_mean(&self) -> f64 {
        self.peak_over_mean
    }

    fn describe(&self) -> String {
        format!("chart {} ({:.1} x {:.1} mm)", self.chart.name(), self.chart.width_mm(), self.chart.height_mm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_patch_of_the_charts_has_a_measured_reflectance() {
        for (name, patch) in chart::PATCHES.into_iter().zip(spectra_spectrum::COLOR_CHECKER) {
            assert_eq!(column(name), format!("colorchecker#{patch}"));
            let measured = spectra_spectrum::find_reflectance(&column(name));
            assert!(measured.is_ok(), "{name}: {measured:?}");
        }
    }
}
