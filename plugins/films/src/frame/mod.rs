//! Traces of camera and handling on a piece of film: gate weave, flicker, dust, scratches and a border.
//!
//! Weave, flicker and border act on the exposure before the characteristic curve, dust and scratches on the density, perforations on the
//! picture. Everything is a function of the film's seed and the frame's number, and is placed in mm on the film, so it does not depend on
//! the resolution.

mod border;
mod dust;
mod motion;
mod random_seed;
mod scratches;
mod shape;

use border::Border;
use random_seed::RandomSeed;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::FrameSize;
use spectra_core::params::{Length, Positive};
use spectra_film::raster::Raster;

/// The map `frame` of a film, as written in a scene: gate weave, flicker, dust, scratches and border. An effect that is left out
/// is off.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FrameParams {
    /// Gate weave: root mean square of the picture's shift in the gate from frame to frame, both across and down, up to 1 mm, mm if bare;
    /// a good camera has `5 um`. Off if left out.
    #[schemars(extend("maximum" = 1))]
    pub gate_weave: Option<Positive<Length>>,
    /// Flicker: root mean square of the change in exposure from frame to frame, stops, more than 0 to 2. Off if left out.
    #[schemars(range(max = 2))]
    pub breathing: Option<Positive<f64>>,
    /// Specks and fibers per square centimeter of film, more than 0 to 1000; different ones on each frame. They block light, so they are
    /// white on a print and black in a projection and on the negative. No dust if left out.
    #[schemars(range(max = 1000))]
    pub dust: Option<Positive<f64>>,
    /// Mean number of scratches on a frame, more than 0 to 100. Scratches run along the film and last for some frames. They are white on a
    /// print of a negative, and bright in a projection, because they have removed emulsion. No scratches if left out.
    #[schemars(range(max = 100))]
    pub scratches: Option<Positive<f64>>,
    /// Film around the frame: `still` is 135 film that runs across, `cine` 35 mm film that runs down, both with perforations; `plain` is
    /// 3 mm of film without any. The stock's name and the frame's number are exposed on it. The border makes the picture larger. On a
    /// print the perforations are as black as the film around them; the negative shows them. No border if left out.
    pub border: Option<BorderKind>,
}

/// The value of `border` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum BorderKind {
    /// 135 film in a still camera (ISO 1007).
    Still,
    /// 35 mm film in a motion-picture camera (ISO 491).
    Cine,
    /// Sheet or roll film.
    Plain,
}

/// Traces of camera and handling on one film, at one frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameEffects {
    params: FrameParams,
    /// Name of the stock, which is exposed on the border.
    name: String,
    seed: u64,
    frame: u64,
}

/// Layout of a frame on its film: the raster with the border, and the shift by gate weave.
pub(crate) struct Laid {
    /// Position of the pixels on the film; the frame begins at pixel 0, and the border lies around it.
    pub raster: Raster,
    border: Option<Border>,
    /// Shift of the picture across and down, in pixels.
    shift_px: [f64; 2],
}

impl FrameEffects {
    pub(crate) fn new(params: FrameParams, name: &str, seed: u64) -> Self {
        Self { params, name: name.to_owned(), seed, frame: 1 }
    }

    pub(crate) fn set_frame(&mut self, frame: u64) {
        self.frame = frame;
    }

    /// Checks that a frame of this size fits in the border. The error is a message and a hint.
    pub(crate) fn check(&self, size: &FrameSize) -> Result<(), [String; 2]> {
        match self.params.border {
            Some(kind) => border::check(kind, [size.width_mm, size.height_mm]),
            None => Ok(()),
        }
    }

    /// Returns the factor by which flicker changes the exposure of the frame.
    pub(crate) fn exposure(&self) -> f64 {
        self.params.breathing.map_or(1.0, |stops| motion::flicker(self.chance("breathing"), self.frame, stops.get()))
    }

    /// Returns the layout on the film of a frame with pixels at `raster`.
    pub(crate) fn laid(&self, raster: &Raster) -> Laid {
        let pitch = raster.pitch_mm;
        let size_mm = [raster.width as f64 * pitch, raster.height as f64 * pitch];
        let border = self.params.border.map(|kind| Border::new(kind, size_mm, &self.name, self.frame));
        let [across, down] = border.as_ref().map_or([0; 2], |b| b.margin_mm().map(|mm| (mm / pitch).round() as usize));
        let outer = Raster {
            width: raster.width + 2 * across,
            height: raster.height + 2 * down,
            pitch_mm: pitch,
            offset_px: [raster.offset_px[0] - across as i64, raster.offset_px[1] - down as i64],
        };
        let weave = self.params.gate_weave.map(|rms| motion::weave(self.chance("weave"), self.frame, rms.get().mm()));
        Laid { raster: outer, border, shift_px: weave.unwrap_or_default().map(|mm| mm / pitch) }
    }

    /// Adds scratches and dust to a plane of amounts of the developed film. `range` is the layer's least and largest amount, and `clear`
    /// the amount of unexposed film. On a reversal film scratches remove emulsion.
    pub(crate) fn soil(&self, plane: &mut [f32], laid: &Laid, range: (f64, f64), clear: f64, reversal: bool) {
        let vertical = self.params.border != Some(BorderKind::Still);
        if let Some(count) = self.params.scratches {
            let away = if reversal { -1.0 } else { 1.0 };
            let all = scratches::of(self.chance("scratches"), self.frame, count.get(), laid.extent_mm(), vertical);
            scratches::apply(&all, plane, &laid.raster, vertical, away, if reversal { range.0 } else { clear });
        }
        if let Some(density) = self.params.dust {
            let seed = self.chance("dust").with(self.frame);
            dust::apply(seed, density.get(), plane, &laid.raster, range.1);
        }
    }

    fn chance(&self, what: &str) -> RandomSeed {
        RandomSeed::new(self.seed, what)
    }
}

impl Laid {
    /// Returns the left, top, right and bottom edges of the raster, mm from the frame's upper left corner.
    fn extent_mm(&self) -> [f64; 4] {
        let [x, y] = self.raster.offset_px.map(|px| px as f64 * self.raster.pitch_mm);
        let [width, height] = [self.raster.width, self.raster.height].map(|px| px as f64 * self.raster.pitch_mm);
        [x, y, x + width, y + height]
    }

    /// Places a plane of the frame's exposure on the film: shifted by gate weave, and surrounded by unexposed border.
    pub(crate) fn lay(&self, plane: Vec<f32>, frame: &Raster) -> Vec<f32> {
        let (width, height) = (self.raster.width, self.raster.height);
        let mut out = plane;
        if self.border.is_some() {
            let [left, top] = [0, 1].map(|i| (frame.offset_px[i] - self.raster.offset_px[i]) as usize);
            let mut wide = vec![0.0; width * height];
            for (y, row) in out.chunks(frame.width.max(1)).enumerate() {
                let at = (top + y) * width + left;
                wide[at..at + frame.width].copy_from_slice(row);
            }
            out = wide;
        }
        if self.shift_px != [0.0; 2] {
            out = motion::shifted(&out, width, height, self.shift_px);
        }
        out
    }

    /// Exposes the letters on the border with `light`, in the unit of the plane.
    pub(crate) fn print(&self, plane: &mut [f32], light: f32) {
        if let Some(border) = &self.border {
            border.print(plane, &self.raster, light);
        }
    }

    /// Paints perforations in the color `hole` into a finished picture.
    pub(crate) fn punch(&self, rgb: &mut [[f32; 3]], hole: [f32; 3]) {
        if let Some(border) = &self.border {
            border.punch(rgb, &self.raster, hole);
        }
    }
}
