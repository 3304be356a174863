//! Tests stopping at a noise level: the promised noise is reached without bias, with the same bits on any number of threads.

use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{RenderOptions, Renderer, Rendering};
use spectra_session::{Control, Session, SessionOptions, SingleThread, Threads, Workers};
use std::path::Path;

const WIDTH: usize = 48;
const HEIGHT: usize = 32;
/// Side of the blocks whose noise is judged, in pixels.
const BLOCK: usize = 16;

fn settings(more: &[&str]) -> Vec<String> {
    let fixed = [format!("imager.resolution=[{WIDTH}, {HEIGHT}]"), "render.noise=3 %".to_owned()];
    fixed.into_iter().chain(more.iter().map(|s| (*s).to_owned())).collect()
}

fn path(scene: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{scene}.yaml"))
}

fn render(scene: &str, more: &[&str], workers: &dyn Workers) -> Rendering {
    let scene = spectra_scene::load(&path(scene), &settings(more)).unwrap_or_else(|faults| panic!("{faults}"));
    Renderer::new(scene, &RenderOptions::default()).expect("ready").run(workers, &Control::new()).expect("rendered")
}

fn bits(exposure: &ExposureFrame) -> Vec<u32> {
    exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
}

/// Returns the mean and the variance between seeds of each pixel, of the luminance or the only layer.
fn over_seeds(scene: &str, more: &[&str], seeds: u64) -> Vec<(f64, f64)> {
    let mut sums = vec![(0.0, 0.0); WIDTH * HEIGHT];
    let scene = spectra_scene::load(&path(scene), &settings(more)).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    for seed in 1..=seeds {
        let exposure = renderer.reseeded(seed).run(&Threads(2), &Control::new()).expect("rendered").exposure;
        let plane = exposure.channels.iter().find(|c| c.name == "Y").unwrap_or(&exposure.channels[0]);
        for ((sum, square), value) in sums.iter_mut().zip(&plane.values) {
            *sum += f64::from(*value);
            *square += f64::from(*value) * f64::from(*value);
        }
    }
    let n = seeds as f64;
    sums.into_iter().map(|(sum, square)| (sum / n, (square - sum * sum / n) / (n - 1.0))).collect()
}

/// The noise between seeds is the requested one: at most 5 % of the blocks end above 1.2 times of it, and none is much cleaner than
/// one round can explain. The mean of many stopped pictures equals that of pictures that did not stop, within 4 standard errors.
#[test]
fn noise_is_what_was_asked_for() {
    let set = ["render.batch=256", "lens.f-number=2"];
    let seeds = 40;
    let stopped = over_seeds("biotar-ortho", &set, seeds);
    let (mut above, mut blocks) = (0, 0);
    for row in 0..HEIGHT / BLOCK {
        for column in 0..WIDTH / BLOCK {
            let pixels: Vec<usize> =
                (0..BLOCK * BLOCK).map(|i| (row * BLOCK + i / BLOCK) * WIDTH + column * BLOCK + i % BLOCK).collect();
            let mean = pixels.iter().map(|p| stopped[*p].0).sum::<f64>() / pixels.len() as f64;
            let variance = pixels.iter().map(|p| stopped[*p].1).sum::<f64>() / pixels.len() as f64;
            let noise = variance.sqrt() / mean;
            println!("block {row}, {column}: {noise}");
            // Another round at most halves the variance.
            assert!(noise > 0.018 && noise < 0.045, "block {row}, {column}: {noise}");
            above += usize::from(noise > 1.2 * 0.03);
            blocks += 1;
        }
    }
    assert!(above * 20 <= blocks, "{above} of {blocks} blocks");
    let all = over_seeds("biotar-ortho", &[&set[..], &["render.noise=null", "render.samples=256"]].concat(), seeds);
    let mean = |pixels: &[(f64, f64)]| {
        let n = pixels.len() as f64;
        let variance = pixels.iter().map(|p| p.1).sum::<f64>() / (n * n * seeds as f64);
        (pixels.iter().map(|p| p.0).sum::<f64>() / n, variance)
    };
    let ((a, va), (b, vb)) = (mean(&stopped), mean(&all));
    assert!((a - b).abs() < 4.0 * (va + vb).sqrt(), "{a} {b} +- {}", (va + vb).sqrt());
}

