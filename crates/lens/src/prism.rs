//! `kind: prism` in a lens file.

use crate::Solid;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math;
use spectra_core::params::{Angle, Faults, Length, Params, Positive, Whole};

/// The kind that is a solid, and no surface.
pub(crate) const PRISM: &str = "prism";

/// A prism: a solid of flat faces that light passes by the nearest one, reflected totally where it must be.
///
/// By `apex` and `side`, or by `corners`. What follows stands on the axis where it leaves the prism, at the reference line: no angle has to
/// be worked out. `glass` is that of the prism; what is in front of it continues behind it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct PrismParams {
    /// Angle between the two faces that the light passes, degrees if bare, more than 0, less than 180. With `side`.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    apex: Option<Angle>,
    /// Length of each of these faces, mm if bare; the axis meets the middle of the first.
    side: Option<Positive<Length>>,
    /// Angle of incidence of the axis on the first face, degrees if bare, between -90 and 90; that of least deviation if absent.
    #[schemars(extend("exclusiveMinimum" = -90, "exclusiveMaximum" = 90))]
    incidence: Option<Angle>,
    /// Corners of the outline, in order, each [y, z] in mm: z along the axis from the place where the thickness in front leads to, y up.
    #[schemars(length(min = 3, max = 64))]
    corners: Option<Vec<[Length; 2]>>,
    /// Full width along x, mm if bare; its sides are ground black. It ends nowhere if absent.
    width: Option<Positive<Length>>,
    /// Faces that are silvered, by number: the first runs from the first corner to the second. None if absent.
    #[serde(default)]
    silvered: Vec<Whole<1, 64>>,
}

/// Keys of surfaces that a prism has not.
const NOT_OF_A_PRISM: [&str; 12] = [
    "semi-diameter",
    "outer-semi-diameter",
    "chamfer",
    "aperture",
    "mirror",
    "stop",
    "reversed",
    "haze",
    "dust",
    "scratches",
    "onion-rings",
    "separation",
];

/// Faults of keys that a prism has not.
pub(crate) fn misplaced(place: &Params) -> Faults {
    let mut faults = Faults::new();
    for key in NOT_OF_A_PRISM.iter().filter(|key| place.get(key).is_some()) {
        let fault = place.fault(key, format!("a prism has no `{key}`"));
        faults.push(
            fault.hint("its corners and its `width` say where it ends; `silvered: [2]` makes its second face a mirror"),
        );
    }
    faults
}

impl PrismParams {
    /// The prism, of a glass whose index is so many times that of what is around it.
    pub(crate) fn solid(&self, params: &Params, medium: usize, index: f64) -> Result<Solid, Faults> {
        let (corners, key) = match (self.apex, self.side, &self.corners) {
            (Some(apex), Some(side), None) => {
                let apex_rad = apex.rad();
                let least = index * math::sin(0.5 * apex_rad);
                if self.incidence.is_none() && !(least < 1.0) {
                    let fault = params.fault(
                        "apex",
                        "no light along the axis passes both sides: the apex is too large for this glass",
                    );
                    return Err(fault.hint("a smaller angle, or `incidence: ...` where it is to be reflected").into());
                }
                let incidence_rad = self.incidence.map_or_else(|| math::asin(least), Angle::rad);
                (Solid::of_apex(apex_rad, side.mm(), incidence_rad), "apex")
            }
            (None, None, Some(corners)) if self.incidence.is_none() => {
                (corners.iter().map(|corner| corner.map(Length::mm)).collect(), "corners")
            }
            _ => {
                let fault =
                    params.fault_here("a prism has `apex` and `side`, perhaps with `incidence`, or else `corners`");
                let hint = "such as `apex: 60 deg, side: 30 mm`, or `corners: [[-15, 0], [15, 0], [0, 15]]`";
                return Err(fault.hint(hint).into());
            }
        };
        let faces = corners.len();
        let silvered: Vec<usize> = self.silvered.iter().map(|face| face.size() - 1).collect();
        if let Some(face) = silvered.iter().find(|face| **face >= faces) {
            let fault = params.fault("silvered", format!("the prism has {faces} faces, there is no face {}", face + 1));
            return Err(fault.hint(format!("numbers from 1 to {faces}")).into());
        }
        let half_width_mm = self.width.map_or(f64::INFINITY, |width| 0.5 * width.mm());
        Solid::new(corners, &silvered, half_width_mm, medium, index).map_err(|error| {
            let hint = "`corners` are [y, z] in mm, in order around the outline; faces that light meets too steeply to be reflected \
                        totally may be `silvered`";
            params.fault(key, error.to_string()).hint(hint).into()
        })
    }
}
