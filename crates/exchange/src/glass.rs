//! Lookup of glasses by the names that other programs give them.

use crate::prescription::Medium;
use spectra_glass::lines::F;
use spectra_glass::{Catalog, FindError, Glass};

/// Largest difference between a stated index and that of a catalog glass for the two to be the same glass.
const SAME_INDEX: f64 = 0.002;

/// Differences in nd and Vd within which a glass is identified by its figures: for figures with all digits, and for the digits that
/// catalogs print.
const SAME_FIGURES: [(f64, f64); 2] = [(1e-9, 1e-6), (6e-6, 6e-3)];

/// Makers by priority, for a name that several makers use if the file does not say which is meant.
const USUAL: [&str; 9] = ["SCHOTT", "OHARA", "HOYA", "HIKARI", "CDGM", "SUMITA", "NHG", "LZOS", "CORNING"];

/// Names in the miscellaneous catalogs of design programs, and the corresponding names here.
const EVERYDAY: [(&str, &str); 28] = [
    ("SILICA", "silica"),
    ("F_SILICA", "silica"),
    // Corning's fused silica.
    ("C79-80", "silica"),
    ("ACRYLIC", "acrylic"),
    ("PMMA", "PMMA"),
    ("POLYCARB", "polycarbonate"),
    ("POLYCARBONATE", "polycarbonate"),
    ("POLYSTYR", "polystyrene"),
    ("POLYSTYRENE", "polystyrene"),
    ("WATER", "water"),
    ("SAPPHIRE", "sapphire"),
    ("SAPHIR", "sapphire"),
    ("CAF2", "calcium fluoride"),
    ("CALCIUM_FLUORIDE", "calcium fluoride"),
    ("MGF2", "magnesium fluoride"),
    ("DIAMOND", "diamond"),
    ("QUARTZ", "quartz"),
    ("CALCITE", "calcite"),
    ("NACL", "salt"),
    ("E48R", "ZeonexE48R"),
    ("ZEONEX_E48R", "ZeonexE48R"),
    ("NOA61", "Norland_NOA-61/Norland"),
    ("NOA-61", "Norland_NOA-61/Norland"),
    ("GERMANIUM", "Ge/Amotchkina"),
    ("ZNSE", "ZnSe/Marple"),
    ("ZNS", "ZnS/Bond"),
    ("BAF2", "BaF2/Malitson"),
    ("LIF", "LiF/Li"),
];

/// A user's own glass catalog, read from an AGF file.
#[derive(Clone, Debug)]
pub struct UserCatalog {
    /// Name of the file, as a lens file refers to it.
    pub file: String,
    /// Glasses of the catalog.
    pub glasses: Vec<Glass>,
}

/// Catalogs in which the names of a file's glasses are searched, in this order, before all bundled ones.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Catalogs<'a> {
    /// The user's own catalogs.
    pub(crate) own: &'a [UserCatalog],
    /// Makers whose catalogs the file names.
    pub(crate) makers: &'a [&'static str],
}

impl Catalogs<'_> {
    /// Returns the glass of the user's own catalogs with this name, as named in a lens file.
    fn user_glass(&self, name: &str, stated: Option<(f64, f64)>) -> Option<Medium> {
        let fits = |glass: &&Glass| glass.name.eq_ignore_ascii_case(name) && fits(glass, stated);
        let of = |own: &UserCatalog| own.glasses.iter().find(fits).map(|glass| format!("{}#{}", own.file, glass.name));
        self.own.iter().find_map(of).map(|name| Medium::Glass { name, nd: None, vd: None })
    }
}

/// Whether a glass is compatible with the nd that a file states.
fn fits(glass: &Glass, stated: Option<(f64, f64)>) -> bool {
    stated.is_none_or(|(nd, _)| (nd - glass.nd()).abs() <= SAME_INDEX)
}

/// Chooses among several glasses of one name: by the stated figures if they identify one, else the first compatible one.
fn chosen(named: &[Glass], stated: Option<(f64, f64)>) -> Option<&Glass> {
    let agrees = |glass: &&Glass, (most_nd, most_vd): (f64, f64)| {
        stated.is_some_and(|(nd, vd)| (nd - glass.nd()).abs() <= most_nd && (vd - glass.vd()).abs() <= most_vd)
    };
    let by_figures = SAME_FIGURES.iter().find_map(|most| named.iter().find(|glass| agrees(glass, *most)));
    by_figures.or_else(|| named.iter().find(|glass| fits(glass, stated)))
}

