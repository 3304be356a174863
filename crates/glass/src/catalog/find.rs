//! Search for a medium by its name.

use spectra_core::names;
use std::collections::{BTreeSet, HashMap};
use std::fmt;

use thiserror::Error;

use super::{Catalog, RecordIndex};
use crate::formula::Formula;
use crate::glass::{Category, Glass};
use crate::lines::LineTriple;
use crate::medium::Medium;

/// A medium that may have been meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Full name: `MAKER/NAME`.
    pub full_name: String,
    /// Index at the d line.
    pub nd: f64,
    /// Abbe number for the lines d, F and C.
    pub vd: f64,
}

impl fmt::Display for Candidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.nd.is_finite() && self.vd.is_finite() && self.vd.abs() < 1000.0 {
            write!(f, "{} (nd {:.5}, Vd {:.2})", self.full_name, self.nd, self.vd)
        } else {
            f.write_str(&self.full_name)
        }
    }
}

/// Reason why a name does not mean exactly one medium.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FindError {
    /// No medium has this name.
    #[error("no glass `{name}`{}", if nearest.is_empty() { String::new() } else { format!("; nearest names: {}", list(nearest)) })]
    Unknown {
        /// Name that was asked for.
        name: String,
        /// The nearest names, in descending order of similarity.
        nearest: Vec<Candidate>,
    },
    /// Several media have this name.
    #[error("`{name}` is the name of {} glasses; write one of: {}", candidates.len(), list(candidates))]
    Ambiguous {
        /// Name that was asked for.
        name: String,
        /// All media that have the name.
        candidates: Vec<Candidate>,
    },
}

impl FindError {
    /// Returns the message without the list of candidates; [`FindError::hint`] says what to write instead.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Unknown { name, .. } => format!("no glass `{name}`"),
            Self::Ambiguous { name, candidates } => format!("`{name}` is the name of {} glasses", candidates.len()),
        }
    }

    /// Returns the hint that says what to write instead.
    #[must_use]
    pub fn hint(&self) -> String {
        match self {
            Self::Unknown { name, .. } if name.parse::<f64>().is_ok_and(|nd| (1.0..=4.0).contains(&nd)) => {
                format!("write `nd: {name}`, or with its Abbe number `glass: {{nd: {name}, vd: ...}}`")
            }
            Self::Unknown { name, nearest }
                if PLASTICS_NOT_HELD.iter().any(|p| p.eq_ignore_ascii_case(name.trim())) =>
            {
                format!("the catalogue has no data of this plastic; it has these plastics: {}", list(nearest))
            }
            Self::Unknown { nearest, .. } => match nearest.as_slice() {
                [] => {
                    "write a glass of a catalogue, such as SCHOTT/N-BK7, or a file of your own, such as `my-glass.yaml`"
                        .to_owned()
                }
                [one] => format!("did you mean `{}`?", one.full_name),
                [first, others @ ..] => format!("did you mean `{}`? Similar: {}", first.full_name, list(others)),
            },
            Self::Ambiguous { name, candidates } => {
                let names: Vec<String> = candidates.iter().map(ToString::to_string).collect();
                format!("write one of {}", names::listed(&names, &format!("spectra list glass {}", name.trim())))
            }
        }
    }
}

