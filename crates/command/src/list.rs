//! `spectra list`: what can be written in a scene.

use crate::arguments::List;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_core::params;
use spectra_core::registry::{self, Documentation};
use std::fmt::Write;

/// Something that a scene can name.
#[derive(Debug, Serialize)]
struct Item {
    stage: &'static str,
    name: String,
    package: &'static str,
    version: &'static str,
    default: bool,
    /// Of a registered stage.
    documentation: Option<Documentation>,
}

/// Bundled files that a scene names: what they are called here, and where they lie.
const BUNDLED: [(&str, &str); 1] = [("lens", "lenses/")];

/// Shows the list.
pub(crate) fn list(arguments: &List) -> Outcome {
    let mut items = items();
    if let Some(stage) = &arguments.stage {
        let mut stages: Vec<&str> = items.iter().map(|item| item.stage).collect();
        stages.dedup();
        if !stages.contains(&stage.as_str()) {
            let near = params::nearest(stage, stages.iter().copied());
            let hint = near.map_or(String::new(), |near| format!("did you mean `{near}`? "));
            return Err(Failure::Input(format!("no stage is called `{stage}` ({hint}known: {})", stages.join(", "))));
        }
        items.retain(|item| item.stage == stage);
    }
    if arguments.json {
        console::pretty_json(&items)?;
    } else {
        console::out(&table(&items))?;
    }
    Ok(DONE)
}

fn items() -> Vec<Item> {
    let registered = registry::list().into_iter().map(|l| Item {
        stage: l.stage,
        name: l.name.to_owned(),
        package: l.package,
        version: l.version,
        default: l.default,
        documentation: Some(l.documentation()),
    });
    let bundled = |stage, name: &str| Item {
        stage,
        name: name.to_owned(),
        package: "bundled",
        version: crate::version::VERSION,
        default: false,
        documentation: None,
    };
    let files = BUNDLED.into_iter().flat_map(|(stage, folder)| {
        let names = spectra_data::list(folder).filter_map(move |path| path.strip_prefix(folder)?.strip_suffix(".yaml"));
        names.map(move |name| bundled(stage, name))
    });
    let stocks = spectra_film::stock::Stock::bundled().map(|name| bundled("stock", name));
    registered.chain(files).chain(stocks).collect()
}

fn table(items: &[Item]) -> String {
    let mut out = String::new();
    let width = |of: fn(&Item) -> usize| items.iter().map(of).max().unwrap_or(0);
    let (names, origins) = (width(|item| item.name.len()), width(|item| origin(item).len()));
    let mut stage = "";
    for item in items {
        if item.stage != stage {
            let gap = if stage.is_empty() { "" } else { "\n" };
            stage = item.stage;
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{gap}{stage}");
        }
        let mut line = format!("  {:<names$}  {:<origins$}", item.name, origin(item));
        if let Some(documentation) = &item.documentation {
            let _ = write!(line, "  {}", documentation.summary);
        }
        if item.default {
            line.push_str(" (default)");
        }
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

/// Where it comes from: crate and version.
fn origin(item: &Item) -> String {
    format!("{} {}", item.package, item.version)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(stage: &'static str, name: &str, package: &'static str, default: bool) -> Item {
        let documentation = Documentation {
            summary: "A thing.".to_owned(),
            text: String::new(),
            examples: Vec::new(),
            references: Vec::new(),
            parameters: Vec::new(),
        };
        let documentation = Some(documentation);
        Item { stage, name: name.to_owned(), package, version: "1.2.3", default, documentation }
    }

    #[test]
    fn stages_are_groups_with_their_crates() {
        let items = [
            item("source", "chart", "spectra-plugin-sources", false),
            item("source", "far-lamp", "lamps", false),
            item("surface", "sphere", "spectra-plugin-surfaces", true),
        ];
        let wanted = [
            "source",
            "  chart     spectra-plugin-sources 1.2.3   A thing.",
            "  far-lamp  lamps 1.2.3                    A thing.",
            "",
            "surface",
            "  sphere    spectra-plugin-surfaces 1.2.3  A thing. (default)",
            "",
        ];
        assert_eq!(table(&items), wanted.join("\n"));
    }
}
