//! Bundled data that can be used by name: scenes, lenses, film stocks, spectra, coatings, and media from glass catalogues.

use spectra_core::names::{self, Match};
use spectra_film::stock::Stock;
use spectra_glass::Catalog;

/// Kinds of bundled data that a name can refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bundled {
    /// A bundled scene.
    Scene,
    /// A bundled lens.
    Lens,
    /// A film stock, or a print stock.
    Stock,
    /// A bundled spectrum.
    Spectrum,
    /// A glass, or another medium.
    Glass,
}

impl Bundled {
    /// All kinds of bundled data.
    pub const ALL: [Self; 5] = [Self::Scene, Self::Lens, Self::Stock, Self::Spectrum, Self::Glass];

    /// Returns the kind of data in this folder of the bundled files; `None` for other folders.
    #[must_use]
    pub fn in_folder(folder: &str) -> Option<Self> {
        match folder {
            "scenes" => Some(Self::Scene),
            "lenses" => Some(Self::Lens),
            "spectra/film" => Some(Self::Stock),
            _ => None,
        }
    }

    /// Returns the noun of this kind with its article, such as `a lens`.
    #[must_use]
    pub const fn noun(self) -> &'static str {
        match self {
            Self::Scene => "a scene",
            Self::Lens => "a lens",
            Self::Stock => "a film stock",
            Self::Spectrum => "a spectrum",
            Self::Glass => "a glass",
        }
    }

    /// Returns the command that lists the names of this kind.
    #[must_use]
    pub const fn listed_by(self) -> &'static str {
        match self {
            Self::Scene => "spectra list scene",
            Self::Lens => "spectra list lens",
            Self::Stock => "spectra list stock",
            Self::Spectrum => "spectra list spectrum",
            Self::Glass => "spectra list glass",
        }
    }

    /// Returns the names of this kind, without file extensions.
    #[must_use]
    pub fn names(self) -> Vec<String> {
        let files = |folder: &'static str| {
            let all = spectra_data::list(folder).filter_map(move |path| path.strip_prefix(folder));
            all.filter_map(|name| name.strip_suffix(".yaml")).map(str::to_owned).collect()
        };
        match self {
            Self::Scene => files("scenes/"),
            Self::Lens => files("lenses/"),
            Self::Stock => Stock::bundled().map(str::to_owned).collect(),
            Self::Spectrum => spectra_spectrum::bundled_spectra().map(|(name, _)| name.to_owned()).collect(),
            Self::Glass => Catalog::bundled().full_names().collect(),
        }
    }

    /// Finds the one name that `typed` stands for, by the rules of [`spectra_core::names::find`].
    ///
    /// # Errors
    /// All names that it could stand for; an empty list if there is none.
    pub fn find(self, typed: &str) -> Result<String, Vec<String>> {
        if self == Self::Glass {
            return match Catalog::bundled().find(typed) {
                Ok(glass) => Ok(glass.full_name()),
                Err(spectra_glass::FindError::Ambiguous { candidates, .. }) => {
                    Err(candidates.into_iter().map(|c| c.full_name).collect())
                }
                Err(_) => Err(Vec::new()),
            };
        }
        let known = self.names();
        match names::find(typed, known.iter().map(String::as_str)) {
            Match::One(name) => Ok(name.to_owned()),
            Match::Several(several) => Err(several.into_iter().map(str::to_owned).collect()),
            Match::Nothing => Err(Vec::new()),
        }
    }
}

/// Returns the names of the stocks that a scene can be exposed on: all except the print stocks.
#[must_use]
pub fn camera_films() -> Vec<String> {
    let is_print = |name: &str| {
        spectra_data::text(&format!("spectra/film/{name}.yaml"))
            .is_some_and(|text| text.lines().any(|line| line.trim_end() == "process: print"))
    };
    Stock::bundled().filter(|name| !is_print(name)).map(str::to_owned).collect()
}

