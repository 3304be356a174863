//! For the tests of plugins: stages from YAML, single rays, and the laws that every stage keeps.
//!
//! A stage is built as a scene builds it, through the registry. Its laws are a struct with what the test must know of it;
//! `hold` tries them on thousands of cases that are the same in every run, and panics with the first one that breaks a law.
//!
//! ```ignore
//! use spectra_testing::{SurfaceLaws, assert_fault, surface};
//!
//! #[test]
//! fn keeps_the_laws_of_surfaces() {
//!     SurfaceLaws::default().hold(&*surface("{kind: axicon, angle: 5 deg}"));
//! }
//!
//! #[test]
//! fn an_angle_is_needed() {
//!     assert_fault("surface", "{kind: axicon}", "angle");
//! }
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod build;
mod film;
mod imager;
mod ray;
mod response;
mod sampler;
mod source;
mod spread;
mod surface;
mod system;

pub use build::{assert_fault, color, film, imager, response, source, surface, wavelengths};
pub use film::FilmLaws;
pub use imager::ImagerLaws;
pub use ray::{Line, Rays, ray};
pub use response::ResponseLaws;
pub use sampler::SamplerLaws;
pub use source::SourceLaws;
pub use surface::SurfaceLaws;
pub use system::systems;
