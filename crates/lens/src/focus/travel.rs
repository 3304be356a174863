//! Moving groups by their laws.

use super::{FocusError, FocusLaw, GroupTravel};
use crate::Lens;
use spectra_core::surface::Action;
use std::ops::Range;

/// Steps of the search for the travel, a part of the focal length each, to both sides.
const STEP: f64 = 1.0 / 200.0;
/// Longest travel looked at, in focal lengths: twice is life size.
const FARTHEST: f64 = 3.0;
const HALVINGS: usize = 80;

impl Lens {
    /// Moves elements toward the object (negative: away) along their own axis, mm, and nothing else. To be followed by
    /// [`Lens::arrange`].
    pub(crate) fn shift_elements(&mut self, range: Range<usize>, toward_object_mm: f64) {
        if range.is_empty() {
            return;
        }
        if let Some(bend) = self.elements[range.start].breaks.last_mut().filter(|_| range.start > 0) {
            bend.thickness_mm -= toward_object_mm;
        } else if range.start > 0 {
            self.elements[range.start - 1].thickness_mm -= toward_object_mm;
        }
        self.elements[range.end - 1].thickness_mm += toward_object_mm;
    }

    /// The same lens with its groups moved on by a common travel, mm; as a whole where no group has a factor.
    ///
    /// # Errors
    /// [`FocusError::Collision`].
    pub(super) fn moved_on(&self, travel_mm: f64) -> Result<Self, FocusError> {
        let factor = |law: &FocusLaw| match law.travel {
            GroupTravel::Factor(factor) => Some((law.group, factor * travel_mm)),
            GroupTravel::Table(_) => None,
        };
        let shifts: Vec<_> = self.focus_laws.iter().filter_map(factor).collect();
        if shifts.is_empty() {
            return Ok(self.clone().with_image_gap_mm(self.image_gap_mm() + travel_mm));
        }
        self.with_groups_shifted(&shifts)
    }

    /// Whether some group moves in proportion to a common travel.
    pub(super) fn has_factors(&self) -> bool {
        self.focus_laws.iter().any(|law| matches!(law.travel, GroupTravel::Factor(_)))
    }

    fn with_groups_shifted(&self, shifts: &[(usize, f64)]) -> Result<Self, FocusError> {
        let mut lens = self.clone();
        for (group, shift_mm) in shifts {
            lens.shift_elements(self.groups[*group].elements.clone(), *shift_mm);
        }
        lens.arrange();
        // Behind a mirror the sign of a gap says nothing.
        if lens.elements.iter().all(|e| e.action != Action::Reflect) {
            for (group, _) in shifts {
                let range = &self.groups[*group].elements;
                let meets = |gap: usize| lens.gap_mm(gap) < 0.0 && self.gap_mm(gap) >= 0.0;
                let collision =
                    |surface| Err(FocusError::Collision { group: self.groups[*group].name.clone(), surface });
                if range.start > 0 && meets(range.start - 1) {
                    return collision(range.start);
                }
                if range.end < lens.elements.len() && meets(range.end - 1) {
                    return collision(range.end + 1);
                }
                if range.end == lens.elements.len() && lens.image_gap_mm() < 0.0 && self.image_gap_mm() >= 0.0 {
                    return collision(range.end + 1);
                }
            }
        }
        Ok(lens)
    }

    /// See [`Lens::focused_at`].
    pub(super) fn focused_by_laws(self, object_mm: f64) -> Result<Self, FocusError> {
        if object_mm <= 0.0 {
            return Err(FocusError::TooNear { nearest_mm: 0.0 });
        }
        let mut shifts = Vec::new();
        for law in &self.focus_laws {
            if let GroupTravel::Table(table) = &law.travel {
                let (nearest_mm, farthest_mm) = table.range_mm();
                let group = self.groups[law.group].name.clone();
                let beyond = FocusError::BeyondTable { group, nearest_mm, farthest_mm };
                shifts.push((law.group, table.shift_mm(object_mm).ok_or(beyond)?));
            }
        }
        let defocus =
            |lens: &Self, object_mm| lens.paraxial_image_gap_mm(object_mm, lens.reference_nm) - lens.image_gap_mm();
        let wanted = defocus(&self, f64::INFINITY);
        let set = self.with_groups_shifted(&shifts)?;
        if !set.has_factors() || object_mm == f64::INFINITY {
            return Ok(set);
        }
        let scale_mm = self.first_order(self.reference_nm).efl_mm.abs();
        let miss = |travel_mm: f64| {
            let lens = set.moved_on(travel_mm).ok()?;
            Some(defocus(&lens, object_mm) - wanted).filter(|miss| miss.is_finite())
        };
        // The nearest zero to either side.
        let mut ends = [(0.0, miss(0.0)), (0.0, miss(0.0))];
        let steps = (FARTHEST / STEP) as usize;
        for step in 1..=steps {
            for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                let Some(before) = end.1 else { continue };
                let next = sign * scale_mm * STEP * step as f64;
                let after = miss(next);
                // A pole changes the sign too, but is no zero: there the values are far from it.
                if after
                    .is_some_and(|after| (before <= 0.0) != (after <= 0.0) && (before - after).abs() < 2.0 * scale_mm)
                {
                    let (mut low, mut high) = (end.0, next);
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (low + high);
                        match miss(middle) {
                            Some(value) if (value <= 0.0) == (before <= 0.0) => low = middle,
                            Some(_) => high = middle,
                            None => break,
                        }
                    }
                    return set.moved_on(0.5 * (low + high));
                }
                *end = (next, after);
            }
        }
        Err(FocusError::NoTravel { object_mm })
    }
}
