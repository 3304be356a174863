//! Glass names of CODE V files.

use crate::glass::{Catalogs, FoundMedium, UserCatalog, look_up, maker_of_catalogue, model};
use crate::number;
use crate::prescription::Medium;
use spectra_glass::lines::{C, D, F};

/// A private glass: one for which the file has a table of indices.
#[derive(Clone, Debug)]
pub(super) struct Private {
    /// Name of the glass, without quotes.
    pub(super) name: String,
    /// Points of the table (wavelength in nm, index), in any order.
    pub(super) points: Vec<(f64, f64)>,
}

impl Private {
    /// Returns the index at a wavelength, interpolated linearly in 1 / wavelength^2, the variable of Cauchy's formula; `None` outside the
    /// table.
    fn index(&self, nm: f64) -> Option<f64> {
        let x = |nm: f64| 1.0 / (nm * nm);
        let below = self.points.iter().filter(|p| p.0 <= nm).max_by(|a, b| a.0.total_cmp(&b.0))?;
        let above = self.points.iter().filter(|p| p.0 >= nm).min_by(|a, b| a.0.total_cmp(&b.0))?;
        if below.0 == above.0 {
            return Some(below.1);
        }
        let t = (x(nm) - x(below.0)) / (x(above.0) - x(below.0));
        Some(below.1 + t * (above.1 - below.1))
    }

    /// Returns nd and Vd if the table covers F to C.
    fn figures(&self) -> Option<(f64, f64)> {
        let [nd, nf, nc] = [D, F, C].map(|line| self.index(line.wavelength_nm));
        let (nd, spread) = (nd?, nf? - nc?);
        Some((nd, if spread > 0.0 { (nd - 1.0) / spread } else { 0.0 }))
    }
}

/// Returns the medium of a name: `NBK7_SCHOTT`, `516800.641700`, `1.5168:64.17`, `'E48'`, `1.5`.
pub(super) fn medium(name: &str, private: &[Private], own: &[UserCatalog]) -> FoundMedium {
    let bare = name.trim_matches(['\'', '"']);
    if let Some(table) = private.iter().find(|table| table.name.eq_ignore_ascii_case(bare)) {
        return match table.figures() {
            Some((nd, vd)) => {
                let (nd, vd) = (round(nd), round(vd));
                let text = format!("glass {bare} has a table in the file, carried by its nd {nd} and Vd {vd}");
                let FoundMedium { medium, note } = model(nd, vd);
                FoundMedium { medium, note: note.or(Some((false, text))) }
            }
            None => FoundMedium {
                medium: Medium::Unknown { name: bare.to_owned() },
                note: Some((
                    true,
                    if table.points.is_empty() {
                        format!("glass {bare}: its formula is not read; write its nd and Vd")
                    } else {
                        format!("glass {bare}: its table does not reach from F to C")
                    },
                )),
            },
        };
    }
    if let Some((nd, vd)) = figures(bare) {
        return model(nd, vd);
    }
    if let Some((name, catalogue)) = bare.rsplit_once('_')
        && let Some(maker) = maker_of_catalogue(catalogue)
    {
        return look_up(name, None, Catalogs { own, makers: &[maker] });
    }
    // Names written by other programs: substance and measurement.
    if let Some((substance, author)) = bare.split_once('_') {
        let found = look_up(&format!("{substance}/{author}"), None, Catalogs::default());
        if !matches!(found.medium, Medium::Unknown { .. }) {
            return found;
        }
        let found = look_up(substance, None, Catalogs::default());
        if let Medium::Glass { name, .. } = &found.medium {
            let text = format!("{bare} is read as {name}");
            return FoundMedium { note: Some((false, text)), ..found };
        }
    }
    look_up(bare, None, Catalogs { own, makers: &["SCHOTT"] })
}

/// Returns the nd and Vd that a name spells: the digits of nd - 1, a point and the digits of Vd, the first two of them whole; or nd:Vd; or
/// an index.
fn figures(name: &str) -> Option<(f64, f64)> {
    if let Some((nd, vd)) = name.split_once(':') {
        return Some((number::parse(nd)?, number::parse(vd)?)).filter(|(nd, _)| (1.0..=4.0).contains(nd));
    }
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    match name.split_once('.') {
        Some((n, v)) if digits(n) && digits(v) && n.len() >= 2 && v.len() >= 2 => {
            let nd = number::parse(&format!("1.{n}"))?;
            let vd = number::parse(&format!("{}.{}", &v[..2], &v[2..]))?;
            Some((nd, vd))
        }
        _ => number::parse(name).filter(|n| (1.0..=4.0).contains(n)).map(|n| (n, 0.0)),
    }
}

/// Rounds to six decimals, because more would not be meaningful.
fn round(value: f64) -> f64 {
    format!("{value:.6}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_as_names() {
        for (name, wanted) in [
            ("516800.641700", Some((1.5168, 64.17))),
            ("517000.520000", Some((1.517, 52.0))),
            ("500.700", Some((1.5, 70.0))),
            ("569.631", Some((1.569, 63.1))),
            ("1.5168:64.17", Some((1.5168, 64.17))),
            ("1.5", Some((1.5, 0.0))),
            ("NBK7_SCHOTT", None),
            ("9.5", None),
        ] {
            assert_eq!(figures(name), wanted, "{name}");
        }
    }

    #[test]
    fn catalogue_names() {
        for (name, ours) in [
            ("NBK7_SCHOTT", "SCHOTT/N-BK7"),
            ("SLAL8_OHARA", "OHARA/S-LAL8"),
            ("f2", "SCHOTT/F2"),
            ("bk7", "SCHOTT/BK7"),
        ] {
            assert!(matches!(medium(name, &[], &[]).medium, Medium::Glass { name, .. } if name == ours), "{name}");
        }
    }

    /// N-BK7 sampled at a few lines gives back its nd and Vd within the accuracy of interpolation.
    #[test]
    fn private_tables_have_figures() {
        let points =
            vec![(700.0, 1.513_06), (587.5618, 1.516_80), (486.1327, 1.522_38), (546.074, 1.518_72), (650.0, 1.514_52)];
        let private = [Private { name: "OWN".to_owned(), points }];
        let Medium::Model { nd, vd: Some(vd), .. } = medium("'own'", &private, &[]).medium else {
            panic!("no figures")
        };
        assert!((nd - 1.5168).abs() < 1e-9 && (vd - 64.17).abs() < 0.1, "{nd} {vd}");
    }
}
