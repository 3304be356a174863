//! Lens files of other programs.
//!
//! - [`read`] takes the bytes of a `.zmx` (Zemax OpticStudio), `.seq` (CODE V) or `.csv` file and gives a
//!   [`Prescription`]: what all of these programs mean by a lens, in millimeters, with a [`Note`] for everything that could
//!   not be carried. Nothing is dropped without a word.
//! - [`yaml::write`] makes a lens file of it, with the notes as comments; [`yaml::read`] goes the other way.
//! - [`zmx::write`] makes a `.zmx` of it.
//!
//! The object and the image surface of those programs are no surfaces of a lens here: the object's distance is a remark, and
//! the thickness behind the last surface is the gap to the image plane. What only chooses rays (fields, wavelengths,
//! vignetting factors) becomes a remark; what limits light (an aperture record, a semi-diameter that was typed in, the stop of a file
//! that floats by its size) clips. An entrance pupil diameter, an f-number and a numerical aperture limit the beam there as the
//! rim of the stop does here: the stop gets the size of their paraxial marginal ray.
//!
//! ```
//! use spectra_exchange::{Format, read, yaml};
//!
//! let zmx = "UNIT MM\nSURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7 0 0 1.5 40\n\
//!            SURF 2\n  CURV -0.02\n  DISZ 47.5\nSURF 3\n  CURV 0\n";
//! let lens = read(Format::Zmx, "lens.zmx", zmx.as_bytes())?;
//! let text = yaml::write(&lens, Some("lens.zmx"));
//! assert!(text.contains("{kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7}"));
//! # Ok::<(), spectra_core::params::Faults>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod csv;
mod decode;
mod glass;
mod number;
mod place;
mod prescription;
mod reference;
mod scale;
pub mod seq;
mod stop;
pub mod yaml;
pub mod zmx;

pub use decode::text;
pub use glass::OwnCatalogue;
pub use prescription::{
    Aperture, ApertureShape, CoordinateBreak, Displacement, FieldKind, Fields, Item, Medium, Note, Ordering,
    Prescription, Shape, Surface, SystemAperture, Wavelength,
};

use spectra_core::params::Faults;

/// Largest file that is read, bytes; UTF-16 doubles the size of a text.
pub const MAX_BYTES: u64 = 16 << 20;

/// Most surfaces and breaks that are read from one file.
pub const MAX_ITEMS: usize = 2000;

/// A kind of lens file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Zemax OpticStudio, sequential.
    Zmx,
    /// CODE V, sequential commands.
    Seq,
    /// A table, one row a surface.
    Csv,
}

impl Format {
    /// By the ending of a file's name, in upper or lower case.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        match ending.to_ascii_lowercase().as_str() {
            "zmx" => Some(Self::Zmx),
            "seq" => Some(Self::Seq),
            "csv" | "tsv" | "txt" => Some(Self::Csv),
            _ => None,
        }
    }

    /// What to write in such a file, so that a surface limits the light: for a hint.
    #[must_use]
    pub fn how_to_clip(self) -> &'static str {
        match self {
            Self::Zmx => {
                "in the .zmx, write an aperture at a surface (`CLAP 0 RADIUS 0`) or 1 behind its semi-diameter (`DIAM RADIUS 1`), or size \
                 its beam (`ENPD DIAMETER`); or convert it by `spectra lens import` and state `semi-diameter` in the lens file"
            }
            Self::Seq => {
                "in the .seq, write an aperture behind a surface (`CIR RADIUS`), or size the beam (`EPD DIAMETER`) and mark the stop (`STO`); \
                 or convert it by `spectra lens import` and state `semi-diameter` in the lens file"
            }
            Self::Csv => "fill a column `semi-diameter` in the table, at least for the first surface",
        }
    }

    /// What to write in such a file, so that a surface is the stop: for a hint.
    #[must_use]
    pub fn how_to_stop(self) -> &'static str {
        match self {
            Self::Zmx => "in the .zmx, write `STOP` among the lines of the surface (`SURF`) that is the stop",
            Self::Seq => "in the .seq, write `STO` behind the surface that is the stop",
            Self::Csv => "in the table, write `stop` in a column `type`, in the row of the stop",
        }
    }
}

/// Reads a lens; `name` is how faults name the file.
///
/// # Errors
/// The file is no lens of this format: too large, no surfaces, a figure that is no number. All faults at once,
/// with line and column.
pub fn read(format: Format, name: &str, bytes: &[u8]) -> Result<Prescription, Faults> {
    read_with(format, name, bytes, &[])
}

/// Reads a lens whose glasses are looked for in these catalogues first.
///
/// # Errors
/// Those of [`read`].
pub fn read_with(format: Format, name: &str, bytes: &[u8], own: &[OwnCatalogue]) -> Result<Prescription, Faults> {
    if bytes.len() as u64 > MAX_BYTES {
        let fault =
            spectra_core::params::Fault::new(format!("{name}: {} bytes, at most {MAX_BYTES} are read", bytes.len()));
        return Err(fault.into());
    }
    let text = decode::text(bytes);
    match format {
        Format::Zmx => zmx::read(name, &text, own),
        Format::Seq => seq::read(name, &text, own),
        Format::Csv => csv::read(name, &text, own),
    }
}
