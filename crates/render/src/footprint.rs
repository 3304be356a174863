//! The part of the frame that a ray stands for, and the pixels over which its light is spread.
//!
//! A footprint is a square of pixels around the pixel that the ray meets. Light that would land beyond an edge of its ghost, or of the
//! frame, is folded back over that edge. No light is lost, an even ghost stays even up to its edge, and the edge stays as sharp as it was.
//! Light is folded along rows or along columns, whichever crosses the edge more steeply, because what counts is how far from the edge the
//! light ends up. If no one direction crosses both of two edges that meet, footprints are smaller there.
//!
//! Smaller squares toward an edge would also keep it sharp, but not the mean: they heap light up before the edge, 7 % of it if they reach
//! half of the way.

/// Largest half side of a footprint, pixels.
pub(crate) const MOST_HALF: f64 = 14.0;
/// Smallest cosine between an edge's normal and the rows or columns along which light is folded over it. Near an edge with a smaller
/// cosine, footprints shrink instead.
const ACROSS: f64 = 0.5;
/// Half side, pixels, that a footprint keeps in a corner between two edges. Single rays would show as colored dots.
const LEAST_IN_CORNER: i64 = 1;

/// An edge of a ghost near the point where a ray lands: a line across the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// Unit vector normal to the edge, pointing out of the ghost: columns, rows.
    pub out: [f64; 2],
    /// Distance from the ray to the edge, pixels, never negative.
    pub away: f64,
}

impl Edge {
    /// Returns the half side, pixels, of the largest square around the ray that does not reach the edge.
    fn room(&self) -> f64 {
        self.away / (self.out[0].abs() + self.out[1].abs())
    }
}

/// The pixels that receive the light of a ray, around the pixel that it meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Footprint {
    /// Half side of the square, pixels, not counting the middle pixel.
    pub half: i64,
    /// Edges of the ghost that cut the square, the nearest first.
    pub edges: [Option<Edge>; 2],
}

impl Footprint {
    /// The footprint of a ray whose light stays in the pixel that it meets.
    pub const PIXEL: Self = Self { half: 0, edges: [None; 2] };

    /// Creates a footprint of this half side, in pixels, with the edges that are near, the nearest first.
    #[inline]
    pub fn new(half: f64, edges: [Option<Edge>; 2]) -> Self {
        let mut own = Self { half: nearest(half), edges };
        own.edges.iter_mut().for_each(|edge| *edge = edge.filter(|edge| edge.room() < own.half as f64 + 0.5));
        if let [None, second] = own.edges {
            own.edges = [second, None];
        }
        if let [Some(_), Some(second)] = own.edges
            && second.out[own.axis()].abs() < ACROSS
        {
            own.half = own.half.min(below(second.room()).max(LEAST_IN_CORNER));
            own.edges[1] = None;
        }
        own
    }

    /// Returns the axis along which light is folded: 0 for columns, 1 for rows.
    fn axis(&self) -> usize {
        self.edges[0].map_or(0, |Edge { out: [x, y], .. }| usize::from(y.abs() > x.abs()))
    }

    /// Number of pixels that receive a share; after folding, some of them may receive several.
    pub fn pixels(&self) -> i64 {
        (2 * self.half + 1) * (2 * self.half + 1)
    }

    /// Clips a line of the square, `beside` pixels away from its middle, to the part that no edge separates from the middle. `None` if
    /// edges leave nothing of it.
    #[inline]
    fn on_this_side(&self, axis: usize, beside: i64, [mut from, mut to]: [i64; 2]) -> Option<[i64; 2]> {
        for Edge { out, away } in self.edges.iter().flatten() {
            let room = (away - out[1 - axis] * beside as f64) / out[axis].abs();
            if out[axis] > 0.0 {
                to = to.min(below(room));
            } else {
                from = from.max(-below(room));
            }
        }
        (from <= to).then_some([from, to])
    }
}

/// A box of pixels: first and last column, first and last row.
pub(crate) type PixelBox = [[usize; 2]; 2];

/// The frame over which light is spread.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameGrid {
    /// Number of columns and rows.
    size: [i64; 2],
}

impl FrameGrid {
    pub fn new(width: u32, height: u32) -> Self {
        Self { size: [width, height].map(i64::from) }
    }

    /// Returns the number of the pixel in a column and row.
    pub fn pixel(&self, column: usize, row: usize) -> usize {
        row * self.size[0] as usize + column
    }

