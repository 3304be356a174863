//! The scene in which a picture file is developed on a film, made here instead of read from a file.
//!
//! The picture fills the frame, which is the largest part of the format's frame that has the picture's shape. White has a
//! luminance of 5000 cd/m2, as in daylight under clouds; that allows an exposure short enough for any film. A photograph (a file
//! of integers) is exposed as it was taken, after its camera's tone curve is removed. Light in floating point is metered as
//! cameras do.

use crate::generated::{MADE, without_generated_places};
use crate::still::{LightFrom, WHITE_CD_M2};
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile, Value};
use spectra_core::registry::{self, Context};
use spectra_core::resources::{ResourceError, Resources};
use spectra_core::spectral::BAND;
use spectra_core::stage::Imager;
use spectra_pictures::read::{Header, ReadOptions, header};
use spectra_scene::{FileResources, FilmTime, NO_LENS, Series, document, series_of_tree, yaml};
use std::path::Path;
use std::sync::Arc;

/// A value of the scene that the user sets.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Path of the value in a scene, such as `film.stock`.
    pub path: String,
    /// The value as it would be written in a scene.
    pub value: String,
    /// The user's own words, for messages: `--stock tri-x`.
    pub as_typed: String,
}

/// A picture to develop, and the file to write.
#[derive(Clone, Debug)]
pub struct PictureJob {
    /// Picture file to develop.
    pub file: String,
    /// Name of the file to write, in the folder of the host.
    pub output: String,
    /// Number of the picture in a sequence or in its file name, if it has one. Each number has grain of its own.
    pub number: Option<u64>,
}

/// Settings of the scenes in which pictures are developed.
#[derive(Clone, Debug, Default)]
pub struct DevelopSettings {
    /// Settings of the scene. If they name a lens (`lens.file`), rays are traced through it; otherwise the film is exposed to the
    /// picture's own pixels.
    pub settings: Vec<Setting>,
    /// Values set on top of `settings`: texts `path=value`.
    pub overrides: Vec<String>,
    /// Format that the frame is cut from; 135 if `None`.
    pub format: Option<Setting>,
    /// Pixels along the longer side of the frame. If `None`, those of the picture, but at most 1920 through a lens.
    pub side_px: Option<u32>,
    /// Whether each picture is metered by itself. Otherwise the first one is metered for all.
    pub meter_each: bool,
}

/// A photograph developed on a film, opened as a session instead of only being written to a file.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// The picture; its output names the scene.
    pub plate: PictureJob,
    /// Settings of the scene, as in [`DevelopSettings`].
    pub settings: Vec<Setting>,
    /// Format that the frame is cut from; 135 if `None`.
    pub format: Option<Setting>,
}

impl Photograph {
    /// Returns the scene of the photograph, with texts `path=value` on top. Without a lens ([`Series::is_without_lens`]) its film
    /// is exposed by [`crate::expose`].
    ///
    /// # Errors
    /// Every fault of the picture's file or of the settings.
    pub fn series(&self, overrides: &[String]) -> Result<Series, Faults> {
        let settings = DevelopSettings {
            settings: self.settings.clone(),
            overrides: overrides.to_vec(),
            format: self.format.clone(),
            ..DevelopSettings::default()
        };
        Ok(settings.scene(&self.plate, None)?.0)
    }
}

/// Returns the number at the end of `stem`, a file name without its extension, or before a version at the end: 7 for
/// `plate.0007.v2`.
#[must_use]
pub fn last_number(stem: &str) -> Option<u64> {
    let version = stem.rfind(['.', '_', '-']).filter(|at| {
        let said = stem[at + 1..].strip_prefix(['v', 'V']);
        said.is_some_and(|said| !said.is_empty() && said.bytes().all(|b| b.is_ascii_digit()))
    });
    if let Some(number) = version.and_then(|at| closing_number(&stem[..at])) {
        return Some(number);
    }
    closing_number(stem)
}

/// Returns the number made of the digits at the end of a text.
fn closing_number(stem: &str) -> Option<u64> {
    let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    stem[stem.len() - digits..].parse().ok()
}

/// Returns whether a file is a picture that can be developed, by its extension.
#[must_use]
pub fn is_picture(file: &Path) -> bool {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| PICTURES.contains(&&*ending))
}

