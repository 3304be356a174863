//! Changes of controls that a page sends.

use crate::page::ChangeKind;

/// Controls that do not apply to a draft, which has its own values.
const NOT_DRAFTED: [&str; 6] =
    ["width", "render.samples", "render.rays", "render.noise", "render.reflections.order", "render.diffraction"];
/// Keys that choose another film, and so need other light. Other keys of a film mostly leave the light valid.
const CHOOSES_FILM: [&str; 2] = ["stock", "kind"];

/// A change of one control.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// Path of the control.
    pub(super) control: String,
    pub(super) what: ChangeKind,
}

impl Change {
    /// Returns whether the change applies to a draft, too.
    pub(super) fn is_for_draft(&self) -> bool {
        !NOT_DRAFTED.contains(&&*self.control)
    }

    /// Returns whether the change belongs to the development of a film, so that it mostly leaves the light valid.
    pub(super) fn is_of_development(&self) -> bool {
        let key = self.control.rsplit('.').next();
        self.control.starts_with("film.") && !CHOOSES_FILM.iter().any(|chooses| key == Some(chooses))
    }
}
