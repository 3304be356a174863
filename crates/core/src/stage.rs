//! The stages of the light path. A stage does not change while light is traced, and does not know which concrete stages come
//! before and after it.
//!
//! Weights: forward, a ray carries flux in W m^-2 mm^2 (radiance in W m^-2 sr^-1 times areas in mm^2), so that flux divided by
//! the pixel's area in mm^2 is irradiance in W m^-2. Backward, a ray carries throughput; multiplied by the radiance it becomes
//! irradiance in W m^-2. Both are divided by the probability with which wavelength and positions were drawn.

use crate::RayBatch;
use crate::cover::CoverStack;
use crate::frame::{DisplayPicture, ExposureFrame, Finished, FrameSize, ImageState, RawFrame, Wanted};
use crate::isa::Isa;
use crate::params::{Faults, Warning};
use crate::spectral::{Channel, SpectralPower, SystemResponse};
use std::any::Any;
use std::sync::Arc;

/// A light source. It can emit rays, return the radiance along given rays, or both.
pub trait Source: Send + Sync {
    /// Loads large files, once, before any light is traced. Checking a scene does not need this; until it is called, a source may
    /// use a placeholder, such as a white card for a picture.
    ///
    /// # Errors
    /// What is wrong with the files, placed at the keys that name them.
    fn prepare(&self) -> Result<(), Faults> {
        Ok(())
    }

    /// What is doubtful in its large files, once they are read.
    fn doubts(&self) -> &[Warning] {
        &[]
    }

    /// Light that enters the lens, summed over the source, in any scale; the wavelength sampler uses it as a weight.
    /// [`RayBatch::lines`] numbers its lines.
    fn spectrum(&self) -> &SpectralPower;

    /// Light that a lens is focused in: the same before [`Source::prepare`] as after it, or a picture would depend on what else was
    /// rendered before it.
    fn focus_light(&self) -> &SpectralPower {
        self.spectrum()
    }

    /// The light that what is white in it sends, in any scale: what color film may be balanced for. Known before [`Source::prepare`].
    fn white(&self) -> &SpectralPower {
        self.focus_light()
    }

    /// Peak brightness divided by mean brightness; used to keep highlights within the range of the exact sums.
    fn peak_over_mean(&self) -> f64 {
        1.0
    }

    /// Distance from the first vertex, mm, for messages and focusing; may be infinite.
    fn distance_mm(&self) -> f64;

    /// The source as an emitter of rays (forward), if it can be one.
    fn emit(&self) -> Option<&dyn Emit> {
        None
    }

    /// The radiance of the source along rays (backward), if it can return it.
    fn radiance(&self) -> Option<&dyn Radiance> {
        None
    }

    /// The source as two, where part of it is much brighter than the rest; `None` where nothing is. Which light belongs to which
    /// must not depend on what is rendered.
    fn split(&self) -> Option<Split<'_>> {
        None
    }

    /// The source as a flat picture whose pixels are known, to expose a film to it without a lens; reads its files. `None` where
    /// it is none.
    fn still(&self) -> Option<Result<Still, Faults>> {
        None
    }

    /// Of a picture: what `response` (a channel's, on the grid of the scene) sees of its mid gray, 18 % of white, over what it sees of
    /// the picture in the mean. `None` of what has no white, and before [`Source::prepare`].
    fn gray_over_mean(&self, _response: &[f64]) -> Option<f64> {
        None
    }

    /// Whether it is a picture that was exposed already, as files of integers are: 18 % of its white is to be a mid gray.
    fn is_exposed(&self) -> bool {
        false
    }

    /// What numbers of its files were taken for, in a few words for the summary, such as the unit of a depth; `None` where nothing is to
    /// be said.
    fn meaning(&self) -> Option<String> {
        None
    }

    /// Facts about the source that are worth reporting, for the log and the EXR.
    fn describe(&self) -> String;
}

/// A flat picture, pixel by pixel. A pixel's radiance, W m^-2 sr^-1 nm^-1, is `scale` times the spectrum that `model` gives its
/// color.
pub struct Still {
    /// Pixels across.
    pub width_px: u32,
    /// Pixels down.
    pub height_px: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Linear light in sRGB primaries, 0 or more; row by row from the top of the upright picture.
    pub rgb: Vec<[f32; 3]>,
    /// How a color becomes a spectrum.
    pub model: Arc<dyn ColorModel>,
    /// Radiance per unit of the model's spectra.
    pub scale: f64,
}

