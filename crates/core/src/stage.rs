//! The stages of the light path. A stage does not change while light is traced, and does not know which concrete stages come before and
//! after it.
//!
//! **Two directions.** Forward, light is traced from the source: for lamps, points and highlights. Backward, it is traced from the imager:
//! for pictures and everything continuous. A source can [`Emit`] rays, return the [`Radiance`] along them, or both. An imager can
//! [`Receive`] rays, [`Launch`] them, or both. A surface works in either direction. Both directions estimate the same exposure in the same
//! units. What an imager makes of light by itself (channels, exposure time, picture, the numbers of a raw file) is its [`Response`]; an
//! imager without one leaves that to a [`Film`].
//!
//! **Weights.** Forward, a ray carries flux in W m^-2 mm^2 (radiance in W m^-2 sr^-1 times areas in mm^2), so that flux divided by the
//! pixel's area in mm^2 is irradiance in W m^-2. Backward, a ray carries throughput; multiplied by the radiance it becomes irradiance in W
//! m^-2. Both are divided by the probability with which wavelength and positions were drawn.
//!
//! **Arguments.** Numbers and files reach a stage only through its arguments. What it must know of the whole scene, it gets as a value: a
//! sampler gets a [`SystemResponse`], a builder a [`Context`](crate::registry::Context), which holds the view of the frame for a source
//! that fills it. Large files of a source are read by [`Source::prepare`], when light is traced and not when a scene is checked.

use crate::RayBatch;
use crate::cover::CoverStack;
use crate::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture, FrameSize, ImageState, RawFrame};
pub use crate::grain_noise::GrainNoise;
use crate::isa::Isa;
use crate::params::{Fault, Faults, Warning};
use crate::spectral::{Channel, SpectralPower, SystemResponse};
use std::any::Any;
use std::sync::Arc;

/// A light source. It can emit rays, return the radiance along given rays, or both.
pub trait Source: Send + Sync {
    /// Loads large files, once, before any light is traced. Checking a scene does not need this; until it is called, a source may
    /// use a placeholder, such as a white card for a picture.
    ///
    /// # Errors
    /// The faults of the files, placed at the keys that name them.
    fn prepare(&self) -> Result<(), Faults> {
        Ok(())
    }

    /// Warnings about the large files of this source, available once [`Source::prepare`] has read them.
    fn warnings(&self) -> &[Warning] {
        &[]
    }

    /// Spectrum of the light that enters the lens, summed over the source, on an arbitrary scale. The wavelength sampler weights
    /// wavelengths by it. [`RayBatch::lines`] refers to its lines.
    fn spectrum(&self) -> &SpectralPower;

    /// Spectrum of the light in which a lens is focused. It must be the same before and after [`Source::prepare`]; otherwise a
    /// picture would depend on what was rendered before it.
    fn focus_light(&self) -> &SpectralPower {
        self.spectrum()
    }

    /// Spectrum of the light from the white parts of the source, on an arbitrary scale, for which a color film may be balanced.
    /// It is known before [`Source::prepare`].
    fn white(&self) -> &SpectralPower {
        self.focus_light()
    }

    /// Peak brightness of the source divided by its mean brightness. It is used to keep highlights within the range of the exact
    /// sums of light.
    fn peak_over_mean(&self) -> f64 {
        1.0
    }

    /// Distance of the source from the first vertex, in mm; may be infinite. It is used for messages and focusing.
    fn distance_mm(&self) -> f64;

    /// Returns the source as an emitter of rays (forward), if it can be one.
    fn emit(&self) -> Option<&dyn Emit> {
        None
    }

    /// Returns the source as a radiance along rays (backward), if it can be one.
    fn radiance(&self) -> Option<&dyn Radiance> {
        None
    }

