//! Constants of radiation and photometry.

/// Planck constant, J s (exact in the SI of 2019).
pub const PLANCK_J_S: f64 = 6.626_070_15e-34;
/// Speed of light in vacuum, m/s (exact).
pub const LIGHT_M_PER_S: f64 = 299_792_458.0;
/// Boltzmann constant, J/K (exact in the SI of 2019).
pub const BOLTZMANN_J_PER_K: f64 = 1.380_649e-23;

/// First radiation constant of radiance, 2 h c^2, W m^2 sr^-1.
pub const FIRST_RADIATION_W_M2_PER_SR: f64 = 2.0 * PLANCK_J_S * LIGHT_M_PER_S * LIGHT_M_PER_S;
/// Second radiation constant, h c / k, m K.
pub const SECOND_RADIATION_M_K: f64 = PLANCK_J_S * LIGHT_M_PER_S / BOLTZMANN_J_PER_K;
/// Wien displacement constant of wavelength, m K: h c / (k x), x the root of x = 5 (1 - exp(-x)).
pub const WIEN_M_K: f64 = SECOND_RADIATION_M_K / 4.965_114_231_744_276;
/// Stefan-Boltzmann constant, 2 pi^5 k^4 / (15 h^3 c^2), W m^-2 K^-4.
pub const STEFAN_BOLTZMANN_W_PER_M2_K4: f64 = {
    let pi = std::f64::consts::PI;
    let k = BOLTZMANN_J_PER_K;
    // Grouped so that no intermediate value leaves the range of an f64.
    2.0 * (pi * pi * pi * pi * pi) / 15.0 * (k / PLANCK_J_S) * (k / PLANCK_J_S) * (k / PLANCK_J_S) * k
        / (LIGHT_M_PER_S * LIGHT_M_PER_S)
};

/// Luminous efficacy, lm/W, that turns an integral over V(lambda) into lumens.
///
/// The SI fixes 683 lm/W at 540 THz (555.016 nm in air), where V(lambda) is 0.999 997; the maximum at 555 nm is
/// 683.002 lm/W. CIE 018:2019 allows 683, used here: 3 parts in a million.
pub const LUMINOUS_EFFICACY_LM_PER_W: f64 = 683.0;

/// Rydberg constant for infinite nuclear mass, 1/m (CODATA 2018).
pub const RYDBERG_PER_M: f64 = 10_973_731.568_160;
/// Ratio of the proton's mass to the electron's (CODATA 2018).
pub const PROTON_ELECTRON_MASS_RATIO: f64 = 1_836.152_673_43;
/// Refractive index of standard air as a constant, for wavelengths computed by hand.
pub const AIR_INDEX: f64 = 1.000_277;
