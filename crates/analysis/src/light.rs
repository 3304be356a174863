//! Which refractive indices a lens is looked at with.

use spectra_glass::{Medium, lines};
use spectra_lens::Lens;

/// One light for a whole analysis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A wavelength in air, nm: every medium at its formula's index there.
    Wavelength(f64),
    /// Every medium at the index that the prescription states, where it does.
    Stated,
}

impl Light {
    /// The lens with every medium held at its index in this light, whatever the wavelength.
    #[must_use]
    pub fn hold(self, mut lens: Lens) -> Lens {
        let reference_nm = lens.reference_nm;
        for medium in &mut lens.media {
            let index = match self {
                Self::Wavelength(nm) => medium.medium.index(nm),
                Self::Stated => medium.stated_nd.unwrap_or_else(|| medium.medium.index(reference_nm)),
            };
            medium.medium = Medium::Constant(index);
        }
        let nm = self.wavelength_nm().unwrap_or(reference_nm);
        lens.cover = lens.cover.map(|cover| cover.held_at(nm));
        lens
    }

    /// The wavelength, nm, if it is one.
    #[must_use]
    pub fn wavelength_nm(self) -> Option<f64> {
        match self {
            Self::Wavelength(nm) => Some(nm),
            Self::Stated => None,
        }
    }

    /// The name of the spectral line that lies exactly there, if one does.
    #[must_use]
    pub fn line(self) -> Option<&'static str> {
        let nm = self.wavelength_nm()?;
        lines::ALL.into_iter().find(|line| line.wavelength_nm == nm).map(|line| line.name)
    }

    /// In words: `587.5618 nm (d)`, or `the stated indices`.
    #[must_use]
    pub fn describe(self) -> String {
        match (self.wavelength_nm(), self.line()) {
            (Some(nm), Some(line)) => format!("{nm} nm ({line})"),
            (Some(nm), None) => format!("{nm} nm"),
            (None, _) => "the stated indices".to_owned(),
        }
    }
}
