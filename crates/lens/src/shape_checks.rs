//! Signs of typing mistakes in the shape of a lens: surfaces that pass through each other, an image that cannot be recorded.

use crate::{Element, Lens};
use spectra_core::surface::Action;

/// Number of steps from the axis to the rim in the search for a crossing.
const STEPS: usize = 64;
/// Number of halvings of the step in which two surfaces cross.
const HALVINGS: usize = 40;
/// Surfaces may meet at their very rims, beyond this fraction of the semi-diameter. Published semi-diameters are rounded up
/// (those of three library lenses by 2 to 3 %), and edges that touch are ground.
const RIM: f64 = 0.95;
/// Tolerance for comparing gaps, mm.
const TOUCH_MM: f64 = 1e-6;

impl Lens {
    /// Returns a warning, with a hint, for each sign of a mistake in the prescription. One sign is neighbors that meet within
    /// their clear semi-diameters. Others are an image of distant objects in front of the last surface or of the whole lens, and
    /// a mirror that sends light away from the next surface. Lenses with a bent axis are not checked, and lenses with mirrors
    /// only for the last sign.
    #[must_use]
    pub fn prescription_warnings(&self) -> Vec<String> {
        let straight = |e: &Element| {
            let pose = if e.reversed { e.pose.reversed() } else { e.pose };
            e.action != Action::Reflect && pose.is_on_axis()
        };
        if !self.image_pose.is_on_axis() && !self.image_pose.facing_back().is_on_axis() {
            return Vec::new();
        }
        if !self.elements.iter().all(straight) {
            return self.behind_mirrors();
        }
        let mut all = Vec::new();
        let solid: Vec<usize> = (0..self.elements.len()).filter(|i| self.elements[*i].action != Action::Pass).collect();
        for pair in solid.windows(2) {
            if let Some(r) = self.meeting_mm(pair[0], pair[1]) {
                all.push(format!(
                    "surfaces {} and {} meet {r:.2} mm from the axis, within their clear semi-diameters: is a thickness, a \
                     radius or its sign wrong, or a semi-diameter too large?",
                    pair[0] + 1,
                    pair[1] + 1
                ));
            }
        }
        let first_order = self.first_order(self.reference_nm);
        let (efl, bfl) = (first_order.efl_mm, first_order.bfl_mm);
        if efl.is_finite() && bfl.is_finite() && efl > 0.0 && bfl < 0.0 {
            all.push(format!(
                "the image of distant objects lies {:.2} mm in front of the last surface: does a radius have the wrong sign?",
                -bfl
            ));
        }
        if efl.is_finite() && efl < 0.0 {
            all.push(format!(
                 "the lens spreads light (focal length {efl:.2} mm), so no image of distant objects falls on film: do all radii follow \
                  the opposite sign convention?"
            ));
        }
        all
    }

    /// Warns of surfaces that the light from a mirror runs away from, if all surfaces lie on one axis.
    fn behind_mirrors(&self) -> Vec<String> {
        let on_axis = |e: &Element| e.solid.is_none() && (e.pose.is_on_axis() || e.pose.reversed().is_on_axis());
        if !self.elements.iter().all(on_axis) {
            return Vec::new();
        }
        let solid = self.elements.iter().enumerate().filter(|(_, e)| e.action != Action::Pass);
        let mut places: Vec<(usize, bool, f64)> =
            solid.map(|(at, e)| (at + 1, e.action == Action::Reflect, e.vertex_z_mm())).collect();
        places.push((self.elements.len() + 1, false, self.image_z_mm()));
        let mut along = 1.0;
        let mut all = Vec::new();
        for pair in places.windows(2) {
            let ((at, mirror, z), (_, _, next_z)) = (pair[0], pair[1]);
            along *= if mirror { -1.0 } else { 1.0 };
            let gap = next_z - z;
            if mirror && gap * along < -TOUCH_MM {
                all.push(format!(
                    "the mirror of surface {at} sends light toward {}z, away from what comes next: is its thickness {:.2} mm?",
                    if along < 0.0 { "-" } else { "+" },
                    -gap
                ));
            }
        }
        all
    }

    /// Finds the distance from the axis at which two surfaces meet within the clear semi-diameters of both, mm; `None` if they do not.
    fn meeting_mm(&self, front: usize, rear: usize) -> Option<f64> {
        let (front, rear) = (&self.elements[front], &self.elements[rear]);
        let rim = match (front.semi_diameter_mm, rear.semi_diameter_mm) {
            (Some(a), Some(b)) => RIM * a.min(b),
            (one, other) => RIM * one.or(other)?,
        };
        let z = |e: &Element, x: f64, y: f64| {
            let sense = if e.reversed { -1.0 } else { 1.0 };
            e.surface.sag_mm(x, y).map(|sag| e.vertex_z_mm() + sense * sag)
        };
        [(1.0, 0.0), (0.0, 1.0)].into_iter().find_map(|(x, y)| {
            let gap = |r: f64| Some(z(rear, r * x, r * y)? - z(front, r * x, r * y)?);
            // Vertices in reverse order, a formal step back between two planes, are not checked.
            gap(0.0).filter(|g| *g >= -TOUCH_MM)?;
            let step = |i: usize| rim * i as f64 / STEPS as f64;
            let past = (1..=STEPS).find(|i| gap(step(*i)).is_some_and(|g| g < -TOUCH_MM))?;
            let (mut apart, mut crossed) = (0.0, step(past));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (apart + crossed);
                if gap(middle).is_some_and(|g| g < 0.0) { crossed = middle } else { apart = middle }
            }
            Some(crossed)
        })
    }
}
