//! A strategy whose samples have no wavelength: one Gaussian term of every factor.
//!
//! The exposure of a pixel is the integral over wavelength of the source's light times the response of the film, into which filters are
//! folded. Each of these two factors is a sum of signed Gaussian terms and of a remainder that the fit leaves over. A sample draws one term
//! or remainder of each factor in proportion to the size of its own integral. The integral of the product of the two is known exactly, so
//! that the estimate is unbiased and nothing is evaluated at a wavelength.
//!
//! The strategy requires that nothing on the way depends on the wavelength: no glass, no coating, and one spectrum for the whole source.
//! Rays must still carry some wavelength. All get the one at which source times film is largest, and a weight that turns source times film
//! there into the integral.

use crate::BenchError;
use crate::strategy::EVERY_FACTOR;
use spectra_core::Isa;
use spectra_core::batch::CONTINUUM;
use spectra_core::spectral::{Grid, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_core::surface::Action;
use spectra_lens::Coating;
use spectra_scene::Scene;
use spectra_spectrum::{GaussianMixture, Outside, Scale, SpectralFunction, Tabulated, fit_gaussians};
use std::sync::Arc;

/// The strategy fitted to a system.
#[derive(Clone, Debug)]
pub(crate) struct EveryFactor {
    wavelength_nm: f64,
    /// Source times film at this wavelength.
    seen_there: f64,
    /// Cumulative probabilities of the source's terms and of the film's, which divide [0, 1). The last one may be that of the remainder.
    upper: [Vec<f64>; 2],
    /// Integral of the product of each pair of terms divided by its probability, ordered by the source's term first.
    values: Vec<f64>,
    probabilities: Vec<f64>,
}

/// A factor as Gaussian terms and a remainder.
struct Factor {
    mixture: GaussianMixture,
    shape: SpectralFunction,
    /// Probabilities of the terms, and of the remainder if there is one.
    shares: Vec<f64>,
    has_rest: bool,
}

impl Factor {
    fn new(grid: &Grid, values: &[f64], terms: usize) -> Result<Self, String> {
        let fit = fit_gaussians(grid, values, terms).map_err(|e| format!("no terms fit: {e}"))?;
        let (min_nm, max_nm) = (grid.start_nm, grid.end_nm());
        let mixture = fit.mixture;
        let left: Vec<f64> = grid.wavelengths_nm().zip(values).map(|(w, v)| (v - mixture.at(w)).abs()).collect();
        let mut shares: Vec<f64> = mixture.terms().iter().map(|t| t.band_integral(min_nm, max_nm).abs()).collect();
        let (sum, rest) = (shares.iter().sum::<f64>(), grid.integrate(&left));
        // A smaller remainder is rounding, and would be drawn too rarely to be useful.
        let has_rest = rest > 1e-9 * sum;
        if has_rest {
            shares.push(rest);
        }
        let all: f64 = shares.iter().sum();
        if !(all > 0.0 && all.is_finite()) {
            return Err("no Gaussian term reaches the band".to_owned());
        }
        shares.iter_mut().for_each(|share| *share /= all);
        let wavelengths: Vec<f64> = grid.wavelengths_nm().collect();
        let table = Tabulated::new(&wavelengths, values, Outside::Zero, Scale::Linear).map_err(|e| e.to_string())?;
        Ok(Self { mixture, shape: SpectralFunction::tabulated(table), shares, has_rest })
    }

    fn upper(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let rising = self.shares.iter().map(|share| {
            sum += share;
            sum
        });
        rising.collect()
    }
}

impl EveryFactor {
    /// Fits `terms` Gaussians to the source, and as many to the single channel.
    ///
    /// # Errors
    /// Message why the strategy cannot sample the system.
    pub(crate) fn new(system: &SystemResponse, terms: usize) -> Result<Self, String> {
        let [channel] = &system.channels[..] else {
            let count = system.channels.len();
            return Err(format!("a sample is one number for one channel, but the scene records {count} channels"));
        };
        if !system.source.lines.is_empty() {
            return Err("the source has spectral lines, which are not Gaussian terms".to_owned());
        }
        let grid = system.grid;
        let source = Factor::new(&grid, &system.source.continuum, terms).map_err(|e| format!("the source: {e}"))?;
        let film = Factor::new(&grid, &channel.response, terms).map_err(|e| format!("the film: {e}"))?;
        let (min_nm, max_nm) = (grid.start_nm, grid.end_nm());
        let all = system.source.seen_by(&channel.response);
        let by_film: Vec<f64> = (source.mixture.terms().iter())
            .map(|t| {
                film.shape
                    .times(&SpectralFunction::mixture(GaussianMixture::new(vec![*t])))
                    .integral(min_nm, max_nm, 1.0)
            })
            .collect();
        let by_source: Vec<f64> = (film.mixture.terms().iter())
            .map(|t| {
                source
                    .shape
                    .times(&SpectralFunction::mixture(GaussianMixture::new(vec![*t])))
                    .integral(min_nm, max_nm, 1.0)
            })
            .collect();
        // The integral with a remainder is the whole integral minus the integrals with the terms.
        let mut integrals = Vec::new();
        let mut column_sums = vec![0.0; film.shares.len()];
        for (i, a) in source.mixture.terms().iter().enumerate() {
            let mut row: Vec<f64> =
                film.mixture.terms().iter().map(|b| a.times(b).band_integral(min_nm, max_nm)).collect();
            if film.has_rest {
                row.push(by_film[i] - row.iter().sum::<f64>());
            }
            column_sums.iter_mut().zip(&row).for_each(|(sum, value)| *sum += value);
            integrals.extend(row);
        }
        if source.has_rest {
            let mut row: Vec<f64> = by_source.iter().zip(&column_sums).map(|(whole, terms)| whole - terms).collect();
            if film.has_rest {
                let so_far = integrals.iter().sum::<f64>() + row.iter().sum::<f64>();
                row.push(all - so_far);
            }
            integrals.extend(row);
        }
        // Rescale to the integral of the scene. A scene stores spectra as tables with straight lines between points. The integral of a
        // product of two Gaussians then differs from the exact one by about h^2 / 6 / (s^2 + t^2). Here h is the distance of the points,
        // and s and t are the standard deviations.
        let of_terms = integrals.iter().sum::<f64>();
        if of_terms > 0.0 {
            integrals.iter_mut().for_each(|value| *value *= all / of_terms);
        }
        let pairs = source.shares.iter().flat_map(|a| film.shares.iter().map(move |b| a * b));
        let probabilities: Vec<f64> = pairs.collect();
        let values = integrals.iter().zip(&probabilities).map(|(w, p)| if *p > 0.0 { w / p } else { 0.0 }).collect();
        let seen = |i: usize| system.source.continuum[i] * channel.response[i];
        let there = (0..grid.count).max_by(|a, b| seen(*a).total_cmp(&seen(*b))).unwrap_or(0);
        if !(seen(there) > 0.0) {
            return Err("the film is not sensitive to any light of the source".to_owned());
        }
        Ok(Self {
            wavelength_nm: grid.wavelength_nm(there),
            seen_there: seen(there),
            upper: [source.upper(), film.upper()],
            values,
            probabilities,
        })
    }

    /// Mean and standard deviation of one sample of the spectral integral, over all choices.
    pub(crate) fn moments(&self) -> (f64, f64) {
        let with = || self.values.iter().zip(&self.probabilities);
        let mean: f64 = with().map(|(v, p)| p * v).sum();
        let second: f64 = with().map(|(v, p)| p * v * v).sum();
        (mean, (second - mean * mean).max(0.0).sqrt())
    }
}

impl WavelengthDensity for EveryFactor {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], _isa: Isa) {
        let [source, film] = &self.upper;
        let pick = |upper: &[f64], u: f64| {
            let at = upper.partition_point(|end| *end <= u).min(upper.len() - 1);
            let from = if at == 0 { 0.0 } else { upper[at - 1] };
            (at, ((u - from) / (upper[at] - from)).clamp(0.0, 1.0))
        };
        for (((u, nm), line), weight) in u.iter().zip(wavelength_nm).zip(line).zip(weight) {
            // One random number serves both: its position within the first part chooses the second.
            let (i, rest) = pick(source, *u);
            let (j, _) = pick(film, rest);
            (*nm, *line) = (self.wavelength_nm, CONTINUUM);
            *weight *= self.values[i * film.len() + j] / self.seen_there;
        }
    }

    /// Density of wavelengths: always 0, because none is drawn.
    fn density_per_nm(&self, _wavelength_nm: f64) -> f64 {
        0.0
    }

    fn line_probability(&self, _line: usize) -> f64 {
        0.0
    }
}

