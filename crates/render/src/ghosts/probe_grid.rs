//! A net of places on the front of the lens, and where light through them lands along one path. Footprints are derived from it.
//!
//! Neighbors in the net tell three things. First, how a step on the front moves the light on the frame (the Jacobian). Second, where light
//! is lost next to light that arrives: an edge of the ghost, the image of a rim or of the stop. Third, where the map folds: a caustic. A
//! footprint is no larger than a few meshes of the net, because the map is known to be linear only that far. It ends at edges, and reaches
//! half of the way to a fold.
//!
//! An edge is found to a 32nd of a mesh and kept as a line across the frame that moves with the ray. In a round lens it turns with the
//! source around the axis.
//!
//! **Limits.** Where the net knows nothing, footprints reach up to 6 pixels to each side. So do those of rays beyond an edge, but no
//! farther than twice their distance beyond it: for their color and their place on the source the edge is elsewhere. Next to a caustic,
//! just beyond an edge and in a corner of two edges, a footprint keeps one or two pixels, because single rays would be colored dots.

use super::guide::FrontRect;
use crate::footprint::{Edge, Footprint, MOST_HALF};

/// Number of meshes across and up.
pub(super) const SIDE: usize = 32;
/// Number of times that the interval between a place whose light arrives and one whose light is lost is halved.
const HALVINGS: usize = 5;
/// Largest half side of a footprint in meshes, along the direction in which the map moves light least.
const MESHES: f64 = 3.0;
/// Distance up to which edges are searched, meshes.
const EDGES_WITHIN: i64 = 4;
/// Distance up to which folds are searched, meshes.
const FOLDS_WITHIN: i64 = 8;
/// Largest half side, pixels, of footprints of rays beyond an edge, and of rays through unknown places. The source is not a point and light
/// has many colors, so the edge is elsewhere for such rays, and blurred by as much.
const UNKNOWN: f64 = 6.0;
/// Half side of footprints of rays that land beyond an edge, as a multiple of their distance beyond it.
const BEYOND: f64 = 2.0;
/// Largest half side of a footprint, as a fraction of the distance to a fold.
const OF_FOLD: f64 = 0.5;
/// Smallest half side at a fold, pixels. Light is squeezed in one direction only there, and single rays would show as colored dots.
const LEAST_AT_FOLD: f64 = 2.0;
/// Smallest half side of footprints of rays just beyond an edge, pixels.
const LEAST_BEYOND: f64 = 1.0;
/// Cosine between the normals of two edges above which they count as one bent edge.
const SAME: f64 = 0.7;

type Pair = [f64; 2];

/// An edge near a mesh. Its distance in pixels is `at` plus `slope` times the place on the front.
#[derive(Clone, Copy, Debug)]
struct NearbyEdge {
    out: Pair,
    at: f64,
    slope: Pair,
}

impl NearbyEdge {
    fn away(&self, [x, y]: Pair) -> f64 {
        self.at + self.slope[0] * x + self.slope[1] * y
    }
}

/// Properties of a mesh: how far footprints may reach to each side, pixels, and the edges nearby.
#[derive(Clone, Copy, Debug, Default)]
struct Mesh {
    /// Whether light of the probes came through.
    is_lit: bool,
    half: f32,
    lines: [u32; 2],
}

/// Index that stands for no line.
const NONE: u32 = 0;

/// The net of one path and zone of the source.
#[derive(Clone, Debug)]
pub(super) struct ProbeGrid {
    part: FrontRect,
    meshes: Vec<Mesh>,
    /// Lines of the meshes; the first is a placeholder for none.
    lines: Vec<NearbyEdge>,
}

impl ProbeGrid {
    /// Builds the net over a part of the front. `land` returns for each of some places where on the frame the light that enters there
    /// lands, in pixels: column and row.
    pub fn new(part: FrontRect, land: impl FnMut(&[Pair]) -> Vec<Option<Pair>>) -> Self {
        let survey = Survey::new(part, land);
        let mut own = Self {
            part,
            meshes: vec![Mesh::default(); SIDE * SIDE],
            lines: vec![NearbyEdge { out: [0.0; 2], at: f64::MAX, slope: [0.0; 2] }],
        };
        for at in 0..SIDE * SIDE {
            if let Some(map) = &survey.maps[at] {
                own.meshes[at] = own.mesh(&survey, at, map);
            }
        }
        own
    }

