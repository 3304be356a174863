//! Development of a film from one or many picture files, without a scene file: the scene is made here.
//!
//! The picture fills the frame, which is the largest part of the format's frame that has the picture's shape. White has a
//! luminance of 5000 cd/m2, as in daylight under clouds; that allows an exposure short enough for any film. A photograph (a file
//! of integers) is exposed as it was taken, after its camera's tone curve is removed. Light in floating point is metered as
//! cameras do.

use crate::generated::{MADE, without_generated_places};
use crate::run::{fits, picture};
use crate::still::WHITE_CD_M2;
use crate::traced_picture::{IncompletePolicy, TracedPicture};
use crate::{
    Event, Host, Job, JobEnd, LightFrom, Names, SeriesPosition, Session, SessionError, SessionOptions, formatting,
};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile, Warning};
use spectra_core::registry::{self, Context};
use spectra_core::resources::{ResourceError, Resources};
use spectra_core::spectral::BAND;
use spectra_core::stage::Imager;
use spectra_pictures::read::{Header, ReadOptions, header};
use spectra_scene::{FileResources, FilmTime, NO_LENS, Output, Series, document, series_of_tree, yaml};
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
    /// File to write, in the folder of the host.
    pub output: String,
    /// Number of the picture in a sequence or in its file name, if it has one. Each number has grain of its own.
    pub number: Option<u64>,
}

/// Pictures to develop, and how to develop them.
pub struct Develop<'a> {
    /// Pictures to develop, in order.
    pub plates: Vec<PictureJob>,
    /// Settings of the scene. If they name a lens (`lens.file`), rays are traced through it; otherwise the film is exposed to the
    /// picture's own pixels.
    pub settings: Vec<Setting>,
    /// Values set on top of `settings`: texts `path=value`.
    pub overrides: Vec<String>,
    /// Format that the frame is cut from; 135 if `None`.
    pub format: Option<Setting>,
    /// Pixels along the longer side of the frame. If `None`, those of the picture, but at most [`TRACED_PX`] through a lens.
    pub side_px: Option<u32>,
    /// Whether the pictures are a series. Of a series only complete pictures are written, and one that fails does not stop the
    /// others.
    pub is_series: bool,
    /// Notes on a series, given before any of it is developed.
    pub notes: Vec<String>,
    /// Whether each picture is metered by itself. Otherwise the first one is metered for all.
    pub meter_each: bool,
    /// Whether pictures whose files already exist are skipped.
    pub skip_existing: bool,
    /// Instruction set that rays are traced with.
    pub isa: Isa,
    /// Version of the program, for the record.
    pub version: &'a str,
    /// Versions that a result depends on, for the record.
    pub versions: Value,
}

/// A photograph on a film, for use as a [`Session`] instead of only being written. The scene is the one that [`develop`] makes of
/// it.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// The picture; its output names the scene.
    pub plate: PictureJob,
    /// Settings of the scene, as in [`Develop`].
    pub settings: Vec<Setting>,
    /// Format that the frame is cut from; 135 if `None`.
    pub format: Option<Setting>,
}

impl Photograph {
    /// Returns the scene of the photograph, with texts `path=value` on top. Without a lens ([`Series::is_without_lens`]) its film
    /// is exposed by [`Session::expose`].
    ///
    /// # Errors
    /// Every fault of the picture's file or of the settings.
    pub fn series(&self, overrides: &[String], isa: Isa) -> Result<Series, SessionError> {
        let job = Develop {
            plates: Vec::new(),
            settings: self.settings.clone(),
            overrides: overrides.to_vec(),
            format: self.format.clone(),
            side_px: None,
            is_series: false,
            notes: Vec::new(),
            meter_each: false,
            skip_existing: false,
            isa,
            version: "",
            versions: Value::Null,
        };
        Ok(scene(&job, &self.plate, None).map_err(without_generated_places)?.0)
    }
}

/// Returns the number at the end of a file name without its extension, or before a version at its end, as in `plate.0007.v2`.
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
pub const TRACED_PX: u32 = 1920;

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

