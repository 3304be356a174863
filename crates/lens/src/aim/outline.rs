//! Outlines of what passes, and how rays are shared out over them.
//!
//! An outline is a fan of triangles about the middle of its zone, of nearly equal areas, one for each zone of angle, depth,
//! azimuth and wavelength. Numbers of the unit square choose a triangle and a place in it, neighbors to neighbors, so that
//! strata survive. Nearly all of them fill the outline; the last few are stretched over a ring around it, a triangle's share of
//! them by its area, so that the ring is filled evenly also where triangles are not alike. What the outline forgot is found
//! there, with a weight that is larger by a known factor, so the estimate has no bias.

use super::AimPattern;
use super::reach::CORNERS;
use super::table::{SLOTS, Table, azimuth_measure, whole};
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::{Loss, RayBatch};

/// Share of the rays that go to the outline itself.
const INSIDE: f64 = 0.9969;
/// The ring reaches this much farther than the outline, in proportion.
pub(super) const RING: f64 = 0.025;
/// The area of the ring, in areas of the outline. The mean of its numbers stands for 16.3 times as much as that of the others.
const AROUND: f64 = (1.0 + RING) * (1.0 + RING) - 1.0;
/// Corners of one outline, the first one twice, how it moves and grows over its zones of wavelength and depth, and [`thin`].
pub(super) const STRIDE: usize = CORNERS + 5;
/// Rays that are aimed at once: what is looked up for them stays in the first level of the cache.
const CHUNK: usize = 64;
/// Steps of the azimuth's measure in [`Outlines::turns`].
pub(super) const TURN_STEPS: usize = 4096;

/// The share of a triangle's numbers that go to the ring, for each mm2 of twice its area.
pub(super) fn thin(corners: &[[f32; 2]]) -> f32 {
    let doubled = corners.windows(2).map(|pair| {
        let ([ax, ay], [bx, by]) = (pair[0].map(f64::from), pair[1].map(f64::from));
        ax * by - ay * bx
    });
    let sum: f64 = doubled.sum();
    if sum > 0.0 { ((1.0 - INSIDE) * CORNERS as f64 / sum) as f32 } else { 0.0 }
}

/// Where in the band a wavelength lies: zones are narrower where glass disperses more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    pub from_nm: f64,
    pub to_nm: f64,
    /// Number of zones.
    pub zones: usize,
}

impl Colors {
    /// The wavelengths between zones, the ends of the band among them.
    pub fn nodes_nm(&self) -> Vec<f64> {
        let at = |k: usize| {
            // The root of x (1.6 - 0.6 x) = share.
            let share = k as f64 / self.zones as f64;
            let x = (1.6 - (2.56 - 2.4 * share).max(0.0).sqrt()) / 1.2;
            self.from_nm + x * (self.to_nm - self.from_nm)
        };
        if self.to_nm <= self.from_nm {
            return vec![self.from_nm];
        }
        (0..=self.zones).map(at).collect()
    }

    /// The zone of a wavelength.
    #[inline(always)]
    pub fn zone(&self, nm: f64) -> usize {
        whole(self.at(nm), (self.zones - 1) as f64)
    }

    /// A wavelength in zones from the lower end of the band; its ends stand for what is beyond.
    #[inline(always)]
    pub fn at(&self, nm: f64) -> f64 {
        let x = (nm - self.from_nm) * (1.0 / (self.to_nm - self.from_nm));
        // Also a band of no width has a zone.
        let x = if x > 0.0 { x } else { 0.0 };
        let x = if x < 1.0 { x } else { 1.0 };
        x * (1.6 - 0.6 * x) * self.zones as f64
    }
}

/// All outlines of a table.
#[derive(Clone, Debug)]
pub(super) struct Outlines {
    pub colors: Colors,
    /// Zones of the angle.
    pub zones: usize,
    /// Zones of the azimuth.
    pub azimuths: usize,
    /// The zone of an azimuth by its measure, where the table itself has none of its own.
    pub turns: Vec<u16>,
    /// Whether corners are along x and y of the lens, not along and across the plane of the point.
    pub turned: bool,
    /// By depth, azimuth, angle, wavelength: corners about the middle of the zone, then shifts from the lower to the upper end
    /// of its wavelengths and of its depths, along and across the plane of the point, mm; then its growth over both, in parts; then
    /// [`thin`].
    pub corners: Vec<[f32; 2]>,
}

