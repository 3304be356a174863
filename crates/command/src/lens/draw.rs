//! `spectra lens draw`.

use super::arguments::{CutArgument, LensDraw};
use super::load;
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::words::figure_of;
use spectra_analysis::draw::{Fans, Ground, Sheet, View};
use spectra_analysis::fan::FanFinder;
use spectra_analysis::info::useful_field_rad;
use spectra_lens::{Lens, Section};
use spectra_plot::{Format, PlotError};

/// Fields beyond this are drawn only when asked for, degrees.
const WIDEST_DEG: f64 = 85.0;
/// Fields that are drawn unless said otherwise, as parts of the largest.
const PARTS: [f64; 2] = [0.6, 0.95];

/// Draws a lens.
pub(crate) fn draw(arguments: &LensDraw) -> Outcome {
    // Before anything is computed: a wrong ending is found out at once.
    let output = arguments.output.clone().unwrap_or_else(|| figure_of(&arguments.setting.lens));
    Format::of(&output).map_err(failure)?;
    let lens = load(&arguments.setting)?;
    let section = match arguments.section {
        CutArgument::X => Section::X,
        CutArgument::Y => Section::Y,
    };
    let fields_deg = fields_deg(arguments, &lens, section)?;
    let fans = Fans {
        fields_deg,
        object_mm: arguments.object.mm(),
        rays: usize::from(arguments.rays),
        wavelengths_nm: arguments.wavelengths.clone(),
    };
    let rays = fans.trace(&lens, section).map_err(|e| Failure::Input(format!("{}: {e}", arguments.setting.lens)))?;
    if rays.is_empty() && arguments.rays > 0 {
        console::warning("no ray passes this lens at these fields: the drawing shows glass alone");
    }
    let ground = if arguments.dark { Ground::Dark } else { Ground::Light };
    let sheet = Sheet {
        width: f64::from(arguments.width),
        height: None,
        ground,
        width_mm: None,
        view: View { section },
        caption: caption(&lens),
        image: true,
    };
    sheet.draw(&lens, &rays).write(&output).map_err(failure)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn fields_deg(arguments: &LensDraw, lens: &Lens, section: Section) -> Result<Vec<f64>, Failure> {
    if !arguments.fields.is_empty() {
        return match arguments.fields.iter().find(|f| !(f.abs() < 180.0)) {
            Some(bad) => Err(Failure::Input(format!("--fields: {bad} degrees is not a field angle; use -180 to 180"))),
            None => Ok(arguments.fields.clone()),
        };
    }
    let refuse = |e| Failure::Input(format!("{}: {e}", arguments.setting.lens));
    let finder = FanFinder::new(lens, section, lens.reference_nm).map_err(refuse)?;
    let largest = finder.largest_field_rad(arguments.object.mm(), WIDEST_DEG.to_radians());
    let largest = largest.map(|rad| useful_field_rad(lens, rad));
    // What passes at the very edge says more of the rims than of the lens: keep inside.
    Ok(std::iter::once(0.0)
        .chain(largest.filter(|f| *f > 0.0).into_iter().flat_map(|f| PARTS.map(|part| part * f.to_degrees())))
        .collect())
}

fn caption(lens: &Lens) -> String {
    let mut text = lens.name.clone();
    let origin = [lens.patent.clone(), lens.year.map(|y| y.to_string())];
    let origin: Vec<String> = origin.into_iter().flatten().collect();
    if !origin.is_empty() {
        text.push_str(&format!(" ({})", origin.join(", ")));
    }
    let f = lens.first_order(lens.reference_nm).efl_mm;
    if f.is_finite() {
        text.push_str(&format!(", f = {f:.2} mm"));
    }
    if let Ok(ray) = lens.marginal_ray() {
        text.push_str(&format!(", f/{:.2}", ray.f_number()));
    }
    text
}

fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Ending { .. } => Failure::Input(error.to_string()),
        PlotError::Write(error) => error.into(),
    }
}
