//! What a ray meets of a picture with depth.
//!
//! The picture is a height field over its own perspective. In the coordinates (column, row, w), w being one over the
//! depth in front of the center of projection, every straight ray is a straight line (a projective map keeps lines), each
//! pixel is a flat cell at its w, and w only falls along a ray from the lens: the cells are walked through in order (J.
//! Amanatides and A. Woo, "A fast voxel traversal algorithm", Eurographics 1987), with no step that could miss one. What stands
//! around the line bounds the part of it that has to be walked ([`super::bounds`]); the result is that of walking all of it.
//!
//! What lies behind a foreground no single picture knows. Where a ray passes from in front of one pixel to behind the next,
//! and the two belong to different things, the background goes on behind the foreground as it was last seen: at the depth
//! and in the color of the last pixel in front of which the ray was: black, if that is one of the picture's lights, for a lamp
//! is no background. No light of the foreground leaks into it. Where the
//! two belong to the same thing the ray meets the step between them. A ray that comes in behind a foreground from
//! beside the picture sees nothing until it comes out again.

use super::bounds::Bounds;
use super::narrowing::{Each, Line, Lines, Look, MUCH_SHORTER, Narrowing, SIDE_BY_SIDE, less, more, pixel};

/// One over the depth of each pixel.
pub(super) struct HeightField {
    width: usize,
    height: usize,
    /// 1/mm, row by row from the top.
    inverse_mm: Vec<f32>,
    bounds: Bounds,
    /// Of each pixel, whether all that touch it belong to the same thing.
    smooth: Vec<bool>,
    nearest: f64,
    farthest: f64,
    edge: f64,
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
/// Rounding moves a place by less than this part of its coordinates: some 2^-52 times a few.
const ROUNDING: f64 = 1e-12;
/// A line is looked at no more often.
const MOST_LOOKS: usize = 16;
/// Pixels across a step within which the background is looked for that goes on behind it.
const MOST_ACROSS: usize = 64;

impl HeightField {
    /// `depth_mm` is positive and finite; neighbors whose depths differ by more than the part `edge` belong to
    /// different things.
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

    /// A pixel and all that touch it.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, row, width) = (cell % self.width, cell / self.width, self.width);
        let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
        let rows = row.saturating_sub(1)..=(row + 1).min(self.height - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// Whether all pixels that touch one belong to the same thing as it does.
    #[inline(always)]
    pub(super) fn is_smooth(&self, cell: usize) -> bool {
        self.smooth[cell]
    }

    /// One over the depth of a pixel, 1/mm.
    #[inline(always)]
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
    #[inline(always)]
    pub(super) fn together(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.w(a), self.w(b));
        (a - b).abs() <= (self.edge * a.max(b)).max(STEP * self.nearest)
    }

    /// What the rays along `len` lines meet first, coming from the lens; those that are not `wanted` are left out. Each finds what
    /// [`HeightField::hit`] finds, but they are narrowed side by side: a loop of its own for each thing that is done, so that all
    /// but the look at the squares runs in vectors, and none waits for another's.
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

    /// Which lines lie over the picture from in front of everything to the farthest: see [`HeightField::over`].
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

    /// [`HeightField::narrowed`] for lines side by side: writes where each has anything beside it first.
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

    /// The pixels that lines are over at these w, and whether rounding leaves no doubt of it and they were narrowed at all.
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

