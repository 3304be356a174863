//! A picture that was taken: the light of a scene, and what can be made of it.

use crate::{FilmTime, Scene, SceneFilm};
use spectra_core::Isa;
use spectra_core::frame::{DisplayPicture, ExposureFrame};
use spectra_core::sink::WriteFault;
use std::sync::OnceLock;

/// A picture, with the name of its film where there are several.
pub type Developed = (Option<String>, DisplayPicture);

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
    pictures: OnceLock<Result<Vec<Developed>, String>>,
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
        Self { scene, exposure, times, attributes, isa, pictures: OnceLock::new() }
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
        self.pictures.get_or_init(|| self.developed()).as_deref().map_err(Clone::clone)
    }

    /// The picture of the film at a place, or the only one.
    ///
    /// # Errors
    /// [`WriteFault::Format`]: why there is none.
    pub fn picture(&self, film: usize) -> Result<&DisplayPicture, WriteFault> {
        let none = || WriteFault::Format("there is no film at this place".to_owned());
        self.pictures().map_err(WriteFault::Format)?.get(film).map(|(_, picture)| picture).ok_or_else(none)
    }

    fn developed(&self) -> Result<Vec<Developed>, String> {
        let Self { scene, exposure, .. } = self;
        let of = |film: &SceneFilm| match &film.name {
            // A film alone has the frame for itself.
            None => Ok((None, film.film.develop(exposure)?)),
            Some(name) => Ok((Some(name.clone()), film.film.develop(&film.exposure(exposure))?)),
        };
        if scene.films.is_empty() {
            let shown = scene.imager.response().and_then(|own| own.display(exposure));
            let picture = shown.ok_or_else(|| "this imager shows no picture without a film on it".to_owned())?;
            return Ok(vec![(None, picture)]);
        }
        scene.films.iter().map(of).collect()
    }

    /// Width over height of a pixel of the frame.
    #[must_use]
    pub fn pixel_aspect(&self) -> f64 {
        let size = self.exposure.size;
        let aspect = size.width_mm / f64::from(size.width_px) / (size.height_mm / f64::from(size.height_px));
        // As near to square as whole numbers of pixels come.
        if (aspect - 1.0).abs() < 0.005 { 1.0 } else { aspect }
    }
}
