//! Intersection of rays with a picture with depth.
//!
//! The picture is a height field over its own perspective, in the coordinates (column, row, w), where w is one over the depth in front of
//! the center of projection. Every straight ray is a straight line there, since a projective map keeps lines. Each pixel is a flat cell at
//! its w, and w only falls along a ray from the lens. The cells are walked through in order (J. Amanatides and A. Woo, "A fast voxel
//! traversal algorithm", Eurographics 1987), so that none is missed. The surfaces around the line bound the part of it that has to be
//! walked ([`super::bounds`]); the result is the same as that of walking all of it.
//!
//! No single picture shows what lies behind a foreground. A ray may pass from in front of one pixel to behind the next. If the two belong
//! to different objects, the background continues behind the foreground: at the depth and in the color of the last pixel that the ray was
//! in front of. It is black if that pixel is one of the picture's lights, since a lamp is not a background. No light of the foreground
//! leaks into it. If the two belong to the same object, the ray meets the step between them. A ray that enters from outside the picture
//! behind a foreground sees no light until it emerges again.

use super::bounds::Bounds;
use super::narrowing::{Each, Line, Lines, Look, MUCH_SHORTER, Narrowing, SIDE_BY_SIDE, less, more, pixel};

/// A picture's height field: the inverse depth of each pixel.
pub(super) struct HeightField {
    width: usize,
    height: usize,
    /// Inverse depths, 1/mm, row by row from the top.
    inverse_mm: Vec<f32>,
    bounds: Bounds,
    /// Whether all pixels that touch a pixel belong to the same object.
    smooth: Vec<bool>,
    nearest: f64,
    farthest: f64,
    edge: f64,
}

/// The point where a ray meets the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Column and row of the point, pixels.
    pub place: [f64; 2],
    /// Pixel whose surface the ray meets.
    pub cell: usize,
    /// Whether the surface is guessed, that is, a background continued behind a foreground.
    pub guessed: bool,
    /// Step at which the ray passed from in front of one pixel to behind the next; `None` if it met the plane of a pixel.
    pub wall: Option<Wall>,
}

/// The step between a pixel and a nearer neighbor. A ray meets the step itself, or the guessed background that continues from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wall {
    /// The farther pixel, which the ray leaves.
    pub cell: u32,
    /// Side on which the nearer pixel lies: 0 left, 1 right, 2 above, 3 below.
    pub side: u8,
}

/// Steps of w below this fraction of the largest w shift no point by as much as a pixel in any realistic picture.
const STEP: f64 = 1e-3;
/// Upper limit of the shift of a point by rounding, relative to its coordinates: a few times 2^-52.
const ROUNDING: f64 = 1e-12;
/// Largest number of narrowing steps for a line.
const MOST_LOOKS: usize = 16;
/// Number of pixels across a step within which the continued background is searched for.
const MOST_ACROSS: usize = 64;

impl HeightField {
    /// Creates the field from positive, finite depths, mm. Neighbors whose depths differ by more than the fraction `edge` belong to
    /// different objects.
    pub(super) fn new(width: usize, height: usize, depth_mm: &[f32], edge: f64) -> Self {
        let inverse_mm: Vec<f32> = depth_mm.iter().map(|d| 1.0 / d).collect();
        let nearest = inverse_mm.iter().fold(0.0_f32, |a, b| a.max(*b));
        let farthest = inverse_mm.iter().fold(f32::INFINITY, |a, b| a.min(*b));
        let (nearest, farthest) = (f64::from(nearest), f64::from(farthest));
        let bounds = Bounds::new(width, height, &inverse_mm);
        let mut own = Self { width, height, inverse_mm, bounds, smooth: Vec::new(), nearest, farthest, edge };
        own.smooth = (0..own.cells()).map(|cell| own.around(cell).all(|beside| own.together(cell, beside))).collect();
        own
    }

