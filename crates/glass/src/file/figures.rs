//! Glasses that are given by their figures, as patents state them.

use super::stated_lines::{self, ThreeLines};
use crate::formula::{ModelGlass, resonance};
use crate::lines::{self, Line, LineTriple};
use crate::medium::Medium;
use crate::{Category, Glass};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Params};

/// Largest difference of a stated index from the one that all figures together give; beyond it one of them is wrong.
const TOLERANCE_N: f64 = 1e-4;
/// Largest relative difference of a stated Abbe number.
const TOLERANCE_V: f64 = 0.01;
/// Keys of an index and an Abbe number for any lines.
const ANY_N: &str = "abbe.n";
const ANY_V: &str = "abbe.v";
/// Range of wavelengths (nm) within which ordinary glasses keep to the normal lines of partial dispersion.
const MODEL_NM: std::ops::RangeInclusive<f64> = 300.0..=1100.0;

/// A glass given by its figures. One index alone has no dispersion; with an Abbe number, or with more indices, the dispersion
/// is that of ordinary glasses with these figures.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Figures {
    /// Index at the d line (587.56 nm), 1 to 4.
    #[schemars(range(min = 1, max = 4))]
    pub nd: Option<f64>,
    /// Abbe number at d, F and C, 5 to 200.
    #[schemars(range(min = 5, max = 200))]
    pub vd: Option<f64>,
    /// Index at the e line (546.07 nm).
    #[schemars(range(min = 1, max = 4))]
    pub ne: Option<f64>,
    /// Abbe number at e, F' and C', 5 to 200.
    #[schemars(range(min = 5, max = 200))]
    pub ve: Option<f64>,
    /// Index at the sodium line D (589.29 nm).
    #[serde(rename = "nD")]
    #[schemars(range(min = 1, max = 4))]
    pub n_sodium: Option<f64>,
    /// Abbe number at D, F and C, 5 to 200.
    #[serde(rename = "vD")]
    #[schemars(range(min = 5, max = 200))]
    pub v_sodium: Option<f64>,
    /// Index at the i line (365.01 nm).
    #[schemars(range(min = 1, max = 4))]
    pub ni: Option<f64>,
    /// Index at the h line (404.66 nm).
    #[schemars(range(min = 1, max = 4))]
    pub nh: Option<f64>,
    /// Index at the g line (435.83 nm).
    #[schemars(range(min = 1, max = 4))]
    pub ng: Option<f64>,
    /// Index at the F' line (479.99 nm).
    #[serde(rename = "nF'")]
    #[schemars(range(min = 1, max = 4))]
    pub n_f_prime: Option<f64>,
    /// Index at the F line (486.13 nm).
    #[serde(rename = "nF")]
    #[schemars(range(min = 1, max = 4))]
    pub n_f: Option<f64>,
    /// Index at the C' line (643.85 nm).
    #[serde(rename = "nC'")]
    #[schemars(range(min = 1, max = 4))]
    pub n_c_prime: Option<f64>,
    /// Index at the C line (656.27 nm).
    #[serde(rename = "nC")]
    #[schemars(range(min = 1, max = 4))]
    pub n_c: Option<f64>,
    /// Index at the r line (706.52 nm).
    #[schemars(range(min = 1, max = 4))]
    pub nr: Option<f64>,
    /// Index at the s line (852.11 nm).
    #[schemars(range(min = 1, max = 4))]
    pub ns: Option<f64>,
    /// An Abbe number for any three lines, and the index at the middle one: `{lines: [450 nm, 580 nm, 680 nm], n: 1.52, v: 60}`.
    pub abbe: Option<AbbeNumber>,
}

/// An Abbe number V = (n - 1) / (n_blue - n_red) for any three lines.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct AbbeNumber {
    /// The three lines, from blue to red, by name or wavelength, nm if bare: `[F, e, C]`.
    pub lines: ThreeLines,
    /// Index at the middle line, 1 to 4; may be absent where an index at another line is stated.
    #[schemars(range(min = 1, max = 4))]
    pub n: Option<f64>,
    /// Abbe number, 5 to 200.
    #[schemars(range(min = 5, max = 200))]
    pub v: f64,
    /// Curve of the index between the lines and beyond: `normal` (the default) is that of real glasses on average, `resonance`
    /// is n = A + B / (L^2 - 0.014 um^2), which some renderers use. `resonance` needs `n`, and no other figure.
    #[serde(default)]
    pub curve: AbbeCurve,
}

