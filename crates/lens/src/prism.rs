//! `kind: prism` in a lens file: a solid instead of a surface.

use crate::Solid;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math;
use spectra_core::params::{Angle, Faults, Length, Params, Positive, Whole};

/// The `kind` of an element that is a solid and not a surface.
pub(crate) const PRISM: &str = "prism";

/// A prism: a solid with flat faces, in which light goes to the nearest face and is reflected totally where it must be.
///
/// Its outline is given by `apex` and `side`, or by `corners`. Everything behind the prism is placed on the axis where it leaves, at the
/// reference line, so no angle has to be computed. `glass` is that of the prism; the medium in front of the prism continues behind it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct PrismParams {
    /// Angle between the two faces that the light passes, degrees if bare, more than 0, less than 180. With `side`.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    apex: Option<Angle>,
    /// Length of each of these two faces, mm if bare; the axis meets the middle of the first.
    side: Option<Positive<Length>>,
    /// Angle of incidence of the axis on the first face, degrees if bare, between -90 and 90. The angle of least deviation if absent.
    #[schemars(extend("exclusiveMinimum" = -90, "exclusiveMaximum" = 90))]
    incidence: Option<Angle>,
    /// Corners of the outline, in order, each [y, z] in mm. z runs along the axis from the point to which the thickness in front leads; y
    /// is up.
    #[schemars(length(min = 3, max = 64))]
    corners: Option<Vec<[Length; 2]>>,
    /// Full width along x, mm if bare; the end faces are ground black. The prism has no ends if absent.
    width: Option<Positive<Length>>,
    /// Numbers of the silvered faces: the first runs from the first corner to the second. None if absent.
    #[serde(default)]
    silvered: Vec<Whole<1, 64>>,
}

/// Keys of surfaces that a prism does not have.
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

/// Reports a fault for each key that a prism does not have.
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
    /// Builds the prism from a glass whose index is `index` times that of the surrounding medium.
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
                    return Err(fault.hint("choose a smaller angle, or set `incidence: ...` for a reflection").into());
                }
                let incidence_rad = self.incidence.map_or_else(|| math::asin(least), Angle::rad);
                (Solid::of_apex(apex_rad, side.mm(), incidence_rad), "apex")
            }
            (None, None, Some(corners)) if self.incidence.is_none() => {
                (corners.iter().map(|corner| corner.map(Length::mm)).collect(), "corners")
            }
            _ => {
                let fault =
                    params.fault_here("a prism needs `apex` and `side`, perhaps with `incidence`, or else `corners`");
                let hint = "such as `apex: 60 deg, side: 30 mm`, or `corners: [[-15, 0], [15, 0], [0, 15]]`";
                return Err(fault.hint(hint).into());
            }
        };
        let faces = corners.len();
        let silvered: Vec<usize> = self.silvered.iter().map(|face| face.size() - 1).collect();
        if let Some(face) = silvered.iter().find(|face| **face >= faces) {
            let fault = params.fault("silvered", format!("the prism has {faces} faces, there is no face {}", face + 1));
            return Err(fault.hint(format!("write numbers from 1 to {faces}")).into());
        }
        let half_width_mm = self.width.map_or(f64::INFINITY, |width| 0.5 * width.mm());
        Solid::new(corners, &silvered, half_width_mm, medium, index).map_err(|error| {
            let hint = "`corners` are [y, z] in mm, in order around the outline; faces that light meets too steeply to be reflected \
                        totally may be `silvered`";
            params.fault(key, error.to_string()).hint(hint).into()
        })
    }
}