fn list(candidates: &[Candidate]) -> String {
    candidates.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Number of names that an error lists.
const LISTED: usize = 6;

/// Other spellings of makers in old and foreign catalogues, and in the files of optical design programs.
const MAKERS: [(&str, &str); 7] = [
    ("LZ", "LZOS"),
    ("NIKON", "HIKARI"),
    ("NIKON-HIKARI", "HIKARI"),
    ("CORNING-FRANCE", "CORNING"),
    ("JENA", "SCHOTT"),
    ("CHENGDU", "CDGM"),
    ("SCHOTT-GLAS", "SCHOTT"),
];

/// Usual plastics for which the catalogue has no data; similar names are something else.
const PLASTICS_NOT_HELD: [&str; 6] = ["PES", "PP", "PE", "ABS", "PTFE", "PSU"];

/// Makers in the order in which they are preferred, if several have the name and nothing else decides.
const USUAL: [&str; 9] = ["SCHOTT", "OHARA", "HOYA", "HIKARI", "CDGM", "SUMITA", "NHG", "LZOS", "CORNING"];
/// Year of the oldest list of the catalogue; the glasses in it existed before, too.
const OLDEST_LIST: u16 = 1983;

/// Facts that are known about a glass in addition to its name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlassFacts<'a> {
    /// Index and perhaps Abbe number, with the lines that belong to them.
    pub figures: Option<(f64, Option<f64>, LineTriple)>,
    /// Maker of the lens, or of the glass.
    pub maker: Option<&'a str>,
    /// Year of the lens.
    pub year: Option<i32>,
}

/// A glass that was chosen by its name and the facts beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenGlass {
    /// The glass.
    pub glass: Glass,
    /// Note for the user, if several glasses were equally likely.
    pub note: Option<String>,
}

impl Catalog {
    /// Finds the medium `name`: `SCHOTT/N-BK7`; `N-BK7` if only one maker has it; an everyday name such as `water` or `PC`; or a
    /// substance of which there is one measurement. Case does not matter unless it tells two media apart (`BaF2` is the crystal,
    /// `BAF2` a flint; `LaF3` may be either). The name of a crystal means the formula that its everyday name stands for, not a
    /// maker's rounded table (`CRYSTRAN/CaF2`). If no name matches, hyphens, underscores, blanks and dots are ignored: `LZ_LF5`
    /// is `LZOS/LF5`.
    ///
    /// # Errors
    /// No medium or several media have the name; the error lists candidates.
    pub fn find(&self, name: &str) -> Result<Glass, FindError> {
        let places = self.places(name);
        match places[..] {
            [place] => Ok(self.glass(place)),
            [] => Err(self.unknown(name)),
            _ => Err(self.ambiguous(name, &places)),
        }
    }

    /// Returns whether at least one medium has the name. It is quick, because it looks for no similar names.
    #[must_use]
    pub fn knows(&self, name: &str) -> bool {
        !self.places(name).is_empty()
    }

    /// Finds a medium like [`Catalog::find`]. The names `air` and `vacuum` mean these media as a lens uses them (air has index
    /// 1).
    ///
    /// # Errors
    /// As [`Catalog::find`].
    pub fn medium(&self, name: &str) -> Result<Medium, FindError> {
        match name.trim() {
            name if name.eq_ignore_ascii_case("air") => Ok(Medium::Air),
            name if name.eq_ignore_ascii_case("vacuum") => Ok(Medium::Vacuum),
            name => self.find(name).map(Medium::from),
        }
    }

    /// Finds a medium by its name and its index `nd`, and its Abbe number `vd` if known, as a patent or a lens file states them.
    /// If several media have the name, it takes the nearest. That must be within 0.002 in nd and, if `vd` is given, within 2 % in
    /// Vd.
    ///
    /// # Errors
    /// As [`Catalog::find`]; also if none of several media with the name is that near.
    pub fn find_with(&self, name: &str, nd: f64, vd: Option<f64>) -> Result<Glass, FindError> {
        let places = self.places(name);
        match places[..] {
            [place] => Ok(self.measured(name, place, (nd, vd, LineTriple::FDC)).glass),
            [] => Err(self.unknown(name)),
            _ => self.nearest_of(&places, nd, vd, LineTriple::FDC).ok_or_else(|| self.ambiguous(name, &places)),
        }
    }

