//! The stages of the light path. A stage is immutable while light is traced, and never knows which
//! concrete stage comes before or after it.
//!
//! Weights: forward, a ray carries flux in W m^-2 mm^2 (radiance in W m^-2 sr^-1 times areas in mm^2),
//! so that flux over the pixel's area in mm^2 is irradiance in W m^-2. Backward, it carries
//! throughput, and ends as irradiance in W m^-2 once the radiance is multiplied in. Both are divided
//! by the probability with which wavelength and places were drawn.

use crate::RayBatch;
use crate::cover::CoverStack;
use crate::frame::{DisplayPicture, ExposureFrame, FrameSize, RawFrame};
use crate::isa::Isa;
use crate::params::Faults;
use crate::spectral::{Channel, SpectralPower, SystemResponse};

/// What is emitted. It can emit rays, answer for the radiance along them, or both.
pub trait Source: Send + Sync {
    /// Reads what is large, once, before any light is traced: what a check of the scene can do without. Until then a source
    /// may stand in for itself, such as a white card for a picture.
    ///
    /// # Errors
    /// What is wrong with the files, with the places of the keys that name them.
    fn prepare(&self) -> Result<(), Faults> {
        Ok(())
    }

    /// Light that goes into the lens, summed over the source, in any scale: what the wavelength
    /// sampler weighs. Its lines are those that [`RayBatch::lines`] numbers.
    fn spectrum(&self) -> &SpectralPower;

    /// Peak over mean brightness: keeps highlights inside of the range of the exact sums.
    fn peak_over_mean(&self) -> f64 {
        1.0
    }

    /// Distance from the first vertex, mm, for messages and focus; infinity is allowed.
    fn distance_mm(&self) -> f64;

    /// The forward ability.
    fn emit(&self) -> Option<&dyn Emit> {
        None
    }

    /// The backward ability.
    fn radiance(&self) -> Option<&dyn Radiance> {
        None
    }

    /// What a person wants to know of it, for the log and the EXR.
    fn describe(&self) -> String;
}

/// Emits rays.
pub trait Emit: Send + Sync {
    /// Writes where each ray starts (mm, frame of the lens), and multiplies its weight by what is
    /// emitted there at its wavelength over the density with which the place was drawn: radiance
    /// times area (W m^-2 sr^-1 nm^-1 mm^2, without the nm^-1 on a line), or a point's intensity
    /// (W sr^-1 nm^-1) times 1e6. `u` and `v` are the numbers to draw with, one a ray.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa);

    /// Whether [`Emit::place`] writes the directions too, as of a beam: then rays are not aimed at the lens, and their
    /// weight is spectral flux times 1e6 (W nm^-1, W on a line).
    fn is_directed(&self) -> bool {
        false
    }

    /// With the directions now set: multiplies the weight by the emission toward it relative to
    /// that of [`Emit::place`], the cosine of an emitting plane included.
    fn radiate(&self, rays: &mut RayBatch, isa: Isa);
}

/// Answers for the light along rays.
pub trait Radiance: Send + Sync {
    /// Multiplies the weight of each living ray, which travels from the lens toward the object (its
    /// position in the frame of the lens), by the radiance that comes against it: W m^-2 sr^-1 nm^-1,
    /// or W m^-2 sr^-1 where the wavelength is a line's.
    fn radiance(&self, rays: &mut RayBatch, isa: Isa);
}

/// From a color to a spectrum.
pub trait ColorModel: Send + Sync {
    /// The lines in it, nm; a ray on line `i` of the model is evaluated there only.
    fn lines_nm(&self) -> &[f64];

    /// What [`ColorModel::evaluate`] needs of one color, given in linear light, sRGB primaries.
    fn coefficients(&self, linear_srgb: [f64; 3]) -> [f32; 3];

    /// The spectrum of one color: (1, 1, 1) is white; any common scale.
    fn spectrum(&self, linear_srgb: [f64; 3]) -> SpectralPower;

    /// Multiplies each weight by the spectrum of its color: per nm, or a line's power for a ray on a line.
    fn evaluate(&self, coefficients: &[[f32; 3]], wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]);
}

/// How wavelengths are drawn.
pub trait WavelengthSampler: Send + Sync {
    /// Fits the strategy to the system.
    ///
    /// # Errors
    /// A text that says why this strategy cannot sample this system without bias.
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String>;
}

/// A strategy fitted to a system.
pub trait WavelengthDensity: Send + Sync {
    /// Draws one wavelength a number of `u` in [0, 1): writes the wavelength (nm) and the line (or
    /// [`crate::batch::CONTINUUM`]), and multiplies the weight by one over the density (nm) or one
    /// over the line's probability.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa);

    /// Probability density of drawing from the continuum at a wavelength, 1/nm.
    fn density_per_nm(&self, wavelength_nm: f64) -> f64;

