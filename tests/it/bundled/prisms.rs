//! Scenes with dispersed light: lines and continua through a prism, on its screen and as a figure, and a lens that separates three
//! lines.

use super::plane::Plane;
use super::taken::{Taken, first};
use super::{Found, Promise, hold};
use crate::common::{repository, run, shown, text};
use spectra_spectrum::{Observer, balmer, find_emission};

const SCREEN: &[&str] = &["imager.resolution=40", "render.rays=200000"];

/// Returns the index of N-SF11 from the coefficients of SCHOTT's catalog.
fn n_sf11(nm: f64) -> f64 {
    let square = (1e-3 * nm).powi(2);
    let terms = [(1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629)];
    (1.0 + terms.iter().map(|(b, c)| b * square / (square - c)).sum::<f64>()).sqrt()
}

/// Returns where light of a wavelength meets the screen, mm above the middle of the picture. Snell's law is applied at both faces of
/// a prism of 60 degrees, which light enters 15 mm from the apex at the angle of minimum deviation of the d line. The screen is
/// perpendicular to the exiting d line, 150 mm from where it leaves, and the frame is shifted by 13 mm.
fn on_screen_mm(nm: f64) -> f64 {
    let (apex, into) = (60_f64.to_radians(), 63.1713_f64.to_radians());
    let first = (into.sin() / n_sf11(nm)).asin();
    let out = (n_sf11(nm) * (apex - first).sin()).asin();
    // Distance from the apex along the second face.
    let leaves = 15.0 * first.cos() / (0.5 * apex + first).sin();
    let aside = (leaves - 15.0) * out.cos() / (out - into).cos();
    150.0 * (out - into).tan() + aside - 13.0
}

/// Checks that the brightest lines of hydrogen are in place, with nothing between them.
fn lines(taken: &[Taken]) -> Vec<Found> {
    let light = taken[0].light();
    let mut all = Vec::new();
    let mut in_lines = 0.0;
    for upper in 3..8 {
        let nm = balmer(upper).expect("a line");
        let wanted = on_screen_mm(nm);
        // The slit is 0.3 mm wide.
        let window = ([0.0, wanted], [6.0, 0.9]);
        in_lines += light.part(window).map(|(_, value)| value).sum::<f64>();
        all.push(Found::within(&format!("{nm:.1} nm at mm"), light.center(window)[1], wanted, 0.03));
    }
    all.push(Found::above("share of the light in five lines", in_lines / light.sum(), 0.999));
    all
}

/// Checks a continuum. The center of its luminance is that of the source weighted with V, because glass and air reflect all colors
/// nearly equally. It must have no gap.
fn continuum(taken: &[Taken]) -> Vec<Found> {
    let y = taken[0].channel("Y");
    let light = find_emission("blackbody:5800").expect("bundled");
    let mut sums = [0.0; 2];
    for nm in (400..=700).map(f64::from) {
        let weight = light.at(nm) * Observer::cie_1931_2deg().at(nm)[1];
        sums = [sums[0] + weight, sums[1] + weight * on_screen_mm(nm)];
    }
    let ends = [on_screen_mm(656.3), on_screen_mm(434.0)];
    let window = ([0.0, 0.5 * (ends[0] + ends[1])], [2.0, 0.5 * (ends[1] - ends[0])]);
    let rows = taken[0].light().along(1, window);
    let (least, most) = rows.iter().fold((f64::MAX, 0.0_f64), |(low, high), row| (low.min(row[1]), high.max(row[1])));
    vec![
        Found::within("middle of the luminance at mm", y.center(([0.0; 2], [6.0, 18.0]))[1], sums[1] / sums[0], 0.1),
        Found::above("darkest row over the brightest", least / most, 0.02),
    ]
}

