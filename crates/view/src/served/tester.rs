//! The color tester: light of one wavelength or a narrow band, as an eye sees it and as a screen can show it.
//!
//! The figures are those of `spectra spectrum info`; the page requests them for each change and draws them.

use serde_json::{Value, json};
use spectra_color::{Gamut, RgbSpace, chromaticity, into_gamut, to_u8};
use spectra_spectrum::{BAND, Observer};

/// Longest step by which a band is integrated, nm.
const STEP_NM: f64 = 0.25;
/// Largest width of a band, nm.
const WIDEST_NM: f64 = 200.0;
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// A light, and the way to show it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRequest {
    /// Middle of the band, nm.
    pub wavelength_nm: f64,
    /// Full width of the band, nm; the power is constant over the band. 0 is a line.
    pub width_nm: f64,
    /// Intensity, 0 to 100; at 100 the brightest channel of the screen is at its maximum.
    pub intensity: f64,
    pub space: &'static RgbSpace,
    pub gamut: Gamut,
    /// Mixture of the screen's channels to compare with the light, linear, 0 to 1.
    pub mixed: [f64; 3],
}

impl LightRequest {
    /// Parses the words of a page; the error names the wrong one.
    pub(crate) fn of(word: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let number = |name: &str, least: f64, most: f64| {
            let text = word(name).ok_or_else(|| format!("the number `{name}` is missing"))?;
            let value = text.parse().ok().filter(|value: &f64| (least..=most).contains(value));
            value.ok_or_else(|| format!("`{name}` must be a number from {least} to {most}"))
        };
        let space = word("space").unwrap_or_default();
        let space = spaces().into_iter().find(|(name, _)| *name == space).map(|(_, space)| space);
        let gamut = match word("gamut").as_deref() {
            Some("clip") => Gamut::Clip,
            Some("desaturate") => Gamut::Desaturate,
            Some("perceptual") => Gamut::Perceptual,
            _ => return Err("`gamut` must be clip, desaturate or perceptual".to_owned()),
        };
        Ok(Self {
            wavelength_nm: number("nm", BAND.start_nm, BAND.end_nm())?,
            width_nm: number("width", 0.0, WIDEST_NM)?,
            intensity: number("intensity", 0.0, 100.0)?,
            space: space.ok_or("`space` is not one of the spaces")?,
            gamut,
            mixed: [number("r", 0.0, 1.0)?, number("g", 0.0, 1.0)?, number("b", 0.0, 1.0)?],
        })
    }
}

/// Returns the color spaces to choose from, with their names in CSS Color 4.
fn spaces() -> [(&'static str, &'static RgbSpace); 3] {
    [("srgb", RgbSpace::srgb()), ("display-p3", RgbSpace::display_p3()), ("rec2020", RgbSpace::rec2020())]
}

/// Returns XYZ of the light for a power of 1: the mean of the observer's functions over the band.
fn xyz(asked: &LightRequest) -> [f64; 3] {
    let observer = Observer::cie_1931_2deg();
    let steps = (asked.width_nm / STEP_NM).ceil().max(1.0);
    let mut sum = [0.0; 3];
    for i in 0..steps as u32 {
        let at = asked.wavelength_nm + ((f64::from(i) + 0.5) / steps - 0.5) * asked.width_nm;
        sum.iter_mut().zip(observer.at(at)).for_each(|(sum, v)| *sum += v / steps);
    }
    sum
}

/// Returns u', v' of the CIE 1976 diagram, in which equal distances look about equally large; `None` for no light.
fn uv_1976(xyz: [f64; 3]) -> Option<[f64; 2]> {
    let [x, y, z] = xyz;
    let sum = x + 15.0 * y + 3.0 * z;
    (sum > 0.0).then(|| [4.0 * x / sum, 9.0 * y / sum])
}

/// Returns the figures of a light as JSON.
pub(crate) fn color(asked: &LightRequest) -> Value {
    let space = asked.space;
    let xyz = xyz(asked);
    let signed = space.from_xyz(xyz);
    let brightest = signed.into_iter().fold(0.0, f64::max);
    // The light is scaled so that its brightest channel is 1, as in `spectrum info`.
    let full = signed.map(|v| if brightest > 0.0 { v / brightest } else { 0.0 });
    let strong = full.map(|v| v * asked.intensity / 100.0);
    let linear = into_gamut(strong, space, asked.gamut);
    let coded = space.encode(linear);
    let outside: Vec<Value> = CHANNELS
        .iter()
        .zip(full)
        .filter(|(_, v)| *v < -5e-5)
        .map(|(name, v)| json!({"channel": name, "by": -v}))
        .collect();
    let shown = space.to_xyz(linear);
    let mixed = space.to_xyz(asked.mixed);
    let apart = |other: [f64; 3]| {
        uv_1976(xyz)
            .zip(uv_1976(other))
            .map(|(a, b)| ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt())
    };
    json!({
        "nm": asked.wavelength_nm,
        "xy": chromaticity(xyz),
        "efficacy": 683.002 * xyz[1],
        "linear": linear,
        "signed": full,
        "coded": coded.map(to_u8),
        "coded_exact": coded,
        "outside": outside,
        "shown_xy": chromaticity(shown),
        "shown_apart": apart(shown),
        "mixed_xy": chromaticity(mixed),
        "mixed_coded": space.encode(asked.mixed).map(to_u8),
        "mixed_exact": space.encode(asked.mixed),
        "mixed_apart": apart(mixed),
    })
}

