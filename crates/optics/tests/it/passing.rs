//! Nearly all rays that are aimed at a lens pass its stop and its rims, whatever the stop and the lens, and no
//! light that passes is missed.

use glam::DVec3;
use spectra_core::numbers::Numbers;
use spectra_core::{Isa, RayBatch, loss::ALIVE};
use spectra_lens::{Aperture, ApertureShape, Iris, Lens};
use spectra_optics::{AimPart, AimPattern, Effort, FrontPupil, RIM_EVERY, RearPupil, stop_down};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;
use std::time::Instant;

const BAND_NM: [f64; 2] = [350.0, 830.0];
/// Number of rays on the axis, and over the whole frame.
const RAYS: usize = 1 << 15;
/// Number of points of the frame from which weights are examined.
const WEIGHED: usize = 64;

fn load(name: &str) -> Lens {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    spectra_lens::load(name, &FileResources::beside(root)).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Width and height of the frames that `docs/lenses.md` shows lenses at, mm (as in `plugins/imagers/src/formats.rs`).
const FRAMES: [(&str, [f64; 2]); 5] = [
    ("135", [36.0, 24.0]),
    ("6x4.5", [56.0, 41.5]),
    ("6x9", [84.0, 56.0]),
    ("academy", [22.0, 16.0]),
    ("super-35", [24.89, 18.67]),
];

/// Returns every lens of the library that takes pictures: name, frame and f-number.
fn library() -> Vec<(String, [f64; 2], f64)> {
    let sheet = include_str!("../../../../docs/lenses.md");
    let of = |line: &str| {
        let (name, rest) = line.strip_prefix('`')?.split_once("`: ")?;
        let format = rest.split(". Source").next()?.rsplit(", ").next()?;
        let frame = FRAMES.iter().find(|f| f.0 == format).unwrap_or_else(|| panic!("{name}: no frame {format}"));
        let f_number = rest.split_once(" f/")?.1.split([',', '.']).take(2).collect::<Vec<_>>().join(".");
        Some((name.to_owned(), frame.1, f_number.parse().unwrap_or_else(|_| panic!("{name}: f/{f_number}"))))
    };
    let lenses: Vec<_> = sheet.lines().filter_map(of).collect();
    let bundled = spectra_data::list("lenses/").filter(|path| !path.contains("surfaces/") && !path.contains("prism"));
    assert_eq!(lenses.len(), bundled.count(), "docs/lenses.md shows every lens");
    lenses
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Opening {
    Round,
    Blades,
    Star,
}

/// Returns the lens with an opening in its stop.
fn with(mut lens: Lens, opening: Opening) -> Lens {
    if opening == Opening::Round {
        return lens;
    }
    let at = lens.stop().expect("a lens that takes pictures has a stop");
    let semi_mm = lens.elements[at].semi_diameter_mm.expect("of a known size");
    let shape = match opening {
        Opening::Round | Opening::Blades => {
            ApertureShape::Iris(Iris { blades: 7, blade_radius_mm: f64::INFINITY, rotation_rad: 0.2 })
        }
        // The page of the file is 24 mm wide, its tips lie on a circle of 20 mm.
        Opening::Star => {
            let star = include_bytes!("../../../../scenes/star.svg");
            let drawing = spectra_masks::read("star.svg", star, Some(2.4 * semi_mm), None);
            ApertureShape::Drawing(drawing.unwrap_or_else(|faults| panic!("{faults}")))
        }
    };
    lens.elements[at].apertures.push(Aperture { shape, center_mm: [0.0; 2], obscures: false });
    lens
}

fn tracer(lens: &Lens) -> Tracer {
    Tracer::new(lens, Indices::Band { min_nm: BAND_NM[0], max_nm: BAND_NM[1] }).expect("media")
}

fn numbers(seed: u64, dimension: u32, n: usize) -> Vec<f64> {
    let mut column = vec![0.0; n];
    Numbers::random(seed).fill(Isa::Baseline, 0, 0, dimension, &mut column);
    column
}

/// The pupil at which rays start, for one of the two directions of travel.
enum Pupil {
    Rear(RearPupil),
    Part(RearPupil, AimPart),
    Front(FrontPupil),
}

impl Pupil {
    fn travel(&self) -> Travel {
        if matches!(self, Self::Front(_)) { Travel::Forward } else { Travel::Backward }
    }

    fn without_outlines(self) -> Self {
        match self {
            Self::Rear(p) | Self::Part(p, _) => Self::Rear(p.without_outlines()),
            Self::Front(p) => Self::Front(p.without_outlines()),
        }
    }

    /// Returns the largest weight of a ray from these points, relative to the mean weight of the rays from the same point. It covers
    /// numbers all over the unit square and numbers at its edge, which are aimed around the outline.
    fn largest_weight(&self, points: &[DVec3]) -> f64 {
        const RIM: usize = 1 << 10;
        const ALL: usize = 1 << 11;
        let (mut u, mut v) = (numbers(31, 0, ALL), numbers(31, 1, ALL));
        for k in 0..RIM {
            let along = ((k / 4) as f64 + 0.5) / (RIM / 4) as f64;
            let far = 1.0 - 1e-6;
            let (a, b) = [(along, far), (along, 1.0 - far), (far, along), (1.0 - far, along)][k % 4];
            u.push(a);
            v.push(b);
        }
        let mut rays = RayBatch::new(ALL + RIM);
        let mut largest = 0.0_f64;
        for (k, point) in points.iter().enumerate() {
            rays.restart(ALL + RIM);
            let c = rays.columns_mut();
            c.x.fill(point.x);
            c.y.fill(point.y);
            c.z.fill(point.z);
            c.n.fill(-1.0);
            c.wavelength_nm.fill(BAND_NM[0] + (k as f64 + 0.5) / points.len() as f64 * (BAND_NM[1] - BAND_NM[0]));
            self.aim(&mut rays, &u, &v);
            let weights = rays.weights();
            let mean = weights[..ALL].iter().sum::<f64>() / ALL as f64;
            if mean > 0.0 {
                largest = weights.iter().fold(largest, |largest, weight| largest.max(weight / mean));
            }
        }
        largest
    }

    fn aim(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) -> usize {
        match self {
            Self::Rear(p) => p.aim(rays, u, v),
            Self::Part(p, part) => p.aim_part(rays, u, v, *part),
            Self::Front(p) => p.aim(rays, u, v, AimPattern::Disk),
        }
    }
}

/// Returns points spread evenly over a frame of film, mm.
fn film(frame: [f64; 2], n: usize) -> Vec<DVec3> {
    let (u, v) = (numbers(11, 0, n), numbers(11, 1, n));
    (0..n).map(|i| DVec3::new((u[i] - 0.5) * frame[0], (v[i] - 0.5) * frame[1], 0.0)).collect()
}

/// Returns the middle and the corners of a frame, mm.
fn corners(frame: [f64; 2]) -> Vec<DVec3> {
    let [w, h] = frame.map(|side| 0.5 * side);
    [[0.0, 0.0], [w, h], [-w, h], [w, -h], [-w, -h]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec()
}

/// The outcome of rays from a list of points: numbers of rays launched and arrived, and the weight of each ray that arrived.
struct Outcome {
    launched: usize,
    arrived: usize,
    values: Vec<f64>,
}

fn outcome(tracer: &Tracer, pupil: &Pupil, points: &[DVec3], seed: u64) -> Outcome {
    const BATCH: usize = 4096;
    let n = points.len();
    let columns: [Vec<f64>; 3] = std::array::from_fn(|d| numbers(seed, d as u32, n));
    let mut rays = RayBatch::new(BATCH);
    let mut work = tracer.work_in_place(BATCH);
    let mut out = Outcome { launched: 0, arrived: 0, values: Vec::with_capacity(n) };
    for first in (0..n).step_by(BATCH) {
        let len = BATCH.min(n - first);
        rays.restart(len);
        let c = rays.columns_mut();
        for i in 0..len {
            (c.x[i], c.y[i], c.z[i]) = points[first + i].into();
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, -1.0);
            c.wavelength_nm[i] = BAND_NM[0] + columns[2][first + i] * (BAND_NM[1] - BAND_NM[0]);
        }
        pupil.aim(&mut rays, &columns[0][first..first + len], &columns[1][first..first + len]);
        // From points from which nothing passes, no rays are launched into the lens.
        out.launched += rays.alive();
        let weights = rays.weights().to_vec();
        tracer.trace(&mut rays, &mut work, pupil.travel());
        for (weight, state) in weights.iter().zip(rays.states()) {
            let passes = *state == ALIVE;
            out.arrived += usize::from(passes);
            out.values.push(if passes { *weight } else { 0.0 });
        }
    }
    out
}

impl Outcome {
    fn lost(&self) -> f64 {
        1.0 - self.arrived as f64 / self.launched as f64
    }
}

/// Returns the mean and its standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn rear(lens: &Lens, tracer: &Tracer, frame: [f64; 2]) -> Pupil {
    let rear = RearPupil::search(lens, tracer, &corners(frame), BAND_NM[0], BAND_NM[1]);
    Pupil::Rear(rear.expect("the lens has an aperture"))
}

/// Returns the front pupil and distant points that the frame sees: those from which light reaches random points of the film.
fn front(lens: &Lens, tracer: &Tracer, frame: [f64; 2], n: usize) -> (Pupil, Vec<DVec3>) {
    let efl_mm = lens.first_order(lens.reference_nm).efl_mm.abs();
    let far = 100.0 * efl_mm;
    // Use the angle instead of the tangent, limited to 1.4 rad: a fisheye sees no plane.
    let points: Vec<DVec3> = film(frame, n)
        .iter()
        .map(|p| {
            let angle = (p.truncate().length() / efl_mm).min(1.4);
            let way = p.truncate().normalize_or_zero() * spectra_core::math::sin(angle);
            DVec3::new(-way.x, -way.y, -spectra_core::math::cos(angle)) * far
        })
        .collect();
    let pupil = FrontPupil::search(lens, tracer, &points[..64.min(n)], BAND_NM[0], BAND_NM[1]);
    (Pupil::Front(pupil.expect("the lens has an aperture")), points)
}

/// Prints one line of the table, percentages of lost rays on the axis and over the frame, with outlines and without, backward and forward.
/// Returns the values with outlines and the largest weight.
fn row(name: &str, lens: &Lens, frame: [f64; 2], n: usize, forward: bool) -> [f64; 5] {
    let tracer = tracer(lens);
    let start = Instant::now();
    let pupil = rear(lens, &tracer, frame);
    let searched = start.elapsed();
    let axis = vec![DVec3::ZERO; n];
    let points = film(frame, n);
    let mut weight = pupil.largest_weight(&points[..WEIGHED]);
    let [on_axis, all] = [&axis, &points].map(|p| 100.0 * outcome(&tracer, &pupil, p, 3).lost());
    let old = pupil.without_outlines();
    let [old_axis, old_all] = [&axis, &points].map(|p| 100.0 * outcome(&tracer, &old, p, 3).lost());
    let mut front_lost = [0.0; 2];
    let mut took = std::time::Duration::ZERO;
    if forward {
        let start = Instant::now();
        let (pupil, points) = front(lens, &tracer, frame, n);
        weight = weight.max(pupil.largest_weight(&points[..WEIGHED]));
        took = start.elapsed();
        let far = points[0].length();
        let axis = vec![DVec3::new(0.0, 0.0, -far); n];
        front_lost = [&axis, &points].map(|p| 100.0 * outcome(&tracer, &pupil, p, 4).lost());
    }
    println!(
        "{name:<46} axis {on_axis:5.2} % (was {old_axis:5.2})  frame {all:5.2} % (was {old_all:5.2})  \
         forward {:5.2} {:5.2}  weight {weight:.1}  searched {searched:.0?} {took:.0?}",
        front_lost[0], front_lost[1]
    );
    [on_axis, all, front_lost[0], front_lost[1], weight]
}

fn cases(names: Option<&[&str]>) -> Vec<(String, Lens, [f64; 2])> {
    let mut cases = Vec::new();
    for (name, frame, open) in library() {
        if names.is_some_and(|names| !names.contains(&name.as_str())) {
            continue;
        }
        let lens = load(&name);
        for f_number in [0.0, 4.0, 16.0] {
            let stopped = if f_number == 0.0 {
                lens.clone()
            } else {
                // A slower lens has no such stop.
                let Ok(stopped) = stop_down(lens.clone(), f_number) else { continue };
                stopped
            };
            for opening in [Opening::Round, Opening::Blades, Opening::Star] {
                let stop = stopped.stop().expect("a lens that takes pictures has a stop");
                // A stop without a stated size passes everything that the rims pass; blades and drawings need a size.
                let sized = opening == Opening::Round || stopped.elements[stop].semi_diameter_mm.is_some();
                let stopped = if sized {
                    stopped.clone()
                } else {
                    stop_down(stopped.clone(), 1.02 * open).unwrap_or_else(|e| panic!("{name}: {e}"))
                };
                let of = if f_number == 0.0 { "open".to_owned() } else { format!("f/{f_number}") };
                cases.push((format!("{name} {of} {opening:?}"), with(stopped.clone(), opening), frame));
            }
        }
    }
    cases
}

/// Prints the table of `benches/README.md`: every lens of the library. Takes minutes.
#[test]
#[ignore = "a table for people: see benches/README.md"]
fn every_lens() {
    let only = std::env::var("SPECTRA_LENSES").ok();
    let names: Option<Vec<&str>> = only.as_ref().map(|names| names.split(',').collect());
    let mut most = [0.0_f64; 5];
    for (name, lens, frame) in cases(names.as_deref()) {
        let lost = row(&name, &lens, frame, RAYS, std::env::var("SPECTRA_BACKWARD").is_err());
        most = std::array::from_fn(|k| most[k].max(lost[k]));
    }
    println!("most: {most:.2?} %");
}

/// Nearly all rays pass several kinds of lenses: fast, faster, a fisheye, a zoom, and an anamorphic without axis; with blades and a drawing
/// in the stop.
#[test]
fn nearly_all_rays_pass() {
    let of = |name: &str| {
        let (_, frame, open) = library().into_iter().find(|l| l.0 == name).unwrap_or_else(|| panic!("{name}"));
        (load(name), frame, open)
    };
    let cases = [
        ("zeiss-biotar-50-f1.4", 0.0, Opening::Round, true),
        ("zeiss-biotar-50-f1.4", 16.0, Opening::Round, false),
        ("zeiss-biotar-50-f1.4", 4.0, Opening::Blades, true),
        ("zeiss-biotar-50-f1.4", 1.43, Opening::Star, false),
        ("zeiss-biotar-50-f1.4", 4.0, Opening::Star, true),
        ("angenieux-100-f1.1", 16.0, Opening::Star, false),
        ("nikkor-100-f1.4", 0.0, Opening::Round, false),
        ("nikkor-100-f1.4", 4.0, Opening::Blades, false),
        ("minolta-fisheye-16-f2.7", 0.0, Opening::Round, false),
        ("canon-ef-70-200-f2.8-at-72", 0.0, Opening::Round, false),
        ("schneider-anamorphic-60", 0.0, Opening::Round, false),
    ];
    for (name, f_number, opening, forward) in cases {
        let (lens, frame, _) = of(name);
        let lens = if f_number == 0.0 { lens } else { stop_down(lens, f_number).expect("it can be stopped down") };
        let lost = row(&format!("{name} {f_number} {opening:?}"), &with(lens, opening), frame, RAYS / 2, forward);
        for (what, [lost, most]) in [
            ("axis", [lost[0], 3.0]),
            ("frame", [lost[1], 6.0]),
            ("forward", [lost[2], 3.0]),
            ("its frame", [lost[3], 6.0]),
        ] {
            assert!(lost <= most, "{name} {f_number} {opening:?}, {what}: {lost:.2} % lost, {most} % at most");
        }
        assert!(lost[4] <= 20.0, "{name} {f_number} {opening:?}: a ray weighs {}", lost[4]);
    }
}

/// The estimate with outlines matches that with the wide ellipses: over the frame, and in each of 20 regions of it.
fn agree(name: &str, lens: &Lens, frame: [f64; 2], n: usize, forward: bool) {
    let tracer = tracer(lens);
    let (pupil, points) =
        if forward { front(lens, &tracer, frame, n) } else { (rear(lens, &tracer, frame), film(frame, n)) };
    let now = outcome(&tracer, &pupil, &points, 21);
    let old = outcome(&tracer, &pupil.without_outlines(), &points, 22);
    alike(name, frame, [&now, &old]);
}

/// Asserts that two estimates agree, over the frame and in each of 20 regions of it.
fn alike(name: &str, frame: [f64; 2], [now, old]: [&Outcome; 2]) {
    const REGIONS: [usize; 2] = [5, 4];
    let n = now.values.len();
    let compare = |what: &str, of: &dyn Fn(usize) -> bool, most: f64| {
        let pick = |o: &Outcome| -> Vec<f64> { (0..n).filter(|i| of(*i)).map(|i| o.values[i]).collect() };
        let ((a, a_error), (b, b_error)) = (mean(&pick(now)), mean(&pick(old)));
        let error = (a_error * a_error + b_error * b_error).sqrt();
        let sigma = (a - b).abs() / error;
        println!(
            "{name} {what}: {:+.3} %, {sigma:.2} standard errors of {:.3} %",
            100.0 * (a / b - 1.0),
            100.0 * error / b
        );
        assert!(sigma < 4.0, "{name} {what}: {a} and {b}, {sigma} standard errors");
        assert!(error < most * b, "{name} {what}: the comparison is no finer than {:.3} %", 100.0 * error / b);
    };
    let scale = if n > 1 << 20 { 1.0 } else { 20.0 };
    compare("frame", &|_| true, 5e-4 * scale);
    let places = film(frame, n);
    for region in 0..REGIONS[0] * REGIONS[1] {
        let inside = |i: usize| {
            let at = |k: usize| ((places[i][k] / frame[k] + 0.5) * REGIONS[k] as f64) as usize;
            at(0).min(REGIONS[0] - 1) + REGIONS[0] * at(1).min(REGIONS[1] - 1) == region
        };
        compare(&format!("region {region}"), &inside, 3e-3 * scale);
    }
}

#[test]
fn outlines_estimate_what_ellipses_do() {
    let frame = [36.0, 24.0];
    let n = 1 << 17;
    agree("open", &load("zeiss-biotar-50-f1.4"), frame, n, false);
    let stopped = stop_down(load("zeiss-biotar-50-f1.4"), 4.0).expect("it can be stopped down");
    agree("f/4, star", &with(stopped, Opening::Star), frame, n, false);
    agree("fisheye", &load("minolta-fisheye-16-f2.7"), frame, n, true);
}

/// Core and rim add up to the whole, whatever is in the stop. Hardly a ray of the core ends, which is the purpose of the split.
#[test]
fn core_and_rim_are_the_whole() {
    let stopped = |name: &str, n: f64| stop_down(load(name), n).expect("it can be stopped down");
    let cases = [
        ("open", load("zeiss-biotar-50-f1.4"), 2e-3),
        ("Helios", load("helios-44-58-f2"), 1e-3),
        ("f/8", stopped("helios-44-58-f2", 8.0), 1e-3),
        ("f/4, blades", with(stopped("zeiss-biotar-50-f1.4", 4.0), Opening::Blades), 2e-2),
        ("f/4, star", with(stopped("zeiss-biotar-50-f1.4", 4.0), Opening::Star), 5e-2),
        ("fisheye", load("minolta-fisheye-16-f2.7"), 1e-2),
        ("anamorphic, all over a frame that it does not fill", load("schneider-anamorphic-60"), 0.15),
    ];
    let frame = [36.0, 24.0];
    let n = 1 << 17;
    for (name, lens, most) in cases {
        let tracer = tracer(&lens);
        let rear = RearPupil::search(&lens, &tracer, &corners(frame), BAND_NM[0], BAND_NM[1]);
        let rear = rear.expect("the lens has an aperture");
        assert!(rear.has_rim() && !rear.clone().without_outlines().has_rim());
        let of = |part, seed| outcome(&tracer, &Pupil::Part(rear.clone(), part), &film(frame, n), seed);
        let (core, rim, whole) = (of(AimPart::Core, 25), of(AimPart::Rim, 26), of(AimPart::Whole, 27));
        println!("{name}: of the whole {:.2} % end, of the core {:.3} %", 100.0 * whole.lost(), 100.0 * core.lost());
        let values = core.values.iter().zip(&rim.values).map(|(core, rim)| core + rim / f64::from(RIM_EVERY)).collect();
        alike(name, frame, [&Outcome { values, ..core }, &whole]);
        let lost = core.lost();
        assert!(lost < most, "{name}: of the core {lost:.4} end");
    }
}

/// A draft search misses no light that passes, even with tilted film, blades or a lens without axis; more of its rays
/// end.
#[test]
fn drafts_estimate_what_the_whole_search_does() {
    let frame = [36.0, 24.0];
    let n = 1 << 17;
    let stopped = |name: &str| stop_down(load(name), 4.0).expect("it can be stopped down");
    let cases = [
        ("open", load("zeiss-biotar-50-f1.4"), 0.0),
        ("f/4, tilted", stopped("zeiss-biotar-50-f1.4"), 0.15),
        ("f/4, blades", with(stopped("zeiss-biotar-50-f1.4"), Opening::Blades), 0.0),
        ("fisheye", load("minolta-fisheye-16-f2.7"), 0.0),
        ("anamorphic", load("schneider-anamorphic-60"), 0.0),
    ];
    for (name, lens, slope) in cases {
        let tracer = tracer(&lens);
        let tilted = |mut p: DVec3| {
            p.z = slope * p.x;
            p
        };
        let (points, seen): (Vec<_>, Vec<_>) =
            (film(frame, n).into_iter().map(tilted).collect(), corners(frame).into_iter().map(tilted).collect());
        let by = |effort| {
            let rear =
                RearPupil::search_by(&lens, &tracer, &seen, BAND_NM, &spectra_core::workers::SingleThread, effort);
            Pupil::Rear(rear.expect("the lens has an aperture"))
        };
        let start = Instant::now();
        let draft = by(Effort::Draft);
        let took = start.elapsed();
        let start = Instant::now();
        let whole = by(Effort::Full);
        let (draft, whole) = (outcome(&tracer, &draft, &points, 23), outcome(&tracer, &whole, &points, 24));
        println!("{name}: {:.1} % end, searched {took:.0?} and {:.0?}", 100.0 * draft.lost(), start.elapsed());
        assert!(draft.lost() < 0.7, "{name}: {:.2} of the rays end", draft.lost());
        alike(name, frame, [&draft, &whole]);
    }
}

/// Outlines estimate the same light as ellipses, compared to 0.05 % of the frame and 0.3 % of a region. Takes minutes.
#[test]
#[ignore = "a table for people: see benches/README.md"]
fn outlines_estimate_what_ellipses_do_finely() {
    for (name, frame, _) in library() {
        agree(&name, &load(&name), frame, 1 << 24, false);
    }
}

/// Every instruction set aims at the same points with the same weights.
#[test]
fn every_tier_aims_alike() {
    let lens = with(stop_down(load("zeiss-biotar-50-f1.4"), 4.0).expect("it can be stopped down"), Opening::Blades);
    let frame = [36.0, 24.0];
    let rear = RearPupil::search(&lens, &tracer(&lens), &corners(frame), BAND_NM[0], BAND_NM[1]);
    let rear = rear.expect("the lens has an aperture");
    let aimed = |part: AimPart, isa: Isa| {
        let points = film(frame, 3000);
        let (u, v) = (numbers(1, 0, 3000), numbers(1, 1, 3000));
        let mut rays = RayBatch::new(3000).on(isa);
        rays.restart(3000);
        let c = rays.columns_mut();
        for (i, p) in points.iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = (*p).into();
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, -1.0);
            c.wavelength_nm[i] = 350.0 + 0.16 * i as f64;
        }
        rear.aim_part(&mut rays, &u, &v, part);
        let bits = |c: &[f64]| c.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let mut all: Vec<Vec<u64>> = rays.positions().iter().map(|c| bits(c)).collect();
        all.extend(rays.directions().iter().map(|c| bits(c)));
        all.push(bits(rays.weights()));
        all
    };
    for part in [AimPart::Whole, AimPart::Core, AimPart::Rim] {
        let want = aimed(part, Isa::Baseline);
        for isa in Isa::available() {
            assert!(aimed(part, isa) == want, "{part:?}, {}", isa.name());
        }
    }
}
