//! Lines of sight: what a camera's frame sees in front of the lens.

/// A line of sight in front of the lens, in the frame of the lens: where it crosses the plane z = 0, and its slope there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightLine {
    /// Number of the point of the frame that this line of sight comes from.
    pub point: usize,
    /// x and y on the plane z = 0, mm.
    pub start_mm: [f64; 2],
    /// Sideways shift of the line in x and y for each mm toward the object, mm.
    pub slope: [f64; 2],
}

impl SightLine {
    /// Returns x and y (mm) at which this line of sight crosses the plane `distance_mm` in front of the first vertex.
    #[must_use]
    pub fn at_mm(&self, distance_mm: f64) -> [f64; 2] {
        [0, 1].map(|k| self.start_mm[k] + self.slope[k] * distance_mm)
    }
}

/// The lines of sight from points all over a frame through the whole opening of the lens, at its reference wavelength. Used for a
/// source that has to fill the frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameView {
    sights: Vec<SightLine>,
    /// Points of the frame with a line of sight at 90 degrees to the axis or more; they cannot see a plane.
    beside: Vec<usize>,
    /// Focal length of the lens, mm, if known.
    focal_length_mm: Option<f64>,
}

impl FrameView {
    /// Creates a view from lines of sight; lines from the same point of the frame must be adjacent. `beside` lists the points
    /// that have a line of sight at 90 degrees or more to the axis.
    #[must_use]
    pub fn new(sights: Vec<SightLine>, beside: Vec<usize>) -> Self {
        Self { sights, beside, focal_length_mm: None }
    }

    /// Sets the focal length of the lens, mm. Its sign is dropped, and a value that is not finite means that it is unknown.
    #[must_use]
    pub fn with_focal_length(self, mm: f64) -> Self {
        Self { focal_length_mm: Some(mm.abs()).filter(|mm| mm.is_finite()), ..self }
    }

    /// Focal length of the lens, mm, positive; `None` if it is unknown or infinite.
    #[must_use]
    pub fn focal_length_mm(&self) -> Option<f64> {
        self.focal_length_mm
    }

    /// Returns whether a plane perpendicular to the axis can fill the frame. It cannot if the lens looks to the side or behind,
    /// or if there are no lines of sight.
    #[must_use]
    pub fn fits_a_plane(&self) -> bool {
        self.beside.is_empty() && !self.sights.is_empty()
    }

    /// Returns half the width and height (mm) of the smallest rectangle around `center_mm` that contains everything the frame
    /// sees on the plane `distance_mm` in front of the first vertex. `None` if there is no such rectangle.
    #[must_use]
    pub fn half_size_mm(&self, distance_mm: f64, center_mm: [f64; 2]) -> Option<[f64; 2]> {
        if !self.fits_a_plane() {
            return None;
        }
        let mut half = [0.0_f64; 2];
        for sight in &self.sights {
            let at = sight.at_mm(distance_mm);
            for k in 0..2 {
                half[k] = half[k].max((at[k] - center_mm[k]).abs());
            }
        }
        half.iter().all(|h| h.is_finite()).then_some(half)
    }

    /// Returns the fraction of the frame's points that get half of their light or more from places where `is_seen` is false. Only
    /// points that see anything through the lens count; `None` if there are none.
    #[must_use]
    pub fn share_missed(&self, is_seen: impl Fn(&SightLine) -> bool) -> Option<f64> {
        let (mut points, mut missed) = (0_usize, 0_usize);
        for of_point in self.sights.chunk_by(|a, b| a.point == b.point) {
            let seen = of_point.iter().filter(|sight| is_seen(sight)).count();
            points += 1;
            missed += usize::from(2 * seen <= of_point.len());
        }
        (points > 0).then(|| missed as f64 / points as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pinhole at z = 0 of 20 mm over 36 x 24 mm sees 1.8 x 1.2 m at 1 m.
    fn pinhole() -> FrameView {
        let mut sights = Vec::new();
        for (point, [x, y]) in [[-18.0, -12.0], [18.0, -12.0], [0.0, 0.0], [18.0, 12.0]].into_iter().enumerate() {
            sights.push(SightLine { point, start_mm: [0.0; 2], slope: [x / 20.0, y / 20.0] });
        }
        FrameView::new(sights, Vec::new())
    }

    #[test]
    fn what_the_frame_sees_grows_with_the_distance() {
        assert_eq!(pinhole().half_size_mm(1000.0, [0.0; 2]), Some([900.0, 600.0]));
        assert_eq!(pinhole().half_size_mm(2000.0, [100.0, 0.0]), Some([1900.0, 1200.0]));
        let behind = FrameView { beside: vec![4], ..pinhole() };
        assert_eq!(behind.half_size_mm(1000.0, [0.0; 2]), None);
        assert_eq!(FrameView::default().half_size_mm(1000.0, [0.0; 2]), None);
    }

    #[test]
    fn points_that_see_beside_it_are_counted() {
        let inside = |half_mm: f64| move |s: &SightLine| s.at_mm(1000.0)[0].abs() <= half_mm;
        assert_eq!(pinhole().share_missed(inside(900.0)), Some(0.0));
        assert_eq!(pinhole().share_missed(inside(899.0)), Some(0.75));
        assert_eq!(FrameView::default().share_missed(inside(1.0)), None);
    }
}
