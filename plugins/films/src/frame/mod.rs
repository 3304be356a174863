//! What becomes of a piece of film in camera and hands: it moves in the gate, flickers, gathers dust and scratches, and has a border.
//!
//! All of it is a function of the film's seed and the frame's number, and lies in mm on the film: other pixels show the same.

mod border;
mod chance;
mod dust;
mod motion;
mod scratches;
mod shape;

use border::Border;
use chance::Chance;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::FrameSize;
use spectra_core::params::{Length, Positive};
use spectra_film::raster::Raster;

/// `frame` as written in a scene: all of it is off unless it is written.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FrameParams {
    /// How far the picture wanders in the gate from frame to frame, root mean square across and down, up to 1 mm, mm if bare; a good
    /// camera has `5 um`. None if left out.
    #[schemars(extend("maximum" = 1))]
    pub gate_weave: Option<Positive<Length>>,
    /// By how much exposure goes up and down from frame to frame, stops, root mean square, more than 0 to 2. None if left out.
    #[schemars(range(max = 2))]
    pub breathing: Option<Positive<f64>>,
    /// Specks and fibers on the film a square centimeter, more than 0 to 1000; others on each frame. They hold light back: white on a
    /// print, black in a projection and on the negative. None if left out.
    #[schemars(range(max = 1000))]
    pub dust: Option<Positive<f64>>,
    /// How many scratches a frame has on average, more than 0 to 100. They run along the film and stay for some frames: white on a print
    /// of a negative, bright in a projection, where they have taken emulsion away. None if left out.
    #[schemars(range(max = 100))]
    pub scratches: Option<Positive<f64>>,
    /// The film around the frame: `still`, 135 film that runs across, `cine`, 35 mm film that runs down, both with perforations, or
    /// `plain`, 3 mm without any, each with the stock's name and the frame's number exposed on it. The picture is larger by it. On a
    /// print perforations are black, as the film around them is; the negative shows them. None if left out.
    pub border: Option<BorderKind>,
}

/// `border` as written in a scene.
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

/// The effects of one film.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameEffects {
    params: FrameParams,
    /// What stands on the border.
    name: String,
    seed: u64,
    frame: u64,
}

/// A plane of a film with its border.
pub(crate) struct Laid {
    /// Where its pixels lie; the frame begins at 0.
    pub raster: Raster,
    border: Option<Border>,
    /// By how much the picture is shifted, pixels.
    shift_px: [f64; 2],
}

impl FrameEffects {
    pub(crate) fn new(params: FrameParams, name: &str, seed: u64) -> Self {
        Self { params, name: name.to_owned(), seed, frame: 1 }
    }

    pub(crate) fn set_frame(&mut self, frame: u64) {
        self.frame = frame;
    }

    /// Whether a frame of this size has room for the border.
    pub(crate) fn check(&self, size: &FrameSize) -> Result<(), [String; 2]> {
        match self.params.border {
            Some(kind) => border::check(kind, [size.width_mm, size.height_mm]),
            None => Ok(()),
        }
    }

    /// By how much more the frame is exposed than it should.
    pub(crate) fn exposure(&self) -> f64 {
        self.params.breathing.map_or(1.0, |stops| motion::flicker(self.chance("breathing"), self.frame, stops.get()))
    }

    /// How a frame with pixels at `raster` lies on its film.
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

    /// Lays dust on the developed film, and scratches it: a plane of amounts, between those of unexposed film (`clear`) and the most
    /// that the layer has. On a reversal film scratches take away.
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

    fn chance(&self, what: &str) -> Chance {
        Chance::new(self.seed, what)
    }
}

impl Laid {
    /// Left, top, right and bottom, mm from the frame's upper left.
    fn extent_mm(&self) -> [f64; 4] {
        let [x, y] = self.raster.offset_px.map(|px| px as f64 * self.raster.pitch_mm);
        let [width, height] = [self.raster.width, self.raster.height].map(|px| px as f64 * self.raster.pitch_mm);
        [x, y, x + width, y + height]
    }

    /// A plane of the frame's exposure, as it lies on the film: shifted, unexposed around.
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

    /// Exposes what stands on the border to `light`, in the unit of the plane.
    pub(crate) fn print(&self, plane: &mut [f32], light: f32) {
        if let Some(border) = &self.border {
            border.print(plane, &self.raster, light);
        }
    }

    /// Shows perforations as `hole` in a finished picture.
    pub(crate) fn punch(&self, rgb: &mut [[f32; 3]], hole: [f32; 3]) {
        if let Some(border) = &self.border {
            border.punch(rgb, &self.raster, hole);
        }
    }
}
