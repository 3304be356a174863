//! Width of a flat source, light beyond its border, and whether the source fills the frame.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame_view::{FrameView, SightLine};
use spectra_core::params::{Fault, Length, Node, Params, Positive, Value};
use spectra_core::registry::Context;

/// Factor by which `width: fill` makes a source larger than the part that the frame sees. The frame is probed at some points
/// only, and no border may show between them.
const MARGIN: f64 = 1.02;
/// Largest angle, degrees, under which a flat picture is seen without a warning. Beyond it, stretched borders fill most of the
/// frame.
const WIDEST_DEG: f64 = 130.0;
/// Fraction of the frame that may lie outside the source without a warning.
const NOTHING: f64 = 0.01;

/// `width` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Width {
    /// The word `fill`: as wide as the frame sees at that distance.
    Fill(FillWord),
    /// A width, mm if bare.
    Width(Positive<Length>),
}

/// The word `fill`, as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FillWord {
    /// The word `fill`: as wide as the frame sees at that distance.
    Fill,
}

impl Width {
    /// Returns the width, in mm, of a picture whose width is `aspect` times its height. The center of the picture is at
    /// `center_mm` on the plane `distance_mm` in front of the first vertex. A picture that fills the frame covers 2 % more than
    /// the frame sees on that plane. What the frame sees is found with real rays through the whole opening of the lens. Without a
    /// lens, the picture is as wide as it is distant. Fails if no plane fills the frame.
    pub(crate) fn mm(
        &self,
        aspect: f64,
        distance_mm: f64,
        center_mm: [f64; 2],
        view: Option<&FrameView>,
        params: &Params,
    ) -> Result<f64, Fault> {
        match self {
            Self::Width(width) => Ok(width.mm()),
            Self::Fill(_) => match view {
                None => Ok(distance_mm),
                Some(view) => needed_mm(view, aspect, distance_mm, center_mm).ok_or_else(|| {
                    params
                        .fault("width", "this lens is turned too far to the side: no plane fills its frame")
                        .hint("write a width, such as `5 m`")
                }),
            },
        }
    }

    pub(crate) fn is_fill(&self) -> bool {
        matches!(self, Self::Fill(_))
    }
}

/// Returns the width that fills the frame, mm; `None` if no plane does.
pub(crate) fn needed_mm(view: &FrameView, aspect: f64, distance_mm: f64, center_mm: [f64; 2]) -> Option<f64> {
    let [x, y] = view.half_size_mm(distance_mm, center_mm)?;
    Some(2.0 * MARGIN * x.max(y * aspect)).filter(|mm| *mm > 0.0)
}

/// The light beyond the border of a flat source.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub(crate) enum Edge {
    /// No light beyond the border.
    #[default]
    Black,
    /// The light at the nearest point of the border.
    Clamp,
    /// The source mirrored at its borders, repeatedly.
    Mirror,
}

impl Edge {
    /// Maps a position along a side of length `size` into 0 to `size`; `None` if there is no light at that position.
    pub(crate) fn place(self, at: f64, size: f64) -> Option<f64> {
        if at >= 0.0 && at <= size {
            return Some(at);
        }
        match self {
            Self::Clamp if !at.is_nan() => Some(at.clamp(0.0, size)),
            Self::Mirror if at.is_finite() => {
                let folded = at.rem_euclid(2.0 * size);
                Some(if folded > size { 2.0 * size - folded } else { folded })
            }
            _ => None,
        }
    }
}

/// Size and position of a flat source on its plane.
pub(crate) struct PlanePlacement {
    pub width_mm: f64,
    pub height_mm: f64,
    pub distance_mm: f64,
    pub center_mm: [f64; 2],
}

impl PlanePlacement {
    fn holds(&self, sight: &SightLine) -> bool {
        let [x, y] = sight.at_mm(self.distance_mm);
        (x - self.center_mm[0]).abs() <= 0.5 * self.width_mm && (y - self.center_mm[1]).abs() <= 0.5 * self.height_mm
    }

