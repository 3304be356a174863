//! Round tick values along an axis.

/// The tick values of an axis and their number format.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Tick values, in ascending order.
    pub values: Vec<f64>,
    /// Difference between neighboring ticks.
    pub step: f64,
    decimals: usize,
}

/// Returns about `count` round values from `low` to `high`, in steps of 1, 2 or 5 times a power of ten. An empty or infinite range gives
/// none.
#[must_use]
pub fn nice_ticks(low: f64, high: f64, count: usize) -> Ticks {
    let none = Ticks { values: Vec::new(), step: 0.0, decimals: 0 };
    let rough = (high - low) / count.max(1) as f64;
    if !(rough > 0.0 && rough.is_finite()) {
        return none;
    }
    let power = libm::floor(libm::log10(rough));
    let unit = libm::pow(10.0, power);
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * unit >= rough * (1.0 - 1e-9)).unwrap_or(10.0);
    let step = factor * unit;
    let power = if factor == 10.0 { power + 1.0 } else { power };
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let many = (last - first).clamp(0.0, 1000.0) as usize;
    let values = (0..=many).map(|i| (first + i as f64) * step).collect();
    Ticks { values, step, decimals: (-power).clamp(0.0, 12.0) as usize }
}

impl Ticks {
    /// Returns the label of a value, with as many decimals as the step has.
    #[must_use]
    pub fn label(&self, value: f64) -> String {
        let text = format!("{value:.*}", self.decimals);
        let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
        if zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        let labels = |low, high, count| {
            let ticks = nice_ticks(low, high, count);
            ticks.values.iter().map(|v| ticks.label(*v)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(labels(0.0, 1.0, 5), "0.0 0.2 0.4 0.6 0.8 1.0");
        assert_eq!(labels(350.0, 830.0, 10), "350 400 450 500 550 600 650 700 750 800");
        assert_eq!(labels(-0.01, 0.013, 4), "\u{2212}0.01 0.00 0.01");
        assert_eq!(labels(0.0, 90.0, 9), "0 10 20 30 40 50 60 70 80 90");
        assert_eq!(labels(1.0, 1.0, 5), "");
        assert_eq!(labels(0.0, f64::INFINITY, 5), "");
    }
}