impl Outlines {
    /// The same with every outline larger: whatever lay in it may be moved by `margin_mm`.
    pub fn widened(mut self, margin_mm: f64) -> Self {
        for outline in self.corners.chunks_exact_mut(STRIDE) {
            // Grown in proportion, each edge moves out by as much as it is away from the center.
            let (outline, more) = outline.split_at_mut(CORNERS + 1);
            let nearest = outline.windows(2).filter_map(|pair| {
                let ([ax, ay], [bx, by]) = (pair[0].map(f64::from), pair[1].map(f64::from));
                let length = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
                (length > 0.0).then(|| (ax * by - ay * bx) / length)
            });
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            let by = if nearest > 0.0 && nearest.is_finite() { 1.0 + margin_mm / nearest } else { 1.0 };
            outline.iter_mut().flatten().for_each(|c| *c = (f64::from(*c) * by) as f32);
            more[STRIDE - CORNERS - 2][0] = thin(outline);
        }
        self
    }
}

/// What is done for one batch.
pub(super) struct Draw<'a, const BACKWARD: bool, const RINGS: bool, const MANY: bool> {
    pub table: &'a Table,
    pub outlines: &'a Outlines,
    pub u: &'a [f64],
    pub v: &'a [f64],
    pub rays: &'a mut RayBatch,
}

/// Turns a batch to its places and says how many have ended.
pub(super) fn aim<const BACKWARD: bool>(
    table: &Table,
    outlines: &Outlines,
    rays: &mut RayBatch,
    [u, v]: [&[f64]; 2],
    pattern: AimPattern,
    isa: Isa,
) -> usize {
    match (pattern == AimPattern::Rings, table.rows.len() > 1) {
        (false, false) => isa.run(Draw::<BACKWARD, false, false> { table, outlines, u, v, rays }),
        (false, true) => isa.run(Draw::<BACKWARD, false, true> { table, outlines, u, v, rays }),
        (true, false) => isa.run(Draw::<BACKWARD, true, false> { table, outlines, u, v, rays }),
        (true, true) => isa.run(Draw::<BACKWARD, true, true> { table, outlines, u, v, rays }),
    }
}

/// What a chunk of rays looks up.
struct Looked {
    /// Row of the table, slot in it, azimuth's step, zone of the wavelength, triangle.
    at: [[u32; CHUNK]; 5],
    /// Where in its zones of wavelength and depth a ray is, -0.5 to 0.5.
    inner: [[f64; CHUNK]; 2],
    /// Ends of the outer edge of the triangle, mm.
    edge: [[f32; CHUNK]; 4],
    /// Middle of the zone: radial, across, axial; normal of its plane: radial, axial; 0 where nothing passes.
    zone: [[f64; CHUNK]; 6],
    /// How outlines change over the zone: shift along and across, mm; growth.
    drift: [[f64; CHUNK]; 4],
    /// How they change with wavelength and depth, as [`Outlines::corners`] has it behind the corners; and [`thin`].
    change: [[f32; CHUNK]; 7],
    /// Where in the zone the point is, -0.5 to 0.5.
    part: [f64; CHUNK],
    /// Unit vector from the axis to the point.
    out: [[f64; CHUNK]; 2],
    /// Place on the outer edge from its first end to its second, and the squared radius as a share of all.
    place: [[f64; CHUNK]; 2],
}