/// Returns the extension of the picture file, such as `png`, if `output` is set among `overrides` (texts `path=value`).
///
/// # Errors
/// `output` names a file that is not a picture, or more than one file.
pub fn picture_ending(overrides: &[String]) -> Result<Option<String>, Fault> {
    // A value that cannot be read is reported when the scene is read.
    let set =
        overrides.iter().rev().filter_map(|text| yaml::parse_override(text).ok()).find(|set| set.path == "output");
    let Some(yaml::Override { node, .. }) = set else { return Ok(None) };
    let files = FileResources::beside(Path::new(""));
    let context = Context::new(&files, BAND);
    let mut endings = Vec::new();
    for item in (0..).map_while(|index| node.element(index)) {
        let output = Params::stage(item.clone(), "output").and_then(|p| registry::build::<dyn Output>(&p, &context));
        let Ok(output) = output else { return Ok(None) };
        endings.push(output.ending()[1]);
    }
    match &endings[..] {
        [ending] if Names::of_picture(Path::new(&format!("picture{ending}"))).is_some() => {
            Ok(Some(ending.trim_start_matches('.').to_owned()))
        }
        [] => Ok(None),
        [ending] => {
            let text = format!("`film develop` writes pictures, but {ending} is not a picture");
            Err(node.fault(text).hint("`--set output=[png]`, or tiff or exr"))
        }
        [first, ..] => {
            let text = format!("one file is written for each picture, but these are {}", endings.join(", "));
            let hint = format!(
                "keep one, or choose with `-o`: `-o out/picture{first}`, or `-o out/####{first}` for a sequence"
            );
            Err(node.fault(text).hint(hint))
        }
    }
}

/// Develops all pictures of a job.
///
/// # Errors
/// [`SessionError`]; if one of several pictures fails, the others are developed all the same.
pub fn develop(job: &Develop<'_>, host: &dyn Host) -> Result<JobEnd, SessionError> {
    match &job.plates[..] {
        [plate] if !job.is_series && !job.skip_existing => {
            one(job, plate, None, IncompletePolicy::IsKept, host).map(|(ended, _)| ended)
        }
        // A file that is skipped if it exists must be complete, so an incomplete picture is not written.
        [plate] if !job.is_series => {
            host.hear(Event::Picture(Some(place(plate, 0, 1))));
            if is_there(plate, 0, 1, host) {
                return Ok(JobEnd::Whole);
            }
            one(job, plate, None, IncompletePolicy::IsLeftOut, host).map(|(ended, _)| ended)
        }
        plates => all(job, plates, host),
    }
}

/// Returns the number and the position of a picture among all.
fn place(plate: &PictureJob, index: usize, of: usize) -> SeriesPosition {
    let number = plate.number.unwrap_or(index as u64 + 1);
    SeriesPosition { number: u32::try_from(number).unwrap_or(u32::MAX), index, of }
}

/// Returns whether a picture's file already exists, and reports it if so.
fn is_there(plate: &PictureJob, index: usize, of: usize, host: &dyn Host) -> bool {
    let is_there = host.folder().has(&plate.output);
    if is_there {
        let shown = host.folder().shown(&plate.output);
        host.hear(Event::Series(
            &format!("{} of {of}: {} already exists", index + 1, formatting::files(std::slice::from_ref(&shown))),
            &json!({ "event": "kept", "files": [shown] }),
        ));
    }
    is_there
}