/// Returns the names of bundled data that `typed` stands for, each with its kind, the likeliest first. `typed` is a whole name,
/// or a part of only one name of a kind. Whole names come before parts. Scenes come last, because they are named after their
/// contents.
#[must_use]
pub fn meanings(typed: &str) -> Vec<(Bundled, String)> {
    let mut found: Vec<(Bundled, String)> =
        Bundled::ALL.into_iter().filter_map(|kind| Some((kind, kind.find(typed).ok()?))).collect();
    let key = names::normalized(typed.trim());
    found.sort_by_key(|(kind, name)| (names::normalized(name) != key, *kind == Bundled::Scene));
    found
}

/// Returns a hint if `typed` is a name of another kind than `wanted`, such as "`kodak-tri-x-400` is a film stock; for a lens,
/// take a name from `spectra list lens`". `None` if it is not.
#[must_use]
pub fn other_kind(typed: &str, wanted: Bundled) -> Option<String> {
    let (kind, name) = meanings(typed).into_iter().find(|(kind, _)| *kind != wanted)?;
    let article = wanted.noun();
    let place = match kind {
        Bundled::Stock => format!(" (in a scene: `film: {{stock: {name}, exposure: 1/60 s}}`)"),
        Bundled::Lens => format!(" (in a scene: `lens: {{file: {name}}}`)"),
        Bundled::Scene | Bundled::Spectrum | Bundled::Glass => String::new(),
    };
    Some(format!("`{name}` is {}{place}; for {article}, take a name from `{}`", kind.noun(), wanted.listed_by()))
}

/// Returns the bundled file of a scene that is called `typed`, such as `biotar-ortho`, `scenes/biotar-ortho.yaml` or a part of
/// one name.
///
/// # Errors
/// All scenes that it could be; an empty list if there is none.
pub(crate) fn scene_file(typed: &str) -> Result<String, Vec<String>> {
    let slashed = typed.replace('\\', "/");
    let inside = slashed.trim_start_matches("./");
    let inside = inside.strip_prefix("scenes/").unwrap_or(inside);
    let stem = inside.strip_suffix(".yaml").or(inside.strip_suffix(".yml")).unwrap_or(inside);
    let whole = format!("scenes/{stem}.yaml");
    if spectra_data::get(&whole).is_some() {
        return Ok(whole);
    }
    // A path of the user's own that does not exist is not a part of a name.
    if stem != inside || stem != slashed {
        return Err(Vec::new());
    }
    Bundled::Scene.find(stem).map(|name| format!("scenes/{name}.yaml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_films_are_no_papers() {
        let films = camera_films();
        assert!(films.len() > 25 && films.len() < Stock::bundled().count(), "{films:?}");
        assert!(
            !films.iter().any(|name| ["kodak-2302", "kodak-endura-premier", "technicolor-iv"].contains(&name.as_str()))
        );
    }

    #[test]
    fn scenes_are_found_as_people_write_them() {
        for typed in [
            "biotar-ortho",
            "biotar-ortho.yaml",
            "scenes/biotar-ortho",
            "./scenes/biotar-ortho.yaml",
            "scenes\\biotar-ortho.yaml",
            "Biotar Ortho",
        ] {
            assert_eq!(scene_file(typed), Ok("scenes/biotar-ortho.yaml".to_owned()), "{typed}");
        }
        assert_eq!(scene_file("zernike"), Ok("scenes/surfaces/zernike.yaml".to_owned()));
        assert!(scene_file("biotar").is_err_and(|several| several.len() > 3));
        for typed in ["", "mine.yaml", "scenes/mine", "folder/biotar-ortho"] {
            assert_eq!(scene_file(typed), Err(Vec::new()), "{typed}");
        }
    }

    #[test]
    fn names_of_another_kind_are_told() {
        let hint = other_kind("Tri-X", Bundled::Lens).expect("a stock");
        assert!(hint.starts_with("`kodak-tri-x-400` is a film stock"), "{hint}");
        assert!(other_kind("biotar-ortho", Bundled::Lens).is_some_and(|hint| hint.contains("is a scene")));
        assert!(other_kind("helios", Bundled::Stock).is_some_and(|hint| hint.contains("`helios-44-58-f2` is a lens")));
        assert_eq!(other_kind("no such thing", Bundled::Lens), None);
    }
}
