//! Moves groups by their focusing laws and searches for the travel that focuses.

use super::{FocusError, FocusLaw, GroupTravel};
use crate::Lens;
use crate::first_order::Section;
use spectra_core::surface::Action;
use std::ops::Range;

/// Step of the search for the travel, to both sides, as a fraction of the focal length.
const STEP: f64 = 1.0 / 200.0;
/// Longest travel that is searched, in focal lengths: twice the travel of life size.
const FARTHEST: f64 = 3.0;
const HALVINGS: usize = 80;
/// Largest number of rounds in which two sections are focused one after the other. Both must come within [`STANDS_MM`].
const TURNS: usize = 40;
const STANDS_MM: f64 = 1e-7;

impl Lens {
    /// Moves elements toward the object (negative: away) along their own axis, by a distance in mm, and nothing else. The caller
    /// must then call [`Lens::arrange`].
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

    /// Returns the lens with its groups moved by their factors times the common travel `travel_mm`. If no group has a factor, the
    /// whole lens moves.
    ///
    /// # Errors
    /// [`FocusError::Collision`] if a group would run into its neighbor.
    pub fn moved_on(&self, travel_mm: f64) -> Result<Self, FocusError> {
        let factor = |law: &FocusLaw| match law.travel {
            GroupTravel::Factor(factor) => Some((law.group, factor * travel_mm)),
            GroupTravel::Table(_) | GroupTravel::SectionX => None,
        };
        let shifts: Vec<_> = self.focus_laws.iter().filter_map(factor).collect();
        if shifts.is_empty() {
            return Ok(self.clone().with_image_gap_mm(self.image_gap_mm() + travel_mm));
        }
        self.with_groups_shifted(&shifts)
    }

    /// Returns whether a group moves in proportion to a common travel.
    pub fn has_factors(&self) -> bool {
        self.focus_laws.iter().any(|law| matches!(law.travel, GroupTravel::Factor(_)))
    }

    /// Lists the groups that follow the x-z section.
    fn follows_across(&self) -> impl Iterator<Item = usize> {
        self.focus_laws.iter().filter(|law| law.travel == GroupTravel::SectionX).map(|law| law.group)
    }

    fn with_groups_shifted(&self, shifts: &[(usize, f64)]) -> Result<Self, FocusError> {
        let mut lens = self.clone();
        for (group, shift_mm) in shifts {
            lens.shift_elements(self.groups[*group].elements.clone(), *shift_mm);
        }
        lens.arrange();
        // Behind a mirror the sign of a gap does not reveal a collision.
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

    /// Focuses the lens by its focusing laws; see [`Lens::focused_at`].
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
        let defocus = |lens: &Self, section, object_mm| {
            lens.paraxial_image_gap_in_mm(section, object_mm, lens.reference_nm) - lens.image_gap_mm()
        };
        let wanted = [Section::Y, Section::X].map(|section| defocus(&self, section, f64::INFINITY));
        let set = self.with_groups_shifted(&shifts)?;
        let across: Vec<usize> = set.follows_across().collect();
        if (!set.has_factors() && across.is_empty()) || object_mm == f64::INFINITY {
            return Ok(set);
        }
        let none = FocusError::NoTravel { object_mm };
        let along = |lens: &Self| defocus(lens, Section::Y, object_mm) - wanted[0];
        let mut lens =
            set.nearest_zero(|lens, travel_mm| lens.moved_on(travel_mm), along).ok_or_else(|| none.clone())?;
        if across.is_empty() {
            return Ok(lens);
        }
        // Focusing one section moves the other a little, so they take turns until both are in focus.
        let aside = |lens: &Self| defocus(lens, Section::X, object_mm) - wanted[1];
        let shifted = |lens: &Self, travel_mm: f64| {
            lens.with_groups_shifted(&across.iter().map(|group| (*group, travel_mm)).collect::<Vec<_>>())
        };
        for _ in 0..TURNS {
            lens = lens.nearest_zero(shifted, aside).ok_or_else(|| none.clone())?;
            if along(&lens).abs() < STANDS_MM {
                return Ok(lens);
            }
            lens = lens.nearest_zero(|lens, travel_mm| lens.moved_on(travel_mm), along).ok_or_else(|| none.clone())?;
        }
        Err(none)
    }

    /// Moves the lens to the nearest travel, to either side, at which `miss` is zero; `None` if there is none.
    fn nearest_zero(
        &self,
        moved: impl Fn(&Self, f64) -> Result<Self, FocusError>,
        miss: impl Fn(&Self) -> f64,
    ) -> Option<Self> {
        let scale_mm = self.first_order(self.reference_nm).efl_mm.abs();
        let miss = |travel_mm: f64| {
            let lens = moved(self, travel_mm).ok()?;
            Some(miss(&lens)).filter(|miss| miss.is_finite())
        };
        let mut ends = [(0.0, miss(0.0)), (0.0, miss(0.0))];
        let steps = (FARTHEST / STEP) as usize;
        for step in 1..=steps {
            for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                let Some(before) = end.1 else { continue };
                let next = sign * scale_mm * STEP * step as f64;
                let after = miss(next);
                // A pole changes the sign, too, but is no zero: near a pole the values are large.
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
                    return moved(self, 0.5 * (low + high)).ok();
                }
                *end = (next, after);
            }
        }
        None
    }
}
