//! What a ray meets of a picture with depth.
//!
//! The picture is a height field over its own perspective. In the coordinates (column, row, w), w being one over the
//! depth in front of the center of projection, every straight ray is a straight line (a projective map keeps lines), each
//! pixel is a flat cell at its w, and w only falls along a ray from the lens: the cells are walked through in order (J.
//! Amanatides and A. Woo, "A fast voxel traversal algorithm", Eurographics 1987), with no step that could miss one.
//!
//! What lies behind a foreground no single picture knows. Where a ray passes from in front of one pixel to behind the next,
//! and the two belong to different things, the background goes on behind the foreground as it was last seen: at the depth
//! and in the color of the last pixel in front of which the ray was. No light of the foreground leaks into it. Where the
//! two belong to the same thing the ray meets the step between them. A ray that comes in behind a foreground from
//! beside the picture sees nothing until it comes out again.

/// One over the depth of each pixel.
pub(super) struct HeightField {
    width: usize,
    height: usize,
    /// 1/mm, row by row from the top.
    inverse_mm: Vec<f32>,
    nearest: f64,
    farthest: f64,
    edge: f64,
}

/// A line in picture coordinates: column and row (pixels from the upper left) at w = 0, and their change per w.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub at_infinity: [f64; 2],
    pub per_w: [f64; 2],
}

impl Line {
    fn at(&self, w: f64) -> [f64; 2] {
        [0, 1].map(|k| self.at_infinity[k] + self.per_w[k] * w)
    }
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Where, in pixels.
    pub place: [f64; 2],
    /// The pixel whose surface it is.
    pub cell: usize,
    /// Whether that surface is guessed: a background that goes on behind a foreground.
    pub guessed: bool,
    /// Where the ray passed from in front of one pixel to behind the next; `None` if it met a pixel's own plane.
    pub wall: Option<Wall>,
}

/// The step between a pixel and a neighbor that stands nearer: what a ray meets there, or the guess that goes on from there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wall {
    /// The pixel that stands farther: the ray leaves it.
    pub cell: u32,
    /// Where the nearer one lies: 0 left, 1 right, 2 above, 3 below.
    pub side: u8,
}

/// Steps of w below this part of the largest move nothing by as much as a pixel in any sensible picture.
const STEP: f64 = 1e-3;

impl HeightField {
    /// `depth_mm` is positive and finite; neighbors whose depths differ by more than the part `edge` belong to
    /// different things.
    pub(super) fn new(width: usize, height: usize, depth_mm: &[f32], edge: f64) -> Self {
        let inverse_mm: Vec<f32> = depth_mm.iter().map(|d| 1.0 / d).collect();
        let nearest = inverse_mm.iter().fold(0.0_f32, |a, b| a.max(*b));
        let farthest = inverse_mm.iter().fold(f32::INFINITY, |a, b| a.min(*b));
        Self { width, height, inverse_mm, nearest: f64::from(nearest), farthest: f64::from(farthest), edge }
    }

    /// One over the depth of a pixel, 1/mm.
    pub(super) fn w(&self, cell: usize) -> f64 {
        f64::from(self.inverse_mm[cell])
    }

    /// The pixel beside one, on a side as [`Wall::side`] counts them.
    pub(super) fn beside(&self, cell: usize, side: u8) -> Option<usize> {
        let (column, row) = (cell % self.width, cell / self.width);
        match side {
            0 => (column > 0).then(|| cell - 1),
            1 => (column + 1 < self.width).then(|| cell + 1),
            2 => (row > 0).then(|| cell - self.width),
            _ => (row + 1 < self.height).then(|| cell + self.width),
        }
    }

    /// How many pixels there are.
    pub(super) fn cells(&self) -> usize {
        self.inverse_mm.len()
    }

