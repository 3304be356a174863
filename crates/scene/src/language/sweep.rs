//! The `sweep` section: one scene, and several pictures that differ in named values.

use super::law::{Law, Track};
use super::picture_values::{PictureValues, SWEEP, check_path};
use super::variables::Variables;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Key, Node, StageNode, Value, Whole, keys_of};
use std::collections::BTreeMap;

/// Largest number of pictures of a sweep.
pub(super) const MAX_PICTURES: usize = 1000;
/// The values of one swept path.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub path: String,
    pub values: Vec<Node>,
}

/// The values that a sweep goes through.
#[derive(Clone, Debug)]
pub(super) enum Sweep {
    /// All combinations of the values of each path; the last path changes fastest.
    Product(Vec<Axis>),
    /// Lists of values that are set together.
    Together(Vec<PictureValues>),
}

/// The `sweep` section as written, for the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "its form is all that is wanted of it")]
pub(crate) enum Form {
    /// All combinations of the values of each path; the last path changes fastest.
    Product(BTreeMap<String, AxisForm>),
    /// Maps of values that are set together.
    Together(Vec<BTreeMap<String, StageNode>>),
}

/// The values of one path as written, for the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "its form is all that is wanted of it")]
pub(crate) enum AxisForm {
    /// A variable that holds a list.
    Variable(String),
    /// A list of values.
    List(Vec<StageNode>),
    /// A range of values.
    Range(Range),
}

/// A range of values as written in a sweep.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Range {
    /// The first value.
    from: StageNode,
    /// The last value.
    to: StageNode,
    /// Number of values, including both ends.
    steps: Whole<2, { MAX_PICTURES as u64 }>,
    /// Spacing of the values: `linear`, `logarithmic` or `reciprocal`.
    #[serde(default)]
    spacing: Spacing,
}

/// Spacings of the values of a range.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Spacing {
    #[default]
    Linear,
    Logarithmic,
    Reciprocal,
}

impl Sweep {
    /// Reads the section. `$name` in it stands for the scene's own variables.
    ///
    /// # Errors
    /// Every fault of the section; more than [`MAX_PICTURES`] pictures.
    pub(super) fn read(section: &Node, variables: &Variables) -> Result<Self, Faults> {
        match &section.value {
            Value::Map(entries) if !entries.is_empty() => product(section, entries, variables),
            Value::Seq(items) if !items.is_empty() => together(section, items),
            _ => {
                let fault = section.fault("a sweep must list the values to try").path(SWEEP);
                Err(fault.hint("such as `sweep: {lens.f-number: [f/2, f/4, f/8]}`").into())
            }
        }
    }

    /// Returns the settings of all pictures, in order.
    pub(super) fn settings(&self) -> Vec<PictureValues> {
        match self {
            Self::Together(settings) => settings.clone(),
            Self::Product(axes) => axes.iter().fold(vec![PictureValues::new()], |settings, axis| {
                let with = |setting: &PictureValues, value: &Node| {
                    setting.iter().cloned().chain([(axis.path.clone(), value.clone())]).collect()
                };
                settings.iter().flat_map(|setting| axis.values.iter().map(move |value| with(setting, value))).collect()
            }),
        }
    }
}

fn product(section: &Node, entries: &[(Key, Node)], variables: &Variables) -> Result<Sweep, Faults> {
    let mut faults = Faults::new();
    let mut axes = Vec::new();
    let mut pictures = Some(1_usize);
    for (key, node) in entries {
        faults.take(check_path(key, node, SWEEP));
        let Some(values) = faults.take(axis(key, node, variables)) else { continue };
        pictures = pictures.and_then(|n| n.checked_mul(values.len()));
        axes.push(Axis { path: key.text.clone(), values });
    }
    if pictures.is_none_or(|n| n > MAX_PICTURES) {
        let many = pictures.map_or("too many".to_owned(), |n| n.to_string());
        faults.push(too_many(section, &many));
    }
    faults.into_result(Sweep::Product(axes))
}

fn too_many(section: &Node, pictures: &str) -> Fault {
    let fault =
        section.fault(format!("the sweep has {pictures} pictures, but at most {MAX_PICTURES} can be made")).path(SWEEP);
    fault.hint("write fewer values, or list values that go together in one map: `sweep: [{a: 1, b: 2}, ...]`")
}

/// Returns the values of one path.
fn axis(key: &Key, node: &Node, variables: &Variables) -> Result<Vec<Node>, Faults> {
    let path = format!("{SWEEP}.{}", key.text);
    // A list given by a variable is needed now; variables inside a written list are replaced later, for each picture.
    let opened = match &node.value {
        Value::String(_) => variables.put_into_part(node)?,
        _ => node.clone(),
    };
    match &opened.value {
        Value::Seq(items) if !items.is_empty() && items.len() <= MAX_PICTURES => Ok(items.clone()),
        Value::Seq(items) if items.len() > MAX_PICTURES => {
            Err(too_many(node, &items.len().to_string()).path(path).into())
        }
        // A path written as nested maps instead of with dots.
        Value::Map(entries) if entries.first().is_some_and(|(key, _)| !keys_of::<Range>().contains(&key.text)) => {
            let fault = node.fault("a swept path must have a list of values, or a range").path(path);
            let joined = entries.first().map_or_else(String::new, |(inner, _)| format!("{}.{}", key.text, inner.text));
            Err(fault.hint(format!("join the keys of a path by dots: `{SWEEP}: {{{joined}: ...}}`")).into())
        }
        Value::Map(entries) if !entries.is_empty() => {
            let range = variables.put_into_part(&opened)?;
            steps_of(&StageNode::new(range, path))
        }
        _ => {
            let fault = node.fault("a swept path must have a list of values, or a range").path(path);
            Err(fault.hint("such as `[f/2, f/4]` or `{from: f/2, to: f/8, steps: 5, spacing: logarithmic}`").into())
        }
    }
}

