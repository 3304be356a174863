//! The keys of a surface in a lens file besides its shape, and the keys of a bend of the axis.

use crate::onion::OnionRingsForm;
use crate::separation::SeparationForm;
use crate::{AxisBreak, CoatingForm, Displacement, DustForm, HazeForm, ScratchesForm, aperture};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Angle, Deferred, Length, Positive, Ratio};

/// Longest length in a lens, mm: 1000 km. Anything longer is a typing mistake in the exponent.
const LONGEST_MM: f64 = 1e9;

/// The keys that every surface may have, whatever its kind; all other keys belong to the kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct SurfaceKeys {
    /// Distance to the next vertex along the axis (for the last surface, to the image plane), mm if bare: positive in
    /// the direction of the light before any mirror. 0 if absent.
    #[serde(default)]
    #[schemars(range(min = -LONGEST_MM, max = LONGEST_MM))]
    pub thickness: Option<Length>,
    /// Medium behind the surface: a name in the catalogue such as `SCHOTT/N-BK7`, `air`, or its `nd` and `vd`. If absent, air;
    /// behind a mirror or a stop, the medium in front of it.
    pub glass: Option<Deferred<GlassForm>>,
    /// Index at the reference line, 1 to 4, as the patent states it; the glass gives the dispersion.
    #[schemars(range(min = 1, max = 4))]
    pub nd: Option<f64>,
    /// Abbe number at the reference line, 5 to 200, as the patent states it.
    #[schemars(range(min = 5, max = 200))]
    pub vd: Option<f64>,
    /// Index at the e line, 1 to 4, instead of `nd`, whatever the reference line is.
    #[schemars(range(min = 1, max = 4))]
    pub ne: Option<f64>,
    /// Abbe number at the lines e, F' and C', 5 to 200, together with `ne`.
    #[schemars(range(min = 5, max = 200))]
    pub ve: Option<f64>,
    /// Clear semi-diameter, mm if bare, more than 0; clips nothing if absent.
    #[schemars(range(max = LONGEST_MM))]
    pub semi_diameter: Option<Positive<Length>>,
    /// Remark for the reader of the file; it has no effect.
    #[expect(dead_code, reason = "a remark is for the reader of the file")]
    pub remark: Option<String>,
    /// Semi-diameter of the edge of the element, mm if bare, for drawing; clips nothing. The clear semi-diameter if absent.
    pub outer_semi_diameter: Option<Positive<Length>>,
    /// Leg of the 45 degree chamfer at the edge, mm if bare: positive toward +z. None if absent.
    pub chamfer: Option<Length>,
    /// Further limits to the light: one aperture or a list; see its `shape`. None if absent.
    pub aperture: Option<Deferred<aperture::ApertureForm>>,
    /// Whether the surface is a mirror; it then has no glass of its own.
    #[serde(default)]
    pub mirror: bool,
    /// Whether this optical surface is the aperture stop.
    #[serde(default)]
    pub stop: bool,
    /// Shift of this surface alone along x and y, mm if bare; none if absent.
    pub decenter: Option<[Length; 2]>,
    /// Tilt of this surface alone about x, y and z, right-handed, degrees if bare; none if absent.
    pub tilt: Option<[Angle; 3]>,
    /// Whether the surface is reversed: turned by half a turn about its y axis.
    #[serde(default)]
    pub reversed: bool,
    /// Coating of this surface: `ideal`, `bare`, or a layer; the lens's if absent.
    pub coating: Option<Deferred<CoatingForm>>,
    /// Separated cement between two glasses, given by the width of the gap of air and how far it reaches in. None if absent.
    pub separation: Option<Deferred<SeparationForm>>,
    /// Haze on the surface: the fraction of the light that it scatters, and how wide; the lens's if absent.
    pub haze: Option<Deferred<HazeForm>>,
    /// Dust on the surface: the fraction that it covers, and the size of its grains; the lens's if absent.
    pub dust: Option<Deferred<DustForm>>,
    /// Scratches on the surface: the fraction that they cover or a drawing of them, and their width; the lens's if absent.
    pub scratches: Option<Deferred<ScratchesForm>>,
    /// Rings that turning left on the surface, given by their period and height: they show in out-of-focus highlights. None if absent.
    pub onion_rings: Option<Deferred<OnionRingsForm>>,
    /// Fraction of the light that a mirror reflects, 0 to 1; all of it if absent.
    #[schemars(range(min = 0, max = 1))]
    pub reflectance: Option<Ratio>,
}

/// The `kind` of an item that bends the axis and is not a surface.
pub(crate) const BREAK: &str = "coordinate-break";

/// A bend of the axis: everything that follows moves with it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct BreakParams {
    /// Shift of the axis along x and y, mm if bare; none if absent.
    decenter: Option<[Length; 2]>,
    /// Tilt of the axis about x, y and z, right-handed, degrees if bare; none if absent.
    tilt: Option<[Angle; 3]>,
    /// Order of the two: `decenter-first` (the default) or `tilt-first`.
    order: Option<Order>,
    /// Distance along the new axis to the next surface or bend, mm if bare; 0 if absent.
    thickness: Option<Length>,
}

/// The order of shift and tilt at a bend of the axis.
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

/// The forms in which a glass may be written.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `medium` reads it")]
pub(crate) enum GlassForm {
    /// A name in the catalogue, `air`, or the name of a glass file.
    Named(String),
    /// Index and Abbe number of the glass.
    Figures(Box<spectra_glass::file::Figures>),
    /// A glass written out with the keys of a glass file.
    Own(Box<spectra_glass::file::GlassFile>),
}
