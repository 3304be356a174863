//! Ghosts: the light of two reflections in a picture is what an independent random walk of reflections brings there; the books
//! close; and the bits are the same however the work is done.

use spectra_core::frame::ExposureFrame;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Coating, Indices, Lens, Path as LightPath, Tracer, Travel};
use spectra_plugins as _;
use spectra_render::{Control, Light, Renderer, Rendering, Threads};
use spectra_scene::{FileResources, Scene};
use std::path::Path;

const COLUMNS: usize = 4;
const ROWS: usize = 3;
const REGIONS: usize = COLUMNS * ROWS;
const SEEDS: u64 = 4;

/// A point of light of one line, through a bare lens.
struct Setup {
    lens: &'static str,
    f_number: f64,
    field_deg: [f64; 2],
    frame_mm: [f64; 2],
    imager: f64,
    order: usize,
}

const BIOTAR: Setup = Setup {
    lens: "zeiss-biotar-50-f1.4",
    f_number: 2.0,
    field_deg: [11.0, 6.0],
    frame_mm: [36.0, 24.0],
    imager: 0.0,
    order: 2,
};
const DISTANCE_MM: f64 = 20_000.0;
const HE_NE_NM: f64 = 632.816;

impl Setup {
    fn scene(&self, set: &[&str]) -> Scene {
        let Self { lens, f_number, field_deg: [fx, fy], frame_mm: [width, height], imager, order } = self;
        let text = format!(
            "spectra: 1\n\
             source: {{kind: point, distance: {DISTANCE_MM}, field: [{fx} deg, {fy} deg], spectrum: he-ne, intensity: 1000}}\n\
             lens: {{file: {lens}, focus: infinity, coating: bare, absorption: false, f-number: {f_number}}}\n\
             imager: {{kind: xyz, width: {width}, height: {height}, resolution: [96, 66]}}\n\
             render: {{direction: forward, samples: 64, rays: 800000, reflections: {{order: {order}, imager: {imager}}}}}\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.yaml");
        std::fs::write(&path, text).expect("written");
        let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
        spectra_scene::load(&path, &set).unwrap_or_else(|faults| panic!("{faults}"))
    }

    /// A picture with the numbers of a seed.
    fn render(&self, seed: u64, set: &[&str]) -> Rendering {
        let seed = format!("render.seed={seed}");
        let renderer = Renderer::new(self.scene(&[set, &[&seed]].concat()), Isa::detect()).expect("ready");
        renderer.run(&Threads(2), &Control::new()).expect("rendered")
    }
}

/// Light of each region, in any unit.
fn regions(frame: &ExposureFrame) -> [f64; REGIONS] {
    let y = &frame.channel("Y").expect("an XYZ imager").values;
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let mut sums = [0.0; REGIONS];
    for (pixel, value) in y.iter().enumerate() {
        sums[pixel / width * ROWS / height * COLUMNS + pixel % width * COLUMNS / width] += f64::from(*value);
    }
    sums
}

