//! A glass by its figures, as patents state them.

use crate::formula::ModelGlass;
use crate::lines::{self, Line, LineTriple};
use crate::medium::Medium;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Params};

/// Where a stated index is farther from that of all figures together, one of them is a slip.
const TOLERANCE_N: f64 = 1e-4;
/// The same for an Abbe number, as part of it.
const TOLERANCE_V: f64 = 0.01;

/// A glass by its figures: one index alone has no dispersion; with an Abbe number, or with more indices, it has that of
/// ordinary glasses with these figures.
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
}

impl Figures {
    /// The indices with their keys, that at the reference line of a patent first: d, else e, else D.
    fn indices(&self) -> Vec<(&'static str, Line, f64)> {
        let all = [
            ("nd", lines::D, self.nd),
            ("ne", lines::E, self.ne),
            ("nD", lines::SODIUM_D, self.n_sodium),
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

    /// The Abbe numbers with their keys.
    fn abbe_numbers(&self) -> Vec<(&'static str, LineTriple, f64)> {
        let all = [
            ("vd", LineTriple::FDC, self.vd),
            ("ve", LineTriple::F_PRIME_E_C_PRIME, self.ve),
            ("vD", LineTriple::F_SODIUM_C, self.v_sodium),
        ];
        all.into_iter().filter_map(|(key, lines, v)| Some((key, lines, v?))).collect()
    }

    /// The index stated at a line.
    #[must_use]
    pub fn index_at(&self, wavelength_nm: f64) -> Option<f64> {
        self.indices().into_iter().find(|(_, line, _)| line.wavelength_nm == wavelength_nm).map(|(_, _, n)| n)
    }

    /// Whether nothing is stated.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices().is_empty() && self.abbe_numbers().is_empty()
    }

    /// Every figure with its key and what an index function makes of it, and by how much the two may differ: 5e-4 in
    /// an index, 0.5 in an Abbe number.
    pub(super) fn against(&self, n: impl Fn(f64) -> f64) -> Vec<(&'static str, f64, f64, f64)> {
        let indices = self.indices().into_iter().map(|(key, line, stated)| (key, stated, n(line.wavelength_nm), 5e-4));
        let abbe = self.abbe_numbers().into_iter().map(|(key, lines, v)| (key, v, lines.abbe_number(&n), 0.5));
        indices.chain(abbe).collect()
    }

    /// The medium of these figures, and how a report calls it. `params` places faults.
    ///
    /// # Errors
    /// No index; a figure that no glass has; figures that contradict each other.
    pub fn medium(&self, params: &Params) -> Result<(Medium, String), Fault> {
        let (indices, abbe) = (self.indices(), self.abbe_numbers());
        let figure = |(key, value): (&str, f64)| format!("{key} = {value}");
        let named = indices.iter().map(|(key, _, n)| (*key, *n)).chain(abbe.iter().map(|(key, _, v)| (*key, *v)));
        let label = match (&indices[..], &abbe[..]) {
            ([(_, _, n)], []) => format!("n = {n}"),
            _ => named.map(figure).collect::<Vec<_>>().join(", "),
        };
        let medium = match (&indices[..], &abbe[..]) {
            ([], []) => {
                let fault = params.fault_here("the glass has no index");
                return Err(
                    fault.hint("`nd` and `vd`, `ne` and `ve`, or indices at several lines: `nd`, `ng`, `nF`, `nC`")
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
        let falls = (350..830).all(|nm| model.index(f64::from(nm)) > model.index(f64::from(nm + 1)));
        if falls { Ok(model) } else { Err(no_such()) }
    }
}
