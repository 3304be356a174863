//! Finds a spectrum by the text that a person writes for it.
//!
//! | written | means |
//! |---|---|
//! | `D65`, `mercury`, `v-lambda-1924` | a bundled file; case, spaces, hyphens and underscores do not matter; a part is enough (`printer`) |
//! | `colorchecker#dark-skin` | a column of a file with several spectra |
//! | `spectra/illuminants/A.csv`, `mine.csv`, `mine.csv#red` | a file beside the scene, else a bundled one; also `.txt`, `.dat`, `.tsv` |
//! | `5600 K`, `3200K` | light of that color temperature: a black body below 5000 K, CIE daylight from there on |
//! | `blackbody:5800` | radiance of a black body of that many kelvin |
//! | `daylight:5500` | CIE daylight of that correlated color temperature, K |
//! | `line:C'`, `line:632.8` | one line, by its letter or its wavelength in nm |
//! | `gaussian:550,20` | center and standard deviation, nm |
//! | `rectangle:500,600` | 1 between two wavelengths, nm |
//! | `constant`, `constant:0.18` | the same value everywhere |
//! | `lines:404.66=1,e=2` | several lines with their powers |
//! | `mine.yaml` | any spectrum described in [`crate::document`]: signed Gaussians, histograms, products ... |
//! | `FdC`, `F'eC'` | the three lines of a set, of equal power |
//! | `rgb-lines` | three lines of the hues of sRGB's primaries that together are white (a form that the color models define) |
//! | `function:exp(-((w - 550) / 20)^4)` | a formula of the wavelength w in nm |
//! | `D65 + 5000 * line:e`, `1 - wratten-25`, `(A + D65) / 2`, `wratten-12^2` | algebra, with spaces around `+ - /`; see [`crate::expression`] |
//!
//! A Gaussian, a rectangle or a constant can be any kind that is wanted: light, filter, surface or detector. In a product only
//! the first factor may be of the wanted kind; the factors after it are filters. Two lights have no product, and only spectra
//! of the same kind can be added. The quotient of two spectra of the same kind is a plain function, and so is a filter's
//! transmittance from a density: `10^(-0.3 * gaussian:550,20)`. Intermediate results may be negative; the final result must
//! not.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::sync::{Arc, Mutex, PoisonError};

use spectra_core::names::{self, Match};
use spectra_core::resources::{ResourceError, Resources};
use spectra_core::spectral::Line;

// A circle with `document.rs`: a name may refer to a document, which names the spectra that it is made of.
use crate::document;

use crate::any_spectrum::AnySpectrum;
use crate::emission::Emission;
use crate::error::SpectrumError;
use crate::expression::{self, Sign, Tree};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::inline;
use crate::meta::{Kind, Meta};
use crate::names::{candidates, normalized};
use crate::pending_spectrum::PendingSpectrum;
use crate::signed_spectrum::SignedSpectrum;
use crate::table::{MAX_BYTES, Table, TableError};
use crate::tabulated::Tabulated;

/// Folders of bundled spectra that can be named without their folder.
const FOLDERS: [&str; 7] = [
    "spectra/illuminants/",
    "spectra/lamps/",
    "spectra/reflectances/",
    "spectra/transmittances/",
    "spectra/cie/",
    "spectra/film/",
    "spectra/sensors/",
];

/// Lists the bundled spectra that can be named: (name, path in the bundled data), in the order of the folders.
pub fn bundled_spectra() -> impl Iterator<Item = (&'static str, &'static str)> {
    FOLDERS.into_iter().flat_map(|folder| {
        spectra_data::list(folder).filter_map(move |path| {
            let name = path.strip_prefix(folder)?.strip_suffix(".csv")?;
            Some((name.rsplit('/').next().unwrap_or(name), path))
        })
    })
}

/// Finds the spectrum `name`; files are looked up in the working directory, then among the bundled data.
///
/// A shape that could be of any kind is taken as light. A table of your own is taken as the kind that its header names
/// (`wavelength_nm,transmittance`), else as light; see [`find_transmittance`] and its siblings.
///
/// # Errors
/// [`SpectrumError`]: an unknown name (with similar names), a faulty file (with row and column), or a file with several columns
/// of which none is chosen.
pub fn find(name: &str) -> Result<AnySpectrum, SpectrumError> {
    Loader { by_header: true, ..Loader::new(None) }.piece(name, Kind::Emission)?.into_any(Kind::Emission)
}