/// Mean and standard error.
fn mean_of(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// A random ray that walks between surfaces and knows no paths: at each it splits, and both parts go on. Written without the
/// tracer: spheres by their two roots, Snell's law by the component across the normal, Fresnel's equations by both polarizations.
struct Walk {
    /// Vertex, curvature, clear radius (mm), and the index before and behind.
    surfaces: Vec<[f64; 5]>,
    image_z: f64,
    frame_mm: [f64; 2],
    imager: f64,
    order: usize,
    state: u64,
    /// What was reflected once more and not followed: all, and what no surface reflected totally before.
    left: [f64; 2],
}

/// Of light that was reflected twice a part goes on to be reflected again, with so much more weight.
const GOES_ON: f64 = 0.125;

impl Walk {
    fn new(lens: &Lens, setup: &Setup) -> Self {
        let surface = |e: &spectra_lens::Element| {
            let index = |medium| lens.index(medium, HE_NE_NM);
            let clear = e.semi_diameter_mm.expect("stated");
            [e.vertex_z_mm(), e.vertex_curvature_per_mm().0, clear, index(e.medium_before), index(e.medium_after)]
        };
        let surfaces = lens.elements.iter().map(surface).collect();
        Self {
            surfaces,
            image_z: lens.image_z_mm(),
            frame_mm: setup.frame_mm,
            imager: setup.imager,
            order: setup.order,
            state: 7,
            left: [0.0; 2],
        }
    }

    /// SplitMix64 (S. Vigna).
    fn number(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Whether light that is reflected once more is followed, and with what weight.
    fn goes_on(&mut self, bounces: usize) -> Option<f64> {
        if bounces >= self.order {
            return None;
        }
        if bounces != 2 {
            return Some(1.0);
        }
        (self.number() < GOES_ON).then_some(1.0 / GOES_ON)
    }

    /// Adds what one ray brings to the regions: straight, and by reflections.
    fn follow(&mut self, ray: Part, sums: &mut impl FnMut(usize, usize, f64)) {
        let Part { mut p, mut d, mut weight, mut gap, mut bounces, is_total } = ray;
        loop {
            if d[2] > 0.0 && gap == self.surfaces.len() {
                let t = (self.image_z - p[2]) / d[2];
                let [x, y] = [p[0] + t * d[0], p[1] + t * d[1]];
                let column = (0.5 - x / self.frame_mm[0]) * COLUMNS as f64;
                let row = (0.5 + y / self.frame_mm[1]) * ROWS as f64;
                if !(column >= 0.0 && row >= 0.0 && column < COLUMNS as f64 && row < ROWS as f64) {
                    return;
                }
                sums(bounces, row as usize * COLUMNS + column as usize, weight);
                if self.imager == 0.0 {
                    return;
                }
                let Some(more) = self.goes_on(bounces) else { return };
                weight *= self.imager * more;
                (p, d[2], bounces) = ([x, y, self.image_z], -d[2], bounces + 1);
                continue;
            }
            if d[2] < 0.0 && gap == 0 {
                return;
            }
            let forward = d[2] > 0.0;
            let [vertex, c, clear, n_before, n_behind] = self.surfaces[if forward { gap } else { gap - 1 }];
            let Some(t) = meet(p, d, vertex, c).filter(|t| *t > -1e-6) else { return };
            p = std::array::from_fn(|k| p[k] + t * d[k]);
            if p[0] * p[0] + p[1] * p[1] > clear * clear {
                return;
            }
            let (n, m) = if forward { (n_before, n_behind) } else { (n_behind, n_before) };
            if n != m {
                let mut normal = [-c * p[0], -c * p[1], 1.0 - c * (p[2] - vertex)];
                let mut cos = dot(normal, d);
                if cos < 0.0 {
                    (normal, cos) = (normal.map(|v| -v), -cos);
                }
                // What lies across the normal grows by the ratio of the indices.
                let across: [f64; 3] = std::array::from_fn(|k| (d[k] - cos * normal[k]) * n / m);
                let sine2 = dot(across, across);
                let inner = (1.0 - sine2).max(0.0).sqrt();
                let rs = (n * cos - m * inner) / (n * cos + m * inner);
                let rp = (m * cos - n * inner) / (m * cos + n * inner);
                let reflected = if sine2 >= 1.0 { 1.0 } else { 0.5 * (rs * rs + rp * rp) };
                let back: [f64; 3] = std::array::from_fn(|k| d[k] - 2.0 * cos * normal[k]);
                if bounces >= self.order {
                    self.left[0] += weight * reflected;
                    self.left[1] += if is_total || sine2 >= 1.0 { 0.0 } else { weight * reflected };
                } else if (back[2] > 0.0) != forward
                    && let Some(more) = self.goes_on(bounces)
                {
                    let (weight, is_total) = (weight * reflected * more, is_total || sine2 >= 1.0);
                    self.follow(Part { p, d: back, weight, gap, bounces: bounces + 1, is_total }, sums);
                }
                weight *= 1.0 - reflected;
                if weight == 0.0 {
                    return;
                }
                d = std::array::from_fn(|k| across[k] + inner * normal[k]);
            }
            gap = if forward { gap + 1 } else { gap - 1 };
        }
    }
}

/// A part of a ray: a place, a direction, in front of surface `gap` and behind the one before.
struct Part {
    p: [f64; 3],
    d: [f64; 3],
    weight: f64,
    gap: usize,
    bounces: usize,
    is_total: bool,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// How far along a ray it meets a sphere of this curvature, on the half about its vertex.
fn meet(p: [f64; 3], d: [f64; 3], vertex: f64, c: f64) -> Option<f64> {
    if c == 0.0 {
        return Some((vertex - p[2]) / d[2]);
    }
    let r = 1.0 / c;
    let from = [p[0], p[1], p[2] - vertex - r];
    let b = dot(from, d);
    let square = b * b - dot(from, from) + r * r;
    if square < 0.0 {
        return None;
    }
    // Light goes from the medium on one side of the vertex to that on the other: into a sphere whose center lies ahead, out of one
    // whose center lies behind.
    let t = if (r > 0.0) == (d[2] > 0.0) { -b - square.sqrt() } else { -b + square.sqrt() };
    ((p[2] + t * d[2] - vertex).abs() < r.abs()).then_some(t)
}

/// Twelve regions of the frame agree with the walk within four standard errors.
fn agrees(setup: &Setup, rays: usize, largest_error: f64) {
    let scene = setup.scene(&[]);
    let mut walk = Walk::new(&scene.lens, setup);
    let tangent = setup.field_deg.map(|deg| DISTANCE_MM * deg.to_radians().tan());
    // As far as a line can cross the plane of the first vertex that meets the glass behind it.
    let [_, c, clear, ..] = walk.surfaces[0];
    let sag = c * clear * clear / (1.0 + (1.0 - c * c * clear * clear).sqrt());
    let clear = clear + sag.abs() * tangent[0].hypot(tangent[1]) / DISTANCE_MM;
    // Straight, by two reflections, by four; and by two or four.
    let mut sums = [[[0.0_f64; 2]; REGIONS]; 4];
    for _ in 0..rays {
        let (r, turn) = (clear * walk.number().sqrt(), std::f64::consts::TAU * walk.number());
        let p = [r * turn.cos(), r * turn.sin(), 0.0];
        let d = [p[0] - tangent[0], p[1] - tangent[1], DISTANCE_MM];
        let length = dot(d, d).sqrt();
        let weight = (DISTANCE_MM / length).powi(3);
        let d = d.map(|v| v / length);
        let mut own = [[0.0_f64; REGIONS]; 4];
        walk.follow(Part { p, d, weight, gap: 0, bounces: 0, is_total: false }, &mut |bounces, region, weight| {
            own[bounces / 2][region] += weight;
            if bounces > 0 {
                own[3][region] += weight;
            }
        });
        for (sums, own) in sums.iter_mut().flatten().zip(own.as_flattened()) {
            *sums = [sums[0] + own, sums[1] + own * own];
        }
    }
    let n = rays as f64;
    let figure = |[sum, square]: [f64; 2]| (sum / n, ((square / n - (sum / n) * (sum / n)) / n).sqrt());
    // As if regions had nothing to do with each other.
    let total = |kind: usize| {
        let each = sums[kind].iter().map(|sum| figure(*sum));
        let (mean, square) = each.fold((0.0, 0.0), |(mean, square), (m, e)| (mean + m, square + e * e));
        (mean, square.sqrt())
    };
    // The straight light says what a unit of the walk is worth.
    let straight: Vec<[f64; REGIONS]> =
        (0..SEEDS).map(|s| regions(&setup.render(s, &["render.reflections.order=0"]).exposure)).collect();
    let unit = mean_of(straight.iter().map(|r| r.iter().sum())).0 / total(0).0;
    let ghosts: Vec<[f64; REGIONS]> = (0..SEEDS)
        .map(|seed| {
            let with = regions(&setup.render(seed, &[]).exposure);
            std::array::from_fn(|k| with[k] - straight[seed as usize][k])
        })
        .collect();
    let mut worst = 0.0_f64;
    for (region, sum) in sums[3].iter().enumerate() {
        let (mean, error) = mean_of(ghosts.iter().map(|g| g[region] / unit));
        let (want, of_walk) = figure(*sum);
        let sigma = error.hypot(of_walk);
        println!("{region}: {mean:.5e} +- {error:.1e}, walk {want:.5e} +- {of_walk:.1e}, {:.2}", (mean - want) / sigma);
        assert!(
            sigma < largest_error * want.max(0.2 * total(3).0 / REGIONS as f64),
            "region {region} is known to {sigma:e} only"
        );
        worst = worst.max((mean - want).abs() / sigma);
    }
    assert!(worst < 4.0, "{worst} standard errors");
    if setup.order > 2 {
        // Of four reflections alone, by the books: some thousand rays for each path.
        let ledger = setup.render(1, &["render.samples=1"]).ledger.expect("ghosts are traced");
        let four = ledger.paths.iter().filter(|path| path.surfaces.len() == 4);
        let booked = four.map(|path| path.power_w).sum::<f64>() / ledger.direct_w;
        let (straight, (want, error)) = (total(0).0, total(2));
        let (want, error) = (want / straight, error / straight);
        println!("four reflections: {booked:.4e}, walk {want:.4e} +- {error:.1e}");
        assert!(
            (booked - want).abs() < 4.0 * error.hypot(0.01 * want) && error < 0.05 * want,
            "{booked} {want} {error}"
        );
    }
}

#[test]
fn four_reflections_are_those_of_a_random_walk() {
    agrees(&Setup { order: 4, ..BIOTAR }, 160_000, 0.01);
}

#[test]
fn four_reflections_with_an_imager_that_reflects_too() {
    agrees(&Setup { order: 4, imager: 0.3, ..BIOTAR }, 220_000, 0.01);
}

#[test]
fn ghosts_of_a_double_gauss_are_those_of_a_random_walk() {
    agrees(&BIOTAR, 160_000, 0.01);
}

#[test]
fn with_an_imager_that_reflects_too() {
    agrees(&Setup { imager: 0.3, ..BIOTAR }, 220_000, 0.01);
}

#[test]
fn ghosts_of_a_fisheye_with_the_light_at_60_degrees() {
    let fisheye = Setup {
        lens: "minolta-fisheye-16-f2.7",
        f_number: 2.8,
        field_deg: [60.0, 0.0],
        frame_mm: [36.0, 24.0],
        imager: 0.0,
        order: 2,
    };
    // Little of what the large front takes in comes to the film, so it is a long walk that knows each region to 1 %.
    agrees(&fisheye, 9_000_000, 0.01);
}

/// Rays along fifteen paths of two reflections, against another program's: `xtask/ghost_rays.py`.
#[test]
fn ghost_rays_are_those_of_optiland() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let text = std::fs::read_to_string(data.join("ghost-rays.csv")).expect("a table");
    let (mut compared, mut paths) = (0, std::collections::BTreeSet::new());
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let lens = data.join("lenses").join(format!("{}.yaml", fields[0]));
        let own =
            spectra_lens::load(lens.to_str().expect("UTF-8"), &FileResources::beside(Path::new(""))).expect("a lens");
        let surface = |at: usize| fields[at].parse::<usize>().expect("a number") - 1;
        let v: Vec<f64> = fields[3..].iter().map(|f| f.parse().expect("a number")).collect();
        let traced = |lens: &Lens| {
            let tracer =
                Tracer::new(&lens.clone().with_coating(Coating::Bare), Indices::Stated, Isa::detect()).expect("media");
            let path =
                LightPath::reflected(tracer.surfaces(), Travel::Forward, &[surface(1), surface(2)]).expect("a path");
            let mut rays = RayBatch::new(1);
            rays.restart(1);
            let c = rays.columns_mut();
            [c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0]] = v[..6].try_into().expect("six");
            c.wavelength_nm[0] = 587.5618;
            tracer.follow(&tracer.route(&path), &mut rays, &mut tracer.work_in_place(1));
            rays
        };
        let mut wide = own.clone();
        wide.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
        let rays = traced(&wide);
        if rays.loss(0).is_some() {
            // Where surfaces without rims cross, Optiland goes back to the one that lies behind; no such ray is within the rims.
            assert!(traced(&own).loss(0).is_some(), "{row}");
            continue;
        }
        let ([x, y, z], [l, m, n]) = (rays.positions().map(|p| p[0]), rays.directions().map(|d| d[0]));
        let way = -z / n;
        let got = [x + way * l, y + way * m, l, m, n];
        for (got, want) in got.into_iter().zip(&v[6..]) {
            assert!((got - want).abs() < 1e-9, "{row}: {got:?}");
        }
        compared += 1;
        paths.insert(fields[..3].join(" "));
    }
    assert!(compared == 57 && paths.len() == 15, "{compared} rays of {} paths", paths.len());
}

