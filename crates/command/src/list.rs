//! `spectra list`: what can be written in a scene.

use crate::arguments::List;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde::Serialize;
use spectra_core::{params, registry};
use std::fmt::Write;

/// Something that a scene can name.
#[derive(Debug, Serialize)]
struct Item {
    stage: &'static str,
    name: String,
    summary: Option<String>,
    package: &'static str,
    version: &'static str,
    default: bool,
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
        summary: Some(l.documentation().summary),
        package: l.package,
        version: l.version,
        default: l.default,
    });
    let bundled = |stage, name: &str| Item {
        stage,
        name: name.to_owned(),
        summary: None,
        package: "bundled",
        version: crate::version::VERSION,
        default: false,
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
    let width = items.iter().map(|item| item.name.len()).max().unwrap_or(0);
    let mut stage = "";
    for item in items {
        if item.stage != stage {
            let gap = if stage.is_empty() { "" } else { "\n" };
            stage = item.stage;
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{gap}{stage}");
        }
        let mut line = format!("  {:<width$}  {}", item.name, item.summary.as_deref().unwrap_or(""));
        if item.default {
            line.push_str(" (default)");
        }
        if item.package != "bundled" && !item.package.starts_with("spectra-plugin-") {
            let _ = write!(line, " [{} {}]", item.package, item.version);
        }
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(stage: &'static str, name: &str, package: &'static str, default: bool) -> Item {
        Item { stage, name: name.to_owned(), summary: Some("A thing.".to_owned()), package, version: "1.2.3", default }
    }

    #[test]
    fn stages_are_groups_and_strangers_are_named() {
        let items = [
            item("source", "chart", "spectra-plugin-sources", false),
            item("source", "far-lamp", "lamps", false),
            item("surface", "sphere", "spectra-plugin-surfaces", true),
        ];
        let wanted = "source\n  chart     A thing.\n  far-lamp  A thing. [lamps 1.2.3]\n\nsurface\n  sphere    A thing. (default)\n";
        assert_eq!(table(&items), wanted);
    }
}
