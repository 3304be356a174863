//! Reuse of stages from a scene that was assembled before.
//!
//! A section whose values are unchanged keeps its stage. Stages that were replaced show what has to be computed again. If source,
//! lens, imager, wavelength density and channels are unchanged, the light is kept, whatever the film does with it. A wavelength
//! density depends only on spectra, so it is kept if the chart or the lens changes. A lens depends on its section, on the light
//! that it is focused in and on the plates in front of the frame, so it is kept if the frame turns.

use crate::build_messages::BuildMessages;
use crate::focus::FocusLight;
use crate::frame_view::ViewSearch;
use crate::landing;
use crate::lens_section::ConfiguredLens;
use crate::{RenderSettings, Scene, SceneFilm};
use spectra_core::cover::CoverStack;
use spectra_core::params::{Fault, Node, Params, Value};
use spectra_core::stage::{Imager, Source, WavelengthSampler};
use std::sync::Arc;

/// The focused lens of another scene.
struct Focused {
    params: Params,
    set: ConfiguredLens,
    light: FocusLight,
}

impl Focused {
    fn of(scene: &Scene) -> Option<Self> {
        let (light, warnings) = scene.focused.clone();
        let set = ConfiguredLens { lens: Arc::clone(&scene.lens), focus: scene.focus.clone(), warnings };
        Some(Self { params: scene.params.clone(), set, light: light? })
    }
}

/// Stages of an earlier scene. If a section is unchanged, its stage is taken over.
#[derive(Default)]
pub(crate) struct ReusableStages<'a> {
    params: Option<Params>,
    pub source: Option<Arc<dyn Source>>,
    pub sampler: Option<Arc<dyn WavelengthSampler>>,
    pub imager: Option<Arc<dyn Imager>>,
    pub films: Option<Vec<SceneFilm>>,
    /// Lenses as they were focused in earlier scenes.
    lenses: Vec<Focused>,
    frame: Option<u64>,
    said: BuildMessages,
    /// Whether the sections of lens and imager are unchanged.
    same_view: bool,
    /// Whether the scene is only checked: noise and grain need not be those of its frame.
    pub is_check: bool,
    /// Effort and workers of a new search for what the frame sees.
    pub search: ViewSearch<'a>,
}

impl<'a> ReusableStages<'a> {
    /// Takes the stages of `scene`. If nothing else holds them, they may be set to another frame.
    pub(crate) fn of(scene: Option<Arc<Scene>>, is_check: bool) -> Self {
        let Some(scene) = scene else { return Self { is_check, ..Self::default() } };
        Self {
            params: Some(scene.params.clone()),
            source: Some(Arc::clone(&scene.source)),
            sampler: Some(Arc::clone(&scene.sampler)),
            imager: Some(Arc::clone(&scene.imager)),
            films: (!scene.films.is_empty()).then(|| scene.films.clone()),
            lenses: Focused::of(&scene).into_iter().collect(),
            frame: scene.render.frame,
            said: scene.said.clone(),
            is_check,
            ..Self::default()
        }
    }

    /// Sets the effort and workers for the search for what the frame sees.
    pub(crate) fn by(self, search: ViewSearch<'a>) -> Self {
        Self { search, ..self }
    }

    /// Returns whether one of these lenses may be usable.
    pub(crate) fn may_have_lens(&self) -> bool {
        !self.lenses.is_empty()
    }

    /// Returns whether the kept source needs no new search for what the frame sees.
    pub(crate) fn knows_view(&self) -> bool {
        self.source.is_some() && (self.same_view || self.is_check)
    }

    /// Adds the lens of another scene as a candidate, and nothing else of that scene.
    pub(crate) fn and_lens_of(mut self, other: Option<&Scene>) -> Self {
        self.lenses.extend(other.and_then(Focused::of));
        self
    }

    /// Drops all stages whose sections differ in `params`.
    pub(crate) fn fitting(self, params: &Params) -> Self {
        let same = |key: &str| self.params.as_ref().is_some_and(|before| same_section(before, params, key));
        // All stages depend on the band.
        let mut lenses = self.lenses;
        lenses.retain(|known| ["wavelengths", "lens"].iter().all(|key| same_section(&known.params, params, key)));
        if !same("wavelengths") {
            return Self { is_check: self.is_check, search: self.search, lenses, ..Self::default() };
        }
        let (films, lens) = (same("film"), same("lens"));
        // An imager that centers on the light depends on all other sections.
        let follows = params.stage_at("imager").ok().flatten().is_some_and(|imager| landing::is_wanted(&imager));
        let imager = same("imager") && (!follows || (same("source") && lens && films));
        // A source that fills the frame gets its size from lens and imager.
        let fills = params.get("source").is_some_and(fills_the_frame);
        let source = same("source") && (!fills || (imager && lens));
        // An imager with noise and a film with grain belong to their frame.
        let frame = params.get("render").and_then(|render| render.get("frame"));
        let frame = match frame.map(|node| &node.value) {
            Some(Value::Number(number)) => number.text.parse().ok(),
            _ => None,
        };
        let in_time = self.is_check || self.frame == frame;
        let is_ours = |film: &SceneFilm| Arc::strong_count(&film.film) == 1;
        let kept = [("source", source), ("imager", imager), ("film", films), ("wavelengths", true)];
        let is_kept = |fault: &Fault| kept.iter().any(|(key, kept)| *kept && fault.path.starts_with(key));
        let mut said = self.said;
        said.warnings.retain(|warning| is_kept(&warning.0));
        said.ends.retain(|end| is_kept(&end.place));
        Self {
            source: self.source.filter(|_| source),
            imager: self.imager.filter(|_| imager && in_time),
            films: self.films.filter(|all| films && (in_time || all.iter().all(is_ours))),
            lenses,
            said,
            same_view: lens && imager,
            ..self
        }
    }

