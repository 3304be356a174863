//! The development of a stock: one of its file, or a push or pull of it.

use crate::effects::Assumed;
use crate::settings::StockParams;
use spectra_core::names;
use spectra_core::params::{Faults, Params};
use spectra_film::emulsion::Emulsion;
use spectra_film::push::{PushError, pushed_or_assumed};
use spectra_film::stock::Stock;

/// Returns the emulsion with the curves of the chosen development or push, and the development in words.
pub(crate) fn develop_as(p: &StockParams, params: &Params, stock: &Stock) -> Result<(Emulsion, String), Faults> {
    let known: Vec<&str> = stock.developments().collect();
    let chosen = p.development.as_deref().or(known.first().copied()).unwrap_or_default();
    if !known.contains(&chosen) {
        let text = format!("{} has no curve for the development `{chosen}`", stock.name);
        return Err(params.fault("development", text).hint(names::hint(chosen, &known, "")).into());
    }
    let Some(stops) = p.push else {
        let emulsion = Emulsion::new(stock, chosen).map_err(|e| params.fault("stock", e.to_string()))?;
        return Ok((emulsion, chosen.to_owned()));
    };
    let developed = pushed_or_assumed(stock, chosen, stops).map_err(|e| {
        let other = "set another `iso` to expose the same film differently";
        let hint = match &e {
            PushError::Beyond { .. } | PushError::BeyondAssumed { .. } => format!("write a smaller `push`, or {other}"),
            _ => format!("leave `push` out, or {other}"),
        };
        params.fault("push", e.to_string()).hint(hint)
    })?;
    let emulsion = Emulsion::with_curves(stock, developed.curves).map_err(|e| params.fault("push", e.to_string()))?;
    if developed.minutes.is_none() && p.assumed == Assumed::Off {
        let text = format!("the effect of a push on {} is assumed, and `assumed: off` excludes that", stock.name);
        return Err(params.fault("push", text).hint("leave out one of the two").into());
    }
    let how = match developed.minutes {
        Some(minutes) => format!("{minutes:.1} min (pushed {stops:+} stops)"),
        None => format!("{chosen} (pushed {stops:+} stops, assumed: the median of other films)"),
    };
    Ok((emulsion, how))
}
