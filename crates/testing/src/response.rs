//! The laws of responses.

use crate::film::{SIZE, check_channels, frame};
use spectra_core::frame::ExposureFrame;
use spectra_core::stage::Response;

/// The laws of responses, and what must be known of one to try them.
///
/// - Channels have a name of their own, a unit, and a response over the band that is finite, not negative and not zero
///   everywhere.
/// - Where it makes a picture, this has the size of the frame and finite values; the same frame gives the same picture, and no
///   light a darker one than much.
/// - Without its channels there is no picture, and no panic.
#[derive(Clone, Copy, Debug)]
pub struct ResponseLaws {
    /// Whether it makes pictures.
    pub shows: bool,
    /// The exposure that counts as much light, in the unit of the channels.
    pub much: f32,
}

impl Default for ResponseLaws {
    /// One that makes pictures, and for which 1 is much.
    fn default() -> Self {
        Self { shows: true, much: 1.0 }
    }
}

impl ResponseLaws {
    /// Tries all of them.
    ///
    /// # Panics
    /// With the first case that breaks a law.
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
            assert_eq!(size, (SIZE.width_px, SIZE.height_px, SIZE.pixels()), "{case}: the picture is of another size");
            assert!(picture.rgb.iter().flatten().all(|v| v.is_finite()), "{case}: not all values are finite");
            assert!(response.display(frame).as_ref() == Some(&picture), "{case}: a second time it is another picture");
            sums.push(picture.rgb.iter().flatten().sum::<f32>());
        }
        assert!(sums.len() < 2 || sums[0] < sums[1], "much light is no brighter than none: {sums:?}");
        let none = ExposureFrame { size: SIZE, channels: Vec::new() };
        assert!(response.display(&none).is_none(), "a frame without channels makes a picture");
    }
}
