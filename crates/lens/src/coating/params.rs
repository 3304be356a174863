//! Reads coatings as lens files, scenes and files of their own write them.

use super::layers::{StackParams, stack};
use super::{Coating, MeasuredCoating};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use spectra_core::names::{self, nearest};
use spectra_core::params::{Fault, Faults, Kinds, Node, Params, SourceFile, Span, StageNode, Value, Whole, keys_of};
use spectra_core::registry::{self, Context, Stage};
use spectra_core::resources::{Resources, beside};
use spectra_core::spectral::BAND;
use std::sync::Arc;

/// The keys that every coating may have, whatever its kind; a file that holds a coating may have more of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct CoatingKeys {
    /// Version of the file format.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// Name of the coating, for people.
    #[expect(dead_code, reason = "for the reader of the file")]
    name: Option<String>,
    /// Source of the figures.
    #[expect(dead_code, reason = "for the reader of the file")]
    source: Option<String>,
    /// License of the figures.
    #[expect(dead_code, reason = "for the reader of the file")]
    license: Option<String>,
    /// License of the figures, as older files spell it.
    #[expect(dead_code, reason = "for the reader of the file")]
    licence: Option<String>,
    /// Remark for the reader of the file.
    #[expect(dead_code, reason = "for the reader of the file")]
    remark: Option<String>,
    /// Whether the coating is assumed for the lens, and not known.
    #[serde(default)]
    assumed: bool,
}

/// The schema of `coating` in a file: the name of a kind or of a file, or a map.
pub struct CoatingForm;

impl JsonSchema for CoatingForm {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CoatingForm".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        // A map that has `layers` is a stack, with or without `kind`.
        let shared = CoatingKeys::json_schema(generator);
        let kinds = vec![("stack", StackParams::json_schema(generator))];
        let stack = Kinds { key: "kind", kinds, default: Some("stack"), shared: Some(&shared), by_name: false };
        json_schema!({
            "x-words": "name, file or map",
            "x-see": "coating",
            "if": { "type": "string" },
            "else": {
                "if": { "not": { "required": ["kind"] }, "required": ["layers"] },
                "then": stack.schema(),
                "else": { "$ref": "#/$defs/coating" },
            },
        })
    }
}

/// Largest file of a measurement that is read, bytes.
const MAX_BYTES: u64 = 4 << 20;

/// A coating that a file states, and whether it is assumed or known.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedCoating {
    /// Coating that the file states.
    pub coating: Coating,
    /// Whether the coating is assumed (usual for lenses of its time), instead of known.
    pub assumed: bool,
}

/// Reads a coating: the name of a kind without parameters (`bare`, `three-layer`), a map, or the name of a file. A YAML file such
/// as `my-stack.yaml` holds a coating. A CSV file such as `my-coating.csv` holds a measured reflectance or transmittance.
///
/// # Errors
/// Faults in the coating, each with its place; faults in the file, with their place in the file.
pub fn read_coating(node: &StageNode, resources: &dyn Resources) -> Result<Coating, Faults> {
    Ok(read_stated_coating(node, resources)?.coating)
}

/// Reads a coating like [`read_coating`], and whether it is marked as assumed.
///
/// # Errors
/// Fails like [`read_coating`].
pub fn read_stated_coating(node: &StageNode, resources: &dyn Resources) -> Result<StatedCoating, Faults> {
    match node.node().as_str() {
        Some(name) if !known().contains(&name) => {
            named(name, node, resources).map(|coating| StatedCoating { coating, assumed: false })
        }
        _ => of_params(&node.params()?, resources),
    }
}

impl Coating {
    /// Returns the coating of this name: a kind without parameters, or a file. Faults quote the name as the command-line option
    /// `--coating`.
    ///
    /// # Errors
    /// A fault if there is no such kind or file; faults in the file.
    pub fn named(name: &str, resources: &dyn Resources) -> Result<Self, Faults> {
        let file = Arc::new(SourceFile::new(format!("--coating {name}"), name));
        let node = Node::new(Value::String(name.to_owned()), Span::default(), file);
        read_coating(&StageNode::new(node, ""), resources)
    }
}

/// Reads the coating of a map, or of a kind by its name.
fn of_params(params: &Params, resources: &dyn Resources) -> Result<StatedCoating, Faults> {
    let (keys, own) = params.split(&keys_of::<CoatingKeys>());
    let context = Context::new(resources, BAND);
    let mut faults = Faults::new();
    let keys = faults.take(keys.parse::<CoatingKeys>());
    let coating = match own.kind() {
        None if own.get("layers").is_some() => stack(&own, &context),
        _ => registry::build::<Coating>(&own, &context),
    };
    let coating = faults.take(coating);
    let (Some(keys), Some(coating)) = (keys, coating) else { return Err(faults) };
    Ok(StatedCoating { coating: *coating, assumed: keys.assumed })
}

/// Names of the registered kinds, sorted.
fn known() -> Vec<&'static str> {
    let mut names: Vec<&str> = Coating::entries().iter().map(|entry| entry.name).collect();
    names.sort_unstable();
    names
}

/// Reads the coating of a file. A fault if `name` is not the name of a file.
fn named(name: &str, node: &StageNode, resources: &dyn Resources) -> Result<Coating, Faults> {
    let (path, column) = match name.rsplit_once('#') {
        Some((file, column)) => (file.trim(), Some(column.trim())),
        None => (name, None),
    };
    let ending = path.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let found = beside(node.node(), path);
    match ending.as_deref() {
        Some("yaml" | "yml") => {
            let file = resources.document(&found, &[], &[]).map_err(|faults| placed(faults, node))?;
            Ok(of_params(&Params::stage(file.node().clone(), "")?, resources)?.coating)
        }
        Some("csv") => {
            let fault = |text: String| node.fault(text);
            let file = resources.read(&found, &[], &[], MAX_BYTES);
            let file = file.map_err(|e| fault(format!("`{path}`: {e}")))?;
            let measured = MeasuredCoating::from_table(&file.name, &file.bytes, column);
            measured.map(|m| Coating::Measured(Arc::new(m))).map_err(|e| e.faults(fault))
        }
        _ => {
            let known = known();
            let fault = node.fault(format!("unknown coating `{name}`"));
            Err(fault
                .hint(match nearest(name, known.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => {
                        let kinds = names::listed(&known, "spectra list coating");
                        format!("{kinds}, {{layer: 1.38, quarter-wave-at: 550 nm}}, or a file: my-stack.yaml, my-coating.csv")
                    }
                })
                .into())
        }
    }
}

/// Gives faults without a place the place of the value that names the file, for a file that was not found.
fn placed(faults: Faults, node: &StageNode) -> Faults {
    let place = |fault: Fault| {
        if fault.place.is_some() {
            return fault;
        }
        Fault { hint: fault.hint, ..node.fault(fault.message) }
    };
    faults.into_iter().map(place).collect::<Vec<_>>().into()
}
