//! Tests diffraction in pictures: the pupil that the film sees, stars of lamps, and unchanged pictures if it is off.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_diffraction::{ChannelLight, PixelSpread, Pupil, Wavefronts};
use spectra_lens::Lens;
use spectra_optics::{Criterion, FocusSearch, Optics};
use spectra_plugins as _;
use spectra_render::{Control, Light as Sums, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::Scene;
use spectra_tracer::{Indices, Tracer, Travel};

fn scene(lens: &str, set: &[&str]) -> Scene {
    let text = format!(
        "spectra: 1\n\
         source: {{kind: point, distance: 20 m, field: [0.3 deg, 0.2 deg], spectrum: D55, intensity: 1000}}\n\
         lens: {lens}\n\
         imager: {{kind: xyz, width: 9, height: 6, resolution: [300, 200]}}\n\
         render: {{direction: forward, samples: 4, rays: 100000}}\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(&path, &set).unwrap_or_else(|faults| panic!("{faults}"))
}

const SEVEN: &str = "{file: zeiss-biotar-50-f1.4, focus: infinity, f-number: 16, aperture: {shape: iris, blades: 7}}";

/// A scene whose light is traced once and viewed with and without diffraction.
struct Traced {
    renderer: Renderer,
    light: Sums,
}

impl Traced {
    fn new(scene: Scene) -> Self {
        let renderer =
            Renderer::new(scene, &RenderOptions { workers: &Threads(2), ..RenderOptions::default() }).expect("ready");
        let mut light = renderer.begin().expect("memory");
        let samples = u64::from(renderer.scene().render.samples);
        renderer.advance(&mut light, samples, &Threads(2), &Control::new()).expect("rendered");
        Self { renderer, light }
    }

    /// Returns the picture with the given `diffraction`; `None` lets the scene decide.
    fn look(&self, diffraction: Option<bool>) -> Rendering {
        let mut scene = Scene::clone(self.renderer.scene());
        scene.render.diffraction = diffraction;
        self.renderer.rendering(&scene, &self.light).expect("memory")
    }
}

/// Returns the area, in direction cosines, that a point of the film sees through the real lens, from rays on a grid.
fn counted(lens: &Lens, point: DVec3) -> f64 {
    let tracer = Tracer::new(lens, Indices::At(lens.reference_nm)).expect("indices");
    let (n, reach) = (700, 0.75);
    let cell = 2.0 * reach / n as f64;
    let mut seen = 0;
    for row in 0..n {
        let mut rays = RayBatch::new(n);
        rays.restart(n);
        let c = rays.columns_mut();
        let at = |k: usize| (k as f64 + 0.5) * cell - reach;
        for k in 0..n {
            let (l, m) = (at(k), at(row));
            let up = 1.0 - l * l - m * m;
            (c.x[k], c.y[k], c.z[k]) = point.into();
            (c.l[k], c.m[k], c.n[k]) = (l, m, -up.max(1e-4).sqrt());
            c.wavelength_nm[k] = lens.reference_nm;
        }
        let mut work = tracer.work_in_place(n);
        tracer.trace(&mut rays, &mut work, Travel::Backward);
        seen += rays.alive();
    }
    seen as f64 * cell * cell
}

/// The pupil polygon has the area that rays find: blades on and off the axis, and the cat's eye of a lens wide open.
#[test]
fn the_opening_is_what_rays_pass() {
    let blades = "{file: zeiss-biotar-50-f1.4, focus: infinity, f-number: 2.8, aperture: {shape: iris, blades: 7}}";
    let wide = "{file: zeiss-biotar-50-f1.4, focus: infinity}";
    let stopped = "{file: zeiss-biotar-50-f1.4, focus: infinity, f-number: 1.6}";
    for (text, points) in
        [(blades, [[0.0, 0.0], [10.0, 6.0]]), (wide, [[0.0, 0.0], [14.0, 9.0]]), (stopped, [[8.0, 0.0], [0.0, -11.0]])]
    {
        let scene = scene(text, &[]);
        let pupil = Pupil::new(&scene.lens).expect("an opening");
        for [x, y] in points {
            let point = DVec3::new(x, y, 0.0);
            let seen = pupil.seen_from(point, [DVec3::X, DVec3::Y]).expect("it sees the opening");
            let want = counted(&scene.lens, point);
            println!("{text} at {x}, {y}: {:.6} and {want:.6}", seen.area());
            assert!((seen.area() / want - 1.0).abs() < 0.01, "{text} at {x}, {y}: {} {want}", seen.area());
        }
    }
    // sin theta' = 1 / 2N.
    let round = scene("{file: zeiss-biotar-50-f1.4, focus: infinity, f-number: 16}", &[]);
    let axis = Pupil::new(&round.lens).unwrap().seen_from(DVec3::ZERO, [DVec3::X, DVec3::Y]).unwrap();
    assert!((axis.area() / (std::f64::consts::PI / 1024.0) - 1.0).abs() < 0.02, "{}", axis.area());
}

#[test]
fn without_it_the_bits_are_as_they_were() {
    let traced = Traced::new(scene(SEVEN, &[]));
    let [absent, off, on] = [None, Some(false), Some(true)].map(|asked| traced.look(asked));
    assert!(absent.exposure == off.exposure && absent.diffraction.is_none());
    assert!(on.exposure != off.exposure);
    // A scene that sets the key itself is traced in the same way.
    let asked = scene(SEVEN, &["render.diffraction=true"]);
    assert_eq!(asked.render.diffraction, Some(true));
    assert!(Traced::new(asked).look(Some(false)).exposure == off.exposure);
    assert_eq!((on.rays, on.detected), (off.rays, off.detected));
}

/// Diffraction is on by default if lights are rendered separately and their stars would be visible, unless it is refused. If no star
/// would be visible it is off.
#[test]
fn it_comes_where_stars_are_seen() {
    let sky = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/sun-sky.exr");
    let over = format!("over: {{kind: picture, file: '{sky}', distance: 500 m, width: fill, luminance: 6000 cd/m2}}");
    let source = |illuminance: &str| {
        let sun = format!("kind: sun, field: [9 deg, 5 deg], illuminance: {illuminance}, spectrum: D55, {over}");
        format!("source={{{sun}}}")
    };
    let frame = "imager={kind: xyz, width: 36, height: 24, resolution: [150, 100]}";
    let shown = |illuminance: &str, more: &[&str]| {
        let source = source(illuminance);
        let base = ["render={samples: 2, rays: 20000, reflections: {order: 0}}", frame, &source];
        Traced::new(scene(SEVEN, &[&base, more].concat()))
    };
    let bright = shown("60000 lx", &[]);
    let [itself, off, on] = [None, Some(false), Some(true)].map(|asked| bright.look(asked));
    assert_eq!(itself.estimators, ["backward", "forward"]);
    assert!(off.diffraction.is_none() && itself.diffraction == on.diffraction && on.diffraction.is_some());
    assert!(itself.exposure == on.exposure && itself.exposure != off.exposure);
    // A star this dim is not visible: the light is the same, and none of it is moved.
    let dim = shown("1 lx", &["render.direction=both"]);
    let itself = dim.look(None);
    assert_eq!(itself.estimators, ["backward", "forward"]);
    assert!(itself.diffraction.is_none() && itself.exposure == dim.look(Some(false)).exposure);
}

/// All light of a lamp is in its frame or accounted for as outside, and the lamp has a star with the right number of spikes.
#[test]
fn a_lamp_gets_its_star() {
    for (blades, spikes) in [(7, 14), (8, 8)] {
        let lens = SEVEN.replace("blades: 7", &format!("blades: {blades}"));
        let traced = Traced::new(scene(&lens, &[]));
        let (off, on) = (traced.look(Some(false)), traced.look(Some(true)));
        let booked = on.diffraction.as_ref().expect("booked");
        assert_eq!(booked.len(), 3);
        let y = |r: &Rendering| {
            r.exposure.channel("Y").expect("Y").values.iter().map(|v| f64::from(*v)).collect::<Vec<_>>()
        };
        let (before, after) = (y(&off), y(&on));
        let sum = |v: &[f64]| v.iter().sum::<f64>();
        let left = booked.iter().find(|d| d.channel == "Y").expect("Y").left;
        assert!((sum(&after) / sum(&before) + left - 1.0).abs() < 1e-6, "{left}");
        assert!(left > 0.0 && left < 0.05, "{left}");
        // Samples a circle of 50 pixels around the lamp.
        let lamp = (0..before.len()).max_by(|a, b| before[*a].total_cmp(&before[*b])).expect("pixels");
        let (column, row) = ((lamp % 300) as f64, (lamp / 300) as f64);
        let around: Vec<f64> = (0..720)
            .map(|i| {
                let a = f64::from(i) * std::f64::consts::TAU / 720.0;
                let (x, y) = (column + 50.0 * a.cos(), row + 50.0 * a.sin());
                if (0.0..300.0).contains(&x) && (0.0..200.0).contains(&y) {
                    after[y as usize * 300 + x as usize]
                } else {
                    0.0
                }
            })
            .collect();
        let high = 0.3 * around.iter().fold(0.0_f64, |a, b| a.max(*b));
        let begins: Vec<usize> = (0..720).filter(|i| around[*i] > high && around[(*i + 719) % 720] <= high).collect();
        // Pixel steps may split a spike in two.
        let apart = begins.iter().enumerate().filter(|(k, i)| *k == 0 || **i - begins[k - 1] > 20).count();
        assert_eq!(apart, spikes, "{blades} blades: {begins:?}");
    }
}

#[test]
fn a_picture_as_a_mask_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    image::GrayImage::from_fn(8, 8, |x, _| image::Luma([x as u8 * 30]))
        .save(folder.path().join("mask.png"))
        .expect("written");
    let text = "spectra: 1\n\
         source: {kind: point, distance: 20 m, spectrum: D55, intensity: 1000}\n\
         lens: {file: zeiss-biotar-50-f1.4, focus: infinity, aperture: {shape: mask, file: mask.png, width: 10}}\n\
         imager: {kind: xyz, width: 9, height: 6, resolution: [30, 20]}\n\
         render: {direction: forward, rays: 1000, diffraction: true}\n";
    let path = folder.path().join("scene.yaml");
    std::fs::write(&path, text).expect("written");
    let scene = std::sync::Arc::new(spectra_scene::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}")));
    let error = Renderer::check(&scene).expect_err("it has no edge");
    let faults = error.faults(&scene).expect("a fault of the scene").to_string();
    assert!(faults.contains("picture used as a mask") && faults.contains("`diffraction: false`"), "{faults}");
}

/// Rays land where the slope of the wavefront predicts.
#[test]
fn the_slope_of_the_wavefront_is_where_rays_land() {
    let scene = scene("{file: zeiss-biotar-50-f1.4, focus: infinity, f-number: 2.8}", &[]);
    let lens = &scene.lens;
    let pupil = Pupil::new(lens).expect("an opening");
    let waves = Wavefronts::new(lens, lens.reference_nm).expect("indices");
    let axes = [DVec3::X, DVec3::Y];
    for point in [DVec3::ZERO, DVec3::new(3.0, -9.0, 0.0)] {
        let opening = pupil.seen_from(point, axes).expect("it sees the opening");
        let wave = waves.seen_from(point, axes, &opening).expect("a wavefront");
        let tracer = Tracer::new(lens, Indices::At(lens.reference_nm)).expect("indices");
        // The path of the light that reaches the point through the middle of the pupil.
        let middle = opening.center();
        let mut back = RayBatch::new(1);
        back.restart(1);
        let c = back.columns_mut();
        (c.x[0], c.y[0], c.z[0]) = point.into();
        (c.l[0], c.m[0], c.n[0]) = (middle[0], middle[1], -(1.0 - middle[0].powi(2) - middle[1].powi(2)).sqrt());
        c.wavelength_nm[0] = lens.reference_nm;
        tracer.trace(&mut back, &mut tracer.work_in_place(1), Travel::Backward);
        let [x, y, z] = back.positions().map(|c| c[0]);
        let from = DVec3::new(x, y, z);
        let way = -DVec3::from_array(back.directions().map(|c| c[0]));
        // Rays parallel to that path.
        let n = 41;
        let mut rays = RayBatch::new(n * n);
        rays.restart(n * n);
        let c = rays.columns_mut();
        for k in 0..n * n {
            let aside = |at: usize| (at as f64 / (n - 1) as f64 - 0.5) * 36.0;
            let start = from + DVec3::new(aside(k % n), aside(k / n), 0.0) - way * 60.0;
            (c.x[k], c.y[k], c.z[k]) = start.into();
            (c.l[k], c.m[k], c.n[k]) = way.into();
            c.wavelength_nm[k] = lens.reference_nm;
        }
        tracer.trace(&mut rays, &mut tracer.work_in_place(n * n), Travel::Forward);
        let none = wave.at(middle).1;
        let (mut worst, mut largest, mut count) = (0.0_f64, 0.0_f64, 0);
        for k in (0..n * n).filter(|k| rays.states()[*k] == spectra_core::loss::ALIVE) {
            let [l, m, along] = rays.directions().map(|c| c[k]);
            let [x, y, z] = rays.positions().map(|c| c[k]);
            let (x, y) = (x - z / along * l, y - z / along * m);
            let slope = wave.at([-l, -m]).1;
            let landed = [x - point.x, y - point.y];
            for axis in 0..2 {
                worst = worst.max((slope[axis] - none[axis] - landed[axis]).abs());
                largest = largest.max(landed[axis].abs());
            }
            count += 1;
        }
        println!("{point}: {count} rays land up to {largest:.4} mm off, as the slope says within {worst:.5} mm");
        assert!(count > 50 && largest > 0.004, "{count} {largest}");
        assert!(worst < 0.03 * largest, "{point}: {worst} of {largest}");
    }
}

/// Returns the sums over the lines of a kernel, across or along.
fn lines(kernel: &PixelSpread, across: bool) -> Vec<f64> {
    let r = kernel.radius() as isize;
    let weight = |k: isize, n: isize| if across { kernel.weight(k, n) } else { kernel.weight(n, k) };
    (-r..r + 1).map(|k| (-r..r + 1).map(|n| weight(k, n)).sum()).collect()
}

/// Rays spread by the kernel have the contrast of light. The reference is an independent script that uses traced wavefronts: every
/// fourth combination of lens, stop and height of its table.
#[test]
fn rays_spread_by_the_wavefront_have_its_contrast() {
    assert_eq!(contrasts_agree(4), 64);
}

/// Compares the whole table of contrasts.
#[test]
#[ignore = "a minute: a long step of .ci/run"]
fn rays_spread_by_the_wavefront_have_its_contrast_everywhere() {
    assert_eq!(contrasts_agree(1), 240);
}

/// Compares every so many groups of the table, and returns the number of contrasts compared.
fn contrasts_agree(every: usize) -> u32 {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/diffraction/tests/data/wave-contrast.csv");
    let text = std::fs::read_to_string(path).expect("a table");
    let mut rows = text.lines().filter(|line| !line.starts_with('#')).skip(1).peekable();
    let (mut worst, mut perfect, mut sum, mut count, mut wrong) = (0.0_f64, 0.0_f64, 0.0, 0, 0);
    let mut group = 0;
    while let Some(first) = rows.next() {
        let [lens, stop, _, film_y] = first.splitn(5, ',').take(4).collect::<Vec<_>>()[..] else { panic!("{first}") };
        let rows_of_group: Vec<&str> =
            std::iter::once(first).chain(std::iter::from_fn(|| rows.next_if(|row| row.contains(film_y)))).collect();
        group += 1;
        if (group - 1) % every != 0 {
            continue;
        }
        let lens = scene(&format!("{{file: {lens}, focus: infinity, f-number: {stop}}}"), &[]).lens;
        // Focuses like `spectra lens trace`.
        let criterion = Criterion::Contrast { per_mm: 30.0 };
        let light = vec![(lens.reference_nm, 1.0)];
        let search = FocusSearch { object_mm: f64::INFINITY, field_rad: 0.0, criterion, light };
        let lens = Optics::new(search.focus(Lens::clone(&lens)).expect("focused"));
        let point = DVec3::new(0.0, film_y.parse().expect("mm"), 0.0);
        let axes = [DVec3::X, DVec3::Y];
        let opening = Pupil::new(&lens).unwrap().seen_from(point, axes).expect("it sees the opening");
        let wave = Wavefronts::new(&lens, 550.0).unwrap().seen_from(point, axes, &opening).expect("a wavefront");
        let (light, pitch) = (ChannelLight::line(550.0), [0.004; 2]);
        let plain = PixelSpread::new(&opening, &light, pitch, 128, 0.0);
        let kernel = plain.clone().with_wave(&opening, &wave, &light, pitch);
        let [edge, light] = [&plain, &kernel].map(|kernel| [true, false].map(|across| lines(kernel, across)));
        for row in rows_of_group {
            let fields: Vec<&str> = row.split(',').collect();
            let [per_mm, rays, _, want] = [5, 6, 7, 8].map(|k| fields[k].parse::<f64>().expect("a number"));
            let contrast = |lines: &[Vec<f64>; 2]| {
                let line = &lines[usize::from(fields[4] == "y")];
                let turns = |k: usize| per_mm * pitch[0] * (k as f64 - (line.len() / 2) as f64);
                rays * line.iter().enumerate().map(|(k, v)| v * (std::f64::consts::TAU * turns(k)).cos()).sum::<f64>()
            };
            let (found, without) = (contrast(&light), contrast(&edge));
            println!("{row}: {found:.3}, {without:.3} for a perfect lens");
            // Contrast that rays have lost cannot be restored.
            let least = if rays > 0.15 { 0.05 } else { 0.1 };
            wrong += u32::from((found - want).abs() > least);
            worst = worst.max((found - want).abs());
            perfect = perfect.max((without - want).abs());
            sum += (found - want).abs();
            count += 1;
        }
    }
    let mean = sum / f64::from(count);
    println!(
        "{count} contrasts within {worst:.3}, on average {mean:.4}; with a perfect lens's pattern within {perfect:.3}"
    );
    assert!(wrong == 0 && mean < 0.01, "{count}, {wrong} wrong, {mean}");
    count
}
