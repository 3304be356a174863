//! Signs of misread glass figures: more axial color than designers leave, and a medium that no maker melts.

use crate::{Lens, LensMedium};
use spectra_core::surface::Action;
use spectra_glass::lines::D;
use spectra_glass::{Catalog, LineTriple, Medium};

/// Axial color above this fraction of the focal length is questioned: corrected lenses of the library leave 0.1 to 0.35 %.
const MOST_COLOR: f64 = 0.004;
/// Two indices that differ by less count as the same figure.
const SAME_INDEX: f64 = 1e-5;
/// At the same index, Abbe numbers that differ by more belong to different kinds of glass.
const OTHER_KIND: f64 = 5.0;

/// A dispersive medium behind a refracting surface.
struct Disperser<'a> {
    surface: usize,
    medium: &'a Medium,
    nd: f64,
    vd: f64,
}

impl Lens {
    /// Returns a warning for each sign of a misread index or Abbe number. One sign is axial color above 0.4 % of the focal length
    /// where two or more glasses refract. The other is a pair of media with the same index and Abbe numbers more than 5 apart, if
    /// one of them is far from every glass of the catalogue. There is no warning about axial color if a glass was not measured at
    /// both lines.
    #[must_use]
    pub fn glass_warnings(&self) -> Vec<String> {
        let dispersers = self.dispersers();
        self.color_doubt(&dispersers).into_iter().chain(twins(&dispersers)).collect()
    }

    /// Returns how far (mm) the focus of the blue line lies behind the focus of the red line. These are the outer lines of the
    /// lens's Abbe numbers, usually F and C.
    #[must_use]
    pub fn axial_color_mm(&self) -> f64 {
        let back_mm = |nm: f64| self.first_order(nm).bfl_mm;
        back_mm(self.abbe_lines.short.wavelength_nm) - back_mm(self.abbe_lines.long.wavelength_nm)
    }

    /// Lists the dispersive media behind refracting surfaces, each once.
    fn dispersers(&self) -> Vec<Disperser<'_>> {
        let mut found: Vec<Disperser<'_>> = Vec::new();
        for (at, e) in self.elements.iter().enumerate() {
            let LensMedium { medium, stated_nd, .. } = &self.media[e.medium_after];
            let refracts = e.action == Action::Refract && e.medium_after != e.medium_before;
            let is_glass = matches!(medium, Medium::Model(_) | Medium::Glass(_));
            if !refracts || !is_glass || found.iter().any(|d| d.medium == medium) {
                continue;
            }
            let stated = stated_nd.filter(|_| self.reference_nm == D.wavelength_nm);
            let nd = stated.unwrap_or_else(|| medium.index(D.wavelength_nm));
            let vd = medium.abbe_number(LineTriple::FDC);
            if vd.is_finite() {
                found.push(Disperser { surface: at + 1, medium, nd, vd });
            }
        }
        found
    }

    fn color_doubt(&self, dispersers: &[Disperser<'_>]) -> Option<String> {
        let (short, long) = (self.abbe_lines.short, self.abbe_lines.long);
        let measured = |d: &Disperser<'_>| d.medium.covers(short.wavelength_nm, long.wavelength_nm);
        if dispersers.len() < 2 || !dispersers.iter().all(measured) {
            return None;
        }
        let color_mm = self.axial_color_mm();
        let part = (color_mm / self.first_order(self.reference_nm).efl_mm).abs();
        (part.is_finite() && part > MOST_COLOR).then(|| {
            format!(
                 "the foci of {} and {} lie {:.3} mm apart, {:.2} % of the focal length; corrected lenses leave 0.1 to 0.3 %: is an index \
                  or an Abbe number misread?",
                short.label(),
                long.label(),
                color_mm.abs(),
                100.0 * part
            )
        })
    }
}

/// Returns a warning for each pair of media with the same index but different Abbe numbers, at least one of them far from every glass.
fn twins(dispersers: &[Disperser<'_>]) -> Vec<String> {
    let mut all = Vec::new();
    for (i, one) in dispersers.iter().enumerate() {
        for other in &dispersers[i + 1..] {
            let alike = (one.nd - other.nd).abs() <= SAME_INDEX;
            if !alike || (one.vd - other.vd).abs() <= OTHER_KIND {
                continue;
            }
            let far =
                [one, other].into_iter().filter(|d| is_far(d)).map(|d| format!("{:.1}", d.vd)).collect::<Vec<_>>();
            if far.is_empty() {
                continue;
            }
            all.push(format!(
                 "the media behind surfaces {} and {} have the same index, {:.5}, but Abbe numbers of {:.1} and {:.1}, and no glass of \
                  the catalogue is near that of {}: is one of them misread?",
                one.surface,
                other.surface,
                one.nd,
                one.vd,
                other.vd,
                far.join(", nor near that of ")
            ));
        }
    }
    all
}

/// Whether no glass of the catalogue is near these figures. A medium with data of its own counts as a glass.
fn is_far(d: &Disperser<'_>) -> bool {
    matches!(d.medium, Medium::Model(_)) && !Catalog::bundled().has_near(d.nd, d.vd)
}