/// Light along the axis, from surface `at` on forward or back, that nobody follows: what is reflected more than `order` times, and what
/// begins with less than `least` where it is reflected more than twice. Surfaces reflect these parts along their common normal.
fn beyond(
    parts: &[f64],
    (order, least): (usize, f64),
    reflected: usize,
    (mut at, step): (isize, isize),
    light: f64,
) -> f64 {
    let (mut light, mut left) = (light, 0.0);
    while let Some(part) = usize::try_from(at).ok().and_then(|at| parts.get(at)) {
        let back = light * part;
        left += if reflected < order && (reflected < 2 || back > least) {
            beyond(parts, (order, least), reflected + 1, (at - step, -step), back)
        } else {
            back
        };
        light -= back;
        at += step;
    }
    left
}

/// What is left after so many reflections, of the light that enters.
fn left(setup: &Setup, set: &[&str]) -> f64 {
    let rendering = setup.render(1, &[&["render.samples=1"], set].concat());
    let ledger = rendering.ledger.expect("ghosts are traced");
    let booked = ledger.detected_w() + ledger.lost_w() + ledger.not_traced_w;
    assert!((booked / ledger.emitted_w - 1.0).abs() < 1e-9, "{ledger:?}");
    assert_eq!(ledger.order as usize, setup.order);
    ledger.not_traced_w / ledger.emitted_w
}