/// Settings for uniform light of one color, whose only noise comes from rays that are lost.
const EVEN: [&str; 4] = [
    "source={kind: chart, chart: white, width: fill, distance: 3 m}",
    "lens.file=helios-44-58-f2",
    "wavelengths={band: [540 nm, 541 nm]}",
    "render.noise=null",
];

/// Rays lost at the rims add no noise. In uniform light of one color, wide open and at f/8, the spread of a pixel between seeds is at
/// most half of what it was when about 0.7 % of the rays were lost at random: 0.36 % with 256 samples.
#[test]
fn rays_that_end_leave_no_noise() {
    for stop in ["lens.f-number=f/2", "lens.f-number=f/8"] {
        let pixels = over_seeds("biotar-ortho", &[&EVEN[..], &["render.samples=256", stop]].concat(), 6);
        let noise = pixels.iter().map(|(mean, variance)| variance / (mean * mean)).sum::<f64>() / pixels.len() as f64;
        println!("{stop}: {:.3} %", 100.0 * noise.sqrt());
        assert!(noise.sqrt() < 0.5 * 0.0036, "{stop}: {}", noise.sqrt());
    }
}

/// Pictures of few samples are as bright as those of many, although not every sample brings a ray to the rim of the pupil. They agree
/// within 4 standard errors, a tenth of the light at the rim. The result does not depend on the batch size.
#[test]
fn few_samples_are_as_bright_as_many() {
    let even = |more: &[&'static str]| [&EVEN[..], &["lens.f-number=f/2"], more].concat();
    let mean = |samples: &'static str, seeds: u64| {
        let pixels = over_seeds("biotar-ortho", &even(&[samples]), seeds);
        let n = pixels.len() as f64;
        let variance = pixels.iter().map(|p| p.1).sum::<f64>() / (n * n * seeds as f64);
        (pixels.iter().map(|p| p.0).sum::<f64>() / n, variance)
    };
    let (many, of_many) = mean("render.samples=256", 2);
    for samples in ["render.samples=1", "render.samples=5", "render.samples=20"] {
        let (few, of_few) = mean(samples, 8);
        let error = (of_few + of_many).sqrt();
        println!("{samples}: {:+.4} % +- {:.4} %", 100.0 * (few / many - 1.0), 100.0 * error / many);
        assert!((few - many).abs() < 4.0 * error, "{samples}: {few} and {many} +- {error}");
        assert!(error < 0.001 * many, "{samples}: {error}");
        let by = |batch: &'static str| bits(&render("biotar-ortho", &even(&[samples, batch]), &SingleThread).exposure);
        assert!(by("render.batch=8") == by("render.batch=256"), "{samples}");
    }
}

/// Returns the luminance, or the only layer, of pictures of a scene with these seeds, each traced on one thread, two at a time.
fn pictures(scene: &str, more: &[&str], seeds: std::ops::Range<u64>) -> Vec<Vec<f32>> {
    let scene = spectra_scene::load(&path(scene), &settings(more)).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    let one = |seed: u64| {
        let picture = renderer.reseeded(seed).run(&SingleThread, &Control::new());
        let mut channels = picture.expect("rendered").exposure.channels;
        let at = channels.iter().position(|c| c.name == "Y").unwrap_or(0);
        channels.swap_remove(at).values
    };
    let middle = seeds.start + (seeds.end - seeds.start) / 2;
    std::thread::scope(|scope| {
        let second = scope.spawn(|| (middle..seeds.end).map(one).collect::<Vec<_>>());
        let first: Vec<_> = (seeds.start..middle).map(one).collect();
        [first, second.join().expect("no panic")].concat()
    })
}