/// File extensions of pictures that can be developed.
pub const PICTURES: [&str; 10] = ["exr", "png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "hdr", "dpx"];

/// Pixels along the longer side of a traced frame if the user gives no number.
const TRACED_PX: u32 = 1920;

/// Largest picture file that is read, bytes; the same limit as for `source: picture`.
const MAX_BYTES: u64 = 1 << 30;

/// Keys of the film that control metering; left out if the exposure is already known.
const METERING: [&str; 3] = ["film.metering", "film.spot", "film.compensation"];

/// Keys of a lens that have no effect without a lens. Its filters are not among them: they act on the film without a lens, too.
const IDLE: [&str; 3] = ["lens.f-number", "lens.focus", "lens.aperture"];

/// Returns whether a path belongs to [`IDLE`].
fn is_idle(path: &str) -> bool {
    IDLE.iter().any(|key| path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.')))
}

/// Returns the path of a text `path=value`.
fn path_of(text: &str) -> &str {
    text.split_once('=').map_or("", |(path, _)| path).trim()
}

impl DevelopSettings {
    /// Returns the scene in which `plate` is developed, and where its light comes from. With `metered`, the picture gets that
    /// exposure, which was metered on another picture; `None` meters this picture or uses the stated exposure.
    ///
    /// # Errors
    /// Every fault of the picture's file or of the settings, without the places of values that the user did not write.
    pub fn scene(&self, plate: &PictureJob, metered: Option<&FilmTime>) -> Result<(Series, LightFrom), Faults> {
        self.scene_with_places(plate, metered).map_err(without_generated_places)
    }

    fn scene_with_places(&self, plate: &PictureJob, metered: Option<&FilmTime>) -> Result<(Series, LightFrom), Faults> {
        let files = FileResources::beside(Path::new(""));
        let is_of_meter = |path: &str| METERING.iter().any(|key| path == *key || path.starts_with(&format!("{key}.")));
        let is_kept = |path: &str| metered.is_none() || !is_of_meter(path.trim());
        let overrides: Vec<String> = self.overrides.iter().filter(|text| is_kept(path_of(text))).cloned().collect();
        let has_lens =
            self.settings.iter().any(|s| s.path == "lens.file") || overrides.iter().any(|o| path_of(o) == "lens.file");
        if !has_lens && let Some(text) = overrides.iter().find(|text| is_idle(path_of(text))) {
            let set = yaml::parse_override(text)?;
            let fault = set.node.fault(format!("without a lens `{}` does nothing", set.path));
            return Err(fault
                .path(&set.path)
                .hint("name a lens, such as `--lens helios-44-58-f2`, or leave this setting out")
                .into());
        }
        let made = self.generated_values(plate, metered, &overrides, has_lens, &files)?;
        let nobody = Arc::new(SourceFile::new(MADE, ""));
        let mut root = Node::new(Value::Map(Vec::new()), Default::default(), Arc::clone(&nobody));
        let mut faults = Faults::new();
        for (path, value) in made {
            faults.take(put(&mut root, path, &value, MADE));
        }
        let file = Value::String(plate.file.clone());
        faults.take(root.set_path("source.file", Node::new(file, Default::default(), nobody)));
        for setting in self.settings.iter().filter(|s| is_kept(&s.path)) {
            faults.take(put(&mut root, &setting.path, &setting.value, &setting.as_typed));
        }
        faults.into_result(())?;
        // The record holds the scene as a user would write it.
        root.file = Arc::new(SourceFile::new(MADE, document(&root)));
        let resources: Arc<dyn Resources> = Arc::new(files);
        let name = Path::new(&plate.output).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let series = series_of_tree(&format!("{name}.yaml"), root, &overrides, resources)?;
        Ok((series, if has_lens { LightFrom::Rays } else { LightFrom::Pixels }))
    }

    /// Returns the values of the scene that the user need not write, by their paths.
    fn generated_values(
        &self,
        plate: &PictureJob,
        metered: Option<&FilmTime>,
        overrides: &[String],
        has_lens: bool,
        files: &FileResources,
    ) -> Result<Vec<(&'static str, String)>, Faults> {
        let sets = |path: &str| overrides.iter().any(|text| path_of(text) == path);
        let layer = overrides.iter().rev().find(|o| path_of(o) == "source.layer");
        let layer = layer.and_then(|text| text.split_once('=')).map(|(_, layer)| layer.trim());
        let header = header_of(&plate.file, layer, files)?;
        let [width_mm, height_mm] = frame_mm(self.format.as_ref(), &header, files)?;
        let [across, down] = pixels(self.side_px, &header, has_lens)?;
        // Makes the pixels square to the last digit, although their numbers are rounded to integers.
        let height_mm =
            if self.side_px.is_some() || has_lens { width_mm * f64::from(down) / f64::from(across) } else { height_mm };
        let mut made = vec![
            ("spectra", "1".to_owned()),
            ("source.kind", "picture".to_owned()),
            ("source.distance", "3 m".to_owned()),
            ("source.width", "fill".to_owned()),
            ("source.luminance", format!("{WHITE_CD_M2} cd/m2")),
            ("lens.file", NO_LENS.to_owned()),
            ("lens.focus", "3 m".to_owned()),
            ("imager.kind", "film".to_owned()),
            ("imager.width", format!("{width_mm} mm")),
            ("imager.height", format!("{height_mm} mm")),
            ("imager.resolution", format!("[{across}, {down}]")),
            ("film.kind", "stock".to_owned()),
        ];
        match metered {
            Some(time) => made.push(("film.exposure", format!("{} s", time.time_s))),
            // A stated time is used as it is. If metering is stated as well, a warning says that one of the two has no effect.
            None if sets("film.exposure") => {}
            // Metering on request applies to photographs too, which are otherwise exposed as taken.
            None if self.meter_each => made.push(("film.metering", "camera".to_owned())),
            None => made.push(("film.exposure", "metered".to_owned())),
        }
        if has_lens {
            made.push(("render.noise", "auto".to_owned()));
        }
        // An `.exr` name asks for the picture on film. The light before the film is written only if `output` is set.
        let is_exr = Path::new(&plate.output).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        if is_exr && !sets("output") {
            made.push(("output", "[{kind: exr, holds: picture}]".to_owned()));
        }
        if header.is_for_display && !sets("source.tone") {
            made.push(("source.tone", "camera".to_owned()));
        }
        made.extend(plate.number.map(|number| ("render.frame", number.to_string())));
        Ok(made)
    }
}

/// Puts a value, as it is written, at a path.
fn put(root: &mut Node, path: &str, value: &str, said: &str) -> Result<(), Faults> {
    let node = yaml::parse(SourceFile::new(said, value))?;
    Ok(root.set_path(path, node)?)
}

/// Reads the size and kind of a picture file from its header.
fn header_of(file: &str, layer: Option<&str>, files: &dyn Resources) -> Result<Header, Faults> {
    let found = files.find(file, &["scenes"], &[], MAX_BYTES).map_err(|error| {
        let hint = match &error {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            _ => "OpenEXR, PNG, JPEG, TIFF, WebP, BMP and Radiance HDR files are read".to_owned(),
        };
        Fault::new(format!("picture `{file}`: {error}")).hint(hint)
    })?;
    let choice = ReadOptions { name: file, layer, ..ReadOptions::default() };
    header(&found, choice)
        .map_err(|trouble| Fault::new(format!("picture `{file}`: {}", trouble.text)).hint(trouble.advice()).into())
}

/// Returns the width and height, in mm, of the largest frame with the picture's shape that fits a format. The format is turned
/// upright for an upright picture.
fn frame_mm(format: Option<&Setting>, header: &Header, files: &dyn Resources) -> Result<[f64; 2], Faults> {
    let mut node = yaml::parse(SourceFile::new(MADE, "{kind: film, format: 135, resolution: 1}"))?;
    if let Some(setting) = format {
        put(&mut node, "format", &setting.value, &setting.as_typed)?;
    }
    let params = Params::stage(node, "imager")?;
    let size = registry::build::<dyn Imager>(&params, &Context::new(files, BAND))?.size();
    let [long, short] = [size.width_mm.max(size.height_mm), size.width_mm.min(size.height_mm)];
    let aspect = header.aspect();
    let [width, height] = if aspect >= 1.0 { [long, short] } else { [short, long] };
    Ok(if aspect > width / height { [width, width / aspect] } else { [height * aspect, height] })
}

/// Returns the number of pixels of the frame, across and down.
fn pixels(side_px: Option<u32>, header: &Header, has_lens: bool) -> Result<[u32; 2], Faults> {
    let own = [header.width, header.height];
    if (header.pixel_aspect - 1.0).abs() > 0.01 && !has_lens && side_px.is_none() {
        let text =
            format!("its pixels are {:.2} times as wide as high, but film needs square ones", header.pixel_aspect);
        return Err(Fault::new(text).hint("set `--side` to fewer pixels than the picture has").into());
    }
    let upright = [f64::from(own[0]) * header.pixel_aspect.max(1.0), f64::from(own[1]) / header.pixel_aspect.min(1.0)];
    let longest = upright[0].max(upright[1]);
    let side = match side_px {
        Some(side) => f64::from(side),
        None if has_lens => longest.min(f64::from(TRACED_PX)),
        None => return Ok(own),
    };
    Ok(upright.map(|px| ((px * side / longest).round() as u32).max(1)))
}