    /// What the ray along a line meets first, coming from the lens.
    ///
    /// Code that runs for each ray: it is inlined into what is compiled for each instruction set, hence no closures.
    #[inline(always)]
    pub(super) fn hit(&self, line: &Line) -> Option<Hit> {
        let [w_in, w_end] = self.over(line)?;
        // A ray that comes in from beside the picture may do so behind something: that needs every step of its way.
        let narrowed = if w_in >= self.nearest { self.narrowed(line, w_in, w_end) } else { None };
        let (cell, near) = match narrowed {
            Some((cell, near)) => {
                // In front of it the ray passed everything, since nothing stands nearer.
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

    /// The pixel whose color stands for what a ray meets, where that is a guess: of the background that the ray left at a step, the one
    /// beside the hidden place, straight across the step. The pixel at the step itself would do for rays that go straight back; others go
    /// on to other rows (or columns), and what crosses the edge there must not be drawn sharp beside it.
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
            // Away from what stands nearer.
            if is_backward && at[axis] == 0 || !is_backward && at[axis] + 1 == size[axis] {
                break;
            }
            at[axis] = if is_backward { at[axis] - 1 } else { at[axis] + 1 };
        }
        hit.cell
    }

    /// Part of a line that lies over the picture, from in front of everything to the farthest: its ends in w.
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

    /// Far more than rounding moves a place on a line, pixels.
    #[inline(always)]
    fn room(&self, line: &Line) -> [f64; 2] {
        let ([a, b], [x, y]) = (line.at_infinity, line.per_w);
        [ROUNDING * (1.0 + a.abs() + x.abs() * self.nearest), ROUNDING * (1.0 + b.abs() + y.abs() * self.nearest)]
    }

    /// The pixel of a place, or the nearest one.
    #[inline(always)]
    fn cell_at(&self, [column, row]: [f64; 2]) -> [usize; 2] {
        // Also where it is no number.
        let (column, row) = (if column > 0.0 { column } else { 0.0 }, if row > 0.0 { row } else { 0.0 });
        [(column as i32 as usize).min(self.width - 1), (row as i32 as usize).min(self.height - 1)]
    }

    /// The same by its number.
    #[inline(always)]
    pub(super) fn cell(&self, place: [f64; 2]) -> usize {
        let [column, row] = self.cell_at(place);
        row * self.width + column
    }

    /// Where a line that comes from in front of everything has anything beside it first: the pixel that it is over there, and w.
    /// `None` where that is where it begins, or too close to a border for rounding to say which pixel it is over.
    #[inline(always)]
    fn narrowed(&self, line: &Line, w_in: f64, w_end: f64) -> Option<([usize; 2], f64)> {
        let room = self.room(line);
        let (mut near, mut far) = (w_in, w_end);
        // How much of what is left is looked at.
        let mut part = 1.0;
        for _ in 0..MOST_LOOKS {
            let upto = if part == 1.0 { far } else { near - part * (near - far) };
            let (first, last) = self.around_line(line, near, upto, room);
            let ends = self.bounds.of(first, last);
            let (nearest, farthest) = (f64::from(ends.nearest), f64::from(ends.farthest));
            // It runs in front of all that, or meets what is nearest there at the earliest.
            let next = less(near, more(nearest, upto));
            // It has met something where what is farthest there lies in front of the end.
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

    /// The box of pixels that a part of a line is over, first and last column and row, with room for rounding.
    #[inline(always)]
    fn around_line(&self, line: &Line, near: f64, far: f64, room: [f64; 2]) -> ([usize; 2], [usize; 2]) {
        let [a, b] = [line.at(near), line.at(far)];
        let first = self.cell_at([less(a[0], b[0]) - room[0], less(a[1], b[1]) - room[1]]);
        let last = self.cell_at([more(a[0], b[0]) + room[0], more(a[1], b[1]) + room[1]]);
        (first, last)
    }

    /// Whether a line stays behind all that stands around it between two ends.
    #[inline(always)]
    fn stays_behind(&self, line: &Line, near: f64, far: f64) -> bool {
        let (first, last) = self.around_line(line, near, far, self.room(line));
        f64::from(self.bounds.of(first, last).farthest) > near
    }

    /// The same without a look at what stands around the line: what [`HeightField::hit`] is tested by.
    #[cfg(test)]
    fn hit_step_by_step(&self, line: &Line) -> Option<Hit> {
        let [w_in, w_end] = self.over(line)?;
        self.walk::<false>(line, self.cell_at(line.at(w_in)), w_in, w_end)
    }

    /// Follows a line pixel by pixel, from a pixel that it is over at `w_in`; `LOOKS` ahead where that may save steps.
    ///
    /// Which side a pixel is left by is a toss-up, so nothing branches on it: both axes are carried on.
    #[inline(always)]
    fn walk<const LOOKS: bool>(&self, line: &Line, cell: [usize; 2], mut w_in: f64, w_end: f64) -> Option<Hit> {
        let [mut across, mut down] = [self.way(line, cell, 0), self.way(line, cell, 1)];
        let mut here = cell[1] * self.width + cell[0];
        // The pixel whose surface the ray was last in front of, and whether it still is.
        let mut before: Option<usize> = None;
        let mut in_front = w_in >= self.nearest;
        // Where it last came behind something, and by which side it came into the pixel where it is.
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
            // Out of the picture, too, there is nothing.
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

    /// How a line goes over columns (`axis` 0) or rows, from this pixel on.
    #[inline(always)]
    fn way(&self, line: &Line, cell: [usize; 2], axis: usize) -> Way {
        let slope = line.per_w[axis];
        let forward = slope < 0.0;
        let (size, stride) = if axis == 0 { (self.width, 1) } else { (self.height, self.width) };
        Way {
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

/// How a line goes over columns or rows, coming from large w.
struct Way {
    /// Where it leaves the column or row that it is over.
    border: f64,
    /// From one border to the next.
    step: f64,
    /// The picture's border that it comes to.
    end: f64,
    /// Where it is at w = 0, and one over its change per w.
    origin: f64,
    inverse: f64,
    /// From pixel to pixel.
    stride: usize,
    /// Of the pixel that it comes to, the side by which it comes: see [`Wall::side`].
    side: u8,
}

impl Way {
    /// The w at which it leaves; nowhere if it runs along.
    #[inline(always)]
    fn leaves(&self) -> f64 {
        more((self.border - self.origin) * self.inverse, f64::NEG_INFINITY)
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

    /// A ray that goes behind the edge and on to other rows meets the background of those rows.
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

    /// With and without a look at what stands around a line, bit by bit: planes, slopes, noise, posts before a wall.
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
                    // Through a place over or beside the picture, at a depth in it.
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

    /// Side by side, with some left out and some beside the picture, each line meets what it meets alone.
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
                            // Nowhere is nowhere, whatever is found there.
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
        // Comes in from the left behind the foreground, and leaves the hidden part over the background.
        let hit = step().hit(&through(-1.0, 1200.0, -24_000.0)).unwrap();
        assert!(hit.cell % 8 >= 4 && !hit.guessed);
    }
}
