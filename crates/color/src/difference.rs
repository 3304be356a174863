//! CIEDE2000, the CIE formula for the perceived difference of two colors.

use std::f64::consts::PI;

/// Computes the CIEDE2000 difference of two colors in CIE Lab, with all parametric factors 1.
///
/// M. R. Luo, G. Cui, B. Rigg, Color Res. Appl. 26, 340 (2001). Hue arithmetic follows G. Sharma, W. Wu, E. N. Dalal, "The CIEDE2000
/// color-difference formula: implementation notes", Color Res. Appl. 30, 21 (2005).
#[must_use]
pub fn ciede2000(first: [f64; 3], second: [f64; 3]) -> f64 {
    let chroma = |a: f64, b: f64| (a * a + b * b).sqrt();
    let mean_ab = 0.5 * (chroma(first[1], first[2]) + chroma(second[1], second[2]));
    let g = 0.5 * (1.0 - seventh(mean_ab));
    let prime = |lab: [f64; 3]| {
        let a = (1.0 + g) * lab[1];
        let hue = if a == 0.0 && lab[2] == 0.0 { 0.0 } else { libm::atan2(lab[2], a) };
        (chroma(a, lab[2]), if hue < 0.0 { hue + 2.0 * PI } else { hue })
    };
    let ((c1, h1), (c2, h2)) = (prime(first), prime(second));
    let colorless = c1 * c2 == 0.0;

    let turn = h2 - h1;
    let hue_step = match turn {
        _ if colorless => 0.0,
        t if t > PI => t - 2.0 * PI,
        t if t < -PI => t + 2.0 * PI,
        t => t,
    };
    let (dl, dc) = (second[0] - first[0], c2 - c1);
    let dh = 2.0 * (c1 * c2).sqrt() * libm::sin(0.5 * hue_step);

    let (l, c) = (0.5 * (first[0] + second[0]), 0.5 * (c1 + c2));
    let sum = h1 + h2;
    let h = match turn.abs() {
        _ if colorless => sum,
        t if t <= PI => 0.5 * sum,
        _ if sum < 2.0 * PI => 0.5 * sum + PI,
        _ => 0.5 * sum - PI,
    };
    let degrees = PI / 180.0;
    let t = 1.0 - 0.17 * libm::cos(h - 30.0 * degrees)
        + 0.24 * libm::cos(2.0 * h)
        + 0.32 * libm::cos(3.0 * h + 6.0 * degrees)
        - 0.20 * libm::cos(4.0 * h - 63.0 * degrees);
    let blue = (h / degrees - 275.0) / 25.0;
    let rotation = -2.0 * seventh(c) * libm::sin(60.0 * degrees * libm::exp(-blue * blue));
    let light = (l - 50.0) * (l - 50.0);
    let sl = 1.0 + 0.015 * light / (20.0 + light).sqrt();
    let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let (dl, dc, dh) = (dl / sl, dc / sc, dh / sh);
    // The quadratic form is never negative, but rounding can take it slightly below 0.
    (dl * dl + dc * dc + dh * dh + rotation * dc * dh).max(0.0).sqrt()
}

/// Returns sqrt(c^7 / (c^7 + 25^7)).
fn seventh(c: f64) -> f64 {
    let c7 = c * c * c * c * c * c * c;
    (c7 / (c7 + 6_103_515_625.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares all 34 pairs of Sharma, Wu and Dalal (2005), table 1, to the four decimals printed.
    #[test]
    fn sharma_pairs() {
        let rows = include_str!("../tests/data/ciede2000-sharma.csv").lines().filter(|l| !l.starts_with(['#', 'L']));
        let mut count = 0;
        for row in rows {
            let v: Vec<f64> = row.split(',').map(|f| f.parse().expect("a number")).collect();
            let (a, b) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
            for got in [ciede2000(a, b), ciede2000(b, a)] {
                assert!((got - v[6]).abs() <= 5.0001e-5, "{row}: {got}");
            }
            count += 1;
        }
        assert_eq!(count, 34);
    }

    #[test]
    fn equal_colors_do_not_differ() {
        for lab in [[50.0, 2.5, 0.0], [0.0; 3], [100.0, -80.0, 30.0]] {
            assert_eq!(ciede2000(lab, lab), 0.0);
        }
        // Black to white differ in L alone, and S_L is 1 at the mean of 50.
        assert!((ciede2000([0.0; 3], [100.0, 0.0, 0.0]) - 100.0).abs() < 1e-12);
    }
}