    fn mesh(&mut self, survey: &Survey, at: usize, map: &Map) -> Mesh {
        let half = survey.half(at, map);
        // Reach from any point of the mesh to the corners of the square.
        let reach = std::f64::consts::SQRT_2 * half + map.half_diagonal();
        let mut near: Vec<(f64, NearbyEdge)> = survey.lines(at, map).filter(|(away, _)| *away < reach).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lines = [NONE; 2];
        if let Some((_, first)) = near.first() {
            let is_other = |line: &NearbyEdge| line.out[0] * first.out[0] + line.out[1] * first.out[1] < SAME;
            let second = near.iter().map(|(_, line)| line).find(|line| is_other(line));
            for (own, line) in lines.iter_mut().zip([Some(first), second].into_iter().flatten()) {
                *own = self.lines.len() as u32;
                self.lines.push(*line);
            }
        }
        Mesh { is_lit: true, half: half as f32, lines }
    }

    /// Returns the footprint of a ray through a place, with half side `half` where that is allowed. `turn` is the cosine and sine of the
    /// rotation about the axis from the source point that the net was found for to the ray's source point.
    pub fn footprint(&self, place: Pair, half: f64, turn: Pair) -> Footprint {
        let Some(inside) = self.part.inside(place) else { return Footprint::new(half.min(UNKNOWN), [None; 2]) };
        let [column, row] = inside.map(|at| ((at * SIDE as f64) as usize).min(SIDE - 1));
        let mesh = &self.meshes[row * SIDE + column];
        let half = half.min(f64::from(mesh.half).max(if mesh.is_lit { 0.0 } else { UNKNOWN }));
        let mut edges = [None; 2];
        for (edge, line) in edges.iter_mut().zip(mesh.lines).filter(|(_, line)| *line != NONE) {
            let line = &self.lines[line as usize];
            let away = line.away(place);
            if away < 0.0 {
                // The edge is elsewhere for this ray: at least as far beyond the known one as the ray lands, and blurred by as much.
                return Footprint::new(half.min((BEYOND * -away).max(LEAST_BEYOND)).min(UNKNOWN), [None; 2]);
            }
            // Columns count opposite to x, rows along y.
            let ([x, y], [cos, sin]) = (line.out, turn);
            *edge = Some(Edge { out: [x * cos + y * sin, y * cos - x * sin], away });
        }
        if let [Some(a), Some(b)] = edges
            && b.away < a.away
        {
            edges = [Some(b), Some(a)];
        }
        Footprint::new(half, edges)
    }
}

/// The linear map from a mesh on the front to the frame.
#[derive(Clone, Copy, Debug)]
struct Map {
    /// Landing point of the middle of the mesh, if all its corners are known.
    center: Option<Pair>,
    /// Step on the frame, pixels, for a step of one mesh across.
    across: Pair,
    /// Step on the frame, pixels, for a step of one mesh up.
    up: Pair,
}

impl Map {
    fn determinant(&self) -> f64 {
        self.across[0] * self.up[1] - self.across[1] * self.up[0]
    }

    /// Returns the largest distance by which a step of one mesh moves light, pixels.
    fn longest(&self) -> f64 {
        let [a, b, c, d] = [self.across[0], self.up[0], self.across[1], self.up[1]];
        let (sum, product) = (a * a + b * b + c * c + d * d, self.determinant());
        (0.5 * (sum + (sum * sum - 4.0 * product * product).max(0.0).sqrt())).sqrt()
    }

    /// Returns the smallest distance by which a step of one mesh moves light, pixels.
    fn shortest(&self) -> f64 {
        let longest = self.longest();
        if longest > 0.0 { self.determinant().abs() / longest } else { 0.0 }
    }

    fn half_diagonal(&self) -> f64 {
        let long = |sign: f64| length([self.across[0] + sign * self.up[0], self.across[1] + sign * self.up[1]]);
        0.5 * long(1.0).max(long(-1.0))
    }

    /// Returns the step on the frame for a step on the front, given in meshes.
    fn moved(&self, [x, y]: Pair) -> Pair {
        [self.across[0] * x + self.up[0] * y, self.across[1] * x + self.up[1] * y]
    }

    /// Transforms the normal of an edge on the front to the normal of its image on the frame, by the transposed inverse.
    fn normal(&self, [x, y]: Pair) -> Pair {
        let over = 1.0 / self.determinant();
        [over * (self.up[1] * x - self.across[1] * y), over * (self.across[0] * y - self.up[0] * x)]
    }
}

fn length([x, y]: Pair) -> f64 {
    (x * x + y * y).sqrt()
}

