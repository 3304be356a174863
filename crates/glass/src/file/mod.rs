//! A user's own glass, in a file beside the scene or lens that names it.
//!
//! | file | holds |
//! |---|---|
//! | `mine.yaml` | a formula with its coefficients, a table of n, or nd and Vd, with absorption where it is known ([`yaml`](self)); or a page of the refractiveindex.info database as it stands there |
//! | `mine.csv` | columns `wavelength_nm` (or `wavelength_um`), `n` and, where it is known, `k`; `mine.csv#NAME` where a column `material` names several |
//! | `mine.agf#N-BK7` | one glass of a catalogue file of an optical design program; the name may be left out where the file has one |

mod csv;
mod database;
mod figures;
mod stated_lines;
mod yaml;

pub use figures::{AbbeCurve, AbbeNumber, Figures};
pub use stated_lines::{StatedLine, StatedLines, ThreeLines};
pub use yaml::{GlassFile, InternalTransmittance, from_params};

use crate::{Catalog, Glass, Medium, agf};
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::resources::{ResourceError, Resources, beside};

/// Largest table or catalogue file that is read, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Returns whether a name is the name of a file, not of a catalogue glass.
#[must_use]
pub fn is_file(name: &str) -> bool {
    let (file, _) = parts(name);
    ["yaml", "yml", "csv", "agf"].iter().any(|ending| has_ending(file, ending))
}

/// Splits a name into the file and the glass in it.
fn parts(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('#') {
        Some((file, glass)) => (file.trim(), Some(glass.trim())),
        None => (name.trim(), None),
    }
}

fn has_ending(file: &str, ending: &str) -> bool {
    file.rsplit_once('.').is_some_and(|(_, e)| e.eq_ignore_ascii_case(ending))
}

/// Finds the medium that the value of `key` names: a user's file, or a medium of the bundled catalogue. A file is first looked up
/// beside the file in which the key is written. `params` is the map that has the key.
///
/// # Errors
/// The faults of the glass's file, placed there; an unknown or ambiguous name, placed at the key.
pub fn medium(name: &str, params: &Params, key: &str, resources: &dyn Resources) -> Result<Medium, Faults> {
    if is_file(name) {
        let (file, glass) = parts(name);
        let path = params.node().at_path(key).map_or_else(|| file.to_owned(), |node| beside(node, file));
        let read = read(&path, file, glass, resources);
        return read.map(Medium::from).map_err(|faults| params.place_at(key, faults));
    }
    Catalog::bundled().medium(name).map_err(|e| params.fault(key, e.message()).hint(e.hint()).into())
}

/// Reads the glass of the file that `name` names; see [`is_file`].
///
/// # Errors
/// All faults of the file, with places; a fault without a place if the file itself is not found.
pub fn load(name: &str, resources: &dyn Resources) -> Result<Glass, Faults> {
    let (file, glass) = parts(name);
    read(file, file, glass, resources)
}

fn read(path: &str, shown: &str, glass: Option<&str>, resources: &dyn Resources) -> Result<Glass, Faults> {
    if has_ending(path, "agf") {
        return from_agf(path, shown, glass, resources);
    }
    if has_ending(path, "csv") {
        let found = bytes(path, shown, resources)?;
        return csv::read(&found.name, &found.bytes, glass);
    }
    if let Some(glass) = glass {
        let fault = Fault::new(format!("`{shown}` holds one glass; there is no `#{glass}`"));
        return Err(fault.hint(format!("write `{shown}`")).into());
    }
    let params = resources.document(path, &[], &[])?;
    if database::is_one(&params) { database::from_params(&params) } else { yaml::from_file(&params, resources) }
}

fn bytes(path: &str, shown: &str, resources: &dyn Resources) -> Result<spectra_core::resources::Resource, Faults> {
    resources.read(path, &[], &[], MAX_BYTES).map_err(|error| {
        let fault = Fault::new(format!("`{shown}`: {error}"));
        match &error {
            ResourceError::NotFound(near) if !near.is_empty() => fault.hint(format!("did you mean `{}`?", near[0])),
            _ => fault,
        }
        .into()
    })
}

fn from_agf(path: &str, shown: &str, glass: Option<&str>, resources: &dyn Resources) -> Result<Glass, Faults> {
    let found = bytes(path, shown, resources)?;
    let stem = shown.rsplit(['/', '\\']).next().unwrap_or(shown);
    let maker = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let mut glasses = agf::read(&found.bytes, maker).glasses;
    let Some(name) = glass else {
        return match glasses.len() {
            1 => Ok(glasses.remove(0)),
            0 => Err(Fault::new(format!("`{shown}`: no glass in it"))
                .hint("a glass catalogue (AGF) has lines `NM ...` and `CD ...`")
                .into()),
            many => Err(Fault::new(format!("`{shown}` holds {many} glasses"))
                .hint(format!("name one, such as `{shown}#{}`", glasses[0].name))
                .into()),
        };
    };
    if let Some(at) = glasses.iter().position(|g| g.name.eq_ignore_ascii_case(name)) {
        return Ok(glasses.remove(at));
    }
    let fault = Fault::new(format!("`{shown}` has no glass `{name}`"));
    Err(match nearest(name, glasses.iter().map(|g| g.name.as_str())) {
        Some(near) => fault.hint(format!("did you mean `{shown}#{near}`?")),
        None => fault.hint(format!("it holds {} glasses", glasses.len())),
    }
    .into())
}

/// Maker of glasses that state none; reports call them by their name alone.
const OWN_MAKER: &str = "own";

/// Refuses a glass whose index is not from 1 to 10 somewhere in its range; says where.
fn sensible(glass: &Glass) -> Result<(), String> {
    let (from, to) = glass.range_nm;
    const STEPS: u32 = 64;
    for i in 0..=STEPS {
        let nm = from + (to - from) * f64::from(i) / f64::from(STEPS);
        let n = glass.index(nm);
        if !(1.0..=10.0).contains(&n) {
            return Err(format!("the index at {nm:.1} nm is {n:.4}, which is not from 1 to 10"));
        }
    }
    Ok(())
}
