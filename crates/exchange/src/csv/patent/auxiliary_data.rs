//! Reads what is printed below a table: coefficients of aspheres, gaps that vary, and the back focus.

use super::equations::{Equation, equations_of};
use super::head::Head;
use super::value;
use super::vocabulary::{figure, gap_number, is_back_focus, is_other, surface_number};
use crate::number;
use std::collections::{BTreeMap, BTreeSet};

/// The conic constant of an asphere, and its coefficients by power.
#[derive(Clone, Debug, Default)]
pub(super) struct Asphere {
    pub conic: Option<String>,
    pub coefficients: BTreeMap<u32, String>,
}

/// Data from below a table, and the back focus from anywhere.
#[derive(Default)]
pub(super) struct AuxiliaryData {
    pub aspheres: BTreeMap<u32, Asphere>,
    /// First values of gaps, by the numbers of their surfaces.
    pub gaps: BTreeMap<u32, String>,
    pub back_focus: Option<String>,
    /// Whether a conic constant was given as kappa.
    pub has_kappa: bool,
    /// Whether kappa is the conic constant itself instead of 1 plus it.
    pub kappa_is_conic: bool,
}

/// Determines the meaning of kappa from the printed formula of the sag (1 - kappa or 1 + kappa), or else from its name.
fn kappa_is_conic(lines: &[&str]) -> bool {
    let plain: String = lines.concat().to_lowercase().chars().filter(|c| !c.is_whitespace()).collect();
    let formula = |sign: char| plain.contains(&format!("1{sign}κ"));
    !formula('-') && (formula('+') || plain.contains("conicconstantκ") || plain.contains("conicconstant(κ)"))
}

/// Splits a line into words, each with the column where it ends, in characters.
fn placed(line: &str) -> Vec<(String, usize)> {
    let mut words = Vec::new();
    let mut word = String::new();
    for (at, c) in line.chars().chain([' ']).enumerate() {
        if !c.is_whitespace() {
            word.push(c);
        } else if !word.is_empty() {
            words.push((std::mem::take(&mut word), at));
        }
    }
    words
}

/// Reads the heading of a table of aspheres with one column per surface, `Surface # 2 3 4 5`: the numbers and where each one ends.
fn surfaces_across(line: &str) -> Option<Vec<(u32, usize)>> {
    let words = placed(line);
    let (first, rest) = words.split_first()?;
    if !first.0.to_lowercase().starts_with("surface") {
        return None;
    }
    let rest = if rest.first().is_some_and(|(word, _)| ["#", "no.", "number"].contains(&word.to_lowercase().as_str())) {
        &rest[1..]
    } else {
        rest
    };
    let columns: Option<Vec<(u32, usize)>> = rest.iter().map(|(word, end)| Some((word.parse().ok()?, *end))).collect();
    columns.filter(|all| all.len() >= 2 && all.windows(2).all(|pair| pair[0].0 < pair[1].0))
}

/// Meaning of a figure of an asphere.
#[derive(Clone, Copy)]
enum Term {
    Conic,
    Kappa,
    Power(u32),
}

impl Term {
    /// Returns the term with this name and number: `K`, `A4`, `C6`, or `A`, `B`, `C` for the fourth, sixth and eighth power.
    fn of(name: &str, number: Option<u32>) -> Option<Self> {
        Some(match (name, number) {
            ("k" | "cc" | "conic", None) => Self::Conic,
            ("κ" | "kappa" | "ε", None) => Self::Kappa,
            ("a" | "c" | "e" | "as", Some(power)) if power.is_multiple_of(2) && (2..=40).contains(&power) => {
                Self::Power(power)
            }
            ("a" | "b" | "c" | "d" | "e" | "f", None) => Self::Power(4 + 2 * "abcdef".find(name)? as u32),
            _ => return None,
        })
    }
}

impl AuxiliaryData {
    /// Returns the powers that any asphere has, in ascending order.
    pub(super) fn powers(&self) -> Vec<u32> {
        let all: BTreeSet<u32> = self.aspheres.values().flat_map(|a| a.coefficients.keys().copied()).collect();
        all.into_iter().collect()
    }