    /// Splits the source in two if part of it is much brighter than the rest; `None` otherwise. Which light belongs to which
    /// part must not depend on what is rendered.
    fn split(&self) -> Option<Split<'_>> {
        None
    }

    /// Returns the source as a flat picture with known pixels, so that a film can be exposed to it without a lens; reads its
    /// files. `None` if the source is no such picture.
    fn still(&self) -> Option<Result<Still, Faults>> {
        None
    }

    /// Returns the light that `response` sees of a mid gray (18 % of white) of this picture, over the mean that it sees of the
    /// picture. `response` is the response of a channel on the grid of the scene. `None` if the source has no white, and before
    /// [`Source::prepare`].
    fn gray_over_mean(&self, _response: &[f64]) -> Option<f64> {
        None
    }

    /// Returns whether the source is a picture that was already exposed, as image files of integers are. 18 % of its white
    /// should then become a mid gray.
    fn is_exposed(&self) -> bool {
        false
    }

    /// Returns a few words for the summary: how numbers in the files of this source were interpreted, such as the unit of a
    /// depth. `None` if there is nothing to say.
    fn meaning(&self) -> Option<String> {
        None
    }

    /// Facts about the source that are worth reporting, for the log and the EXR.
    fn describe(&self) -> String;
}

/// A flat picture, pixel by pixel. A pixel's radiance, W m^-2 sr^-1 nm^-1, is `scale` times the spectrum that `model` gives its
/// color.
pub struct Still {
    /// Number of pixels across the picture.
    pub width_px: u32,
    /// Number of pixels down the picture.
    pub height_px: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Linear light in sRGB primaries, 0 or more; row by row from the top of the upright picture.
    pub rgb: Vec<[f32; 3]>,
    /// Model that turns a color into a spectrum.
    pub model: Arc<dyn ColorModel>,
    /// Radiance per unit of the model's spectra.
    pub scale: f64,
}

/// A source split in two parts whose radiances along any ray add up to that of the whole. Each part is rendered in the
/// direction that finds it.
#[derive(Clone, Copy)]
pub struct Split<'a> {
    /// The bright part, which emits rays and is rendered forward.
    pub lights: &'a dyn Source,
    /// The rest of the source, whose radiance is asked for along rays: it is rendered backward.
    pub rest: &'a dyn Source,
    /// Whether the split is expected to give less noise in the same time than backward rendering of the whole source.
    pub pays: bool,
}

/// A source that emits rays, for forward rendering.
pub trait Emit: Send + Sync {
    /// Writes where each ray starts (mm, frame of the lens). Multiplies its weight by the emission there at its wavelength,
    /// divided by the probability density of the position. Emission is radiance times area (W m^-2 sr^-1 nm^-1 mm^2; W m^-2 sr^-1
    /// mm^2 on a line). For a point source it is intensity (W sr^-1 nm^-1) times 1e6. `u` and `v` are the random numbers to use,
    /// one per ray.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]);

    /// Half the width and half the height (mm) of the spots that emit all light of this source, perpendicular to the axis; `None`
    /// if it is not made of spots. Each spot fades linearly from its middle along both sides. A ray that starts in the middle
    /// carries as much light as one from anywhere in the spot.
    fn spots_mm(&self) -> Option<[f64; 2]> {
        None
    }

    /// Starts each ray in the middle of a spot, which the ray represents; otherwise like [`Emit::place`]. For sources that have
    /// [`Emit::spots_mm`].
    fn place_in_middle(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        self.place(rays, u, v);
    }

    /// Returns whether [`Emit::place`] also writes the directions, as for a beam. Such rays are not aimed at the lens, and
    /// their weight is spectral flux times 1e6 (W nm^-1, W on a line).
    fn is_directed(&self) -> bool {
        false
    }

    /// Multiplies each ray's weight by the emission in its direction, relative to the emission that [`Emit::place`] has applied.
    /// For an emitting plane this includes the cosine. It is called once the directions are set.
    fn radiate(&self, rays: &mut RayBatch);

    /// Returns whether the source draws random numbers beyond `u` and `v` ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// A source that returns the radiance along given rays, for backward rendering.
pub trait Radiance: Send + Sync {
    /// Multiplies the weight of each living ray by the radiance that arrives along it. Rays run from the lens toward the object;
    /// their positions are in the frame of the lens. Radiance is in W m^-2 sr^-1 nm^-1, or in W m^-2 sr^-1 if the wavelength is
    /// that of a line.
    fn radiance(&self, rays: &mut RayBatch);