/// A medium and an optional note: whether the medium changes the path of light, and the text.
pub(crate) struct FoundMedium {
    pub(crate) medium: Medium,
    pub(crate) note: Option<(bool, String)>,
}

/// Returns the maker that a catalog of a design program belongs to: `OHARA_2010`, `OLD_SCHO`, `NIKON-HIKARI`. `None` for collections such
/// as MISC.
pub(crate) fn maker_of_catalogue(catalogue: &str) -> Option<&'static str> {
    let name = catalogue.to_ascii_uppercase();
    // Match the first letters, which is what old programs with short file names keep.
    let marks: [(&str, &str); 12] = [
        ("SCHO", "SCHOTT"),
        ("OHAR", "OHARA"),
        ("HOYA", "HOYA"),
        ("HIKARI", "HIKARI"),
        ("NIKON", "HIKARI"),
        ("CDGM", "CDGM"),
        ("CHENGDU", "CDGM"),
        ("SUMI", "SUMITA"),
        ("NHG", "NHG"),
        ("LZOS", "LZOS"),
        ("CORN", "CORNING"),
        ("ISUZU", "ISUZU"),
    ];
    marks.iter().find(|(mark, _)| name.contains(mark)).map(|(_, maker)| *maker)
}

/// Returns the name in a design program's miscellaneous catalog of a medium that belongs to no maker.
pub(crate) fn everyday_name(full_name: &str) -> Option<&'static str> {
    let catalogue = Catalog::bundled();
    let same = |ours: &str| catalogue.find(ours).is_ok_and(|glass| glass.full_name() == full_name);
    EVERYDAY.iter().find(|(_, ours)| same(ours)).map(|(theirs, _)| *theirs)
}

/// Finds the medium in the catalogs that is nearest to what the file means. `stated` are the nd and Vd that the file gives with the name.
pub(crate) fn look_up(name: &str, stated: Option<(f64, f64)>, catalogues: Catalogs<'_>) -> FoundMedium {
    let quiet = |medium| FoundMedium { medium, note: None };
    if name.eq_ignore_ascii_case("air") {
        return quiet(Medium::Air);
    }
    if name.eq_ignore_ascii_case("vacuum") {
        return quiet(Medium::Glass { name: "vacuum".to_owned(), nd: None, vd: None });
    }
    if let Some(medium) = catalogues.user_glass(name, stated) {
        return quiet(medium);
    }
    match find(name, stated, catalogues.makers) {
        Some((glass, None)) => with_stated(&glass, stated),
        Some((glass, Some(told))) => {
            let found = with_stated(&glass, stated);
            FoundMedium { note: found.note.or(Some(told)), ..found }
        }
        None => match stated {
            Some((nd, vd)) => {
                let text = format!("glass {name} is not in any catalog: carried by its nd {nd} and Vd {vd}");
                let FoundMedium { medium, note } = model(nd, vd);
                FoundMedium { medium, note: note.or(Some((false, text))) }
            }
            None => FoundMedium {
                medium: Medium::Unknown { name: name.to_owned() },
                note: Some((
                    true,
                    format!(
                        "glass {name} is not in any catalog, and the file states no index: write one, or import with a \
                         catalog that has the glass (`spectra lens import --agf FILE`)"
                    ),
                )),
            },
        },
    }
}

/// Returns a glass that is defined by nd and Vd; without dispersion if Vd is not usable.
pub(crate) fn model(nd: f64, vd: f64) -> FoundMedium {
    if nd == 1.0 {
        return FoundMedium { medium: Medium::Air, note: None };
    }
    if (5.0..=200.0).contains(&vd) {
        return FoundMedium { medium: Medium::Model { nd, vd: Some(vd), ng: None }, note: None };
    }
    let note = (vd != 0.0).then(|| (true, format!("an Abbe number of {vd}: carried without dispersion")));
    FoundMedium { medium: Medium::Model { nd, vd: None, ng: None }, note }
}

/// Returns a glass defined by nd, Vd and the deviation of its relative partial dispersion of g and F from the normal line: ng = nF + (P +
/// deviation) (nF - nC).
pub(crate) fn model_off_normal(nd: f64, vd: f64, deviation: f64) -> FoundMedium {
    let mut found = model(nd, vd);
    if deviation != 0.0 {
        match &mut found.medium {
            Medium::Model { nd, vd: Some(vd), ng } => {
                *ng = dispersed(*nd, *vd).map(|(nf, spread)| rounded(nf + (normal_partial(*vd) + deviation) * spread));
            }
            _ => {
                found.note = Some((true, format!("a deviation of {deviation} from the normal line, but no dispersion")))
            }
        }
    }
    found
}