/// Returns the light at the violet end of the figure's last row, as a share of full brightness.
fn figure(scene: &str, intensity: &str) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    let path = repository(&format!("scenes/{scene}.yaml"));
    let written = std::fs::read_to_string(&path).expect("a scene");
    assert!(written.contains(&format!("intensity: {intensity}")), "{scene} asks for {intensity}");
    let output =
        format!("output=[{{kind: rays, size: [160, 120], view: 110 mm, wavelengths: 40, intensity: {intensity}}}]");
    let small = ["--set", &output, "--set", "render.rays=2000", "--set", "imager.resolution=20", "--threads", "1"];
    let ended = run(&[&["run", shown(&path), "-o", shown(folder.path())], &small[..]].concat());
    let said = text(&ended.stderr);
    assert!(ended.status.success() && !said.contains("warning"), "{scene}: {said}");
    let picture = image::open(folder.path().join(format!("{scene}-rays.png"))).expect("a figure").into_rgb8();
    let row = picture.height() - 1;
    let lit: Vec<f64> = (0..picture.width())
        .map(|x| f64::from(picture.get_pixel(x, row).0.into_iter().max().unwrap_or(0)) / 255.0)
        .filter(|value| *value > 0.02)
        .collect();
    // The violet end is on the left; its first pixel is only partly covered.
    lit[1..lit.len() / 4].iter().sum::<f64>() / (lit.len() / 4 - 1) as f64
}

/// Separates a picture into its three spectral lines, from the share that X, Y and Z have of each.
fn three_lines(taken: &Taken, nm: [f64; 3]) -> [Plane; 3] {
    let [x, y, z] = ["X", "Y", "Z"].map(|name| taken.channel(name));
    let m = nm.map(|nm| Observer::cie_1931_2deg().at(nm));
    // Rows of the inverse of the matrix with these columns.
    let cross =
        |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let rows = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let volume = dot(m[0], rows[0]);
    rows.map(|row| {
        let [a, b, c] = row.map(|v| v / volume);
        x.with(&y, |x, y| a * x + b * y).with(&z, |xy, z| xy + c * z)
    })
}

/// Checks the dark line that frames the chart, 17 mm from the axis and 74 um wide. In the light of each spectral line it is as sharp
/// as it is drawn, but displaced from the other lines.
fn parted(taken: &[Taken]) -> Vec<Found> {
    let seen = three_lines(&taken[0], [643.85, 546.07, 435.84]).map(|plane| {
        // A place above the arrow beside the line.
        let ground = plane.mean(([0.97, 0.51], [0.08, 0.08]));
        let mut sums = [0.0; 3];
        for [x, value] in plane.along(0, ([1.195, 0.51], [0.1, 0.08])) {
            let dark = (0.75 - value / ground).max(0.0);
            sums = [sums[0] + dark, sums[1] + x * dark, sums[2] + x * x * dark];
        }
        let middle = sums[1] / sums[0];
        [1e3 * middle, 1e3 * (sums[2] / sums[0] - middle * middle).sqrt()]
    });
    let [red, green, blue] = seen.map(|line| line[0]);
    vec![
        Found::above("um from the g line out to the e line", green - blue, 12.0),
        Found::above("um from the e line out to the C' line", red - green, 12.0),
        // Without any blur, a line of this width has 21 um.
        Found::below(
            "widest line, standard deviation in um",
            seen.iter().map(|line| line[1]).fold(0.0, f64::max),
            30.0,
        ),
    ]
}

pub const PRISMS: &[Promise] = &[
    Promise { scene: "prism-hydrogen", pictures: &[first(SCREEN)], says: "the Balmer lines, on a screen", held: lines },
    Promise {
        scene: "prism-5800k",
        pictures: &[first(SCREEN)],
        says: "a blackbody through a prism; the figure shows every color at full brightness",
        held: |t| {
            let mut all = continuum(t);
            all.push(Found::above("violet in the figure", figure("prism-5800k", "full"), 0.9));
            all
        },
    },
    Promise {
        scene: "prism-5800k-true",
        pictures: &[first(SCREEN)],
        says: "a blackbody through a prism; the figure shows colors at their true relative intensity",
        held: |t| {
            let mut all = continuum(t);
            all.push(Found::below("violet in the figure", figure("prism-5800k-true", "\"true\""), 0.6));
            all
        },
    },
    Promise {
        scene: "biotar-lines",
        pictures: &[first(&[
            "source.width=1.45 m",
            "imager={kind: xyz, width: 3 mm, height: 1.2 mm, shift: [-15.5 mm, 0], resolution: 240}",
            "render.samples=96",
        ])],
        says: "every color is made of three lines; lateral color splits the picture into three",
        held: parted,
    },
];

#[test]
fn light_taken_apart() {
    hold(PRISMS);
}