    /// Warns if the lens sees too wide an angle for a flat picture, as a fisheye does.
    pub(crate) fn warn_of_fisheye(&self, what: &str, params: &Params, context: &Context<'_>) {
        let half = context.view.and_then(|view| view.half_size_mm(self.distance_mm, self.center_mm));
        let Some([x, y]) = half else { return };
        let corner = (x * x + y * y).sqrt();
        let seen = 2.0 * spectra_core::math::atan2(corner, self.distance_mm).to_degrees();
        if seen <= WIDEST_DEG {
            return;
        }
        let text = format!(
            "this lens sees {seen:.0} degrees from corner to corner: {what} is {} wide to fill the frame, whose center shows only a small part of it",
            length(self.width_mm)
        );
        let hint = format!(
            "for a flat picture use a lens of less than {WIDEST_DEG:.0} degrees; `spectra list lens` lists all lenses"
        );
        context.warn(params.fault("width", text).hint(hint));
    }

    /// Warns if part of the frame lies outside a source whose border is not marked as intended. `what` names the source, such
    /// as `the picture`.
    pub(crate) fn warn_unless_filled(&self, what: &str, params: &Params, context: &Context<'_>) {
        let Some(view) = context.view else { return };
        let Some(missed) = view.share_missed(|sight| self.holds(sight)).filter(|missed| *missed >= NOTHING) else {
            return;
        };
        let aspect = self.width_mm / self.height_mm;
        let Some(needed_mm) = needed_mm(view, aspect, self.distance_mm, self.center_mm) else { return };
        let text = format!("the frame is not filled: {:.0} % of it lies outside {what}", (100.0 * missed).max(1.0));
        let hint = match bare(params.get("width")) {
            // Someone wrote 1.5 for 1.5 m, but a bare number is in mm.
            Some(mm) if (0.2..5.0).contains(&(1000.0 * mm / needed_mm)) => {
                format!("{mm} mm wide: did you mean `{mm} m`? Or `width: fill`")
            }
            _ => format!("`width: fill`, or at least {}; `edge: black` if the border is intended", length(needed_mm)),
        };
        context.warn(params.fault("width", text).hint(hint));
    }
}

/// Returns a number that was written without a unit; `None` for anything else.
fn bare(node: Option<&Node>) -> Option<f64> {
    match node.map(|node| &node.value) {
        Some(Value::Number(number)) => Some(number.value),
        _ => None,
    }
}

/// Formats a length as a person would write it, rounded up to two or three digits.
fn length(mm: f64) -> String {
    let (value, unit) = match mm {
        mm if mm >= 1e6 => (mm / 1e6, "km"),
        mm if mm >= 1000.0 => (mm / 1000.0, "m"),
        mm if mm >= 1.0 => (mm, "mm"),
        mm => (mm * 1000.0, "um"),
    };
    let step = if value >= 100.0 {
        10.0
    } else if value >= 10.0 {
        1.0
    } else {
        0.1
    };
    let value = (value / step).ceil() * step;
    if step < 1.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_the_border_is_what_the_edge_says() {
        assert_eq!((Edge::Black.place(-0.1, 4.0), Edge::Black.place(4.0, 4.0)), (None, Some(4.0)));
        assert_eq!((Edge::Clamp.place(-3.0, 4.0), Edge::Clamp.place(9.0, 4.0)), (Some(0.0), Some(4.0)));
        let mirrored: Vec<_> = [-1.0, 5.0, 9.0, -9.0].iter().map(|at| Edge::Mirror.place(*at, 4.0)).collect();
        assert_eq!(mirrored, [Some(1.0), Some(3.0), Some(1.0), Some(1.0)]);
        for edge in [Edge::Black, Edge::Clamp, Edge::Mirror] {
            assert_eq!(edge.place(f64::NAN, 4.0), None);
        }
    }

    #[test]
    fn lengths_are_written_to_be_typed_and_never_too_small() {
        for (mm, written) in
            [(1831.0, "1.9 m"), (12_345.0, "13 m"), (187.2, "190 mm"), (0.02, "20 um"), (3.0, "3.0 mm")]
        {
            assert_eq!(length(mm), written);
        }
    }
}
