//! Colors as named spectra: `rgb:#ff8040`, `rgb:255,128,64 by gaussians`, `srgb-r`, `rgb-lines`.
//!
//! Such a color, used as a light, is the spectrum that a color model gives it under D65. Used as a surface, a filter or a detector, it is
//! the function by which the model multiplies an equal-energy light.

use spectra_color::{RgbSpace, chromaticity, dominant_wavelength, matrix};
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile, Span, Value};
use spectra_core::registry::{self, Context, Stage};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_core::spectral::{BAND, Line, SpectralPower};
use spectra_core::stage::ColorModel;
use spectra_spectrum::{
    Emission, Kind, Observer, Outside, PendingSpectrum, Scale, SpectralFunction, SpectrumError, Tabulated, illuminant,
};
use std::sync::Arc;

spectra_spectrum::expression_of_wanted!(
    "rgb:#ff8040",
    "write an sRGB color such as rgb:#ff8040 or rgb:255,128,64, and a color model if not the default one: rgb:#ff8040 by gaussians",
    |text, wanted| {
        let (color, model) = match text.split_once(" by ") {
            Some((color, model)) => (color, Some(model.trim())),
            None => (text, None),
        };
        of_color(code_values(color)?, model, wanted)
    }
);
spectra_spectrum::expression_of_wanted!("srgb-r", "write srgb-r alone", |_, wanted| of_color(
    [255.0, 0.0, 0.0],
    None,
    wanted
));
spectra_spectrum::expression_of_wanted!("srgb-g", "write srgb-g alone", |_, wanted| of_color(
    [0.0, 255.0, 0.0],
    None,
    wanted
));
spectra_spectrum::expression_of_wanted!("srgb-b", "write srgb-b alone", |_, wanted| of_color(
    [0.0, 0.0, 255.0],
    None,
    wanted
));
spectra_spectrum::expression_of_wanted!("srgb-w", "write srgb-w alone", |_, wanted| of_color([255.0; 3], None, wanted));

spectra_spectrum::expression_of_wanted!("rgb-lines", "write rgb-lines alone", |_, _| Some(
    rgb_lines().map(PendingSpectrum::from)
));

/// Returns three spectral lines with the hues of sRGB's red, green and blue, whose powers add up to white (D65). Such light looks like
/// daylight until it falls on something. The mean power is 1, like that of the lines of other sets.
fn rgb_lines() -> Result<Emission, SpectrumError> {
    let (space, observer) = (RgbSpace::srgb(), Observer::cie_1931_2deg());
    let white = space.white_xyz();
    let mut lines_nm = [0.0; 3];
    let mut xyz_of_lines = [[0.0; 3]; 3];
    for (i, nm) in lines_nm.iter_mut().enumerate() {
        let mut primary = [0.0; 3];
        primary[i] = 1.0;
        let hue = chromaticity(space.to_xyz(primary)).zip(chromaticity(white));
        *nm = hue.and_then(|(hue, white)| dominant_wavelength(hue, white)).map_or(f64::NAN, |hue| hue.wavelength_nm);
        let line = observer.at(*nm);
        (0..3).for_each(|k| xyz_of_lines[k][i] = line[k]);
    }
    let powers = matrix::apply(&matrix::inverse(&xyz_of_lines), white);
    let unit = 3.0 / powers.iter().sum::<f64>();
    let lines =
        lines_nm.into_iter().zip(powers).map(|(wavelength_nm, power)| Line { wavelength_nm, power: unit * power });
    Emission::new(None, lines.collect())
}

/// Parses `#ff8040` or `255,128,64` into three values from 0 to 255; `None` if the text is neither.
fn code_values(text: &str) -> Option<[f64; 3]> {
    let text = text.trim();
    if let Some(digits) = text.strip_prefix('#') {
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        let channel = |i: usize| u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok().map(f64::from);
        return Some([channel(0)?, channel(1)?, channel(2)?]);
    }
    let values: Option<Vec<f64>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    let values: [f64; 3] = values?.try_into().ok()?;
    values.iter().all(|v| (0.0..=255.0).contains(v)).then_some(values)
}

/// Returns the spectrum of a color by the named model, or by the default one; `None` if there is no model of that name.
fn of_color(
    code_values: [f64; 3],
    model: Option<&str>,
    wanted: Kind,
) -> Option<Result<PendingSpectrum, SpectrumError>> {
    let entries = <dyn ColorModel as Stage>::entries();
    let name = match model {
        Some(name) => entries.iter().find(|entry| entry.name == name)?.name,
        None => entries.iter().find(|entry| entry.default)?.name,
    };
    Some(spectrum(code_values, name, wanted))
}

fn spectrum(code_values: [f64; 3], model: &str, wanted: Kind) -> Result<PendingSpectrum, SpectrumError> {
    let is_light = matches!(wanted, Kind::Emission | Kind::Lines);
    let under = if is_light { illuminant("D65")? } else { Emission::constant(1.0)? };
    let model = build(model, &under.to_power(&BAND))?;
    let linear = RgbSpace::srgb().decode(code_values.map(|v| v / 255.0));
    let SpectralPower { grid, continuum, lines } = model.spectrum(linear);
    let wavelengths: Vec<f64> = grid.wavelengths_nm().collect();
    let outside = if is_light { Outside::Zero } else { Outside::Constant };
    let is_dark = continuum.iter().all(|v| *v == 0.0);
    let shape = SpectralFunction::tabulated(Tabulated::new(&wavelengths, &continuum, outside, Scale::Linear)?);
    if is_light {
        let continuum = (!is_dark || lines.is_empty()).then_some(shape);
        return Emission::new(continuum, lines).map(PendingSpectrum::from);
    }
    if lines.iter().any(|line| line.power != 0.0) {
        let (left, right) = ("a color model of spectral lines", wanted.word());
        return Err(SpectrumError::NotTogether { left, right, operation: "meaning" });
    }
    Ok(PendingSpectrum::Bare(shape))
}