/// Pictures that stop at 1 % are biased by less than 0.1 %, the frame certainly and its blocks within their errors. At most 5 % of
/// the blocks deviate by more than 1.2 %: each picture from the mean of all, RMS over the pixels of a block.
#[test]
#[ignore = "minutes in a release build: see benches/README.md"]
fn a_thousand_seeds_have_no_bias() {
    let seeds = std::env::var("SPECTRA_SEEDS").map_or(1000, |text| text.parse::<u64>().expect("a number"));
    let scene = "bench/noise-flat";
    let set = ["imager.crop=\"3:2\"", "render.noise=1 %", "render.samples=8192"];
    let stopped = pictures(scene, &set, 0..seeds);
    // Enough pictures for a mean about as accurate as that of the others.
    let fixed = [&set[..1], &["render.noise=null", "render.samples=2048"]].concat();
    let all = pictures(scene, &fixed, 1 << 40..(1 << 40) + seeds.div_ceil(4));
    let mean_of = |pictures: &[Vec<f32>], pixel: usize| {
        pictures.iter().map(|p| f64::from(p[pixel])).sum::<f64>() / pictures.len() as f64
    };
    let truth: Vec<f64> = (0..WIDTH * HEIGHT).map(|pixel| mean_of(&all, pixel)).collect();
    let stopped_mean: Vec<f64> = (0..WIDTH * HEIGHT).map(|pixel| mean_of(&stopped, pixel)).collect();
    // Returns the mean over some pixels relative to the truth there, minus 1, and its standard error from the scatter between
    // pictures.
    let bias = |pixels: &[usize]| {
        let over = |values: &dyn Fn(usize) -> f64| pixels.iter().map(|p| values(*p)).sum::<f64>() / pixels.len() as f64;
        let truth = over(&|p| truth[p]);
        let error2 = |pictures: &[Vec<f32>]| {
            let means: Vec<f64> = pictures.iter().map(|picture| over(&|p| f64::from(picture[p]))).collect();
            let mean = means.iter().sum::<f64>() / means.len() as f64;
            means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (means.len() * (means.len() - 1)) as f64
        };
        (over(&|p| stopped_mean[p]) / truth - 1.0, (error2(&stopped) + error2(&all)).sqrt() / truth)
    };
    let frame: Vec<usize> = (0..WIDTH * HEIGHT).collect();
    let (off, error) = bias(&frame);
    println!("{seeds} seeds: the frame is biased by {:.4} % +- {:.4} %", 100.0 * off, 100.0 * error);
    assert!(off.abs() + 2.0 * error < 0.001, "{off:e} +- {error:e}");
    let (mut above, mut judged) = (0, 0);
    for row in 0..HEIGHT / BLOCK {
        for column in 0..WIDTH / BLOCK {
            let pixels: Vec<usize> =
                (0..BLOCK * BLOCK).map(|i| (row * BLOCK + i / BLOCK) * WIDTH + column * BLOCK + i % BLOCK).collect();
            let (off, error) = bias(&pixels);
            let mean = pixels.iter().map(|p| stopped_mean[*p]).sum::<f64>() / pixels.len() as f64;
            let noises: Vec<f64> = stopped
                .iter()
                .map(|picture| {
                    let square: f64 = pixels.iter().map(|p| (f64::from(picture[*p]) - stopped_mean[*p]).powi(2)).sum();
                    (square / pixels.len() as f64).sqrt() / mean
                })
                .collect();
            let loud = noises.iter().filter(|noise| **noise > 0.012).count();
            println!(
                "block {row}, {column}: {:.4} % +- {:.4} %; noise {:.3} %, {loud} above 1.2 %",
                100.0 * off,
                100.0 * error,
                100.0 * noises.iter().sum::<f64>() / noises.len() as f64
            );
            assert!(off.abs() < 0.001 + 4.0 * error, "block {row}, {column}: {off:e} +- {error:e}");
            (above, judged) = (above + loud, judged + noises.len());
        }
    }
    println!("{above} of {judged} blocks are above 1.2 %");
    assert!(above * 20 <= judged, "{above} of {judged}");
}

