//! Points and rectangles on a canvas.

/// A point on a canvas: x to the right and y downward, in CSS pixels.
pub type Point = [f64; 2];

/// A rectangle parallel to the axes of the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

impl Rect {
    /// Creates a rectangle from its edges.
    #[must_use]
    pub const fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { left, top, right, bottom }
    }

    /// Width of the rectangle, canvas units.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Height of the rectangle, canvas units.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Returns the four corners in order, starting at the upper left.
    #[must_use]
    pub fn corners(&self) -> [Point; 4] {
        [[self.left, self.top], [self.right, self.top], [self.right, self.bottom], [self.left, self.bottom]]
    }

    /// Whether this rectangle and `other` have an area in common.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether `other` lies within this rectangle.
    #[must_use]
    pub fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && other.right <= self.right && self.top <= other.top && other.bottom <= self.bottom
    }

    /// Returns this rectangle, larger by `margin` on each side.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.left - margin, self.top - margin, self.right + margin, self.bottom + margin)
    }
}

/// Returns a circle as a polygon that deviates by at most 0.02 units from it.
pub(crate) fn circle(center: Point, radius: f64) -> Vec<Point> {
    // The sagitta of a chord is r (1 - cos(pi/n)), about r pi^2 / (2 n^2).
    let sides = (16.0 * radius.max(0.0).sqrt()).ceil().clamp(8.0, 512.0) as usize;
    (0..sides)
        .map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / sides as f64;
            [center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle)]
        })
        .collect()
}