    /// Returns whether the source draws random numbers from the rays ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// The range of colors from which a color model can make spectra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorGamut {
    /// Colors inside sRGB: no value of linear sRGB is negative.
    Srgb,
    /// All colors that light can have, except the last 0.001 in xy before the spectral locus and the line of purples.
    Real,
}

/// A model that turns a color into a spectrum.
pub trait ColorModel: Send + Sync {
    /// Range of colors that the model is made for. Other colors are moved toward white at constant luminance before the model
    /// sees them.
    fn gamut(&self) -> ColorGamut {
        ColorGamut::Srgb
    }

    /// Wavelengths of the model's spectral lines, nm. For a ray on line `i`, only that line is evaluated.
    fn lines_nm(&self) -> &[f64];

    /// Returns the coefficients from which [`ColorModel::evaluate`] computes the spectrum of one color. The color is linear light
    /// in sRGB primaries.
    fn coefficients(&self, linear_srgb: [f64; 3]) -> [f32; 3];

    /// Returns the spectrum of one color, linear light in sRGB primaries, on a scale that all colors share; (1, 1, 1) is white.
    fn spectrum(&self, linear_srgb: [f64; 3]) -> SpectralPower;

    /// Multiplies each ray's weight by the spectrum of its color at its wavelength, per nm. On a spectral line (`line`) the
    /// factor is the power of that line. All slices have one element per ray.
    fn evaluate(&self, coefficients: &[[f32; 3]], wavelength_nm: &[f64], line: &[u32], weight: &mut [f64]);
}

/// A strategy for drawing wavelengths, before it is fitted to a system.
pub trait WavelengthSampler: Send + Sync {
    /// Fits the strategy to a system.
    ///
    /// # Errors
    /// The reason why this strategy cannot sample this system without bias.
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault>;
}

/// A strategy for drawing wavelengths, fitted to a system.
pub trait WavelengthDensity: Send + Sync {
    /// Draws one wavelength for each number of `u` in [0, 1): writes the wavelength (nm) and the line (or
    /// [`crate::batch::CONTINUUM`]), and multiplies the weight by one over the density (nm) or one over the line's probability.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa);

    /// Probability density of drawing a wavelength from the continuum, 1/nm.
    fn density_per_nm(&self, wavelength_nm: f64) -> f64;

    /// Probability of drawing line `i` of the source.
    fn line_probability(&self, line: usize) -> f64;

    /// Number of consecutive samples that share one random number, rotated among them (see
    /// [`crate::numbers::Numbers::fill_rotated`]); 1 if each sample has its own number.
    fn group(&self) -> u32 {
        1
    }
}

/// The imager, which determines the pixel and the channel of a ray.
pub trait Imager: Send + Sync {
    /// Size of the recorded frame, in pixels and mm.
    fn size(&self) -> FrameSize;

    /// Response of the imager itself to light; `None` if a film on it responds instead.
    fn response(&self) -> Option<&dyn Response>;

    /// Returns the imager as a receiver of rays (forward), if it can be one.
    fn receive(&self) -> Option<&dyn Receive> {
        None
    }

    /// Returns the imager as a starting point of rays (backward), if it can be one.
    fn launch(&self) -> Option<&dyn Launch> {
        None
    }

    /// Plates directly in front of the imager, if any. A camera allows for them: the lens is focused through them, and the
    /// nominal image plane (z = 0) lies farther back by the distance that they move the image.
    fn cover(&self) -> Option<CoverStack> {
        None
    }

    /// Sets the frame of an animation. Each frame has its own noise, which follows from the imager's seed and the frame's
    /// number ([`crate::numbers::seed_of_frame`]), whatever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}
}

/// The part of an imager that does not depend on geometry: how a detector responds to light, and the picture that it makes.
pub trait Response: Send + Sync {
    /// Channels of the detector, as responses to irradiance, or to irradiance times seconds if it has an exposure time.
    fn channels(&self) -> Vec<Channel>;

    /// Exposure time of the detector, s, if it has one.
    fn exposure_time_s(&self) -> Option<f64> {
        None
    }

    /// Returns a picture of the recorded exposure, or `None` if this response makes none.
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture>;

