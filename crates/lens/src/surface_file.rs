//! What a lens file states of one surface beside its shape, and of a bend of the axis.

use crate::onion::OnionRingsForm;
use crate::separation::SeparationForm;
use crate::{AxisBreak, CoatingForm, Displacement, DustForm, HazeForm, ScratchesForm, aperture};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Angle, Length, Part, Positive, Ratio};

/// Longer is no lens, but a slip of the exponent; 1000 km.
const LONGEST_MM: f64 = 1e9;

/// What every surface may state, whatever its kind; all other keys are the kind's own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Place {
    /// Distance to the next vertex along the axis (of the last surface, to the image plane), mm if bare: positive in
    /// the sense of the light before any mirror. 0 if absent.
    #[serde(default)]
    #[schemars(range(min = -LONGEST_MM, max = LONGEST_MM))]
    pub thickness: Option<Length>,
    /// Medium behind the surface: a name of the catalogue such as `SCHOTT/N-BK7`, `air`, or its `nd` and `vd`. Air if
    /// absent; behind a mirror or a stop, what is in front of it.
    pub glass: Option<Part<GlassForm>>,
    /// Index at the reference line, 1 to 4, as the patent states it; the glass gives the dispersion.
    #[schemars(range(min = 1, max = 4))]
    pub nd: Option<f64>,
    /// Abbe number at the reference line, 5 to 200, as the patent states it.
    #[schemars(range(min = 5, max = 200))]
    pub vd: Option<f64>,
    /// Index at the e line, 1 to 4, in place of `nd`, whatever the reference line is.
    #[schemars(range(min = 1, max = 4))]
    pub ne: Option<f64>,
    /// Abbe number at e, F' and C', 5 to 200, with `ne`.
    #[schemars(range(min = 5, max = 200))]
    pub ve: Option<f64>,
    /// Clear semi-diameter, mm if bare, more than 0; clips nothing if absent.
    #[schemars(range(max = LONGEST_MM))]
    pub semi_diameter: Option<Positive<Length>>,
    /// A word for people; read, and left to them.
    #[expect(dead_code, reason = "a remark is for the reader of the file")]
    pub remark: Option<String>,
    /// Edge of the element, mm if bare, for drawing; clips nothing. The semi-diameter if absent.
    pub outer_semi_diameter: Option<Positive<Length>>,
    /// Leg of the 45 degree chamfer at the edge, mm if bare: positive toward +z. None if absent.
    pub chamfer: Option<Length>,
    /// What else limits the light: one aperture or a list; see its `shape`. Nothing if absent.
    pub aperture: Option<Part<aperture::ApertureForm>>,
    /// Whether it reflects; then it has no glass of its own.
    #[serde(default)]
    pub mirror: bool,
    /// Whether this optical surface is the aperture stop.
    #[serde(default)]
    pub stop: bool,
    /// Shift of this surface alone along x and y, mm if bare; none if absent.
    pub decenter: Option<[Length; 2]>,
    /// Tilt of this surface alone about x, y and z, right-handed, degrees if bare; none if absent.
    pub tilt: Option<[Angle; 3]>,
    /// Whether it stands the other way round.
    #[serde(default)]
    pub reversed: bool,
    /// Its own coating: `ideal`, `bare`, or a layer; the lens's if absent.
    pub coating: Option<Part<CoatingForm>>,
    /// Where the cement between two glasses has come apart, by the width of the gap of air and how far it reaches in. Nowhere if absent.
    pub separation: Option<Part<SeparationForm>>,
    /// Haze on it: the share of the light that it scatters, and how wide; the lens's if absent.
    pub haze: Option<Part<HazeForm>>,
    /// Dust on it: the share that it covers, and how large its grains are; the lens's if absent.
    pub dust: Option<Part<DustForm>>,
    /// Scratches on it: the share that they cover or a drawing of them, and how wide they are; the lens's if absent.
    pub scratches: Option<Part<ScratchesForm>>,
    /// Rings that turning left on it, by their period and height: they show in highlights out of focus. None if absent.
    pub onion_rings: Option<Part<OnionRingsForm>>,
    /// Part of the light that a mirror reflects, 0 to 1; all of it if absent.
    #[schemars(range(min = 0, max = 1))]
    pub reflectance: Option<Ratio>,
}

/// The kind that bends the axis, and is no surface.
pub(crate) const BREAK: &str = "coordinate-break";

/// A bend of the axis.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct BreakParams {
    /// Shift of the axis along x and y, mm if bare; none if absent.
    decenter: Option<[Length; 2]>,
    /// Tilt of the axis about x, y and z, right-handed, degrees if bare; none if absent.
    tilt: Option<[Angle; 3]>,
    /// What comes first: `decenter-first` (the default) or `tilt-first`.
    order: Option<Order>,
    /// Distance to what follows, along the new axis, mm if bare; 0 if absent.
    thickness: Option<Length>,
}

/// What comes first at a bend of the axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Order {
    DecenterFirst,
    TiltFirst,
}

impl BreakParams {
    pub fn axis_break(&self) -> AxisBreak {
        let tilt_first = self.order == Some(Order::TiltFirst);
        let displacement = Displacement { tilt_first, ..displacement(self.decenter, self.tilt) };
        AxisBreak { displacement, thickness_mm: self.thickness.map_or(0.0, Length::mm) }
    }
}

pub(crate) fn displacement(decenter: Option<[Length; 2]>, tilt: Option<[Angle; 3]>) -> Displacement {
    Displacement {
        decenter_mm: decenter.map_or([0.0; 2], |d| d.map(Length::mm)),
        tilt_rad: tilt.map_or([0.0; 3], |t| t.map(Angle::rad)),
        tilt_first: false,
    }
}

/// What a glass is written as.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `medium` reads it")]
pub(crate) enum GlassForm {
    /// A name of the catalogue, `air`, or a glass file.
    Named(String),
    /// Its figures.
    Figures(Box<spectra_glass::file::Figures>),
    /// Written out with the keys of a glass file.
    Own(Box<spectra_glass::file::GlassFile>),
}
