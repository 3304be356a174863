//! What a benchmark gives.

use serde::Serialize;

/// What the error was measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// The exposure of each channel by the spectrum alone; the truth is exact quadrature.
    Integral,
    /// Every pixel of the rendered scene; the truth is a reference render.
    Scene,
}

impl Measure {
    /// Name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Integral => "integral",
            Self::Scene => "scene",
        }
    }
}

/// Which numbers the wavelengths were drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NumberKind {
    /// Owen-scrambled Sobol points. In the one dimension of the wavelength, 2^k of them are 2^k jittered strata.
    Sobol,
    /// A shifted lattice.
    Lattice,
    /// Independent random numbers.
    Random,
    /// Jittered strata, as many as there are samples.
    Stratified,
}

impl NumberKind {
    /// Name in tables and files, as a scene has it.
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

/// A value between the ends of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The value itself.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// How far the mean over seeds is from the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelBias {
    /// Channel.
    pub channel: String,
    /// Mean of the relative error.
    pub relative: f64,
    /// The same in standard errors of that mean (and of the reference, where there is one).
    pub standard_errors: f64,
}

/// One number of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Samples of the integral; of a pixel, in a scene (forward: rays a pixel of the frame).
    pub samples: u32,
    /// Relative RMS error of linear exposure: root of the mean over seeds and channels of the squared error. Of a
    /// scene, the sum over pixels of the squared error is taken relative to the sum of the squared exposure.
    pub error: Interval,
    /// Time that these samples take, s, from [`Series::ns_a_sample`]; of a scene, samples of all pixels.
    pub seconds: f64,
    /// Mean against the truth, each channel; of a scene, of the whole frame's light.
    pub bias: Vec<ChannelBias>,
    /// Mean CIEDE2000 to the truth, over seeds and pixels; where the channels are X, Y, Z. The lightest pixel of the
    /// truth has Y = 100, and the light itself is the white.
    pub ciede2000: Option<f64>,
    /// Each seed by itself: [`crate::seeds_csv`] has them; too many for JSON.
    #[serde(skip)]
    pub by_seed: Vec<OfSeed>,
}

/// What one seed gave.
#[derive(Clone, Debug, PartialEq)]
pub struct OfSeed {
    /// The seed.
    pub seed: u64,
    /// Its relative RMS error over channels, and pixels of a scene.
    pub error: f64,
    /// Relative error of the light of each channel, with its sign, in the order of [`Point::bias`].
    pub relative: Vec<f64>,
}

/// One strategy, measured in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// The strategy, with the parameters that differ from its usual ones.
    pub strategy: String,
    /// What was measured.
    pub measure: Measure,
    /// Numbers that it was measured with.
    pub numbers: NumberKind,
    /// Seeds.
    pub seeds: usize,
    /// Exponent of the error against samples, by least squares in log-log; `None` where less than two errors are
    /// above rounding (1e-12).
    pub slope: Option<Interval>,
    /// Time of one sample, ns: the shortest of all seeds at the largest number of samples, threads together.
    pub ns_a_sample: f64,
    /// Error over that of the first strategy at the same (largest) number of samples.
    pub ratio_at_equal_samples: Option<f64>,
    /// The same at the time that the first strategy takes for it, carried there along this strategy's slope.
    pub ratio_at_equal_time: Option<f64>,
    /// Numbers of samples, rising.
    pub points: Vec<Point>,
}

impl Series {
    /// The largest bias over channels and numbers of samples, in standard errors.
    #[must_use]
    pub fn largest_bias(&self) -> f64 {
        let all = self.points.iter().flat_map(|p| &p.bias);
        all.map(|b| b.standard_errors.abs()).fold(0.0, f64::max)
    }
}

/// What the pixels of a scene are compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Strategy.
    pub strategy: String,
    /// Renders, each of its own seed, whose mean it is.
    pub renders: u32,
    /// Samples of each render.
    pub samples: u32,
    /// Its own relative RMS error, by the scatter of its renders; taken off the squared errors of the strategies.
    pub error: f64,
}

/// A strategy that cannot sample the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// The strategy.
    pub strategy: String,
    /// Why.
    pub reason: String,
}

/// What a benchmark gives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scene.
    pub scene: String,
    /// The seed that all others follow from.
    pub seed: u64,
    /// Its source.
    pub source: String,
    /// Its lens.
    pub lens: String,
    /// What is recorded.
    pub channels: Vec<String>,
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// `forward` or `backward`.
    pub direction: &'static str,
    /// Threads that scenes were rendered on.
    pub threads: usize,
    /// Instruction set.
    pub isa: &'static str,
    /// Where the 95 % intervals come from.
    pub intervals: &'static str,
    /// What the pixels are compared with; `None` where only the integral was measured.
    pub reference: Option<Reference>,
    /// The measurements: by measure and numbers, then in the order of the strategies.
    pub series: Vec<Series>,
    /// Strategies that were not measured.
    pub left_out: Vec<LeftOut>,
}
