//! The documentation of a stage, taken from the schema of its parameters.

use super::SchemaOf;
use super::form::{ValueForm, ValueRange, alternatives, is, resolved};
use schemars::SchemaGenerator;
use serde::Serialize;
use serde_json::{Map, Value};

/// Documentation of a stage, or of any map whose parameters have a schema.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Documentation {
    /// The first paragraph.
    pub summary: String,
    /// The rest of the text, without examples and references; Markdown.
    pub text: String,
    /// Blocks of YAML, each valid in a file as it stands.
    pub examples: Vec<String>,
    /// Sources of formulas and data.
    pub references: Vec<String>,
    /// Parameters, in the order of their declaration.
    pub parameters: Vec<Parameter>,
}

/// Documentation of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Path of the key within the stage's map, such as `a.b` for key `b` of map `a`; `[]` stands for the elements of a list.
    pub key: String,
    /// Form of the value.
    #[serde(rename = "type")]
    pub form: ValueForm,
    /// Unit of a bare number; empty if it has none.
    pub unit: String,
    /// Allowed values.
    pub range: ValueRange,
    /// Default value; `None` if the parameter must be given, or if its absence has a meaning of its own.
    pub default: Option<Value>,
    /// Whether the parameter must be given.
    pub required: bool,
    /// Meaning of the parameter.
    pub description: String,
    /// Examples of the value.
    pub examples: Vec<Value>,
}

impl Documentation {
    /// Extracts the documentation from the schema of the parameters.
    #[must_use]
    pub fn of(schema: SchemaOf) -> Self {
        let mut generator = SchemaGenerator::default();
        let schema = schema(&mut generator);
        let definitions = generator.take_definitions(true);
        let description = schema.get("description").and_then(Value::as_str).unwrap_or_default();
        let mut found = Self::read(description);
        let all = |_: &str| true;
        parameters(schema.as_value(), &definitions, "", 0, &all, &mut found.parameters);
        of_kinds(schema.as_value(), &definitions, ("", "."), 1, &mut found.parameters);
        found
    }

    /// Splits a description into its sections.
    fn read(description: &str) -> Self {
        let mut sections: Vec<(String, Vec<&str>)> = vec![(String::new(), Vec::new())];
        let mut in_block = false;
        for line in description.lines() {
            in_block ^= line.trim_start().starts_with("```");
            match line.strip_prefix("# ").filter(|_| !in_block) {
                Some(title) => sections.push((title.trim().to_lowercase(), Vec::new())),
                None => sections.last_mut().expect("one is there").1.push(line),
            }
        }
        let (mut summary, mut text) = (String::new(), String::new());
        let (mut examples, mut references) = (Vec::new(), Vec::new());
        for (title, lines) in &sections {
            let body = lines.join("\n");
            match title.as_str() {
                "" => {
                    let (first, rest) = body.trim().split_once("\n\n").unwrap_or((body.trim(), ""));
                    summary = first.replace('\n', " ");
                    text = rest.trim().to_owned();
                }
                "example" | "examples" => {
                    let blocks = body.split("```").skip(1).step_by(2);
                    examples.extend(blocks.map(|block| {
                        let (_, code) = block.split_once('\n').unwrap_or(("", block));
                        code.trim_end().to_owned()
                    }));
                }
                "reference" | "references" => references = items(lines),
                other => {
                    text.push_str(&format!("\n\n# {other}\n{}", body.trim_end()));
                }
            }
        }
        Self { summary, text: text.trim().to_owned(), examples, references, parameters: Vec::new() }
    }
}

/// Returns the items of a Markdown list; continued lines belong to the item before.
fn items(lines: &[&str]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for line in lines.iter().map(|line| line.trim()).filter(|line| !line.is_empty()) {
        match (line.strip_prefix("- ").or(line.strip_prefix("* ")), found.last_mut()) {
            (Some(item), _) => found.push(item.to_owned()),
            (None, Some(last)) => {
                last.push(' ');
                last.push_str(line);
            }
            (None, None) => found.push(line.to_owned()),
        }
    }
    found
}

