//! Tests ghosts: the light of reflections in a picture agrees with an independent random walk, the ledger balances, and the bits do
//! not depend on how the work is done.

mod walk;

use crate::common::statistics::{self, Estimate, bits, estimates, over_seeds, ready, rendered};
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Coating, Lens};
use spectra_render::{Control, Light as Sums, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::{FileResources, Scene};
use spectra_tracer::{Indices, Path as LightPath, Tracer, Travel};
use std::path::Path;
use walk::Light;

const COLUMNS: usize = 4;
const ROWS: usize = 3;
const REGIONS: usize = COLUMNS * ROWS;
const SEEDS: u64 = 4;

/// A point of light in one spectral line through an uncoated lens.
pub struct Setup {
    /// Name of its random walk in the table.
    walk: &'static str,
    lens: &'static str,
    f_number: f64,
    field_deg: [f64; 2],
    frame_mm: [f64; 2],
    imager: f64,
    order: usize,
}

const BIOTAR: Setup = Setup {
    walk: "biotar",
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
        let Self { lens, f_number, field_deg: [fx, fy], frame_mm: [width, height], imager, order, .. } = self;
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

    /// Prepares the scene with the random numbers of its own seed.
    fn ready(&self, set: &[&str]) -> Renderer {
        ready(self.scene(set))
    }

    /// Renders the picture.
    fn render(&self, set: &[&str]) -> Rendering {
        rendered(&self.ready(set))
    }
}

/// Returns the light of each region, in arbitrary units.
fn regions(rendering: &Rendering) -> Vec<f64> {
    statistics::regions(rendering, COLUMNS, ROWS)
}

/// Checks that twelve regions of the frame agree with the walk within four standard errors.
fn agrees(setup: &Setup, largest_error: f64) {
    let walked = walk::known(setup);
    // Direct light calibrates the unit of the walk.
    let straight = over_seeds(&setup.ready(&["render.reflections.order=0"]), 0..SEEDS, regions);
    let light: Vec<f64> = straight.iter().map(|regions| regions.iter().sum()).collect();
    let unit = Estimate::of(&light).mean / walked.total(Light::Straight).mean;
    let with = over_seeds(&setup.ready(&[]), 0..SEEDS, regions);
    let ghosts: Vec<Vec<f64>> = with
        .iter()
        .zip(&straight)
        .map(|(with, straight)| with.iter().zip(straight).map(|(with, straight)| (with - straight) / unit).collect())
        .collect();
    let even = walked.total(Light::Ghosts).mean / REGIONS as f64;
    let mut worst = 0.0_f64;
    for (region, (found, want)) in estimates(&ghosts).iter().zip(walked.of(Light::Ghosts)).enumerate() {
        let apart = found.apart(want);
        println!("{region}: {found:?}, walk {want:?}, {apart:.2}");
        assert!(
            found.error.hypot(want.error) < largest_error * want.mean.max(0.2 * even),
            "region {region} is known only to {found:?} and {want:?}"
        );
        worst = worst.max(apart);
    }
    assert!(worst < 4.0, "{worst} standard errors");
    if setup.order > 2 {
        // Compares only four reflections with the ledger, which has about a thousand rays per path.
        let ledger = setup.render(&["render.samples=1"]).ledger.expect("ghosts are traced");
        let four = ledger.paths.iter().filter(|path| path.surfaces.len() == 4);
        let booked = four.map(|path| path.power_w).sum::<f64>() / ledger.direct_w;
        let (straight, four) = (walked.total(Light::Straight).mean, walked.total(Light::Four));
        let (want, error) = (four.mean / straight, four.error / straight);
        println!("four reflections: {booked:.4e}, walk {want:.4e} +- {error:.1e}");
        assert!(
            (booked - want).abs() < 4.0 * error.hypot(0.01 * want) && error < 0.05 * want,
            "{booked} {want} {error}"
        );
    }
}

const FOUR: Setup = Setup { walk: "biotar-four", order: 4, ..BIOTAR };
const FOUR_WITH_IMAGER: Setup = Setup { walk: "biotar-four-imager", order: 4, imager: 0.3, ..BIOTAR };
const WITH_IMAGER: Setup = Setup { walk: "biotar-imager", imager: 0.3, ..BIOTAR };
const FISHEYE: Setup = Setup {
    walk: "fisheye",
    lens: "minolta-fisheye-16-f2.7",
    f_number: 2.8,
    field_deg: [60.0, 0.0],
    frame_mm: [36.0, 24.0],
    imager: 0.0,
    order: 2,
};

/// Setups on the axis, wide open and stopped down.
const ON_AXIS: [Setup; 3] = [
    Setup { walk: "axis-two", field_deg: [0.0; 2], f_number: 1.5, order: 2, ..BIOTAR },
    Setup { walk: "axis-four", field_deg: [0.0; 2], f_number: 1.5, order: 4, ..BIOTAR },
    Setup { walk: "axis-four-stopped-down", field_deg: [0.0; 2], f_number: 16.0, order: 4, ..BIOTAR },
];

/// Returns each walk of the table with its number of rays. Little of the light that the large front of the fisheye accepts reaches
/// the film, so its walk must be long to determine each region to 1 %.
fn walks() -> Vec<(&'static Setup, usize)> {
    let frames = [(&BIOTAR, 180_000), (&WITH_IMAGER, 220_000), (&FOUR, 160_000), (&FOUR_WITH_IMAGER, 220_000)];
    let axis = ON_AXIS.iter().map(|setup| (setup, 200_000));
    frames.into_iter().chain([(&FISHEYE, 9_000_000)]).chain(axis).collect()
}

/// Writes the table anew, which takes two minutes: `cargo test --test it -- --ignored walks_are_written`.
#[test]
#[ignore = "writes tests/data/ghost-walks.csv"]
fn walks_are_written() {
    walk::write(&walks());
}

/// A part of each walk, with other random numbers, reproduces the figures of the table: the total of each kind of light, and each
/// region.
#[test]
fn walks_of_the_table_are_walked_again() {
    for (setup, rays) in walks() {
        let (known, again) = (walk::known(setup), walk::Walked::by(setup, rays / 40, 11));
        for light in [Light::Straight, Light::Two, Light::Four, Light::Left] {
            let (a, b) = (known.total(light), again.total(light));
            assert!(a.mean == b.mean || a.apart(b) < 4.5, "{}: {light:?}: {a:?}, again {b:?}", setup.walk);
            // Few rays underestimate their error where a few of them carry much light.
            for (region, (a, b)) in known.of(light).zip(again.of(light)).enumerate() {
                assert!(
                    a.mean == b.mean || (a.mean - b.mean).abs() < 6.0 * b.error.max(a.error * 40_f64.sqrt()),
                    "{}: {light:?} in region {region}: {a:?}, again {b:?}",
                    setup.walk
                );
            }
        }
    }
}

#[test]
fn four_reflections_are_those_of_a_random_walk() {
    agrees(&FOUR, 0.01);
}

#[test]
fn four_reflections_with_an_imager_that_reflects_too() {
    agrees(&FOUR_WITH_IMAGER, 0.01);
}

#[test]
fn ghosts_of_a_double_gauss_are_those_of_a_random_walk() {
    agrees(&BIOTAR, 0.01);
}

#[test]
fn with_an_imager_that_reflects_too() {
    agrees(&WITH_IMAGER, 0.01);
}

#[test]
fn ghosts_of_a_fisheye_with_the_light_at_60_degrees() {
    agrees(&FISHEYE, 0.01);
}

/// Rays along fifteen paths of two reflections agree with those of another program: `xtask/ghost_rays.py`.
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
            let tracer = Tracer::new(&lens.clone().with_coating(Coating::Bare), Indices::Stated).expect("media");
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
            // Where surfaces without rims cross, Optiland goes back to the surface that lies behind. No such ray is within the rims.
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

/// Returns the light on the axis, starting at surface `at` in either direction, that is not traced: light reflected more than `order`
/// times, and light that is weaker than `least` when it is reflected more than twice. `parts` are the reflectances along the common
/// normal.
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

/// Returns the share of the emitted light that is not traced after this number of reflections.
fn left(setup: &Setup, set: &[&str]) -> f64 {
    let rendering = setup.render(&[&["render.samples=1"], set].concat());
    let ledger = rendering.ledger.expect("ghosts are traced");
    let booked = ledger.detected_w() + ledger.lost_w() + ledger.not_traced_w;
    assert!((booked / ledger.emitted_w - 1.0).abs() < 1e-9, "{ledger:?}");
    assert_eq!(ledger.order as usize, setup.order);
    ledger.not_traced_w / ledger.emitted_w
}

/// Two reflections of a thin beam along the axis of an uncoated Biotar leave 1.6 % untraced, and four leave less than 0.1 %. This is
/// the sum of products of Fresnel's factors; the branches below 1e-8, which are cut, make up 0.2 % of it.
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

/// Wide open, four reflections leave half as much again as on the axis, and an independent walk confirms it. Without total
/// reflection, the walk leaves no more than on the axis. Stopped down, less than 0.1 % is left.
#[test]
fn what_reflections_leave_is_what_a_random_walk_leaves() {
    for setup in &ON_AXIS {
        let Setup { order, f_number, .. } = *setup;
        let walked = walk::known(setup);
        let (got, want, without) =
            (left(setup, &[]), walked.total(Light::Left), walked.total(Light::LeftNotTotally).mean);
        println!("order {order}, f/{f_number}: {got:.3e}, walk {want:?}, without total reflection {without:.3e}");
        let Estimate { mean: want, error } = want;
        // The ledger is computed from about a thousand rays on a grid.
        assert!((got - want).abs() < 4.0 * error.hypot(0.01 * want) && error < 0.02 * want, "{got} {want} {error}");
        match (order, f_number) {
            (2, _) => assert!((0.014..0.018).contains(&got), "{got}"),
            (_, 16.0) => assert!(got < 1e-3, "{got}"),
            _ => assert!(without < 1e-3, "{without}"),
        }
    }
}

/// The ledger books every watt exactly once.
#[test]
fn the_books_close() {
    for imager in [0.0, 0.2] {
        for (field_deg, f_number) in [([0.0; 2], 16.0), ([11.0, 6.0], 2.0), ([24.0, 0.0], 1.5)] {
            let rendering = Setup { field_deg, f_number, imager, ..BIOTAR }.render(&["render.samples=1"]);
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

/// Light that leaves through the front does not depend on the size of the frame; light that misses the frame does.
#[test]
fn light_out_of_the_front_is_not_light_beside_the_frame() {
    let [small, large] = [12.0, 2000.0].map(|side| {
        let rendering = Setup { frame_mm: [side; 2], ..BIOTAR }.render(&["render.samples=1"]);
        rendering.ledger.expect("ghosts are traced")
    });
    assert!(large.front_w > 0.01 * large.emitted_w && (small.front_w / large.front_w - 1.0).abs() < 1e-9, "{small:?}");
    assert!(large.beside_w < 0.1 * large.front_w && small.beside_w > large.beside_w, "{small:?} {large:?}");
}

/// The light that the estimator puts on the frame agrees with the ledger, within the errors of both.
#[test]
fn the_picture_has_the_light_of_the_books() {
    let light = |set: &[&str]| over_seeds(&BIOTAR.ready(set), 0..SEEDS, |r| vec![regions(r).iter().sum()]);
    let (with, without) = (light(&["render.reflections.order=2"]), light(&["render.reflections.order=0"]));
    let parts: Vec<f64> = with.iter().zip(&without).map(|(with, without)| with[0] / without[0] - 1.0).collect();
    let Estimate { mean, error } = Estimate::of(&parts);
    let ledger = BIOTAR.render(&[]).ledger.expect("ghosts are traced");
    let booked = ledger.ghosts_w / ledger.direct_w;
    assert!((mean - booked).abs() < 4.0 * error + 0.02 * booked, "{mean} +- {error}, booked {booked}");
}

#[test]
fn threads_batches_and_steps_change_no_bit() {
    let renderer = |set: &[&str]| Renderer::new(BIOTAR.scene(set), &RenderOptions::default()).expect("ready");
    let whole = renderer(&[]);
    let run = |r: &Renderer, threads| bits(&r.run(&Threads(threads), &Control::new()).expect("rendered"));
    let want = run(&whole, 1);
    assert_eq!(run(&whole, 3), want);
    assert_eq!(run(&renderer(&["render.batch=40"]), 2), want);
    let scalar = Renderer::new(BIOTAR.scene(&[]), &RenderOptions { isa: Isa::Baseline, ..RenderOptions::default() })
        .expect("ready");
    assert_eq!(run(&scalar, 2), want);
    // Traces three samples, saves and loads the light, then traces the rest.
    let (threads, control) = (Threads(2), Control::new());
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 3, &threads, &control).expect("rendered");
    let mut file = Vec::new();
    light.save(&mut file).expect("written");
    let mut light = Sums::load(&whole, &mut &file[..]).expect("of this scene");
    whole.advance(&mut light, 64, &threads, &control).expect("rendered");
    assert_eq!(bits(&whole.rendering(whole.scene(), &light).expect("memory")), want);
    // The search before the first ray does not depend on the number of samples.
    let fewer = renderer(&["render.samples=3", "render.rays=37500"]);
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 3, &threads, &control).expect("rendered");
    assert!(bits(&whole.rendering(whole.scene(), &light).expect("memory")) == run(&fewer, 2));
}

/// Polarization changes the light of ghosts by a few per cent and no more. Without reflections the bits are those without the key.
#[test]
fn order_and_polarization_are_asked_for() {
    let ghosts = |set: &[&str]| BIOTAR.render(set).ledger.map(|ledger| ledger.ghosts_w);
    let (plain, polarized) = (ghosts(&[]), ghosts(&["render.reflections.polarized=true"]));
    let ratio = polarized.expect("traced") / plain.expect("traced");
    assert!((ratio - 1.0).abs() > 1e-3 && (ratio - 1.0).abs() < 0.1, "{ratio}");
    let off = BIOTAR.render(&["render.reflections.order=0"]);
    assert!(off.ledger.is_none() && off.estimators == ["forward"]);
    assert_eq!(BIOTAR.render(&[]).estimators, ["forward", "ghosts"]);
}