/// The shape of the dispersion curve that is fitted to an index and an Abbe number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum AbbeCurve {
    /// The curve of glasses on the normal lines of partial dispersion.
    #[default]
    Normal,
    /// One resonance in the ultraviolet: n = A + B / (L^2 - 0.014 um^2).
    Resonance,
}

impl Figures {
    /// Returns the indices with their keys. The index at the reference line of a patent comes first: d, else e, else D.
    fn indices(&self) -> Vec<(&'static str, Line, f64)> {
        let any = self.abbe_lines().zip(self.abbe.as_ref().and_then(|abbe| abbe.n));
        let all = [
            ("nd", lines::D, self.nd),
            ("ne", lines::E, self.ne),
            ("nD", lines::SODIUM_D, self.n_sodium),
            (ANY_N, any.map_or(lines::D, |(lines, _)| lines.mid), any.map(|(_, n)| n)),
            ("ni", lines::I, self.ni),
            ("nh", lines::H, self.nh),
            ("ng", lines::G, self.ng),
            ("nF'", lines::F_PRIME, self.n_f_prime),
            ("nF", lines::F, self.n_f),
            ("nC'", lines::C_PRIME, self.n_c_prime),
            ("nC", lines::C, self.n_c),
            ("nr", lines::R, self.nr),
            ("ns", lines::S, self.ns),
        ];
        all.into_iter().filter_map(|(key, line, n)| Some((key, line, n?))).collect()
    }

    /// Returns the Abbe numbers with their keys.
    fn abbe_numbers(&self) -> Vec<(&'static str, LineTriple, f64)> {
        let all = [
            ("vd", LineTriple::FDC, self.vd),
            ("ve", LineTriple::F_PRIME_E_C_PRIME, self.ve),
            ("vD", LineTriple::F_SODIUM_C, self.v_sodium),
        ];
        let any = self.abbe_lines().zip(self.abbe.as_ref()).map(|(lines, abbe)| (ANY_V, lines, abbe.v));
        all.into_iter().filter_map(|(key, lines, v)| Some((key, lines, v?))).chain(any).collect()
    }

    /// Returns the lines of `abbe`, if they are three.
    fn abbe_lines(&self) -> Option<LineTriple> {
        self.abbe.as_ref().and_then(|abbe| stated_lines::rising(&abbe.lines))
    }

    /// Returns the name that reports use for the figure of this key.
    fn called(&self, key: &str) -> String {
        match self.abbe_lines() {
            Some(lines) if key == ANY_N => lines.mid.indexed("n"),
            Some(lines) if key == ANY_V => lines.abbe_label(),
            _ => key.to_owned(),
        }
    }

    /// Checks that `abbe` names three lines, and an index that no other key states. `params` places faults.
    ///
    /// # Errors
    /// Lines that are unknown or do not rise; the same line twice.
    pub(super) fn checked(&self, params: &Params) -> Result<(), Fault> {
        let Some(abbe) = &self.abbe else { return Ok(()) };
        let lines = stated_lines::triple(&abbe.lines, params, "abbe.lines")?;
        let twice = |(key, line, _): &(&str, Line, f64)| {
            *key != ANY_N && abbe.n.is_some() && line.wavelength_nm == lines.mid.wavelength_nm
        };
        match self.indices().into_iter().find(twice) {
            Some((key, ..)) => {
                let text = format!("the index at {} is also stated by `{key}`", lines.mid.label());
                Err(params.fault(ANY_N, text).hint("leave one of them out"))
            }
            None => Ok(()),
        }
    }

    /// Returns the index that is stated at the line of this wavelength; `None` if none is stated there.
    #[must_use]
    pub fn index_at(&self, wavelength_nm: f64) -> Option<f64> {
        self.indices().into_iter().find(|(_, line, _)| line.wavelength_nm == wavelength_nm).map(|(_, _, n)| n)
    }