    /// Chooses one of several glasses with the same name by the facts `beside` it. First choice is the glass that has the stated
    /// figures, as in [`Catalog::find_with`], then the glass of the lens's maker, if that maker made glass. Next is the only
    /// glass of the lens's time, then, with a note, the glass of the maker preferred by default.
    ///
    /// # Errors
    /// An unknown name; a name of several glasses of which none has the stated figures; several measurements of a substance.
    pub fn choose(&self, name: &str, beside: GlassFacts<'_>) -> Result<ChosenGlass, FindError> {
        let places = self.places(name);
        let quiet = |glass: Glass| Ok(ChosenGlass { glass, note: None });
        match (&places[..], beside.figures) {
            (&[place], Some(figures)) => return Ok(self.measured(name, place, figures)),
            (&[place], None) => return quiet(self.glass(place)),
            ([], _) => return Err(self.unknown(name)),
            _ => {}
        }
        if let Some((n, v, lines)) = beside.figures {
            let near = self.nearest_of(&places, n, v, lines);
            return near.map_or_else(|| Err(self.ambiguous(name, &places)), quiet);
        }
        let glasses: Vec<Glass> = places.iter().map(|place| self.glass(*place)).collect();
        if glasses.iter().any(|glass| !glass.category.is_glass()) {
            return Err(self.ambiguous(name, &places));
        }
        let words = beside.maker.unwrap_or_default().to_uppercase();
        let by_maker =
            words.split(|c: char| !c.is_alphanumeric() && c != '-').filter(|word| !word.is_empty()).find_map(|word| {
                let maker = our_maker(word);
                glasses.iter().find(|glass| same_name(&glass.maker, &maker))
            });
        if let Some(glass) = by_maker {
            return quiet(glass.clone());
        }
        if let Some(year) = beside.year {
            let listed = |glass: &&Glass| {
                glass.years.is_some_and(|(first, last)| {
                    i32::from(first) <= year.max(i32::from(OLDEST_LIST))
                        && year <= i32::from(last).max(i32::from(OLDEST_LIST))
                })
            };
            let mut of_time = glasses.iter().filter(listed);
            if let (Some(glass), None) = (of_time.next(), of_time.next()) {
                return quiet(glass.clone());
            }
        }
        let rank = |glass: &Glass| USUAL.iter().position(|maker| same_name(maker, &glass.maker)).unwrap_or(USUAL.len());
        let Some(glass) = glasses.iter().min_by_key(|glass| rank(glass)) else { return Err(self.unknown(name)) };
        let others: Vec<String> =
            glasses.iter().filter(|other| *other != glass).map(|other| candidate(other).to_string()).collect();
        let note = format!(
            "`{name}` is the name of {} glasses; {} is used. If another is meant, write its maker: {}",
            glasses.len(),
            candidate(glass),
            names::listed(&others, &format!("spectra list glass {}", name.trim()))
        );
        Ok(ChosenGlass { glass: glass.clone(), note: Some(note) })
    }

    /// Lists all media whose name, maker or everyday name contains `fragment`, sorted by name. Case, hyphens and blanks are
    /// ignored.
    #[must_use]
    pub fn search(&self, fragment: &str) -> Vec<Glass> {
        let (maker, fragment) = fragment.split_once('/').map_or((None, fragment), |(maker, rest)| (Some(maker), rest));
        let (maker, wanted) = (maker.map(squeeze), squeeze(fragment));
        let has = |place: RecordIndex| {
            let own_maker = squeeze(self.maker_of(place));
            let in_name = squeeze(self.name_of(place)).contains(&wanted);
            maker.as_ref().map_or(in_name || own_maker.contains(&wanted), |maker| own_maker.contains(maker) && in_name)
        };
        let mut found: Vec<RecordIndex> =
            self.index.iter().map(|(_, place)| *place).filter(|place| has(*place)).collect();
        for (alias, target) in self.bundle.aliases() {
            if maker.is_none() && squeeze(alias).contains(&wanted) {
                let more = self.places(target);
                found.extend(more.into_iter().filter(|place| !found.contains(place)).collect::<Vec<_>>());
            }
        }
        found.into_iter().map(|place| self.glass(place)).collect()
    }

    fn unknown(&self, name: &str) -> FindError {
        FindError::Unknown { name: name.to_owned(), nearest: self.nearest_names(name) }
    }

