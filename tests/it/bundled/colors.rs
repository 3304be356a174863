//! How films, sensors and eyes record the patches of a ColorChecker.

use super::plane::{Plane, Window, mean};
use super::taken::{Taken, first};
use super::{Found, Promise, hold};
use crate::common::{repository, run, shown, text};
use spectra_core::spectral::Channel;
use spectra_spectrum::{COLOR_CHECKER, find_emission, find_reflectance};

const SMALL: &[&str] = &["imager.resolution=96", "render.samples=64"];
const ORTHO: &[&str] = &["imager.resolution=96", "render.samples=64", "film.stock=ilford-ortho-plus"];
/// Settings for the resolution chart, whose patches are small.
const FINE: &[&str] = &["imager.resolution=192", "render.samples=32"];

/// Positions of the patches of a chart on the film, mm: center of the block, distance between neighboring patches, and half the width
/// of a window.
pub struct Block {
    pub middle: [f64; 2],
    pub pitch: f64,
    pub half: f64,
}

/// A ColorChecker that fills a frame 36 mm wide: patches are 46 of 282 mm, slightly more in the middle because of the lens's
/// distortion.
const WHOLE: Block = Block { middle: [0.0, 0.0], pitch: 6.3, half: 1.3 };
/// A ColorChecker that fills an APS-C sensor 23.6 mm wide.
const APS_C: Block = Block { middle: [0.0, 0.0], pitch: 4.1, half: 0.8 };
/// The patches in the resolution chart, 65 of 1500 mm each. One mm of this chart is 27 um on the film.
const OF_CHART: Block = Block { middle: [0.0, -6.79], pitch: 1.752, half: 0.5 };

impl Block {
    fn window(&self, name: &str) -> Window {
        let at = COLOR_CHECKER.iter().position(|patch| *patch == name).expect("a patch");
        let (column, row) = ((at % 6) as f64, (at / 6) as f64);
        let [x, y] = self.middle;
        ([x + (column - 2.5) * self.pitch, y + (1.5 - row) * self.pitch], [self.half; 2])
    }
}

const GRAYS: [&str; 6] = ["white", "neutral-8", "neutral-6.5", "neutral-5", "neutral-3.5", "black"];
/// A gray of 9 %: to the eye, the red patch is lighter and the blue patch darker.
const DARK_GRAY: &str = "neutral-3.5";
/// Indices of the patches near the middle of the frame.
const INNER: [usize; 12] = [7, 8, 9, 10, 13, 14, 15, 16, 19, 20, 21, 22];

/// Checks that the light of the patches on each channel follows from their reflectances, the given light and the channel's
/// sensitivity. Reports the largest difference as a share of white. The falloff is the fourth power of the cosine, from a pupil 53 mm
/// in front of the film.
pub fn reflected(taken: &Taken, block: &Block, light: &str) -> Found {
    let grid = &taken.scene.grid;
    let light = find_emission(light).expect("bundled").to_power(grid);
    let mut worst = 0.0_f64;
    for (plane, response) in taken.channels() {
        let white = light.seen_by(response);
        let pair = |at: &usize| {
            let name = COLOR_CHECKER[*at];
            let patch = find_reflectance(&format!("colorchecker#{name}")).expect("bundled").on_grid(grid);
            let seen: Vec<f64> = response.iter().zip(&patch).map(|(a, b)| a * b).collect();
            let window = block.window(name);
            let [x, y] = window.0;
            let cosine2 = 1.0 / (1.0 + (x * x + y * y) / (53.0 * 53.0));
            (plane.mean_of_lit(window) / (cosine2 * cosine2), light.seen_by(&seen) / white)
        };
        let pairs: Vec<(f64, f64)> = INNER.iter().map(pair).collect();
        let scale = pairs.iter().map(|(a, b)| a * b).sum::<f64>() / pairs.iter().map(|(_, b)| b * b).sum::<f64>();
        worst = pairs.iter().map(|(a, b)| (a / scale - b).abs()).fold(worst, f64::max);
    }
    // With more layers to share the light, each layer is noisier.
    let most = if taken.channels().len() == 1 { 0.03 } else { 0.06 };
    Found::below("patches are off by", worst, most)
}

/// Returns the light of one patch of the finished picture over that of another.
fn over(tones: &Plane, block: &Block, patch: &str, other: &str) -> f64 {
    tones.mean(block.window(patch)) / tones.mean(block.window(other))
}

/// Checks that one patch of the finished picture has at least `least` times the light of another.
fn lighter(tones: &Plane, block: &Block, light: &str, dark: &str, least: f64) -> Found {
    Found::above(&format!("{light} over {dark}"), over(tones, block, light, dark), least)
}

/// Checks that one patch of the finished picture has at most `most` times the light of another.
fn darker(tones: &Plane, block: &Block, dark: &str, light: &str, most: f64) -> Found {
    Found::below(&format!("{dark} over {light}"), over(tones, block, dark, light), most)
}

