//! A recorded picture: the light of a scene, and the pictures made from it.
//!
//! A picture is finished once for all files. `Film::finish` and `Response::finish` give what a screen shows. On request they also give the
//! layers of the film, and the picture without a gamut: linear sRGB, with values below 0 and above 1. All other color spaces follow from
//! that. The `image_state` of a stage states what its values stand for (scene, display or densities), and decides which tags a file gets.
//!
//! A film may be finished in two steps, negative and print, and states by `develops_as` whose negatives are like its own. Printing is quick
//! and developing is not, so a program that shows one exposure in many ways keeps the negatives ([`Negatives`]).

use crate::{FilmTime, LightLayer, Negatives, Scene, SceneFilm};
use serde_json::Value;
use spectra_core::Isa;
use spectra_core::frame::{
    DisplayPicture, ExposureChannel, ExposureFrame, ExtraData, ExtraRequest, FinishedPicture, ImageState,
};
use spectra_core::params::Fault;
use spectra_core::sink::WriteFault;
use std::sync::OnceLock;

/// A developed picture, with the name of its film if there are several.
pub type Developed = (Option<String>, DisplayPicture);

/// All pictures, and the additional data of each.
type All = (Vec<Developed>, Vec<ExtraData>);

/// The light that a scene recorded, ready to be developed and written to files.
pub struct Shot<'a> {
    /// The scene that was rendered.
    pub scene: &'a Scene,
    /// Linear exposure of each channel, for the exposure time of the recording.
    pub exposure: &'a ExposureFrame,
    /// Exposure time of each film.
    pub times: &'a [FilmTime],
    /// Names and texts for the headers of files.
    pub attributes: &'a [(String, String)],
    /// Instruction set to compute figures with.
    pub isa: Isa,
    /// Light separated by kinds, as far as outputs hold them.
    pub layers: &'a [LightLayer],
    tell: &'a (dyn Fn() -> Value + Sync),
    report: OnceLock<Value>,
    kept: Option<&'a Negatives>,
    pictures: OnceLock<Result<All, Fault>>,
}

impl<'a> Shot<'a> {
    /// Wraps the light that a scene recorded, with the exposure times of its films, attributes for the headers of files, and the
    /// instruction set to compute with. No film is developed yet.
    #[must_use]
    pub fn new(
        scene: &'a Scene,
        exposure: &'a ExposureFrame,
        times: &'a [FilmTime],
        attributes: &'a [(String, String)],
        isa: Isa,
    ) -> Self {
        let (report, pictures) = (OnceLock::new(), OnceLock::new());
        let tell = &|| Value::Null;
        Self { scene, exposure, times, attributes, isa, layers: &[], tell, report, kept: None, pictures }
    }

    /// Sets the function that creates the report, the content of `SCENE.json`. It is called when the report is first needed.
    #[must_use]
    pub fn with_report(self, tell: &'a (dyn Fn() -> Value + Sync)) -> Self {
        Self { tell, ..self }
    }

    /// Returns the report, which is the content of `SCENE.json`; null if no function was set.
    #[must_use]
    pub fn report(&self) -> &Value {
        self.report.get_or_init(self.tell)
    }

    /// Adds layers that hold the light of one [`LightKind`](crate::LightKind) each.
    #[must_use]
    pub fn with_layers(self, layers: &'a [LightLayer]) -> Self {
        Self { layers, ..self }
    }

    /// Uses the cache `kept` for pictures without additional data. A film that was already developed from this exposure is only
    /// printed again. Other films are developed, and their negatives are kept.
    #[must_use]
    pub fn with_negatives(self, kept: &'a Negatives) -> Self {
        Self { kept: Some(kept), ..self }
    }

    /// Returns the factor for each channel of the recorded exposure that gives the exposure of its film; 1 for channels of no
    /// film.
    #[must_use]
    pub fn gains(&self) -> Vec<f64> {
        let mut gains = vec![1.0; self.exposure.channels.len()];
        for time in self.times {
            gains[time.channels.clone()].fill(time.gain);
        }
        gains
    }

    /// Returns the pictures of the frame: one for each film, with its name if there are several, or the picture of the imager.
    /// They are developed only once.
    ///
    /// # Errors
    /// The reason why there is no picture, as text.
    pub fn pictures(&self) -> Result<&[Developed], Fault> {
        self.all().map(|(pictures, _)| &pictures[..])
    }

    /// Returns the picture of the film at an index, or the only picture.
    ///
    /// # Errors
    /// [`WriteFault::Format`] with the reason why there is no picture.
    pub fn picture(&self, film: usize) -> Result<&DisplayPicture, WriteFault> {
        let (pictures, _) = self.all().map_err(|fault| WriteFault::Format(fault.to_string()))?;
        pictures.get(film).map(|(_, picture)| picture).ok_or_else(no_film)
    }

