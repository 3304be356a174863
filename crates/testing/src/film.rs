//! The laws of films.

use spectra_core::frame::{DisplayPicture, ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::spectral::{BAND, Channel};
use spectra_core::stage::Film;

/// The laws of films, and what must be known of one to try them.
///
/// - Channels have a name of their own, a unit, and a response over the band that is finite, not negative and not zero
///   everywhere; exposure times are finite and above zero.
/// - The picture has the size of the frame, its values are finite and within what a screen shows; the same frame gives the
///   same picture.
/// - A missing channel is an error with a text.
/// - If it says so: more light is never darker.
#[derive(Clone, Copy, Debug)]
pub struct FilmLaws {
    /// Whether more light makes no pixel darker: true of a reversal film or a print, not of a negative, nor of one with grain
    /// or a meter.
    pub brighter_with_light: bool,
    /// How far beyond 0 and 1 a picture's values may lie: colors that a screen cannot show.
    pub beyond_screen: f32,
    /// Exposures that are tried, in the unit of the channels: least and most. 0 is tried anyway.
    pub exposures: [f32; 2],
}

impl Default for FilmLaws {
    /// A positive whose colors a screen can show, from 1e-6 to 1e6 lx s.
    fn default() -> Self {
        Self { brighter_with_light: true, beyond_screen: 1e-6, exposures: [1e-6, 1e6] }
    }
}

pub(crate) const SIZE: FrameSize = FrameSize { width_px: 9, height_px: 5, width_mm: 36.0, height_mm: 20.0 };
/// Exposures between the least and the most.
const STEPS: usize = 24;

impl FilmLaws {
    /// Tries all of them.
    ///
    /// # Panics
    /// With the first case that breaks a law.
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
        // Other values in each pixel and channel, as in a picture.
        let middle = (least * most).sqrt();
        let mixed =
            frame(&channels, |channel, pixel| (middle * f64::from(((channel * 5 + pixel * 7) % 11) as u32)) as f32);
        self.develop(film, &mixed, "a picture");
        for missing in 0..channels.len() {
            let mut less = mixed.clone();
            less.channels.remove(missing);
            let name = &channels[missing].name;
            if let Err(text) = film.develop(&less) {
                assert!(!text.trim().is_empty(), "without channel `{name}` its error is an empty text");
            }
        }
        let none = ExposureFrame { size: SIZE, channels: Vec::new() };
        assert!(film.develop(&none).is_err(), "a frame without channels is developed all the same");
    }

    fn develop(&self, film: &dyn Film, frame: &ExposureFrame, case: &str) -> DisplayPicture {
        let picture = film.develop(frame).unwrap_or_else(|text| panic!("{case}: {text}"));
        let size = (picture.width_px, picture.height_px, picture.rgb.len());
        let want = (SIZE.width_px, SIZE.height_px, SIZE.pixels());
        assert_eq!(size, want, "{case}: the picture is of another size than the frame");
        let range = -self.beyond_screen..=1.0 + self.beyond_screen;
        for (pixel, rgb) in picture.rgb.iter().enumerate() {
            assert!(rgb.iter().all(|v| range.contains(v)), "{case}: pixel {pixel} is {rgb:?}, outside of 0 to 1");
        }
        let again = film.develop(frame).unwrap_or_else(|text| panic!("{case}, again: {text}"));
        assert!(again == picture, "{case}: a second time the picture is another one");
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

/// What holds for the channels of films and imagers alike.
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
        assert!(channel.response.iter().any(|r| *r > 0.0), "channel `{name}` sees nothing");
    }
}