impl<const BACKWARD: bool, const RINGS: bool, const MANY: bool> Vectorized for Draw<'_, BACKWARD, RINGS, MANY> {
    type Output = usize;
    #[inline(always)]
    fn run(self) -> usize {
        let Self { table, outlines, u, v, rays } = self;
        let c = rays.columns_mut();
        let mut looked = Looked {
            at: [[0; CHUNK]; 5],
            inner: [[0.0; CHUNK]; 2],
            edge: [[0.0; CHUNK]; 4],
            zone: [[0.0; CHUNK]; 6],
            drift: [[0.0; CHUNK]; 4],
            change: [[0.0; CHUNK]; 7],
            part: [0.0; CHUNK],
            out: [[0.0; CHUNK]; 2],
            place: [[0.0; CHUNK]; 2],
        };
        let (mut dark, mut from) = (0, 0);
        while from < c.x.len() {
            let to = (from + CHUNK).min(c.x.len());
            let r = from..to;
            let (u, v) = (&u[r.clone()], &v[r.clone()]);
            let color = &c.wavelength_nm[r.clone()];
            look::<BACKWARD, RINGS, MANY>(
                table,
                outlines,
                u,
                v,
                &c.x[r.clone()],
                &c.y[r.clone()],
                &c.z[r.clone()],
                color,
                &mut looked,
            );
            dark += turn::<BACKWARD>(
                table,
                outlines.turned,
                &looked,
                &mut c.x[r.clone()],
                &mut c.y[r.clone()],
                &mut c.z[r.clone()],
                &mut c.l[r.clone()],
                &mut c.m[r.clone()],
                &mut c.n[r.clone()],
                &mut c.weight[r.clone()],
                &mut c.state[r],
            );
            from = to;
        }
        dark
    }
}

/// Numbers of the unit square as an equal share of the disk: the squared radius, and the azimuth in turns.
#[inline(always)]
fn disk<const RINGS: bool>(u: f64, v: f64) -> (f64, f64) {
    if RINGS {
        return (u, v);
    }
    // Shirley and Chiu's concentric map, without its sines.
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let wide = a.abs() > b.abs();
    let (r, other) = if wide { (a, b) } else { (b, a) };
    let eighth = 0.125 * (other / if r == 0.0 { 1.0 } else { r });
    let turns = if wide { eighth } else { 0.25 - eighth };
    let turns = if r < 0.0 { turns + 0.5 } else { turns };
    (r * r, if turns < 0.0 { turns + 1.0 } else { turns })
}

/// A number of a triangle as a squared radius in parts of the outline's, and how much of that it stands for, where `ring` is the
/// share of the numbers that go around it.
#[inline(always)]
fn within(squared: f64, ring: f64) -> (f64, f64) {
    let kept = 1.0 - ring;
    let inside = squared <= kept;
    let stands_for = if inside { 1.0 } else { AROUND } / if inside { kept } else { ring };
    (if inside { squared * stands_for } else { 1.0 + (squared - kept) * stands_for }, stands_for)
}

#[inline(always)]
fn look<const BACKWARD: bool, const RINGS: bool, const MANY: bool>(
    table: &Table,
    outlines: &Outlines,
    u: &[f64],
    v: &[f64],
    x: &[f64],
    y: &[f64],
    z: &[f64],
    color: &[f64],
    looked: &mut Looked,
) {
    let len = x.len().min(CHUNK);
    let (u, v, x, y, z, color) = (&u[..len], &v[..len], &x[..len], &y[..len], &z[..len], &color[..len]);
    // What needs no table, in vectors; then the tables, ray by ray.
    for i in 0..len {
        let (row, slot, ex, ey, zones) =
            table.place::<BACKWARD, MANY>(table.eye_z_mm, table.angle_scale, x[i], y[i], z[i]);
        let (squared, turns) = disk::<RINGS>(u[i], v[i]);
        let along = turns * CORNERS as f64;
        let triangle = whole(along, (CORNERS - 1) as f64);
        let shade = outlines.colors.at(color[i]);
        let band = whole(shade, (outlines.colors.zones - 1) as f64);
        looked.inner[0][i] = shade - band as f64 - 0.5;
        looked.inner[1][i] = table.depth_part::<BACKWARD>(x[i], y[i], z[i]);
        looked.part[i] = zones - slot as f64 - 0.5;
        looked.out[0][i] = ex;
        looked.out[1][i] = ey;
        looked.place[0][i] = along - triangle as f64;
        looked.place[1][i] = squared;
        looked.at[0][i] = row as u32;
        looked.at[1][i] = slot as u32;
        looked.at[3][i] = band as u32;
        looked.at[4][i] = triangle as u32;
    }
    if !outlines.turns.is_empty() {
        for i in 0..len {
            let measure = azimuth_measure(looked.out[0][i], looked.out[1][i]);
            looked.at[2][i] = whole(measure * (0.25 * TURN_STEPS as f64), TURN_STEPS as f64) as u32;
        }
    }
    for i in 0..len {
        let [row, slot, step, band, triangle] = looked.at.each_ref().map(|column| column[i] as usize);
        let slot = slot & (SLOTS - 1);
        let f = &table.rows[row].0[slot];
        let mut at = row;
        if !outlines.turns.is_empty() {
            at = row * outlines.azimuths + usize::from(outlines.turns[step & (TURN_STEPS - 1)]);
        }
        let at = at * outlines.zones + slot.min(outlines.zones - 1);
        let first = (at * outlines.colors.zones + band) * STRIDE;
        let outline = &outlines.corners[first..first + STRIDE];
        let [[sa, sc], [da, dc], [gc, gd], [thin, _]] = std::array::from_fn(|k| outline[CORNERS + 1 + k]);
        for (column, value) in looked.change.iter_mut().zip([sa, sc, da, dc, gc, gd, thin]) {
            column[i] = value;
        }
        let [a, b] = [outline[triangle], outline[triangle + 1]];
        for (column, value) in looked.edge.iter_mut().zip([a[0], a[1], b[0], b[1]]) {
            column[i] = value;
        }
        for (column, field) in looked.zone.iter_mut().zip([0, 1, 2, 6, 7, 8]) {
            column[i] = f[field];
        }
        for (column, value) in looked.drift.iter_mut().zip(&f[10..14]) {
            column[i] = *value;
        }
    }
}