/// Finds the spectrum `name`; files are looked up by `files`: next to the scene, then among the bundled data.
///
/// # Errors
/// As [`find`].
pub fn find_in(name: &str, files: &dyn Resources) -> Result<AnySpectrum, SpectrumError> {
    Loader { by_header: true, ..Loader::new(Some(files)) }.piece(name, Kind::Emission)?.into_any(Kind::Emission)
}

/// Finds the spectrum `name` as a spectrum of the given kind. A file that states no kind is read as this kind.
///
/// # Errors
/// As [`find`], and [`SpectrumError::WrongKind`] for a spectrum of another kind.
pub fn find_as_in(name: &str, kind: Kind, files: &dyn Resources) -> Result<AnySpectrum, SpectrumError> {
    let found = load(name, Some(files), kind)?;
    let same = found.kind() == kind || (kind == Kind::Lines && found.kind() == Kind::Emission);
    if same {
        return Ok(found);
    }
    Err(SpectrumError::WrongKind { name: name.into(), found: found.kind().word(), wanted: kind.word() })
}

/// Finds a column of a table that is neither light, matter nor detector: a color-matching function with negative values, or a
/// component from which spectra are summed. Returns `None` if `name` is no such column.
#[must_use]
pub fn function_in(name: &str, files: &dyn Resources) -> Option<(Kind, Tabulated)> {
    let (file, column) = name.trim().rsplit_once('#')?;
    let table = table(file.trim(), Some(files), Kind::Emission).ok()?;
    let is_function = matches!(table.kind, Kind::ColorMatching | Kind::Components);
    let key = normalized(column);
    let at = table.columns.iter().position(|c| normalized(c) == key).filter(|_| is_function)?;
    Some((table.kind, table.column_at(at)))
}

/// Returns notes on how the table `name` was interpreted if it is not in the format of the bundled tables; see [`Table::notes`].
#[must_use]
pub fn notes_in(name: &str, files: &dyn Resources) -> Vec<&'static str> {
    let name = name.trim();
    let file = name.rsplit_once('#').map_or(name, |(file, _)| file.trim());
    if !is_table(file) {
        return Vec::new();
    }
    table(file, Some(files), Kind::Emission).map_or_else(|_| Vec::new(), |table| table.notes.clone())
}

macro_rules! typed {
    ($plain:ident, $with:ident, $kind:ident, $what:literal) => {
        #[doc = concat!("Finds the ", $what, " `name`; see [`find`].")]
        ///
        /// # Errors
        /// As [`find`], and [`SpectrumError::WrongKind`].
        pub fn $plain(name: &str) -> Result<$kind, SpectrumError> {
            of_kind(name, load(name, None, Kind::$kind)?)
        }

        #[doc = concat!("Finds the ", $what, " `name`; see [`find_in`].")]
        ///
        /// # Errors
        /// As [`find`], and [`SpectrumError::WrongKind`].
        pub fn $with(name: &str, files: &dyn Resources) -> Result<$kind, SpectrumError> {
            of_kind(name, load(name, Some(files), Kind::$kind)?)
        }

        impl TryFrom<AnySpectrum> for $kind {
            type Error = Kind;
            /// Returns the spectrum, or as error the kind that it is of.
            fn try_from(found: AnySpectrum) -> Result<Self, Kind> {
                match found {
                    AnySpectrum::$kind(it) => Ok(it),
                    other => Err(other.kind()),
                }
            }
        }

        impl OfKind for $kind {
            const KIND: Kind = Kind::$kind;
        }
    };
}

typed!(find_emission, find_emission_in, Emission, "light");
typed!(find_transmittance, find_transmittance_in, Transmittance, "filter");
typed!(find_reflectance, find_reflectance_in, Reflectance, "surface");
typed!(find_sensitivity, find_sensitivity_in, Sensitivity, "detector");

trait OfKind: TryFrom<AnySpectrum, Error = Kind> {
    const KIND: Kind;
}