/// Builds the color model `name` with its defaults, for the illuminant `light`.
fn build(name: &str, light: &SpectralPower) -> Result<Box<dyn ColorModel>, SpectrumError> {
    let file = Arc::new(SourceFile::new("rgb", name));
    let node = Node::new(Value::String(name.to_owned()), Span { len: name.len(), ..Span::default() }, file);
    let params = Params::stage(node, "color").map_err(SpectrumError::Document)?;
    let context = Context { illuminant: Some(light), ..Context::new(&NoFiles, BAND) };
    registry::build::<dyn ColorModel>(&params, &context).map_err(SpectrumError::Document)
}

/// Resources that refuse every file: a model with its defaults reads none.
struct NoFiles;

impl Resources for NoFiles {
    fn read(&self, path: &str, _: &[&str], _: &[&str], _: u64) -> Result<Resource, ResourceError> {
        Err(ResourceError::Io(format!("`{path}` is not read for a color that is named in a line")))
    }

    fn document(&self, path: &str, _: &[&str], _: &[&str]) -> Result<Params, Faults> {
        Err(Fault::new(format!("`{path}` is not read for a color that is named in a line")).into())
    }
}

#[cfg(test)]
mod tests {
    use spectra_color::{RgbSpace, chromaticity, xyz_of_light, xyz_of_reflectance};
    use spectra_spectrum::{Observer, find_emission, find_reflectance, illuminant};

    /// Named colors have the right chromaticity as lights and, at half brightness, as surfaces under D65.
    #[test]
    fn colors_are_lights_and_surfaces() {
        let observer = Observer::cie_1931_2deg();
        let d65 = illuminant("D65").expect("bundled");
        let space = RgbSpace::srgb();
        for (name, rgb) in [
            ("srgb-r", [1.0, 0.0, 0.0]),
            ("srgb-g", [0.0, 1.0, 0.0]),
            ("srgb-b", [0.0, 0.0, 1.0]),
            ("srgb-w", [1.0; 3]),
            ("rgb:#ff8040", [1.0, 0.215_860_5, 0.051_269_5]),
            ("rgb:255,128,64 by smooth", [1.0, 0.215_860_5, 0.051_269_5]),
        ] {
            let wanted = chromaticity(space.to_xyz(rgb)).expect("a color");
            let light = find_emission(name).unwrap_or_else(|e| panic!("{name}: {e}"));
            let seen = xyz_of_light(&light, observer).and_then(chromaticity).expect("a color");
            let apart = (seen[0] - wanted[0]).hypot(seen[1] - wanted[1]);
            assert!(apart < 2e-3, "{name}: {seen:?}, not {wanted:?}");
            let surface = find_reflectance(&format!("0.5 * {name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
            let seen = xyz_of_reflectance(&surface, &d65, observer).expect("a color");
            let apart = chromaticity(seen).map(|s| (s[0] - wanted[0]).hypot(s[1] - wanted[1])).expect("a color");
            assert!(apart < 2e-3, "{name} as a surface: {apart}");
            assert!((seen[1] / 50.0 / space.luminance(rgb) - 1.0).abs() < 0.02, "{name}: Y {}", seen[1]);
        }
        for wrong in ["rgb:#ff80", "rgb:1,2", "rgb:300,0,0", "rgb:#ff8040 by magic"] {
            assert!(find_emission(wrong).expect_err(wrong).to_string().contains("is not understood"), "{wrong}");
        }
    }

    const RGB_LINES: [(f64, f64); 3] = [(611.282, 0.747_601), (549.133, 1.148_732), (464.312, 1.103_667)];

    /// The lines of `rgb-lines` make white together, and have the hues of the primaries.
    #[test]
    fn rgb_lines_make_white() {
        let observer = Observer::cie_1931_2deg();
        let (space, light) = (RgbSpace::srgb(), find_emission("rgb-lines").expect("named"));
        let white = chromaticity(space.white_xyz()).expect("a color");
        let seen = xyz_of_light(&light, observer).and_then(chromaticity).expect("a color");
        assert!((seen[0] - white[0]).abs() < 1e-12 && (seen[1] - white[1]).abs() < 1e-12, "{seen:?}");
        // Dominant wavelengths and relative powers from an independent computation (xtask/rgb_lines.py).
        for (line, (nm, power)) in light.lines().iter().zip(RGB_LINES) {
            assert!((line.wavelength_nm - nm).abs() < 0.01, "{line:?}");
            assert!((line.power - power).abs() < 1e-3, "{line:?}");
        }
        // Each line has the hue of its primary: line, primary and white lie on one straight line in xy.
        for (i, line) in light.lines().iter().enumerate() {
            let mut primary = [0.0; 3];
            primary[i] = 1.0;
            let [p, l] =
                [space.to_xyz(primary), observer.at(line.wavelength_nm)].map(|xyz| chromaticity(xyz).expect("a color"));
            let [a, b] = [p, l].map(|xy| [xy[0] - white[0], xy[1] - white[1]]);
            assert!((a[0] * b[1] - a[1] * b[0]).abs() < 1e-5 && a[0] * b[0] + a[1] * b[1] > 0.0, "{line:?}");
        }
        let total: f64 = light.lines().iter().map(|line| line.power).sum();
        assert!((total - 3.0).abs() < 1e-12);
    }
}
