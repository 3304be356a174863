//! The strategies to compare and their parameters.

use crate::BenchError;
use spectra_core::registry::{Entry, Stage};
use spectra_core::spectral::{BAND, SystemResponse};
use spectra_core::stage::WavelengthSampler;
use spectra_scene::{Scene, yaml};

/// A wavelength strategy: a `kind` of the `wavelengths` section, and its other keys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strategy {
    /// Registered name of the strategy.
    pub kind: String,
    /// The other keys, written as between the braces of a YAML map. `None` takes the keys of the scene if it uses this strategy,
    /// otherwise the defaults.
    pub keys: Option<String>,
}

impl Strategy {
    /// Label of the strategy in tables: its kind and its keys.
    #[must_use]
    pub fn label(&self) -> String {
        match &self.keys {
            Some(keys) => format!("{} {{{keys}}}", self.kind),
            None => self.kind.clone(),
        }
    }
}

/// Name of the strategy that draws one Gaussian term of every factor. It cannot be used in a scene, whose strategies must draw a
/// wavelength.
pub(crate) const EVERY_FACTOR: &str = "one-term-of-every-factor";

impl Strategy {
    /// Whether this strategy draws one term of every factor.
    pub(crate) fn is_every_factor(&self) -> bool {
        self.kind == EVERY_FACTOR
    }

    /// Returns the number of terms for each factor: its key `terms`, or 6 by default.
    pub(crate) fn terms(&self) -> Result<usize, BenchError> {
        let Some(keys) = &self.keys else { return Ok(6) };
        let terms = keys.strip_prefix("terms").map(str::trim_start).and_then(|rest| rest.strip_prefix(':'));
        let terms = terms.and_then(|text| text.trim().parse().ok()).filter(|terms| (1..=32).contains(terms));
        let wrong = || {
            BenchError::Strategy(format!(
                "`{}`: its only key is `terms`, 1 to 32: {EVERY_FACTOR}{{terms: 6}}",
                self.label()
            ))
        };
        terms.ok_or_else(wrong)
    }
}

/// Parses strategies separated by commas: `uniform, truncated-gaussian{center: 550, sigma: 60}`.
///
/// # Errors
/// [`BenchError::Strategy`]: unbalanced braces, a name that is not registered, or a strategy that appears twice.
pub fn parse_list(text: &str) -> Result<Vec<Strategy>, BenchError> {
    let names: Vec<&str> = registered().into_iter().chain([EVERY_FACTOR]).collect();
    let mut found: Vec<Strategy> = Vec::new();
    for part in split(text)? {
        let (kind, keys) = match part.split_once('{') {
            Some((kind, keys)) => {
                let keys = keys
                    .trim_end()
                    .strip_suffix('}')
                    .ok_or_else(|| BenchError::Strategy(format!("`{part}`: write NAME, or NAME{{key: value, ...}}")))?;
                (kind.trim(), Some(keys.trim()).filter(|k| !k.is_empty()))
            }
            None => (part.trim(), None),
        };
        if !names.contains(&kind) {
            let hint = spectra_core::names::hint(kind, &names, "spectra list wavelengths");
            return Err(BenchError::Strategy(format!("unknown strategy `{kind}`; {hint}")));
        }
        let strategy = Strategy { kind: kind.to_owned(), keys: keys.map(str::to_owned) };
        if found.contains(&strategy) {
            return Err(BenchError::Strategy(format!("`{}` appears twice", strategy.label())));
        }
        found.push(strategy);
    }
    Ok(found)
}

/// Splits at the commas outside braces, brackets and quotes.
fn split(text: &str) -> Result<Vec<&str>, BenchError> {
    let (mut parts, mut depth, mut quote, mut from) = (Vec::new(), 0_i32, None, 0);
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (Some(q), _) if c == q => quote = None,
            (Some(_), _) => {}
            (None, '"') => quote = Some(c),
            (None, '{' | '[') => depth += 1,
            (None, '}' | ']') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(&text[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    if depth != 0 || quote.is_some() {
        return Err(BenchError::Strategy(format!("`{text}`: a brace or a quote is not closed")));
    }
    parts.push(&text[from..]);
    Ok(parts)
}

/// Returns the names of all registered strategies, sorted.
fn registered() -> Vec<&'static str> {
    let mut names: Vec<&str> = entries().iter().map(|e| e.name).collect();
    names.sort_unstable();
    names
}

fn entries() -> Vec<&'static Entry<dyn WavelengthSampler>> {
    <dyn WavelengthSampler as Stage>::entries()
}

/// Returns the default strategy of a scene.
fn usual() -> Option<&'static str> {
    entries().iter().find(|e| e.default).map(|e| e.name)
}

/// Returns all registered strategies, the default first.
pub(crate) fn all() -> Vec<Strategy> {
    let mut names = registered();
    names.sort_by_key(|n| Some(*n) != usual());
    // Put it last: it is used only if nothing in the scene depends on the wavelength.
    names.push(EVERY_FACTOR);
    names.into_iter().map(|kind| Strategy { kind: kind.to_owned(), keys: None }).collect()
}

