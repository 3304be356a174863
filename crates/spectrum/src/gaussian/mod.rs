//! Gaussian terms and signed sums of them.
//!
//! A term is written as exp(-a x^2 + b x + c) in some papers; in nanometres from 0 that loses everything (c is near
//! -150 000 for a line 1 nm wide at 550 nm), so a [`GaussianTerm`] holds its sign, logarithm of amplitude, center and
//! width, and gives (a, b, c) as a view. Products of terms are terms, and their integrals over a band are exact: so is
//! everything of a [`GaussianMixture`]. Three ways lead to one: terms that are known, the best Gaussian at one point of
//! a function ([`GaussianTerm::local`]), and the best terms for a whole spectrum ([`fit_gaussians`]).

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
