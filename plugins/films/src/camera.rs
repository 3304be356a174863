//! The camera that exposes a film, and the part of [`spectra_core::stage::Film`] that it answers for every film.

use crate::metering::{ExposureSettings, Meter, Metered};
use spectra_core::spectral::Channel;

/// A camera with its exposure settings and its meter.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    /// Channels of the film, followed by the meter's channel if the meter is on.
    pub channels: Vec<Channel>,
    /// How the scene sets the exposure.
    pub settings: ExposureSettings,
    /// Frames of an animation that are metered.
    pub frames: Metered,
    /// Meter that the scene sets to a speed.
    pub meter: Meter,
}

/// Implements the methods of `Film` on exposure and metering for a film with the field `camera`.
macro_rules! exposed_by_camera {
    () => {
        fn channels(&self) -> Vec<spectra_core::spectral::Channel> {
            self.camera.channels.clone()
        }

        fn picture_channels(&self) -> usize {
            self.camera.channels.iter().filter(|c| c.name != $crate::metering::METER).count()
        }

        fn exposure_time_s(&self) -> f64 {
            self.camera.settings.time_s
        }

        fn metered_time_s(&self, exposure: &spectra_core::frame::ExposureFrame) -> f64 {
            self.camera.settings.time_s * self.camera.meter.factor(exposure)
        }

        fn is_metered(&self) -> bool {
            self.camera.meter.is_on()
        }

        fn keeps_exposure(&self) -> bool {
            self.camera.settings.keeps
        }

        fn meter(&self) -> Option<&'static str> {
            self.camera.meter.word()
        }

        fn meters_each_frame(&self) -> bool {
            self.camera.frames == $crate::metering::Metered::Each
        }

        fn is_metered_at(&self, size: &spectra_core::frame::FrameSize, pixel: u32) -> bool {
            self.camera.meter.looks_at(size, pixel)
        }

        fn warnings(&self) -> Vec<String> {
            $crate::metering::overruled(self.camera.settings.is_overruled)
        }
    };
}
pub(crate) use exposed_by_camera;
