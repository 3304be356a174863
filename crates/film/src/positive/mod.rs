//! Converts a developed film to a picture: printed on a print stock, scanned, projected, or on a light table.
//!
//! Amounts of dye or silver give a spectral transmittance. Light through the film exposes the layers of the print stock, or reaches a
//! scanner's filters, or the eye. For whole frames, the spectral sums are tabulated once over the amounts, so a frame costs table look-ups.
//!
//! A color print is timed to the aim densities of its stock. A projection is seen in the dark, and shown in a lit room by an exponent of
//! luminance ([`Surround::exponent`](crate::viewing_options::Surround::exponent)).

mod frame;
mod printing;
mod scan;
mod viewing;

pub use scan::{DENSITY_OF_ONE, ScanScale};
pub use viewing::{Viewing, on_band};

use crate::deposit::Deposit;
use crate::emulsion::Emulsion;
use crate::stock::{Medium, Process, Stock};
use crate::viewing_options::{PictureBlack, PictureWhite, ViewingOptions};
use frame::Tables;
use printing::Printing;
use scan::Scan;
use spectra_spectrum::Emission;
use std::sync::OnceLock;

/// A film that cannot be shown as requested.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PositiveError {
    /// The light is invisible.
    #[error("the light is invisible to the eye")]
    DarkLight,
    /// The stock is a camera film, but a print stock is needed.
    #[error("{stock} is not a print stock")]
    NoPrintStock {
        /// Name of the stock.
        stock: String,
    },
    /// The print stock cannot be balanced for this negative.
    #[error("{stock}: {reason}")]
    Unbalanced {
        /// Name of the print stock.
        stock: String,
        /// Reason why it cannot be balanced.
        reason: &'static str,
    },
    /// The film's mid gray is not denser than unexposed film.
    #[error("its mid gray is not denser than unexposed film")]
    NoGray,
}

/// A process that converts amounts of dye or silver to a picture.
#[derive(Clone, Debug)]
pub struct Positive {
    film: Deposit,
    way: PositiveKind,
    /// Smallest and largest amount in each layer.
    ranges: Vec<(f64, f64)>,
    /// Tables for whole frames, built on first use: they take longer than all other preparation.
    tables: OnceLock<Tables>,
}

#[derive(Clone, Debug)]
enum PositiveKind {
    Look(Viewing),
    Print(Box<Printing>),
    Scan(Scan),
}

impl Positive {
    /// Prepares the film itself in transmitted light: a negative on a light table (the bare light is white), or a slide,
    /// projected. `film` is the developed `stock`, and `light` shines through it. `look` sets white, black and surround.
    ///
    /// # Errors
    /// [`PositiveError::DarkLight`] if the light is invisible.
    pub fn transmitted(
        stock: &Stock,
        film: &Emulsion,
        light: &Emission,
        look: ViewingOptions,
    ) -> Result<Self, PositiveError> {
        let mut viewing = Viewing::by(light).ok_or(PositiveError::DarkLight)?;
        if stock.process == Process::Reversal {
            let of = |end: fn((f64, f64)) -> f64| {
                let amounts: Vec<f64> = (0..film.layers()).map(|i| end(film.range(i))).collect();
                viewing.xyz(film.deposit(), &amounts)
            };
            let white = if look.white == PictureWhite::Film { of(|range| range.0) } else { viewing.white() };
            let black = if look.black == PictureBlack::Stretched { of(|range| range.1)[1] } else { 0.0 };
            viewing = viewing.between(black, white).surrounded(look.surround);
        }
        Ok(Self::of(film, PositiveKind::Look(viewing)))
    }

    /// Prepares a print on `print` (developed as `printed`), made with a lamp of the spectrum `lamp` and viewed in `light`.
    ///
    /// The print is balanced for a mid gray subject that left `gray_lx_s` on the negative. The gray is shown as 18 % of white; in a dark
    /// surround it has the aim densities of the print stock, if it has any.
    ///
    /// # Errors
    /// [`PositiveError`]: the light is invisible, `print` is not a print stock, or it cannot be balanced.
    pub fn printed(
        film: &Emulsion,
        gray_lx_s: f64,
        print: &Stock,
        printed: Emulsion,
        lamp: &Emission,
        light: &Emission,
        look: ViewingOptions,
    ) -> Result<Self, PositiveError> {
        let viewing = print_viewing(print, light, look)?;
        let gray = film.neutral(spectra_core::math::log10(gray_lx_s));
        let unexposed = film.neutral(f64::NEG_INFINITY);
        let printing =
            Printing::balanced(film.deposit(), &unexposed, &gray, print, printed, Some(lamp), viewing, look)?;
        Ok(Self::of(film, PositiveKind::Print(Box::new(printing))))
    }

