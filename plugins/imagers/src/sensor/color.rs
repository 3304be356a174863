//! What the sensor's colors mean: its matrix and its white, from its sensitivities.

use glam::{DMat3, DVec3};
use spectra_core::spectral::{Channel, Grid, SpectralPower};
use spectra_spectrum::{Emission, Observer, find_reflectance};

/// The patches that the matrix is fitted to: ISO 17321-1.
const PATCHES: [&str; 24] = [
    "dark-skin",
    "light-skin",
    "blue-sky",
    "foliage",
    "blue-flower",
    "bluish-green",
    "orange",
    "purplish-blue",
    "moderate-red",
    "purple",
    "yellow-green",
    "orange-yellow",
    "blue",
    "green",
    "red",
    "yellow",
    "magenta",
    "cyan",
    "white",
    "neutral-8",
    "neutral-6.5",
    "neutral-5",
    "neutral-3.5",
    "black",
];

/// Matrix and white of a camera under a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraColor {
    /// The camera's red, green and blue, of which those of white have 1 as the largest, from XYZ, of which white has Y 1.
    pub camera_from_xyz: DMat3,
    /// The camera's red, green and blue of white; the largest is 1.
    pub neutral: DVec3,
    /// XYZ of white, Y 1.
    pub white_xyz: DVec3,
}

impl CameraColor {
    /// Fits the matrix to the ColorChecker's patches under a light, by least squares; white is met exactly by what is
    /// left over, shared out along white. `None` for sensitivities that are blind to one of three colors.
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
        let (mut products, mut squares) = (DMat3::ZERO, DMat3::ZERO);
        for patch in PATCHES {
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
            // Every patch counts alike, the dark ones too.
            let weight = 1.0 / (xyz.y * xyz.y);
            products += DMat3::from_cols(camera * xyz.x, camera * xyz.y, camera * xyz.z) * weight;
            squares += DMat3::from_cols(xyz * xyz.x, xyz * xyz.y, xyz * xyz.z) * weight;
        }
        let (neutral, white_xyz) = (camera_white / largest, white / y);
        let fitted = products * squares.inverse();
        let missing = neutral - fitted * white_xyz;
        let along = white_xyz / white_xyz.length_squared();
        let camera_from_xyz = fitted + DMat3::from_cols(missing * along.x, missing * along.y, missing * along.z);
        camera_from_xyz.inverse().is_finite().then_some(Self { camera_from_xyz, neutral, white_xyz })
    }
}
