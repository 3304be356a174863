//! A lens mounted the other way round.

use crate::pose::{AxisBreak, Displacement};
use crate::{Element, Lens};
use spectra_core::surface::Action;

/// Why a lens cannot be turned round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReverseError {
    /// It looks back to where its light comes from; turned round it has no front.
    #[error("a lens with an odd number of mirrors cannot be reversed: its image is on the object side")]
    OddMirrors,
    /// Its axis leaves a prism by another way than it enters.
    #[error("a lens with a prism cannot be reversed: write its file the other way round")]
    Prism,
}

/// Seen from the other side, half a turn about y away: right is left, front is rear.
fn turned(d: Displacement) -> Displacement {
    let ([x, y], [a, b, c]) = (d.decenter_mm, d.tilt_rad);
    Displacement { decenter_mm: [-x, y], tilt_rad: [-a, b, -c], ..d }
}

/// The way back, seen from the other side.
fn undone(d: Displacement) -> Displacement {
    let ([x, y], [a, b, c]) = (d.decenter_mm, d.tilt_rad);
    Displacement { decenter_mm: [x, -y], tilt_rad: [a, -b, c], tilt_first: !d.tilt_first }
}

impl Lens {
    /// The lens turned round by half a turn about its y axis: the last surface is the first. Its image plane stands where
    /// infinity is sharp by paraxial optics, or as far away as before where there is no such place behind it. It focuses
    /// as a whole, and bends of the axis in front of the image plane are gone.
    ///
    /// # Errors
    /// [`ReverseError`].
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
            // The way to the next one is the way that led here: bends and distances in the other order.
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