/// A probe that sends every ray at one wavelength, with the weight that makes source times film 1 there.
struct Probe {
    wavelength_nm: f64,
    weight: f64,
}

impl WavelengthSampler for Probe {
    fn prepare(&self, _system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, spectra_core::params::Fault> {
        Ok(Box::new(Self { ..*self }))
    }
}

impl WavelengthDensity for Probe {
    fn draw(&self, _u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], _isa: Isa) {
        wavelength_nm.fill(self.wavelength_nm);
        line.fill(CONTINUUM);
        weight.iter_mut().for_each(|weight| *weight *= self.weight);
    }

    fn density_per_nm(&self, _wavelength_nm: f64) -> f64 {
        0.0
    }

    fn line_probability(&self, _line: usize) -> f64 {
        0.0
    }
}

/// Number of samples per pixel of a probe.
const PROBE_SAMPLES: u32 = 4;
/// Largest difference of two probes, relative to the largest exposure: many times what the rounding of sums leaves.
const SAME: f64 = 1e-4;

/// Returns what depends on the wavelength between source and film, if anything does. Effects of the lens are named. Otherwise the scene is
/// traced at single wavelengths, which must all give the same picture.
///
/// # Errors
/// [`BenchError::Render`] if the scene cannot be traced.
pub(crate) fn needs_wavelength(
    scene: &Scene,
    system: &SystemResponse,
    threads: usize,
    isa: Isa,
) -> Result<Option<String>, BenchError> {
    if let Some(reason) = of_lens(scene) {
        return Ok(Some(reason));
    }
    let grid = system.grid;
    let response = &system.channels[0].response;
    let seen = |i: usize| system.source.continuum[i] * response[i];
    let most = (0..grid.count).map(seen).fold(0.0, f64::max);
    let bright: Vec<usize> = (0..grid.count).filter(|i| seen(*i) > 0.02 * most).collect();
    let (Some(first), Some(last)) = (bright.first(), bright.last()) else { return Ok(None) };
    let mut before: Option<(f64, Vec<f32>)> = None;
    for at in [*first, bright[bright.len() / 2], *last] {
        let wavelength_nm = grid.wavelength_nm(at);
        let mut scene = scene.clone();
        scene.sampler = Arc::new(Probe { wavelength_nm, weight: 1.0 / seen(at) });
        let seed = std::iter::once(1);
        let probes = crate::frame::renders(&mut scene, EVERY_FACTOR, PROBE_SAMPLES, seed, threads, isa)?;
        let Some(values) = probes.first().map(|(frame, _)| frame.channels[0].values.clone()) else { return Ok(None) };
        if let Some((nm, other)) = &before {
            let largest = other.iter().copied().fold(0.0_f32, f32::max);
            let apart = values.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            if f64::from(apart) > SAME * f64::from(largest) {
                return Ok(Some(format!(
                    "the picture at {nm} nm differs from that at {wavelength_nm} nm: the colors of the source, \
                     or something in front of the film, depend on the wavelength"
                )));
            }
        } else {
            before = Some((wavelength_nm, values));
        }
    }
    Ok(None)
}