    /// Returns the lens if it was focused in this light and behind these cover plates before.
    pub(crate) fn lens_in(&mut self, light: Option<&FocusLight>, cover: Option<&CoverStack>) -> Option<ConfiguredLens> {
        let is_it = |known: &Focused| light == Some(&known.light) && cover == known.set.lens.cover.as_ref();
        std::mem::take(&mut self.lenses).into_iter().find(is_it).map(|known| known.set)
    }

    /// Takes the messages of the stages that are left.
    pub(crate) fn take_messages(&mut self) -> BuildMessages {
        std::mem::take(&mut self.said)
    }
}

impl Scene {
    /// Returns a copy with another seed.
    #[must_use]
    pub fn with_seed(&self, seed: u64) -> Self {
        let mut scene = self.clone();
        scene.render.seed = seed;
        scene
    }

    /// Returns whether light between the imager and the lens takes the same ways as in `other`: both have the same lens, imager, band and
    /// random numbers.
    #[must_use]
    pub fn has_the_view_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.lens, &other.lens)
            && same_section(&self.params, &other.params, "imager")
            && self.imager.size() == other.imager.size()
            && self.grid == other.grid
            && self.render.numbers == other.render.numbers
            && self.render.samples == other.render.samples
    }

    /// Returns whether rays of `other` differ from those of this scene in their seed only: both share the stages up to the imager. Films
    /// may differ if they record the same channels.
    #[must_use]
    pub fn differs_in_seed_only(&self, other: &Self) -> bool {
        let settings = |scene: &Self| RenderSettings { seed: 0, frame: None, ..scene.render };
        Arc::ptr_eq(&self.source, &other.source)
            && Arc::ptr_eq(&self.sampler, &other.sampler)
            && self.has_the_view_of(other)
            && self.channels == other.channels
            && self.picture_channels() == other.picture_channels()
            && self.ghost_paths() == other.ghost_paths()
            && settings(self) == settings(other)
    }
}

fn same_section(a: &Params, b: &Params, key: &str) -> bool {
    match (a.get(key), b.get(key)) {
        (None, None) => true,
        (Some(a), Some(b)) => same_node(a, b),
        _ => false,
    }
}

/// Returns whether a `width` anywhere in the node is `fill`.
fn fills_the_frame(node: &Node) -> bool {
    match &node.value {
        Value::Map(entries) => entries
            .iter()
            .any(|(key, value)| (key.text == "width" && value.as_str() == Some("fill")) || fills_the_frame(value)),
        Value::Seq(items) => items.iter().any(fills_the_frame),
        _ => false,
    }
}

/// Returns whether two trees have the same values from the same files (file names are relative to these).
fn same_node(a: &Node, b: &Node) -> bool {
    (Arc::ptr_eq(&a.file, &b.file) || (a.file.name == b.file.name && a.file.text == b.file.text))
        && match (&a.value, &b.value) {
            (Value::Null, Value::Null) => true,
            (Value::Bool(a), Value::Bool(b)) => a == b,
            (Value::Number(a), Value::Number(b)) => a.text == b.text && a.value.to_bits() == b.value.to_bits(),
            (Value::String(a), Value::String(b)) => a == b,
            (Value::Seq(a), Value::Seq(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same_node(a, b)),
            (Value::Map(a), Value::Map(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|((k, a), (l, b))| k.text == l.text && same_node(a, b))
            }
            _ => false,
        }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaml;
    use spectra_core::params::SourceFile;

    #[test]
    fn sections_are_the_same_where_they_say_the_same() {
        let file = SourceFile::new(
            "t.yaml",
            "a: {x: [1, two, null, true]}\nb: {x: [1, two, null, true]}\nc: {x: [1, two, null, false]}\nd: {y: [1, two, null, true]}\ne: {x: [1.0, two, null, true]}\n",
        );
        let root = yaml::parse(file).unwrap_or_else(|faults| panic!("{faults}"));
        let node = |key: &str| root.get(key).expect("there");
        assert!(same_node(node("a"), node("b")));
        for other in ["c", "d", "e"] {
            assert!(!same_node(node("a"), node(other)), "{other}");
        }
    }
}