/// Returns a picture on paper without the black of the paper itself, a density of 2.1 under a flare of 0.5 %.
fn over_paper_black(tones: &Plane) -> Plane {
    const BLACK: f64 = (0.007_943_3 + 0.005) / 1.005;
    tones.with(tones, |value, _| value - BLACK)
}

/// Checks that the grays fall from white to black, as in a positive.
fn falling(tones: &Plane, block: &Block) -> Found {
    let steps = GRAYS.map(|name| tones.mean(block.window(name)));
    let least = steps.windows(2).map(|pair| pair[0] / pair[1]).fold(f64::MAX, f64::min);
    Found::above("each gray over the next", least, 1.05)
}

/// Checks that each color of the finished picture has at least half as much light again in its own primaries as in the others, and
/// that grays have little color.
fn hues(taken: &Taken, film: usize, block: &Block, tint: f64) -> Vec<Found> {
    let colors = taken.colors(film);
    let of = |name: &str| [0, 1, 2].map(|k: usize| colors[k].mean(block.window(name)));
    let mut all = Vec::new();
    let own =
        [("red", 0b001), ("green", 0b010), ("blue", 0b100), ("yellow", 0b011), ("magenta", 0b101), ("cyan", 0b110)];
    for (name, primaries) in own {
        let rgb = of(name);
        let side = |is_own: bool| (0..3).filter(move |k| (primaries >> k & 1 == 1) == is_own).map(|k| rgb[k]);
        let (low, high) = (side(true).fold(f64::MAX, f64::min), side(false).fold(f64::MIN, f64::max));
        all.push(Found::above(&format!("{name}: light of its primaries over other light"), low / high.max(1e-4), 1.5));
    }
    let cast = |name: &&str| {
        let rgb = of(name);
        rgb.iter().map(|v| (v / rgb[1] - 1.0).abs()).fold(0.0, f64::max)
    };
    all.push(Found::below("grays are tinted by", GRAYS[1..4].iter().map(cast).fold(0.0, f64::max), tint));
    all
}

pub const FILMS: &[Promise] = &[
    Promise {
        scene: "biotar-blue-plate",
        pictures: &[first(SMALL)],
        says: "blue prints light and every other color dark",
        held: |t| {
            let tones = t[0].tones(0);
            let dark = ["green", "red", "yellow", "orange", "moderate-red", "yellow-green"];
            let over = dark.map(|dark| lighter(&tones, &WHOLE, "blue", dark, 2.0));
            over.into_iter().chain([reflected(&t[0], &WHOLE, "D55")]).collect()
        },
    },
    Promise {
        scene: "biotar-panchromatic-plate",
        pictures: &[first(SMALL)],
        says: "sees red, but blue far better",
        held: |t| {
            let tones = t[0].tones(0);
            let grid = &t[0].scene.grid;
            let response = &t[0].scene.channels[0].response;
            let to = |from_nm: u32| mean((from_nm..from_nm + 80).map(|nm| grid.interpolate(response, f64::from(nm))));
            vec![
                lighter(&tones, &WHOLE, "red", DARK_GRAY, 1.5),
                // To the eye, green has four times the luminance of blue.
                lighter(&tones, &WHOLE, "blue", "green", 1.2),
                Found::above("sensitive to blue over red", to(400) / to(600), 2.0),
                reflected(&t[0], &WHOLE, "D55"),
            ]
        },
    },
    Promise {
        scene: "biotar-double-x",
        pictures: &[first(SMALL)],
        says: "in tungsten light, printed: a positive that sees red",
        held: |t| {
            let tones = t[0].tones(0);
            vec![falling(&tones, &WHOLE), lighter(&tones, &WHOLE, "red", "blue", 1.3), reflected(&t[0], &WHOLE, "A")]
        },
    },
    Promise {
        scene: "biotar-trix",
        pictures: &[first(SMALL), first(ORTHO)],
        says: "panchromatic film sees red, to which orthochromatic film is blind",
        held: |t| {
            let tones = t[0].tones(0);
            vec![
                lighter(&tones, &WHOLE, "red", DARK_GRAY, 1.15),
                darker(&t[1].tones(0), &WHOLE, "red", DARK_GRAY, 0.5),
                falling(&tones, &WHOLE),
                reflected(&t[0], &WHOLE, "D55"),
            ]
        },
    },
    Promise {
        scene: "three-films",
        pictures: &[first(SMALL)],
        says: "one trace, three films; red is black only on the first one",
        held: |t| {
            let [red, green, blue] = t[0].colors(2).map(|plane| plane.mean(WHOLE.window("red")));
            vec![
                darker(&t[0].tones(0), &WHOLE, "red", DARK_GRAY, 0.5),
                lighter(&t[0].tones(1), &WHOLE, "red", DARK_GRAY, 1.15),
                Found::above("color: red over other light of red", red / green.max(blue), 3.0),
                // The ratio of the chart itself in D55, from its reflectances, is 1.345.
                Found::within(
                    "color: red over a dark gray",
                    over(&t[0].tones(2), &WHOLE, "red", DARK_GRAY),
                    1.345,
                    0.15,
                ),
                reflected(&t[0], &WHOLE, "D55"),
            ]
        },
    },
    Promise {
        scene: "biotar-color-negative",
        pictures: &[first(SMALL)],
        says: "printed on the stock that was made for it: a positive in its colors",
        held: |t| {
            let mut all = hues(&t[0], 0, &WHOLE, 0.2);
            all.extend([falling(&t[0].tones(0), &WHOLE), reflected(&t[0], &WHOLE, "D55")]);
            all
        },
    },
    Promise {
        scene: "biotar-reversal",
        pictures: &[first(SMALL)],
        says: "on reversal film, projected: a positive in its colors",
        held: |t| {
            let mut all = hues(&t[0], 0, &WHOLE, 0.2);
            all.extend([falling(&t[0].tones(0), &WHOLE), reflected(&t[0], &WHOLE, "D55")]);
            all
        },
    },
    Promise {
        scene: "biotar-three-strip",
        pictures: &[first(SMALL)],
        says: "three separation negatives, printed by dye transfer: a positive in its colors",
        held: |t| {
            let mut all = hues(&t[0], 0, &WHOLE, 0.2);
            all.extend([falling(&t[0].tones(0), &WHOLE), reflected(&t[0], &WHOLE, "D55")]);
            all.push(Found::is("three negatives", t[0].channels().len() == 3));
            all
        },
    },
    Promise {
        scene: "biotar-ortho",
        pictures: &[first(FINE)],
        says: "red turns black and blue turns light: the film is blind beyond 565 nm",
        held: |t| {
            let tones = t[0].tones(0);
            let response = &t[0].scene.channels[0].response;
            let most = response.iter().copied().fold(0.0, f64::max);
            let last = response.iter().rposition(|value| *value > 0.01 * most).expect("it sees something");
            vec![
                Found::within("sensitivity ends at nm", t[0].scene.grid.wavelength_nm(last), 565.0, 5.0),
                darker(&over_paper_black(&tones), &OF_CHART, "red", DARK_GRAY, 0.5),
                lighter(&tones, &OF_CHART, "blue", DARK_GRAY, 2.0),
                reflected(&t[0], &OF_CHART, "D65"),
            ]
        },
    },
];

