//! Lens files of other programs: reading and writing.
//!
//! - [`read`] parses the bytes of a `.zmx` (Zemax OpticStudio), `.seq` (CODE V) or `.csv` file into a [`Prescription`]: what all of these
//!   programs mean by a lens, in millimeters. Everything that could not be carried over is listed as a [`Note`]; nothing is dropped
//!   silently.
//! - [`yaml::write`] writes a prescription as a lens file, with the notes as comments; [`yaml::read`] does the reverse.
//! - [`zmx::write`] writes a prescription as a `.zmx` file.
//!
//! The object and image surfaces of those programs are not surfaces of a lens here. The object distance becomes a remark, and the thickness
//! behind the last surface is the gap to the image plane. Data that only select rays (fields, wavelengths, vignetting factors) become
//! remarks. Data that limit light become clear apertures: an aperture record, a semi-diameter that was typed in, the stop of a file that
//! floats by its size. In those programs an entrance pupil diameter, an f-number or a numerical aperture limits the beam as the rim of the
//! stop does here. The stop therefore gets the size of the paraxial marginal ray.
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
mod prescription;
mod reference;
mod scale;
pub mod seq;
mod source;
mod stop;
pub mod yaml;
pub mod zmx;

pub use decode::text;
pub use glass::UserCatalog;
pub use prescription::{
    Aperture, ApertureShape, AxisItem, CoordinateBreak, Displacement, FieldKind, Fields, Medium, Note, Prescription,
    Surface, SurfaceShape, SystemAperture, Wavelength, ZernikeOrdering,
};

use spectra_core::params::Faults;

/// Size of the largest file that is read, bytes (16 MiB). UTF-16 doubles the size of a text.
pub const MAX_BYTES: u64 = 16 << 20;

/// Largest number of surfaces and coordinate breaks read from one file.
pub const MAX_ITEMS: usize = 2000;

/// A lens file format of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Zemax OpticStudio, sequential mode.
    Zmx,
    /// CODE V, sequential command file.
    Seq,
    /// A table with one row per surface.
    Csv,
}

impl Format {
    /// Returns the format for the extension of a file name, in upper or lower case; `None` if it is unknown.
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

    /// Returns a hint that says what to write in a file of this format so that a surface limits the light.
    #[must_use]
    pub fn how_to_clip(self) -> &'static str {
        match self {
            Self::Zmx => {
                "in the .zmx, add an aperture to a surface (`CLAP 0 RADIUS 0`) or a 1 after its semi-diameter (`DIAM RADIUS 1`), or state \
                 the size of the beam (`ENPD DIAMETER`); or convert it with `spectra lens import` and state `semi-diameter` in the lens file"
            }
            Self::Seq => {
                "in the .seq, add an aperture after a surface (`CIR RADIUS`), or state the size of the beam (`EPD DIAMETER`) and mark the stop \
                 (`STO`); or convert it with `spectra lens import` and state `semi-diameter` in the lens file"
            }
            Self::Csv => "fill in a column `semi-diameter` in the table, at least for the first surface",
        }
    }

    /// Returns a hint that says what to write in a file of this format so that a surface is the stop.
    #[must_use]
    pub fn how_to_stop(self) -> &'static str {
        match self {
            Self::Zmx => "in the .zmx, write `STOP` in the block of the surface (`SURF`) that is the stop",
            Self::Seq => "in the .seq, write `STO` after the surface that is the stop",
            Self::Csv => "in the table, write `stop` in the column `type`, in the row of the stop",
        }
    }
}

/// Reads a lens file. `name` is the name of the file in error messages.
///
/// # Errors
/// The file is no lens of this format: it is too large, has no surfaces, or has a value that is not a number. All faults are
/// reported at once, with line and column.
pub fn read(format: Format, name: &str, bytes: &[u8]) -> Result<Prescription, Faults> {
    read_with(format, name, bytes, &[])
}

/// Reads a lens file whose glasses are searched for in the catalogs `own` first. `name` is the name of the file in error
/// messages.
///
/// # Errors
/// The same as for [`read`].
pub fn read_with(format: Format, name: &str, bytes: &[u8], own: &[UserCatalog]) -> Result<Prescription, Faults> {
    if bytes.len() as u64 > MAX_BYTES {
        let fault =
            spectra_core::params::Fault::new(format!("{name}: {} bytes; at most {MAX_BYTES} can be read", bytes.len()));
        return Err(fault.into());
    }
    let text = decode::text(bytes);
    match format {
        Format::Zmx => zmx::read(name, &text, own),
        Format::Seq => seq::read(name, &text, own),
        Format::Csv => csv::read(name, &text, own),
    }
}
