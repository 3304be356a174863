//! Lobes: how far and in which direction light is scattered.
//!
//! A lobe is a distribution of steps of the direction cosines along the surface, each multiplied by the index of refraction: the quantity
//! that refraction conserves. Steps depend neither on the direction nor on the place, and a step and its opposite are equally likely. So
//! the etendue is kept, and light of either direction of travel keeps its weight (J. E. Harvey, "Light-scattering characteristics of
//! optical surfaces", thesis, University of Arizona, 1976).

use spectra_core::math::{exp, j0, j1, log, pow, sin_cos_turns};
use std::f64::consts::PI;
use std::sync::Arc;

/// The distribution of the steps by which a layer scatters light.
#[derive(Clone, Debug, PartialEq)]
pub enum Lobe {
    /// Harvey and Shack's three-parameter function: proportional to (1 + (step / shoulder)^2)^(slope / 2), for steps up to 1.
    /// A slope of -3 is the Henyey-Greenstein function (Astrophys. J. 93, 70 (1941)) with shoulder = (1 - g) / sqrt(g).
    Harvey {
        /// Step at which the function begins to fall steeply.
        shoulder: f64,
        /// Exponent of the function at large steps, negative.
        slope: f64,
    },
    /// Diffraction by opaque disks. By Babinet's principle it is the pattern of round openings (G. B. Airy, Trans. Cambridge
    /// Phil. Soc. 5, 283 (1835)).
    Disks {
        /// Median of the diameters, weighted by area, nm.
        diameter_nm: f64,
        /// Standard deviation of the logarithm of the diameter.
        spread: f64,
        /// Diffraction pattern of one disk.
        pattern: Pattern,
    },
    /// Diffraction by opaque lines: the pattern of slits, in the direction across each line.
    Lines {
        /// Width of the lines, nm.
        width_nm: f64,
        /// Direction in which the lines run.
        run: Run,
        /// Diffraction pattern of one line.
        pattern: Pattern,
    },
}

/// The direction in which lines on a surface run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Run {
    /// All directions are equally likely.
    Any,
    /// The lines run around the axis, as left by a turning cloth.
    Around,
    /// All lines run along this unit vector (x, y).
    Along([f64; 2]),
}

impl Lobe {
    /// Creates a lobe of disks with this median diameter, nm. `spread` is the standard deviation of the logarithm of the diameter.
    #[must_use]
    pub fn disks(diameter_nm: f64, spread: f64) -> Self {
        Self::Disks { diameter_nm, spread, pattern: Pattern::disk() }
    }

    /// Creates a lobe of lines with this width, nm.
    #[must_use]
    pub fn lines(width_nm: f64, run: Run) -> Self {
        Self::Lines { width_nm, run, pattern: Pattern::slit() }
    }

    /// Draws a step of the direction cosines along x and y of the surface, multiplied by the index. The four numbers in [0, 1)
    /// are random, and the last argument is the point of the surface (mm).
    #[must_use]
    pub fn step(&self, [u, v]: [f64; 2], [a, b]: [f64; 2], wavelength_nm: f64, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = sin_cos_turns(v);
        match self {
            Self::Harvey { shoulder, slope } => {
                let far = harvey_step(*shoulder, *slope, u);
                [far * cos, far * sin]
            }
            Self::Disks { diameter_nm, spread, pattern } => {
                let normal = (-2.0 * log(1.0 - a)).sqrt() * sin_cos_turns(b).1;
                let far = pattern.quantile(u) * wavelength_nm / (PI * diameter_nm * exp(spread * normal));
                [far * cos, far * sin]
            }
            Self::Lines { width_nm, run, pattern } => {
                let far = pattern.quantile(u) * wavelength_nm / (PI * width_nm);
                let far = if v < 0.5 { -far } else { far };
                let [across_x, across_y] = match run {
                    Run::Any => {
                        let (sin, cos) = sin_cos_turns(a);
                        [cos, sin]
                    }
                    Run::Along([along_x, along_y]) => [-along_y, *along_x],
                    Run::Around => {
                        let r = (x * x + y * y).sqrt();
                        if r > 0.0 { [x / r, y / r] } else { [1.0, 0.0] }
                    }
                };
                [far * across_x, far * across_y]
            }
        }
    }
}

/// Returns the step below which a fraction `u` of Harvey and Shack's function lies.
fn harvey_step(shoulder: f64, slope: f64, u: f64) -> f64 {
    // Up to a factor, the integral over a disk is ((1 + (step / shoulder)^2)^power - 1) / power; a logarithm where power is 0.
    let (power, most) = (1.0 + 0.5 * slope, log(1.0 + 1.0 / (shoulder * shoulder)));
    let grown = if power.abs() < 1e-9 { exp(u * most) } else { pow(1.0 + u * (exp(power * most) - 1.0), 1.0 / power) };
    shoulder * (grown - 1.0).max(0.0).sqrt()
}

/// A cumulative diffraction pattern: the fraction of light at scaled steps below x = pi times size times step over wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Fractions at 0, [`CELL`], 2 [`CELL`] ... [`END`], with linear interpolation between them.
    within: Arc<[f64]>,
    /// Beyond the end the fraction within x is 1 - tail / x. Fringes, which no film resolves there, are left out.
    tail: f64,
}

const CELL: f64 = 0.02;
const CELLS: usize = 6000;
const END: f64 = CELL * CELLS as f64;