    /// Prepares a dye transfer print: three separation negatives ([`Emulsion::separations`]), each printed onto the matrix of one dye of
    /// `print`.
    ///
    /// The layers of `print` are blue, green and red in this order. The print is balanced for a mid gray subject that left `gray_lx_s` on
    /// each negative, and viewed as in [`Positive::printed`].
    ///
    /// # Errors
    /// [`PositiveError`]: the light is invisible, `print` is not a print stock of three layers, or it cannot be balanced.
    pub fn from_separations(
        film: &Emulsion,
        gray_lx_s: &[f64; 3],
        print: &Stock,
        printed: Emulsion,
        light: &Emission,
        look: ViewingOptions,
    ) -> Result<Self, PositiveError> {
        if film.layers() != 3 || printed.layers() != 3 {
            return Err(PositiveError::NoPrintStock { stock: print.name.clone() });
        }
        let viewing = print_viewing(print, light, look)?;
        let gray: Vec<f64> =
            gray_lx_s.iter().enumerate().map(|(i, h)| film.amount(i, spectra_core::math::log10(*h))).collect();
        let unexposed = film.neutral(f64::NEG_INFINITY);
        let printing = Printing::balanced(film.deposit(), &unexposed, &gray, print, printed, None, viewing, look)?;
        Ok(Self::of(film, PositiveKind::Print(Box::new(printing))))
    }

    /// Prepares a scan: density through the filters of the stock's densitometry.
    ///
    /// [`ScanScale::Picture`] inverts the density along the curves of a neutral subject. Mid gray (`gray_lx_s` on the film) is shown as
    /// such, and unexposed film as black.
    /// Up to half of white, the picture is proportional to the light of the scene; above, a shoulder ends where the film does. Channels are
    /// shown as those of the screen, unmanaged, like a scanner without a profile.
    /// The other scales are for files, whose values are those of the scale.
    ///
    /// # Errors
    /// [`PositiveError::NoGray`] if mid gray is not denser than unexposed film.
    pub fn scanned(stock: &Stock, film: &Emulsion, gray_lx_s: f64, scale: ScanScale) -> Result<Self, PositiveError> {
        let scan = Scan::new(stock, film, gray_lx_s, scale)?;
        Ok(Self::of(film, PositiveKind::Scan(scan)))
    }

    fn of(film: &Emulsion, way: PositiveKind) -> Self {
        let ranges: Vec<(f64, f64)> = (0..film.layers()).map(|i| film.range(i)).collect();
        let deposit = film.deposit().clone();
        Self { film: deposit, way, ranges, tables: OnceLock::new() }
    }

    /// Returns the color of a place of the film with these amounts: linear light, sRGB primaries.
    #[must_use]
    pub fn shown(&self, amounts: &[f64]) -> [f64; 3] {
        match &self.way {
            PositiveKind::Look(viewing) => viewing.to_screen(viewing.xyz(&self.film, amounts)),
            PositiveKind::Print(printing) => printing.viewing.to_screen(printing.xyz(&self.film, amounts)),
            PositiveKind::Scan(scan) => scan.shown(&scan.densities(&self.film, amounts)),
        }
    }

    /// Returns XYZ of a place, relative to the bare light; `None` for a scan, which no eye views.
    #[must_use]
    pub fn xyz(&self, amounts: &[f64]) -> Option<[f64; 3]> {
        match &self.way {
            PositiveKind::Look(viewing) => Some(viewing.xyz(&self.film, amounts)),
            PositiveKind::Print(printing) => Some(printing.xyz(&self.film, amounts)),
            PositiveKind::Scan(_) => None,
        }
    }

    /// Viewing conditions of the film or its print; `None` for a scan, which no eye views.
    #[must_use]
    pub fn viewing(&self) -> Option<&Viewing> {
        match &self.way {
            PositiveKind::Look(viewing) => Some(viewing),
            PositiveKind::Print(printing) => Some(&printing.viewing),
            PositiveKind::Scan(_) => None,
        }
    }

    /// Returns the amounts in the print for a place of a negative; `None` if nothing is printed.
    #[must_use]
    pub fn print_amounts(&self, amounts: &[f64]) -> Option<Vec<f64>> {
        match &self.way {
            PositiveKind::Print(printing) => Some(printing.printed(&self.film, amounts)),
            PositiveKind::Look(_) | PositiveKind::Scan(_) => None,
        }
    }