fn of_kind<T: OfKind>(name: &str, found: AnySpectrum) -> Result<T, SpectrumError> {
    let wrong = |kind: Kind| SpectrumError::WrongKind { name: name.into(), found: kind.word(), wanted: T::KIND.word() };
    T::try_from(found).map_err(wrong)
}

fn load(name: &str, files: Option<&dyn Resources>, wanted: Kind) -> Result<AnySpectrum, SpectrumError> {
    Loader::new(files).piece(name, wanted)?.into_any(wanted)
}

/// Returns the front matter of a bundled spectrum or a file: name, source, license, range. Returns `None` for a spectrum that
/// is written inline, and if nothing is found.
#[must_use]
pub fn meta_in(name: &str, files: &dyn Resources) -> Option<Meta> {
    let name = name.trim();
    if !matches!(expression::parse(name), Ok(Tree::Name { .. })) || inline::single(name, Kind::Emission).is_some() {
        return None;
    }
    let file = name.rsplit_once('#').map_or(name, |(file, _)| file.trim());
    if is_yaml(file) {
        return Loader::new(Some(files)).document(file, Kind::Emission).ok().map(|(_, meta)| meta);
    }
    table(file, Some(files), Kind::Emission).ok().map(|table| table.meta.clone())
}

/// Returns the front matter of a bundled spectrum, whatever files are in the working directory.
#[must_use]
pub fn bundled_meta(name: &str) -> Option<Meta> {
    table(name, None, Kind::Emission).ok().map(|table| table.meta.clone())
}

/// Loads spectra that may be made of others, and limits their number.
pub(crate) struct Loader<'a> {
    files: Option<&'a dyn Resources>,
    /// Whether no kind is requested, so that the header of a table decides.
    by_header: bool,
    /// Numbers of spectra that may still be loaded, and of levels that may still be nested.
    left: Cell<u32>,
    depth: Cell<u32>,
}

impl<'a> Loader<'a> {
    /// More than anybody writes, but few enough that a file which names itself fails at once.
    const MOST: u32 = 1000;
    const DEEPEST: u32 = 12;

    fn new(files: Option<&'a dyn Resources>) -> Self {
        Self { files, by_header: false, left: Cell::new(Self::MOST), depth: Cell::new(Self::DEEPEST) }
    }

