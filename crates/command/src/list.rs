//! `spectra list`: lists all names that can be used, with the figures to choose by.

use crate::arguments::List;
use crate::console;
use crate::outcome::{DONE, Outcome};
use serde::Serialize;
use serde_json::{Map, Value, json};
use spectra_analysis::fan::largest_field_rad;
use spectra_core::names;
use spectra_core::params::Fault;
use spectra_core::registry::{self, Documentation, Listed};
use spectra_film::stock::{Process, Stock};
use spectra_glass::Catalog;
use spectra_lens::Section;
use spectra_optics::Optics;
use spectra_scene::bundled::{self, Bundled};
use spectra_scene::{FileKind, FileResources, file_schema};
use spectra_spectrum::table::Table;
use std::fmt::Write;
use std::path::Path;

/// An entry of the list: something that a scene or a command can name.
#[derive(Debug, Serialize)]
struct Item {
    stage: &'static str,
    name: String,
    package: &'static str,
    version: &'static str,
    default: bool,
    /// Documentation of a registered stage; `None` for bundled data.
    documentation: Option<Documentation>,
    /// Figures to choose by; their names contain the units.
    #[serde(flatten)]
    figures: Map<String, Value>,
    /// The figures formatted as columns of text.
    #[serde(skip)]
    columns: Vec<String>,
    /// One-line description of the entry.
    summary: String,
}

/// Kinds of bundled data, in the order of the list; the other kinds are registered stages.
const KINDS: [&str; 7] = ["scene", "lens", "stock", "spectrum", "glass", "sensor", "format"];
/// Kinds with too many entries to appear in the list of everything.
const LONG: [&str; 2] = ["spectrum", "glass"];
/// Largest half field angle to search for, degrees.
const WIDEST_DEG: f64 = 85.0;

/// Writes the list to standard output.
pub(crate) fn list(arguments: &List) -> Outcome {
    let mut kinds: Vec<&str> = registry::list().iter().map(|l| l.stage).collect();
    kinds.dedup();
    // `spectrum` is both a kind of stage and a kind of file.
    kinds.retain(|kind| !KINDS.contains(kind));
    kinds.extend(KINDS);
    let all = kinds.clone();
    let wanted = match &arguments.stage {
        Some(typed) => vec![kind(typed, &kinds)?],
        None => kinds,
    };
    // The list of everything omits the files of long kinds: of spectra it shows only the registered kinds.
    let short = |kind: &str| arguments.stage.is_none() && LONG.contains(&kind);
    let of = |kind: &&str| if short(kind) { registered(kind) } else { items(kind) };
    let mut items: Vec<Item> = wanted.iter().flat_map(of).collect();
    if !arguments.words.is_empty() {
        let words: Vec<String> = arguments.words.iter().map(|word| names::normalized(word)).collect();
        items.retain(|item| {
            let said = names::normalized(&format!("{} {} {}", item.name, item.columns.join(" "), item.summary));
            words.iter().all(|word| said.contains(word.as_str()))
        });
    }
    if arguments.json {
        console::pretty_json(&items)?;
    } else {
        let is_whole = arguments.stage.is_none() && arguments.words.is_empty();
        let mut out = if is_whole { contents(&all, &items) } else { String::new() };
        out.push_str(&table(&items));
        if arguments.stage.is_none() {
            for kind in LONG {
                // Writing to a String cannot fail.
                let _ = writeln!(out, "\n{kind}\n  {} of them: `spectra list {kind}`", items_of(kind).len());
            }
        }
        console::out(&out)?;
    }
    Ok(DONE)
}

/// Returns the table of contents: each kind with its number of entries, bundled data first, then kinds of stages. `listed` holds the
/// entries of all kinds except the long ones.
fn contents(kinds: &[&str], listed: &[Item]) -> String {
    let mut out = String::from("Kinds of names, and how many there are:\n");
    let order = KINDS.into_iter().chain(kinds.iter().copied().filter(|kind| !KINDS.contains(kind)));
    let width = kinds.iter().map(|kind| kind.len()).max().unwrap_or(0);
    for kind in order {
        let count = match kind {
            kind if LONG.contains(&kind) => items_of(kind).len(),
            kind => listed.iter().filter(|item| item.stage.split(' ').next_back() == Some(kind)).count(),
        };
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  {kind:<width$}  {count:>5}  spectra list {kind}");
    }
    out.push('\n');
    out
}