/// A source as two whose radiances along any ray add up to that of the whole: each is rendered from the side that finds it.
#[derive(Clone, Copy)]
pub struct Split<'a> {
    /// What is bright, as an emitter: it is rendered forward.
    pub lights: &'a dyn Source,
    /// All else, which is asked for radiance: it is rendered backward.
    pub rest: &'a dyn Source,
    /// Whether this is expected to give less noise in the same time than asking the whole source for radiance.
    pub pays: bool,
}

/// Emits rays.
pub trait Emit: Send + Sync {
    /// Writes where each ray starts (mm, frame of the lens), and multiplies its weight by what is emitted there at its
    /// wavelength, divided by the density with which the position was drawn: radiance times area (W m^-2 sr^-1 nm^-1 mm^2,
    /// without the nm^-1 on a line), or a point's intensity (W sr^-1 nm^-1) times 1e6. `u` and `v` are the random numbers to use,
    /// one per ray.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa);

    /// Half the width and height of the spots that all of its light comes from, mm across the axis, where it is made of such: each fades from
    /// its middle along both sides as a straight line, and a ray from the middle carries what one from anywhere in the spot does.
    fn spots_mm(&self) -> Option<[f64; 2]> {
        None
    }

    /// As [`Emit::place`], with each ray in the middle of a spot, for which it stands: for sources that have [`Emit::spots_mm`].
    fn place_in_middle(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa) {
        self.place(rays, u, v, isa);
    }

    /// Whether [`Emit::place`] also writes the directions, as for a beam. Such rays are not aimed at the lens, and their weight
    /// is spectral flux times 1e6 (W nm^-1, W on a line).
    fn is_directed(&self) -> bool {
        false
    }

    /// Called once the directions are set: multiplies the weight by the emission in that direction relative to that of
    /// [`Emit::place`], including the cosine for an emitting plane.
    fn radiate(&self, rays: &mut RayBatch, isa: Isa);

    /// Whether it draws numbers beyond `u` and `v` ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// Returns the light along rays.
pub trait Radiance: Send + Sync {
    /// Multiplies the weight of each living ray by the radiance that arrives along it. The ray travels from the lens toward the
    /// object, its position in the frame of the lens. Radiance is in W m^-2 sr^-1 nm^-1, or in W m^-2 sr^-1 if the wavelength is
    /// that of a line.
    fn radiance(&self, rays: &mut RayBatch, isa: Isa);

    /// Whether it draws numbers from the rays ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// The colors of which a color model makes spectra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorGamut {
    /// Those of sRGB: no value of linear sRGB is negative.
    Srgb,
    /// All that light can have, but for the last 0.001 in xy before the spectral locus and the line of purples.
    Real,
}

/// Turns a color into a spectrum.
pub trait ColorModel: Send + Sync {
    /// The colors that it is made for. Others are moved toward white, luminance kept, before it is asked.
    fn gamut(&self) -> ColorGamut {
        ColorGamut::Srgb
    }

    /// The spectral lines of the model, nm; for a ray on line `i`, only that line is evaluated.
    fn lines_nm(&self) -> &[f64];

    /// What [`ColorModel::evaluate`] needs to know of one color, which is given in linear light with sRGB primaries.
    fn coefficients(&self, linear_srgb: [f64; 3]) -> [f32; 3];

    /// The spectrum of one color, in any common scale; (1, 1, 1) is white.
    fn spectrum(&self, linear_srgb: [f64; 3]) -> SpectralPower;

    /// Multiplies each weight by the spectrum of its color: per nm, or by a line's power for a ray on a line.
    fn evaluate(&self, coefficients: &[[f32; 3]], wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]);
}

/// How wavelengths are drawn.
pub trait WavelengthSampler: Send + Sync {
    /// Fits the strategy to a system.
    ///
    /// # Errors
    /// The reason why this strategy cannot sample this system without bias.
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String>;
}

/// A strategy fitted to a system.
pub trait WavelengthDensity: Send + Sync {
    /// Draws one wavelength for each number of `u` in [0, 1): writes the wavelength (nm) and the line (or
    /// [`crate::batch::CONTINUUM`]), and multiplies the weight by one over the density (nm) or one over the line's probability.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa);

    /// Probability density of drawing a wavelength from the continuum, 1/nm.
    fn density_per_nm(&self, wavelength_nm: f64) -> f64;

    /// Probability of drawing line `i` of the source.
    fn line_probability(&self, line: usize) -> f64;

    /// How many consecutive samples share one number, rotated among them (see [`crate::numbers::Numbers::fill_rotated`]); 1 if
    /// each has its own.
    fn group(&self) -> u32 {
        1
    }
}