    /// Returns the box that holds one pixel.
    #[inline]
    pub fn one(&self, pixel: u32) -> PixelBox {
        let (pixel, width) = (pixel as usize, self.size[0] as usize);
        [[pixel % width; 2], [pixel / width; 2]]
    }

    /// Calls `add` for each box of pixels of a footprint around a pixel. Together the boxes hold [`Footprint::pixels`] pixels.
    #[inline]
    pub fn each_box(&self, pixel: u32, footprint: &Footprint, mut add: impl FnMut(PixelBox)) {
        let middle = [i64::from(pixel) % self.size[0], i64::from(pixel) / self.size[0]];
        let half = footprint.half;
        let inside = |axis: usize| middle[axis] >= half && middle[axis] + half < self.size[axis];
        if inside(0) && inside(1) && footprint.edges[0].is_none() {
            add(middle.map(|at| [(at - half) as usize, (at + half) as usize]));
            return;
        }
        self.each_folded(middle, footprint, &mut add);
    }

    /// Calls `add` for each box of a footprint whose light is folded back at edges of the ghost or of the frame.
    fn each_folded(&self, middle: [i64; 2], footprint: &Footprint, add: &mut impl FnMut(PixelBox)) {
        let (axis, half) = (footprint.axis(), footprint.half);
        let frame = |axis: usize| [-middle[axis], self.size[axis] - 1 - middle[axis]];
        let room = |beside: i64| Some((beside, footprint.on_this_side(axis, beside, frame(axis))?));
        // Find the line that the light of each line goes to, and the range in it that has room. A line beyond two edges is moved to the
        // other side of the middle, where there is more room. The middle line always has some.
        let line = |beside: i64| {
            let within = |beside: i64| mirrored(beside, frame(1 - axis));
            room(within(beside)).or_else(|| room(within(-beside))).or_else(|| room(0)).unwrap_or((0, [0, 0]))
        };
        let mut first = -half;
        while first <= half {
            let (beside, own) = line(first);
            let mut many = 1;
            while first + many <= half && line(first + many) == (beside + many, own) {
                many += 1;
            }
            folded([-half, half], own, &mut |along| {
                let mut both = [along, along];
                both[1 - axis] = [beside, beside + many - 1];
                let pixels = |axis: usize| both[axis].map(|at| (middle[axis] + at) as usize);
                add([pixels(0), pixels(1)]);
            });
            first += many;
        }
    }
}

/// Folds a pixel back into a range, as often as necessary.
fn mirrored(mut at: i64, [low, high]: [i64; 2]) -> i64 {
    while at < low || at > high {
        at = if at < low { 2 * low - 1 - at } else { 2 * high + 1 - at };
    }
    at
}

/// Folds a row of pixels, given by its first and last, back into a range, as often as necessary. Calls `add` for each resulting piece.
fn folded([from, to]: [i64; 2], [low, high]: [i64; 2], add: &mut impl FnMut([i64; 2])) {
    if to < low || from > high {
        let at = if to < low { 2 * low - 1 } else { 2 * high + 1 };
        return folded([at - to, at - from], [low, high], add);
    }
    add([from.max(low), to.min(high)]);
    if from < low {
        folded([low, 2 * low - 1 - from], [low, high], add);
    }
    if to > high {
        folded([2 * high + 1 - to, high], [low, high], add);
    }
}

/// Rounds a number of small magnitude to the nearest integer.
#[inline]
fn nearest(number: f64) -> i64 {
    below(number + 0.5)
}

/// Returns the floor of a number of small magnitude, by operations that are fast and the same on all machines.
#[inline]
fn below(number: f64) -> i64 {
    const ABOVE: f64 = 4096.0;
    (number.clamp(-ABOVE, ABOVE) + ABOVE) as i64 - ABOVE as i64
}

