//! Distributes rays over outlines: see [`super::outline`].

use super::measure::{azimuth_measure, whole};
use super::outline::{Outlines, RING, STRIDE, TURN_STEPS};
use super::part::{AimPart, RIM_EVERY};
use super::star_region::CORNERS;
use super::table::{SLOTS, Table};
use super::toward::toward;
use spectra_core::isa::Vectorized;
use spectra_core::{Loss, RayBatch};

/// Area of the ring relative to the outline. For [`AimPart::Whole`] the mean of its numbers counts 16.3 times as much as that of the
/// others.
const AROUND: f64 = (1.0 + RING) * (1.0 + RING) - 1.0;
/// Number of rays that are aimed at once: the data looked up for them stays in the first-level cache.
const CHUNK: usize = 64;

/// Squared radius of the core relative to the outline. The rim contains most of the part of an outline that passes no light.
const CORE: f64 = 0.986;
/// Fraction of the rim's numbers that goes around the outline, relative to that of the whole: a ray there weighs 0.8 times one of the
/// whole's.
const RIM_THIN: f64 = 20.0;
/// Largest fraction of a triangle's numbers that goes around the outline.
const MOST_THIN: f64 = 0.5;

/// The distribution of the numbers of one part over outline and ring.
#[derive(Clone, Copy)]
struct Cast {
    /// Squared radii within the outline, relative to the outline.
    from: f64,
    to: f64,
    /// Fraction of the numbers that goes around the outline, in units of [`super::outline::thin`].
    ring: f64,
    /// Factor of the weight of each number besides its area.
    each: f64,
}

impl Cast {
    fn of(part: AimPart) -> Self {
        match part {
            AimPart::Whole => Self { from: 0.0, to: 1.0, ring: 1.0, each: 1.0 },
            AimPart::Core => Self { from: 0.0, to: CORE, ring: 0.0, each: 1.0 },
            AimPart::Rim => Self { from: CORE, to: 1.0, ring: RIM_THIN, each: f64::from(RIM_EVERY) },
        }
    }
}

/// Kernel that aims one batch at outlines.
struct Draw<'a, const BACKWARD: bool, const RINGS: bool, const MANY: bool> {
    table: &'a Table,
    outlines: &'a Outlines,
    cast: Cast,
    u: &'a [f64],
    v: &'a [f64],
    rays: &'a mut RayBatch,
}

/// Aims a batch at its points of the pupil and returns how many rays have ended.
pub(super) fn aim<const BACKWARD: bool>(
    table: &Table,
    outlines: &Outlines,
    rays: &mut RayBatch,
    [u, v]: [&[f64]; 2],
    rings: bool,
    part: AimPart,
) -> usize {
    let isa = rays.isa();
    let cast = Cast::of(part);
    match (rings, table.rows.len() > 1) {
        (false, false) => isa.run(Draw::<BACKWARD, false, false> { table, outlines, cast, u, v, rays }),
        (false, true) => isa.run(Draw::<BACKWARD, false, true> { table, outlines, cast, u, v, rays }),
        (true, false) => isa.run(Draw::<BACKWARD, true, false> { table, outlines, cast, u, v, rays }),
        (true, true) => isa.run(Draw::<BACKWARD, true, true> { table, outlines, cast, u, v, rays }),
    }
}

/// The values that a chunk of rays looks up.
struct Looked {
    /// Row of the table, slot in the row, step of the azimuth, wavelength zone, triangle.
    at: [[u32; CHUNK]; 5],
    /// Position of a ray in its wavelength zone and depth zone, -0.5 to 0.5.
    inner: [[f64; CHUNK]; 2],
    /// Ends of the outer edge of the triangle, mm.
    edge: [[f32; CHUNK]; 4],
    /// Middle of the zone: radial, across, axial, in mm; normal of its plane: radial, axial; area in mm^2, 0 if no light passes.
    zone: [[f64; CHUNK]; 6],
    /// Change of outlines over the zone: shift along and across, mm; growth along and across.
    drift: [[f64; CHUNK]; 4],
    /// Change of outlines with wavelength and depth, as in [`Outlines::corners`] behind the corners; and [`thin`](super::outline::thin).
    change: [[f32; CHUNK]; 7],
    /// Position of the point in its zone of the angle, -0.5 to 0.5.
    part: [f64; CHUNK],
    /// Unit vector from the axis to the point.
    out: [[f64; CHUNK]; 2],
    /// Position on the outer edge from its first to its second end, and the squared radius, each 0 to 1.
    place: [[f64; CHUNK]; 2],
}