    /// Returns a pixel and all pixels that touch it.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, row, width) = (cell % self.width, cell / self.width, self.width);
        let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
        let rows = row.saturating_sub(1)..=(row + 1).min(self.height - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// Returns whether all pixels that touch a pixel belong to the same object.
    #[inline(always)]
    pub(super) fn is_smooth(&self, cell: usize) -> bool {
        self.smooth[cell]
    }

    /// Inverse depth of a pixel, 1/mm.
    #[inline(always)]
    pub(super) fn w(&self, cell: usize) -> f64 {
        f64::from(self.inverse_mm[cell])
    }

    /// Returns the neighbor of a pixel on a side, numbered as in [`Wall::side`]; `None` outside the picture.
    pub(super) fn beside(&self, cell: usize, side: u8) -> Option<usize> {
        let (column, row) = (cell % self.width, cell / self.width);
        match side {
            0 => (column > 0).then(|| cell - 1),
            1 => (column + 1 < self.width).then(|| cell + 1),
            2 => (row > 0).then(|| cell - self.width),
            _ => (row + 1 < self.height).then(|| cell + self.width),
        }
    }

    /// Number of pixels of the picture.
    pub(super) fn cells(&self) -> usize {
        self.inverse_mm.len()
    }

    /// Returns whether two pixels belong to the same object.
    #[inline(always)]
    pub(super) fn together(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.w(a), self.w(b));
        (a - b).abs() <= (self.edge * a.max(b)).max(STEP * self.nearest)
    }

    /// Finds what the rays along `len` lines meet first, coming from the lens; lines that are not `wanted` are skipped. The results are
    /// those of [`HeightField::hit`], but the lines are narrowed in parallel, with a separate loop for each operation. Everything except
    /// the lookup of the squares is then vectorized, and no line waits for another.
    #[inline(always)]
    pub(super) fn hits(&self, lines: &Lines, len: usize, wanted: &[bool; SIDE_BY_SIDE], hits: &mut [Option<Hit>]) {
        let len = len.min(SIDE_BY_SIDE);
        let mut inside = [false; SIDE_BY_SIDE];
        self.lie_inside(lines, &mut inside);
        let mut narrowing = Narrowing::new();
        for i in 0..len {
            narrowing.take(lines, i, inside[i] & wanted[i]);
        }
        let mut near = [self.nearest; SIDE_BY_SIDE];
        self.narrow(&mut narrowing, &mut near);
        let mut cells = [[0_u32; SIDE_BY_SIDE]; 2];
        let mut sure = [false; SIDE_BY_SIDE];
        self.begin(lines, &near, &mut cells, &mut sure);
        for i in 0..len {
            if !wanted[i] {
                hits[i] = None;
                continue;
            }
            let line = lines.line(i);
            if !inside[i] {
                hits[i] = self.hit(&line);
                continue;
            }
            let (cell, from) = if sure[i] {
                let (cell, w) = (cells.map(|column| column[i] as usize), near[i]);
                let here = cell[1] * self.width + cell[0];
                if self.w(here) == w {
                    hits[i] = Some(Hit { place: line.at(w), cell: here, guessed: false, wall: None });
                    continue;
                }
                (cell, w)
            } else {
                (self.cell_at(line.at(self.nearest)), self.nearest)
            };
            hits[i] = self.walk::<true>(&line, cell, from, self.farthest);
        }
    }

    /// Finds the lines that stay over the picture from the nearest to the farthest depth: see [`HeightField::over`].
    #[inline(always)]
    fn lie_inside(&self, lines: &Lines, inside: &mut [bool; SIDE_BY_SIDE]) {
        let size = [self.width as f64, self.height as f64];
        for i in 0..SIDE_BY_SIDE {
            let line = lines.line(i);
            let ([near, far], room) = ([line.at(self.nearest), line.at(self.farthest)], self.room(&line));
            let mut lies = true;
            for k in 0..2 {
                lies &= less(near[k], far[k]) > room[k];
                lies &= more(near[k], far[k]) < size[k] - room[k];
            }
            inside[i] = lies;
        }
    }

