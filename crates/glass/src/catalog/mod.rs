//! Media by name, and the nearest glass to an index and an Abbe number.
//!
//! The bundled catalogue stays text: only names are indexed at the start, and a record is parsed when it is asked for.

mod absorption_substitute;
mod check;
mod era;
mod find;
mod nearest;
mod text;

pub use absorption_substitute::{Absorption, AbsorptionSubstitute};
pub use check::{Deviation, LISTED_TOLERANCE_ND, LISTED_TOLERANCE_VD, ListedCheck};
pub use era::{Era, EraError};
pub use find::{Candidate, ChosenGlass, FindError, GlassFacts};
pub use nearest::{Match, Query};

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use thiserror::Error;

use crate::glass::{Category, Glass};
use text::Bundle;

/// A line of a catalogue file that cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("catalogue line {line}: {message}")]
pub struct CatalogError {
    /// Line, from 1.
    pub line: usize,
    /// Message that says what is wrong.
    pub message: String,
}

/// The place of the record of an indexed name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RecordIndex {
    /// Record of the text.
    Text(u32),
    /// A glass added by the user.
    Own(u32),
}

/// A catalogue of glasses and other media by name.
#[derive(Clone, Debug)]
pub struct Catalog {
    bundle: Arc<Bundle>,
    own: Vec<Glass>,
    /// Upper-case names, sorted, with their places.
    index: Vec<(Cow<'static, str>, RecordIndex)>,
    /// The names without hyphens and blanks; made when first asked for.
    squeezed: OnceLock<HashMap<String, Vec<RecordIndex>>>,
}

impl Catalog {
    /// Returns the catalogue that is compiled in: makers' optical glasses, historical ones, filters, crystals, plastics,
    /// liquids, gases; about 4 000 media. It is built once, within a millisecond or two.
    #[must_use]
    pub fn bundled() -> &'static Catalog {
        static BUNDLED: OnceLock<Catalog> = OnceLock::new();
        BUNDLED.get_or_init(|| {
            let text = spectra_data::text("spectra/glass/catalogue.txt").expect("the glass catalogue is bundled");
            Catalog::from_text(text).expect("the bundled catalogue is well-formed: a test reads all of it")
        })
    }

    /// Reads a catalogue from text in the format of `spectra/glass/README.md`.
    ///
    /// # Errors
    /// The first line whose head cannot be read. Records are parsed when they are asked for, and a record that cannot be read
    /// panics then: the text is compiled in, and a test calls [`Catalog::verify`].
    pub fn from_text(text: &'static str) -> Result<Catalog, CatalogError> {
        let bundle = Bundle::new(text)?;
        let mut index: Vec<_> =
            (0..bundle.len()).map(|i| (upper(bundle.name(i)), RecordIndex::Text(i as u32))).collect();
        index.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        Ok(Catalog { bundle: Arc::new(bundle), own: Vec::new(), index, squeezed: OnceLock::new() })
    }

    /// Creates an empty catalogue, for a user's own glasses alone.
    #[must_use]
    pub fn empty() -> Catalog {
        Catalog { bundle: Arc::default(), own: Vec::new(), index: Vec::new(), squeezed: OnceLock::new() }
    }

    /// Adds glasses, such as those of a user's AGF file. A glass replaces an earlier one with the same maker and name.
    pub fn add(&mut self, glasses: impl IntoIterator<Item = Glass>) {
        self.squeezed = OnceLock::new();
        for glass in glasses {
            let name = glass.name.to_uppercase();
            let maker = glass.maker.to_uppercase();
            let same = |(n, place): &(Cow<'static, str>, RecordIndex)| {
                *n == name && self.maker_of(*place).to_uppercase() == maker
            };
            if let Some(at) = self.index.iter().position(same) {
                self.index.remove(at);
            }
            let place = RecordIndex::Own(self.own.len() as u32);
            self.own.push(glass);
            let at = self.index.partition_point(|(n, _)| n.as_ref() <= name.as_str());
            self.index.insert(at, (Cow::Owned(name), place));
        }
    }

    /// Number of media in the catalogue.
    #[must_use]
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Returns whether the catalogue holds no media.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Iterates over all media, sorted by name.
    pub fn glasses(&self) -> impl Iterator<Item = Glass> + '_ {
        self.index.iter().map(|(_, place)| self.glass(*place))
    }

    /// Iterates over all names as `MAKER/NAME`, without reading the media's data.
    pub fn full_names(&self) -> impl Iterator<Item = String> + '_ {
        self.index.iter().map(|(_, place)| format!("{}/{}", self.maker_of(*place), self.name_of(*place)))
    }

    /// Lists the makers (and substances) in alphabetical order.
    #[must_use]
    pub fn makers(&self) -> Vec<String> {
        let mut makers: Vec<_> = self.index.iter().map(|(_, place)| self.maker_of(*place).to_owned()).collect();
        makers.sort_unstable();
        makers.dedup();
        makers
    }

    /// Reads every record of the text.
    ///
    /// # Errors
    /// The first record that cannot be read.
    pub fn verify(&self) -> Result<(), CatalogError> {
        (0..self.bundle.len()).try_for_each(|i| self.bundle.glass(i).map(drop))
    }

    fn glass(&self, place: RecordIndex) -> Glass {
        match place {
            RecordIndex::Own(i) => self.own[i as usize].clone(),
            RecordIndex::Text(i) => self
                .bundle
                .glass(i as usize)
                .expect("records of the bundled catalogue are well-formed: a test reads all of them"),
        }
    }

    fn maker_of(&self, place: RecordIndex) -> &str {
        match place {
            RecordIndex::Own(i) => &self.own[i as usize].maker,
            RecordIndex::Text(i) => self.bundle.maker(i as usize),
        }
    }

    fn category_of(&self, place: RecordIndex) -> Category {
        match place {
            RecordIndex::Own(i) => self.own[i as usize].category,
            RecordIndex::Text(i) => self.bundle.category(i as usize),
        }
    }

    fn name_of(&self, place: RecordIndex) -> &str {
        match place {
            RecordIndex::Own(i) => &self.own[i as usize].name,
            RecordIndex::Text(i) => self.bundle.name(i as usize),
        }
    }
}

/// Converts a name to upper case; borrows it if it is that already.
fn upper(name: &'static str) -> Cow<'static, str> {
    if name.bytes().any(|b| b.is_ascii_lowercase() || !b.is_ascii()) {
        Cow::Owned(name.to_uppercase())
    } else {
        Cow::Borrowed(name)
    }
}
