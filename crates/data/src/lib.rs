//! Bundled measured data, lenses and scenes, compiled into the binary.
//!
//! A file is named by its path in the repository, with forward slashes: `spectra/illuminants/D65.csv`,
//! `lenses/zeiss-biotar-50-f1.4.yaml`, `scenes/biotar-ortho.yaml`. An installed program therefore needs no data folder.
//!
//! ```
//! let text = spectra_data::text("spectra/illuminants/D65.csv").unwrap();
//! assert!(text.starts_with("# spectra: 1"));
//! assert!(spectra_data::list("spectra/illuminants/").any(|name| name.ends_with("/D65.csv")));
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod licenses;

pub use licenses::{License, licenses};

include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// Returns the content of the bundled file `path`; `None` if there is no such file.
#[must_use]
pub fn get(path: &str) -> Option<&'static [u8]> {
    let at = FILES.binary_search_by(|(name, _)| (*name).cmp(path)).ok()?;
    Some(FILES[at].1)
}

/// Returns the content of the bundled file `path` as text; `None` if there is no such file, or it is not UTF-8.
#[must_use]
pub fn text(path: &str) -> Option<&'static str> {
    std::str::from_utf8(get(path)?).ok()
}

/// Returns the names of all bundled files that begin with `prefix`, in sorted order.
pub fn list(prefix: &str) -> impl Iterator<Item = &'static str> + use<'_> {
    let first = FILES.partition_point(|(name, _)| *name < prefix);
    FILES[first..].iter().map(|(name, _)| *name).take_while(move |name| name.starts_with(prefix))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_unique_so_that_search_finds_each() {
        assert!(FILES.windows(2).all(|w| w[0].0 < w[1].0));
        for (name, bytes) in FILES {
            assert_eq!(get(name), Some(*bytes));
            assert!(!name.contains('\\') && !name.starts_with('/'), "{name}");
        }
    }

    #[test]
    fn unknown_names_are_none() {
        for name in ["", "spectra", "spectra/illuminants/D65", "../Cargo.toml", "spectra/illuminants/D65.csv/"] {
            assert!(get(name).is_none(), "{name}");
        }
    }

    #[test]
    fn list_gives_what_begins_with_the_prefix() {
        assert_eq!(list("").count(), FILES.len());
        assert_eq!(list("spectra/illuminants/D65").collect::<Vec<_>>(), ["spectra/illuminants/D65.csv"]);
        assert_eq!(list("no such").count(), 0);
    }
}