    /// Counts one more spectrum against the limit.
    pub(crate) fn count(&self, name: &str) -> Result<(), SpectrumError> {
        match self.left.get().checked_sub(1) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(SpectrumError::TooMany(name.chars().take(80).collect())),
        }
    }

    /// Loads the spectrum of a name or expression; a shape stays a shape.
    pub(crate) fn piece(&self, name: &str, wanted: Kind) -> Result<PendingSpectrum, SpectrumError> {
        self.part(name, wanted)?.settled()
    }

    /// Loads the spectrum of a name or expression as a part of a sum, which is checked as a whole later.
    pub(crate) fn part(&self, name: &str, wanted: Kind) -> Result<PendingSpectrum, SpectrumError> {
        let name = name.trim();
        match expression::parse(name)? {
            Tree::Name { text, .. } => self.single(&text, wanted),
            tree => self.value(name, &tree, wanted).map(PendingSpectrum::Signed),
        }
    }

    /// Evaluates an expression. Its first named spectrum may be of the wanted kind; later factors of a product are filters.
    fn value(&self, whole: &str, tree: &Tree, wanted: Kind) -> Result<SignedSpectrum, SpectrumError> {
        let within = |at: usize, len: usize| {
            move |cause: SpectrumError| match cause {
                placed @ SpectrumError::Within { .. } => placed,
                cause => SpectrumError::Within { text: whole.to_owned(), at, len, cause: Box::new(cause) },
            }
        };
        match tree {
            Tree::Number(value) => SignedSpectrum::number(*value),
            Tree::Name { text, at, len } => {
                self.single(text, wanted).map(SignedSpectrum::from).map_err(within(*at, *len))
            }
            Tree::Negative(part) => self.value(whole, part, wanted)?.scaled(-1.0),
            Tree::Joined { sign, at, parts } => {
                let is_filter = matches!(sign, Sign::Times | Sign::Over) && parts[0].has_name();
                let second = if is_filter { Kind::Transmittance } else { wanted };
                let left = self.value(whole, &parts[0], wanted)?;
                let right = self.value(whole, &parts[1], second)?;
                let joined = match sign {
                    Sign::Plus => left.plus(&right),
                    Sign::Minus => left.minus(&right),
                    Sign::Times => left.times(&right),
                    Sign::Over => left.over(&right),
                    Sign::Power => left.to_the_power(&right),
                };
                joined.map_err(within(*at, 1))
            }
        }
    }

    fn single(&self, name: &str, wanted: Kind) -> Result<PendingSpectrum, SpectrumError> {
        self.count(name)?;
        if let Some(piece) = inline::single(name, wanted) {
            return piece;
        }
        let (file, column) = match name.rsplit_once('#') {
            Some((file, column)) => (file.trim(), Some(column.trim())),
            None => (name, None),
        };
        if is_yaml(file) {
            return self.document(name, wanted).map(|(piece, _)| piece);
        }
        // A factor after a light in a product is a filter, whatever its header says.
        let table = if self.by_header && wanted == Kind::Emission {
            table_by(file, self.files, |shown, bytes| Table::parse_by_header(shown, bytes, column, wanted))?
        } else {
            table(file, self.files, wanted)?
        };
        from_table(name, &table, column).map(PendingSpectrum::Typed)
    }

    fn document(&self, name: &str, wanted: Kind) -> Result<(PendingSpectrum, Meta), SpectrumError> {
        let Some(files) = self.files else {
            let cause = "a spectrum in YAML must lie beside a scene; its name alone is not enough".to_owned();
            return Err(SpectrumError::Io { name: name.into(), cause });
        };
        let Some(depth) = self.depth.get().checked_sub(1) else {
            return Err(SpectrumError::TooMany(name.chars().take(80).collect()));
        };
        let file = files.document(name, &["spectra"], &[]).map_err(SpectrumError::Document)?;
        self.depth.set(depth);
        let found = document::of_file(&file, wanted, self, files).map_err(SpectrumError::Document);
        self.depth.set(depth + 1);
        found
    }
}

fn is_yaml(name: &str) -> bool {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    ending.is_some_and(|e| e == "yaml" || e == "yml")
}

/// Returns whether `name` is that of a file with a table.
fn is_table(name: &str) -> bool {
    const ENDINGS: [&str; 6] = ["csv", "txt", "dat", "tsv", "asc", "prn"];
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) || name.contains(['/', '\\'])
}

/// Returns the bundled table of a path; it is read only once.
fn bundled_table(path: &'static str) -> Result<Arc<Table>, SpectrumError> {
    static KNOWN: Mutex<BTreeMap<&'static str, Arc<Table>>> = Mutex::new(BTreeMap::new());
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known().get(path).cloned();
    found.map_or_else(
        || {
            let read = Arc::new(Table::parse_bytes(path, spectra_data::get(path).unwrap_or_default(), None)?);
            known().insert(path, Arc::clone(&read));
            Ok(read)
        },
        Ok,
    )
}

/// Returns the table of a bundled name or of a file.
fn table(name: &str, files: Option<&dyn Resources>, wanted: Kind) -> Result<Arc<Table>, SpectrumError> {
    table_by(name, files, |shown, bytes| Table::parse_bytes(shown, bytes, Some(wanted)))
}

/// Returns the table of a bundled name or of a file; a file is parsed by `parse`.
fn table_by(
    name: &str,
    files: Option<&dyn Resources>,
    parse: impl FnOnce(&str, &[u8]) -> Result<Table, TableError>,
) -> Result<Arc<Table>, SpectrumError> {
    if !is_table(name) {
        let key = normalized(name);
        let fluorescent = key.strip_prefix('f').filter(|n| n.starts_with(|c: char| c.is_ascii_digit()));
        let key = fluorescent.map_or_else(|| name.to_owned(), |n| format!("fl{n}"));
        return match names::find(&key, bundled_spectra().map(|(name, _)| name)) {
            Match::One(found) => {
                let path = bundled_spectra().find(|(name, _)| *name == found).map_or("", |(_, path)| path);
                bundled_table(path)
            }
            Match::Several(several) => Err(SpectrumError::Unknown {
                name: name.chars().take(80).collect(),
                candidates: several.into_iter().take(8).map(str::to_owned).collect(),
            }),
            Match::Nothing => Err(unknown(name)),
        };
    }
    let (shown, bytes) = match files {
        Some(files) => read_resource(name, files)?,
        None => read_file(name)?,
    };
    Ok(Arc::new(parse(&shown, &bytes)?))
}

