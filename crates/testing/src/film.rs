//! The laws that every film must obey.

use spectra_core::frame::{DisplayPicture, ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::spectral::{BAND, Channel};
use spectra_core::stage::Film;

/// The laws of films, with the facts about a film that are needed to check them.
///
/// - Each channel has a unique name, a unit, and a response over the band that is finite, not negative and not zero
///   everywhere; exposure times are finite and above zero.
/// - The picture has the size of the frame, and its values are finite and within the range of a screen; the same frame gives
///   the same picture.
/// - A missing channel is an error with a message.
/// - If [`FilmLaws::brighter_with_light`] is true, more light never makes a pixel darker.
#[derive(Clone, Copy, Debug)]
pub struct FilmLaws {
    /// Whether more light never makes a pixel darker: true for a reversal film or a print, false for a negative and for a film with
    /// grain or a meter.
    pub brighter_with_light: bool,
    /// Largest amount by which a picture's values may lie outside 0 to 1, for colors that a screen cannot show.
    pub beyond_screen: f32,
    /// Least and largest exposure that are tried, in the unit of the channels; 0 is always tried.
    pub exposures: [f32; 2],
}

impl Default for FilmLaws {
    /// Returns the laws of a positive whose colors a screen can show, tried from 1e-6 to 1e6 lx s.
    fn default() -> Self {
        Self { brighter_with_light: true, beyond_screen: 1e-6, exposures: [1e-6, 1e6] }
    }
}

pub(crate) const SIZE: FrameSize = FrameSize { width_px: 9, height_px: 5, width_mm: 36.0, height_mm: 20.0 };
/// Number of steps from the least to the largest exposure.
const STEPS: usize = 24;

impl FilmLaws {
    /// Checks all laws on a film.
    ///
    /// # Panics
    /// At the first case that breaks a law; the message describes it.
    pub fn hold(&self, film: &dyn Film) {
        let channels = film.channels();
        assert!(!channels.is_empty(), "the film has no channels");
        check_channels(&channels);
        let time = film.exposure_time_s();
        assert!(time > 0.0 && time.is_finite(), "its exposure time is {time} s");
        assert!(!film.describe().trim().is_empty(), "`describe` says nothing");
        let [least, most] = self.exposures.map(f64::from);
        let step = |i: usize| (least * spectra_core::math::pow(most / least, i as f64 / STEPS as f64)) as f32;
        let exposures = std::iter::once(0.0).chain((0..=STEPS).map(step));
        let mut darker: Option<(f32, Vec<[f32; 3]>)> = None;
        for exposure in exposures {
            let frame = frame(&channels, |_, _| exposure);
            let picture = self.develop(film, &frame, &format!("{exposure} everywhere"));
            let metered = film.metered_time_s(&frame);
            assert!(metered > 0.0 && metered.is_finite(), "at {exposure} the metered time is {metered} s");
            if let Some((before, less)) = darker.filter(|_| self.brighter_with_light) {
                for (a, b) in less.iter().zip(&picture.rgb) {
                    let falls = (0..3).any(|k| b[k] < a[k] - 1e-6);
                    assert!(!falls, "more light is darker: {before} gives {a:?}, {exposure} gives {b:?}");
                }
            }
            darker = Some((exposure, picture.rgb));
        }
        // Different values in each pixel and channel, as in a picture.
        let middle = (least * most).sqrt();
        let mixed =
            frame(&channels, |channel, pixel| (middle * f64::from(((channel * 5 + pixel * 7) % 11) as u32)) as f32);
        self.develop(film, &mixed, "a picture");
        for missing in 0..channels.len() {
            let mut less = mixed.clone();
            less.channels.remove(missing);
            let name = &channels[missing].name;
            if let Err(text) = film.develop(&less) {
                assert!(!text.message.trim().is_empty(), "without channel `{name}` its error is an empty text");
            }
        }
        let none = ExposureFrame { size: SIZE, channels: Vec::new() };
        assert!(film.develop(&none).is_err(), "a frame without channels is developed without an error");
    }

    fn develop(&self, film: &dyn Film, frame: &ExposureFrame, case: &str) -> DisplayPicture {
        let picture = film.develop(frame).unwrap_or_else(|text| panic!("{case}: {text}"));
        let size = (picture.width_px, picture.height_px, picture.rgb.len());
        let want = (SIZE.width_px, SIZE.height_px, SIZE.pixels());
        assert_eq!(size, want, "{case}: the picture does not have the size of the frame");
        let range = -self.beyond_screen..=1.0 + self.beyond_screen;
        for (pixel, rgb) in picture.rgb.iter().enumerate() {
            assert!(rgb.iter().all(|v| range.contains(v)), "{case}: pixel {pixel} is {rgb:?}, outside 0 to 1");
        }
        let again = film.develop(frame).unwrap_or_else(|text| panic!("{case}, again: {text}"));
        assert!(again == picture, "{case}: developing the frame again gives another picture");
        picture
    }
}

pub(crate) fn frame(channels: &[Channel], value: impl Fn(usize, usize) -> f32) -> ExposureFrame {
    let plane = |(at, channel): (usize, &Channel)| ExposureChannel {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        values: (0..SIZE.pixels()).map(|pixel| value(at, pixel)).collect(),
    };
    ExposureFrame { size: SIZE, channels: channels.iter().enumerate().map(plane).collect() }
}

/// Checks the laws of channels, which films, responses and imagers share.
pub(crate) fn check_channels(channels: &[Channel]) {
    for (i, channel) in channels.iter().enumerate() {
        let name = &channel.name;
        assert!(!name.trim().is_empty(), "channel {i} has no name");
        assert!(channels[..i].iter().all(|other| other.name != *name), "two channels are called `{name}`");
        assert!(!channel.unit.trim().is_empty(), "channel `{name}` has no unit");
        let many = channel.response.len();
        assert_eq!(many, BAND.count, "channel `{name}` has {many} responses; the grid has {}", BAND.count);
        for (response, nm) in channel.response.iter().zip(BAND.wavelengths_nm()) {
            assert!(response.is_finite() && *response >= 0.0, "channel `{name}` responds with {response} at {nm} nm");
        }
        assert!(channel.response.iter().any(|r| *r > 0.0), "channel `{name}` has no response anywhere");
    }
}
