//! `kind: v-coat`: two layers that together reflect nothing at one wavelength.
//!
//! From H. A. Macleod, "Thin-Film Optical Filters", chapter 3, antireflection coatings of two layers. With index n1 next to the air
//! and n2 next to the glass n', a stack of phase thicknesses delta1 and delta2 reflects nothing at normal incidence if
//! tan^2 delta1 = (n' - 1) (n2^2 - n') n1^2 / ((n1^2 n' - n2^2) (n' - n1^2)) and
//! tan^2 delta2 = (n' - 1) (n' - n1^2) n2^2 / ((n1^2 n' - n2^2) (n2^2 - n')).
//! The product tan delta1 tan delta2 = n1 n2 (n' - 1) / (n1^2 n' - n2^2) determines which pairs of angles belong together.

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
/// Use it for lenses that see one wavelength: lasers, narrow filters, a hydrogen line. At other wavelengths it reflects more than a single
/// layer; on glass of another index a little reflection remains. The inner layer has the high index; both are as thin as possible.
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
    /// Wavelength at which nothing is reflected, nm if bare.
    at: Positive<Wavelength>,
    /// Index of the glass at that wavelength, 1.1 to 4.
    #[schemars(range(min = 1.1, max = 4))]
    glass: f64,
    /// Index of the layer next to the air, 1.1 to 5; the default is magnesium fluoride.
    #[serde(default = "magnesium_fluoride")]
    #[schemars(range(min = 1.1, max = 5))]
    low: f64,
    /// Index of the layer next to the glass, 1.1 to 5; the default is zirconium oxide.
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
        let text = format!("layers of {} and {} cannot cancel the reflection of glass of {}", p.low, p.high, p.glass);
        return Err(params
            .fault("glass", text)
            .hint("choose `low` above the square root of the glass's index, and `high` above `low` times that root")
            .into());
    };
    let layer = |waves: f64, index: f64| StackLayer::constant(waves * p.at.nm() / index, index, 0.0);
    Ok(Box::new(Coating::Stack(Arc::new(Stack::new(vec![layer(outer, p.low), layer(inner, p.high)])))))
}

/// Computes the optical thicknesses of both layers in wavelengths, for the thinner pair; `None` if there is no solution.
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

    /// By the characteristic matrix, which is independent of these formulas, nothing is reflected at the wavelength on any glass. Beside
    /// it the curve has the V shape that gives the coating its name.
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

    /// On glass whose index is the square of the layer's index a single layer suffices, and the second layer vanishes.
    #[test]
    fn a_perfect_single_layer_needs_no_second() {
        let [outer, inner] = waves(1.38, 2.1, 1.38 * 1.38 - 1e-12).expect("a coating");
        assert!((outer - 0.25).abs() < 1e-5 && inner < 1e-5, "{outer} {inner}");
        // Two layers of low index have no solution on such glass.
        assert_eq!(waves(1.2, 1.3, 1.9), None);
    }
}
