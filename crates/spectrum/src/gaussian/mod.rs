//! Gaussian terms and signed sums of them.
//!
//! Some papers write a term as exp(-a x^2 + b x + c). With x in nanometers from 0 that form loses all precision: c is near -150
//! 000 for a line 1 nm wide at 550 nm. A [`GaussianTerm`] therefore stores its sign, logarithm of amplitude, center and width,
//! and gives (a, b, c) as a view. Products of terms are terms, and their integrals over a band are exact; the same is true of a
//! [`GaussianMixture`]. There are three ways to make one: from known terms, as the best Gaussian at one point of a function
//! ([`GaussianTerm::local`]), or as the best terms for a whole spectrum ([`fit_gaussians`]).

mod fit;
mod local;
mod mixture;
mod one_term;
mod projection;
mod term;

pub use fit::{GaussianFit, GaussianFitReport, fit_gaussians};
pub use local::NoGaussian;
pub use mixture::GaussianMixture;
pub use one_term::OneTerm;
pub use term::GaussianTerm;