/// Values of the scene file, with `overrides` applied.
pub(crate) struct SceneDefaults {
    /// Strategy of the scene.
    kind: Option<String>,
    /// Spectrum of the source.
    light: Option<String>,
}

impl SceneDefaults {
    pub(crate) fn by(scene: &Scene, overrides: &[String]) -> Result<Self, BenchError> {
        let mut root = yaml::parse_bytes(&scene.name, scene.text.as_bytes())?;
        for text in overrides {
            yaml::parse_override(text)?.apply(&mut root).map_err(spectra_core::params::Faults::from)?;
        }
        let text = |path: &str| root.at_path(path).and_then(|node| node.as_str()).map(str::to_owned);
        Ok(Self {
            kind: text("wavelengths.kind").or_else(|| usual().map(str::to_owned)),
            light: text("source.illuminant").or_else(|| text("source.spectrum")),
        })
    }
}

/// Returns the strategy with the keys that it needs, and the override that puts it into the scene. The override is `None` for the
/// scene's own strategy.
pub(crate) fn resolve(
    strategy: &Strategy,
    said: &SceneDefaults,
    scene: &Scene,
    system: &SystemResponse,
) -> (Strategy, Option<String>) {
    if strategy.keys.is_none() && said.kind.as_deref() == Some(&strategy.kind) {
        return (strategy.clone(), None);
    }
    let keys = strategy.keys.clone().or_else(|| needed(&strategy.kind, said, system));
    let grid = scene.grid;
    let mut map = format!("kind: {}", strategy.kind);
    if grid != BAND {
        map.push_str(&format!(", band: [{} nm, {} nm]", grid.start_nm, grid.end_nm()));
    }
    if let Some(keys) = &keys {
        map.push_str(&format!(", {keys}"));
    }
    (Strategy { kind: strategy.kind.clone(), keys }, Some(format!("wavelengths={{{map}}}")))
}

/// Returns keys that a strategy requires, derived from the light and the channels of the scene.
fn needed(kind: &str, said: &SceneDefaults, system: &SystemResponse) -> Option<String> {
    match kind {
        // Use the mean and standard deviation of the light that the channels see.
        "truncated-gaussian" => {
            let (center_nm, sigma_nm) = moments(system)?;
            Some(format!("center: {center_nm:.0} nm, sigma: {:.0} nm", sigma_nm.max(1.0)))
        }
        // Draw in proportion to the source alone.
        "inverse-transform" => {
            let light = said.light.as_deref().unwrap_or("D65");
            Some(format!("spectrum: \"{}\"", light.replace(['"', '\\'], "")))
        }
        _ => None,
    }
}

/// Returns the mean and the standard deviation, in nm, of the wavelength of the light that all channels see together.
fn moments(system: &SystemResponse) -> Option<(f64, f64)> {
    let seen = system.summed_response();
    let weighted = |f: &dyn Fn(f64) -> f64| {
        let response: Vec<f64> = seen.iter().zip(system.grid.wavelengths_nm()).map(|(r, nm)| r * f(nm)).collect();
        system.source.seen_by(&response)
    };
    let total = weighted(&|_| 1.0);
    let mean = weighted(&|nm| nm) / total;
    let variance = weighted(&|nm| (nm - mean) * (nm - mean)) / total;
    (total > 0.0).then(|| (mean, variance.max(0.0).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::{Channel, SpectralPower};
    use spectra_plugins as _;

    #[test]
    fn lists_are_split_outside_of_braces() {
        let list = parse_list("uniform, truncated-gaussian{center: 550, sigma: 60},stratified{}").unwrap();
        let labels: Vec<String> = list.iter().map(Strategy::label).collect();
        assert_eq!(labels, ["uniform", "truncated-gaussian {center: 550, sigma: 60}", "stratified"]);
        for bad in ["uniform,uniform", "unifrom", "uniform{a: 1", "uniform}", "", "uniform{a: 1}b"] {
            assert!(parse_list(bad).is_err(), "{bad}");
        }
        assert!(parse_list("unifrom").unwrap_err().to_string().contains("did you mean `uniform`"));
    }

    #[test]
    fn the_usual_strategy_comes_first() {
        let all = all();
        assert_eq!(Some(all[0].kind.as_str()), usual());
        assert!(all.len() >= 2);
    }

    /// A constant light seen by a triangle from 400 nm to 600 nm: mean 500 nm, and the variance of a symmetric triangle, h^2/6.
    #[test]
    fn moments_of_a_triangle() {
        let response: Vec<f64> = BAND.wavelengths_nm().map(|w| (1.0 - (w - 500.0).abs() / 100.0).max(0.0)).collect();
        let source = SpectralPower { grid: BAND, continuum: vec![1.0; BAND.count], lines: Vec::new() };
        let channels = vec![Channel { name: "t".into(), unit: "1".into(), response }].into();
        let (mean, sigma) = moments(&SystemResponse { grid: BAND, source, channels }).unwrap();
        // Allow for the second moment, which is integrated linearly between nanometers: an error of 1/6 nm^2.
        assert!((mean - 500.0).abs() < 1e-9 && (sigma - (1e4 / 6.0_f64).sqrt()).abs() < 0.01, "{mean} {sigma}");
    }
}
