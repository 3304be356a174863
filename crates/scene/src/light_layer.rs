//! Layers of light, separated by the way that it reached the imager.

use spectra_core::frame::ExposureChannel;

/// Ways in which light reaches the imager. All kinds together are the exposure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LightKind {
    /// Light that comes straight through the lens.
    Direct,
    /// Light from reflections that are traced as paths.
    Ghosts,
    /// Light from random walks inside the lens, or scattered by dirt on its glass.
    Glare,
    /// Light that diffraction moves; negative where it takes away more than it adds.
    Star,
}

impl LightKind {
    /// All kinds of light.
    pub const ALL: [Self; 4] = [Self::Direct, Self::Ghosts, Self::Glare, Self::Star];

    /// Returns the name of this kind in a scene and as a layer.
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

/// The ghost paths whose light a layer holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum GhostPaths {
    /// All paths; also used for every other kind of light.
    #[default]
    All,
    /// The path that these surfaces reflect, in the order of the light, counted from 1. The number after that of the last surface
    /// stands for the imager.
    One(Vec<usize>),
    /// All paths that have no layer of their own.
    Others,
}

/// A layer with the light of one kind, or of some paths of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLayer {
    /// Kind of the light.
    pub kind: LightKind,
    /// Ghost paths of the layer.
    pub paths: GhostPaths,
    /// Channels in the order of the exposure's channels, under names such as `ghosts.Y` and `ghosts.7-3.Y`.
    pub channels: Vec<ExposureChannel>,
}

impl LightLayer {
    /// Returns the name of a layer: `ghosts`, `ghosts.other`, or `ghosts.7-3` for light reflected by surface 7 and then by
    /// surface 3.
    ///
    /// Names have no commas, because some programs separate lists of channels by commas.
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
