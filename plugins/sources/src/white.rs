//! The light of white: illuminant and luminance, which all picture sources share.

use spectra_core::params::{DataEnd, Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::SpectralPower;
use spectra_spectrum::{Observer, constants};

/// Finds the illuminant named under the key `illuminant`, on the grid of the band. It must have visible light.
pub(crate) fn illuminant(name: &str, params: &Params, context: &Context<'_>) -> Result<SpectralPower, Faults> {
    let power = light("illuminant", name, params, context)?;
    if luminance_cd_m2(&power) > 0.0 {
        Ok(power)
    } else {
        let fault = params.fault("illuminant", format!("`{name}` has no visible light, so no luminance can be set"));
        Err(fault.hint("write a light with power between 380 and 780 nm, such as D65").into())
    }
}

/// Finds the emission spectrum `name`, written under `key`, on the grid of the band. It must have light in the band.
pub(crate) fn light(key: &str, name: &str, params: &Params, context: &Context<'_>) -> Result<SpectralPower, Faults> {
    let found = spectra_spectrum::find_emission_in(name, context.resources)
        .map_err(|e| e.faults(|text| params.fault(key, text)))?;
    let power = found.to_power(&context.grid);
    if let (Some((first, last)), Some(warnings)) = (found.flat_beyond_nm(), context.warnings) {
        warnings.push_end(DataEnd { place: params.fault(key, name), measured_nm: [first, last] });
    }
    if power.is_dark() {
        let fault = params.fault(key, format!("`{name}` has no light in the band"));
        let (first, last) = (context.grid.start_nm, context.grid.end_nm());
        let hint =
            format!("the band is {first} to {last} nm: write another light, or another `wavelengths: {{band: ...}}`");
        return Err(fault.hint(hint).into());
    }
    Ok(power)
}

/// Returns the luminance, cd/m^2, of a radiance spectrum (W m^-2 sr^-1 nm^-1).
pub(crate) fn luminance_cd_m2(radiance: &SpectralPower) -> f64 {
    constants::LUMINOUS_EFFICACY_LM_PER_W * Observer::cie_1931_2deg().xyz_of_power(radiance)[1]
}
