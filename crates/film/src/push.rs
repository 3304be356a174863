//! Push and pull development: interpolates between the curves of a sheet, or, if the sheet has only one, assumes the behavior of other
//! films.

use crate::curve::{CharacteristicCurve, CurveError, TabulatedCurve};
use crate::print::metered_exposure_lx_s;
use crate::stock::{Development, Layer, Process, Stock};
use spectra_core::math::{log, log10, pow};

/// A film that cannot be pushed as requested.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PushError {
    /// A film without a speed, for example a print stock.
    #[error("{stock} is not a camera film: it has no speed from which to push it")]
    NoCameraFilm {
        /// Name of the stock.
        stock: String,
    },
    /// The curve does not reach a mid gray at this push.
    #[error("{stock}: a mid gray {stops:+} stops from its speed lies outside its curve")]
    NoGray {
        /// Name of the stock.
        stock: String,
        /// Requested push, stops.
        stops: f64,
    },
    /// A push beyond the range that is assumed from other films.
    #[error(
        "{stock} has only one development time; a push can be assumed from -{MOST_ASSUMED} to +{MOST_ASSUMED} stops, not {stops:+}"
    )]
    BeyondAssumed {
        /// Name of the stock.
        stock: String,
        /// Requested push, stops.
        stops: f64,
    },
    /// A push beyond the longest or the shortest development time.
    #[error("the development times of {stock} reach from {fewest:+} to {most:+} stops, not {stops:+}")]
    Beyond {
        /// Name of the stock.
        stock: String,
        /// Requested push, stops.
        stops: f64,
        /// Push at the shortest time (negative for a pull), to a tenth of a stop.
        fewest: f64,
        /// Push at the longest time, to a tenth of a stop.
        most: f64,
    },
    /// The interpolated curve is not valid.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

/// A pushed or pulled development.
#[derive(Clone, Debug, PartialEq)]
pub struct Pushed {
    /// Development time, min; `None` if the curves are assumed.
    pub minutes: Option<f64>,
    /// Characteristic curve of each layer.
    pub curves: Vec<CharacteristicCurve>,
}

/// Number of intervals at which curves are sampled.
const POINTS: usize = 256;

/// Largest push or pull, in stops, of a film without a series of development times.
pub const MOST_ASSUMED: f64 = 2.0;
/// Factor by which each stop of push raises the contrast (ISO 6's average gradient), and each stop of pull lowers it. It is the
/// median over the development times in the series of Tri-X and Double-X.
pub const CONTRAST_PER_STOP: f64 = 1.24;
/// Fog density added by each stop of push: the median of the same films. A pull leaves the fog unchanged.
pub const FOG_PER_STOP: f64 = 0.036;

/// Pushes by `stops` from the development `usual`, as [`pushed`] does if the sheet has a series of development times. If the
/// sheet has only one, scales densities above base and fog by [`CONTRAST_PER_STOP`]. Then shifts the curves until a mid gray
/// metered at the pushed speed has its usual density above fog.
///
/// For a reversal film, the scaled densities are those of its first developer: what the positive lacks of its maximum density.
/// Its mid gray keeps the density of the positive.
///
/// # Errors
/// [`PushError`].
pub fn pushed_or_assumed(stock: &Stock, usual: &str, stops: f64) -> Result<Pushed, PushError> {
    match stock.layers.as_slice() {
        [layer] if series(layer).len() > 1 && layer.development(usual).is_some_and(|d| d.minutes.is_some()) => {
            pushed(stock, usual, stops)
        }
        _ => assumed(stock, usual, stops),
    }
}

fn assumed(stock: &Stock, usual: &str, stops: f64) -> Result<Pushed, PushError> {
    let name = || stock.name.clone();
    let iso = stock
        .iso
        .filter(|_| stock.process != Process::Print)
        .ok_or_else(|| PushError::NoCameraFilm { stock: name() })?;
    if !(stops.abs() <= MOST_ASSUMED) {
        return Err(PushError::BeyondAssumed { stock: name(), stops });
    }
    let gray = log10(metered_exposure_lx_s(iso));
    let (contrast, fog) = (pow(CONTRAST_PER_STOP, stops), FOG_PER_STOP * stops.max(0.0));
    let each = stock.layers.iter().map(|layer| {
        let curve = &layer
            .development(usual)
            .or(layer.developments.first())
            .ok_or_else(|| PushError::NoCameraFilm { stock: name() })?
            .curve;
        let (least, most) = curve.density_range();
        let is_reversal = stock.process == Process::Reversal;
        // Density from the first developer, above its density without light.
        let silver =
            |x: f64| if is_reversal { most - curve.density(x) } else { curve.density(x) - curve.unexposed_density() };
        // A negative's mid gray keeps its density above fog; a slide's mid gray keeps its density.
        let kept = silver(gray) - if is_reversal { fog } else { 0.0 };
        let metered = gray - stops * log10(2.0);
        let (mut left, mut right) = (metered - 4.0, metered + 4.0);
        if contrast * silver(left) > kept || contrast * silver(right) < kept {
            return Err(PushError::NoGray { stock: name(), stops });
        }
        while right - left > 1e-12 {
            let middle = 0.5 * (left + right);
            if contrast * silver(middle) > kept { right = middle } else { left = middle }
        }
        let moved = 0.5 * (left + right) - metered;
        let density = |x: f64| match is_reversal {
            true => (most - fog - contrast * silver(x + moved)).max(least),
            false => (curve.unexposed_density() + fog + contrast * silver(x + moved)).min(10.0),
        };
        let (low, high) = curve.exposure_range();
        let at = |i: usize| low - moved + (high - low) * i as f64 / POINTS as f64;
        let points: Vec<[f64; 2]> = (0..=POINTS).map(|i| [at(i), density(at(i))]).collect();
        Ok(TabulatedCurve::new(&points)?.into())
    });
    Ok(Pushed { minutes: None, curves: each.collect::<Result<_, _>>()? })
}