/// Divides an integer into equal shares for this many pixels, and returns the share and the rest. The rest goes to the pixel that the ray
/// meets.
#[inline]
pub(crate) fn shared(value: i64, pixels: i64) -> (i64, i64) {
    let share = value / pixels;
    (share, value - share * pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(ground: &FrameGrid, pixel: u32, footprint: &Footprint, value: i64) -> Vec<i64> {
        let [width, height] = ground.size.map(|size| size as usize);
        let mut cells = vec![0; width * height];
        let (share, left) = shared(value, footprint.pixels());
        ground.each_box(pixel, footprint, |[[from, to], [low, high]]| {
            for row in low..=high {
                cells[row * width + from..=row * width + to].iter_mut().for_each(|c| *c += share);
            }
        });
        cells[pixel as usize] += left;
        cells
    }

    fn edge(turn: f64, away: f64) -> Edge {
        Edge { out: [turn.cos(), turn.sin()], away }
    }

    /// Checks pixels in the middle, at an edge and in a corner of the frame, at edges of a ghost, and in a frame smaller than the
    /// footprint.
    #[test]
    fn shares_add_up_to_the_ray() {
        for (width, height) in [(40, 30), (7, 5), (1, 9), (1, 1)] {
            let ground = FrameGrid::new(width, height);
            for k in 0..200 {
                let turn = 0.37 * f64::from(k);
                let half = f64::from(k % 15);
                let near = [Some(edge(turn, half * 0.1)), Some(edge(turn * 1.7, half * 0.3))];
                let edges = [[None; 2], [near[0], None], near][k as usize % 3];
                let footprint = Footprint::new(half, edges);
                for pixel in [0, width * height / 2, width * height - 1] {
                    for value in [1, -1, 1_000_003, -77_777_777, 1 << 49] {
                        assert_eq!(spread(&ground, pixel, &footprint, value).iter().sum::<i64>(), value);
                    }
                }
            }
        }
    }

    #[test]
    fn light_stays_on_its_side_of_edges() {
        let ground = FrameGrid::new(64, 64);
        for k in 0..60 {
            let turn = 0.21 * f64::from(k);
            let edges = [edge(turn, 2.5), edge(turn + 0.4 * f64::from(k % 8), 4.0)];
            let footprint = Footprint::new(6.0, edges.map(Some));
            for (at, value) in spread(&ground, 32 * 64 + 32, &footprint, 1 << 40).iter().enumerate() {
                let [x, y] = [at % 64, at / 64].map(|at| at as f64 - 32.0);
                let beyond = edges.iter().map(|edge| x * edge.out[0] + y * edge.out[1] - edge.away).fold(0.0, f64::max);
                assert!(*value == 0 || beyond < 1e-9, "{k}: {x} {y} {beyond}");
            }
        }
    }

    #[test]
    fn a_footprint_is_a_square() {
        let ground = FrameGrid::new(64, 64);
        let cells = spread(&ground, 32 * 64 + 32, &Footprint::new(5.2, [None; 2]), 121 * 7);
        let lit = |at: usize| (at % 64).abs_diff(32).max((at / 64).abs_diff(32)) <= 5;
        assert!(cells.iter().enumerate().all(|(at, value)| *value == if lit(at) { 7 } else { 0 }));
        assert_eq!(Footprint::PIXEL.pixels(), 1);
    }

    /// Rays on each pixel of a part of the frame: the light stays in that part and stays even, whatever the direction of its edge.
    #[test]
    fn an_even_ghost_stays_even_up_to_its_edges() {
        let (side, half) = (80_usize, 6.0);
        let ground = FrameGrid::new(side as u32, side as u32);
        for turn in [0.0, 0.3, 0.7, 1.1, 1.571, 2.5, 4.0, 5.9] {
            let mut cells = vec![0_i64; side * side];
            let away = |pixel: usize| {
                let [x, y] = [pixel % side, pixel / side].map(|at| at as f64 - 39.5);
                12.0 - x * f64::cos(turn) - y * f64::sin(turn)
            };
            for pixel in (0..side * side).filter(|pixel| away(*pixel) >= 0.0) {
                let footprint = Footprint::new(half, [Some(edge(turn, away(pixel))), None]);
                let own = spread(&ground, pixel as u32, &footprint, 169 * 1000);
                cells.iter_mut().zip(own).for_each(|(cell, own)| *cell += own);
            }
            // Average by distance from the edge, because single pixels depend on how the edge crosses them.
            for step in 0..10 {
                let far = |pixel: usize| [pixel % side, pixel / side].iter().all(|at| (14..66).contains(at));
                let is_here = |pixel: &usize| far(*pixel) && (away(*pixel) / 2.0).floor() as i64 == step;
                let own: Vec<i64> = (0..side * side).filter(is_here).map(|pixel| cells[pixel]).collect();
                let mean = own.iter().sum::<i64>() as f64 / own.len() as f64 / 169_000.0;
                assert!((mean - 1.0).abs() < 0.04, "{turn}: {mean} at {step}");
            }
            assert!((0..side * side).all(|pixel| away(pixel) >= -1e-9 || cells[pixel] == 0), "{turn}");
        }
    }
}
