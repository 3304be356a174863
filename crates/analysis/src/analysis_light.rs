//! The light that an analysis uses, which selects the refractive indices.

use spectra_glass::{Medium, lines};
use spectra_lens::Lens;

/// The light of a whole analysis: one wavelength, or the indices that the prescription states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnalysisLight {
    /// A wavelength in air, nm. Every medium has the index of its formula there.
    Wavelength(f64),
    /// The indices stated in the prescription. A medium without one uses its formula at the reference wavelength.
    Stated,
}

impl AnalysisLight {
    /// Returns the lens with every medium (and the cover plates) fixed at its index in this light, whatever the wavelength.
    #[must_use]
    pub fn with_fixed_indices(self, lens: &Lens) -> Lens {
        let mut lens = lens.clone();
        let reference_nm = lens.reference_nm;
        for medium in &mut lens.media {
            let index = match self {
                Self::Wavelength(nm) => medium.medium.index(nm),
                Self::Stated => medium.stated_nd.unwrap_or_else(|| medium.medium.index(reference_nm)),
            };
            medium.medium = Medium::Constant(index);
        }
        let nm = self.wavelength_nm().unwrap_or(reference_nm);
        lens.cover = lens.cover.map(|cover| cover.at_wavelength(nm));
        lens
    }

    /// The wavelength in air, nm; `None` for [`AnalysisLight::Stated`], which uses the indices of the prescription.
    #[must_use]
    pub fn wavelength_nm(self) -> Option<f64> {
        match self {
            Self::Wavelength(nm) => Some(nm),
            Self::Stated => None,
        }
    }

    /// Name of the spectral line at exactly this wavelength; `None` if there is none.
    #[must_use]
    pub fn line(self) -> Option<&'static str> {
        let nm = self.wavelength_nm()?;
        lines::ALL.into_iter().find(|line| line.wavelength_nm == nm).map(|line| line.name)
    }

    /// Describes this light in words: `587.5618 nm (d)`, or `the stated indices`.
    #[must_use]
    pub fn describe(self) -> String {
        match (self.wavelength_nm(), self.line()) {
            (Some(nm), Some(line)) => format!("{nm} nm ({line})"),
            (Some(nm), None) => format!("{nm} nm"),
            (None, _) => "the stated indices".to_owned(),
        }
    }
}
