//! A picture whose pixels are read when light is traced.

use super::backdrop::Backdrop;
use super::deep::DeepPicture;
use super::depth::Depth;
use super::height_field::HeightField;
use super::picture_file::PictureFile;
use super::picture_texture::PictureTexture;
use super::planes::Pixels;
use super::settings::{PictureSettings, assemble};
use super::tone::{CameraTone, Tone};
use super::{edges, gamut, highlights};
use crate::frame::Edge;
use crate::plane_source::PlaneSource;
use crate::split_source::{LightPart, SplitSource};
use spectra_core::params::{Faults, Warning};
use spectra_core::stage::{Source, Still};
use spectra_pictures::read::LinearPicture;
use std::sync::Arc;

/// A checked picture, flat or with depth, whose pixels are not read yet.
pub(super) struct PendingPicture {
    pub file: PictureFile,
    pub settings: PictureSettings,
    pub tone: Tone,
    /// Stops above white up to which clipped highlights are estimated; `None` if they stay clipped.
    pub recover_stops: Option<f64>,
    /// Distance of the plane from the first vertex, mm.
    pub distance_mm: f64,
    /// Pixels beyond the picture on each side that are shown, horizontally and vertically.
    pub overscan: [u32; 2],
    pub depth: Option<Depth>,
    /// Focal length of the lens, mm, if it is known.
    pub focal_length_mm: Option<f64>,
}

impl PendingPicture {
    /// Returns whether the picture emits rays: its light ends at its border.
    pub(super) fn emits(&self) -> bool {
        self.settings.edge == Edge::Black
    }

    /// Reads the pixels in linear light, without a tone curve, and with highlights recovered if that is asked for.
    fn pixels(&self, overscan: [u32; 2]) -> Result<LinearPicture, Faults> {
        let mut linear = self.file.read(overscan)?;
        if self.tone == Tone::Camera {
            let curve = CameraTone::new();
            curve.take_back(&mut linear.rgb);
            linear.clipped_at = linear.clipped_at.map(|at| curve.value(at));
        }
        if let (Some(stops), Some(clipped_at)) = (self.recover_stops, linear.clipped_at) {
            highlights::recover(&mut linear.rgb, linear.width as usize, clipped_at, stops);
        }
        gamut::bring_in(&mut linear, &*self.settings.model);
        Ok(linear)
    }

    /// Reads the picture without its overscan, for exposing film without a lens.
    pub(super) fn still(&self) -> Result<(Still, Vec<Warning>), Faults> {
        let linear = self.pixels([0; 2])?;
        let warnings = self.file.warnings(&linear);
        Ok((self.settings.still(linear), warnings))
    }

    /// Reads the picture and makes its source.
    pub(super) fn source(&self) -> Result<(Box<dyn Source>, Vec<Warning>), Faults> {
        let linear = self.pixels(self.overscan)?;
        let mut warnings = self.file.warnings(&linear);
        let source = match &self.depth {
            Some(depth) => self.deep_source(depth, linear, &mut warnings)?,
            None => {
                let distance_mm = self.distance_mm;
                let map = self.settings.map(linear, &self.file.name);
                with_halves(map, self.emits(), |texture| PlaneSource { texture, distance_mm })
            }
        };
        Ok((source, warnings))
    }

    /// Makes the source of a picture whose pixels lie at their depths.
    fn deep_source(
        &self,
        depth: &Depth,
        mut linear: LinearPicture,
        warnings: &mut Vec<Warning>,
    ) -> Result<Box<dyn Source>, Faults> {
        let width_mm = self.settings.width_mm;
        let plane_mm = self.distance_mm + depth.eye_mm;
        let mut all = depth.of(&linear, plane_mm, width_mm, self.overscan)?;
        let size_px = [linear.width, linear.height];
        let pixels = Pixels { size_px, aspect: linear.pixel_aspect, pixel_mm: width_mm / f64::from(linear.width) };
        let doubt = depth.scale_warning(&all, plane_mm, self.focal_length_mm);
        warnings.extend(doubt.or_else(|| depth.kind_warning(&all, plane_mm, pixels)));
        // The raw depths of the picture are no longer needed.
        linear.depth = None;
        let width_px = linear.width as usize;
        let mixed = match depth.cleans_edges {
            true => edges::part(&mut linear.rgb, &mut all, width_px, depth.edge),
            false => None,
        };
        let meaning: Arc<str> = depth.describe(all.len(), mixed.as_ref()).into();
        let map = assemble(linear, &self.file.name, &self.settings, mixed.as_ref());
        let model = &*self.settings.model;
        let behind = mixed.map(|mixed| Arc::new(Backdrop::new(mixed, model, &all, width_px, depth.edge)));
        let ends = all.iter().fold([f32::INFINITY, 0.0_f32], |[a, b], d| [a.min(*d), b.max(*d)]);
        let field = Arc::new(HeightField::new(map.width_px, map.height_px, &all, depth.edge));
        Ok(with_halves(map, self.emits(), |map| {
            let fields = (Arc::clone(&field), behind.clone());
            DeepPicture::new(map, fields, plane_mm, depth.eye_mm, ends.map(f64::from), Arc::clone(&meaning))
        }))
    }
}

/// Makes the source of a picture. If the picture has lights and may emit, the source also has a part with the lights and one with the
/// rest.
fn with_halves<S: Source + 'static>(
    map: PictureTexture,
    emits: bool,
    make: impl Fn(PictureTexture) -> S,
) -> Box<dyn Source> {
    let Some(pays) = map.lights.as_ref().filter(|_| emits).map(|lights| lights.pays) else {
        return Box::new(make(map));
    };
    let [lights, rest] = [LightPart::Lights, LightPart::Rest].map(|half| make(map.half(half)));
    Box::new(SplitSource { lights, rest, whole: make(map), pays })
}