fn unknown(name: &str) -> SpectrumError {
    let head = |text: &'static str| text.split_once(':').map_or(text, |(head, _)| head);
    let examples = inline::examples();
    let near = match name.split_once(':') {
        Some((wanted, _)) => candidates(wanted, examples.iter().copied().map(head)),
        None => candidates(name, bundled_spectra().map(|(n, _)| n).chain(examples.iter().copied().map(head))),
    };
    let example = |n: String| examples.iter().copied().find(|i| head(i) == n).map_or(n, str::to_owned);
    SpectrumError::Unknown {
        name: name.chars().take(80).collect(),
        candidates: near.into_iter().map(example).collect(),
    }
}

fn read_resource(name: &str, files: &dyn Resources) -> Result<(String, Vec<u8>), SpectrumError> {
    match files.read(name, &["spectra"], &[".csv"], MAX_BYTES) {
        Ok(resource) => Ok((resource.name, resource.bytes.into_owned())),
        Err(ResourceError::NotFound(candidates)) => Err(SpectrumError::Unknown { name: name.into(), candidates }),
        Err(other) => Err(SpectrumError::Io { name: name.into(), cause: other.to_string() }),
    }
}

fn read_file(name: &str) -> Result<(String, Vec<u8>), SpectrumError> {
    let io = |cause: String| SpectrumError::Io { name: name.into(), cause };
    let file = match fs::File::open(name) {
        Ok(file) => file,
        Err(error) => {
            return match spectra_data::get(name) {
                Some(bytes) => Ok((name.into(), bytes.to_vec())),
                None if error.kind() == std::io::ErrorKind::NotFound => Err(unknown(name)),
                None => Err(io(error.to_string())),
            };
        }
    };
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|e| io(e.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(io(format!("more than {MAX_BYTES} bytes")));
    }
    Ok((name.into(), bytes))
}

fn from_table(name: &str, table: &Table, column: Option<&str>) -> Result<AnySpectrum, SpectrumError> {
    let index = match column {
        None if table.columns.len() == 1 => 0,
        None => {
            return Err(SpectrumError::Ambiguous { name: name.into(), columns: table.columns.clone() });
        }
        Some(wanted) => {
            let key = normalized(wanted);
            let at = table.columns.iter().position(|c| normalized(c) == key);
            at.ok_or_else(|| SpectrumError::NoColumn {
                name: table.file.clone(),
                column: wanted.chars().take(80).collect(),
                columns: table.columns.clone(),
            })?
        }
    };
    let values = table.column_at(index);
    Ok(match table.kind {
        Kind::Emission => AnySpectrum::Emission(Emission::tabulated(values)?),
        Kind::Lines => {
            let lines = values.wavelengths_nm().iter().zip(values.values());
            let lines = lines.map(|(w, p)| Line { wavelength_nm: *w, power: *p }).collect();
            AnySpectrum::Emission(Emission::new(None, lines)?)
        }
        Kind::Transmittance => AnySpectrum::Transmittance(Transmittance::from_checked(values)),
        Kind::Reflectance => AnySpectrum::Reflectance(Reflectance::from_checked(values)),
        Kind::Sensitivity => AnySpectrum::Sensitivity(Sensitivity::from_checked(values)),
        // A function that is nowhere negative can serve as a detector; the others cannot.
        Kind::ColorMatching if values.extremes().0 >= 0.0 => {
            AnySpectrum::Sensitivity(Sensitivity::from_checked(values))
        }
        Kind::ColorMatching | Kind::Components => {
            let (found, wanted) = (table.kind.word(), "emission, transmittance, reflectance or sensitivity");
            return Err(SpectrumError::WrongKind { name: name.into(), found, wanted });
        }
    })
}