    /// Computes [`HeightField::narrowed`] for lines in parallel: writes the w at which each first comes beside a surface.
    #[inline(always)]
    fn narrow(&self, lines: &mut Narrowing, found: &mut Each) {
        let last = [self.width as f64 - 1.0, self.height as f64 - 1.0];
        lines.near = [self.nearest; SIDE_BY_SIDE];
        lines.far = [self.farthest; SIDE_BY_SIDE];
        lines.part = [1.0; SIDE_BY_SIDE];
        for i in 0..SIDE_BY_SIDE {
            let room = self.room(&lines.line(i));
            (lines.room[0][i], lines.room[1][i]) = (room[0], room[1]);
        }
        for _ in 0..MOST_LOOKS {
            if lines.len == 0 {
                break;
            }
            let mut look = Look::new();
            lines.boxes(last, &mut look);
            for i in 0..lines.len {
                let (first, last) = look.of(i);
                let ends = self.bounds.of(first, last);
                (look.nearest[i], look.farthest[i]) = (ends.nearest, ends.farthest);
                look.small[i] = u32::from(Bounds::is_small(first, last));
            }
            lines.shorten(&mut look);
            lines.keep(&look, found);
        }
        for i in 0..lines.len {
            found[lines.ray[i] as usize % SIDE_BY_SIDE] = lines.near[i];
        }
    }

    /// Finds the pixels under the lines at these w. `sure` is whether a line was narrowed and rounding leaves no doubt about the pixel.
    #[inline(always)]
    fn begin(&self, lines: &Lines, near: &Each, cells: &mut [[u32; SIDE_BY_SIDE]; 2], sure: &mut [bool; SIDE_BY_SIDE]) {
        let last = [self.width as f64 - 1.0, self.height as f64 - 1.0];
        for i in 0..SIDE_BY_SIDE {
            let line = lines.line(i);
            let (place, room) = (line.at(near[i]), self.room(&line));
            let mut is_sure = near[i] != self.nearest;
            for k in 0..2 {
                let cell = pixel(place[k], last[k]);
                cells[k][i] = cell;
                let part = place[k] - f64::from(cell);
                is_sure &= (part > room[k]) & (part < 1.0 - room[k]);
            }
            sure[i] = is_sure;
        }
    }

    /// Finds what the ray along a line meets first, coming from the lens.
    ///
    /// This code runs for each ray. It is inlined into code that is compiled for each instruction set, so it has no closures.
    #[inline(always)]
    pub(super) fn hit(&self, line: &Line) -> Option<Hit> {
        let [w_in, w_end] = self.over(line)?;
        // A ray that enters from outside the picture may do so behind a surface. Every step of it then has to be walked.
        let narrowed = if self.starts_in_front(line, w_in, w_end) { self.narrowed(line, w_in, w_end) } else { None };
        let (cell, near) = match narrowed {
            Some((cell, near)) => {
                // Up to here the ray passed in front of everything, since no surface is nearer.
                let here = cell[1] * self.width + cell[0];
                if self.w(here) == near {
                    return Some(Hit { place: line.at(near), cell: here, guessed: false, wall: None });
                }
                (cell, near)
            }
            None => (self.cell_at(line.at(w_in)), w_in),
        };
        self.walk::<true>(line, cell, near, w_end)
    }

    /// Returns the pixel whose color is used for a guessed background: the one beside the hidden point, straight across the step. For rays
    /// that go straight back, the pixel at the step itself would do. Other rays continue to other rows (or columns), and what crosses the
    /// edge there must not appear sharp beside it.
    #[inline]
    pub(super) fn goes_on(&self, hit: &Hit) -> usize {
        let Some(wall) = hit.wall.filter(|_| hit.guessed) else { return hit.cell };
        let (axis, is_backward) = (usize::from(wall.side / 2), wall.side % 2 == 1);
        let size = [self.width, self.height];
        let mut at = [hit.cell % self.width, hit.cell / self.width];
        at[1 - axis] = (hit.place[1 - axis].max(0.0) as usize).min(size[1 - axis] - 1);
        for _ in 0..MOST_ACROSS {
            let cell = at[1] * self.width + at[0];
            if self.together(hit.cell, cell) {
                return cell;
            }
            // Move away from the nearer side.
            if is_backward && at[axis] == 0 || !is_backward && at[axis] + 1 == size[axis] {
                break;
            }
            at[axis] = if is_backward { at[axis] - 1 } else { at[axis] + 1 };
        }
        hit.cell
    }

