//! Results of a benchmark.

use serde::Serialize;

/// The quantity whose error was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Exposure of each channel from the spectrum alone, compared with exact quadrature.
    Integral,
    /// Every pixel of the rendered scene, compared with a reference render.
    Scene,
}

impl Measure {
    /// Name of the measure in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Integral => "integral",
            Self::Scene => "scene",
        }
    }
}

/// Kind of numbers from which the wavelengths were drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NumberKind {
    /// Owen-scrambled Sobol points. In the one dimension of the wavelength, 2^k of them are 2^k jittered strata.
    Sobol,
    /// Points of a shifted lattice.
    Lattice,
    /// Independent random numbers.
    Random,
    /// Jittered strata, one for each sample.
    Stratified,
}

impl NumberKind {
    /// Name of the kind in tables and files, as written in a scene.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::Lattice => "lattice",
            Self::Random => "random",
            Self::Stratified => "stratified",
        }
    }
}

/// A value with the ends of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Bias of one channel: deviation of the mean over seeds from the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelBias {
    /// Name of the channel.
    pub channel: String,
    /// Mean of the relative error over seeds.
    pub relative: f64,
    /// Mean relative error in standard errors of that mean (and of the reference, if there is one).
    pub standard_errors: f64,
}

/// Results for one number of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Number of samples of the integral, or samples per pixel in a scene (forward: rays per pixel of the frame).
    pub samples: u32,
    /// Relative RMS error of linear exposure: root of the mean over seeds and channels of the squared error. For a scene the squared error
    /// summed over pixels is divided by the squared exposure summed over pixels.
    pub error: Interval,
    /// Time for these samples in seconds, computed from [`Series::ns_a_sample`]. For a scene, the time for the samples of all
    /// pixels.
    pub seconds: f64,
    /// Bias of each channel; for a scene, bias of the light of the whole frame.
    pub bias: Vec<ChannelBias>,
    /// Mean CIEDE2000 relative to the truth, over seeds and pixels, if the channels are X, Y, Z. The lightest pixel of the truth has Y =
    /// 100, and the light source is the white.
    pub ciede2000: Option<f64>,
    /// Results of each seed. [`crate::seeds_csv`] writes them; JSON leaves them out because they are too many.
    #[serde(skip)]
    pub by_seed: Vec<OfSeed>,
}

/// Result of a single seed.
#[derive(Clone, Debug, PartialEq)]
pub struct OfSeed {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Relative RMS error of this seed over channels, and over pixels of a scene.
    pub error: f64,
    /// Signed relative error of the light of each channel, in the order of [`Point::bias`].
    pub relative: Vec<f64>,
}

/// Results of one strategy by one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Strategy, with the parameters that differ from the defaults.
    pub strategy: String,
    /// Quantity whose error was measured.
    pub measure: Measure,
    /// Kind of numbers used.
    pub numbers: NumberKind,
    /// Number of seeds.
    pub seeds: usize,
    /// Exponent of the error as a function of samples, fitted by least squares in log-log; `None` if fewer than two errors are above
    /// rounding (1e-12).
    pub slope: Option<Interval>,
    /// Time of one sample, ns: the shortest over all seeds at the largest number of samples, with all threads together.
    pub ns_a_sample: f64,
    /// Error divided by that of the first strategy at the same (largest) number of samples.
    pub ratio_at_equal_samples: Option<f64>,
    /// Error divided by that of the first strategy at equal time, extrapolated along this strategy's slope.
    pub ratio_at_equal_time: Option<f64>,
    /// Results for each number of samples, in ascending order.
    pub points: Vec<Point>,
}

impl Series {
    /// Returns the largest bias over channels and numbers of samples, in standard errors.
    #[must_use]
    pub fn largest_bias(&self) -> f64 {
        let all = self.points.iter().flat_map(|p| &p.bias);
        all.map(|b| b.standard_errors.abs()).fold(0.0, f64::max)
    }
}

/// The reference render that the pixels of a scene are compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Strategy of the reference.
    pub strategy: String,
    /// Number of averaged renders, each with its own seed.
    pub renders: u32,
    /// Number of samples of each render.
    pub samples: u32,
    /// Relative RMS error of the reference itself, from the scatter of its renders. Its square is subtracted from the squared errors of the
    /// strategies.
    pub error: f64,
}

/// A strategy that cannot sample the scene and was skipped.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Name of the strategy.
    pub strategy: String,
    /// Reason why the strategy was skipped.
    pub reason: String,
}

/// Results of a benchmark of one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scene.
    pub scene: String,
    /// Seed from which all others are derived.
    pub seed: u64,
    /// Description of the source.
    pub source: String,
    /// Name of the lens.
    pub lens: String,
    /// Names of the recorded channels.
    pub channels: Vec<String>,
    /// Width of the frame, pixels.
    pub width_px: u32,
    /// Height of the frame, pixels.
    pub height_px: u32,
    /// Direction of rendering: `forward` or `backward`.
    pub direction: &'static str,
    /// Number of threads used for rendering.
    pub threads: usize,
    /// Instruction set used.
    pub isa: &'static str,
    /// Description of how the 95 % intervals were computed.
    pub intervals: &'static str,
    /// Reference of the rendered scene; `None` if only the integral was measured.
    pub reference: Option<Reference>,
    /// Results, ordered by measure and numbers, then in the order of the strategies.
    pub series: Vec<Series>,
    /// Strategies that were skipped.
    pub left_out: Vec<LeftOut>,
}