    /// Returns the conic constant and the coefficients of these powers for a surface; empty where there are none.
    pub(super) fn terms(&self, surface: Option<u32>, powers: &[u32]) -> Vec<String> {
        let asphere = surface.and_then(|number| self.aspheres.get(&number));
        let of = |power: &u32| asphere.and_then(|a| a.coefficients.get(power).cloned()).unwrap_or_default();
        let conic = asphere.and_then(|a| a.conic.clone()).unwrap_or_default();
        std::iter::once(conic).chain(powers.iter().map(of)).collect()
    }

    pub(super) fn of(lines: &[&str], from: usize) -> Self {
        let mut below = Self { kappa_is_conic: kappa_is_conic(lines), ..Self::default() };
        lines.iter().for_each(|line| below.take_back_focus(line));
        let mut surface = None;
        // Terms of a table of aspheres, the surface of its current row, and how many terms have been read.
        let mut terms: Vec<Term> = Vec::new();
        // Surfaces of a table of aspheres with one column per surface, each with the position where its figures end.
        let mut columns: Vec<(u32, usize)> = Vec::new();
        let mut row: Option<(u32, usize)> = None;
        for line in lines.iter().skip(from) {
            let plain = line.trim();
            // Stop at a second example, which is another lens.
            if Head::of(plain).is_some_and(|head| head.is_of_surfaces())
                || plain.to_lowercase().starts_with("example 2")
            {
                break;
            }
            if is_other(plain) && !plain.to_lowercase().contains("asph") && !plain.contains("非球面") {
                surface = None;
                columns.clear();
            }
            if let Some(own) = surfaces_across(line) {
                columns = own;
                continue;
            }
            if below.take_across(line, &columns) {
                continue;
            }
            let head = plain.split('=').next().unwrap_or_default();
            let lower = head.to_lowercase();
            let is_named = (lower.contains("surface") || head.contains('面') || lower.starts_with("no."))
                && !lower.contains("number of");
            let bare = plain.trim_matches(['(', ')', '*', ':', '.', 'r', ' ', '[', ']']);
            let is_bare = !bare.is_empty() && bare.len() < 4 && bare.chars().all(|c| c.is_ascii_digit());
            if is_named || is_bare {
                columns.clear();
                surface = surface_number(head).or(surface);
            }
            let all = equations_of(plain);
            let leads = |e: &Equation| matches!(e.name.as_str(), "k" | "κ" | "kappa" | "a") || e.number.is_some();
            let is_of_asphere = all.iter().any(leads);
            for equation in all {
                // Read bare letters as coefficients only together with a conic constant or `A`; elsewhere they may be a focal length.
                if !is_of_asphere && equation.number.is_none() {
                    continue;
                }
                if value(&equation.value).is_none() {
                    continue;
                }
                if let (Some(surface), Some(term)) = (surface, Term::of(&equation.name, equation.number)) {
                    below.set(surface, term, equation.value);
                }
            }
            if !plain.contains('=') {
                below.take_row(plain, &mut terms, &mut row);
                below.take_gap(plain);
            }
        }
        below.aspheres.retain(|_, asphere| asphere.conic.is_some() || !asphere.coefficients.is_empty());
        below
    }