impl<const BACKWARD: bool, const RINGS: bool, const MANY: bool> Vectorized for Draw<'_, BACKWARD, RINGS, MANY> {
    type Output = usize;
    #[inline(always)]
    fn run(self) -> usize {
        let Self { table, outlines, cast, u, v, rays } = self;
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
                cast,
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

/// Maps numbers of the unit square to the disk, keeping areas: returns the squared radius and the azimuth in turns.
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

/// Maps a number of a triangle to a squared radius relative to the outline, and returns the weight that it stands for. `thin` is the
/// fraction of the numbers that go around the outline when rays go all over it.
#[inline(always)]
fn within(squared: f64, thin: f64, cast: Cast) -> (f64, f64) {
    let ring = thin * cast.ring;
    let ring = if ring < MOST_THIN { ring } else { MOST_THIN };
    let kept = 1.0 - ring;
    let inside = squared <= kept;
    let stands_for = if inside { cast.to - cast.from } else { AROUND } / if inside { kept } else { ring };
    let radius2 = if inside { cast.from + squared * stands_for } else { 1.0 + (squared - kept) * stands_for };
    (radius2, stands_for * cast.each)
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
    // First everything that needs no table, in vectors; then the table lookups, ray by ray.
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

/// Aims the rays of a chunk with the looked-up values. Columns are separate arguments, so that the compiler knows that none overlaps
/// another.
#[inline(always)]
fn turn<const BACKWARD: bool>(
    table: &Table,
    turned: bool,
    cast: Cast,
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
        let (radius2, stands_for) = within(squared[i], thin * doubled, cast);
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
        let mm2 = 0.5 * CORNERS as f64 * stands_for * doubled * (size * size) * (grown_a * grown_c);
        let (point, facing) = ([x[i], y[i], z[i]], [l[i], m[i], n[i]]);
        let ([dl, dm, dn], solid_angle) =
            toward::<BACKWARD>(point, [tx, ty, tz], [ex, ey], [nr[i], nz[i]], mm2, facing);
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
    use super::super::outline::INSIDE;
    use super::*;

    /// The map keeps areas: equal fractions of the square are equal fractions of the disk, in triangles and rings.
    #[test]
    fn numbers_fill_the_disk_evenly() {
        // The grid is much finer than the accuracy that is tested.
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
        let [whole, core, rim] = [AimPart::Whole, AimPart::Core, AimPart::Rim].map(Cast::of);
        for ring in [0.0, 0.2 * (1.0 - INSIDE), 1.0 - INSIDE, 0.2] {
            let around = if ring > 0.0 { (1.0 + RING) * (1.0 + RING) } else { 1.0 };
            for (cast, from, to) in [(whole, 0.0, around), (core, 0.0, CORE), (rim, CORE, around)] {
                // Each number stands for the area between it and the next one, and for its fraction of the rays.
                let (mut sum, mut last) = (0.0, from);
                for k in 0..n {
                    let (radius2, stands_for) = within((k as f64 + 0.5) / n as f64, ring, cast);
                    assert!(radius2 > last, "{ring}: {radius2} after {last}");
                    (sum, last) = (sum + stands_for / cast.each / n as f64, radius2);
                }
                assert!((last / to - 1.0).abs() < 1e-4, "{ring}: {last}, not {to}");
                assert!((sum / (to - from) - 1.0).abs() < 1e-4, "{ring}: {sum} from {from} to {to}");
            }
        }
        assert_eq!(within(1.0, 0.0, whole), (1.0, 1.0));
    }
}