fn steps_of(node: &StageNode) -> Result<Vec<Node>, Faults> {
    let range: Range = node.parse()?;
    let law = match range.spacing {
        Spacing::Linear => Law::Linear,
        Spacing::Logarithmic => Law::Logarithmic,
        Spacing::Reciprocal => Law::Reciprocal,
    };
    let ends = [range.from.node().clone(), range.to.node().clone()];
    let last = (range.steps.get() - 1) as f64;
    let track = Track::new(&[0.0, last], &ends, law).map_err(|fault| fault.path(node.path()))?;
    Ok((0..range.steps.size()).map(|i| track.value_at(i as f64)).collect())
}

fn together(section: &Node, items: &[Node]) -> Result<Sweep, Faults> {
    let mut faults = Faults::new();
    if items.len() > MAX_PICTURES {
        faults.push(too_many(section, &items.len().to_string()));
    }
    let mut settings = Vec::new();
    for (at, item) in items.iter().enumerate() {
        let Value::Map(entries) = &item.value else {
            let fault = item
                .fault("each entry of such a sweep must be a map from paths to values")
                .path(format!("{SWEEP}[{at}]"));
            faults.push(
                fault.hint("such as `[{film.stock: a, lens.f-number: f/2}, {film.stock: b, lens.f-number: f/4}]`"),
            );
            continue;
        };
        for (key, value) in entries {
            faults.take(check_path(key, value, &format!("{SWEEP}[{at}]")));
        }
        settings.push(entries.iter().map(|(key, value)| (key.text.clone(), value.clone())).collect());
    }
    faults.into_result(Sweep::Together(settings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer::one_line;
    use crate::yaml::parse;
    use spectra_core::params::SourceFile;

    fn settings(text: &str) -> Result<Vec<String>, String> {
        let root = parse(SourceFile::new("t.yaml", text)).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        let variables = Variables::of(root.get("variables")).expect("variables");
        let sweep =
            Sweep::read(root.get("sweep").expect("a sweep"), &variables).map_err(|faults| faults.to_string())?;
        let words = |s: &PictureValues| {
            s.iter().map(|(path, node)| format!("{path}={}", one_line(node))).collect::<Vec<_>>().join(" ")
        };
        Ok(sweep.settings().iter().map(words).collect())
    }

    #[test]
    fn the_last_path_of_a_product_changes_fastest() {
        let all = settings("sweep: {a.b: [x, y], c: [1, 2, 3]}").expect("good");
        assert_eq!(all, ["a.b=x c=1", "a.b=x c=2", "a.b=x c=3", "a.b=y c=1", "a.b=y c=2", "a.b=y c=3"]);
    }

    #[test]
    fn values_can_go_together() {
        let all = settings("sweep: [{a: 1, b: {c: 2}}, {a: 2}]").expect("good");
        assert_eq!(all, ["a=1 b={c: 2}", "a=2"]);
    }

    #[test]
    fn ranges_end_where_they_say() {
        for (range, wanted) in [
            ("{from: f/2, to: f/8, steps: 3, spacing: logarithmic}", "f/2 f/4 f/8"),
            ("{from: 1 m, to: 20 cm, steps: 3}", "1 m 0.6 m 20 cm"),
            ("{from: inf, to: 1 m, steps: 3, spacing: reciprocal}", "inf 2 m 1 m"),
            ("{from: $near, to: 3 m, steps: 2}", "1 m 3 m"),
            ("$list", "1 2"),
        ] {
            let all =
                settings(&format!("variables: {{near: 1 m, list: [1, 2]}}\nsweep: {{a: {range}}}\n")).expect(range);
            assert_eq!(all.join(" ").replace("a=", ""), wanted, "{range}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_at_its_place() {
        let many = format!("{{a: [{}], b: {{from: 1, to: 2, steps: 51}}}}", "1, ".repeat(20));
        for (sweep, said) in [
            ("{}", "a sweep must list the values to try"),
            ("3", "t.yaml:1:8: a sweep must list"),
            ("{a: 3}", "t.yaml:1:12: a swept path must have a list of values"),
            ("{a: []}", "a swept path must have a list of values"),
            ("{a..b: [1]}", "t.yaml:1:9: `a..b` is not a path: a key is empty"),
            ("{animation.frames: [1]}", "`animation` cannot change from picture to picture"),
            ("{a: {b: [1, 2]}}", "join the keys of a path by dots: `sweep: {a.b: ...}`"),
            ("{a: {from: 1, to: 2}}", "missing key `steps`"),
            ("{a: {from: 1, to: 2, stops: 3}}", "unknown key `stops` (did you mean `steps`?)"),
            (
                "{a: {from: 1, to: 2, steps: 1}}",
                "t.yaml:1:36: found 1, which is out of range (a whole number from 2 to 1000)",
            ),
            ("{a: {from: 1, to: 2, steps: 1e9}}", "found 1e9, which is out of range"),
            ("{a: {from: 1, to: 2, steps: 3, spacing: log}}", "unknown value `log` for `spacing`"),
            ("{a: {from: 1 m, to: 2 s, steps: 3}}", "`2 s` and `1 m` are of different kinds"),
            (&many, "the sweep has 1020 pictures, but at most 1000 can be made"),
            ("[3]", "t.yaml:1:9: each entry of such a sweep must be a map"),
            ("[{sweep: 1}]", "`sweep` cannot change from picture to picture"),
        ] {
            let error = settings(&format!("sweep: {sweep}\n")).expect_err(said);
            assert!(error.contains(said), "{error}");
        }
    }
}
