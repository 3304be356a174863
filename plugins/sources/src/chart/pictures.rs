//! Writes each chart as a PNG for visual inspection.
//!
//! ```text
//! SPECTRA_CHART_PICTURES=folder cargo test -p spectra-plugin-sources chart::pictures -- --ignored
//! ```

use super::*;

/// Encoded sRGB, 8 bit, of the patches in their order (manufacturer's values, ColorChecker before November 2014).
const PATCH_SRGB: [[u8; 3]; 24] = [
    [115, 82, 68],
    [194, 150, 130],
    [98, 122, 157],
    [87, 108, 67],
    [133, 128, 177],
    [103, 189, 170],
    [214, 126, 44],
    [80, 91, 166],
    [193, 90, 99],
    [94, 60, 108],
    [157, 188, 64],
    [224, 163, 46],
    [56, 61, 150],
    [70, 148, 73],
    [175, 54, 60],
    [231, 199, 31],
    [187, 86, 149],
    [8, 133, 161],
    [243, 243, 242],
    [200, 200, 200],
    [160, 160, 160],
    [122, 122, 121],
    [85, 85, 85],
    [52, 52, 52],
];

fn decoded(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

fn linear(ink: Ink) -> [f64; 3] {
    match ink {
        Ink::Gray(reflectance) => [reflectance; 3],
        Ink::Rgb(rgb) => rgb.map(decoded),
        Ink::Own(number) => panic!("no drawn chart has the user's patch {number}"),
        Ink::Patch(name) => {
            let index = PATCHES.iter().position(|&known| known == name).expect("patches have listed names");
            PATCH_SRGB[index].map(|v| decoded(f64::from(v) / 255.0))
        }
    }
}

/// Renders the part of a chart between two corners, `columns` pixels wide; each pixel is the mean of 4 x 4 points.
fn picture(chart: &Chart, low: [f64; 2], high: [f64; 2], columns: u32) -> image::RgbImage {
    let pixel = (high[0] - low[0]) / f64::from(columns);
    let rows = ((high[1] - low[1]) / pixel).round() as u32;
    let colors: Vec<[f64; 3]> = chart.inks().iter().map(|&ink| linear(ink)).collect();
    image::RgbImage::from_fn(columns, rows, |column, row| {
        let mut sum = [0.0; 3];
        for sub in 0..16_u32 {
            let x = low[0] + pixel * (f64::from(column) + (f64::from(sub % 4) + 0.5) / 4.0);
            let y = high[1] - pixel * (f64::from(row) + (f64::from(sub / 4) + 0.5) / 4.0);
            if let Some(color) = colors.get(usize::from(chart.ink_at(x, y))) {
                (0..3).for_each(|k| sum[k] += color[k] / 16.0);
            }
        }
        image::Rgb(sum.map(|v| (255.0 * encoded(v)).round() as u8))
    })
}

#[test]
#[ignore = "writes pictures to the folder SPECTRA_CHART_PICTURES"]
fn write_each_chart() {
    let folder = std::env::var_os("SPECTRA_CHART_PICTURES").expect("SPECTRA_CHART_PICTURES names a folder");
    let folder = std::path::Path::new(&folder);
    std::fs::create_dir_all(folder).expect("the folder can be made");
    for entry in CHARTS {
        let chart = entry.build(None, 1).expect("every chart can be built");
        let half = [0.5 * chart.width_mm(), 0.5 * chart.height_mm()];
        let whole = picture(&chart, half.map(|v| -v), half, 1800);
        whole.save(folder.join(format!("{}.png", entry.name))).expect("the picture can be written");
    }
    let chart = chart("resolution", None, 1).expect("the resolution chart can be built");
    for (name, low, high) in [
        ("upper", [-350.0, 100.0], [350.0, 460.0]),
        ("middle", [-350.0, -110.0], [350.0, 110.0]),
        ("lower", [-350.0, -460.0], [350.0, -90.0]),
        ("corner", [350.0, 140.0], [755.0, 505.0]),
    ] {
        let part = picture(&chart, low, high, 1600);
        part.save(folder.join(format!("resolution-{name}.png"))).expect("the picture can be written");
    }
}
