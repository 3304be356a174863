//! Results as data: a [`Sheet`] holds the figures, tables and curves of one result, and every form in which it is shown is made of it.
//!
//! - text for a terminal: [`Sheet::to_text`];
//! - JSON with a key for each figure, and an array of objects for each table: [`Sheet::to_json`];
//! - CSV of its tables, with one header row of the same keys: [`Table::to_csv`];
//! - a drawing of its curves, as SVG or PNG: [`Chart::canvas`];
//! - a page for a browser: [`Sheet::to_html`].
//!
//! ```
//! use spectra_sheet::{Column, Sheet, Table};
//! let mut sheet = Sheet::new("a thin lens");
//! sheet.fact("efl_mm", "focal length", Some(50.0), |mm| format!("{mm:.2} mm"));
//! let mut fields = Table::new("fields", [Column::fixed("field_deg", "field / deg", 1), Column::fixed("height_mm", "height / mm", 3)]);
//! fields.push((10.0, 8.8163));
//! sheet.table(fields);
//! assert_eq!(
//!     sheet.to_text(),
//!     "a thin lens\n\n  focal length  50.00 mm\n\n  field / deg  height / mm\n         10.0        8.816\n"
//! );
//! assert_eq!(sheet.to_json().to_string(), r#"{"efl_mm":50.0,"fields":[{"field_deg":10.0,"height_mm":8.8163}]}"#);
//! ```

mod chart;
mod number;
mod sheet;
mod table;

pub use chart::Chart;
pub use number::{percent, significant};
pub use sheet::Sheet;
pub use table::{Column, Table};