    /// Returns the additional data of the picture at the index `film`. They hold only what some output of the scene asks for
    /// ([`crate::Output::extra_request`]).
    ///
    /// # Errors
    /// [`WriteFault::Format`] with the reason why there is no picture.
    pub fn extra_data(&self, film: usize) -> Result<&ExtraData, WriteFault> {
        let (_, beside) = self.all().map_err(|fault| WriteFault::Format(fault.to_string()))?;
        beside.get(film).ok_or_else(no_film)
    }

    /// Returns the picture at an index without gamut mapping ([`ExtraData::unclamped`]) if it is known, otherwise the ordinary
    /// picture.
    ///
    /// # Errors
    /// [`WriteFault::Format`] with the reason why there is no picture.
    pub fn unclamped_picture(&self, film: usize) -> Result<&DisplayPicture, WriteFault> {
        match &self.extra_data(film)?.unclamped {
            Some(open) => Ok(open),
            None => self.picture(film),
        }
    }

    /// Returns what the values of the picture at an index represent.
    #[must_use]
    pub fn image_state(&self, film: usize) -> ImageState {
        match self.scene.films.get(film) {
            Some(film) => film.film.image_state(),
            None => self.scene.imager.response().map_or(ImageState::default(), |own| own.image_state()),
        }
    }

    fn all(&self) -> Result<&All, Fault> {
        self.pictures.get_or_init(|| self.developed()).as_ref().map_err(Clone::clone)
    }

    fn developed(&self) -> Result<All, Fault> {
        let Self { scene, exposure, .. } = self;
        let outputs = scene.output.iter().map(|output| output.extra_request());
        let wanted = outputs.fold(ExtraRequest::default(), |a, b| ExtraRequest {
            unclamped: a.unclamped || b.unclamped,
            layers: a.layers || b.layers,
        });
        if scene.films.is_empty() {
            let shown = scene.imager.response().and_then(|own| own.finish(exposure, wanted));
            let FinishedPicture { display: shown, extra: mut beside } =
                shown.ok_or_else(|| Fault::new("this imager gives no picture without a film"))?;
            if wanted.layers {
                let layers = exposure.channels.iter().cloned();
                beside.layers = layers.map(|c| ExposureChannel { name: format!("exposure.{}", c.name), ..c }).collect();
            }
            return Ok((vec![(None, shown)], vec![beside]));
        }
        let of = |(place, film): (usize, &SceneFilm)| -> Result<(Developed, ExtraData), Fault> {
            let finish = |exposure: &ExposureFrame| match self.kept {
                None => film.film.finish(exposure, wanted),
                Some(kept) => kept.finish(place, &film.film, exposure),
            };
            let finished = match &film.name {
                // A single film owns the whole frame.
                None => finish(exposure)?,
                Some(_) => finish(&film.exposure(exposure))?,
            };
            if let Some([x, y]) = no_number(&finished.display) {
                let film = film.film.name();
                return Err(Fault::new(format!("{film}: `develop` returned NaN for the color of pixel {x}, {y}")));
            }
            let FinishedPicture { display: shown, extra: beside } = finished;
            Ok(((film.name.clone(), shown), beside))
        };
        let all = scene.films.iter().enumerate().map(of).collect::<Result<Vec<_>, Fault>>()?;
        Ok(all.into_iter().unzip())
    }

    /// Returns the width of a pixel over its height for viewing: its aspect on the film times the squeeze of an anamorphic lens.
    #[must_use]
    pub fn pixel_aspect(&self) -> f64 {
        let size = self.exposure.size;
        let aspect = size.width_mm / f64::from(size.width_px) / (size.height_mm / f64::from(size.height_px));
        // Widths and heights in whole pixels cannot give exactly square pixels.
        let aspect = if (aspect - 1.0).abs() < 0.005 { 1.0 } else { aspect };
        aspect * self.scene.lens.squeeze
    }
}

/// Returns the first pixel, row by row, with a value that is not a number; files would show it black.
fn no_number(picture: &DisplayPicture) -> Option<[usize; 2]> {
    let at = picture.rgb.iter().position(|rgb| rgb.iter().any(|v| v.is_nan()))?;
    let width = picture.width_px as usize;
    Some([at % width, at / width])
}

fn no_film() -> WriteFault {
    WriteFault::Format("there is no film at this place".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_no_number_is_found() {
        let mut picture = DisplayPicture { width_px: 3, height_px: 2, rgb: vec![[0.5, f32::INFINITY, -1.0]; 6] };
        assert_eq!(no_number(&picture), None);
        picture.rgb[4][2] = f32::NAN;
        assert_eq!(no_number(&picture), Some([1, 1]));
    }
}