/// The imager: it determines the pixel and the channel.
pub trait Imager: Send + Sync {
    /// Its size.
    fn size(&self) -> FrameSize;

    /// What it makes of light by itself; `None` if that is up to a film on it.
    fn response(&self) -> Option<&dyn Response>;

    /// The imager as a receiver of rays (forward), if it can be one.
    fn receive(&self) -> Option<&dyn Receive> {
        None
    }

    /// The imager as a starting point of rays (backward), if it can be one.
    fn launch(&self) -> Option<&dyn Launch> {
        None
    }

    /// The plates directly in front of it, if any. A camera allows for them: the lens is focused through them, and the nominal
    /// image plane (z = 0) lies farther back by as much as they move the image.
    fn cover(&self) -> Option<CoverStack> {
        None
    }

    /// Sets the frame of an animation. Each frame has its own noise, which follows from the imager's seed and the frame's number
    /// ([`crate::numbers::seed_of_frame`]), whichever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}
}

/// How a detector responds to light, and the picture that it makes: the part of an imager that does not depend on geometry.
pub trait Response: Send + Sync {
    /// Its channels, as responses to irradiance, or to irradiance times seconds where it has an exposure time.
    fn channels(&self) -> Vec<Channel>;

    /// Exposure time, s, if it has one.
    fn exposure_time_s(&self) -> Option<f64> {
        None
    }

    /// A picture of what these channels recorded, or `None` if there is none.
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture>;

    /// The same picture with what else is `wanted` of it, as far as it is known.
    fn finish(&self, exposure: &ExposureFrame, _wanted: Wanted) -> Option<Finished> {
        self.display(exposure).map(Finished::of)
    }

    /// What the values of its picture stand for.
    fn image_state(&self) -> ImageState {
        ImageState::SceneReferred
    }

    /// Its analog-to-digital converter, if it has one.
    fn digitize(&self) -> Option<&dyn Digitize> {
        None
    }
}

impl<R: Response + ?Sized> Response for Box<R> {
    fn channels(&self) -> Vec<Channel> {
        (**self).channels()
    }

    fn exposure_time_s(&self) -> Option<f64> {
        (**self).exposure_time_s()
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        (**self).display(exposure)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: Wanted) -> Option<Finished> {
        (**self).finish(exposure, wanted)
    }

    fn image_state(&self) -> ImageState {
        (**self).image_state()
    }

    fn digitize(&self) -> Option<&dyn Digitize> {
        (**self).digitize()
    }
}

/// Turns what the channels recorded into the numbers of a raw file.
pub trait Digitize: Send + Sync {
    /// The numbers.
    fn raw(&self, exposure: &ExposureFrame) -> RawFrame;
}

/// Receives rays.
pub trait Receive: Send + Sync {
    /// Moves the living rays onto the imager (in the frame whose nominal image plane is z = 0) and writes the pixel into the tag,
    /// with the channel if the light adds to one channel only ([`crate::batch::tag_of`]). Rays that miss the frame end as
    /// [`crate::Loss::OutOfFrame`].
    fn receive(&self, rays: &mut RayBatch, isa: Isa);

    /// Whether it draws numbers from the rays ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// Launches rays.
pub trait Launch: Send + Sync {
    /// For the pixel in each ray's tag, and (`u`, `v`) in [0, 1)^2 within it, writes the point (mm; nominal image plane z = 0),
    /// and the imager's unit normal (toward the lens) as the direction.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64], isa: Isa);

    /// Called once the directions are set (toward the lens; positions anywhere along the rays): applies what is in front of the
    /// pixels to each ray. It may shift a ray sideways by less than matters at the pupil, change its weight, end it, or name the
    /// one channel that it adds to ([`crate::batch::tag_of`]).
    fn admit(&self, _rays: &mut RayBatch, _isa: Isa) {}

    /// Whether it draws numbers beyond `u` and `v` ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// A developed film, as the film that made it knows it.
pub type Negative = Box<dyn Any + Send + Sync>;

/// Where a frame lies that a film can tell nothing apart in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// It has too little light.
    Dark,
    /// It has too much of it.
    Bright,
}

/// The film: which light it responds to, and how it is developed.
pub trait Film: Any + Send + Sync {
    /// Its channels: responses to spectral irradiance, in lux (times seconds of exposure).
    fn channels(&self) -> Vec<Channel>;

    /// How many of its channels, counted from the first, make the picture. The rest only inform the camera, as a light meter
    /// does.
    fn picture_channels(&self) -> usize {
        self.channels().len()
    }