/// Of a thin beam along the axis of a bare Biotar two reflections leave 1.6 % and four less than 0.1 %: the sum of products of Fresnel's
/// factors, in which the branches that are cut, with less than 1e-8, are 0.2 %.
#[test]
fn on_the_axis_reflections_leave_the_sum_of_products() {
    let setup = Setup { field_deg: [0.0; 2], f_number: 1.5, ..BIOTAR };
    let lens = setup.scene(&[]).lens;
    let reflectance = |e: &spectra_lens::Element| {
        let [n, m] = [e.medium_before, e.medium_after].map(|medium| lens.index(medium, HE_NE_NM));
        ((n - m) / (n + m)).powi(2)
    };
    let parts: Vec<f64> = lens.elements.iter().map(reflectance).collect();
    for (order, between) in [(2, [0.0155, 0.0165]), (4, [8e-4, 1e-3])] {
        let beam = "source={kind: beam, distance: 10 mm, diameter: 2 um, spectrum: he-ne}";
        let got = left(&Setup { order, ..setup }, &[beam]);
        let [want, whole] = [1e-8, 0.0].map(|least| beyond(&parts, (order, least), 0, (0, 1), 1.0));
        println!("{order}: {got:.6e}, {want:.6e}, nothing cut {whole:.6e}");
        assert!((got - want).abs() < 5e-8 && want < 1.003 * whole, "{order}: {got} {want} {whole}");
        assert!(got > between[0] && got < between[1], "{order}: {got}");
    }
}