    fn ambiguous(&self, name: &str, places: &[RecordIndex]) -> FindError {
        FindError::Ambiguous { name: name.to_owned(), candidates: self.candidates(places) }
    }

    fn nearest_of(&self, places: &[RecordIndex], n: f64, v: Option<f64>, lines: LineTriple) -> Option<Glass> {
        let far = |glass: &Glass| {
            let n = (glass.index(lines.mid.wavelength_nm) - n).abs() / 0.002;
            let v = v.map_or(0.0, |v| (glass.abbe_number(lines) - v).abs() / (0.02 * v));
            n.max(v)
        };
        let best = places.iter().map(|&p| self.glass(p)).map(|g| (far(&g), g)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 <= 1.0).then_some(best.1)
    }

    /// Returns the data set that the bare name of a substance means beside stated figures: the default one if it has that index,
    /// else the one nearest to the figures.
    fn measured(&self, name: &str, usual: RecordIndex, (n, v, lines): (f64, Option<f64>, LineTriple)) -> ChosenGlass {
        let own = |glass: &Glass| glass.index(lines.mid.wavelength_nm);
        let glass = self.glass(usual);
        let all = self.data_sets(name);
        if all.len() < 2 || has_index(n, own(&glass)) {
            return ChosenGlass { glass, note: None };
        }
        // If none is near, the lens warns of that as for any glass.
        let Some(nearest) = self.nearest_of(&all, n, v, lines) else { return ChosenGlass { glass, note: None } };
        let called = lines.mid.indexed("n");
        let but = match own(&nearest) {
            own if has_index(n, own) => String::new(),
            own => format!("; it has {own:.5}"),
        };
        let note = format!(
            "`{name}` has {} data sets: {} is used, the nearest to the stated {called} {n}{but}",
            all.len(),
            nearest.full_name()
        );
        ChosenGlass { glass: nearest, note: Some(note) }
    }

    /// Returns all data of the substance of that bare name that were measured near room temperature.
    fn data_sets(&self, name: &str) -> Vec<RecordIndex> {
        let asked = name.trim();
        let is_one = |place: RecordIndex| {
            let named = same_name(self.maker_of(place), asked) || same_name(self.name_of(place), asked);
            named && !self.category_of(place).is_glass()
        };
        let all = self.index.iter().map(|(_, place)| *place).filter(|place| is_one(*place));
        all.filter(|place| self.glass(*place).temperature_c.is_none_or(|t| (0.0..=40.0).contains(&t))).collect()
    }

    /// Returns the default data of a substance, for which its everyday name stands, if a maker's short, rounded table has the
    /// same name.
    fn usual_data(&self, asked: &str, named: &[RecordIndex]) -> Option<Vec<RecordIndex>> {
        let is_table = |place: &RecordIndex| {
            self.category_of(*place) == Category::Crystal && matches!(self.glass(*place).formula, Formula::Table(_))
        };
        if asked.contains('/') || !named.iter().all(is_table) {
            return None;
        }
        let of_substance = |target: &&str| target.split_once('/').is_some_and(|(of, _)| same_name(of, asked));
        let mut targets = self.bundle.aliases().map(|(_, target)| target);
        let target = self.bundle.alias(asked).or_else(|| targets.find(of_substance))?;
        let usual = self.places(target);
        let is_formula = |place: &RecordIndex| !matches!(self.glass(*place).formula, Formula::Table(_));
        (!usual.is_empty() && usual.iter().all(is_formula)).then_some(usual)
    }