/// Deepest nesting that is shown.
const DEEPEST: usize = 4;

/// Adds the parameters of a map whose keys are wanted, and the parameters of the maps in them.
fn parameters(
    schema: &Value,
    definitions: &Map<String, Value>,
    prefix: &str,
    depth: usize,
    wanted: &dyn Fn(&str) -> bool,
    found: &mut Vec<Parameter>,
) {
    let Some(Value::Object(properties)) = schema.get("properties") else { return };
    let required = |key: &str| {
        schema.get("required").and_then(Value::as_array).is_some_and(|all| all.iter().any(|k| k.as_str() == Some(key)))
    };
    for (key, property) in properties {
        // The key that names the kind needs no entry.
        if property.get("const").is_some() || !wanted(key) {
            continue;
        }
        let path = format!("{prefix}{key}");
        let inner = resolved(property, definitions);
        let said = property.get("description").or_else(|| inner.get("description"));
        found.push(Parameter {
            key: path.clone(),
            form: ValueForm::of(property, definitions),
            unit: unit(inner, definitions).to_owned(),
            range: ValueRange::of(inner),
            default: property.get("default").or_else(|| inner.get("default")).filter(|d| !d.is_null()).cloned(),
            required: required(key),
            description: said.and_then(Value::as_str).unwrap_or_default().replace('\n', " "),
            examples: inner.get("examples").and_then(Value::as_array).cloned().unwrap_or_default(),
        });
        // Parts with a page of their own are documented there.
        if depth < DEEPEST && inner.get("x-see").is_none() {
            let inside =
                if is(inner, "array") { inner.get("items").map(|i| resolved(i, definitions)) } else { Some(inner) };
            let mark = if is(inner, "array") { "[]." } else { "." };
            let Some(inside) = inside.filter(|s| s.get("x-see").is_none()) else { continue };
            for map in maps(inside, definitions) {
                parameters(map, definitions, &format!("{path}{mark}"), depth + 1, &|_| true, found);
            }
            of_kinds(inside, definitions, (&path, mark), depth + 1, found);
        }
    }
}

/// Adds the parameters of each kind of a map and, once before them, those that all kinds share. `at` is the path of the map,
/// and the separator between it and a key.
fn of_kinds(
    schema: &Value,
    definitions: &Map<String, Value>,
    at: (&str, &str),
    depth: usize,
    found: &mut Vec<Parameter>,
) {
    let all = kinds(schema);
    let (path, mark) = at;
    let property = |map: &Value, key: &str| map.get("properties").and_then(|p| p.get(key)).cloned();
    let [(_, first), others @ ..] = &all[..] else { return };
    let shared = |key: &str| {
        let here = property(first, key);
        !others.is_empty() && here.is_some() && others.iter().all(|(_, map)| property(map, key) == here)
    };
    let prefix = if path.is_empty() { String::new() } else { format!("{path}{mark}") };
    parameters(first, definitions, &prefix, depth, &shared, found);
    for (kind, map) in &all {
        parameters(map, definitions, &format!("{path}({kind}){mark}"), depth, &|key| !shared(key), found);
    }
}

/// Returns the unit of a bare number, or of the items of a list.
fn unit<'a>(schema: &'a Value, definitions: &'a Map<String, Value>) -> &'a str {
    if let Some(unit) = schema.get("x-unit").and_then(Value::as_str) {
        return unit;
    }
    let items = schema.get("items").into_iter();
    let several = schema.get("prefixItems").and_then(Value::as_array).into_iter().flatten();
    let inner = items.chain(several).chain(alternatives(schema)).map(|s| resolved(s, definitions));
    inner.map(|s| if std::ptr::eq(s, schema) { "" } else { unit(s, definitions) }).find(|u| !u.is_empty()).unwrap_or("")
}