    /// Tables for whole pictures, built on first use: a single place needs none. They are accurate to a code value of 8 bits.
    fn tables(&self) -> &Tables {
        self.tables.get_or_init(|| Tables::new(&self.film, &self.ranges, &self.way))
    }

    /// Computes the densities of the print of a whole negative, layer by layer with their names, as a densitometer reads them
    /// ([`densities`]), including paper or film base. `None` if nothing is printed.
    #[must_use]
    pub fn print_densities(&self, planes: &[&[f32]]) -> Option<Vec<(String, Vec<f32>)>> {
        let PositiveKind::Print(printing) = &self.way else { return None };
        let of_silver = |density: f64| printing.printed(&self.film, &[density]);
        let printed = frame::printed(self.tables(), printing.emulsion.layers(), &of_silver, planes);
        let printed: Vec<&[f32]> = printed.iter().map(Vec::as_slice).collect();
        let read = read_through(printing.filters.as_deref(), &printing.emulsion, &printed);
        Some(printing.names.iter().cloned().zip(read).collect())
    }

    /// Computes the picture of a whole film, [`Positive::shown`] for each place. `planes` holds a plane of amounts per layer, of equal
    /// length.
    #[must_use]
    pub fn picture(&self, planes: &[&[f32]]) -> Vec<[f32; 3]> {
        self.tables().picture(planes, &self.way, GamutLimit::Screen)
    }

    /// Computes the picture of a whole film without gamut limits: below 0 for colors outside sRGB, above 1 where it is brighter than the
    /// film's white. For a scan on a file scale, returns the values of that scale.
    #[must_use]
    pub fn unclamped_picture(&self, planes: &[&[f32]]) -> Vec<[f32; 3]> {
        match self.film.layers() {
            // Silver is tabulated as shown, dyes as densities.
            1 => Tables::silver(&self.film, &self.way, GamutLimit::Open).picture(planes, &self.way, GamutLimit::Open),
            _ => self.tables().picture(planes, &self.way, GamutLimit::Open),
        }
    }

    /// Returns the color of a place without any film, for example a perforation.
    #[must_use]
    pub fn hole(&self, reach: GamutLimit) -> [f64; 3] {
        match &self.way {
            PositiveKind::Look(viewing) => viewing.shown_in(bare(viewing.weights()), reach),
            PositiveKind::Print(printing) => printing.viewing.shown_in(printing.hole(), reach),
            PositiveKind::Scan(scan) => scan.shown_in(&vec![0.0; scan.weights.len()], reach),
        }
    }
}

/// Sums that the receivers measure in the bare light.
fn bare(weights: &[Vec<f64>]) -> [f64; 3] {
    [0, 1, 2].map(|i| weights[i].iter().sum())
}

/// Computes the densities of a whole film, from a plane of amounts per layer, as a densitometer reads them: each layer through the filter
/// of its own color in the stock's densitometry. For silver, these are the amounts.
#[must_use]
pub fn densities(stock: &Stock, film: &Emulsion, planes: &[&[f32]]) -> Vec<Vec<f32>> {
    read_through(stock.filters().as_deref(), film, planes)
}

/// Computes [`densities`] through these filters.
fn read_through(filters: Option<&[Vec<f64>]>, film: &Emulsion, planes: &[&[f32]]) -> Vec<Vec<f32>> {
    match (planes, filters) {
        ([a, b, c], Some(filters)) => {
            let ranges: Vec<(f64, f64)> = (0..film.layers()).map(|i| film.range(i)).collect();
            let seen = frame::seen(film.deposit(), &ranges, filters, [a, b, c]);
            (0..3).map(|i| seen.iter().map(|d| d[i]).collect()).collect()
        }
        _ => planes.iter().map(|plane| plane.to_vec()).collect(),
    }
}

/// Range of the values of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GamutLimit {
    /// Values within sRGB, as a screen shows them.
    Screen,
    /// Values without limits.
    Open,
}

/// Viewing conditions of a print. Paper also reflects light of the room, unless its black is stretched.
fn print_viewing(print: &Stock, light: &Emission, look: ViewingOptions) -> Result<Viewing, PositiveError> {
    let viewing = Viewing::by(light).ok_or(PositiveError::DarkLight)?;
    Ok(match print.medium {
        Medium::Film => viewing.surrounded(look.surround),
        Medium::Paper if look.black == PictureBlack::Kept => viewing.with_flare(),
        Medium::Paper => viewing,
    })
}
