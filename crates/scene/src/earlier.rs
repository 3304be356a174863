//! What pictures of one series share.

use crate::{Scene, SceneFilm};
use spectra_core::params::{Node, Params, Value};
use spectra_core::stage::{Imager, Source, WavelengthSampler};
use std::sync::Arc;

/// Stages of another picture of the same series: where a section says the same, its stage is taken over.
#[derive(Default)]
pub(crate) struct Earlier {
    pub params: Option<Params>,
    pub source: Option<Box<dyn Source>>,
    pub sampler: Option<Box<dyn WavelengthSampler>>,
    pub imager: Option<Box<dyn Imager>>,
    pub films: Option<Vec<SceneFilm>>,
    /// The scene is only looked at: noise and grain need not be those of its frame.
    pub is_check: bool,
}

impl Earlier {
    /// The stages of `scene`, of which nothing else is left.
    pub(crate) fn of(scene: Option<Scene>, is_check: bool) -> Self {
        let Some(Scene { params, source, sampler, imager, films, .. }) = scene else {
            return Self { is_check, ..Self::default() };
        };
        Self {
            params: Some(params),
            source: Some(source),
            sampler: Some(sampler),
            imager: Some(imager),
            films: (!films.is_empty()).then_some(films),
            is_check,
        }
    }

    /// Leaves nothing of what `params` say otherwise.
    pub(crate) fn fitting(self, params: &Params) -> Self {
        let same = |key: &str| self.params.as_ref().is_some_and(|before| same_section(before, params, key));
        // The band is everybody's.
        if !same("wavelengths") {
            return Self { is_check: self.is_check, ..Self::default() };
        }
        let (imager, films) = (same("imager"), same("film"));
        // A source that fills the frame has its size from the lens and the imager.
        let fills = params.get("source").is_some_and(fills_the_frame);
        let source = same("source") && (!fills || (imager && same("lens")));
        Self {
            source: self.source.filter(|_| source),
            // An imager with noise is the imager of its frame.
            imager: self.imager.filter(|_| imager && self.is_check),
            films: self.films.filter(|_| films),
            ..self
        }
    }
}

fn same_section(a: &Params, b: &Params, key: &str) -> bool {
    match (a.get(key), b.get(key)) {
        (None, None) => true,
        (Some(a), Some(b)) => same_node(a, b),
        _ => false,
    }
}

/// Whether a width within is `fill`.
fn fills_the_frame(node: &Node) -> bool {
    match &node.value {
        Value::Map(entries) => entries
            .iter()
            .any(|(key, value)| (key.text == "width" && value.as_str() == Some("fill")) || fills_the_frame(value)),
        Value::Seq(items) => items.iter().any(fills_the_frame),
        _ => false,
    }
}

/// Whether two trees say the same, in the same files (a name of a file counts from there).
fn same_node(a: &Node, b: &Node) -> bool {
    Arc::ptr_eq(&a.file, &b.file)
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