    /// Returns the part of a line that lies over the picture, from the nearest to the farthest depth, as its ends in w; `None` if there is
    /// none.
    #[inline(always)]
    fn over(&self, line: &Line) -> Option<[f64; 2]> {
        let size = [self.width as f64, self.height as f64];
        let (mut w_in, mut w_end) = (self.nearest, self.farthest);
        let [near, far] = [line.at(w_in), line.at(w_end)];
        let room = self.room(line);
        let mut inside = true;
        for k in 0..2 {
            inside &= less(near[k], far[k]) > room[k];
            inside &= more(near[k], far[k]) < size[k] - room[k];
        }
        if inside {
            return Some([w_in, w_end]);
        }
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
        (w_in >= w_end).then_some([w_in, w_end])
    }

    /// Returns a bound, in pixels, of the shift of a point on a line by rounding, with a large margin.
    #[inline(always)]
    fn room(&self, line: &Line) -> [f64; 2] {
        let ([a, b], [x, y]) = (line.at_infinity, line.per_w);
        [ROUNDING * (1.0 + a.abs() + x.abs() * self.nearest), ROUNDING * (1.0 + b.abs() + y.abs() * self.nearest)]
    }

    /// Returns the column and row of the pixel at a point, or of the nearest one.
    #[inline(always)]
    fn cell_at(&self, [column, row]: [f64; 2]) -> [usize; 2] {
        // Also for NaN.
        let (column, row) = (if column > 0.0 { column } else { 0.0 }, if row > 0.0 { row } else { 0.0 });
        [(column as i32 as usize).min(self.width - 1), (row as i32 as usize).min(self.height - 1)]
    }

    /// Returns the index of the pixel at a point, or of the nearest one.
    #[inline(always)]
    pub(super) fn cell(&self, place: [f64; 2]) -> usize {
        let [column, row] = self.cell_at(place);
        row * self.width + column
    }

    /// Finds where a line that starts in front of everything first comes beside a surface. Returns the pixel under it there, and w.
    /// `None` if that is at its start, or too close to a border for rounding to tell which pixel is under it.
    #[inline(always)]
    fn narrowed(&self, line: &Line, w_in: f64, w_end: f64) -> Option<([usize; 2], f64)> {
        let room = self.room(line);
        let (mut near, mut far) = (w_in, w_end);
        // Fraction of the remaining line that the next look covers.
        let mut part = 1.0;
        for _ in 0..MOST_LOOKS {
            let upto = if part == 1.0 { far } else { near - part * (near - far) };
            let (first, last) = self.around_line(line, near, upto, room);
            let ends = self.bounds.of(first, last);
            let (nearest, farthest) = (f64::from(ends.nearest), f64::from(ends.farthest));
            // The line runs in front of all that, or meets the nearest surface there at the earliest.
            let next = less(near, more(nearest, upto));
            // The line has met a surface by then if the farthest one there lies in front of the end.
            let end = if farthest > far && farthest >= upto { less(farthest, next) } else { far };
            let shorter = next - end < MUCH_SHORTER * (near - far);
            let moved = next < near;
            (near, far) = (next, end);
            if near == far {
                break;
            }
            if !shorter {
                if Bounds::is_small(first, last) {
                    break;
                }
                part *= if moved { 1.0 } else { 0.5 };
            } else if moved {
                part = 1.0;
            }
        }
        if near == w_in {
            return None;
        }
        let place = line.at(near);
        let cell = self.cell_at(place);
        let mut is_sure = true;
        for k in 0..2 {
            let part = place[k] - cell[k] as f64;
            is_sure &= part > room[k] && part < 1.0 - room[k];
        }
        is_sure.then_some((cell, near))
    }

    /// Returns the box of pixels under a part of a line (first and last column and row), with a margin for rounding.
    #[inline(always)]
    fn around_line(&self, line: &Line, near: f64, far: f64, room: [f64; 2]) -> ([usize; 2], [usize; 2]) {
        let [a, b] = [line.at(near), line.at(far)];
        let first = self.cell_at([less(a[0], b[0]) - room[0], less(a[1], b[1]) - room[1]]);
        let last = self.cell_at([more(a[0], b[0]) + room[0], more(a[1], b[1]) + room[1]]);
        (first, last)
    }

    /// Returns whether a line starts in front of all surfaces around it, up to an end.
    #[inline(always)]
    fn starts_in_front(&self, line: &Line, w_in: f64, w_end: f64) -> bool {
        if w_in >= self.nearest {
            return true;
        }
        let (first, last) = self.around_line(line, w_in, w_end, self.room(line));
        f64::from(self.bounds.of(first, last).nearest) <= w_in
    }

