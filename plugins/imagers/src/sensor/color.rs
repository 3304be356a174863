//! Color of a sensor: the matrices and the white, computed from its sensitivities.

use glam::{DMat3, DVec3};
use spectra_color::Adaptation;
use spectra_core::spectral::{Channel, Grid, SpectralPower};
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::{COLOR_CHECKER, Emission, Observer, find_reflectance};

/// XYZ of D50, x 0.3457, y 0.3585: the white of the color space of raw converters (Adobe, Digital Negative Specification 1.4).
const D50: [f64; 3] = [0.3457 / 0.3585, 1.0, (1.0 - 0.3457 - 0.3585) / 0.3585];

/// Color matrices and white of a camera under one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraColor {
    /// Matrix from XYZ to the camera's red, green and blue. White has Y = 1 in XYZ and 1 as its largest camera value.
    pub camera_from_xyz: DMat3,
    /// The camera's red, green and blue for white; the largest is 1.
    pub neutral: DVec3,
    /// XYZ of white, with Y = 1.
    pub white_xyz: DVec3,
    /// Matrix from balanced camera values to XYZ adapted to D50 (Bradford). Balanced means that red, green and blue are each
    /// divided by their value for white.
    pub d50_from_balanced: DMat3,
    /// Signal that 1 lx s of white light gives in the channel with the largest signal, in the unit of the channels.
    pub largest_per_lx_s: f64,
}

impl CameraColor {
    /// Fits the matrices to the patches of the ColorChecker (ISO 17321-1) under a light, by least squares. White is reproduced
    /// exactly. In the matrix from XYZ, the error of white is added back along white; in the matrix to D50, white is a
    /// constraint of the fit (G. D. Finlayson, M. S. Drew, J. Electron. Imaging 6, 484 (1997)). `None` if there are not three
    /// channels, or if they cannot distinguish three colors under this light.
    #[must_use]
    pub fn fit(channels: &[Channel], light: &Emission, grid: &Grid) -> Option<Self> {
        let [red, green, blue] = channels else { return None };
        let power = light.to_power(grid);
        let observer = Observer::cie_1931_2deg().on_grid(grid);
        let seen = |power: &SpectralPower| {
            let by = |response: &[f64]| power.seen_by(response);
            let camera = DVec3::new(by(&red.response), by(&green.response), by(&blue.response));
            (camera, DVec3::new(by(&observer[0]), by(&observer[1]), by(&observer[2])))
        };
        let (camera_white, white) = seen(&power);
        let (largest, y) = (camera_white.max_element(), white.y);
        if !(camera_white.min_element() > 0.0 && y > 0.0) {
            return None;
        }
        let (neutral, white_xyz) = (camera_white / largest, white / y);
        let to_d50 = Adaptation::Bradford.matrix(white_xyz.to_array(), D50);
        let to_d50 = DMat3::from_cols_array_2d(&to_d50).transpose();
        let (mut products, mut squares) = (DMat3::ZERO, DMat3::ZERO);
        let (mut adapted_products, mut balanced_squares) = (DMat3::ZERO, DMat3::ZERO);
        for patch in COLOR_CHECKER {
            let reflectance = find_reflectance(&format!("colorchecker#{patch}")).ok()?;
            let continuum =
                power.continuum.iter().zip(grid.wavelengths_nm()).map(|(p, w)| p * reflectance.at(w)).collect();
            let line = |l: &spectra_core::spectral::Line| spectra_core::spectral::Line {
                power: l.power * reflectance.at(l.wavelength_nm),
                ..*l
            };
            let lines = power.lines.iter().map(line).collect();
            let (camera, xyz) = seen(&SpectralPower { grid: *grid, continuum, lines });
            let (camera, xyz) = (camera / largest, xyz / y);
            // Relative weights, so that dark patches count as much as bright ones.
            let weight = 1.0 / (xyz.y * xyz.y);
            products += outer(camera, xyz) * weight;
            squares += outer(xyz, xyz) * weight;
            let balanced = camera / neutral;
            adapted_products += outer(to_d50 * xyz, balanced) * weight;
            balanced_squares += outer(balanced, balanced) * weight;
        }
        let fitted = products * squares.inverse();
        let missing = neutral - fitted * white_xyz;
        let along = white_xyz / white_xyz.length_squared();
        let camera_from_xyz = fitted + outer(missing, along);
        let inverse = balanced_squares.inverse();
        let fitted = adapted_products * inverse;
        // Lagrange multipliers: the least-squares matrix among all that map (1, 1, 1) to white.
        let along = inverse * DVec3::ONE;
        let missing = DVec3::from_array(D50) - fitted * DVec3::ONE;
        let d50_from_balanced = fitted + outer(missing, along / along.element_sum());
        let largest_per_lx_s = largest / (LUMINOUS_EFFICACY_LM_PER_W * y);
        let found = Self { camera_from_xyz, neutral, white_xyz, d50_from_balanced, largest_per_lx_s };
        (camera_from_xyz.inverse().is_finite() && d50_from_balanced.is_finite()).then_some(found)
    }
}

/// Returns the outer product a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