/// Develops pictures one after another.
fn all(job: &Develop<'_>, plates: &[PictureJob], host: &dyn Host) -> Result<JobEnd, SessionError> {
    let begun_s = host.now_s();
    host.hear(Event::Series(
        &format!(
            "{}, {}",
            formatting::counted(plates.len() as u64, "picture"),
            if job.meter_each { "each metered" } else { "exposed like the first" }
        ),
        &json!({ "event": "series", "pictures": plates.len(), "metered": if job.meter_each { "each" } else { "first" } }),
    ));
    for note in &job.notes {
        host.hear(Event::Note(note));
    }
    let (mut metered, mut done, mut failed) = (None, 0, Vec::new());
    // A stated exposure is not metered.
    let mut meters = !job.meter_each;
    let mut ended = JobEnd::Whole;
    for (index, plate) in plates.iter().enumerate() {
        if host.is_stopped() {
            ended = JobEnd::Stopped;
            break;
        }
        host.hear(Event::Picture(Some(place(plate, index, plates.len()))));
        if job.skip_existing && is_there(plate, index, plates.len(), host) {
            done += 1;
            continue;
        }
        if metered.is_none() && meters && index > 0 {
            let mut earlier =
                plates[..index].iter().filter(|earlier| failed.iter().all(|(file, _)| *file != earlier.file));
            metered = earlier.find_map(|earlier| meter(job, earlier, host));
            if host.is_stopped() {
                ended = JobEnd::Stopped;
                break;
            }
            if metered.is_none() {
                let text = format!(
                    "`{}` sets the exposure instead of the first picture; those after it are exposed like it",
                    plate.file
                );
                host.hear(Event::Warning(&Warning::from(text)));
            }
        }
        let exposure = metered.as_ref().filter(|_| !job.meter_each);
        match one(job, plate, exposure, IncompletePolicy::IsLeftOut, host) {
            Ok((JobEnd::Stopped, _)) => {
                ended = JobEnd::Stopped;
                break;
            }
            Ok((JobEnd::Whole, times)) => {
                done += 1;
                metered = metered.or_else(|| times.into_iter().find(|time| time.is_metered));
                meters &= metered.is_some();
            }
            // A fault of the settings affects every picture.
            Err(SessionError::Faults(faults)) if faults.iter().any(|fault| fault.place.is_some()) => {
                return Err(faults.into());
            }
            Err(error @ SessionError::Request(_)) => return Err(error),
            Err(error) => {
                host.hear(Event::Warning(&Warning::from(format!("`{}` was not developed: {error}", plate.file))));
                failed.push((plate.file.clone(), error.to_string()));
            }
        }
    }
    host.hear(Event::Picture(None));
    let stopped = ended == JobEnd::Stopped && host.is_interrupted();
    host.hear(Event::Series(
        &format!(
            "{done} of {} in {}",
            formatting::counted(plates.len() as u64, "picture"),
            formatting::duration(host.now_s() - begun_s)
        ),
        &json!({ "event": "end", "done": done, "of": plates.len(), "interrupted": stopped }),
    ));
    match &failed[..] {
        [] => Ok(ended),
        [(file, why)] => Err(SessionError::Failed(format!("`{file}` was not developed: {why}"))),
        // Gives the cause of the first failure: all may have the same one, and warnings may be turned off.
        [(file, why), ..] => {
            Err(SessionError::Failed(format!("{} pictures were not developed: `{file}`: {why} ...", failed.len())))
        }
    }
}

/// Meters a picture whose file already exists. Returns `None` if it cannot be read, or if tracing stops. Through a lens it is
/// traced with all samples, because fewer would change the last digits of the metered time.
fn meter(job: &Develop<'_>, plate: &PictureJob, host: &dyn Host) -> Option<FilmTime> {
    let (series, light) = scene(job, plate, None).ok()?;
    let mut session = Session::new(series, SessionOptions { isa: job.isa, ..SessionOptions::default() }).ok()?;
    let rendering = match light {
        LightFrom::Pixels => session.expose().ok()?,
        LightFrom::Rays if !session.scene().films.iter().any(|film| film.film.is_metered()) => return None,
        LightFrom::Rays => {
            fits(&session, host).ok()?;
            host.hear(Event::Note(&format!("`{}` is traced once more, to expose the others like it", plate.file)));
            let control = host.control();
            session.prepare(host.workers()).ok()?;
            TracedPicture::of(&mut session, host, &control, IncompletePolicy::IsLeftOut).ok()?.rendering
        }
    };
    let exposure = (!rendering.partial).then_some(rendering.exposure)?;
    session.scene().film_times(&exposure).into_iter().find(|time| time.is_metered)
}

/// Develops a picture, with the exposure metered on another one if `metered` is given.
fn one(
    job: &Develop<'_>,
    plate: &PictureJob,
    metered: Option<&FilmTime>,
    unfinished: IncompletePolicy,
    host: &dyn Host,
) -> Result<(JobEnd, Vec<FilmTime>), SessionError> {
    let (series, light) = scene(job, plate, metered).map_err(without_generated_places)?;
    let of_picture = Names::of_picture(Path::new(&plate.output));
    let none = || SessionError::Request(format!("{}: a picture cannot be written with this ending", plate.output));
    let job = Job {
        series: &series,
        light,
        chosen: vec![0],
        skip_existing: false,
        names: of_picture.ok_or_else(none)?,
        isa: job.isa,
        scene_file: plate.file.clone(),
        overrides: series.overrides().to_vec(),
        version: job.version,
        versions: job.versions.clone(),
    };
    picture(&job, unfinished, host).map_err(|error| match error {
        SessionError::Faults(faults) => SessionError::Faults(without_generated_places(faults)),
        other => other,
    })
}