/// Wide open four reflections leave half as much again as on the axis, and it is true: an independent walk leaves as much, and without
/// what is reflected totally no more than on the axis. Stopped down they leave less than 0.1 %.
#[test]
fn what_reflections_leave_is_what_a_random_walk_leaves() {
    for (order, f_number) in [(2, 1.5), (4, 1.5), (4, 16.0)] {
        let setup = Setup { field_deg: [0.0; 2], f_number, order, ..BIOTAR };
        let mut walk = Walk::new(&setup.scene(&[]).lens, &setup);
        let clear = walk.surfaces[0][2];
        let mut figures = [[0.0; 2]; 2];
        let n = 200_000;
        for _ in 0..n {
            let (r, turn) = (clear * walk.number().sqrt(), std::f64::consts::TAU * walk.number());
            let p = [r * turn.cos(), r * turn.sin(), 0.0];
            let d = [p[0], p[1], DISTANCE_MM];
            let length = dot(d, d).sqrt();
            walk.left = [0.0; 2];
            let part = Part { p, d: d.map(|v| v / length), weight: 1.0, gap: 0, bounces: 0, is_total: false };
            walk.follow(part, &mut |_, _, _| {});
            for (sums, own) in figures.iter_mut().zip(walk.left) {
                *sums = [sums[0] + own, sums[1] + own * own];
            }
        }
        let n = f64::from(n);
        let figure = |[sum, square]: [f64; 2]| (sum / n, ((square / n - (sum / n) * (sum / n)) / n).sqrt());
        let (got, [(want, error), (without, _)]) = (left(&setup, &[]), figures.map(figure));
        println!(
            "order {order}, f/{f_number}: {got:.3e}, walk {want:.3e} +- {error:.1e}, without total reflection {without:.3e}"
        );
        // The books are some thousand rays on a net.
        assert!((got - want).abs() < 4.0 * error.hypot(0.01 * want) && error < 0.02 * want, "{got} {want} {error}");
        match (order, f_number) {
            (2, _) => assert!((0.014..0.018).contains(&got), "{got}"),
            (_, 16.0) => assert!(got < 1e-3, "{got}"),
            _ => assert!(without < 1e-3, "{without}"),
        }
    }
}