/// Returns the kind that a word means, also in the plural: `lens`, `lenses`, `stocks`, `spectra`.
fn kind(typed: &str, kinds: &[&'static str]) -> Result<&'static str, Fault> {
    let key = names::normalized(typed);
    let several = |kind: &str| match kind {
        "spectrum" => "spectra".to_owned(),
        "lens" | "glass" => format!("{kind}es"),
        kind => format!("{kind}s"),
    };
    if let Some(kind) = kinds.iter().copied().find(|kind| key == *kind || key == several(kind)) {
        return Ok(kind);
    }
    let fault = Fault::new(format!("there is no list `{typed}`"));
    if names::nearest(&key, kinds.iter().copied()).is_some() {
        return Err(fault.hint(names::hint(&key, kinds, "")));
    }
    let named = bundled::meanings(typed).into_iter().next();
    Err(fault.hint(match named {
        Some((kind, name)) => format!("`{name}` is {}; `{}` lists others", kind.noun(), kind.listed_by()),
        None => names::hint(&key, kinds, ""),
    }))
}

fn items(kind: &str) -> Vec<Item> {
    let mut all = registered(kind);
    all.extend(items_of(kind));
    all
}

fn registered(kind: &str) -> Vec<Item> {
    let of_kind = registry::list().into_iter().filter(|l| l.stage == kind);
    let item = |l: Listed| {
        let documentation = l.documentation();
        Item {
            stage: l.stage,
            name: l.name.to_owned(),
            package: l.package,
            version: l.version,
            default: l.default,
            columns: vec![format!("{} {}", l.package, l.version)],
            summary: documentation.summary.clone(),
            documentation: Some(documentation),
            figures: Map::new(),
        }
    };
    of_kind.map(item).collect()
}

fn items_of(kind: &str) -> Vec<Item> {
    match kind {
        "scene" => Bundled::Scene.names().iter().filter_map(|name| scene(name)).collect(),
        "lens" => Bundled::Lens.names().iter().filter_map(|name| lens(name)).collect(),
        "stock" => {
            let mut all: Vec<Item> = Stock::bundled().filter_map(stock).collect();
            // Print stocks come last, because no scene is exposed on one.
            all.sort_by_key(|item| item.stage);
            all.reverse();
            let (mut camera, print): (Vec<Item>, Vec<Item>) = all.into_iter().partition(|item| item.stage == "stock");
            camera.sort_by(|a, b| a.name.cmp(&b.name));
            camera.into_iter().chain(print).collect()
        }
        "spectrum" => {
            spectra_spectrum::bundled_spectra().filter_map(|(name, path)| spectrum("spectrum", name, path)).collect()
        }
        "sensor" => {
            let all = spectra_spectrum::bundled_spectra().filter(|(_, path)| path.starts_with("spectra/sensors/"));
            all.filter_map(|(name, path)| spectrum("sensor", name, path)).collect()
        }
        "glass" => Catalog::bundled().glasses().map(|glass| glass_item(&glass)).collect(),
        "format" => formats(),
        _ => Vec::new(),
    }
}

fn plain(stage: &'static str, name: &str, summary: &str) -> Item {
    Item {
        stage,
        name: name.to_owned(),
        package: "bundled",
        version: crate::version::VERSION,
        default: false,
        documentation: None,
        figures: Map::new(),
        columns: Vec::new(),
        summary: summary.to_owned(),
    }
}

/// Returns the entry of a bundled scene; its description is the comment at the top of the file.
fn scene(name: &str) -> Option<Item> {
    let text = spectra_data::text(&format!("scenes/{name}.yaml"))?;
    let head: Vec<&str> = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    Some(plain("scene", name, &first_sentence(&head.join(" "))))
}

fn first_sentence(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.split_once(". ").map_or(text.clone(), |(first, _)| format!("{first}."))
}

fn lens(name: &str) -> Option<Item> {
    let lens = Optics::new(spectra_lens::load(name, &FileResources::beside(Path::new(""))).ok()?);
    let f_mm = Some(lens.first_order(lens.reference_nm).efl_mm.abs()).filter(|f| f.is_finite());
    // An afocal lens has no f-number, only rounding errors.
    let f_number = lens.marginal_ray().ok().map(|ray| ray.f_number()).filter(|n| n.is_finite() && f_mm.is_some());
    let field = largest_field_rad(&lens, Section::Y, f64::INFINITY, WIDEST_DEG.to_radians()).ok().flatten();
    let field_deg = field.map(f64::to_degrees);
    let rounded = |value: f64, digits: i32| {
        let scale = 10_f64.powi(digits);
        (value * scale).round() / scale
    };
    let figures = json!({
        "focal_length_mm": f_mm.map(|f| rounded(f, 3)),
        "f_number": f_number.map(|n| rounded(n, 3)),
        "field_deg": field_deg.map(|deg| rounded(deg, 1)),
        "year": lens.year,
    });
    let column = |value: Option<String>| value.unwrap_or_default();
    let columns = vec![
        column(f_mm.map(|f| format!("{f:.0} mm"))),
        column(f_number.map(|n| format!("f/{n:.2}"))),
        column(field_deg.map(|deg| format!("+-{deg:.0} deg"))),
        column(lens.year.map(|year| year.to_string())),
    ];
    Some(Item { figures: map(figures), columns, ..plain("lens", name, &lens.name) })
}

fn stock(name: &'static str) -> Option<Item> {
    let stock = Stock::load(name, &FileResources::beside(Path::new(""))).ok()?;
    let process = match (stock.process, stock.layers.len()) {
        (Process::Negative, 1) => "black-and-white negative",
        (Process::Negative, _) => "color negative",
        (Process::Reversal, _) => "reversal (slides)",
        (Process::Print, _) => "print stock",
    };
    let figures = json!({
        "process": process,
        "iso": stock.iso,
        "iso_tungsten": stock.iso_tungsten,
        "layers": stock.layers.len(),
        "year": stock.year,
        "maker": stock.maker,
        "print": stock.print,
    });
    let columns = vec![
        stock.speed_text().unwrap_or_default(),
        process.to_owned(),
        stock.year.map_or(String::new(), |year| year.to_string()),
    ];
    let stage = if stock.process == Process::Print { "print stock" } else { "stock" };
    Some(Item { figures: map(figures), columns, ..plain(stage, name, &stock.name) })
}

fn spectrum(stage: &'static str, name: &'static str, path: &'static str) -> Option<Item> {
    let table = Table::parse_bytes(path, spectra_data::get(path)?, None).ok()?;
    let columns_in = if table.columns.len() > 1 { table.columns } else { Vec::new() };
    let range = table.meta.range_nm;
    let figures = json!({
        "kind": table.kind.word(),
        "title": table.meta.name,
        "range_nm": range.map(|(from, to)| [from, to]),
        "columns": columns_in,
        "source": table.meta.source,
        "license": table.meta.license,
    });
    let columns =
        vec![table.kind.word().to_owned(), range.map_or(String::new(), |(from, to)| format!("{from:.0}-{to:.0} nm"))];
    let mut summary = table.meta.name.unwrap_or_default();
    if !columns_in.is_empty() {
        let shown: Vec<&str> = columns_in.iter().take(6).map(String::as_str).collect();
        let more = if columns_in.len() > shown.len() { ", ..." } else { "" };
        summary = format!("{summary} (#{}{more})", shown.join(", #"));
    }
    Some(Item { figures: map(figures), columns, ..plain(stage, name, summary.trim()) })
}

fn glass_item(glass: &spectra_glass::Glass) -> Item {
    let (nd, vd) = (glass.nd(), glass.vd());
    let known = |value: f64| Some(value).filter(|v| v.is_finite());
    let figures = json!({ "nd": known(nd), "vd": known(vd) });
    let column = |value: f64, text: String| known(value).map_or(String::new(), |_| text);
    let columns = vec![column(nd, format!("nd {nd:.5}")), column(vd, format!("Vd {vd:.2}"))];
    Item { figures: map(figures), columns, ..plain("glass", &glass.full_name(), "") }
}

/// Returns the image formats that imagers know, taken from their schema.
fn formats() -> Vec<Item> {
    fn search(value: &Value) -> Option<&Vec<Value>> {
        match value {
            Value::Object(map) => match map.get("x-formats") {
                Some(Value::Array(all)) => Some(all),
                _ => map.values().find_map(search),
            },
            Value::Array(items) => items.iter().find_map(search),
            _ => None,
        }
    }
    let schema = file_schema(FileKind::Scene);
    let item = |format: &Value| {
        let name = format.get("name")?.as_str()?;
        let mm = |key: &str| format.get(key).and_then(Value::as_f64);
        let (width, height) = (mm("width_mm")?, mm("height_mm")?);
        let source = format.get("source").and_then(Value::as_str).unwrap_or_default();
        let figures = json!({ "width_mm": width, "height_mm": height });
        let columns = vec![format!("{width} x {height} mm")];
        Some(Item { figures: map(figures), columns, ..plain("format", name, source) })
    };
    search(&schema).into_iter().flatten().filter_map(item).collect()
}

fn map(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn table(items: &[Item]) -> String {
    let mut out = String::new();
    let mut stage = "";
    for (at, item) in items.iter().enumerate() {
        if item.stage != stage {
            let gap = if stage.is_empty() { "" } else { "\n" };
            stage = item.stage;
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{gap}{stage}");
        }
        // Each column of a group is as wide as its widest entry.
        let group = items[at..].iter().chain(&items[..at]).filter(|other| other.stage == stage);
        let group: Vec<&Item> = group.collect();
        let width = |of: &dyn Fn(&Item) -> usize| group.iter().map(|item| of(item)).max().unwrap_or(0);
        let mut line = format!("  {:<1$}", item.name, width(&|item| item.name.len()));
        for (i, column) in item.columns.iter().enumerate() {
            let width = width(&|item| item.columns.get(i).map_or(0, |c| c.chars().count()));
            let _ = write!(line, "  {column:<width$}");
        }
        let _ = write!(line, "  {}", item.summary);
        if item.default {
            line.push_str(" (default)");
        }
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(stage: &'static str, name: &str, package: &'static str, default: bool) -> Item {
        let columns = vec![format!("{package} 1.2.3")];
        Item { package, default, columns, ..plain(stage, name, "A thing.") }
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
            "  chart     spectra-plugin-sources 1.2.3  A thing.",
            "  far-lamp  lamps 1.2.3                   A thing.",
            "",
            "surface",
            "  sphere  spectra-plugin-surfaces 1.2.3  A thing. (default)",
            "",
        ];
        assert_eq!(table(&items), wanted.join("\n"));
    }

    #[test]
    fn kinds_are_found_in_the_plural_too() {
        let kinds = ["source", "lens", "stock", "spectrum", "glass"];
        for (typed, wanted) in
            [("lens", "lens"), ("lenses", "lens"), ("Stocks", "stock"), ("spectra", "spectrum"), ("glasses", "glass")]
        {
            assert_eq!(kind(typed, &kinds).ok(), Some(wanted), "{typed}");
        }
        let hint = |typed: &str| kind(typed, &kinds).err().and_then(|fault| fault.hint).unwrap_or_default();
        assert!(hint("sourc").starts_with("did you mean `source`?"));
        assert!(
            hint("tri-x").starts_with("`kodak-tri-x-400` is a film stock; `spectra list stock`"),
            "{}",
            hint("tri-x")
        );
    }
}