/// Pushes by `stops` (pulls, if negative) from the stock's development named `usual`.
///
/// Metering at 2^stops times the speed gives a mid gray less exposure. The result is the development time at which this gray
/// still gets its usual density above base and fog. Between two times of the sheet, densities are interpolated linearly in the
/// logarithm of the time.
///
/// # Errors
/// [`PushError`].
pub fn pushed(stock: &Stock, usual: &str, stops: f64) -> Result<Pushed, PushError> {
    let none = || PushError::NoCameraFilm { stock: stock.name.clone() };
    let iso = stock.iso.ok_or_else(none)?;
    let [layer] = &stock.layers[..] else { return Err(none()) };
    let usual = layer.development(usual).ok_or_else(none)?;
    let series = series(layer);
    let start = usual.minutes.filter(|_| series.len() > 1).ok_or_else(none)?;
    let gray = log10(metered_exposure_lx_s(iso));
    let over = |d: f64, fog: f64| d - fog;
    let wanted = over(usual.curve.density(gray), usual.curve.unexposed_density());
    // Push of a development time in stops: how much less exposure gives the wanted density.
    let reach = |minutes: f64| -> Option<f64> {
        let at = |x: f64| over(density(&series, minutes, x), density(&series, minutes, f64::NEG_INFINITY)) - wanted;
        let (mut left, mut right) = (gray - 3.0, gray + 3.0);
        if at(left) > 0.0 || at(right) < 0.0 {
            return None;
        }
        while right - left > 1e-12 {
            let middle = 0.5 * (left + right);
            if at(middle) > 0.0 { right = middle } else { left = middle }
        }
        Some((gray - right) / log10(2.0))
    };
    let (shortest, longest) = (series[0].0, series[series.len() - 1].0);
    let (fewest, most) = (reach(shortest).unwrap_or(0.0), reach(longest).unwrap_or(0.0));
    let (mut left, mut right) = (shortest, longest);
    if stops == 0.0 {
        (left, right) = (start, start);
    } else if !(stops >= fewest.min(tenths(fewest)) && stops <= most.max(tenths(most))) {
        // The range is reported to a tenth of a stop, and every reported value can be requested: it is limited to the longest time.
        return Err(PushError::Beyond { stock: stock.name.clone(), stops, fewest: tenths(fewest), most: tenths(most) });
    }
    while right - left > 1e-9 {
        let middle = 0.5 * (left + right);
        if reach(middle).is_some_and(|r| r > stops) { right = middle } else { left = middle }
    }
    let minutes = 0.5 * (left + right);
    let low = series.iter().map(|(_, d)| d.curve.exposure_range().0).fold(f64::INFINITY, f64::min);
    let high = series.iter().map(|(_, d)| d.curve.exposure_range().1).fold(f64::NEG_INFINITY, f64::max);
    let points: Vec<[f64; 2]> = (0..=POINTS)
        .map(|i| low + (high - low) * i as f64 / POINTS as f64)
        .map(|x| [x, density(&series, minutes, x)])
        .collect();
    Ok(Pushed { minutes: Some(minutes), curves: vec![TabulatedCurve::new(&points)?.into()] })
}

/// Rounds to a tenth; never -0.
fn tenths(stops: f64) -> f64 {
    (stops * 10.0).round() / 10.0 + 0.0
}

/// Developments of known time, shortest first.
fn series(layer: &Layer) -> Vec<(f64, &Development)> {
    let mut all: Vec<(f64, &Development)> =
        layer.developments.iter().filter_map(|d| d.minutes.map(|m| (m, d))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Density after any time, at log10 of an exposure (lx s).
fn density(series: &[(f64, &Development)], minutes: f64, log10_exposure: f64) -> f64 {
    let i = series.partition_point(|s| s.0 <= minutes).clamp(1, series.len() - 1);
    let ((t0, a), (t1, b)) = (series[i - 1], series[i]);
    let part = log(minutes / t0) / log(t1 / t0);
    let (a, b) = (a.curve.density(log10_exposure), b.curve.density(log10_exposure));
    a + (b - a) * part
}