    /// Probability of drawing line `i` of the source.
    fn line_probability(&self, line: usize) -> f64;

    /// How many samples in a row share one number, rotated among them (see
    /// [`crate::numbers::Numbers::fill_rotated`]); 1 where each has its own.
    fn group(&self) -> u32 {
        1
    }
}

/// The imager: which pixel, which channel.
pub trait Imager: Send + Sync {
    /// Its size.
    fn size(&self) -> FrameSize;

    /// The channels it records by itself; `None` where a film lies on it and decides.
    fn channels(&self) -> Option<Vec<Channel>>;

    /// The forward ability.
    fn receive(&self) -> Option<&dyn Receive> {
        None
    }

    /// The backward ability.
    fn launch(&self) -> Option<&dyn Launch> {
        None
    }

    /// The plates that stand right before it, if there are any. A camera puts its frame where they put the image: the lens
    /// is focused through them, and the nominal image plane (z = 0) stands as much farther back.
    fn cover(&self) -> Option<CoverStack> {
        None
    }

    /// A picture of what it recorded by itself; `None` where a film makes it.
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture>;

    /// Exposure time, s, where the imager states one.
    fn exposure_time_s(&self) -> Option<f64> {
        None
    }

    /// Whether it has a converter: [`Imager::raw`] gives something.
    fn has_converter(&self) -> bool {
        false
    }

    /// What its converter gives, of an imager that has one.
    fn raw(&self, _exposure: &ExposureFrame) -> Option<RawFrame> {
        None
    }

    /// From now on it is the imager of this frame of an animation: its noise is another one than that of other frames, by
    /// its own seed and the number ([`crate::numbers::seed_of_frame`]), whichever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}
}

/// What a detector sees of the light that falls on it, and the picture that it makes of that: the part of an imager that
/// knows no geometry.
pub trait Response: Send + Sync {
    /// Its channels, for an irradiance: an imager with an exposure time records the product with the seconds.
    fn channels(&self) -> Vec<Channel>;

    /// A picture of what these channels recorded; `None` where there is none.
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture>;
}

impl<R: Response + ?Sized> Response for Box<R> {
    fn channels(&self) -> Vec<Channel> {
        (**self).channels()
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        (**self).display(exposure)
    }
}

/// Receives rays.
pub trait Receive: Send + Sync {
    /// Moves the living rays (frame: the nominal image plane is z = 0) onto the imager and writes the
    /// pixel into the tag (with one channel, where the light adds to no other: [`crate::batch::tag_of`]); rays beside
    /// the frame end as [`crate::Loss::OutOfFrame`].
    fn receive(&self, rays: &mut RayBatch, isa: Isa);
}

/// Launches rays.
pub trait Launch: Send + Sync {
    /// For the pixel in each ray's tag and (`u`, `v`) in [0, 1)^2 of it, writes the point (mm; nominal
    /// image plane z = 0), and the imager's unit normal (toward the lens) in place of the direction.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa);

    /// With the directions now set (toward the lens; positions anywhere along the rays): what stands before the pixels
    /// does to each ray. It may move a ray aside by less than what its pupil would notice, change its weight, end it, and
    /// name the one channel that it adds to ([`crate::batch::tag_of`]).
    fn admit(&self, _rays: &mut RayBatch, _isa: Isa) {}
}

/// The film: which light it sees, and what becomes of it.
pub trait Film: Send + Sync {
    /// Its channels: responses per spectral irradiance, in lux (times seconds of exposure).
    fn channels(&self) -> Vec<Channel>;

    /// How many of its channels, the first ones, the picture is made of; those behind them only tell the camera something,
    /// as a light meter does.
    fn picture_channels(&self) -> usize {
        self.channels().len()
    }

    /// Exposure time that the light is recorded for, s.
    fn exposure_time_s(&self) -> f64;

    /// Exposure time that the film is developed as having had, s: what the camera's meter chose, where one meters the frame;
    /// else the time that it was recorded for.
    fn metered_time_s(&self, _exposure: &ExposureFrame) -> f64 {
        self.exposure_time_s()
    }

    /// Whether a meter in the camera chooses the exposure time, by the frame.
    fn is_metered(&self) -> bool {
        false
    }

    /// What a person should know before believing the picture: what was stated and has no effect, and so on.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// What it is called, in a few words.
    fn name(&self) -> String {
        self.describe()
    }

    /// Develops the frame into a picture. Its exposure, in lx s per channel, is that of [`Film::exposure_time_s`]: what a
    /// meter makes of it is the film's own business.
    ///
    /// # Errors
    /// A text that says which channel is missing.
    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, String>;

    /// From now on it is the piece of film of this frame of an animation: its grains are others than those of other
    /// frames, by its own seed and the number ([`crate::numbers::seed_of_frame`]), whichever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}

    /// What a person wants to know of it, for the log and the EXR.
    fn describe(&self) -> String;
}