    /// Returns the glasses of a name together with the data of the substance whose formula is written exactly so: `LaF3` is
    /// lanthanum fluoride, but many write the flint LAF3 that way. Returns `named` if there is no such substance, or if the
    /// name is not in upper and lower case, as formulas are.
    fn or_substance(&self, asked: &str, named: Vec<RecordIndex>) -> Vec<RecordIndex> {
        let is_formula = asked.bytes().any(|b| b.is_ascii_lowercase()) && asked.bytes().any(|b| b.is_ascii_uppercase());
        if named.is_empty() || !is_formula {
            return named;
        }
        let is_of_it = |place: &RecordIndex| self.maker_of(*place) == asked && !self.category_of(*place).is_glass();
        let mut all: Vec<RecordIndex> = self.index.iter().map(|(_, place)| *place).filter(is_of_it).collect();
        if all.is_empty() {
            return named;
        }
        // Makers write names in capitals. Other media that have the name by chance, such as measurements named after their
        // author, are not meant.
        let of_maker = |place: &RecordIndex| {
            self.category_of(*place).is_glass() && !self.name_of(*place).bytes().any(|b| b.is_ascii_lowercase())
        };
        all.extend(named.into_iter().filter(of_maker));
        all
    }

    fn places(&self, name: &str) -> Vec<RecordIndex> {
        let asked = name.trim();
        let (maker, name) = split_maker(asked);
        let maker = maker.map(our_maker);
        let of_maker = |place: &RecordIndex| maker.as_ref().is_none_or(|m| same_name(self.maker_of(*place), m));
        let upper = name.to_uppercase();
        let start = self.index.partition_point(|(n, _)| n.as_ref() < upper.as_str());
        let same = self.index[start..].iter().take_while(|(n, _)| n.as_ref() == upper).map(|(_, place)| *place);
        let exact: Vec<RecordIndex> = same.filter(of_maker).collect();
        // Case counts if it tells some of them apart.
        let to_the_letter: Vec<RecordIndex> =
            exact.iter().copied().filter(|place| self.name_of(*place) == name).collect();
        let named = if to_the_letter.is_empty() { self.or_substance(asked, exact) } else { to_the_letter };
        if !named.is_empty() {
            return self.usual_data(asked, &named).unwrap_or(named);
        }
        if let Some(target) = self.bundle.alias(asked) {
            return self.places(target);
        }
        // A substance without the name of a measurement.
        if maker.is_none() {
            let all: Vec<RecordIndex> =
                self.index.iter().map(|(_, p)| *p).filter(|p| same_name(self.maker_of(*p), &upper)).collect();
            if !all.is_empty() {
                return all;
            }
        }
        let squeezed = squeeze(name);
        if squeezed.is_empty() {
            return Vec::new();
        }
        let all = self.squeezed.get_or_init(|| {
            let mut all: HashMap<String, Vec<RecordIndex>> = HashMap::new();
            for (name, place) in &self.index {
                all.entry(squeeze(name)).or_default().push(*place);
            }
            all
        });
        all.get(&squeezed).into_iter().flatten().copied().filter(of_maker).collect()
    }

    fn candidates(&self, places: &[RecordIndex]) -> Vec<Candidate> {
        places.iter().map(|&place| candidate(&self.glass(place))).collect()
    }