fn between(a: Pair, b: Pair) -> Pair {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

fn less(a: Pair, b: Pair) -> Pair {
    [a[0] - b[0], a[1] - b[1]]
}

/// A piece of an edge on the front, in meshes.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    middle: Pair,
    /// Unit vector toward the side where light is lost.
    out: Pair,
}

/// The survey of a path: the map, pieces of edges and folds of each mesh.
struct Survey {
    part: FrontRect,
    maps: Vec<Option<Map>>,
    /// Pieces of edges, with their meshes, mesh by mesh.
    stretches: Vec<(usize, Stretch)>,
    /// Landing points of folds, with their meshes, mesh by mesh.
    folds: Vec<(usize, Pair)>,
}

/// Number of nodes across.
const NODES: usize = SIDE + 1;

impl Survey {
    fn new(part: FrontRect, mut land: impl FnMut(&[Pair]) -> Vec<Option<Pair>>) -> Self {
        let place = |[x, y]: Pair| part.place([x / SIDE as f64, y / SIDE as f64]);
        let nodes: Vec<Pair> = (0..NODES * NODES).map(|at| [(at % NODES) as f64, (at / NODES) as f64]).collect();
        let mut at = |nodes: &[Pair]| land(&nodes.iter().map(|node| place(*node)).collect::<Vec<_>>());
        let landed = at(&nodes);
        let crossings = Crossings::found(&landed, &mut at);
        let of_mesh = |mesh: usize| crossings.stretches(mesh, &landed).into_iter().map(move |stretch| (mesh, stretch));
        let stretches = (0..SIDE * SIDE).flat_map(of_mesh).collect();
        let maps = filled((0..SIDE * SIDE).map(|mesh| map(corners(mesh).map(|node| landed[node]))).collect());
        let folds = folds(&maps, &landed);
        Self { part, maps, stretches, folds }
    }

    /// Returns the largest half side of footprints of rays through a mesh, ignoring edges.
    fn half(&self, at: usize, map: &Map) -> f64 {
        let mut half = (MESHES * map.shortest()).min(MOST_HALF);
        if let Some(center) = map.center {
            for (_, fold) in self.folds.iter().filter(|(mesh, _)| is_within(*mesh, at, FOLDS_WITHIN)) {
                half = half.min(OF_FOLD * length(less(*fold, center)));
            }
        }
        half.max(LEAST_AT_FOLD.min(MESHES * map.longest()))
    }

    /// Iterates over the edges around a mesh: the distance of each piece from the middle of the mesh, and the line on which it lies.
    fn lines<'a>(&'a self, at: usize, map: &'a Map) -> impl Iterator<Item = (f64, NearbyEdge)> + 'a {
        let middle = [(at % SIDE) as f64 + 0.5, (at / SIDE) as f64 + 0.5];
        let near = self.stretches.iter().filter(move |(mesh, _)| is_within(*mesh, at, EDGES_WITHIN));
        near.filter_map(move |(_, stretch)| {
            let normal = map.normal(stretch.out);
            let size = length(normal);
            if !size.is_finite() || size <= 0.0 {
                return None;
            }
            // Convert a step in meshes to one on the front.
            let (low, high) = (self.part.low, self.part.high);
            let meshes = [0, 1].map(|axis| SIDE as f64 / (high[axis] - low[axis]));
            let slope = [-stretch.out[0] * meshes[0] / size, -stretch.out[1] * meshes[1] / size];
            let on = self.part.place(stretch.middle.map(|at| at / SIDE as f64));
            let line = NearbyEdge { out: normal.map(|n| n / size), at: -(slope[0] * on[0] + slope[1] * on[1]), slope };
            Some((length(map.moved(less(stretch.middle, middle))), line))
        })
    }
}

/// Returns the nodes of a mesh: lower left, lower right, upper left, upper right.
fn corners(mesh: usize) -> [usize; 4] {
    let first = mesh / SIDE * NODES + mesh % SIDE;
    [first, first + 1, first + NODES, first + NODES + 1]
}

/// Returns whether a mesh is at most this many meshes away from another, across and up.
fn is_within(mesh: usize, from: usize, away: i64) -> bool {
    let side = SIDE as i64;
    let [(column, row), (own_column, own_row)] = [mesh, from].map(|at| (at as i64 % side, at as i64 / side));
    (column - own_column).abs() <= away && (row - own_row).abs() <= away
}

/// Iterates over a mesh and its neighbors up to this many meshes away.
fn around(mesh: usize, away: i64) -> impl Iterator<Item = usize> {
    let (column, row, side) = ((mesh % SIDE) as i64, (mesh / SIDE) as i64, SIDE as i64);
    let range = move |at: i64| (at - away).max(0)..(at + away + 1).min(side);
    range(row).flat_map(move |row| range(column).map(move |column| (row * side + column) as usize))
}

