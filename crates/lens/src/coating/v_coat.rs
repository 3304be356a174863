//! `kind: v-coat`: two layers that reflect nothing at one wavelength.
//!
//! H. A. Macleod, "Thin-Film Optical Filters", chapter 3, antireflection coatings of two layers: with indices n1 next to the air
//! and n2 next to the glass n', a stack of phase thicknesses delta1 and delta2 reflects nothing at normal incidence where
//! tan^2 delta1 = (n' - 1) (n2^2 - n') n1^2 / ((n1^2 n' - n2^2) (n' - n1^2)),
//! tan^2 delta2 = (n' - 1) (n' - n1^2) n2^2 / ((n1^2 n' - n2^2) (n2^2 - n')),
//! and tan delta1 tan delta2 = n1 n2 (n' - 1) / (n1^2 n' - n2^2) says which of their angles belong together.

use super::{Coating, CoatingEntry, Stack, StackLayer};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math;
use spectra_core::params::{Faults, Params, Positive, Wavelength};
use spectra_core::registry::Context;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Two layers that reflect nothing at one wavelength, on glass of one index.
///
/// For lenses of one light: lasers, narrow filters, a line of hydrogen. Beside its wavelength it reflects more than a single layer; on
/// glass of another index a little remains. The inner layer is of high index, both are as thin as they can be.
///
/// # Example
/// ```yaml
/// {kind: v-coat, at: 656.3 nm, glass: 1.5143}
/// ```
///
/// # References
/// - H. A. Macleod, Thin-Film Optical Filters, chapter 3.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct VCoat {
    /// Where nothing is reflected, nm if bare.
    at: Positive<Wavelength>,
    /// Index of the glass there, 1.1 to 4.
    #[schemars(range(min = 1.1, max = 4))]
    glass: f64,
    /// Index of the layer next to the air, 1.1 to 5: magnesium fluoride.
    #[serde(default = "magnesium_fluoride")]
    #[schemars(range(min = 1.1, max = 5))]
    low: f64,
    /// Index of the layer next to the glass, 1.1 to 5: zirconium oxide.
    #[serde(default = "zirconium_oxide")]
    #[schemars(range(min = 1.1, max = 5))]
    high: f64,
}

fn magnesium_fluoride() -> f64 {
    1.38
}

fn zirconium_oxide() -> f64 {
    2.1
}

spectra_core::register!(CoatingEntry, "v-coat": VCoat, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<Coating>, Faults> {
    let p: VCoat = params.parse()?;
    let Some([outer, inner]) = waves(p.low, p.high, p.glass) else {
        let text = format!("layers of {} and {} cannot take away what glass of {} reflects", p.low, p.high, p.glass);
        return Err(params
            .fault("glass", text)
            .hint("`low` above the root of the glass's index, and `high` above `low` times that root")
            .into());
    };
    let layer = |waves: f64, index: f64| StackLayer::constant(waves * p.at.nm() / index, index, 0.0);
    Ok(Box::new(Coating::Stack(Arc::new(Stack::new(vec![layer(outer, p.low), layer(inner, p.high)])))))
}

/// Optical thicknesses of both layers in wavelengths, the thinner pair; `None` where there is none.
fn waves(low: f64, high: f64, glass: f64) -> Option<[f64; 2]> {
    let (low2, high2) = (low * low, high * high);
    let (above, below, cross) = (high2 - glass, glass - low2, low2 * glass - high2);
    let squares = [(glass - 1.0) * above * low2 / (cross * below), (glass - 1.0) * below * high2 / (cross * above)];
    if !squares.iter().all(|square| square.is_finite() && *square >= 0.0) {
        return None;
    }
    let [outer, inner] = squares.map(|square| math::atan(square.sqrt()));
    let pairs = if cross > 0.0 {
        [[outer, inner], [PI - outer, PI - inner]]
    } else {
        [[outer, PI - inner], [PI - outer, inner]]
    };
    let thickness = |[outer, inner]: [f64; 2]| outer / low + inner / high;
    let thinner = if thickness(pairs[0]) <= thickness(pairs[1]) { pairs[0] } else { pairs[1] };
    Some(thinner.map(|delta| delta / TAU))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the characteristic matrix, which knows nothing of these formulas: nothing is reflected at the wavelength, on every glass; and
    /// beside it the curve is the V that has given it its name.
    #[test]
    fn nothing_is_reflected_at_its_wavelength() {
        let mut found = 0;
        for glass in [1.45, 1.5168, 1.62, 1.75, 1.9] {
            for (low, high) in [(1.38, 2.1), (1.46, 2.35), (1.38, 1.75)] {
                let Some([outer, inner]) = waves(low, high, glass) else { continue };
                found += 1;
                let layer = |waves: f64, index: f64| StackLayer::constant(waves * 550.0 / index, index, 0.0);
                let coating = Coating::Stack(Arc::new(Stack::new(vec![layer(outer, low), layer(inner, high)])));
                let reflected = |nm: f64| coating.reflectance(1.0, glass, 1.0, nm).mean();
                assert!(reflected(550.0) < 1e-15, "{low} {high} on {glass}: {:e}", reflected(550.0));
                assert!(reflected(500.0) > 1e-4 && reflected(610.0) > 1e-4);
                assert!(outer + inner < 0.75, "{outer} {inner}");
            }
        }
        assert_eq!(found, 12);
    }

    /// What a single layer can do: on glass of the square of its index no second layer is needed.
    #[test]
    fn a_perfect_single_layer_needs_no_second() {
        let [outer, inner] = waves(1.38, 2.1, 1.38 * 1.38 - 1e-12).expect("a coating");
        assert!((outer - 0.25).abs() < 1e-5 && inner < 1e-5, "{outer} {inner}");
        // Between two low layers there is none on such glass.
        assert_eq!(waves(1.2, 1.3, 1.9), None);
    }
}
