//! Reverses a lens, as mounted the other way round.

use crate::pose::{AxisBreak, Displacement};
use crate::{Element, Lens};
use spectra_core::surface::Action;

/// The reason why a lens cannot be reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReverseError {
    /// The lens has an odd number of mirrors and sends light back to the object side, so it has no front when reversed.
    #[error("a lens with an odd number of mirrors cannot be reversed: its image is on the object side")]
    OddMirrors,
    /// The lens has a prism, whose axis enters and leaves by different faces.
    #[error("a lens with a prism cannot be reversed: write its file the other way round")]
    Prism,
}

/// Converts a displacement to the frame turned by half a turn about y, in which right is left and front is rear.
fn turned(d: Displacement) -> Displacement {
    let ([x, y], [a, b, c]) = (d.decenter_mm, d.tilt_rad);
    Displacement { decenter_mm: [-x, y], tilt_rad: [-a, b, -c], ..d }
}

/// Returns the inverse of a displacement, seen from the other side.
fn undone(d: Displacement) -> Displacement {
    let ([x, y], [a, b, c]) = (d.decenter_mm, d.tilt_rad);
    Displacement { decenter_mm: [x, -y], tilt_rad: [a, -b, c], tilt_first: !d.tilt_first }
}

impl Lens {
    /// Returns the lens turned by half a turn about its y axis, so that the last surface is the first. The image plane is placed
    /// at the paraxial focus for infinity. If that focus does not lie behind the lens, the image distance stays as before. The
    /// reversed lens focuses as a whole, and bends of the axis in front of the image plane are removed.
    ///
    /// # Errors
    /// [`ReverseError`] if the lens has an odd number of mirrors or a prism.
    pub fn reversed(&self) -> Result<Self, ReverseError> {
        if self.elements.iter().filter(|e| e.action == Action::Reflect).count() % 2 == 1 {
            return Err(ReverseError::OddMirrors);
        }
        if self.elements.iter().any(|e| e.solid.is_some()) {
            return Err(ReverseError::Prism);
        }
        let count = self.elements.len();
        let mut elements: Vec<Element> = self.elements.iter().rev().cloned().collect();
        for (at, e) in elements.iter_mut().enumerate() {
            e.reversed = !e.reversed;
            e.displacement = turned(e.displacement);
            std::mem::swap(&mut e.medium_before, &mut e.medium_after);
            e.breaks.clear();
            if at + 1 == count {
                continue;
            }
            // The path to the next element is the path that led here, with bends and distances in reverse order.
            let here = &self.elements[count - 1 - at];
            e.thickness_mm = here.breaks.last().map_or(self.elements[count - 2 - at].thickness_mm, |b| b.thickness_mm);
        }
        for at in 1..count {
            let (behind, ahead) = (&self.elements[count - at], &self.elements[count - 1 - at]);
            elements[at].breaks = (0..behind.breaks.len())
                .rev()
                .map(|k| AxisBreak {
                    displacement: undone(behind.breaks[k].displacement),
                    thickness_mm: if k > 0 { behind.breaks[k - 1].thickness_mm } else { ahead.thickness_mm },
                })
                .collect();
        }
        let mut groups = self.groups.clone();
        for group in &mut groups {
            group.elements = count - group.elements.end..count - group.elements.start;
            group.about = count - 1 - group.about;
            group.displacement = turned(group.displacement);
        }
        let mut lens = Self {
            name: format!("{}, reversed", self.name),
            elements,
            groups,
            image_breaks: Vec::new(),
            focus_laws: Vec::new(),
            focused_mm: f64::INFINITY,
            ..self.clone()
        };
        lens.arrange();
        let focus_mm = lens.paraxial_image_gap_mm(f64::INFINITY, lens.reference_nm);
        let image_mm = if focus_mm.is_finite() && focus_mm > 0.0 { focus_mm } else { self.image_gap_mm() };
        Ok(lens.with_image_gap_mm(image_mm))
    }
}