/// Computes the map of a mesh with at least three known corners.
fn map(corners: [Option<Pair>; 4]) -> Option<Map> {
    let step = |from: usize, to: usize| Some(less(corners[to]?, corners[from]?));
    let both = |a: Option<Pair>, b: Option<Pair>| match (a, b) {
        (Some(a), Some(b)) => Some(between(a, b)),
        (a, b) => a.or(b),
    };
    let (across, up) = (both(step(0, 1), step(2, 3))?, both(step(0, 2), step(1, 3))?);
    let center = match corners {
        [Some(a), Some(b), Some(c), Some(d)] => Some(between(between(a, b), between(c, d))),
        _ => None,
    };
    Some(Map { center, across, up })
}

/// Fills in meshes at an edge with too few known corners: they get the mean map of their neighbors.
fn filled(maps: Vec<Option<Map>>) -> Vec<Option<Map>> {
    let own = |at: usize| {
        if maps[at].is_some() {
            return maps[at];
        }
        let known: Vec<&Map> = around(at, 1).filter_map(|mesh| maps[mesh].as_ref()).collect();
        let mean = |of: fn(&Map) -> Pair| {
            [0, 1].map(|axis| known.iter().map(|map| of(map)[axis]).sum::<f64>() / known.len() as f64)
        };
        (!known.is_empty()).then(|| Map { center: None, across: mean(|map| map.across), up: mean(|map| map.up) })
    };
    (0..maps.len()).map(own).collect()
}

/// Finds the folds: between two neighboring meshes of which one is mapped directly and the other mirrored, light lies on a caustic.
fn folds(maps: &[Option<Map>], landed: &[Option<Pair>]) -> Vec<(usize, Pair)> {
    let mut folds = Vec::new();
    let is_mirrored =
        |mesh: usize| maps[mesh].as_ref().filter(|map| map.center.is_some()).map(|map| map.determinant() < 0.0);
    for mesh in 0..SIDE * SIDE {
        let own = corners(mesh);
        let right = (mesh % SIDE + 1 < SIDE).then_some((mesh + 1, [own[1], own[3]]));
        let above = (mesh / SIDE + 1 < SIDE).then_some((mesh + SIDE, [own[2], own[3]]));
        for (other, [a, b]) in right.into_iter().chain(above) {
            let folds_there = matches!((is_mirrored(mesh), is_mirrored(other)), (Some(a), Some(b)) if a != b);
            if let (true, Some(a), Some(b)) = (folds_there, landed[a], landed[b]) {
                folds.push((mesh, between(a, b)));
            }
        }
    }
    folds
}

/// The points on the lines between nodes where light begins to be lost: for each node, on the line to the right and on the line upward.
struct Crossings {
    across: Vec<Option<Pair>>,
    up: Vec<Option<Pair>>,
}

impl Crossings {
    fn found(landed: &[Option<Pair>], at: &mut impl FnMut(&[Pair]) -> Vec<Option<Pair>>) -> Self {
        let node = |at: usize| [(at % NODES) as f64, (at / NODES) as f64];
        let mut open: Vec<(usize, bool, Pair, Pair)> = Vec::new();
        for from in 0..NODES * NODES {
            let right = (from % NODES + 1 < NODES).then_some((from + 1, false));
            let above = (from / NODES + 1 < NODES).then_some((from + NODES, true));
            for (to, is_up) in right.into_iter().chain(above) {
                match (landed[from].is_some(), landed[to].is_some()) {
                    (true, false) => open.push((from, is_up, node(from), node(to))),
                    (false, true) => open.push((from, is_up, node(to), node(from))),
                    _ => {}
                }
            }
        }
        for _ in 0..HALVINGS {
            let middles: Vec<Pair> = open.iter().map(|(.., lit, dark)| between(*lit, *dark)).collect();
            let came = if middles.is_empty() { Vec::new() } else { at(&middles) };
            for (((.., lit, dark), middle), came) in open.iter_mut().zip(middles).zip(came) {
                *(if came.is_some() { lit } else { dark }) = middle;
            }
        }
        let mut own = Self { across: vec![None; NODES * NODES], up: vec![None; NODES * NODES] };
        for (from, is_up, lit, dark) in open {
            (if is_up { &mut own.up } else { &mut own.across })[from] = Some(between(lit, dark));
        }
        own
    }