    /// Exposure time for which light is recorded, s.
    fn exposure_time_s(&self) -> f64;

    /// Exposure time that the film is developed for, s: the one that the camera's meter chose, if it meters the frame; otherwise
    /// the time that was recorded.
    fn metered_time_s(&self, _exposure: &ExposureFrame) -> f64 {
        self.exposure_time_s()
    }

    /// Whether a meter in the camera chooses the exposure time from the frame.
    fn is_metered(&self) -> bool {
        false
    }

    /// Whether the camera takes a picture that was exposed already as it is: its meter is shown a mid gray of the picture in place of the
    /// frame ([`Source::is_exposed`]).
    fn keeps_exposure(&self) -> bool {
        false
    }

    /// The meter that chooses the exposure time, in a word, such as `spot`; `None` where none does.
    fn meter(&self) -> Option<&'static str> {
        None
    }

    /// Whether the camera meters each frame of an animation by itself; otherwise all are exposed as the first one is metered.
    fn meters_each_frame(&self) -> bool {
        false
    }

    /// Whether the camera's meter looks at a pixel. The channels beyond [`Film::picture_channels`] are recorded with fewer rays
    /// than the picture, and only where this is true; elsewhere they are 0.
    fn is_metered_at(&self, _size: &FrameSize, _pixel: u32) -> bool {
        true
    }

    /// Warnings about the picture, for example of a setting that has no effect.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Whether nearly all of a frame, its exposure as in [`Film::develop`], is beyond what the film can tell apart; `None` as well
    /// where a film does not know.
    fn beyond(&self, _exposure: &ExposureFrame) -> Option<Beyond> {
        None
    }

    /// Exposure time, s, with which the mean of the frame would be a mid gray, where the film knows it.
    fn gray_time_s(&self, _exposure: &ExposureFrame) -> Option<f64> {
        None
    }

    /// How many of its first channels see a gray card alike in the light that the film is balanced for; 0 where it is balanced for none.
    fn balanced_channels(&self) -> usize {
        0
    }

    /// What is not known of an exposure of `time_s` seconds, in a sentence: whether so long a time counts in full. `None` where it is
    /// known.
    fn long_exposure_doubt(&self, _time_s: f64) -> Option<String> {
        None
    }

    /// Checks that a frame of this size can be developed, before any light is traced.
    ///
    /// # Errors
    /// The reason why it cannot, and what to write instead.
    fn check_frame(&self, _size: &FrameSize) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// A short name.
    fn name(&self) -> String {
        self.describe()
    }

    /// Develops the frame into a picture. Its exposure, in lx s per channel, is that of [`Film::exposure_time_s`]; the film
    /// itself applies the exposure time chosen by a meter.
    ///
    /// # Errors
    /// The name of the missing channel, in a sentence.
    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, String>;

    /// The same picture with what else is `wanted` of it, as far as it is known.
    ///
    /// # Errors
    /// As [`Film::develop`].
    fn finish(&self, exposure: &ExposureFrame, _wanted: Wanted) -> Result<Finished, String> {
        self.develop(exposure).map(Finished::of)
    }

    /// The developed film, before it is printed, scanned or looked at, with what is `wanted` that rests on it alone; `None` where a
    /// film is finished in one go.
    ///
    /// # Errors
    /// As [`Film::develop`].
    fn negative(&self, _exposure: &ExposureFrame, _wanted: Wanted) -> Result<Option<Negative>, String> {
        Ok(None)
    }

    /// [`Film::finish`] from a negative that this film made, or one that [`Film::develops_as`] it.
    ///
    /// # Errors
    /// As [`Film::develop`]; a negative of another kind of film.
    fn print(&self, _negative: &Negative, _wanted: Wanted) -> Result<Finished, String> {
        Err("this film makes no negative".to_owned())
    }

    /// Whether the [`Film::negative`] of any exposure is that of `other`, bit for bit.
    fn develops_as(&self, _other: &dyn Film) -> bool {
        false
    }

    /// What the values of its picture stand for.
    fn image_state(&self) -> ImageState {
        ImageState::DisplayReferred
    }

    /// Whether [`Film::finish`] knows exposure and density of its layers.
    fn has_layers(&self) -> bool {
        false
    }

    /// Sets the frame of an animation. Each frame has its own grain, which follows from the film's seed and the frame's number
    /// ([`crate::numbers::seed_of_frame`]), whichever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}

    /// Facts about the film that are worth reporting, for the log and the EXR.
    fn describe(&self) -> String;
}