    /// Returns whether a line stays behind all surfaces around it between two ends.
    #[inline(always)]
    fn stays_behind(&self, line: &Line, near: f64, far: f64) -> bool {
        let (first, last) = self.around_line(line, near, far, self.room(line));
        f64::from(self.bounds.of(first, last).farthest) > near
    }

    /// Finds what a ray meets without using the bounds, as a reference for [`HeightField::hit`].
    #[cfg(test)]
    fn hit_step_by_step(&self, line: &Line) -> Option<Hit> {
        let [w_in, w_end] = self.over(line)?;
        self.walk::<false>(line, self.cell_at(line.at(w_in)), w_in, w_end)
    }

    /// Follows a line pixel by pixel, from the pixel under it at `w_in`. With `LOOKS` it uses the bounds where that may save steps.
    ///
    /// The side on which the line leaves a pixel is unpredictable, so the code does not branch on it and updates both axes.
    #[inline(always)]
    fn walk<const LOOKS: bool>(&self, line: &Line, cell: [usize; 2], mut w_in: f64, w_end: f64) -> Option<Hit> {
        let [mut across, mut down] = [self.way(line, cell, 0), self.way(line, cell, 1)];
        let mut here = cell[1] * self.width + cell[0];
        // The last pixel that the ray was in front of, and whether the ray still is in front.
        let mut before: Option<usize> = None;
        let mut in_front = w_in >= self.nearest;
        // The step at which the ray last went behind a surface, and the side of the previous pixel on which the current one lies.
        let mut wall = None;
        let mut side = 0;
        loop {
            let (leaves_column, leaves_row) = (across.leaves(), down.leaves());
            let is_down = leaves_row > leaves_column;
            let leaves = if is_down { leaves_row } else { leaves_column };
            let ends = !(leaves > w_end);
            let w_out = if ends { w_end } else { less(leaves, w_in) };
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
                    if LOOKS && let Some(cell) = before {
                        let w = self.w(cell);
                        if w >= w_end && self.stays_behind(line, w_in, w) {
                            return Some(Hit { place: line.at(w), cell, guessed: true, wall });
                        }
                    }
                }
                in_front = false;
                if let Some(before) = before.filter(|before| w_out <= self.w(*before)) {
                    return Some(Hit { place: line.at(self.w(before)), cell: before, guessed: true, wall });
                }
            }
            // The ray meets nothing if its line ends or leaves the picture.
            let (border, end) = if is_down { (down.border, down.end) } else { (across.border, across.end) };
            if ends | (border == end) {
                return None;
            }
            across.border += if is_down { 0.0 } else { across.step };
            down.border += if is_down { down.step } else { 0.0 };
            here = here.wrapping_add(if is_down { down.stride } else { across.stride });
            side = if is_down { down.side } else { across.side };
            w_in = w_out;
        }
    }

    /// Returns how a line crosses columns (`axis` 0) or rows, from this pixel on.
    #[inline(always)]
    fn way(&self, line: &Line, cell: [usize; 2], axis: usize) -> AxisTraversal {
        let slope = line.per_w[axis];
        let forward = slope < 0.0;
        let (size, stride) = if axis == 0 { (self.width, 1) } else { (self.height, self.width) };
        AxisTraversal {
            border: (cell[axis] + usize::from(forward)) as f64,
            step: if forward { 1.0 } else { -1.0 },
            end: if forward { size as f64 } else { 0.0 },
            origin: line.at_infinity[axis],
            inverse: if slope == 0.0 { f64::INFINITY } else { 1.0 / slope },
            stride: if forward { stride } else { stride.wrapping_neg() },
            side: 2 * axis as u8 + u8::from(forward),
        }
    }
}

/// Traversal state of a line along columns or rows, coming from large w.
struct AxisTraversal {
    /// Border where the line leaves the current column or row.
    border: f64,
    /// Step from one border to the next.
    step: f64,
    /// Border of the picture toward which the line runs.
    end: f64,
    /// Position of the line at w = 0.
    origin: f64,
    /// Inverse of the change of position per w.
    inverse: f64,
    /// Step of the pixel index from one pixel to the next.
    stride: usize,
    /// Side of the current pixel on which the next one lies: see [`Wall::side`].
    side: u8,
}