    /// Whether two pixels belong to the same thing.
    pub(super) fn together(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.w(a), self.w(b));
        (a - b).abs() <= (self.edge * a.max(b)).max(STEP * self.nearest)
    }

    /// What the ray along a line meets first, coming from the lens.
    pub(super) fn hit(&self, line: &Line) -> Option<Hit> {
        let size = [self.width as f64, self.height as f64];
        // From in front of everything to the farthest, as far as the line lies over the picture.
        let (mut w_in, mut w_end) = (self.nearest, self.farthest);
        for k in 0..2 {
            let (at, slope) = (line.at_infinity[k], line.per_w[k]);
            if slope == 0.0 {
                if !(at >= 0.0 && at <= size[k]) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-at / slope, (size[k] - at) / slope);
            w_in = w_in.min(a.max(b));
            w_end = w_end.max(a.min(b));
        }
        if !(w_in >= w_end) {
            return None;
        }
        let [column, row] = line.at(w_in);
        let last = [self.width - 1, self.height - 1];
        let mut cell = [(column.max(0.0) as usize).min(last[0]), (row.max(0.0) as usize).min(last[1])];
        let forward = line.per_w.map(|slope| slope < 0.0);
        // The pixel whose surface the ray was last in front of, and whether it still is.
        let mut before: Option<usize> = None;
        let mut in_front = w_in >= self.nearest;
        // Where it last came behind something, and by which side it came into the pixel where it is.
        let mut wall = None;
        let mut side = 0;
        loop {
            let leaves = [0, 1].map(|k| {
                let border = (cell[k] + usize::from(forward[k])) as f64;
                let w = (border - line.at_infinity[k]) / line.per_w[k];
                if line.per_w[k] == 0.0 || w.is_nan() { f64::NEG_INFINITY } else { w }
            });
            let axis = usize::from(leaves[1] > leaves[0]);
            let ends = !(leaves[axis] > w_end);
            let w_out = if ends { w_end } else { leaves[axis].min(w_in) };
            let here = cell[1] * self.width + cell[0];
            let surface = self.w(here);
            if w_in >= surface {
                if w_out <= surface {
                    return Some(Hit { place: line.at(surface), cell: here, guessed: false, wall: None });
                }
                (before, in_front) = (Some(here), true);
            } else {
                if in_front {
                    wall = before.map(|before| Wall { cell: before as u32, side });
                    if before.is_none_or(|before| self.together(before, here)) {
                        return Some(Hit { place: line.at(w_in), cell: here, guessed: false, wall });
                    }
                }
                in_front = false;
                if let Some(before) = before.filter(|before| w_out <= self.w(*before)) {
                    return Some(Hit { place: line.at(self.w(before)), cell: before, guessed: true, wall });
                }
            }
            if ends {
                return None;
            }
            let next = if forward[axis] { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
            if next > last[axis] {
                return None;
            }
            cell[axis] = next;
            side = 2 * axis as u8 + u8::from(forward[axis]);
            w_in = w_out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight columns: the left four at 1 m, the others at 2 m.
    fn step() -> HeightField {
        let depth: Vec<f32> = (0..16).map(|i| if i % 8 < 4 { 1000.0 } else { 2000.0 }).collect();
        HeightField::new(8, 2, &depth, 0.05)
    }

    /// The line of a ray through (column, row) at depth `at_mm` with a slope in columns per w.
    fn through(column: f64, at_mm: f64, slope: f64) -> Line {
        Line { at_infinity: [column - slope / at_mm, 0.5], per_w: [slope, 0.0] }
    }

    #[test]
    fn a_ray_along_the_perspective_meets_its_own_pixel() {
        for column in 0..8 {
            let hit = step().hit(&through(f64::from(column) + 0.3, 1000.0, 0.0)).unwrap();
            assert_eq!((hit.cell, hit.guessed), (column as usize, false));
        }
    }

    /// Rays through the plane of the foreground, on either side of its edge, at any slope: the left ones meet it, the
    /// right ones pass and see background only, guessed where it is hidden.
    #[test]
    fn the_edge_is_sharp_and_leaks_nothing() {
        let field = step();
        for slope in [-5000.0, -2000.0, -1.0, 1.0, 2000.0, 5000.0] {
            let near = field.hit(&through(3.999, 1000.0, slope)).unwrap();
            assert!(near.cell % 8 < 4 && !near.guessed, "{slope} {near:?}");
            // From w = 1/1000 to 1/2000 the column falls by slope / 2000.
            let column = 4.001 - slope / 2000.0;
            let far = field.hit(&through(4.001, 1000.0, slope)).unwrap();
            assert!(far.cell % 8 >= 4, "{slope} {far:?}");
            assert_eq!(far.guessed, column < 4.0, "{slope} {far:?}");
            assert!((far.place[0] - column).abs() < 1e-6);
        }
    }

    /// A slanted plane has steps between its pixels; a ray slips through none of them.
    #[test]
    fn a_slanted_surface_has_no_cracks() {
        let depth: Vec<f32> = (0..100).map(|i| 1.0 / (1e-3 - 1e-5 * (i % 50) as f32)).collect();
        let field = HeightField::new(50, 2, &depth, 0.05);
        let mut met = 0;
        for k in 0..2000 {
            let slope = (f64::from(k) - 1000.0) * 37.0;
            if let Some(hit) = field.hit(&through(25.3, 1100.0, slope)) {
                met += 1;
                assert!(!hit.guessed, "{slope} {hit:?}");
                // The exact plane: w = 1e-3 - 1e-5 (column - 0.5), met within one pixel and one step.
                let w = (hit.place[0] - (25.3 - slope / 1100.0)) / slope;
                if slope.abs() > 1.0 {
                    let plane = 1e-3 - 1e-5 * (hit.place[0] - 0.5);
                    assert!((w - plane).abs() < 1.01e-5, "{slope} {hit:?}");
                }
            }
        }
        assert!(met > 1900, "{met}");
    }

    #[test]
    fn beside_the_picture_there_is_nothing() {
        assert_eq!(step().hit(&through(8.5, 1000.0, 0.0)), None);
        assert_eq!(step().hit(&through(-0.1, 1000.0, 0.0)), None);
        // Comes in from the left behind the foreground, and leaves the hidden part over the background.
        let hit = step().hit(&through(-1.0, 1200.0, -24_000.0)).unwrap();
        assert!(hit.cell % 8 >= 4 && !hit.guessed);
    }
}
