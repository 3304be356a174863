//! Reciprocity failure: the loss of speed at long exposures.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{exp, log, pow};
use spectra_core::params::{Fault, Params, Positive, Time};

/// Reciprocity failure, stated by two exposure times. An exposure of the time Ta has the effect that the metered time Tm would
/// have without the failure.
#[derive(Clone, Debug, PartialEq)]
pub enum Reciprocity {
    /// A power law: Ta = Tm^exponent, in units of the threshold (K. Schwarzschild, 1900).
    PowerLaw {
        /// Exponent, at least 1.
        exponent: f64,
        /// Threshold, s: shorter times count in full.
        above_s: f64,
    },
    /// The table of the sheet. Linear between rows in the logarithms of both times, and beyond the last row.
    Table {
        /// Threshold, s: shorter times count in full.
        above_s: f64,
        /// Rows (Tm, Ta) in s, both ascending, with Tm above the threshold and Ta at least Tm.
        rows: Vec<[f64; 2]>,
    },
}

impl Reciprocity {
    /// Longest time that counts in full, s.
    #[must_use]
    pub fn above_s(&self) -> f64 {
        match self {
            Self::PowerLaw { above_s, .. } | Self::Table { above_s, .. } => *above_s,
        }
    }

    /// Returns the fraction of an exposure of `time_s` that takes effect, relative to a short exposure with as many lx s. This is
    /// Tm / Ta at Ta = `time_s`: 1 up to the threshold, less beyond.
    #[must_use]
    pub fn effect(&self, time_s: f64) -> f64 {
        if !(time_s > self.above_s()) {
            return 1.0;
        }
        match self {
            Self::PowerLaw { exponent, above_s } => pow(time_s / above_s, 1.0 / exponent - 1.0),
            Self::Table { above_s, rows } => {
                let start = [log(*above_s); 2];
                let points: Vec<[f64; 2]> =
                    std::iter::once(start).chain(rows.iter().map(|r| [log(r[0]), log(r[1])])).collect();
                let ta = log(time_s);
                // The segment that contains the time, or the last one.
                let i = points.partition_point(|p| p[1] <= ta).clamp(1, points.len() - 1);
                let (a, b) = (points[i - 1], points[i]);
                let tm = a[0] + (b[0] - a[0]) * (ta - a[1]) / (b[1] - a[1]);
                exp(tm - ta)
            }
        }
    }
}

/// Longest exposure (s) that needs no warning if a film's sheet states no reciprocity: makers allow at least this much.
const UNDOUBTED_S: f64 = 1.0;

/// Returns a warning for an exposure of `time_s` if the file of the stock `name` has no reciprocity and the time is longer than 1 s.
#[must_use]
pub fn unknown(reciprocity: Option<&Reciprocity>, name: &str, time_s: f64) -> Option<String> {
    (reciprocity.is_none() && time_s > UNDOUBTED_S).then(|| {
        format!(
            "reciprocity of {name} is not known: {} counts in full, though most films lose speed beyond 1 s",
            spectra_core::shutter::format_time(time_s)
        )
    })
}

/// Loss of speed at long exposures: a power law, or a table.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ReciprocityFile {
    /// Exponent p of the law, adjusted time = above x (metered time / above)^p, 1 to 10. Or else `table`.
    #[schemars(range(min = 1, max = 10))]
    exponent: Option<f64>,
    /// Rows of metered and adjusted time, in s, ascending. Or else `exponent`.
    table: Option<Vec<[f64; 2]>>,
    /// Metered time above which speed is lost, s if bare.
    above: Positive<Time>,
}

impl ReciprocityFile {
    pub(super) fn read(&self, params: &Params) -> Result<Reciprocity, Fault> {
        let above_s = self.above.s();
        match (self.exponent, &self.table) {
            (Some(exponent), None) => Ok(Reciprocity::PowerLaw { exponent, above_s }),
            (None, Some(rows)) => {
                let mut before = [above_s; 2];
                for (i, row) in rows.iter().enumerate() {
                    let sound = row.iter().all(|t| t.is_finite()) && row[0] > before[0] && row[1] > before[1];
                    if !sound || row[1] < row[0] {
                        let text = "metered and adjusted times must increase, and the adjusted time must be at least the metered one";
                        let fault = params.fault(&format!("reciprocity.table[{i}]"), text);
                        return Err(fault.hint(format!("[metered, adjusted] in seconds, above {above_s} s")));
                    }
                    before = *row;
                }
                if rows.is_empty() {
                    return Err(params.fault("reciprocity.table", "the table has no rows"));
                }
                Ok(Reciprocity::Table { above_s, rows: rows.clone() })
            }
            _ => {
                let fault = params.fault("reciprocity", "give either an `exponent` or a `table`");
                Err(fault.hint("`{exponent: 1.25, above: 1 s}` or `{table: [[1, 2], [10, 50]], above: 0.1 s}`"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kodak F-4017: metered 1, 10 and 100 s become 2, 50 and 1200 s.
    #[test]
    fn a_table_gives_back_its_rows() {
        let table = Reciprocity::Table { above_s: 0.1, rows: vec![[1.0, 2.0], [10.0, 50.0], [100.0, 1200.0]] };
        for (tm, ta) in [(1.0, 2.0), (10.0, 50.0), (100.0, 1200.0)] {
            assert!((table.effect(ta) * ta / tm - 1.0).abs() < 1e-12, "{ta}");
        }
        assert_eq!([0.01, 0.1, f64::NAN].map(|t| table.effect(t)), [1.0; 3]);
        let mut before = 1.0;
        for i in 0..400 {
            let effect = table.effect(pow(10.0, -2.0 + f64::from(i) * 0.015));
            assert!(effect <= before + 1e-12 && effect > 0.0, "{i}");
            before = effect;
        }
    }
}
