//! The parameters that all plane imagers share, and the frame that they describe.

use crate::formats::{FORMATS, format_named};
use crate::plane::{MAX_PIXELS, MAX_SIDE_PX};
use spectra_core::frame::FrameSize;
use spectra_core::params::{Fault, Faults, Length, Params, Positive, nearest};

/// The frame as a scene writes it: a named format or width and height, and the number of pixels.
pub(crate) struct Frame {
    pub(crate) format: Option<String>,
    pub(crate) width: Option<Positive<Length>>,
    pub(crate) height: Option<Positive<Length>>,
    pub(crate) resolution: [u32; 2],
}

impl Frame {
    /// Checks it, before anything is allocated by it.
    pub(crate) fn size(&self, params: &Params) -> Result<FrameSize, Faults> {
        let mut faults = Faults::new();
        let size_mm = faults.take(self.size_mm(params));
        faults.extend(self.resolution_faults(params));
        let [width_px, height_px] = self.resolution;
        let (width_mm, height_mm) = size_mm.unwrap_or_default();
        faults.into_result(FrameSize { width_px, height_px, width_mm, height_mm })
    }

    fn size_mm(&self, params: &Params) -> Result<(f64, f64), Fault> {
        match (&self.format, self.width, self.height) {
            (Some(name), None, None) => match format_named(name) {
                Some(format) => Ok((format.width_mm, format.height_mm)),
                None => {
                    let names = FORMATS.map(|f| f.name);
                    let known = names.join(", ");
                    let fault = params.fault("format", format!("unknown format `{name}`"));
                    Err(match nearest(name, names) {
                        Some(near) => fault.hint(format!("did you mean `{near}`? Known: {known}")),
                        None => fault.hint(format!("known: {known}; or give width and height")),
                    })
                }
            },
            (None, Some(width), Some(height)) => {
                let (width_mm, height_mm) = (width.mm(), height.mm());
                // Far beyond any camera; keeps areas and their inverses well inside of what a double holds.
                const RANGE_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e5;
                for (key, mm) in [("width", width_mm), ("height", height_mm)] {
                    if !RANGE_MM.contains(&mm) {
                        return Err(params
                            .fault(key, format!("{mm} mm is no size of an imager"))
                            .hint("0.001 mm to 100 m"));
                    }
                }
                Ok((width_mm, height_mm))
            }
            (None, None, None) => Err(params
                .fault("format", "how large is the imager? `format` is missing")
                .hint("`format: 135`, or width and height")),
            (Some(_), ..) => {
                Err(params.fault("format", "the size is given twice").hint("either format, or width and height"))
            }
            (None, Some(_), None) => {
                Err(params.fault("width", "`height` is missing").hint("width and height go together"))
            }
            (None, None, Some(_)) => {
                Err(params.fault("height", "`width` is missing").hint("width and height go together"))
            }
        }
    }

    fn resolution_faults(&self, params: &Params) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (i, px) in self.resolution.into_iter().enumerate() {
            if !(1..=MAX_SIDE_PX).contains(&px) {
                let text = format!("{px} pixels is no side of a picture");
                faults.push(params.fault(&format!("resolution[{i}]"), text).hint(format!("1 to {MAX_SIDE_PX}")));
            }
        }
        let [width, height] = self.resolution.map(u64::from);
        if faults.is_empty() && width * height > MAX_PIXELS {
            let text = format!("{width} x {height} are {} megapixels", width * height / 1_000_000);
            faults.push(params.fault("resolution", text).hint(format!("at most {}", MAX_PIXELS / 1_000_000)));
        }
        faults
    }
}
