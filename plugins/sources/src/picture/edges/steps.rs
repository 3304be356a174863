//! Decides which neighboring depths belong to the same object.

/// The inverse depth of a picture, and its steps.
pub(super) struct Steps {
    pub width: usize,
    pub height: usize,
    /// Inverse depth of each pixel, 1/mm.
    w: Vec<f32>,
    /// Whether each pixel touches one of another object.
    beside: Vec<bool>,
    edge: f32,
    /// Smallest difference that counts as a step, 1/mm.
    least: f32,
}

/// Directions in a picture (columns and rows): horizontal, vertical and the two diagonals.
pub(super) const WAYS: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Smallest step of w that counts, as a fraction of the largest w, as in [`super::super::height_field`].
const STEP: f32 = 1e-3;

impl Steps {
    pub(super) fn new(depth_mm: &[f32], width: usize, edge: f64) -> Self {
        let w: Vec<f32> = depth_mm.iter().map(|d| 1.0 / d).collect();
        let least = STEP * w.iter().fold(0.0_f32, |a, b| a.max(*b));
        let height = w.len() / width.max(1);
        let mut own = Self { width, height, w, beside: Vec::new(), edge: edge as f32, least };
        own.beside = (0..own.w.len()).map(|cell| own.window(cell, 1).any(|other| !own.together(cell, other))).collect();
        own
    }

    /// Returns whether the picture has steps.
    pub(super) fn any(&self) -> bool {
        self.beside.contains(&true)
    }

    /// Returns whether a pixel touches one of another object.
    pub(super) fn is_beside(&self, cell: usize) -> bool {
        self.beside[cell]
    }

    /// Inverse depth of a pixel, 1/mm.
    pub(super) fn w(&self, cell: usize) -> f32 {
        self.w[cell]
    }

    /// Returns whether two inverse depths, 1/mm, belong to the same object.
    pub(super) fn alike(&self, a: f32, b: f32) -> bool {
        (a - b).abs() <= (self.edge * a.max(b)).max(self.least)
    }

    /// Returns whether two depths (mm) belong to the same object.
    pub(super) fn are_together(&self, a_mm: f32, b_mm: f32) -> bool {
        self.alike(1.0 / a_mm, 1.0 / b_mm)
    }

    /// Returns whether two pixels belong to the same object.
    pub(super) fn together(&self, a: usize, b: usize) -> bool {
        self.alike(self.w[a], self.w[b])
    }

    /// Returns the pixels of a square around a pixel that lie in the picture, row by row.
    pub(super) fn window(&self, cell: usize, radius: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, row, width) = (cell % self.width, cell / self.width, self.width);
        let columns = column.saturating_sub(radius)..=(column + radius).min(width - 1);
        let rows = row.saturating_sub(radius)..=(row + radius).min(self.height - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// Returns the distance of two pixels: the larger of their distances in columns and in rows.
    pub(super) fn distance(&self, a: usize, b: usize) -> usize {
        (a % self.width).abs_diff(b % self.width).max((a / self.width).abs_diff(b / self.width))
    }

    /// Returns the pixel `steps` steps away along `way`; `None` outside the picture.
    pub(super) fn along(&self, cell: usize, way: [isize; 2], steps: isize) -> Option<usize> {
        let column = (cell % self.width).checked_add_signed(way[0] * steps).filter(|c| *c < self.width)?;
        let row = (cell / self.width).checked_add_signed(way[1] * steps).filter(|r| *r < self.height)?;
        Some(row * self.width + column)
    }
}