    /// Returns the picture of [`Response::display`] with the extra data that are `wanted`, as far as they are known.
    fn finish(&self, exposure: &ExposureFrame, _wanted: ExtraRequest) -> Option<FinishedPicture> {
        self.display(exposure).map(FinishedPicture::of)
    }

    /// Image state of the picture: what its values stand for.
    fn image_state(&self) -> ImageState {
        ImageState::SceneReferred
    }

    /// Analog-to-digital converter of the detector, if it has one.
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

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        (**self).finish(exposure, wanted)
    }

    fn image_state(&self) -> ImageState {
        (**self).image_state()
    }

    fn digitize(&self) -> Option<&dyn Digitize> {
        (**self).digitize()
    }
}

/// An analog-to-digital converter, which turns recorded channels into the numbers of a raw file.
pub trait Digitize: Send + Sync {
    /// Returns the numbers of the raw file.
    fn raw(&self, exposure: &ExposureFrame) -> RawFrame;
}

/// An imager that receives rays, for forward rendering.
pub trait Receive: Send + Sync {
    /// Moves the living rays onto the imager, in the frame whose nominal image plane is z = 0. Writes the pixel into the tag,
    /// with the channel if the light adds to one channel only ([`crate::batch::tag_of`]). Rays that miss the frame end as
    /// [`crate::Loss::OutOfFrame`].
    fn receive(&self, rays: &mut RayBatch);

    /// Returns whether the imager draws random numbers from the rays ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// An imager that launches rays, for backward rendering.
pub trait Launch: Send + Sync {
    /// Writes the starting point of each ray (mm): the position (`u`, `v`) in [0, 1)^2 within the pixel of its tag. The frame has
    /// its nominal image plane at z = 0. Writes the imager's unit normal, toward the lens, as the direction.
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]);

    /// Applies what lies in front of the pixels to each ray, once the directions (toward the lens) are set. Positions may lie
    /// anywhere along the rays. It may shift a ray sideways by less than matters at the pupil, change its weight, end it, or
    /// restrict it to one channel ([`crate::batch::tag_of`]).
    fn admit(&self, _rays: &mut RayBatch) {}

    /// Returns whether the imager draws random numbers beyond `u` and `v` ([`crate::numbers::RayNumbers`]).
    fn draws(&self) -> bool {
        false
    }
}

/// A developed film, in the private form of the film that made it.
pub type Negative = Box<dyn Any + Send + Sync>;

/// Reason why a film cannot distinguish tones in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misexposure {
    /// The frame has too little light.
    Dark,
    /// The frame has too much light.
    Bright,
}

/// The film: which light it responds to, and how it is developed.
pub trait Film: Any + Send + Sync {
    /// Channels of the film: responses to spectral irradiance that give lux, or lux seconds after multiplication by the exposure
    /// time.
    fn channels(&self) -> Vec<Channel>;

    /// Number of channels, counted from the first, that make the picture. Further channels are only for the camera, such as for
    /// its light meter.
    fn picture_channels(&self) -> usize {
        self.channels().len()
    }

    /// Exposure time for which the film records light, s.
    fn exposure_time_s(&self) -> f64;

    /// Exposure time for which the film is developed, s: the time that the camera's meter chose, if it meters the frame;
    /// otherwise the recorded time.
    fn metered_time_s(&self, _exposure: &ExposureFrame) -> f64 {
        self.exposure_time_s()
    }

    /// Returns whether a meter in the camera chooses the exposure time from the frame.
    fn is_metered(&self) -> bool {
        false
    }

    /// Returns whether the camera keeps the exposure of a picture that was already exposed ([`Source::is_exposed`]). Its meter
    /// then measures a mid gray of that picture instead of the frame.
    fn keeps_exposure(&self) -> bool {
        false
    }