impl Pattern {
    /// Tabulates the pattern of a round opening: 1 - J0^2 - J1^2 (Lord Rayleigh, Phil. Mag. 11, 214 (1881)).
    #[must_use]
    pub fn disk() -> Self {
        let within = |k: usize| {
            let x = CELL * k as f64;
            1.0 - j0(x) * j0(x) - j1(x) * j1(x)
        };
        Self { within: (0..=CELLS).map(within).collect(), tail: 2.0 / PI }
    }

    /// Tabulates the pattern of a slit: the integral of (sin x / x)^2, by Simpson's rule within each cell.
    #[must_use]
    pub fn slit() -> Self {
        let density = |x: f64| {
            let sinc = if x == 0.0 { 1.0 } else { spectra_core::math::sin(x) / x };
            sinc * sinc * 2.0 / PI
        };
        let mut sum = 0.0;
        let mut within = vec![0.0];
        for k in 0..CELLS {
            let x = CELL * k as f64;
            sum += CELL / 6.0 * (density(x) + 4.0 * density(x + 0.5 * CELL) + density(x + CELL));
            within.push(sum);
        }
        Self { within: within.into(), tail: 1.0 / PI }
    }

    /// Returns the fraction of light at scaled steps below `x`.
    #[must_use]
    pub fn within(&self, x: f64) -> f64 {
        if x >= END {
            return 1.0 - self.outside_end() * END / x;
        }
        let at = x.max(0.0) / CELL;
        let cell = (at as usize).min(CELLS - 1);
        self.within[cell] + (at - cell as f64) * (self.within[cell + 1] - self.within[cell])
    }

    /// Returns the scaled step below which the fraction `part` of the light lies.
    #[must_use]
    pub fn quantile(&self, part: f64) -> f64 {
        if part >= self.within[CELLS] {
            return END * self.outside_end() / (1.0 - part);
        }
        let cell = self.within.partition_point(|w| *w <= part).clamp(1, CELLS) - 1;
        let (low, high) = (self.within[cell], self.within[cell + 1]);
        CELL * (cell as f64 + if high > low { (part - low) / (high - low) } else { 0.0 })
    }

    fn outside_end(&self) -> f64 {
        1.0 - self.within[CELLS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rings of the Airy pattern contain 83.8, 91.0 and 93.8 % of the light (Born and Wolf, "Principles of Optics", table 8.2 and
    /// 8.5.2), the middle of a slit's pattern 90.28 %. A quantile is the inverse of the fraction within; the tails match the closed forms.
    #[test]
    fn patterns_hold_what_tables_say() {
        let (disk, slit) = (Pattern::disk(), Pattern::slit());
        for (x, part) in [(3.831_706, 0.837_785), (7.015_587, 0.909_92), (10.173_468, 0.937_6)] {
            assert!((disk.within(x) - part).abs() < 5e-5, "{x}: {}", disk.within(x));
        }
        assert!((slit.within(PI) - 0.902_823).abs() < 5e-6, "{}", slit.within(PI));
        for pattern in [&disk, &slit] {
            for x in [0.3, 2.0, 9.1, 77.7, 119.9, 130.0, 4000.0] {
                assert!((pattern.quantile(pattern.within(x)) / x - 1.0).abs() < 2e-3, "{x}");
            }
            let outside = 1.0 - pattern.within(END);
            assert!((outside * END / pattern.tail - 1.0).abs() < 0.02, "{outside}");
        }
    }

    /// The fraction of steps within a radius matches the closed form, for slopes on both sides of -2 and at -2.
    #[test]
    fn harvey_steps_follow_the_closed_form() {
        let shoulder: f64 = 0.02;
        for slope in [-1.3, -2.0, -3.0] {
            let density = |r: f64| (1.0 + (r / shoulder) * (r / shoulder)).powf(0.5 * slope) * r;
            let sum = |to: f64| {
                let n = 200_000;
                (0..n).map(|k| density((f64::from(k) + 0.5) / f64::from(n) * to)).sum::<f64>() * to / f64::from(n)
            };
            let all = sum(1.0);
            for u in [0.01, 0.2, 0.5, 0.9, 0.999] {
                let r = harvey_step(shoulder, slope, u);
                assert!((sum(r) / all - u).abs() < 1e-6, "{slope} {u}");
            }
            assert!(harvey_step(shoulder, slope, 1.0) < 1.0 + 1e-9);
        }
    }

    /// The Henyey-Greenstein function of the angle at normal incidence, where a step is the chord 2 sin(angle / 2).
    #[test]
    fn a_slope_of_three_is_henyey_and_greenstein() {
        let g: f64 = 0.97;
        let shoulder = (1.0 - g) / g.sqrt();
        let henyey = |chord: f64| (1.0 + g * g - 2.0 * g * (1.0 - 0.5 * chord * chord)).powf(-1.5);
        let harvey = |step: f64| (1.0 + (step / shoulder) * (step / shoulder)).powf(-1.5);
        for step in [0.001, 0.03, 0.4] {
            assert!((henyey(step) / henyey(0.0) / harvey(step) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn lines_scatter_across_themselves() {
        let at = [3.0, 4.0];
        let step = |run| Lobe::lines(5000.0, run).step([0.7, 0.9], [0.1, 0.2], 500.0, at);
        let [x, y] = step(Run::Along([1.0, 0.0]));
        assert!(x == 0.0 && y > 0.0);
        let [x, y] = step(Run::Around);
        assert!((x * 4.0 - y * 3.0).abs() < 1e-12 && x > 0.0);
    }
}