pub const EYES: &[Promise] = &[
    Promise {
        scene: "biotar-color",
        pictures: &[first(FINE)],
        says: "the chart in CIE XYZ, as the eye would see it",
        held: |t| {
            let y = t[0].channel("Y");
            vec![
                reflected(&t[0], &OF_CHART, "D65"),
                lighter(&y, &OF_CHART, "red", DARK_GRAY, 1.1),
                darker(&y, &OF_CHART, "blue", DARK_GRAY, 0.9),
            ]
        },
    },
    Promise {
        scene: "night-vision",
        pictures: &[first(SMALL)],
        says: "by V'(lambda) red is darker than blue",
        held: |t| {
            // To the eye by day, red is 1.3 times as light as this gray, and blue two thirds as light.
            let light = t[0].channel("scotopic");
            vec![
                darker(&light, &WHOLE, "red", DARK_GRAY, 0.7),
                lighter(&light, &WHOLE, "blue", DARK_GRAY, 1.2),
                lighter(&light, &WHOLE, "blue", "red", 2.0),
                reflected(&t[0], &WHOLE, "D65"),
            ]
        },
    },
    Promise {
        scene: "false-color",
        pictures: &[first(SMALL)],
        says: "green becomes blue, red and orange become yellow, and grays stay gray",
        held: |t| {
            let colors = t[0].colors(0);
            let of = |name: &str| [0, 1, 2].map(|k: usize| colors[k].mean(WHOLE.window(name)));
            let [green, red, orange] = ["green", "red", "orange"].map(of);
            let cast = |name: &&str| {
                let rgb = of(name);
                rgb.iter().map(|v| (v / rgb[1] - 1.0).abs()).fold(0.0, f64::max)
            };
            let yellow = |name: &str, [r, g, b]: [f64; 3]| {
                [
                    Found::above(&format!("{name}: red and green over blue"), r.min(g) / b, 2.0),
                    Found::near(&format!("{name}: red over green"), r / g, 1.0, 0.35),
                ]
            };
            let mut all = vec![
                Found::above("green: blue over other light", green[2] / green[0].max(green[1]), 1.5),
                Found::below("grays are tinted by", GRAYS[1..4].iter().map(cast).fold(0.0, f64::max), 0.1),
            ];
            all.extend(yellow("red", red).into_iter().chain(yellow("orange", orange)));
            all
        },
    },
    Promise {
        scene: "sensor-biotar",
        pictures: &[first(SMALL)],
        says: "the ColorChecker on a sensor with color filters, a raw file that raw converters open",
        held: |t| {
            let mut all = hues(&t[0], 0, &APS_C, 0.15);
            all.extend([reflected(&t[0], &APS_C, "D65"), raw_file("sensor-biotar")]);
            all
        },
    },
    Promise {
        scene: "sensor-wide-angle",
        pictures: &[
            first(&["imager.resolution=48", "render.samples=200"]),
            first(&["imager.resolution=48", "render.samples=200", "lens.file=canon-35-f1.8", "lens.f-number=f/8"]),
        ],
        says: "light reaches the corners obliquely, and they change color; a retrofocus lens does not show this",
        held: |t| {
            let [wide, retrofocus] = [&t[0], &t[1]].map(|taken| {
                let [red, green, _] = taken.colors(0);
                let tint = |window: Window| red.mean(window) / green.mean(window);
                let corners = [[15.6, 9.6], [-15.6, 9.6], [15.6, -9.6], [-15.6, -9.6]].map(|at| tint((at, [2.4; 2])));
                mean(corners.into_iter()) / tint(([0.0; 2], [2.4; 2]))
            });
            vec![
                Found::above("red over green, corners over middle", wide, 1.4),
                Found::within("red over green, through a retrofocus lens", retrofocus, 1.0, 0.1),
            ]
        },
    },
    Promise {
        scene: "spectral-bands",
        pictures: &[first(SMALL)],
        says: "the spectrum in 20 bands of 20 nm, named as in spectral OpenEXR, with the lines of FL11",
        held: bands,
    },
];

