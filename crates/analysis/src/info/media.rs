//! Assumptions about the media of a lens: modeled dispersion, and absorption borrowed from similar glasses.

use serde::Serialize;
use spectra_glass::{AbsorptionSubstitute, Medium};
use spectra_lens::Lens;
use spectra_sheet::Sheet;

/// A medium with assumed properties.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssumedMedium {
    /// Name of the medium in the lens file.
    pub medium: String,
    /// Number of lines at which its index is stated, if no formula is known. The dispersion is then that of ordinary glasses with these
    /// figures. `None` if a formula is known.
    pub modeled_from_lines: Option<usize>,
    /// Glass whose absorption is used instead; `None` if the absorption is known, or no similar glass is.
    pub absorption_of: Option<String>,
    /// Index and Abbe number of that glass minus those of the medium.
    pub absorption_delta: Option<[f64; 2]>,
}

/// Lists the media of a lens with assumed properties, in the order of the light.
pub(super) fn assumed(lens: &Lens) -> Vec<AssumedMedium> {
    let each = lens.media.iter().filter_map(|m| {
        let modeled = match &m.medium {
            Medium::Model(model) => Some(model.stated_lines()),
            Medium::Glass(glass) => match &glass.formula {
                spectra_glass::Formula::Model(model) => Some(model.stated_lines()),
                _ => None,
            },
            _ => None,
        };
        let lender: Option<AbsorptionSubstitute> =
            m.medium.absorption(lens.year).and_then(|a| a.lender).filter(|_| lens.absorption);
        (modeled.is_some() || lender.is_some()).then(|| AssumedMedium {
            medium: m.label.clone(),
            modeled_from_lines: modeled,
            absorption_delta: lender.as_ref().map(|l| [l.delta_nd, l.delta_vd]),
            absorption_of: lender.map(|l| l.full_name),
        })
    });
    each.collect()
}

/// Adds sentences about these media to a sheet; adds none if nothing is assumed.
pub(super) fn note(media: &[AssumedMedium], sheet: &mut Sheet) {
    let list = |is_asked: &dyn Fn(usize) -> bool| {
        let asked = media.iter().filter(|m| m.modeled_from_lines.is_some_and(is_asked));
        asked.map(|m| m.medium.as_str()).collect::<Vec<_>>().join("; ")
    };
    let modeled = list(&|lines| lines == 1);
    if !modeled.is_empty() {
        sheet.note(&format!("modeled dispersion (ordinary glass of this nd and Vd): {modeled}"));
        sheet.note("  for nine glasses out of ten the index is right within 0.0002 at r, 0.0004 at g and 0.0009 at h;");
        sheet.note("  the error is larger for dense flints, short flints, fluor crowns and phosphate crowns");
    }
    let through = list(&|lines| lines > 1);
    if !through.is_empty() {
        sheet.note(&format!("modeled dispersion (interpolated between the stated lines): {through}"));
    }
    let borrowed: Vec<String> =
        media.iter().filter_map(|m| Some(format!("{} from {}", m.medium, m.absorption_of.as_ref()?))).collect();
    if !borrowed.is_empty() {
        sheet.note(&format!("absorption taken from a similar glass (assumed): {}", borrowed.join("; ")));
    }
}
