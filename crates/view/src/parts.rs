//! Data for a page, wherever its engine runs: the drawing of the lens, pictures and faults in the page's format.

pub use crate::section::svg;

use half::f16;
use half::slice::HalfFloatSliceExt;
use serde_json::{Value, json};
use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::params::Fault;
use spectra_scene::{FilmTime, Scene};
use spectra_session::{Session, SessionError};

/// Returns the numbers of a picture as 16-bit floats (IEEE 754 binary16), little-endian. They are right to one part in 2048, which is finer
/// than any screen's codes, and take half as many bytes as 32-bit floats.
pub(crate) fn halves(numbers: &[f32]) -> Vec<u8> {
    let mut halves = vec![f16::ZERO; numbers.len()];
    halves.convert_from_f32_slice(numbers);
    halves.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Packs a picture for the page: the length of the head (`u32`, little-endian), the head as JSON, then the numbers, aligned to four bytes.
pub(crate) fn packed(head: &Value, numbers: &[u8]) -> Vec<u8> {
    let mut head = head.to_string();
    head.push_str(&" ".repeat((4 - head.len() % 4) % 4));
    let mut bytes = Vec::with_capacity(4 + head.len() + numbers.len());
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.extend(numbers);
    bytes
}

/// Returns a JSON object with the entries of both objects.
pub(crate) fn joined(mut one: Value, other: Value) -> Value {
    if let (Value::Object(one), Value::Object(other)) = (&mut one, other) {
        one.extend(other);
    }
    one
}

/// Returns facts about a session's picture for the head that a page gets with it: samples so far, `rays`, exposure time, lens,
/// film, focus and warnings. `times` are the exposure times of the films.
#[must_use]
pub fn head(session: &Session, times: &[FilmTime], rays: u64) -> Value {
    let scene = session.scene();
    json!({
        "samples": session.samples(),
        "of": session.samples_in_all(),
        "rays": rays,
        "exposure_s": times.first().map_or(1.0, |time| time.time_s),
        "lens": scene.lens.name,
        "film": times.first().map(|time| time.film.clone()),
        "focus": scene.focus.to_string(),
        "warnings": session.warnings().map(|warning| fault_json(&warning.0)).collect::<Vec<_>>(),
    })
}

/// Returns the exposure of a pixel in each channel, at each film's own exposure time, in the frame of this number. `None` if there is no
/// such pixel.
pub(crate) fn pixel(exposure: &ExposureFrame, times: &[FilmTime], frame: u64, [x, y]: [u64; 2]) -> Option<Value> {
    let [width, height] = [exposure.size.width_px, exposure.size.height_px].map(u64::from);
    if x >= width || y >= height {
        return None;
    }
    let at = (y * width + x) as usize;
    let of = |(i, channel): (usize, &ExposureChannel)| {
        let gain = times.iter().find(|time| time.channels.contains(&i)).map_or(1.0, |time| time.gain as f32);
        let value = channel.values.get(at).map(|value| value * gain);
        json!({"name": channel.name, "unit": channel.unit, "value": value})
    };
    Some(json!({"frame": frame, "channels": exposure.channels.iter().enumerate().map(of).collect::<Vec<_>>()}))
}

/// Returns an error as JSON. `path` is that of the control that caused it; empty if there is none.
#[must_use]
pub fn error_json(error: &SessionError, path: &str) -> Value {
    match error {
        SessionError::Faults(faults) => {
            let all: Vec<Value> = faults.iter().map(fault_json).collect();
            json!({"path": path, "faults": all})
        }
        other => json!({"path": path, "faults": [{"message": other.to_string()}]}),
    }
}

/// Returns a fault as JSON for the page: message, place and hint.
fn fault_json(fault: &Fault) -> Value {
    json!({"message": fault.message, "place": fault.place_text(), "hint": fault.hint})
}

/// Returns the spectrum of a scene's light and the response of each channel of its picture as JSON, over wavelength in nm. Each
/// curve is scaled so that its largest value is 1.
#[must_use]
pub fn spectra(scene: &Scene) -> Value {
    let unit = |values: &[f64]| -> Vec<f64> {
        let most = values.iter().copied().fold(0.0, f64::max);
        values.iter().map(|v| if most > 0.0 { v / most } else { 0.0 }).collect()
    };
    let light = scene.source.spectrum();
    let strongest = light.lines.iter().map(|line| line.power).fold(f64::MIN_POSITIVE, f64::max);
    let lines = light.lines.iter().map(|line| [line.wavelength_nm, line.power / strongest]);
    let grid: Vec<f64> = scene.grid.wavelengths_nm().collect();
    let channels = scene.picture_channels().into_iter().filter_map(|at| scene.channels.get(at));
    let layers = channels.map(|c| json!({"name": c.name, "nm": grid, "values": unit(&c.response)}));
    json!({
        "light": {
            "nm": light.grid.wavelengths_nm().collect::<Vec<_>>(),
            "values": unit(&light.continuum),
            "lines": lines.collect::<Vec<_>>(),
        },
        "layers": layers.collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::frame::FrameSize;

    #[test]
    fn a_pixel_is_that_of_its_column_and_row() {
        let size = FrameSize { width_px: 3, height_px: 2, width_mm: 36.0, height_mm: 24.0 };
        let channel = ExposureChannel {
            name: "Y".to_owned(),
            unit: "lx s".to_owned(),
            values: (0..6).map(|i| i as f32).collect(),
        };
        let exposure = ExposureFrame { size, channels: vec![channel] };
        let value = |at| pixel(&exposure, &[], 1, at).map(|found| found["channels"][0]["value"].as_f64());
        assert_eq!([[0, 0], [2, 0], [1, 1], [2, 1]].map(value), [0.0, 2.0, 4.0, 5.0].map(|v| Some(Some(v))));
        assert_eq!([[3, 0], [0, 2]].map(value), [None, None]);
    }
}