    /// Name of the meter that chooses the exposure time, such as `spot`; `None` if no meter does.
    fn meter(&self) -> Option<&'static str> {
        None
    }

    /// Returns whether the camera meters each frame of an animation separately. Otherwise all frames are exposed as the first
    /// one is metered.
    fn meters_each_frame(&self) -> bool {
        false
    }

    /// Returns whether the camera's meter looks at a pixel. The channels beyond [`Film::picture_channels`] are recorded with
    /// fewer rays than the picture, and only where this is true; elsewhere they are 0.
    fn is_metered_at(&self, _size: &FrameSize, _pixel: u32) -> bool {
        true
    }

    /// Warnings about the picture, for example of a setting that has no effect.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns [`Misexposure::Dark`] or [`Misexposure::Bright`] if nearly all of a frame is beyond the range in which the film
    /// distinguishes tones. The frame's exposure is as for [`Film::develop`]. `None` if the frame is within the range, or if the
    /// film does not know.
    fn misexposure(&self, _exposure: &ExposureFrame) -> Option<Misexposure> {
        None
    }

    /// Exposure time (s) with which the mean of the frame would be a mid gray; `None` if the film does not know it.
    fn gray_time_s(&self, _exposure: &ExposureFrame) -> Option<f64> {
        None
    }

    /// Number of channels, counted from the first, that respond equally to a gray card in the light for which the film is
    /// balanced; 0 if it is balanced for none.
    fn balanced_channels(&self) -> usize {
        0
    }

    /// Returns a sentence that warns if it is unknown whether an exposure of `time_s` seconds counts in full (reciprocity
    /// failure); `None` if it is known.
    fn long_exposure_warning(&self, _time_s: f64) -> Option<String> {
        None
    }

    /// Returns the grain of each channel of the picture, so that no more rays are traced than the grain shows. `metered` is a frame of
    /// which only the channels beyond [`Film::picture_channels`] are known; the others have no values. Exposures are as for
    /// [`Film::develop`]. `None` if the film has no grain.
    fn grain_noise(&self, _metered: &ExposureFrame) -> Option<Vec<GrainNoise>> {
        None
    }

    /// Checks that a frame of this size can be developed, before any light is traced.
    ///
    /// # Errors
    /// The reason why it cannot, and what to write instead.
    fn check_frame(&self, _size: &FrameSize) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// A short name of the film.
    fn name(&self) -> String {
        self.describe()
    }

    /// Develops the frame into a picture. The frame's exposure, in lx s per channel, is for [`Film::exposure_time_s`]; the film
    /// itself applies the exposure time chosen by a meter.
    ///
    /// # Errors
    /// A sentence that names the missing channel.
    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, Fault>;

    /// Returns the picture of [`Film::develop`] with the extra data that are `wanted`, as far as they are known.
    ///
    /// # Errors
    /// As [`Film::develop`].
    fn finish(&self, exposure: &ExposureFrame, _wanted: ExtraRequest) -> Result<FinishedPicture, Fault> {
        self.develop(exposure).map(FinishedPicture::of)
    }

    /// Develops the film without printing, scanning or viewing it, with the `wanted` data that depend on the developed film
    /// alone. `None` if the film is finished in one step.
    ///
    /// # Errors
    /// As [`Film::develop`].
    fn negative(&self, _exposure: &ExposureFrame, _wanted: ExtraRequest) -> Result<Option<Negative>, Fault> {
        Ok(None)
    }

    /// Finishes a picture like [`Film::finish`], from a negative that was made by this film or by one that [`Film::develops_as`] it.
    ///
    /// # Errors
    /// As [`Film::develop`]; a negative of another kind of film.
    fn print(&self, _negative: &Negative, _wanted: ExtraRequest) -> Result<FinishedPicture, Fault> {
        Err(Fault::new("this film makes no negative"))
    }

    /// Returns whether the [`Film::negative`] of any exposure equals that of `other`, bit for bit.
    fn develops_as(&self, _other: &dyn Film) -> bool {
        false
    }

    /// Image state of the picture: what its values stand for.
    fn image_state(&self) -> ImageState {
        ImageState::DisplayReferred
    }

    /// Returns whether [`Film::finish`] gives the exposure and density of each layer.
    fn has_layers(&self) -> bool {
        false
    }

    /// Sets the frame of an animation. Each frame has its own grain, which follows from the film's seed and the frame's number
    /// ([`crate::numbers::seed_of_frame`]), whatever frame was set before.
    fn set_frame(&mut self, _frame: u64) {}

    /// Facts about the film that are worth reporting, for the log and the EXR.
    fn describe(&self) -> String;
}
