//! Film without a traced ray: pictures are exposed pixel by pixel, and stocks become tables.
//!
//! - [`DevelopSettings`] makes the scene in which a picture file is developed on a film; [`Photograph`] is one such picture;
//! - [`expose`] exposes the film of a scene to its flat picture, as an ideal lens would;
//! - [`FilmPipeline`] takes pictures of single colors on a film: [`Cube`] tabulates them, [`FilmInLight`] compares lights.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod cube;
mod generated;
mod lamp;
mod photograph;
mod pipeline;
mod still;

pub use cube::{Cube, CubeErrors, CubeFile, RANDOM_COLORS};
pub use generated::{is_generated, without_generated_place, without_generated_places};
pub use lamp::FilmInLight;
pub use photograph::{DevelopSettings, PICTURES, Photograph, PictureJob, Setting, is_picture, last_number};
pub use pipeline::FilmPipeline;
pub use still::{LightFrom, expose, expose_still};