    /// Finds the pieces of edges in a mesh, each from where the edge enters to where it leaves.
    fn stretches(&self, mesh: usize, landed: &[Option<Pair>]) -> Vec<Stretch> {
        let own = corners(mesh);
        let sides = [self.across[own[0]], self.up[own[1]], self.across[own[2]], self.up[own[0]]];
        let met: Vec<Pair> = sides.into_iter().flatten().collect();
        let node = |at: usize| [(at % NODES) as f64, (at / NODES) as f64];
        let stretch = |ends: &[Pair]| {
            let (a, b) = (*ends.first()?, *ends.get(1)?);
            let (middle, along) = (between(a, b), less(b, a));
            let size = length(along);
            let across = [along[1] / size, -along[0] / size];
            // Corners whose light is lost lie outside, others inside.
            let side = |at: usize| {
                let away = less(node(at), middle);
                let side = away[0] * across[0] + away[1] * across[1];
                if landed[at].is_some() { -side } else { side }
            };
            let outside: f64 = own.iter().map(|at| side(*at)).sum();
            (size > 0.0).then(|| Stretch { middle, out: if outside < 0.0 { across.map(|n| -n) } else { across } })
        };
        met.chunks(2).filter_map(stretch).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRAIGHT: Pair = [1.0, 0.0];

    /// A ghost of 200 pixels, round on the front at (0.1, -0.2) with radius 0.7, rotated and stretched on the way.
    fn round([x, y]: Pair) -> Option<Pair> {
        let inside = (x - 0.1).powi(2) + (y + 0.2).powi(2) < 0.49;
        inside.then_some([400.0 - 120.0 * x + 40.0 * y, 300.0 + 20.0 * x + 150.0 * y])
    }

    fn net(of: fn(Pair) -> Option<Pair>) -> ProbeGrid {
        ProbeGrid::new(FrontRect::ALL, |places| places.iter().map(|place| of(*place)).collect())
    }

    #[test]
    fn an_edge_is_where_light_is_lost() {
        let net = net(round);
        assert_eq!(net.footprint([0.1, -0.2], 6.0, STRAIGHT), Footprint { half: 6, edges: [None; 2] });
        assert_eq!(net.footprint([0.95, 0.9], 9.0, STRAIGHT), Footprint { half: 6, edges: [None; 2] });
        for k in 0..40 {
            let (sin, cos) = (f64::from(k) * 0.157).sin_cos();
            let place = [0.1 + 0.68 * cos, -0.2 + 0.68 * sin];
            let found = net.footprint(place, 5.0, STRAIGHT);
            let edge = found.edges[0].unwrap_or_else(|| panic!("no edge at {place:?}: {found:?}"));
            // Checks the distance to the outside along the direction that the edge has.
            let at = round(place).expect("inside");
            let ahead = |away: f64| {
                let [c, r] = [at[0] + away * edge.out[0] - 400.0, at[1] + away * edge.out[1] - 300.0];
                let over = -120.0 * 150.0 - 40.0 * 20.0;
                round([(150.0 * c - 40.0 * r) / over, (-120.0 * r - 20.0 * c) / over]).is_none()
            };
            assert!(!ahead(edge.away - 0.6) && ahead(edge.away + 0.6), "{k}: {edge:?}");
        }
    }

    /// A map folded along x = 0.25: light that lands near the caustic stays near it, light far from it is spread.
    #[test]
    fn footprints_are_small_near_a_fold() {
        let folded = |[x, y]: Pair| Some([300.0 * (x - 0.25) * (x - 0.25), 200.0 * y]);
        let net = net(folded);
        for x in [-0.6, -0.2, 0.1, 0.2, 0.3, 0.5, 0.8] {
            let half = net.footprint([x, 0.3], 10.0, STRAIGHT).half as f64;
            let away = 300.0 * (x - 0.25) * (x - 0.25);
            assert!(half <= (0.5 * away).max(LEAST_AT_FOLD) + 1.0, "{x}: {half} of {away}");
        }
        assert!(net.footprint([-0.6, 0.3], 10.0, STRAIGHT).half == 10);
    }

    #[test]
    fn small_ghosts_have_small_footprints() {
        let small = |[x, y]: Pair| (x * x + y * y < 0.5).then_some([10.0 * x, 10.0 * y]);
        assert!(net(small).footprint([0.0; 2], 8.0, STRAIGHT).half <= 2);
        assert_eq!(net(|_| None).footprint([0.0; 2], 4.0, STRAIGHT), Footprint { half: 4, edges: [None; 2] });
    }
}