    /// Reads one term of several surfaces, each figure below the number of its surface: `A4 = 9.9e-3 -3.0e-3 ...`. Returns whether the line
    /// is such a row.
    fn take_across(&mut self, line: &str, columns: &[(u32, usize)]) -> bool {
        let words = placed(line);
        let Some(((name, _), figures)) = words.split_first().filter(|_| !columns.is_empty()) else { return false };
        let name = name.trim_end_matches('=');
        let letters: String = name.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_lowercase).collect();
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        let Some(term) = Term::of(&letters, digits.parse().ok()) else { return false };
        let figures: Vec<&(String, usize)> = figures.iter().filter(|(word, _)| word != "=").collect();
        if figures.is_empty()
            || figures.len() > columns.len()
            || figures.iter().any(|(word, _)| value(word).is_none() && word != "-")
        {
            return false;
        }
        let surfaces: Vec<u32> = if figures.len() == columns.len() {
            columns.iter().map(|(surface, _)| *surface).collect()
        } else {
            // Assign each figure to the nearest column, if blanks have kept the positions.
            let nearest = |end: usize| columns.iter().min_by_key(|(_, column)| column.abs_diff(end)).map(|(s, _)| *s);
            figures.iter().filter_map(|(_, end)| nearest(*end)).collect()
        };
        if surfaces.windows(2).any(|pair| pair[0] == pair[1]) {
            return false;
        }
        // Skip a dash, which means that a surface has no such term.
        for ((word, _), surface) in figures.into_iter().zip(surfaces).filter(|((word, _), _)| word != "-") {
            self.set(surface, term, figure(word));
        }
        true
    }

    fn set(&mut self, surface: u32, term: Term, figure: String) {
        let asphere = self.aspheres.entry(surface).or_default();
        match term {
            Term::Conic => drop(asphere.conic.get_or_insert(figure)),
            Term::Kappa => {
                let kappa = value(&figure).unwrap_or(1.0);
                let conic = number::shortest(if self.kappa_is_conic { kappa } else { kappa - 1.0 });
                asphere.conic.get_or_insert(conic);
                self.has_kappa = true;
            }
            Term::Power(power) => drop(asphere.coefficients.entry(power).or_insert(figure)),
        }
    }

    /// Reads a line of a table of aspheres: headings such as `Si K A B C`, rows, and lines that continue a row.
    fn take_row(&mut self, line: &str, terms: &mut Vec<Term>, row: &mut Option<(u32, usize)>) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let term = |word: &&str| {
            let letters: String = word.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_lowercase).collect();
            let digits: String = word.chars().filter(char::is_ascii_digit).collect();
            (letters.chars().count() <= 2).then(|| Term::of(&letters, digits.parse().ok())).flatten()
        };
        let named: Vec<Term> = words.iter().filter_map(term).collect();
        if named.len() >= 2 && named.len() + 2 >= words.len() && matches!(named[0], Term::Conic | Term::Kappa) {
            (*terms, *row) = (named, None);
            return;
        }
        let figures: Option<Vec<String>> =
            words.iter().map(|word| value(word).map(|_| figure(word))).collect::<Option<Vec<String>>>();
        let Some(mut figures) = figures.filter(|all| !all.is_empty() && !terms.is_empty()) else {
            // Words end a table of aspheres.
            if !line.is_empty() && words.len() > 2 {
                terms.clear();
            }
            return;
        };
        let is_open = row.is_some_and(|(_, count)| count < terms.len());
        if !(is_open && row.is_some_and(|(_, count)| count + figures.len() <= terms.len())) {
            let Some(number) = figures.remove(0).parse().ok().filter(|number| *number < 1000) else { return };
            *row = Some((number, 0));
        }
        let Some((surface, count)) = row else { return };
        for figure in figures {
            let Some(term) = terms.get(*count) else { break };
            *count += 1;
            self.set(*surface, *term, figure);
        }
    }

    /// Reads the values of a gap, `d5 1.20 8.40 16.50` or `d 5 1.20`; the first one is used.
    fn take_gap(&mut self, line: &str) {
        let words: Vec<&str> =
            line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|w| !w.is_empty()).collect();
        let joined = words.get(..2).map(|two| two.concat()).unwrap_or_default();
        let named = |name: &str, first: Option<&&str>| {
            Some((gap_number(Some(name))?, first.filter(|f| value(f).is_some())?.to_string()))
        };
        let found = words.first().and_then(|name| named(name, words.get(1)));
        let found = found.or_else(|| named(&joined, words.get(2)));
        if let Some((number, first)) = found {
            self.gaps.entry(number).or_insert_with(|| figure(&first));
        }
    }

    /// Reads the back focus: `BF = 37.78`, `Back focus = +79.8`, `s' = 47,96` or `BF 37.78`.
    fn take_back_focus(&mut self, line: &str) {
        if self.back_focus.is_some() {
            return;
        }
        let typed = |word: &str| {
            let point = if word.contains('.') { word.to_owned() } else { word.replacen(',', ".", 1) };
            value(word).map(|_| figure(&point).trim_start_matches('+').to_owned())
        };
        let parts: Vec<&str> = line.split('=').collect();
        for pair in parts.windows(2) {
            let name: Vec<&str> = pair[0].split_whitespace().collect();
            let is_named =
                (1..=3).any(|count| count <= name.len() && is_back_focus(&name[name.len() - count..].join(" ")));
            let mut words = pair[1].split_whitespace();
            let first = words.next().unwrap_or_default();
            let first = if ["+", "-"].contains(&first) { words.next().unwrap_or_default() } else { first };
            if is_named && let Some(figure) = typed(first.trim_end_matches([',', ';'])) {
                self.back_focus = Some(figure);
                return;
            }
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        if let [name, first, ..] = &words[..]
            && is_back_focus(name)
        {
            self.back_focus = typed(first);
        }
    }
}
