//! Light by the way that it came to the imager.

use spectra_core::frame::ExposureChannel;

/// How light came to the imager. All kinds together are the exposure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LightKind {
    /// Straight through the lens.
    Direct,
    /// By reflections that are traced as paths.
    Ghosts,
    /// By walks inside the lens, or scattered by what lies on its glass.
    Glare,
    /// What diffraction moves: it is negative where more is taken away than comes.
    Star,
}

impl LightKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Direct, Self::Ghosts, Self::Glare, Self::Star];

    /// Its name in a scene, and as a layer.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Ghosts => "ghosts",
            Self::Glare => "glare",
            Self::Star => "star",
        }
    }
}

/// Which paths of ghosts a layer has the light of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum GhostPaths {
    /// All of them; so has every other kind of light.
    #[default]
    All,
    /// That which these surfaces reflect, in the order of the light, counted from 1; one more than the lens has is the imager.
    One(Vec<usize>),
    /// All that have no layer of their own.
    Others,
}

/// The light of one kind, or of some paths of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLayer {
    /// Which one.
    pub kind: LightKind,
    /// Of which paths.
    pub paths: GhostPaths,
    /// Channels in the order of the exposure's, under names such as `ghosts.Y` and `ghosts.7-3.Y`.
    pub channels: Vec<ExposureChannel>,
}

impl LightLayer {
    /// A layer's name: `ghosts`, `ghosts.7-3` for what the seventh surface and then the third one reflect, `ghosts.other`.
    ///
    /// No comma, as programs that take lists of channels part them by commas.
    #[must_use]
    pub fn name(kind: LightKind, paths: &GhostPaths) -> String {
        match paths {
            GhostPaths::All => kind.name().to_owned(),
            GhostPaths::One(surfaces) => {
                let surfaces: Vec<String> = surfaces.iter().map(usize::to_string).collect();
                format!("{}.{}", kind.name(), surfaces.join("-"))
            }
            GhostPaths::Others => format!("{}.other", kind.name()),
        }
    }
}
