//! The laws that every response must obey.

use crate::film::{SIZE, check_channels, frame};
use spectra_core::frame::ExposureFrame;
use spectra_core::stage::Response;

/// The laws of responses, with the facts about a response that are needed to check them.
///
/// - Each channel has a unique name, a unit, and a response over the band that is finite, not negative and not zero everywhere.
/// - A picture has the size of the frame and finite values. The same frame gives the same picture. A frame without any light
///   gives a darker picture than one with much light.
/// - A frame that lacks the response's channels gives no picture and no panic.
#[derive(Clone, Copy, Debug)]
pub struct ResponseLaws {
    /// Whether the response makes pictures.
    pub shows: bool,
    /// Exposure that counts as much light, in the unit of the channels.
    pub much: f32,
}

impl Default for ResponseLaws {
    /// Returns the laws of a response that makes pictures and for which an exposure of 1 is much light.
    fn default() -> Self {
        Self { shows: true, much: 1.0 }
    }
}

impl ResponseLaws {
    /// Checks all laws on a response.
    ///
    /// # Panics
    /// At the first case that breaks a law; the message describes it.
    pub fn hold(&self, response: &dyn Response) {
        let channels = response.channels();
        assert!(!channels.is_empty(), "the response has no channels");
        check_channels(&channels);
        let much = self.much;
        let dark = frame(&channels, |_, _| 0.0);
        let bright = frame(&channels, |_, _| much);
        let mixed = frame(&channels, |channel, pixel| much * ((channel * 5 + pixel * 7) % 11) as f32);
        let mut sums = Vec::new();
        for (case, frame) in [("no light", &dark), ("much light", &bright), ("a picture", &mixed)] {
            let Some(picture) = response.display(frame) else {
                assert!(!self.shows, "{case}: there is no picture");
                continue;
            };
            let size = (picture.width_px, picture.height_px, picture.rgb.len());
            assert_eq!(size, (SIZE.width_px, SIZE.height_px, SIZE.pixels()), "{case}: the picture has another size");
            assert!(picture.rgb.iter().flatten().all(|v| v.is_finite()), "{case}: not all values are finite");
            assert!(response.display(frame).as_ref() == Some(&picture), "{case}: a second call gives another picture");
            sums.push(picture.rgb.iter().flatten().sum::<f32>());
        }
        assert!(sums.len() < 2 || sums[0] < sums[1], "much light is no brighter than none: {sums:?}");
        let none = ExposureFrame { size: SIZE, channels: Vec::new() };
        assert!(response.display(&none).is_none(), "a frame without channels makes a picture");
    }
}