/// Returns the scene of a picture, and where its light comes from.
fn scene(job: &Develop<'_>, plate: &PictureJob, metered: Option<&FilmTime>) -> Result<(Series, LightFrom), Faults> {
    let files = FileResources::beside(Path::new(""));
    let is_of_meter = |path: &str| METERING.iter().any(|key| path == *key || path.starts_with(&format!("{key}.")));
    let is_kept = |path: &str| metered.is_none() || !is_of_meter(path.trim());
    let path_of = |text: &str| text.split_once('=').map_or("", |(path, _)| path).trim().to_owned();
    let overrides: Vec<String> = job.overrides.iter().filter(|text| is_kept(&path_of(text))).cloned().collect();
    let has_lens =
        job.settings.iter().any(|s| s.path == "lens.file") || overrides.iter().any(|o| path_of(o) == "lens.file");
    let light = if has_lens { LightFrom::Rays } else { LightFrom::Pixels };

    if !has_lens && let Some(text) = overrides.iter().find(|text| is_idle(&path_of(text))) {
        let set = yaml::parse_override(text)?;
        let fault = set.node.fault(format!("without a lens `{}` does nothing", set.path));
        return Err(fault
            .path(&set.path)
            .hint("name a lens, such as `--lens helios-44-58-f2`, or leave it out")
            .into());
    }

    let layer = overrides.iter().rev().find(|o| path_of(o) == "source.layer");
    let layer = layer.and_then(|text| text.split_once('=')).map(|(_, layer)| layer.trim());
    let header = header_of(&plate.file, layer, &files)?;
    let [width_mm, height_mm] = frame_mm(job.format.as_ref(), &header, &files)?;
    let [across, down] = pixels(job, &header, has_lens)?;
    // Makes the pixels square to the last digit, although their numbers are rounded to integers.
    let height_mm =
        if job.side_px.is_some() || has_lens { width_mm * f64::from(down) / f64::from(across) } else { height_mm };

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
        None if overrides.iter().any(|text| path_of(text) == "film.exposure") => {}
        // Metering on request applies to photographs too, which are otherwise exposed as taken.
        None if job.meter_each => made.push(("film.metering", "camera".to_owned())),
        None => made.push(("film.exposure", "metered".to_owned())),
    }
    if has_lens {
        made.push(("render.noise", "1 %".to_owned()));
    }
    // An `.exr` name asks for the picture on film. The light before the film is written only if `output` is set.
    let is_exr = Path::new(&plate.output).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    if is_exr && !overrides.iter().any(|text| path_of(text) == "output") {
        made.push(("output", "[{kind: exr, holds: picture}]".to_owned()));
    }
    if header.is_for_display && !overrides.iter().any(|text| path_of(text) == "source.tone") {
        made.push(("source.tone", "camera".to_owned()));
    }
    made.extend(plate.number.map(|number| ("render.frame", number.to_string())));

    let nobody = Arc::new(SourceFile::new(MADE, ""));
    let map = spectra_core::params::Value::Map(Vec::new());
    let mut root = Node::new(map, Default::default(), Arc::clone(&nobody));
    let mut faults = Faults::new();
    for (path, value) in made {
        faults.take(put(&mut root, path, &value, MADE));
    }
    let file = spectra_core::params::Value::String(plate.file.clone());
    faults.take(root.set_path("source.file", Node::new(file, Default::default(), nobody)));
    for setting in job.settings.iter().filter(|s| is_kept(&s.path)) {
        faults.take(put(&mut root, &setting.path, &setting.value, &setting.as_typed));
    }
    faults.into_result(())?;
    // The record holds the scene as a user would write it.
    root.file = Arc::new(SourceFile::new(MADE, document(&root)));
    let resources: Arc<dyn Resources> = Arc::new(files);
    let name = Path::new(&plate.output).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    Ok((series_of_tree(&format!("{name}.yaml"), root, &overrides, resources)?, light))
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

/// Returns the width and height, mm, of the largest frame of the picture's shape that a format holds, turned upright for an
/// upright picture.
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
fn pixels(job: &Develop<'_>, header: &Header, has_lens: bool) -> Result<[u32; 2], Faults> {
    let own = [header.width, header.height];
    if (header.pixel_aspect - 1.0).abs() > 0.01 && !has_lens && job.side_px.is_none() {
        let text =
            format!("its pixels are {:.2} times as wide as high, but film needs square ones", header.pixel_aspect);
        return Err(Fault::new(text).hint("set `--side` to fewer pixels than the picture has").into());
    }
    let upright = [f64::from(own[0]) * header.pixel_aspect.max(1.0), f64::from(own[1]) / header.pixel_aspect.min(1.0)];
    let longest = upright[0].max(upright[1]);
    let side = match job.side_px {
        Some(side) => f64::from(side),
        None if has_lens => longest.min(f64::from(TRACED_PX)),
        None => return Ok(own),
    };
    Ok(upright.map(|px| ((px * side / longest).round() as u32).max(1)))
}