/// Returns the deviation of a glass with these figures from the normal line; 0 if no index at g is stated.
pub(crate) fn deviation(nd: f64, vd: Option<f64>, ng: Option<f64>) -> f64 {
    let off = |vd: f64, ng: f64| {
        let (nf, spread) = dispersed(nd, vd)?;
        Some(rounded((ng - nf) / spread - normal_partial(vd)))
    };
    vd.zip(ng).and_then(|(vd, ng)| off(vd, ng)).unwrap_or(0.0)
}

/// Returns nF and nF - nC of a glass that is defined by nd and Vd alone.
fn dispersed(nd: f64, vd: f64) -> Option<(f64, f64)> {
    let nf = spectra_glass::Medium::from_nd_vd(nd, vd)?.index(F.wavelength_nm);
    Some((nf, (nd - 1.0) / vd))
}

/// Relative partial dispersion of g and F on the normal line through K7 and F2 (SCHOTT, TIE-29: 0.6438 - 0.001682 Vd).
fn normal_partial(vd: f64) -> f64 {
    0.6438 - 0.001_682 * vd
}

/// Rounds to eight decimals, because more would not be meaningful.
fn rounded(value: f64) -> f64 {
    format!("{value:.8}").parse().unwrap_or(value)
}

/// Finds the glass of a name, with a note about the choice if one is needed.
fn find(name: &str, stated: Option<(f64, f64)>, makers: &[&str]) -> Option<(Glass, Option<(bool, String)>)> {
    let catalogue = Catalog::bundled();
    // Skip the search for similar names: some files ask for an unknown name many times.
    let by = |full: &str| match stated {
        _ if !catalogue.knows(full) => Err(FindError::Unknown { name: full.to_owned(), nearest: Vec::new() }),
        Some((nd, vd)) => catalogue.find_with(full, nd, (vd > 0.0).then_some(vd)),
        None => catalogue.find(full),
    };
    // The prefix of a catalog counts more than the list of all catalogs.
    let prefixed = name.get(..3).is_some_and(|prefix| prefix.eq_ignore_ascii_case("LZ_"));
    let named: Vec<Glass> = match prefixed {
        true => Vec::new(),
        false => makers.iter().filter_map(|maker| by(&format!("{maker}/{name}")).ok()).collect(),
    };
    if let Some(glass) = chosen(&named, stated) {
        return Some((glass.clone(), None));
    }
    if let Some(glass) = named.first() {
        // Use another maker's glass of this name if it has the stated index.
        return match by(name) {
            Ok(other) if fits(&other, stated) => {
                let text = format!("{name} is read as {}, which has the stated index", other.full_name());
                Some((other, Some((false, text))))
            }
            _ => Some((glass.clone(), None)),
        };
    }
    match by(name) {
        Ok(glass) => Some((glass, None)),
        Err(FindError::Ambiguous { candidates, .. }) => {
            let of = |maker: &&str| candidates.iter().find(|c| c.full_name.starts_with(&format!("{maker}/")));
            let chosen = makers.iter().chain(&USUAL).find_map(of).or(candidates.first())?;
            let text = format!("{name} is the name of {} glasses: {} is used", candidates.len(), chosen.full_name);
            catalogue.find(&chosen.full_name).ok().map(|glass| (glass, Some((false, text))))
        }
        Err(FindError::Unknown { .. }) => {
            // Molding changes an index in the third decimal.
            if let Some(raw) = name.strip_suffix("_MOLD").filter(|_| stated.is_none()) {
                let (glass, _) = find(raw, None, makers)?;
                let text = format!("{name} is read as {} before molding", glass.full_name());
                return Some((glass, Some((true, text))));
            }
            let (_, ours) = EVERYDAY.iter().find(|(theirs, _)| name.eq_ignore_ascii_case(theirs))?;
            let glass = catalogue.find(ours).ok()?;
            let text = format!("{name} is read as {}", glass.full_name());
            Some((glass, Some((false, text))))
        }
    }
}

