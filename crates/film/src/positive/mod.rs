//! From a developed film to a picture: printed on a print stock, scanned, projected, or on a light table.
//!
//! Amounts of dye or silver become a spectral transmittance; light through it exposes the layers of the print stock, or meets
//! a scanner's filters, or the eye. For whole frames the spectral sums are tabulated once, over the amounts.

mod frame;
mod printing;
mod scan;
mod viewing;

pub use scan::{DENSITY_OF_ONE, ScanScale};
pub use viewing::{Viewing, on_band};

use crate::deposit::Deposit;
use crate::emulsion::Emulsion;
use crate::look::{Look, PictureBlack, PictureWhite};
use crate::stock::{Medium, Process, Stock};
use frame::Tables;
use printing::Printing;
use scan::Scan;
use spectra_spectrum::Emission;
use std::sync::OnceLock;

/// A film that cannot be shown as asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PositiveError {
    /// A light that no eye sees.
    #[error("the light is dark to the eye")]
    DarkLight,
    /// A camera film where a print stock is wanted.
    #[error("{stock} is not a print stock")]
    NoPrintStock {
        /// Its name.
        stock: String,
    },
    /// A print stock that cannot be balanced for this negative.
    #[error("{stock}: {reason}")]
    Unbalanced {
        /// The print stock.
        stock: String,
        /// Why.
        reason: &'static str,
    },
    /// A film whose mid gray is no denser than unexposed film.
    #[error("its mid gray is not denser than unexposed film")]
    NoGray,
}

/// How amounts become a picture.
#[derive(Clone, Debug)]
pub struct Positive {
    film: Deposit,
    way: Way,
    /// Smallest and largest amount in each layer.
    ranges: Vec<(f64, f64)>,
    /// Made for the first whole frame: they take longer than all else that is set up.
    tables: OnceLock<Tables>,
}

#[derive(Clone, Debug)]
enum Way {
    Look(Viewing),
    Print(Box<Printing>),
    Scan(Scan),
}

impl Positive {
    /// The film itself in transmitted light: a negative on a light table (the bare light is white), or a slide, projected.
    ///
    /// # Errors
    /// [`PositiveError::DarkLight`].
    pub fn transmitted(stock: &Stock, film: &Emulsion, light: &Emission, look: Look) -> Result<Self, PositiveError> {
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
        Ok(Self::of(film, Way::Look(viewing)))
    }

    /// Printed on `print` (developed as `printed`) by a printer whose lamp has the spectrum `lamp`, balanced for a mid gray
    /// subject that left `gray_lx_s` on the negative, and looked at in `light`. The gray is shown as 18 % of white; in a dark surround
    /// it has the aim densities of the print stock, where it has such.
    ///
    /// # Errors
    /// [`PositiveError`].
    pub fn printed(
        film: &Emulsion,
        gray_lx_s: f64,
        print: &Stock,
        printed: Emulsion,
        lamp: &Emission,
        light: &Emission,
        look: Look,
    ) -> Result<Self, PositiveError> {
        let viewing = seen(print, light, look)?;
        let gray = film.neutral(spectra_core::math::log10(gray_lx_s));
        let unexposed = film.neutral(f64::NEG_INFINITY);
        let printing =
            Printing::balanced(film.deposit(), &unexposed, &gray, print, printed, Some(lamp), viewing, look)?;
        Ok(Self::of(film, Way::Print(Box::new(printing))))
    }

    /// Printed by dye transfer: three separation negatives ([`Emulsion::separations`]), each onto the matrix of one dye of
    /// `print`, whose layers are blue, green and red in this order; balanced for a mid gray subject that left `gray_lx_s` on
    /// each, and looked at as [`Positive::printed`] is.
    ///
    /// # Errors
    /// [`PositiveError`].
    pub fn from_separations(
        film: &Emulsion,
        gray_lx_s: &[f64; 3],
        print: &Stock,
        printed: Emulsion,
        light: &Emission,
        look: Look,
    ) -> Result<Self, PositiveError> {
        if film.layers() != 3 || printed.layers() != 3 {
            return Err(PositiveError::NoPrintStock { stock: print.name.clone() });
        }
        let viewing = seen(print, light, look)?;
        let gray: Vec<f64> =
            gray_lx_s.iter().enumerate().map(|(i, h)| film.amount(i, spectra_core::math::log10(*h))).collect();
        let unexposed = film.neutral(f64::NEG_INFINITY);
        let printing = Printing::balanced(film.deposit(), &unexposed, &gray, print, printed, None, viewing, look)?;
        Ok(Self::of(film, Way::Print(Box::new(printing))))
    }

    /// Scanned: density through the filters of the stock's densitometry. [`ScanScale::Picture`] turns it around along the curves
    /// of a neutral subject, mid gray (`gray_lx_s` on the film) shown as such and unexposed film as black; up to half of white in
    /// proportion to the light of the scene, above under a shoulder that ends where the film does. Channels are shown as the
    /// screen's, unmanaged, as a scanner does without a profile. The other scales are for a file: its values are the scale's.
    ///
    /// # Errors
    /// [`PositiveError::NoGray`].
    pub fn scanned(stock: &Stock, film: &Emulsion, gray_lx_s: f64, scale: ScanScale) -> Result<Self, PositiveError> {
        let scan = Scan::new(stock, film, gray_lx_s, scale)?;
        Ok(Self::of(film, Way::Scan(scan)))
    }