/// Returns the maps among the alternatives of a schema.
fn maps<'a>(schema: &'a Value, definitions: &'a Map<String, Value>) -> Vec<&'a Value> {
    if schema.get("properties").is_some() {
        return vec![schema];
    }
    alternatives(schema).map(|a| resolved(a, definitions)).filter(|a| a.get("properties").is_some()).collect()
}

/// Returns the kinds of a map that has a key for its kind, each with its schema; see [`crate::params::Kinds`].
fn kinds(schema: &Value) -> Vec<(&str, &Value)> {
    let one = schema.get("else").filter(|e| e.get("$ref").is_none()).unwrap_or(schema);
    let all = one.get("allOf").and_then(Value::as_array).into_iter().flatten();
    all.filter_map(|case| {
        let condition = case.get("if")?.get("properties")?.as_object()?;
        let kind = condition.values().next()?.get("const")?.as_str()?;
        let then = case.get("then")?;
        then.get("properties").is_some().then_some((kind, then))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::{Angle, Length, OrInfinity, Positive};
    use schemars::JsonSchema;
    use serde::Deserialize;

    /// A cone: it draws a beam out
    /// into a line.
    ///
    /// The tip is sharp.
    ///
    /// # Example
    /// ```yaml
    /// kind: cone
    /// angle: 5 deg
    /// ```
    /// # References
    /// - Somebody, J. Opt. Soc. Am. 44,
    ///   592 (1954).
    #[derive(Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, rename_all = "kebab-case")]
    #[allow(dead_code, reason = "only its schema is looked at")]
    struct ConeParams {
        /// Angle of the side, degrees if bare.
        angle: Angle,
        /// Where it ends.
        #[serde(default = "five")]
        end_radius: Positive<Length>,
        /// Where it begins.
        begin: Option<OrInfinity<Length>>,
        /// Terms.
        #[schemars(length(max = 20))]
        #[serde(default)]
        terms: Vec<f64>,
        /// The tip.
        tip: Option<Tip>,
    }

    /// A tip.
    #[derive(Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, rename_all = "kebab-case")]
    #[allow(dead_code, reason = "only its schema is looked at")]
    struct Tip {
        /// The shape.
        shape: Shape,
    }

    #[derive(Deserialize, JsonSchema)]
    #[serde(rename_all = "kebab-case")]
    #[allow(dead_code, reason = "only its schema is looked at")]
    enum Shape {
        /// Freshly made.
        Sharp,
        /// Worn by use.
        VeryRound,
    }

    fn five() -> Positive<Length> {
        Positive::from_bare(5.0)
    }

    use crate::params::Quantity;

    #[test]
    fn doc_comments_become_documentation() {
        let doc = Documentation::of(ConeParams::json_schema);
        assert_eq!(doc.summary, "A cone: it draws a beam out into a line.");
        assert_eq!(doc.text, "The tip is sharp.");
        assert_eq!(doc.examples, ["kind: cone\nangle: 5 deg"]);
        assert_eq!(doc.references, ["Somebody, J. Opt. Soc. Am. 44, 592 (1954)."]);
        let shown: Vec<String> = doc
            .parameters
            .iter()
            .map(|p| {
                let default = p.default.as_ref().map_or(String::new(), ToString::to_string);
                format!(
                    "{}: {} [{}] {} {default} {}",
                    p.key,
                    p.form,
                    p.unit,
                    p.range,
                    if p.required { "!" } else { "" }
                )
            })
            .collect();
        let wanted = [
            "angle: angle [deg]   !",
            "end-radius: length [mm] > 0 \"5 mm\" ",
            "begin: length or inf [mm]   ",
            "terms: list of number [] 20 of them at most [] ",
            "tip: map []   ",
            "tip.shape: sharp | very-round []   !",
        ];
        assert_eq!(shown, wanted);
        assert_eq!(doc.parameters[0].description, "Angle of the side, degrees if bare.");
    }
}
