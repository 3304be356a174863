//! `spectra lens ghosts`: lists the ghosts of a lens.

use super::arguments::LensGhosts;
use super::load;
use super::trace::path_of;
use crate::console;
use crate::formatting::counted;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_analysis::draw::{DrawingBackground, SectionView, Sheet};
use spectra_analysis::ghosts::{Ghost, GhostSearch, Ghosts, ghost_rays, ghosts as find};
use spectra_lens::{Lens, Section};
use spectra_optics::Optics;
use spectra_plot::{Format, PlotError};
use std::path::Path;

/// Lists the ghosts of a lens, and draws one.
pub(crate) fn ghosts(arguments: &LensGhosts) -> Outcome {
    // A wrong extension is reported before anything is computed.
    if let Some(output) = &arguments.output {
        Format::of(output).map_err(failure)?;
    }
    let lens = load(&arguments.setting)?;
    let path = path_of(&arguments.path, &lens)?;
    let asked = path.as_ref().map(|path| path.reflections().count());
    let order = if arguments.order == "4" || asked == Some(4) { 4 } else { 2 };
    if asked.is_some_and(|count| count > 4) {
        return Err(Failure::Input("--path: name two surfaces, or four".to_owned()));
    }
    let search = GhostSearch { wavelength_nm: lens.reference_nm, order, share: arguments.share };
    let all = find(&lens, search).map_err(|error| Failure::Input(format!("{}: {error}", arguments.setting.lens)))?;
    if arguments.json {
        console::pretty_json(&json!({
            "lens": lens.name,
            "wavelength_nm": lens.reference_nm,
            "order": order,
            "energy": sum(&all.paths),
            "not_traced": all.not_traced,
            "paths": all.paths,
        }))?;
    } else {
        console::out(&table(&lens, &all, order, arguments.all))?;
    }
    if let Some(output) = &arguments.output {
        let asked: Option<Vec<usize>> = path.map(|path| path.reflections().map(|at| at + 1).collect());
        draw(arguments, &lens, &all, asked, output)?;
    }
    Ok(DONE)
}

fn sum(ghosts: &[Ghost]) -> f64 {
    // `sum` of an empty list would be -0.
    ghosts.iter().fold(0.0, |sum, ghost| sum + ghost.energy)
}

fn table(lens: &Lens, found: &Ghosts, order: usize, is_whole: bool) -> String {
    let all = &found.paths;
    let of = |many: usize| all.iter().filter(|ghost| ghost.surfaces.len() == many).count();
    let four = if order > 2 { format!(" and {} of four", of(4)) } else { String::new() };
    let mut text = format!(
        "{}: {} of two reflections{four}, together {:.3} % of the straight light (infinity, on the axis, {:.1} nm)\n",
        lens.name,
        counted(of(2) as u64, "ghost"),
        100.0 * sum(all),
        lens.reference_nm
    );
    let more = if order > 2 { "more often, or on paths with less light than --share" } else { "more often" };
    text.push_str(&format!("{} of the light that enters is reflected {more}\n", percent(found.not_traced)));
    let width = if order > 2 { 14 } else { 8 };
    if !all.is_empty() {
        text.push_str(&format!(
            "{:<width$}     energy      focus   f of ghost  size on film    C' : e : F'\n",
            "surfaces"
        ));
    }
    let shown = if is_whole { all.len() } else { MOST.min(all.len()) };
    all[..shown].iter().for_each(|ghost| text.push_str(&row(ghost, width)));
    if shown < all.len() {
        let weaker = counted((all.len() - shown) as u64, "weaker one");
        let them = if shown + 1 == all.len() { "it" } else { "them" };
        text.push_str(&format!("{weaker}: --all shows {them}\n"));
    }
    text
}

/// Formats a fraction as a percentage with at least two digits.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        _ if percent >= 0.1 => format!("{percent:.2} %"),
        _ if percent > 0.0 => format!("{percent:.1e} %"),
        _ => "0 %".to_owned(),
    }
}

/// Number of paths listed without `--all`.
const MOST: usize = 15;

fn names(surfaces: &[usize]) -> String {
    surfaces.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

fn row(ghost: &Ghost, width: usize) -> String {
    let length = |mm: Option<f64>| mm.map_or_else(|| "-".to_owned(), |mm| format!("{mm:.2} mm"));
    let [red, green, blue] = ghost.color;
    format!(
        "{:>width$} {:>10.2e} {:>10} {:>12} {:>10.2} mm    {red:.2} : {green:.0} : {blue:.2}\n",
        names(&ghost.surfaces),
        ghost.energy,
        length(ghost.focus_mm),
        length(ghost.focal_length_mm),
        ghost.size_mm
    )
}

/// Draws the lens with the rays of a ghost.
fn draw(
    arguments: &LensGhosts,
    lens: &Optics,
    all: &Ghosts,
    asked: Option<Vec<usize>>,
    output: &Path,
) -> Result<(), Failure> {
    let ghost = match &asked {
        Some(surfaces) => all.paths.iter().find(|ghost| ghost.surfaces == *surfaces),
        None => all.paths.iter().max_by(|a, b| a.density().total_cmp(&b.density())),
    };
    let Some(surfaces) = asked.clone().or_else(|| ghost.map(|ghost| ghost.surfaces.clone())) else {
        return Err(Failure::Input(format!("{} has no ghosts to draw: nothing reflects", lens.name)));
    };
    let reflections: Vec<usize> = surfaces.iter().map(|at| at - 1).collect();
    let section = Section::Y;
    let field_rad = arguments.field.to_radians();
    let rays = ghost_rays(lens, &reflections, lens.reference_nm, field_rad, section, arguments.rays.into());
    let rays = rays.map_err(|error| Failure::Input(format!("{}: {error}", arguments.setting.lens)))?;
    if rays.is_empty() {
        console::warning("no ray reaches the image plane along this path: the drawing shows only the glass");
    }
    let at = if arguments.field == 0.0 { String::new() } else { format!(", light from {} degrees", arguments.field) };
    let energy =
        ghost.map_or_else(String::new, |ghost| format!(": {:.1e} of the straight light on the axis", ghost.energy));
    let named = names(&surfaces);
    let sheet = Sheet {
        width: WIDTH,
        height: None,
        ground: DrawingBackground::Light,
        width_mm: None,
        view: SectionView { section },
        caption: format!("{}, reflected by surfaces {named}{energy}{at}", lens.name),
        image: true,
    };
    sheet.draw(lens, &rays).write(output).map_err(failure)?;
    console::note(&format!("wrote {}: the ghost of surfaces {named}", output.display()));
    Ok(())
}

/// Width of the drawing, CSS pixels.
const WIDTH: f64 = 900.0;

fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Ending { .. } => Failure::Input(error.to_string()),
        PlotError::Write(error) => error.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_no_negative_percentage() {
        assert_eq!(format!("{:.3}", 100.0 * sum(&[])), "0.000");
        assert_eq!([-0.0, 0.0, 0.002].map(percent), ["0 %", "0 %", "0.20 %"]);
    }
}
