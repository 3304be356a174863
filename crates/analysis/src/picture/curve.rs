//! Figure of a cut through a picture.

use super::cut::Cut;
use super::measured::NotMeasured;
use spectra_plot::Canvas;
use spectra_sheet::Chart;

/// Draws the curves of a cut against the distance along it, in mm on the film if that is known, otherwise in pixels. `is_log`
/// makes the scale of the values logarithmic.
///
/// # Errors
/// No value along the cut is defined, or none is above 0 on a logarithmic scale.
pub fn curve(cut: &Cut, is_log: bool, title: &str) -> Result<Canvas, NotMeasured> {
    let (distance, name) = match &cut.distance_mm {
        Some(mm) => (mm, "distance on the film / mm"),
        None => (&cut.distance_px, "distance / px"),
    };
    let mut chart = Chart::new("cut", title, name).logarithmic(is_log);
    for (label, values) in cut.labels.iter().zip(&cut.values) {
        chart.push(label, distance.iter().zip(values).map(|(x, value)| [*x, *value]));
    }
    chart.canvas().ok_or_else(|| {
        if is_log {
            let text = "no value along the cut is above 0, so a logarithmic scale shows nothing";
            NotMeasured::new(text, "leave `--log` out")
        } else {
            NotMeasured::new("no value is defined along the cut", "choose another line or another `--quantity`")
        }
    })
}
