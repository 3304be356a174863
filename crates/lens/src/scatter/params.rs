//! Reads haze, dust and scratches as lens files and scenes write them.

use super::{Layer, LayerKind, Lobe, Run};
use crate::aperture::{ApertureForm, read as read_apertures};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{sin, sin_cos_turns};
use spectra_core::params::{
    Angle, Deferred, Faults, Length, NonNegative, Params, Positive, Ratio, Readable, StageNode,
};
use spectra_core::resources::Resources;
use std::f64::consts::TAU;

/// Haze on a surface: fine droplets or grains, for example oil that has settled. It scatters a fraction of the light by Harvey and
/// Shack's function.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(inline)]
pub struct HazeForm {
    /// Fraction of the light that the haze scatters at each passage, 0 to 1.
    #[schemars(range(max = 1))]
    share: NonNegative<Ratio>,
    /// Angle up to which the scattered light is nearly uniform, degrees if bare, up to 60; small grains scatter wide. 1 degree if absent.
    #[schemars(range(max = 60))]
    shoulder: Option<Positive<Angle>>,
    /// Exponent by which the scattered light falls with the angle beyond the shoulder, -6 to 0; -2 if absent. -3 is the Henyey-Greenstein
    /// function.
    #[schemars(range(min = -6, max = 0))]
    slope: Option<f64>,
    /// Where the haze lies: one aperture or a list, written as in `aperture`. It covers what these let pass. All over the surface if
    /// absent.
    #[serde(rename = "where")]
    place: Option<Deferred<ApertureForm>>,
}

/// Dust on a surface: grains that stop as much light as they cover and diffract the same amount (Babinet's principle).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(inline)]
pub struct DustForm {
    /// Fraction of the surface that grains cover, 0 to 0.5.
    #[schemars(range(max = 0.5))]
    coverage: NonNegative<Ratio>,
    /// Median diameter of the grains, mm if bare, 1 um to 5 mm.
    #[schemars(range(min = 0.001, max = 5))]
    diameter: Positive<Length>,
    /// Standard deviation of the logarithm of the diameter, 0 to 2; 0.4 if absent. If all grains are alike (0), the pattern has rings.
    #[schemars(range(min = 0, max = 2))]
    spread: Option<f64>,
    /// Where the dust lies, written as for `haze`. All over the surface if absent.
    #[serde(rename = "where")]
    place: Option<Deferred<ApertureForm>>,
}

/// Scratches on a surface: lines that stop as much light as they cover and diffract the same amount to both sides (Babinet's principle).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(inline)]
pub struct ScratchesForm {
    /// Fraction of the surface that scratches cover, 0 to 0.5. With `where` it may be omitted: then half of the light that meets the drawn
    /// scratches is stopped and half of it is diffracted.
    #[schemars(range(max = 0.5))]
    coverage: Option<NonNegative<Ratio>>,
    /// Width of a scratch, mm if bare, 1 um to 5 mm.
    #[schemars(range(min = 0.001, max = 5))]
    width: Positive<Length>,
    /// Direction in which the scratches run, degrees if bare, counterclockwise from x. All directions are equally likely if absent.
    direction: Option<Angle>,
    /// Whether the scratches run around the axis, as left by a turning cloth.
    #[serde(default)]
    around: bool,
    /// Where the scratches are, written as for `haze`: a drawing (SVG) or a picture of them. All over the surface if absent.
    #[serde(rename = "where")]
    place: Option<Deferred<ApertureForm>>,
}

const SHOULDER_DEG: f64 = 1.0;
const SLOPE: f64 = -2.0;
const SPREAD: f64 = 0.4;
/// By Babinet's principle an opaque body removes twice the light that falls on it: it stops half and diffracts half.
const MOST_COVERED: f64 = 0.5;
const NM_PER_MM: f64 = 1e6;

fn parsed<T: Readable>(node: &StageNode) -> Result<(Params, T), Faults> {
    let params = Params::section(node.node().clone(), node.path())?;
    let own = params.parse()?;
    Ok((params, own))
}

fn places(place: Option<&Deferred<ApertureForm>>, resources: &dyn Resources) -> Result<Vec<crate::Aperture>, Faults> {
    place.map_or(Ok(Vec::new()), |node| read_apertures(node, resources))
}

/// Reads a layer of haze.
fn haze(node: &StageNode, resources: &dyn Resources) -> Result<Layer, Faults> {
    let (_, p) = parsed::<HazeForm>(node)?;
    let shoulder = sin(p.shoulder.map_or(SHOULDER_DEG.to_radians(), |angle| angle.rad()));
    Ok(Layer {
        soil: LayerKind::Haze,
        stopped: 0.0,
        scattered: p.share.number(),
        places: places(p.place.as_ref(), resources)?,
        lobe: Lobe::Harvey { shoulder, slope: p.slope.unwrap_or(SLOPE) },
    })
}

/// Reads a layer of dust.
fn dust(node: &StageNode, resources: &dyn Resources) -> Result<Layer, Faults> {
    let (_, p) = parsed::<DustForm>(node)?;
    Ok(Layer {
        soil: LayerKind::Dust,
        stopped: p.coverage.number(),
        scattered: p.coverage.number(),
        places: places(p.place.as_ref(), resources)?,
        lobe: Lobe::disks(NM_PER_MM * p.diameter.mm(), p.spread.unwrap_or(SPREAD)),
    })
}

/// Reads a layer of scratches.
fn scratches(node: &StageNode, resources: &dyn Resources) -> Result<Layer, Faults> {
    let (params, p) = parsed::<ScratchesForm>(node)?;
    let coverage = match (p.coverage, &p.place) {
        (Some(coverage), _) => coverage.number(),
        (None, Some(_)) => MOST_COVERED,
        (None, None) => {
            let fault = params.fault_here("how many scratches are there? `coverage` or `where` is missing");
            return Err(fault.hint("add `coverage: 1 %`, or `where: {shape: mask, file: scratches.svg}`").into());
        }
    };
    let run = match (p.direction, p.around) {
        (Some(_), true) => {
            let fault = params.fault("direction", "scratches that run `around` have no `direction`");
            return Err(fault.hint("leave one of them out").into());
        }
        (Some(direction), false) => {
            let turns = direction.rad() / TAU;
            let (sin, cos) = sin_cos_turns(turns - turns.floor());
            Run::Along([cos, sin])
        }
        (None, true) => Run::Around,
        (None, false) => Run::Any,
    };
    Ok(Layer {
        soil: LayerKind::Scratches,
        stopped: coverage,
        scattered: coverage,
        places: places(p.place.as_ref(), resources)?,
        lobe: Lobe::lines(NM_PER_MM * p.width.mm(), run),
    })
}

/// Reads the layers of haze, dust and scratches from those nodes that are given, in this order. Faults are added to `faults`.
pub fn read_layers(
    [haze_form, dust_form, scratches_form]: [Option<&StageNode>; 3],
    resources: &dyn Resources,
    faults: &mut Faults,
) -> Vec<Layer> {
    let all = [
        haze_form.map(|node| haze(node, resources)),
        dust_form.map(|node| dust(node, resources)),
        scratches_form.map(|node| scratches(node, resources)),
    ];
    all.into_iter().flatten().filter_map(|layer| faults.take(layer)).collect()
}