/// Returns the glass with the stated figures if they are compatible with it; otherwise without them, and with a note.
fn with_stated(glass: &Glass, stated: Option<(f64, f64)>) -> FoundMedium {
    let name = glass.full_name();
    match stated {
        Some((nd, vd)) if (nd - glass.nd()).abs() <= SAME_INDEX => FoundMedium {
            medium: Medium::Glass { name, nd: Some(nd), vd: (5.0..=200.0).contains(&vd).then_some(vd) },
            note: None,
        },
        Some((nd, _)) => {
            let text = format!("{name} has nd {:.5}; the nd {nd} stated in the file is ignored", glass.nd());
            FoundMedium { medium: Medium::Glass { name, nd: None, vd: None }, note: Some((false, text)) }
        }
        None => FoundMedium { medium: Medium::Glass { name, nd: None, vd: None }, note: None },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(medium: &Medium) -> &str {
        match medium {
            Medium::Glass { name, .. } | Medium::Unknown { name } => name,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn names_of_design_programs() {
        for (theirs, makers, ours) in [
            ("N-BK7", &["SCHOTT"][..], "SCHOTT/N-BK7"),
            ("NBK7", &["SCHOTT"], "SCHOTT/N-BK7"),
            ("BK7", &["SCHOTT"], "SCHOTT/BK7"),
            ("SLAL8", &["OHARA"], "OHARA/S-LAL8"),
            ("F2", &["HOYA"], "HOYA/F2"),
            ("F2", &["SCHOTT", "HOYA"], "SCHOTT/F2"),
            ("SILICA", &["SCHOTT"], "SiO2/Malitson"),
            ("LZ_LF5", &["SCHOTT"], "LZOS/LF5"),
            ("PMMA", &[], "poly_methyl_methacrylate/Sultanova"),
        ] {
            let found = look_up(theirs, None, Catalogs { makers, ..Catalogs::default() });
            assert_eq!(name(&found.medium), ours, "{theirs}");
        }
    }

    /// Among glasses of one name the first catalog has precedence, unless the file states figures to the last digit, which then decide.
    #[test]
    fn figures_choose_among_makers() {
        let catalogue = Catalog::bundled();
        let makers = &["OHARA", "SCHOTT", "HOYA"];
        for full in ["OHARA/F2", "SCHOTT/F2", "HOYA/F2", "OHARA/SK16", "SCHOTT/SK16"] {
            let glass = catalogue.find(full).expect("bundled");
            let stated = Some((glass.nd(), glass.vd()));
            let found = look_up(&glass.name, stated, Catalogs { makers, ..Catalogs::default() });
            assert_eq!(name(&found.medium), full);
        }
        let found = look_up("F2", Some((1.6201, 36.3)), Catalogs { makers, ..Catalogs::default() });
        assert_eq!(name(&found.medium), "OHARA/F2");
    }

    #[test]
    fn what_nobody_knows_is_told() {
        let found = look_up("UNOBTAINIUM", None, Catalogs::default());
        assert_eq!(name(&found.medium), "UNOBTAINIUM");
        assert!(found.note.is_some_and(|(alters, text)| alters && text.contains("UNOBTAINIUM")));
        let found = look_up("UNOBTAINIUM", Some((1.6, 50.0)), Catalogs::default());
        assert_eq!(found.medium, Medium::Model { nd: 1.6, vd: Some(50.0), ng: None });
        assert!(found.note.is_some_and(|(alters, text)| !alters && text.contains("UNOBTAINIUM")));
    }

    #[test]
    fn figures_that_are_not_the_glass_are_told() {
        let found = look_up("N-BK7", Some((1.52, 64.0)), Catalogs::default());
        assert!(matches!(found.medium, Medium::Glass { nd: None, .. }));
        assert!(found.note.is_some_and(|(_, text)| text.contains("1.51680") && text.contains("1.52")));
        let found = look_up("N-BK7", Some((1.5168, 64.17)), Catalogs::default());
        assert!(matches!(found.medium, Medium::Glass { nd: Some(1.5168), vd: Some(64.17), .. }));
    }

    #[test]
    fn catalogues_have_makers() {
        for (catalogue, maker) in [
            ("SCHOTT", Some("SCHOTT")),
            ("OLD_SCHO", Some("SCHOTT")),
            ("ohara_2010", Some("OHARA")),
            ("NIKON-HIKARI", Some("HIKARI")),
            ("MISC", None),
            ("INFRARED", None),
        ] {
            assert_eq!(maker_of_catalogue(catalogue), maker);
        }
    }
}
