//! Support for tests of plugins: stages built from YAML, single rays, and the laws that every stage must obey.
//!
//! A stage is built through the registry, as for a scene. Its laws are a struct with the facts that the test must know about the
//! stage. `hold` checks the laws on thousands of cases that are the same in every run, and panics at the first case that breaks one.
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
mod surface;
mod system;
mod test_numbers;

pub use build::{assert_fault, color, film, imager, response, source, surface, wavelengths};
pub use film::FilmLaws;
pub use imager::ImagerLaws;
pub use ray::{Ray, Rays, ray};
pub use response::ResponseLaws;
pub use sampler::SamplerLaws;
pub use source::SourceLaws;
pub use surface::SurfaceLaws;
pub use system::systems;
