//! Light at a surface between two media: refraction, Fresnel's equations, a single coating.
//!
//! Media are transparent (real indices). Angles are measured from the normal, in radians.

/// Fractions of the power that are reflected, by polarization.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// Reflectance for an electric field perpendicular to the plane of incidence.
    pub s: f64,
    /// Reflectance for an electric field in the plane of incidence.
    pub p: f64,
}

impl Reflectance {
    /// Reflectance for unpolarized light: the mean of both polarizations.
    #[must_use]
    pub fn mean(self) -> f64 {
        0.5 * (self.s + self.p)
    }
}

/// Returns the angle of refraction (radians) from index `n1` into `n2`; `None` on total reflection.
#[must_use]
pub fn refraction_angle(n1: f64, n2: f64, incidence_rad: f64) -> Option<f64> {
    let sine = n1 * libm::sin(incidence_rad) / n2;
    (sine.abs() <= 1.0).then(|| libm::asin(sine))
}

/// Returns the critical angle in `n1`, above which light is totally reflected at `n2`; `None` unless `n1` is larger than `n2`.
#[must_use]
pub fn critical_angle(n1: f64, n2: f64) -> Option<f64> {
    (n1 > n2 && n2 > 0.0).then(|| libm::asin(n2 / n1))
}

/// Returns Brewster's angle in `n1`, at which no p-polarized light is reflected at `n2`.
#[must_use]
pub fn brewster_angle(n1: f64, n2: f64) -> f64 {
    libm::atan2(n2, n1)
}

/// Returns the Fresnel reflectance between `n1` and `n2`, from the cosine of the angle of incidence in `n1` (0 to 1). Both values
/// are 1 on total reflection. Born and Wolf, Principles of Optics, section 1.5.
#[must_use]
pub fn fresnel(n1: f64, n2: f64, cos_incidence: f64) -> Reflectance {
    let ratio = n1 / n2;
    let cos_square = 1.0 - ratio * ratio * (1.0 - cos_incidence * cos_incidence);
    if cos_square <= 0.0 {
        return Reflectance { s: 1.0, p: 1.0 };
    }
    let cos_refraction = cos_square.sqrt();
    let amplitude = |a: f64, b: f64| (a - b) / (a + b);
    let s = amplitude(n1 * cos_incidence, n2 * cos_refraction);
    let p = amplitude(n2 * cos_incidence, n1 * cos_refraction);
    Reflectance { s: s * s, p: p * p }
}

/// Returns the reflectance at normal incidence of a layer of index `n_layer` and `thickness_nm` between media of index `n1` and
/// `n2`, at `wavelength_nm` in air. Airy's sum; Born and Wolf, section 1.6.4.
#[must_use]
pub fn single_layer_reflectance(n1: f64, n_layer: f64, n2: f64, thickness_nm: f64, wavelength_nm: f64) -> f64 {
    let front = (n1 - n_layer) / (n1 + n_layer);
    let back = (n_layer - n2) / (n_layer + n2);
    // Phase of one round trip.
    let phase = 4.0 * std::f64::consts::PI * n_layer * thickness_nm / wavelength_nm;
    let cross = 2.0 * front * back * libm::cos(phase);
    let (front2, back2) = (front * front, back * back);
    (front2 + back2 + cross) / (1.0 + front2 * back2 + cross)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_and_grazing() {
        let r = fresnel(1.0, 1.5, 1.0);
        assert!((r.s - 0.04).abs() < 1e-15 && (r.p - 0.04).abs() < 1e-15);
        let grazing = fresnel(1.0, 1.5, 0.0);
        assert!((grazing.s - 1.0).abs() < 1e-15 && (grazing.p - 1.0).abs() < 1e-15);
        assert!((fresnel(1.5, 1.0, 0.5).mean() - 1.0).abs() < 1e-15);
    }

    /// Light that comes back along the refracted ray is reflected in the same fractions.
    #[test]
    fn reflectance_is_the_same_from_both_sides() {
        for degrees in [0.0, 20.0, 40.0, 56.0, 80.0] {
            let outside = f64::to_radians(degrees);
            let inside = refraction_angle(1.0, 1.7, outside).expect("no total reflection into the denser medium");
            let (a, b) = (fresnel(1.0, 1.7, libm::cos(outside)), fresnel(1.7, 1.0, libm::cos(inside)));
            assert!((a.s - b.s).abs() < 1e-14 && (a.p - b.p).abs() < 1e-14);
        }
    }

    #[test]
    fn a_layer_of_no_thickness_or_of_half_a_wave_is_not_there() {
        let bare = fresnel(1.0, 1.5168, 1.0).s;
        assert!((single_layer_reflectance(1.0, 1.38, 1.5168, 0.0, 550.0) - bare).abs() < 1e-15);
        assert!((single_layer_reflectance(1.0, 1.38, 1.5168, 550.0 / 2.76, 550.0) - bare).abs() < 1e-15);
    }

    #[test]
    fn critical_angle_of_glass() {
        let angle = critical_angle(1.5, 1.0).expect("glass is denser");
        assert!((angle.to_degrees() - 41.8103).abs() < 1e-4);
        assert!(refraction_angle(1.5, 1.0, angle + 1e-9).is_none());
        assert!(refraction_angle(1.5, 1.0, angle - 1e-9).is_some());
        assert_eq!(critical_angle(1.0, 1.5), None);
    }
}