impl AxisTraversal {
    /// Returns the w at which the line leaves the current column or row; minus infinity if it runs along it.
    #[inline(always)]
    fn leaves(&self) -> f64 {
        more((self.border - self.origin) * self.inverse, f64::NEG_INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of eight columns: the left four at 1 m, the others at 2 m.
    fn step() -> HeightField {
        let depth: Vec<f32> = (0..16).map(|i| if i % 8 < 4 { 1000.0 } else { 2000.0 }).collect();
        HeightField::new(8, 2, &depth, 0.05)
    }

    /// Returns the line of a ray through a column at depth `at_mm`, with a slope in columns per w.
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

    /// Rays cross the plane of the foreground on either side of its edge, at any slope. The left ones meet it. The right ones
    /// pass and see only background, which is guessed where it is hidden.
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

    /// A ray that passes behind the edge and continues to other rows meets the background of those rows.
    #[test]
    fn what_is_hidden_is_guessed_from_beside_it() {
        let depth: Vec<f32> = (0..48).map(|i| if i % 8 < 4 { 1000.0 } else { 2000.0 }).collect();
        let (field, mut rows) = (HeightField::new(8, 6, &depth, 0.05), Vec::new());
        for per_w in [-2600.0, 0.0, 2600.0] {
            let mut line = through(4.001, 1000.0, 2000.0);
            // Through the middle of row 2 at the plane of the foreground.
            (line.at_infinity[1], line.per_w[1]) = (2.5 - per_w / 1000.0, per_w);
            let hit = field.hit(&line).expect("the background");
            assert!(hit.guessed && hit.cell / 8 == 2, "{hit:?}");
            let cell = field.goes_on(&hit);
            assert_eq!(cell % 8, 4);
            rows.push(cell / 8);
        }
        assert_eq!(rows, [3, 2, 1]);
    }

    /// A slanted plane has steps between its pixels, but no ray slips through them.
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
                // The exact plane is w = 1e-3 - 1e-5 (column - 0.5); the ray meets it within one pixel and one step.
                let w = (hit.place[0] - (25.3 - slope / 1100.0)) / slope;
                if slope.abs() > 1.0 {
                    let plane = 1e-3 - 1e-5 * (hit.place[0] - 0.5);
                    assert!((w - plane).abs() < 1.01e-5, "{slope} {hit:?}");
                }
            }
        }
        assert!(met > 1900, "{met}");
    }

    /// Results are the same with and without the bounds, bit by bit: planes, slopes, noise, posts in front of a wall.
    #[test]
    fn narrowing_changes_nothing() {
        let mut state = 1_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut met, mut walls, mut guessed, mut skipped) = (0, 0, 0, 0);
        for (width, height) in [(1, 1), (2, 9), (37, 23), (150, 90)] {
            for kind in 0..6 {
                let depth: Vec<f32> = (0..width * height)
                    .map(|i| {
                        let (c, r) = (i % width, i / width);
                        match kind {
                            0 => 1500.0,
                            1 => 900.0 + 7.0 * c as f32 + 3.0 * r as f32,
                            2 => 800.0 + 2000.0 * ((i * 7919 % 613) as f32 / 613.0),
                            3 if c % 23 < 6 && r > 3 => 1000.0,
                            4 if (c / 9 + r / 7) % 3 == 0 => 1000.0 + c as f32,
                            _ => 4000.0 + (r % 3) as f32,
                        }
                    })
                    .collect();
                let field = HeightField::new(width, height, &depth, 0.05);
                for _ in 0..4000 {
                    // Through a point over or outside the picture, at a depth within it.
                    let at = [draw() * 1.2 - 0.1, draw() * 1.2 - 0.1];
                    let w = field.farthest + (field.nearest - field.farthest) * draw();
                    let reach = 10.0_f64.powf(4.0 * draw()) / field.nearest.max(1e-9);
                    let mut per_w = [(draw() - 0.5) * reach, (draw() - 0.5) * reach];
                    if draw() < 0.1 {
                        per_w[usize::from(draw() < 0.5)] = 0.0;
                    }
                    let mut place = [at[0] * width as f64, at[1] * height as f64];
                    if draw() < 0.1 {
                        // On a border.
                        place = place.map(f64::round);
                    }
                    let line = Line { at_infinity: [0, 1].map(|k| place[k] - per_w[k] * w), per_w };
                    let hit = field.hit(&line);
                    assert_eq!(hit, field.hit_step_by_step(&line), "{width} x {height}, {kind}: {line:?}");
                    met += usize::from(hit.is_some());
                    walls += usize::from(hit.is_some_and(|hit| hit.wall.is_some()));
                    guessed += usize::from(hit.is_some_and(|hit| hit.guessed));
                    skipped += usize::from(
                        field
                            .over(&line)
                            .is_some_and(|[a, b]| a >= field.nearest && field.narrowed(&line, a, b).is_some()),
                    );
                }
            }
        }
        assert!(met > 20_000 && walls > 2000 && guessed > 1000 && skipped > 5000, "{met} {walls} {guessed} {skipped}");
    }

    /// Lines processed in parallel, some skipped and some outside the picture, meet what they meet alone.
    #[test]
    fn side_by_side_is_as_alone() {
        let mut state = 5_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut met, mut walls, mut guessed, mut out) = (0, 0, 0, 0);
        for (width, height) in [(1, 1), (37, 23), (150, 90)] {
            for kind in 0..4 {
                let depth: Vec<f32> = (0..width * height)
                    .map(|i| match (kind, i % width, i / width) {
                        (0, ..) => 1500.0,
                        (1, c, r) => 900.0 + 7.0 * c as f32 + 3.0 * r as f32,
                        (2, c, r) if (c / 9 + r / 7) % 3 == 0 => 1000.0 + c as f32,
                        _ => 4000.0 + 900.0 * ((i * 7919 % 613) as f32 / 613.0),
                    })
                    .collect();
                let field = HeightField::new(width, height, &depth, 0.05);
                for round in 0..120 {
                    let mut lines = Lines::new();
                    let mut wanted = [false; SIDE_BY_SIDE];
                    for i in 0..SIDE_BY_SIDE {
                        let reach = 10.0_f64.powf(4.0 * draw()) / field.nearest;
                        let w = field.farthest + (field.nearest - field.farthest) * draw();
                        for (k, size) in [width, height].into_iter().enumerate() {
                            lines.per_w[k][i] = if draw() < 0.1 { 0.0 } else { (draw() - 0.5) * reach };
                            lines.at_infinity[k][i] = (draw() * 1.2 - 0.1) * size as f64 - lines.per_w[k][i] * w;
                        }
                        wanted[i] = draw() < 0.9;
                    }
                    lines.at_infinity[0][7] = f64::NAN;
                    let len = SIDE_BY_SIDE - round % 5;
                    let mut hits = [None; SIDE_BY_SIDE];
                    field.hits(&lines, len, &wanted, &mut hits);
                    for i in 0..len {
                        let alone = field.hit_step_by_step(&lines.line(i)).filter(|_| wanted[i]);
                        if i == 7 {
                            // The line has a NaN: any result is accepted.
                            continue;
                        }
                        assert_eq!(hits[i], alone, "{width} x {height}, {kind}: {:?}", lines.line(i));
                        met += usize::from(alone.is_some());
                        walls += usize::from(alone.is_some_and(|hit| hit.wall.is_some()));
                        guessed += usize::from(alone.is_some_and(|hit| hit.guessed));
                        out += usize::from(alone.is_none());
                    }
                }
            }
        }
        assert!(met > 20_000 && walls > 2000 && guessed > 1000 && out > 5000, "{met} {walls} {guessed} {out}");
    }

    #[test]
    fn beside_the_picture_there_is_nothing() {
        assert_eq!(step().hit(&through(8.5, 1000.0, 0.0)), None);
        assert_eq!(step().hit(&through(-0.1, 1000.0, 0.0)), None);
        // The ray enters from the left behind the foreground, and emerges over the background.
        let hit = step().hit(&through(-1.0, 1200.0, -24_000.0)).unwrap();
        assert!(hit.cell % 8 >= 4 && !hit.guessed);
    }
}
