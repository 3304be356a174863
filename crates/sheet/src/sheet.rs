//! The figures, tables and curves of one result.

use crate::chart::Chart;
use crate::table::Table;
use serde::Serialize;
use serde_json::{Map, Value};
use spectra_plot::Page;

/// A part of a sheet, in the order in which it is shown.
#[derive(Clone, Debug, PartialEq)]
enum Part {
    Heading(String),
    /// Labels with their values as text.
    Facts(Vec<(String, String)>),
    Table(Table),
    Chart(Chart),
    Notes(Vec<String>),
}

/// A result as data: a title, figures, tables, curves and notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    title: String,
    data: Map<String, Value>,
    parts: Vec<Part>,
}

impl Sheet {
    /// Creates an empty sheet. The title is shown in text and on pages, but is not in the data.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), data: Map::new(), parts: Vec::new() }
    }

    /// Adds a value to the data only: JSON has it under `key`, text and pages do not show it. A value without a JSON form, such
    /// as infinity, is `null`.
    pub fn data(&mut self, key: &str, value: impl Serialize) {
        self.data.insert(key.to_owned(), serde_json::to_value(value).unwrap_or(Value::Null));
    }

    /// Adds every field of a struct to the data, as [`Sheet::data`] does for one value.
    pub fn fields(&mut self, value: impl Serialize) {
        if let Ok(Value::Object(fields)) = serde_json::to_value(value) {
            self.data.extend(fields);
        }
    }

    /// Adds a line, a label and a text, that is shown but is not in the data. Without a text, no line is shown.
    pub fn line(&mut self, label: &str, text: Option<String>) {
        let Some(text) = text else { return };
        let fact = (label.to_owned(), text);
        match self.parts.last_mut() {
            Some(Part::Facts(facts)) => facts.push(fact),
            _ => self.parts.push(Part::Facts(vec![fact])),
        }
    }

    /// Adds a figure to the data, under `key`, and as a shown line with `label`, where `text` formats it. Without a value, the
    /// data has `null` and no line is shown.
    pub fn fact<T: Serialize>(&mut self, key: &str, label: &str, value: Option<T>, text: impl FnOnce(&T) -> String) {
        self.line(label, value.as_ref().map(text));
        self.data(key, value);
    }

    /// Adds a text to the data, under `key`, and as a shown line with `label`. Without a text, the data has `null` and no line is
    /// shown.
    pub fn text(&mut self, key: &str, label: &str, value: Option<&str>) {
        self.fact(key, label, value, |text| (*text).to_owned());
    }

    /// Starts a part with a heading.
    pub fn heading(&mut self, text: &str) {
        self.parts.push(Part::Heading(text.to_owned()));
    }

    /// Adds a sentence on a line of its own that is shown but is not in the data.
    pub fn note(&mut self, text: &str) {
        match self.parts.last_mut() {
            Some(Part::Notes(notes)) => notes.push(text.to_owned()),
            _ => self.parts.push(Part::Notes(vec![text.to_owned()])),
        }
    }

    /// Adds a table. In the data it is an array of objects under the key of the table. A table without rows is not shown.
    pub fn table(&mut self, table: Table) {
        self.data.insert(table.key.clone(), table.to_json());
        self.show(table);
    }

    /// Adds a table that is only shown, because the data already has its values in another form. A table without rows is left
    /// out.
    pub fn show(&mut self, table: Table) {
        if !table.is_empty() {
            self.parts.push(Part::Table(table));
        }
    }

    /// Adds a chart. In the data, the key of the chart holds an object that maps the label of each curve to its array of points.
    pub fn chart(&mut self, chart: Chart) {
        self.data.insert(chart.key.clone(), chart.to_json());
        self.parts.push(Part::Chart(chart));
    }

    /// Returns the data as one JSON object.
    #[must_use]
    pub fn to_json(&self) -> Value {
        Value::Object(self.data.clone())
    }

    /// Formats the sheet for a terminal. Values stand in one column; charts are left out.
    #[must_use]
    pub fn to_text(&self) -> String {
        let labels =
            self.parts.iter().filter_map(|part| if let Part::Facts(facts) = part { Some(facts) } else { None });
        let width = labels.flatten().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
        let mut out = format!("{}\n", self.title);
        for part in &self.parts {
            out.push('\n');
            match part {
                Part::Heading(text) => out += &format!("{text}\n"),
                Part::Notes(notes) => notes.iter().for_each(|note| out += &format!("{note}\n")),
                Part::Facts(facts) => {
                    for (label, text) in facts {
                        out += &format!("  {label:<width$}  {text}\n");
                    }
                }
                Part::Table(table) => out += &table.to_text(),
                // The blank line is taken back.
                Part::Chart(_) => drop(out.pop()),
            }
        }
        out
    }

    /// Makes a page for a browser: one HTML file without scripts.
    #[must_use]
    pub fn to_html(&self) -> String {
        let mut page = Page::new(&self.title);
        for part in &self.parts {
            match part {
                Part::Heading(text) => page.heading(text),
                Part::Facts(facts) => page.facts(facts),
                Part::Table(table) => {
                    let (head, rows) = table.cells();
                    page.table(&head, &rows);
                }
                Part::Chart(chart) => {
                    if let Some(canvas) = chart.canvas() {
                        page.figure(&canvas, chart.title());
                    }
                }
                Part::Notes(notes) => notes.iter().for_each(|note| page.paragraph(note)),
            }
        }
        page.to_html()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;

    fn sheet() -> Sheet {
        let mut sheet = Sheet::new("a <lens>");
        sheet.text("maker", "maker", Some("Zeiss"));
        sheet.fact("f_number", "f-number", Some(1.4), |n| format!("f/{n:.1}"));
        sheet.fact("year", "year", None::<i32>, ToString::to_string);
        sheet.data("image_mm", f64::INFINITY);
        sheet.heading("fields");
        let mut table = Table::new("fields", [Column::fixed("field_deg", "field", 1)]);
        table.push([12.25]);
        sheet.table(table);
        sheet.table(Table::new("mounts", []));
        let mut chart = Chart::new("mtf", "contrast", "frequency / (1/mm)");
        chart.push("sagittal", [[0.0, 1.0], [10.0, 0.5]]);
        sheet.chart(chart);
        sheet.note("the stop is open");
        sheet.note("nothing moves");
        sheet
    }

    #[test]
    fn readers_see_what_is_known_in_its_order() {
        let text = "a <lens>\n\n  maker     Zeiss\n  f-number  f/1.4\n\nfields\n\n  field\n   12.2\n\nthe stop is open\nnothing moves\n";
        assert_eq!(sheet().to_text(), text);
    }

    #[test]
    fn data_has_every_key_whether_or_not_there_is_a_value() {
        let json = r#"{"maker":"Zeiss","f_number":1.4,"year":null,"image_mm":null,"fields":[{"field_deg":12.25}],"mounts":[],"mtf":{"sagittal":[[0.0,1.0],[10.0,0.5]]}}"#;
        let wanted: Value = serde_json::from_str(json).expect("JSON");
        assert_eq!(sheet().to_json(), wanted);
    }

    #[test]
    fn a_table_for_readers_is_not_in_the_data() {
        let mut sheet = Sheet::new("rows");
        let mut table = Table::new("years", [Column::text("years", "listed")]);
        table.push(["1923-1967"]);
        sheet.show(table);
        assert_eq!(sheet.to_text(), "rows\n\n  listed\n  1923-1967\n");
        assert_eq!(sheet.to_json(), serde_json::json!({}));
    }

    #[test]
    fn a_page_has_all_parts_and_escapes_texts() {
        let html = sheet().to_html();
        for part in ["a &lt;lens&gt;", "f/1.4", "12.2", "data:image/svg+xml", "the stop is open"] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }
}