/// Columns come as arguments of their own: so the compiler knows that none overlaps another.
#[inline(always)]
fn turn<const BACKWARD: bool>(
    table: &Table,
    turned: bool,
    looked: &Looked,
    x: &mut [f64],
    y: &mut [f64],
    z: &mut [f64],
    l: &mut [f64],
    m: &mut [f64],
    n: &mut [f64],
    weight: &mut [f64],
    state: &mut [u64],
) -> usize {
    let len = x.len().min(CHUNK);
    let (x, y, z) = (&mut x[..len], &mut y[..len], &mut z[..len]);
    let (l, m, n) = (&mut l[..len], &mut m[..len], &mut n[..len]);
    let (weight, state) = (&mut weight[..len], &mut state[..len]);
    let ended = Loss::Vignetted.state(table.surface);
    let [zr, za, zz, nr, nz, area] = &looked.zone;
    let [out_x, out_y] = &looked.out;
    let [on_edge, squared] = &looked.place;
    let [by_color, by_depth] = &looked.inner;
    let [shift_a, shift_c, growth_a, growth_c] = &looked.drift;
    let mut dark = 0_u64;
    for i in 0..len {
        let (ex, ey) = (out_x[i], out_y[i]);
        let [ax, ay, bx, by] = looked.edge.each_ref().map(|column| f64::from(column[i]));
        let [color_a, color_c, depth_a, depth_c, of_color, of_depth, thin] =
            looked.change.each_ref().map(|column| f64::from(column[i]));
        let (color, depth) = (by_color[i], by_depth[i]);
        let size = 1.0 + color * of_color + depth * of_depth;
        let (moved_a, moved_c) = (color * color_a + depth * depth_a, color * color_c + depth * depth_c);
        let doubled = ax * by - ay * bx;
        let (radius2, stands_for) = within(squared[i], thin * doubled);
        let radius = radius2.sqrt() * size;
        let p = radius * (ax + on_edge[i] * (bx - ax));
        let q = radius * (ay + on_edge[i] * (by - ay));
        let (along, beside) = if turned { (p * ex + q * ey, q * ex - p * ey) } else { (p, q) };
        let part = looked.part[i];
        let (grown_a, grown_c) = (1.0 + part * growth_a[i], 1.0 + part * growth_c[i]);
        let (along, beside) =
            (along * grown_a + (part * shift_a[i] + moved_a), beside * grown_c + (part * shift_c[i] + moved_c));
        let radial = zr[i] + along * nz[i];
        let across = za[i] + beside;
        let tx = radial * ex - across * ey;
        let ty = radial * ey + across * ex;
        let tz = table.eye_z_mm + (zz[i] - along * nr[i]);
        let (dx, dy, dz) = (tx - x[i], ty - y[i], tz - z[i]);
        let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
        let (dl, dm, dn) = (dx * inverse, dy * inverse, dz * inverse);
        let cosine = ((dl * ex + dm * ey) * nr[i] + dn * nz[i]).abs();
        let mm2 = 0.5 * CORNERS as f64 * stands_for * doubled * (size * size) * (grown_a * grown_c);
        let mut solid_angle = mm2 * cosine * inverse * inverse;
        if BACKWARD {
            // The imager's normal stands in the place of the direction.
            let facing = dl * l[i] + dm * m[i] + dn * n[i];
            solid_angle *= if facing > 0.0 { facing } else { 0.0 };
        }
        let none = area[i] == 0.0;
        weight[i] *= if none { 0.0 } else { solid_angle };
        dark += u64::from(none);
        state[i] = if none { ended } else { state[i] };
        (x[i], y[i], z[i]) = (tx, ty, tz);
        (l[i], m[i], n[i]) = (dl, dm, dn);
    }
    dark as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The map keeps area: equal shares of the square are equal shares of the disk, in triangles and rings.
    #[test]
    fn numbers_fill_the_disk_evenly() {
        // Cells are this much finer than their edges can be seen to lie.
        let n = 2048;
        let mut cells = [[0_u32; 8]; 8];
        for k in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64;
            let (squared, turns) = disk::<false>(at(k % n), at(k / n));
            assert!((0.0..=1.0).contains(&squared) && (0.0..=1.0).contains(&turns));
            cells[((squared * 8.0) as usize).min(7)][((turns * 8.0) as usize).min(7)] += 1;
            let (p, q) = spectra_core::math::concentric_disk(at(k % n), at(k / n));
            let (sin, cos) = spectra_core::math::sin_cos_turns(turns);
            let r = squared.sqrt();
            assert!((r * cos - p).abs() < 1e-14 && (r * sin - q).abs() < 1e-14);
        }
        for count in cells.iter().flatten() {
            assert!((f64::from(*count) / (n * n) as f64 * 64.0 - 1.0).abs() < 0.01, "{count}");
        }
    }

    #[test]
    fn numbers_stand_for_outline_and_ring() {
        let n = 1 << 20;
        for ring in [0.0, 0.2 * (1.0 - INSIDE), 1.0 - INSIDE, 0.2] {
            // Each number stands for what lies between it and the next one.
            let (mut sum, mut last) = (0.0, 0.0);
            for k in 0..n {
                let (radius2, stands_for) = within((k as f64 + 0.5) / n as f64, ring);
                assert!(radius2 > last, "{ring}: {radius2} after {last}");
                (sum, last) = (sum + stands_for / n as f64, radius2);
            }
            let want = if ring > 0.0 { (1.0 + RING) * (1.0 + RING) } else { 1.0 };
            assert!((last / want - 1.0).abs() < 1e-4 && (sum / want - 1.0).abs() < 1e-4, "{ring}: {last} {sum}");
        }
        assert_eq!(within(1.0, 0.0), (1.0, 1.0));
    }

    #[test]
    fn zones_of_wavelength_begin_at_their_nodes() {
        let colors = Colors { from_nm: 350.0, to_nm: 830.0, zones: 4 };
        let nodes = colors.nodes_nm();
        assert!((nodes[0] - 350.0).abs() < 1e-9 && (nodes[4] - 830.0).abs() < 1e-9);
        for k in 0..4 {
            assert!(nodes[k + 1] - nodes[k] > 50.0);
            assert_eq!(colors.zone(nodes[k] + 0.01), k);
            assert_eq!(colors.zone(nodes[k + 1] - 0.01), k);
        }
        assert_eq!((colors.zone(0.0), colors.zone(1e4)), (0, 3));
        let one = Colors { from_nm: 550.0, to_nm: 550.0, zones: 1 };
        assert_eq!(one.zone(550.0), 0);
    }
}