    /// Returns the names with the smallest edit distance among those that could have been meant: glasses for what looks like a
    /// glass, substances and everyday names for a word. Names of the stated maker come first.
    fn nearest_names(&self, name: &str) -> Vec<Candidate> {
        let asked = name.trim();
        let (maker, bare) = split_maker(asked);
        let maker = maker.map(|maker| self.maker_like(our_maker(maker)));
        let bare: Vec<char> = bare.to_uppercase().chars().take(64).collect();
        if maker.is_none() && PLASTICS_NOT_HELD.iter().any(|plastic| plastic.eq_ignore_ascii_case(asked)) {
            let plastics = self.bundle.aliases().filter_map(|(alias, target)| {
                let &[place] = &self.places(target)[..] else { return None };
                let glass = self.glass(place);
                let short = alias.chars().all(|c| c.is_ascii_uppercase());
                (glass.category == Category::Plastic && short)
                    .then(|| Candidate { full_name: alias.to_owned(), ..candidate(&glass) })
            });
            return plastics.take(LISTED).collect();
        }
        let farthest = (bare.len() / 3).clamp(1, 4);
        let is_code = bare.iter().any(char::is_ascii_digit);
        let mut scored: Vec<(usize, bool, bool, usize)> = Vec::new();
        for (i, (candidate, place)) in self.index.iter().enumerate() {
            // A measurement is named after its author; nobody means it without naming the substance.
            let category = self.category_of(*place);
            if maker.is_none() && (!category.is_glass() || candidate.bytes().any(|b| b.is_ascii_digit()) != is_code) {
                continue;
            }
            let other_maker = maker.as_ref().is_some_and(|m| !same_name(self.maker_of(*place), m));
            if other_maker && !category.is_glass() {
                continue;
            }
            // An heir (a successor with one more letter in front) is as near as the name itself, and comes after it.
            let is_heir = is_heir(&bare, candidate);
            let distance = if is_heir { 0 } else { edit_distance(&bare, candidate) };
            if distance <= farthest {
                scored.push((distance, other_maker, is_heir, i));
            }
        }
        scored.sort_unstable();
        scored.truncate(LISTED);
        let mut near: Vec<(usize, Candidate)> =
            scored.iter().map(|&(distance, _, _, i)| (distance, candidate(&self.glass(self.index[i].1)))).collect();
        if maker.is_none() {
            near.extend(self.near_words(&bare, farthest));
            near.sort_by_key(|(distance, _)| *distance);
            near.truncate(LISTED);
        }
        near.into_iter().map(|(_, candidate)| candidate).collect()
    }

    /// Returns the only maker of glass whose name is a letter or two away; the name as typed if there is none, or if there are
    /// several.
    fn maker_like(&self, typed: String) -> String {
        let glasses = self.index.iter().filter(|(_, place)| self.category_of(*place).is_glass());
        let makers: BTreeSet<&str> = glasses.map(|(_, place)| self.maker_of(*place)).collect();
        if makers.iter().any(|maker| same_name(maker, &typed)) {
            return typed;
        }
        let letters: Vec<char> = typed.chars().take(64).collect();
        let farthest = (letters.len() / 3).min(2);
        let mut near = makers.iter().filter(|maker| edit_distance(&letters, &maker.to_uppercase()) <= farthest);
        match (near.next(), near.next()) {
            (Some(maker), None) => (*maker).to_owned(),
            _ => typed,
        }
    }

    /// Returns everyday names and substances near a word.
    fn near_words(&self, word: &[char], farthest: usize) -> Vec<(usize, Candidate)> {
        let mut near: Vec<(usize, Candidate)> = Vec::new();
        for (alias, target) in self.bundle.aliases() {
            let distance = edit_distance(word, &alias.to_uppercase());
            if let (true, &[place]) = (distance <= farthest, &self.places(target)[..]) {
                near.push((distance, Candidate { full_name: alias.to_owned(), ..candidate(&self.glass(place)) }));
            }
        }
        let mut substances: Vec<(&str, RecordIndex)> =
            self.index.iter().map(|(_, place)| (self.maker_of(*place), *place)).collect();
        substances.retain(|(_, place)| !self.category_of(*place).is_glass());
        substances.sort_by_key(|(substance, _)| *substance);
        substances.dedup_by_key(|(substance, _)| *substance);
        for (substance, place) in substances {
            let distance = edit_distance(word, &substance.to_uppercase());
            if distance <= farthest {
                near.push((distance, candidate(&self.glass(place))));
            }
        }
        near.sort_by_key(|(distance, _)| *distance);
        near.truncate(LISTED);
        near
    }
}

/// Returns whether a stated index is `own`, as far as its digits go.
fn has_index(stated: f64, own: f64) -> bool {
    let digits = stated.to_string().split_once('.').map_or(0, |(_, digits)| digits.len());
    (stated - own).abs() <= 1.000_001 * 0.1_f64.powi(digits.min(8) as i32)
}