/// Returns the data of the diagram as JSON: the spectral locus with colors, and the screens' gamuts.
pub(crate) fn diagram() -> Value {
    let observer = Observer::cie_1931_2deg();
    let srgb = RgbSpace::srgb();
    let locus = BAND.wavelengths_nm().filter_map(|nm| {
        let xyz = observer.at(nm);
        let signed = srgb.from_xyz(xyz).map(|v| v.max(0.0));
        let brightest = signed.into_iter().fold(0.0, f64::max);
        let linear = signed.map(|v| if brightest > 0.0 { v / brightest } else { 0.0 });
        chromaticity(xyz).map(|[x, y]| json!({"nm": nm, "x": x, "y": y, "srgb": srgb.encode(linear).map(to_u8)}))
    });
    let spaces = spaces().map(|(name, space)| {
        json!({"name": name, "title": space.name, "corners": space.primaries_xy, "white": space.white_xy})
    });
    json!({"locus": locus.collect::<Vec<_>>(), "spaces": spaces, "range_nm": [BAND.start_nm, BAND.end_nm()], "widest_nm": WIDEST_NM})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(wavelength_nm: f64) -> LightRequest {
        let (space, gamut) = (RgbSpace::srgb(), Gamut::Clip);
        LightRequest { wavelength_nm, width_nm: 0.0, intensity: 100.0, space, gamut, mixed: [0.5; 3] }
    }

    fn three(value: &Value) -> [f64; 3] {
        [0, 1, 2].map(|i| value[i].as_f64().expect("a number"))
    }

    /// Colors of spectral lines agree with the published dispersion study, whose table is linear. Half the intensity gives half of each
    /// value.
    #[test]
    fn lines_of_mercury_are_those_of_the_study() {
        for (nm, table, shown) in [
            (436.0, [33, 0, 255], [101, 0, 255]),
            (547.0, [0, 255, 0], [0, 255, 0]),
            (577.0, [255, 148, 0], [255, 200, 0]),
            (579.0, [255, 126, 0], [255, 187, 0]),
            (620.0, [255, 0, 0], [255, 0, 0]),
        ] {
            let got = color(&asked(nm));
            let (linear, coded) = (three(&got["linear"]), three(&got["coded"]));
            for i in 0..3 {
                assert!(to_u8(linear[i]).abs_diff(table[i]) <= 1, "{nm}: {linear:?}");
                assert!((coded[i] - f64::from(shown[i])).abs() <= 1.0, "{nm}: {coded:?}");
            }
            assert!(!got["outside"].as_array().expect("a list").is_empty(), "no screen has a line of the spectrum");
            let half = three(&color(&LightRequest { intensity: 50.0, ..asked(nm) })["linear"]);
            assert!((0..3).all(|i| (half[i] - linear[i] / 2.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_band_is_the_mean_of_its_lines() {
        let band = color(&LightRequest { width_nm: 2.0, ..asked(560.0) });
        // The mean from 559 to 561 nm of the 1 nm table, which is linear between its rows.
        let at = |nm| Observer::cie_1931_2deg().at(nm);
        let mean = [0, 1, 2].map(|i| (at(559.0)[i] + 2.0 * at(560.0)[i] + at(561.0)[i]) / 4.0);
        let wanted = chromaticity(mean).expect("light");
        for i in 0..2 {
            assert!((band["xy"][i].as_f64().expect("a number") - wanted[i]).abs() < 2e-6, "{band} {wanted:?}");
        }
        // A wide band around green lies inside the gamut of every screen.
        assert!(
            color(&LightRequest { width_nm: 200.0, ..asked(540.0) })["outside"].as_array().expect("a list").is_empty()
        );
    }

    #[test]
    fn what_a_page_sends_is_looked_at() {
        let words = |nm: &'static str, space: &'static str| {
            LightRequest::of(move |name| {
                Some(str::to_owned(match name {
                    "nm" => nm,
                    "space" => space,
                    "gamut" => "clip",
                    _ => "0.5",
                }))
            })
        };
        assert!(words("577", "srgb").is_ok());
        for (nm, space) in [("349", "srgb"), ("831", "srgb"), ("NaN", "srgb"), ("", "srgb"), ("577", "/etc/passwd")] {
            assert!(words(nm, space).is_err(), "{nm} {space}");
        }
    }
}