/// Describes the first surface of the lens that refracts or attenuates light depending on its wavelength.
fn of_lens(scene: &Scene) -> Option<String> {
    let lens = &scene.lens;
    let (from, to) = (scene.grid.start_nm, scene.grid.end_nm());
    for (i, element) in lens.elements.iter().enumerate() {
        let (before, after) = (element.medium_before, element.medium_after);
        let ratio = |nm: f64| lens.index(after, nm) / lens.index(before, nm);
        if element.action == Action::Refract && before != after && (ratio(from) - ratio(to)).abs() > 1e-12 {
            let glass = &lens.media[if lens.media[after].label == "air" { before } else { after }].label;
            return Some(format!(
                "surface {} ({}) of {} refracts at {glass}, whose index depends on the wavelength",
                i + 1,
                element.kind,
                lens.name
            ));
        }
        let coating = element.coating.as_ref().unwrap_or(&lens.coating);
        if element.action != Action::Pass && before != after && !matches!(coating, Coating::Ideal) {
            return Some(format!("the coating of surface {} of {} depends on the wavelength", i + 1, lens.name));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::spectral::{BAND, Channel};
    use spectra_spectrum::{find_emission, find_sensitivity};

    fn system(light: &str, film: &str) -> SystemResponse {
        let response = find_sensitivity(film).expect("bundled").on_grid(&BAND);
        let channels = vec![Channel { name: "film".into(), unit: "1".into(), response }].into();
        SystemResponse { grid: BAND, source: find_emission(light).expect("bundled").to_power(&BAND), channels }
    }

    /// The remainders of the fits are included: the mean is the integral, and the scatter is that over all choices.
    #[test]
    fn the_mean_is_the_integral_and_the_scatter_as_computed() {
        for (light, film) in [("D65", "ilford-ortho-plus"), ("A", "v-lambda-1924"), ("FL2", "ilford-ortho-plus")] {
            let system = system(light, film);
            let strategy = EveryFactor::new(&system, 4).expect("terms");
            let exact = system.source.seen_by(&system.channels[0].response);
            let (mean, deviation) = strategy.moments();
            assert!((mean / exact - 1.0).abs() < 1e-12, "{light}: {mean} {exact}");
            // Use equidistant numbers, so that sums are integrals over them.
            let count = 1 << 18;
            let u: Vec<f64> = (0..count).map(|i| (f64::from(i) + 0.5) / f64::from(count)).collect();
            let (mut nm, mut line, mut weight) = (vec![0.0; u.len()], vec![0; u.len()], vec![1.0; u.len()]);
            strategy.draw(&u, &mut nm, &mut line, &mut weight, Isa::Baseline);
            let there = BAND.interpolate(&system.source.continuum, nm[0])
                * BAND.interpolate(&system.channels[0].response, nm[0]);
            let drawn = weight.iter().map(|w| w * there).sum::<f64>() / f64::from(count);
            let second = weight.iter().map(|w| w * there * w * there).sum::<f64>() / f64::from(count);
            assert!((drawn / exact - 1.0).abs() < 1e-3, "{light}: {drawn} {exact}");
            let scatter = (second - drawn * drawn).sqrt();
            assert!((scatter / deviation - 1.0).abs() < 5e-3, "{light}: {scatter} {deviation}");
            println!("{light} on {film}: {:.3}", deviation / exact);
        }
    }

    #[test]
    fn lines_and_several_channels_are_refused() {
        assert!(EveryFactor::new(&system("mercury", "ilford-ortho-plus"), 6).expect_err("lines").contains("lines"));
        let mut three = system("D65", "ilford-ortho-plus");
        three.channels = vec![three.channels[0].clone(); 3].into();
        assert!(EveryFactor::new(&three, 6).expect_err("three").contains("records 3"));
    }
}
