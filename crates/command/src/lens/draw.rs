//! `spectra lens draw`: draws a lens with its rays.

use super::arguments::{CutArgument, LensDraw};
use super::load;
use crate::console;
use crate::formatting::figure_of;
use crate::outcome::{DONE, Failure, Outcome};
use spectra_analysis::draw::{DrawingBackground, Fans, SectionView, Sheet};
use spectra_analysis::fan::largest_field_rad;
use spectra_analysis::info::useful_field_rad;
use spectra_lens::Section;
use spectra_optics::Optics;
use spectra_plot::{Format, PlotError};

/// Largest field angle that is drawn by default, degrees.
const WIDEST_DEG: f64 = 85.0;
/// Default fields besides the axis, as fractions of the largest field angle.
const PARTS: [f64; 2] = [0.6, 0.95];

/// Draws a lens with fans of rays and writes the drawing to a file.
pub(crate) fn draw(arguments: &LensDraw) -> Outcome {
    // A wrong extension is reported before anything is computed.
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
        console::warning("no ray passes this lens at these field angles: the drawing shows only the glass");
    }
    let ground = if arguments.dark { DrawingBackground::Dark } else { DrawingBackground::Light };
    let sheet = Sheet {
        width: f64::from(arguments.width),
        height: None,
        ground,
        width_mm: None,
        view: SectionView { section },
        caption: caption(&lens),
        image: true,
    };
    sheet.draw(&lens, &rays).write(&output).map_err(failure)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

fn fields_deg(arguments: &LensDraw, lens: &Optics, section: Section) -> Result<Vec<f64>, Failure> {
    if !arguments.fields.is_empty() {
        return match arguments.fields.iter().find(|f| !(f.abs() < 180.0)) {
            Some(bad) => Err(Failure::Input(format!("--fields: {bad} degrees is not a field angle; use -180 to 180"))),
            None => Ok(arguments.fields.clone()),
        };
    }
    let refuse = |e| Failure::Input(format!("{}: {e}", arguments.setting.lens));
    let largest = largest_field_rad(lens, section, arguments.object.mm(), WIDEST_DEG.to_radians()).map_err(refuse)?;
    let largest = largest.map(|rad| useful_field_rad(lens, rad));
    // The beam at the very edge of the field shows the rims more than the lens, so the default fields stay inside.
    Ok(std::iter::once(0.0)
        .chain(largest.filter(|f| *f > 0.0).into_iter().flat_map(|f| PARTS.map(|part| part * f.to_degrees())))
        .collect())
}

fn caption(lens: &Optics) -> String {
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