/// Parts of a picture stop after different numbers of samples, and the reached noise is reported.
#[test]
fn dark_and_busy_parts_get_more_samples() {
    let picture =
        render("biotar-ortho", &["render.noise=2 %", "render.samples=4096", "lens.f-number=f/4"], &Threads(2));
    let noise = picture.noise.expect("asked for");
    assert!(!picture.partial && noise.worst <= noise.asked && noise.clean == 1.0, "{noise:?}");
    // Every block has at least 16 samples. Others than the worst one have fewer than it. One pixel in eight is traced twice.
    let frame = (WIDTH * HEIGHT) as u64;
    let rays = |samples: u64| samples * frame * 9 / 8;
    assert!(picture.rays > rays(16) && picture.rays < rays(picture.samples), "{}", picture.rays);
    // If the sample limit is reached, a warning says so.
    let few = render("biotar-ortho", &["render.samples=64", "render.noise=0.5 %"], &Threads(2));
    assert!(few.rays == 64 * frame * 9 / 8 && few.noise.is_some_and(|noise| noise.clean < 0.99));
    assert!(few.warnings.iter().any(|warning| warning.contains("`render.samples` (now 64)")), "{:?}", few.warnings);
}

/// The bits are the same on any number of threads and with any batch size, also if the light is saved and loaded in between.
#[test]
fn the_same_bits_however_the_work_is_done() {
    for scene in ["biotar-ortho", "gray-card"] {
        let whole = render(scene, &["render.samples=1024"], &Threads(3));
        let alone = render(scene, &["render.samples=1024", "render.batch=100"], &SingleThread);
        assert_eq!(bits(&whole.exposure), bits(&alone.exposure), "{scene}");
        let open = || {
            Session::open(&path(scene), &settings(&["render.samples=1024"]), SessionOptions::default())
                .expect("a session")
        };
        let mut first = open();
        first.advance(100, &Threads(2), &Control::new()).expect("rendered");
        let mut file = Vec::new();
        first.save(&mut file).expect("saved");
        let mut second = open();
        second.load(&mut file.as_slice()).expect("taken up");
        second.advance(1024, &Threads(2), &Control::new()).expect("rendered");
        assert_eq!(bits(&second.rendering().expect("memory").exposure), bits(&whole.exposure), "{scene}: taken up");
    }
}

#[test]
fn strata_cannot_stop() {
    let faults = spectra_scene::load(&path("gray-card"), &settings(&["render.numbers=stratified"]));
    assert!(
        faults.map(drop).expect_err("refused").to_string().contains("`stratified` numbers need all of their samples")
    );
}

/// A gray card in uniform light at 64 samples per pixel: the noise of every layer of a color negative is below 1.8 %, from the
/// differences of neighbors. From 15 000 differences that figure is accurate to 1 %.
#[test]
fn a_gray_card_is_even_at_64_samples() {
    let set = [
        "lens.f-number=f/8",
        "imager={kind: film, format: 135, resolution: [150, 100]}",
        "film={stock: kodak-vision3-250d-5207, exposure: 1/55 s}",
        "render.samples=64",
    ];
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    let scene = spectra_scene::load(&path("gray-card"), &set).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene, &RenderOptions::default()).expect("ready");
    let exposure = renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure;
    for layer in &exposure.channels {
        let mean = layer.values.iter().map(|v| f64::from(*v)).sum::<f64>() / layer.values.len() as f64;
        let pairs = layer.values.chunks_exact(150).flat_map(|row| row.windows(2));
        let square: f64 = pairs.map(|pair| f64::from(pair[1] - pair[0]).powi(2)).sum();
        let noise = (0.5 * square / (149.0 * 100.0)).sqrt() / mean;
        println!("{}: {:.2} %", layer.name, 100.0 * noise);
        assert!(noise < 0.018, "{}: {noise}", layer.name);
    }
}
