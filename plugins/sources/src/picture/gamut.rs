//! Gamut mapping: colors for which the color model has no spectrum are moved toward white and counted.

use spectra_color::{MARGIN, fit_to_gamut};
use spectra_core::stage::{ColorGamut, ColorModel};
use spectra_pictures::read::{FileProblem, LinearPicture};

/// Pixels whose largest value is below this fraction of white are too dark for a warning.
const DARK: f32 = 1e-3;
/// Distance in xy up to which a shift needs no warning: less than an eye sees (a MacAdam ellipse). The red of Display P3, which many
/// photographs contain, moves by a third of it.
const UNSEEN: f64 = 3.0 * MARGIN;

/// Moves the picture's colors into the gamut of the model, and adds a warning about how many moved.
pub(super) fn bring_in(linear: &mut LinearPicture, model: &dyn ColorModel) {
    let gamut = model.gamut();
    let (mut moved, mut farthest, mut black) = (0_usize, 0.0_f64, 0_usize);
    for pixel in linear.rgb.iter_mut().filter(|pixel| pixel.iter().any(|v| *v < 0.0)) {
        let fitted = fit_to_gamut(pixel.map(f64::from), gamut);
        let counts = pixel.iter().any(|v| v.abs() > DARK);
        if counts && fitted.distance_xy.is_infinite() {
            black += 1;
        } else if counts && fitted.distance_xy > 0.0 {
            moved += 1;
            farthest = farthest.max(fitted.distance_xy);
        }
        *pixel = fitted.rgb.map(|v| v as f32);
    }
    let all = linear.rgb.len();
    let mut said = Vec::new();
    if farthest > UNSEEN {
        let beyond = match gamut {
            ColorGamut::Srgb => "colors outside sRGB, for which this color model has no spectrum",
            ColorGamut::Real => "colors that no light has, or only light of a single wavelength",
        };
        said.push(format!(
            "{moved} of its {all} pixels have {beyond}: they are moved toward white by at most {farthest:.4} in xy, at the same luminance"
        ));
    }
    if black > 0 {
        said.push(format!("{black} of its {all} pixels have negative luminance and are black"));
    }
    if said.is_empty() {
        return;
    }
    let hint = match gamut {
        ColorGamut::Srgb => {
            "write `color: {kind: smooth}`, which keeps all real colors, or convert the picture to sRGB"
        }
        ColorGamut::Real => {
            "convert it to a narrower gamut, such as Rec. 2020 or Display P3, in the program that made it"
        }
    };
    linear.warnings.push(FileProblem { key: "file", text: said.join("; "), hint: Some(hint.to_owned()) });
}