/// Returns the name of a maker in this catalogue, in upper case.
fn our_maker(name: &str) -> String {
    let upper = name.to_uppercase();
    MAKERS.iter().find(|(alias, _)| *alias == upper).map_or(upper, |(_, maker)| (*maker).to_owned())
}

/// Returns whether two names are the same except for case.
fn same_name(a: &str, b: &str) -> bool {
    if a.is_ascii() && b.is_ascii() { a.eq_ignore_ascii_case(b) } else { a.to_uppercase() == b.to_uppercase() }
}

fn candidate(glass: &Glass) -> Candidate {
    Candidate { full_name: glass.full_name(), nd: glass.nd(), vd: glass.vd() }
}

/// Splits the maker from a name: `SCHOTT/N-BK7`, or the `LZ_` of LZOS glasses in design programs.
fn split_maker(name: &str) -> (Option<&str>, &str) {
    if let Some((maker, name)) = name.split_once('/') {
        let name = name.trim();
        return (Some(maker.trim()), strip_lzos(name).unwrap_or(name));
    }
    match strip_lzos(name) {
        Some(rest) => (Some("LZOS"), rest),
        None => (None, name),
    }
}

fn strip_lzos(name: &str) -> Option<&str> {
    let prefix = name.get(..3)?;
    (prefix.eq_ignore_ascii_case("LZ_") && name.len() > 3).then(|| &name[3..])
}

fn squeeze(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '-' | '_' | ' ' | '.')).flat_map(char::to_uppercase).collect()
}

/// Returns whether a glass is the named one with the letter that its maker puts before it today: `K-LASFN1` for `LASFN1`.
fn is_heir(name: &[char], candidate: &str) -> bool {
    let Some((mark, rest)) = candidate.split_once('-') else { return false };
    mark.len() == 1 && rest.chars().eq(name.iter().copied())
}

/// Computes Levenshtein's distance: insertions, deletions and replacements of characters.
fn edit_distance(a: &[char], b: &str) -> usize {
    let mut row: Vec<usize> = (0..=a.len()).collect();
    for (j, cb) in b.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = j + 1;
        for (i, ca) in a.iter().enumerate() {
            let replace = diagonal + usize::from(*ca != cb);
            diagonal = row[i + 1];
            row[i + 1] = replace.min(row[i] + 1).min(diagonal + 1);
        }
    }
    row[a.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_of_words() {
        let chars = |s: &str| s.chars().collect::<Vec<_>>();
        assert_eq!(edit_distance(&chars("KITTEN"), "SITTING"), 3);
        assert_eq!(edit_distance(&chars(""), "ABC"), 3);
        assert_eq!(edit_distance(&chars("N-BK7"), "N-BK7"), 0);
    }

    #[test]
    fn heirs() {
        let lasfn1: Vec<char> = "LASFN1".chars().collect();
        assert!(is_heir(&lasfn1, "K-LASFN1"));
        assert!(!is_heir(&lasfn1, "K-LASFN10") && !is_heir(&lasfn1, "LASFN1") && !is_heir(&lasfn1, "KZ-LASFN1"));
    }

    #[test]
    fn a_slip_in_a_maker_is_that_maker() {
        let Err(FindError::Unknown { nearest, .. }) = Catalog::bundled().find("SCHOT/SK10") else { panic!("found") };
        assert_eq!(nearest.first().map(|c| c.full_name.as_str()), Some("SCHOTT/SK10"));
    }

    #[test]
    fn makers_in_names() {
        assert_eq!(split_maker("schott / N-BK7"), (Some("schott"), "N-BK7"));
        assert_eq!(split_maker("LZ_LF5"), (Some("LZOS"), "LF5"));
        assert_eq!(split_maker("lzos/LZ_LF5"), (Some("lzos"), "LF5"));
        assert_eq!(split_maker("LZ_"), (None, "LZ_"));
        assert_eq!(split_maker("\u{df}\u{df}"), (None, "\u{df}\u{df}"));
    }
}
