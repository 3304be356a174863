//! A picture that was taken: the light of a scene, and what can be made of it.

use crate::{FilmTime, LightLayer, Negatives, Scene, SceneFilm};
use serde_json::Value;
use spectra_core::Isa;
use spectra_core::frame::{Beside, DisplayPicture, ExposureChannel, ExposureFrame, Finished, ImageState, Wanted};
use spectra_core::sink::WriteFault;
use std::sync::OnceLock;

/// A picture, with the name of its film where there are several.
pub type Developed = (Option<String>, DisplayPicture);

/// All pictures, and what is known beside each.
type All = (Vec<Developed>, Vec<Beside>);

/// The light that a scene recorded, on its way to files.
pub struct Shot<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Linear exposure per channel, for the time that the scene records.
    pub exposure: &'a ExposureFrame,
    /// How long each film was exposed.
    pub times: &'a [FilmTime],
    /// What is said of it in the headers of files: names and texts.
    pub attributes: &'a [(String, String)],
    /// Instruction set to compute figures with.
    pub isa: Isa,
    /// The light by its kinds, of those that an output holds.
    pub layers: &'a [LightLayer],
    tell: &'a (dyn Fn() -> Value + Sync),
    report: OnceLock<Value>,
    kept: Option<&'a Negatives>,
    pictures: OnceLock<Result<All, String>>,
}

impl<'a> Shot<'a> {
    /// Nothing is developed yet.
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

    /// The same with what is said of how it came about, which is made when it is asked for.
    #[must_use]
    pub fn told(self, tell: &'a (dyn Fn() -> Value + Sync)) -> Self {
        Self { tell, ..self }
    }

    /// What is said of how it came about: the content of `SCENE.json`; null where nobody says.
    #[must_use]
    pub fn report(&self) -> &Value {
        self.report.get_or_init(self.tell)
    }

    /// The same with the light by its kinds.
    #[must_use]
    pub fn with_layers(self, layers: &'a [LightLayer]) -> Self {
        Self { layers, ..self }
    }

    /// The same for pictures alone, nothing beside them: films that were developed of this exposure before are printed again, and those
    /// that are developed are kept.
    #[must_use]
    pub fn keeping(self, kept: &'a Negatives) -> Self {
        Self { kept: Some(kept), ..self }
    }

    /// By what the values of each channel are to be multiplied, to be what the films got.
    #[must_use]
    pub fn gains(&self) -> Vec<f64> {
        let mut gains = vec![1.0; self.exposure.channels.len()];
        for time in self.times {
            gains[time.channels.clone()].fill(time.gain);
        }
        gains
    }

    /// The pictures of the frame: by each film, with its name where there are several, or else by the imager. They are
    /// developed once.
    ///
    /// # Errors
    /// Why there is none, in words.
    pub fn pictures(&self) -> Result<&[Developed], String> {
        self.all().map(|(pictures, _)| &pictures[..])
    }

    /// The picture of the film at a place, or the only one.
    ///
    /// # Errors
    /// [`WriteFault::Format`]: why there is none.
    pub fn picture(&self, film: usize) -> Result<&DisplayPicture, WriteFault> {
        let (pictures, _) = self.all().map_err(WriteFault::Format)?;
        pictures.get(film).map(|(_, picture)| picture).ok_or_else(no_film)
    }

    /// What is known of that picture beside it, as far as an output of the scene wants it ([`crate::Output::wanted`]).
    ///
    /// # Errors
    /// [`WriteFault::Format`]: why there is none.
    pub fn beside(&self, film: usize) -> Result<&Beside, WriteFault> {
        let (_, beside) = self.all().map_err(WriteFault::Format)?;
        beside.get(film).ok_or_else(no_film)
    }

    /// That picture in no gamut, as far as it is known: see [`Beside::open`].
    ///
    /// # Errors
    /// [`WriteFault::Format`]: why there is none.
    pub fn open(&self, film: usize) -> Result<&DisplayPicture, WriteFault> {
        match &self.beside(film)?.open {
            Some(open) => Ok(open),
            None => self.picture(film),
        }
    }

    /// What the values of that picture stand for.
    #[must_use]
    pub fn image_state(&self, film: usize) -> ImageState {
        match self.scene.films.get(film) {
            Some(film) => film.film.image_state(),
            None => self.scene.imager.response().map_or(ImageState::default(), |own| own.image_state()),
        }
    }

    fn all(&self) -> Result<&All, String> {
        self.pictures.get_or_init(|| self.developed()).as_ref().map_err(Clone::clone)
    }

    fn developed(&self) -> Result<All, String> {
        let Self { scene, exposure, .. } = self;
        let outputs = scene.output.iter().map(|output| output.wanted());
        let wanted =
            outputs.fold(Wanted::default(), |a, b| Wanted { open: a.open || b.open, layers: a.layers || b.layers });
        if scene.films.is_empty() {
            let shown = scene.imager.response().and_then(|own| own.finish(exposure, wanted));
            let Finished { shown, mut beside } =
                shown.ok_or_else(|| "this imager shows no picture without a film on it".to_owned())?;
            if wanted.layers {
                let layers = exposure.channels.iter().cloned();
                beside.layers = layers.map(|c| ExposureChannel { name: format!("exposure.{}", c.name), ..c }).collect();
            }
            return Ok((vec![(None, shown)], vec![beside]));
        }
        let of = |(place, film): (usize, &SceneFilm)| -> Result<(Developed, Beside), String> {
            let finish = |exposure: &ExposureFrame| match self.kept {
                None => film.film.finish(exposure, wanted),
                Some(kept) => kept.finish(place, &film.film, exposure),
            };
            let finished = match &film.name {
                // A film alone has the frame for itself.
                None => finish(exposure)?,
                Some(_) => finish(&film.exposure(exposure))?,
            };
            if let Some([x, y]) = no_number(&finished.shown) {
                let film = film.film.name();
                return Err(format!(
                    "{film}: the color of pixel {x}, {y} is not a number: its `develop` made one that is none"
                ));
            }
            let Finished { shown, beside } = finished;
            Ok(((film.name.clone(), shown), beside))
        };
        let all = scene.films.iter().enumerate().map(of).collect::<Result<Vec<_>, String>>()?;
        Ok(all.into_iter().unzip())
    }

    /// Width over height of a pixel of the frame, as it is to be looked at: on the film times the squeeze of the lens.
    #[must_use]
    pub fn pixel_aspect(&self) -> f64 {
        let size = self.exposure.size;
        let aspect = size.width_mm / f64::from(size.width_px) / (size.height_mm / f64::from(size.height_px));
        // As near to square as whole numbers of pixels come.
        let aspect = if (aspect - 1.0).abs() < 0.005 { 1.0 } else { aspect };
        aspect * self.scene.lens.squeeze
    }
}

/// The first pixel, from the left and from the top, with a value that is not a number: files would show it black.
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