    /// Returns whether no figure is stated.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices().is_empty() && self.abbe_numbers().is_empty()
    }

    /// Returns every figure as its key, its stated value, its value by an index function, and the largest allowed difference:
    /// 5e-4 for an index, 0.5 for an Abbe number.
    pub(super) fn against(&self, n: impl Fn(f64) -> f64) -> Vec<(&'static str, f64, f64, f64)> {
        let indices = self.indices().into_iter().map(|(key, line, stated)| (key, stated, n(line.wavelength_nm), 5e-4));
        let abbe = self.abbe_numbers().into_iter().map(|(key, lines, v)| (key, v, lines.abbe_number(&n), 0.5));
        indices.chain(abbe).collect()
    }

    /// Creates the medium with these figures, and the name that reports use for it. Faults are placed in `params`.
    ///
    /// # Errors
    /// No index; a figure that no glass has; figures that contradict each other.
    pub fn medium(&self, params: &Params) -> Result<(Medium, String), Fault> {
        let (indices, abbe) = (self.indices(), self.abbe_numbers());
        self.checked(params)?;
        if let Some(lines) = self.abbe_lines()
            && !(MODEL_NM.contains(&lines.short.wavelength_nm) && MODEL_NM.contains(&lines.long.wavelength_nm))
        {
            let fault =
                params.fault("abbe.lines", "these lines alone do not determine the dispersion of visible light");
            return Err(fault.hint("use lines from 300 to 1100 nm, or a `formula` or `table`"));
        }
        let figure = |(key, value): (&str, f64)| format!("{} = {value}", self.called(key));
        let named = indices.iter().map(|(key, _, n)| (*key, *n)).chain(abbe.iter().map(|(key, _, v)| (*key, *v)));
        let label = match (&indices[..], &abbe[..]) {
            ([(_, _, n)], []) => format!("n = {n}"),
            _ => named.map(figure).collect::<Vec<_>>().join(", "),
        };
        if let (Some(AbbeNumber { curve: AbbeCurve::Resonance, .. }), Some(lines)) = (&self.abbe, self.abbe_lines()) {
            let [(ANY_N, _, n)] = indices[..] else {
                let fault =
                    params.fault("abbe.curve", "this curve takes one index and one Abbe number, both at three lines");
                return Err(fault
                    .hint("write `abbe: {curve: resonance, lines: [F, d, C], n: 1.62, v: 36.4}` and no other figure"));
            };
            let [(ANY_V, _, v)] = abbe[..] else {
                let fault = params.fault("abbe.curve", "this curve takes only one Abbe number");
                return Err(fault.hint("leave the other one out"));
            };
            let formula = resonance::through(n, v, lines);
            // Nothing was measured, so no wavelength lies beyond the data.
            let range = (100.0, 1e6);
            let glass =
                Glass::new(super::OWN_MAKER, &format!("{label}, one resonance"), Category::User, formula, range);
            return Ok((Medium::Glass(glass.into()), format!("{label}, one resonance")));
        }
        let medium = match (&indices[..], &abbe[..]) {
            ([], []) => {
                let fault = params.fault_here("the glass has no index");
                return Err(
                    fault.hint("write `nd` and `vd`, `ne` and `ve`, `abbe: {lines: [F, e, C], n: ..., v: ...}`, or indices at several lines: `nd`, `ng`, `nF`, `nC`")
                );
            }
            ([], [(key, ..), ..]) => {
                return Err(params.fault(key, format!("`{key}` needs an index")).hint("add `nd: ...`"));
            }
            ([(_, _, n)], []) => Medium::Constant(*n),
            _ => Medium::Model(self.model(params, &indices, &abbe)?),
        };
        Ok((medium, label))
    }

    fn model(
        &self,
        params: &Params,
        indices: &[(&'static str, Line, f64)],
        abbe: &[(&'static str, LineTriple, f64)],
    ) -> Result<ModelGlass, Fault> {
        let stated: Vec<(Line, f64)> = indices.iter().map(|(_, line, n)| (*line, *n)).collect();
        let numbers: Vec<(f64, LineTriple)> = abbe.iter().map(|(_, lines, v)| (*v, *lines)).collect();
        let no_such = || {
            let key = abbe.first().map_or(indices[0].0, |(key, ..)| key);
            params.fault(key, "no glass has these figures").hint("an index falls from violet to red")
        };
        let model = ModelGlass::through(&stated, &numbers).ok_or_else(no_such)?;
        let slip = |key: &str, value: f64, own: String| {
            let text = format!("{key} is stated as {value}, but the other figures make it {own}");
            params.fault(key, text).hint("the figures contradict each other: which one is wrong?")
        };
        let off = |(_, line, n): &&(&str, Line, f64)| (model.index(line.wavelength_nm) - n).abs();
        if let Some(worst) = indices.iter().max_by(|a, b| off(a).total_cmp(&off(b)))
            && off(&worst) > TOLERANCE_N
        {
            return Err(slip(worst.0, worst.2, format!("{:.5}", model.index(worst.1.wavelength_nm))));
        }
        for (key, lines, v) in abbe {
            let own = lines.abbe_number(|w| model.index(w));
            if (own - v).abs() > TOLERANCE_V * v {
                return Err(slip(key, *v, format!("{own:.2}")));
            }
        }
        if model.falls() { Ok(model) } else { Err(no_such()) }
    }
}