    fn of(film: &Emulsion, way: Way) -> Self {
        let ranges: Vec<(f64, f64)> = (0..film.layers()).map(|i| film.range(i)).collect();
        let deposit = film.deposit().clone();
        Self { film: deposit, way, ranges, tables: OnceLock::new() }
    }

    /// What a place of the film with these amounts is shown as: linear light, sRGB primaries.
    #[must_use]
    pub fn shown(&self, amounts: &[f64]) -> [f64; 3] {
        match &self.way {
            Way::Look(viewing) => viewing.shown(viewing.xyz(&self.film, amounts)),
            Way::Print(printing) => printing.viewing.shown(printing.xyz(&self.film, amounts)),
            Way::Scan(scan) => scan.shown(&scan.densities(&self.film, amounts)),
        }
    }

    /// XYZ of a place, relative to the bare light, where there is an eye in the way: not in a scan.
    #[must_use]
    pub fn xyz(&self, amounts: &[f64]) -> Option<[f64; 3]> {
        match &self.way {
            Way::Look(viewing) => Some(viewing.xyz(&self.film, amounts)),
            Way::Print(printing) => Some(printing.xyz(&self.film, amounts)),
            Way::Scan(_) => None,
        }
    }

    /// The eye that looks at it: none in a scan.
    #[must_use]
    pub fn viewing(&self) -> Option<&Viewing> {
        match &self.way {
            Way::Look(viewing) => Some(viewing),
            Way::Print(printing) => Some(&printing.viewing),
            Way::Scan(_) => None,
        }
    }

    /// Amounts in the print of a place of a negative; `None` where nothing is printed.
    #[must_use]
    pub fn print_amounts(&self, amounts: &[f64]) -> Option<Vec<f64>> {
        match &self.way {
            Way::Print(printing) => Some(printing.printed(&self.film, amounts)),
            Way::Look(_) | Way::Scan(_) => None,
        }
    }

    /// The picture of a whole film: one plane of amounts a layer, of equal length. Within a code value of 8 bits of
    /// Made for the first whole picture: a place alone needs none.
    fn tables(&self) -> &Tables {
        self.tables.get_or_init(|| Tables::new(&self.film, &self.ranges, &self.way))
    }

    /// Densities of the print of a whole negative, layer by layer with their names, as a densitometer reads them ([`densities`]): of paper
    /// and film base with what lies on them. `None` where nothing is printed.
    #[must_use]
    pub fn print_densities(&self, planes: &[&[f32]]) -> Option<Vec<(String, Vec<f32>)>> {
        let Way::Print(printing) = &self.way else { return None };
        let of_silver = |density: f64| printing.printed(&self.film, &[density]);
        let printed = frame::printed(self.tables(), printing.emulsion.layers(), &of_silver, planes);
        let printed: Vec<&[f32]> = printed.iter().map(Vec::as_slice).collect();
        let read = read_through(printing.filters.as_deref(), &printing.emulsion, &printed);
        Some(printing.names.iter().cloned().zip(read).collect())
    }

    /// [`Positive::shown`] for each place.
    #[must_use]
    pub fn picture(&self, planes: &[&[f32]]) -> Vec<[f32; 3]> {
        self.tables().picture(planes, &self.way, Reach::Screen)
    }

    /// The same in no gamut: below 0 what sRGB cannot have, above 1 what is brighter than the film's white. Of a scan on the
    /// scale of a file, the values of that scale.
    #[must_use]
    pub fn open_picture(&self, planes: &[&[f32]]) -> Vec<[f32; 3]> {
        match self.film.layers() {
            // Silver is tabulated as it is shown, dyes as densities.
            1 => Tables::silver(&self.film, &self.way, Reach::Open).picture(planes, &self.way, Reach::Open),
            _ => self.tables().picture(planes, &self.way, Reach::Open),
        }
    }

    /// What a place without any film is shown as: a perforation.
    #[must_use]
    pub fn hole(&self, reach: Reach) -> [f64; 3] {
        match &self.way {
            Way::Look(viewing) => viewing.shown_in(bare(viewing.weights()), reach),
            Way::Print(printing) => printing.viewing.shown_in(printing.hole(), reach),
            Way::Scan(scan) => scan.shown_in(&vec![0.0; scan.weights.len()], reach),
        }
    }
}

/// What receivers see of the bare light.
fn bare(weights: &[Vec<f64>]) -> [f64; 3] {
    [0, 1, 2].map(|i| weights[i].iter().sum())
}

/// Densities of a whole film, of one plane of amounts a layer, as a densitometer reads them through the filters of the stock's
/// densitometry, each layer through that of its own color; of silver its own.
#[must_use]
pub fn densities(stock: &Stock, film: &Emulsion, planes: &[&[f32]]) -> Vec<Vec<f32>> {
    read_through(stock.filters().as_deref(), film, planes)
}

/// [`densities`] through these filters.
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

/// How far the values of a picture go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// As a screen shows them, within sRGB.
    Screen,
    /// As they come.
    Open,
}

/// How a print is looked at. Paper reflects light of the room besides, unless its ends are stretched.
fn seen(print: &Stock, light: &Emission, look: Look) -> Result<Viewing, PositiveError> {
    let viewing = Viewing::by(light).ok_or(PositiveError::DarkLight)?;
    Ok(match print.medium {
        Medium::Film => viewing.surrounded(look.surround),
        Medium::Paper if look.black == PictureBlack::Kept => viewing.with_flare(),
        Medium::Paper => viewing,
    })
}
