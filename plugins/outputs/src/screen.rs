//! Parts that `png`, `jpeg` and `tiff` share: color spaces, and pixels that are not square.

use crate::exr::DENSITIES;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{DisplayPicture, ExtraRequest, ImageState};
use spectra_core::sink::WriteFault;
use spectra_core::stage::Film;
use spectra_pictures::write::{PictureSpace, squared};
use spectra_scene::Shot;
use std::borrow::Cow;

/// A color space as written in a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[schemars(inline)]
pub(crate) enum Space {
    #[default]
    #[serde(rename = "srgb")]
    Srgb,
    #[serde(rename = "display-p3")]
    DisplayP3,
    #[serde(rename = "rec2020")]
    Rec2020,
    #[serde(rename = "acescct")]
    AcesCct,
}

/// The way a picture is written to a file for a screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen {
    pub space: Space,
    pub desqueeze: bool,
}

impl Screen {
    pub(crate) fn wanted(self) -> ExtraRequest {
        ExtraRequest { unclamped: self.space != Space::Srgb, layers: false }
    }

    pub(crate) fn check_film(self, film: &dyn Film) -> Result<(), [String; 2]> {
        if film.image_state() == ImageState::Data && self.space != Space::Srgb {
            return Err([DENSITIES.to_owned(), "leave out `space`, or write `scan: picture`".to_owned()]);
        }
        Ok(())
    }

    /// Returns the picture, its color space, and the ratio of its pixels' width to their height.
    pub(crate) fn of<'a>(
        self,
        shot: &'a Shot<'_>,
        film: usize,
    ) -> Result<(Cow<'a, DisplayPicture>, PictureSpace, f64), WriteFault> {
        let (picture, space) = match self.space {
            Space::Srgb if shot.image_state(film) == ImageState::Data => (shot.picture(film)?, PictureSpace::Values),
            Space::Srgb => (shot.picture(film)?, PictureSpace::Srgb),
            Space::DisplayP3 => (shot.unclamped_picture(film)?, PictureSpace::DisplayP3),
            Space::Rec2020 => (shot.unclamped_picture(film)?, PictureSpace::Rec2020),
            Space::AcesCct => (shot.unclamped_picture(film)?, PictureSpace::AcesCct),
        };
        let aspect = shot.pixel_aspect();
        if self.desqueeze && aspect != 1.0 {
            return Ok((Cow::Owned(squared(picture, aspect)), space, 1.0));
        }
        Ok((Cow::Borrowed(picture), space, aspect))
    }
}
