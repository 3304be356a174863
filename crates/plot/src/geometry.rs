//! Places on a canvas.

/// x to the right and y downward, in units of a CSS pixel.
pub type Point = [f64; 2];

/// A rectangle along the axes.
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
    /// From its edges.
    #[must_use]
    pub const fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { left, top, right, bottom }
    }

    /// Its width.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Its height.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Its corners, around from the upper left.
    #[must_use]
    pub fn corners(&self) -> [Point; 4] {
        [[self.left, self.top], [self.right, self.top], [self.right, self.bottom], [self.left, self.bottom]]
    }

    /// Whether the two have a part in common.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether `other` lies within.
    #[must_use]
    pub fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && other.right <= self.right && self.top <= other.top && other.bottom <= self.bottom
    }

    /// Wider by `margin` on each side.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.left - margin, self.top - margin, self.right + margin, self.bottom + margin)
    }
}

/// A circle as a polygon: its edge is nowhere more than 0.02 of a unit from the true one.
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