/// Checks for a DNG: a TIFF file with a version (tag 50706) and with light behind a mosaic of color filters (tag 262 is 32803).
fn raw_file(scene: &str) -> Found {
    let folder = tempfile::tempdir().expect("a folder");
    let path = repository(&format!("scenes/{scene}.yaml"));
    let out = folder.path();
    let small = ["--samples", "1", "--set", "imager.resolution=48", "--threads", "1"];
    let output = run(&[&["run", shown(&path), "-o", shown(out)], &small[..]].concat());
    let said = text(&output.stderr);
    assert!(output.status.success() && !said.contains("warning"), "{scene}: {said}");
    let dng = std::fs::read(out.join(format!("{scene}.dng"))).expect("it is written");
    let number =
        |at: usize, bytes: usize| dng[at..at + bytes].iter().rev().fold(0, |sum, b| sum << 8 | usize::from(*b));
    let begin = number(4, 4);
    let entries = (0..number(begin, 2)).map(|k| begin + 2 + 12 * k);
    let tags: Vec<(usize, usize)> = entries.map(|at| (number(at, 2), number(at + 8, 2))).collect();
    let is_raw = dng.starts_with(b"II*\0") && tags.contains(&(262, 32803)) && tags.iter().any(|tag| tag.0 == 50706);
    Found::is("the raw file is a DNG with a mosaic", is_raw)
}

/// Checks that the share of each band in the light of the grays is the share of the lamp there: grays reflect all wavelengths
/// equally.
fn bands(taken: &[Taken]) -> Vec<Found> {
    let channels = taken[0].channels();
    let lamp = find_emission("FL11").expect("bundled");
    let grays = |plane: &Plane| mean(GRAYS[1..4].iter().map(|name| plane.mean(WHOLE.window(name))));
    let found = channels.iter().map(|(plane, _)| grays(plane));
    let of_band = |k: usize| mean((0..200).map(|i| lamp.at(380.0 + 20.0 * k as f64 + (f64::from(i) + 0.5) * 0.1)));
    let share = |all: Vec<f64>| -> Vec<f64> { all.iter().map(|v| v / all.iter().sum::<f64>()).collect() };
    let (found, wanted) = (share(found.collect()), share((0..20).map(of_band).collect()));
    let worst = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let named = |(k, channel): (usize, &Channel)| channel.name == format!("S0.{}0,0nm", 39 + 2 * k);
    let are_named = taken[0].scene.channels.iter().enumerate().all(named);
    vec![
        Found::is("20 channels S0.390,0nm to S0.770,0nm", channels.len() == 20 && are_named),
        Found::below("bands are off by", worst, 0.02),
        // These bands contain 435, 545 and 611 nm.
        Found::above("share of three bands in all light", [2, 8, 11].map(|k| found[k]).iter().sum(), 0.45),
    ]
}

#[test]
fn color_checkers_on_film() {
    hold(FILMS);
}

#[test]
fn color_checkers_for_eyes_and_sensors() {
    hold(EYES);
}