/// Every watt is booked once.
#[test]
fn the_books_close() {
    for imager in [0.0, 0.2] {
        for (field_deg, f_number) in [([0.0; 2], 16.0), ([11.0, 6.0], 2.0), ([24.0, 0.0], 1.5)] {
            let rendering = Setup { field_deg, f_number, imager, ..BIOTAR }.render(1, &["render.samples=1"]);
            let ledger = rendering.ledger.expect("ghosts are traced");
            let booked = ledger.detected_w() + ledger.lost_w() + ledger.not_traced_w;
            assert!((booked / ledger.emitted_w - 1.0).abs() < 1e-9, "{ledger:?}");
            let all = [ledger.direct_w, ledger.ghosts_w, ledger.rims_w, ledger.absorbed_w, ledger.front_w];
            assert!(all.iter().all(|w| *w >= -1e-12 * ledger.emitted_w), "{ledger:?}");
            let by_path: f64 = ledger.paths.iter().map(|path| path.power_w).sum();
            assert!((by_path / ledger.ghosts_w - 1.0).abs() < 1e-12);
            assert_eq!(ledger.paths.len(), if imager > 0.0 { 55 } else { 45 });
        }
    }
}

/// What the estimator puts on the frame is what the books say, within the errors of both.
#[test]
fn the_picture_has_the_light_of_the_books() {
    let ghosts = |seed| {
        let [with, without] = ["2", "0"].map(|order| {
            let set = format!("render.reflections.order={order}");
            regions(&BIOTAR.render(seed, &[&set]).exposure).iter().sum::<f64>()
        });
        (with / without - 1.0, 0.0)
    };
    let (mean, error) = mean_of((0..SEEDS).map(|seed| ghosts(seed).0).collect::<Vec<_>>().into_iter());
    let ledger = BIOTAR.render(1, &[]).ledger.expect("ghosts are traced");
    let booked = ledger.ghosts_w / ledger.direct_w;
    assert!((mean - booked).abs() < 4.0 * error + 0.02 * booked, "{mean} +- {error}, booked {booked}");
}

fn bits(rendering: &Rendering) -> Vec<u32> {
    rendering.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
}

#[test]
fn threads_batches_and_steps_change_no_bit() {
    let renderer = |set: &[&str]| Renderer::new(BIOTAR.scene(set), Isa::detect()).expect("ready");
    let whole = renderer(&[]);
    let run = |r: &Renderer, threads| bits(&r.run(&Threads(threads), &Control::new()).expect("rendered"));
    let want = run(&whole, 1);
    assert_eq!(run(&whole, 3), want);
    assert_eq!(run(&renderer(&["render.batch=40"]), 2), want);
    let scalar = Renderer::new(BIOTAR.scene(&[]), Isa::Baseline).expect("ready");
    assert_eq!(run(&scalar, 2), want);
    // Three samples, saved, loaded, and the others.
    let (threads, control) = (Threads(2), Control::new());
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 3, &threads, &control).expect("rendered");
    let mut file = Vec::new();
    light.save(&mut file).expect("written");
    let mut light = Light::load(&whole, &mut &file[..]).expect("of this scene");
    whole.advance(&mut light, 64, &threads, &control).expect("rendered");
    assert_eq!(bits(&whole.look(whole.scene(), &light).expect("memory")), want);
    // What is searched before the first ray does not depend on how many samples are to come.
    let fewer = renderer(&["render.samples=3", "render.rays=37500"]);
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 3, &threads, &control).expect("rendered");
    assert!(bits(&whole.look(whole.scene(), &light).expect("memory")) == run(&fewer, 2));
}

/// Polarization moves some percent of the light of ghosts, and no more; without reflections the bits are those without the key.
#[test]
fn order_and_polarization_are_asked_for() {
    let ghosts = |set: &[&str]| BIOTAR.render(1, set).ledger.map(|ledger| ledger.ghosts_w);
    let (plain, polarized) = (ghosts(&[]), ghosts(&["render.reflections.polarized=true"]));
    let ratio = polarized.expect("traced") / plain.expect("traced");
    assert!((ratio - 1.0).abs() > 1e-3 && (ratio - 1.0).abs() < 0.1, "{ratio}");
    let off = BIOTAR.render(1, &["render.reflections.order=0"]);
    assert!(off.ledger.is_none() && off.estimators == ["forward"]);
    assert_eq!(BIOTAR.render(1, &[]).estimators, ["forward", "ghosts"]);
}
