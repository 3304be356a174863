//! Focusing laws: how groups of surfaces move when a lens is focused.

/// The focusing law of one group: how the group moves when the lens is focused.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusLaw {
    /// Group that moves: index into [`crate::Lens::groups`].
    pub group: usize,
    /// How the group moves.
    pub travel: GroupTravel,
}

/// The way a group moves in focusing.
#[derive(Clone, Debug, PartialEq)]
pub enum GroupTravel {
    /// The group moves this many times the common travel of all such groups, toward the object if positive. The common travel
    /// follows from the object distance.
    Factor(f64),
    /// The group moves as a table of object distances states.
    Table(FocusTable),
    /// The group moves until the x-z section of a lens with cylinders is in focus as well. The other groups, or the whole lens,
    /// focus the y-z section.
    SectionX,
}

/// The shift of a group as a function of the object distance. It is a monotone cubic in one over the distance, through every
/// point.
///
/// F. N. Fritsch and J. Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci.
/// Stat. Comput. 5 (1984), 300.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusTable {
    /// One over the object distance, 1/mm, ascending.
    vergence: Vec<f64>,
    shift_mm: Vec<f64>,
    slope: Vec<f64>,
}

impl FocusTable {
    /// Creates a table from pairs of an object distance from the first vertex and the shift toward the object at this distance,
    /// both in mm. Distances are descending; infinity is allowed. Returns `None` unless there are at least two points in this
    /// order.
    #[must_use]
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        let vergence: Vec<f64> = points.iter().map(|(distance_mm, _)| 1.0 / distance_mm).collect();
        let shift_mm: Vec<f64> = points.iter().map(|(_, shift)| *shift).collect();
        let rising = vergence.windows(2).all(|w| w[0] < w[1]) && vergence.iter().all(|v| *v >= 0.0 && v.is_finite());
        if points.len() < 2 || !rising || !shift_mm.iter().all(|s| s.is_finite()) {
            return None;
        }
        let step = |i: usize| vergence[i + 1] - vergence[i];
        let secant = |i: usize| (shift_mm[i + 1] - shift_mm[i]) / step(i);
        let last = points.len() - 1;
        let slope = (0..=last)
            .map(|i| match i {
                0 => secant(0),
                _ if i == last => secant(last - 1),
                _ => {
                    let (before, after) = (secant(i - 1), secant(i));
                    if before * after <= 0.0 {
                        return 0.0;
                    }
                    let (a, b) = (2.0 * step(i) + step(i - 1), step(i) + 2.0 * step(i - 1));
                    (a + b) / (a / before + b / after)
                }
            })
            .collect();
        Some(Self { vergence, shift_mm, slope })
    }

    /// Returns the table with all lengths multiplied by `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let times = |all: &[f64], factor: f64| all.iter().map(|v| v * factor).collect();
        Self {
            vergence: times(&self.vergence, 1.0 / factor),
            shift_mm: times(&self.shift_mm, factor),
            slope: times(&self.slope, factor * factor),
        }
    }

    /// Nearest and farthest object distance of the table, mm.
    #[must_use]
    pub fn range_mm(&self) -> (f64, f64) {
        (1.0 / self.vergence[self.vergence.len() - 1], 1.0 / self.vergence[0])
    }

    /// Returns the shift toward the object (mm) for an object at the distance `object_mm`; `None` outside the range of the table.
    #[must_use]
    pub fn shift_mm(&self, object_mm: f64) -> Option<f64> {
        let v = 1.0 / object_mm;
        let last = self.vergence.len() - 1;
        if !(v >= self.vergence[0] && v <= self.vergence[last]) {
            return None;
        }
        let i = self.vergence.partition_point(|w| *w <= v).clamp(1, last) - 1;
        let h = self.vergence[i + 1] - self.vergence[i];
        let t = (v - self.vergence[i]) / h;
        let (a, b) = (self.shift_mm[i], self.shift_mm[i + 1]);
        let (p, q) = (self.slope[i] * h, self.slope[i + 1] * h);
        // Hermite's cubic, expanded about its left end.
        Some(a + t * (p + t * ((3.0 * (b - a) - 2.0 * p - q) + t * (2.0 * (a - b) + p + q))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_goes_through_its_points_and_never_back() {
        let points = [(f64::INFINITY, 0.0), (2000.0, 0.4), (1900.0, 0.4), (500.0, 1.9), (300.0, 7.0)];
        let table = FocusTable::new(&points).expect("in order");
        for (distance, shift) in points {
            assert!((table.shift_mm(distance).expect("inside") - shift).abs() < 1e-13, "{distance}");
        }
        let mut before = 0.0;
        for step in 0..=1000 {
            let shift = table.shift_mm(300.0 * 1000.0 / f64::from(step)).expect("inside");
            assert!(shift >= before - 1e-13, "{step}: {shift} after {before}");
            before = shift;
        }
        assert_eq!(table.shift_mm(299.0), None);
        assert_eq!(table.range_mm(), (300.0, f64::INFINITY));
        assert!(FocusTable::new(&points[..1]).is_none());
        assert!(FocusTable::new(&[(500.0, 1.0), (2000.0, 0.4)]).is_none());
    }

    /// A shift proportional to 1/distance stays a straight line.
    #[test]
    fn a_line_stays_a_line() {
        let line = |d: f64| 700.0 / d + 0.1;
        let table = FocusTable::new(&[3000.0, 1500.0, 800.0, 450.0].map(|d| (d, line(d)))).expect("in order");
        for d in [3000.0, 2000.0, 1000.0, 700.0, 460.0] {
            assert!((table.shift_mm(d).expect("inside") - line(d)).abs() < 1e-12, "{d}");
        }
    }
}
