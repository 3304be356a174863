//! A film developed from a picture file, or from many, without a scene file: the scene is made here.
//!
//! The picture fills the frame: of the format's frame the largest part that has the picture's shape. White has a luminance of
//! 5000 cd/m2, as in daylight under clouds, which is short enough an exposure for any film. A photograph, a file of integers, is exposed as it
//! was taken, once its camera's tone curve is taken back; light in floating point is metered as cameras do.

use crate::made::{MADE, of_nobody};
use crate::run::{fits, picture};
use crate::still::WHITE_CD_M2;
use crate::taken::{Taken, Unfinished};
use crate::{Ended, Event, Host, Job, LightFrom, Names, Place, Session, SessionError, words};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile, Warning};
use spectra_core::registry::{self, Context};
use spectra_core::resources::{ResourceError, Resources};
use spectra_core::spectral::BAND;
use spectra_core::stage::Imager;
use spectra_pictures::read::{Choice, Header, header};
use spectra_scene::{FileResources, FilmTime, NO_LENS, Output, Series, document, series_of_tree, yaml};
use std::path::Path;
use std::sync::Arc;

/// A value of the scene that somebody states.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Where it stands in a scene, such as `film.stock`.
    pub path: String,
    /// The value as it would be written there.
    pub value: String,
    /// What the person wrote, for messages: `--stock tri-x`.
    pub said: String,
}

/// A picture to develop, and what becomes of it.
#[derive(Clone, Debug)]
pub struct Plate {
    /// Its file.
    pub file: String,
    /// The file that is written, in the folder of the host.
    pub output: String,
    /// Its number, if it has one, as one of several or by its name: each has grain of its own by it.
    pub number: Option<u64>,
}

/// What is to be developed, and how.
pub struct Develop<'a> {
    /// The pictures, in their order.
    pub plates: Vec<Plate>,
    /// What the scene says. Where it names a lens (`lens.file`), rays are traced through it; otherwise the film gets the
    /// picture's own pixels.
    pub settings: Vec<Setting>,
    /// What is set on top of all that: texts `path=value`.
    pub overrides: Vec<String>,
    /// The format that the frame is cut from; 135 if none is said.
    pub format: Option<Setting>,
    /// Pixels along the longer side of the frame; those of the picture if none, or at most [`TRACED_PX`] through a lens.
    pub side_px: Option<u32>,
    /// Whether they are a series: of it only whole pictures are written, and one that fails does not stop the others.
    pub is_series: bool,
    /// What is worth knowing of a series before any of it is developed.
    pub notes: Vec<String>,
    /// Whether each picture is metered; otherwise the first one is, for all.
    pub meter_each: bool,
    /// Whether pictures whose files are there are left as they are.
    pub skip_existing: bool,
    /// Instruction set.
    pub isa: Isa,
    /// For the record: the version of the program.
    pub version: &'a str,
    /// For the record: the versions that a result depends on.
    pub versions: Value,
    /// The unit that a bare number at a path of a scene is read in.
    pub unit_of: &'a (dyn Fn(&str) -> Option<String> + Sync),
}

/// A photograph on a film, to be held as a [`Session`] and not only written: the scene is the one that [`develop`] makes of it.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// The picture; its output names the scene.
    pub plate: Plate,
    /// What the scene says, as in [`Develop`].
    pub settings: Vec<Setting>,
    /// The format that the frame is cut from; 135 if none is said.
    pub format: Option<Setting>,
}

impl Photograph {
    /// The scene of it, with texts `path=value` on top. Without a lens ([`Series::is_without_lens`]) its film is exposed by
    /// [`Session::expose`].
    ///
    /// # Errors
    /// Everything that is wrong with the picture's file or with what is set.
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
            unit_of: &|_| None,
        };
        Ok(scene(&job, &self.plate, None).map_err(of_nobody)?.0)
    }
}

/// The number that a name without its ending closes with; before a version, as in `plate.0007.v2`, where there is one.
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

/// The digits that a text closes with.
fn closing_number(stem: &str) -> Option<u64> {
    let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    stem[stem.len() - digits..].parse().ok()
}

/// Whether a file is a picture by its ending.
#[must_use]
pub fn is_picture(file: &Path) -> bool {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| PICTURES.contains(&&*ending))
}

/// Endings of pictures that can be developed.
pub const PICTURES: [&str; 10] = ["exr", "png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "hdr", "dpx"];

/// Pixels along the longer side of a frame that rays are traced for, where nobody says how many.
pub const TRACED_PX: u32 = 1920;

/// A file of one picture, bytes; the limit of `source: picture`.
const MAX_BYTES: u64 = 1 << 30;
/// Keys of the film that find the exposure; where it is known they are left out.
const METERING: [&str; 3] = ["film.metering", "film.spot", "film.compensation"];

/// Keys of a lens that do nothing where there is none; its filters stand before the film all the same.
const IDLE: [&str; 3] = ["lens.f-number", "lens.focus", "lens.aperture"];

/// Whether a path is of [`IDLE`].
fn is_idle(path: &str) -> bool {
    IDLE.iter().any(|key| path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.')))
}

/// How the file of a picture ends, such as `png`, where `output` is set among `overrides` (texts `path=value`).
///
/// # Errors
/// No picture is among the outputs, or more than one file.
pub fn picture_ending(overrides: &[String]) -> Result<Option<String>, Fault> {
    // What cannot be read is told of where the scene is read.
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
            let text = format!("`film develop` writes pictures, and {ending} is none");
            Err(node.fault(text).hint("`--set output=[png]`, or tiff or exr"))
        }
        [first, ..] => {
            let text = format!("one file is written of a picture, and these are {}", endings.join(", "));
            let hint =
                format!("leave one, or say at `-o` which: `-o out/picture{first}`, of a sequence `-o out/####{first}`");
            Err(node.fault(text).hint(hint))
        }
    }
}

/// Develops all pictures.
///
/// # Errors
/// [`SessionError`]; of several pictures, those that could be are developed all the same.
pub fn develop(job: &Develop<'_>, host: &dyn Host) -> Result<Ended, SessionError> {
    match &job.plates[..] {
        [plate] if !job.is_series && !job.skip_existing => {
            one(job, plate, None, Unfinished::IsKept, host).map(|(ended, _)| ended)
        }
        // Where a file that is there is skipped, it has to be whole.
        [plate] if !job.is_series => {
            host.hear(Event::Picture(Some(place(plate, 0, 1))));
            if is_there(plate, 0, 1, host) {
                return Ok(Ended::Whole);
            }
            one(job, plate, None, Unfinished::IsLeftOut, host).map(|(ended, _)| ended)
        }
        plates => all(job, plates, host),
    }
}

/// Which of how many pictures it is.
fn place(plate: &Plate, index: usize, of: usize) -> Place {
    let number = plate.number.unwrap_or(index as u64 + 1);
    Place { number: u32::try_from(number).unwrap_or(u32::MAX), index, of }
}

/// Whether a picture's file is there; says so.
fn is_there(plate: &Plate, index: usize, of: usize, host: &dyn Host) -> bool {
    let is_there = host.folder().has(&plate.output);
    if is_there {
        let shown = host.folder().shown(&plate.output);
        host.hear(Event::Series(
            &format!("{} of {of}: {} is there", index + 1, words::files(std::slice::from_ref(&shown))),
            &json!({ "event": "kept", "files": [shown] }),
        ));
    }
    is_there
}

/// Develops pictures one by one.
fn all(job: &Develop<'_>, plates: &[Plate], host: &dyn Host) -> Result<Ended, SessionError> {
    let begun_s = host.now_s();
    host.hear(Event::Series(
        &format!(
            "{}, {}",
            words::counted(plates.len() as u64, "picture"),
            if job.meter_each { "each metered" } else { "exposed as the first is" }
        ),
        &json!({ "event": "series", "pictures": plates.len(), "metered": if job.meter_each { "each" } else { "first" } }),
    ));
    for note in &job.notes {
        host.hear(Event::Note(note));
    }
    let (mut metered, mut done, mut failed) = (None, 0, Vec::new());
    // An exposure that is stated is not metered.
    let mut meters = !job.meter_each;
    let mut ended = Ended::Whole;
    for (index, plate) in plates.iter().enumerate() {
        if host.is_stopped() {
            ended = Ended::Stopped;
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
                ended = Ended::Stopped;
                break;
            }
            if metered.is_none() {
                let text = format!(
                    "`{}` sets the exposure in place of the first picture, and those after it are exposed as it is",
                    plate.file
                );
                host.hear(Event::Warning(&Warning::from(text)));
            }
        }
        let exposure = metered.as_ref().filter(|_| !job.meter_each);
        match one(job, plate, exposure, Unfinished::IsLeftOut, host) {
            Ok((Ended::Stopped, _)) => {
                ended = Ended::Stopped;
                break;
            }
            Ok((Ended::Whole, times)) => {
                done += 1;
                metered = metered.or_else(|| times.into_iter().find(|time| time.is_metered));
                meters &= metered.is_some();
            }
            // What is wrong with the settings is wrong with every picture.
            Err(SessionError::Faults(faults)) if faults.iter().any(|fault| fault.place.is_some()) => {
                return Err(faults.into());
            }
            Err(error @ SessionError::Request(_)) => return Err(error),
            Err(error) => {
                host.hear(Event::Warning(&Warning::from(format!("`{}` is not developed: {error}", plate.file))));
                failed.push((plate.file.clone(), error.to_string()));
            }
        }
    }
    host.hear(Event::Picture(None));
    let stopped = ended == Ended::Stopped && host.is_interrupted();
    host.hear(Event::Series(
        &format!(
            "{done} of {} in {}",
            words::counted(plates.len() as u64, "picture"),
            words::duration(host.now_s() - begun_s)
        ),
        &json!({ "event": "end", "done": done, "of": plates.len(), "interrupted": stopped }),
    ));
    match &failed[..] {
        [] => Ok(ended),
        [(file, why)] => Err(SessionError::Failed(format!("`{file}` is not developed: {why}"))),
        // The cause of the first, since it may be that of all, and warnings may be silent.
        [(file, why), ..] => {
            Err(SessionError::Failed(format!("{} pictures are not developed: `{file}`: {why} ...", failed.len())))
        }
    }
}

/// What the camera metered of a picture that is there already; `None` where it cannot be read, or tracing stops. Through a lens it is
/// traced as it was then: less light would meter it otherwise in the last digits.
fn meter(job: &Develop<'_>, plate: &Plate, host: &dyn Host) -> Option<FilmTime> {
    let (series, light) = scene(job, plate, None).ok()?;
    let mut session = Session::of_series(series, 0, job.isa).ok()?;
    let rendering = match light {
        LightFrom::Pixels => session.expose().ok()?,
        LightFrom::Rays if !session.scene().films.iter().any(|film| film.film.is_metered()) => return None,
        LightFrom::Rays => {
            fits(&session, host).ok()?;
            host.hear(Event::Note(&format!("`{}` is traced once more, to expose the others as it was", plate.file)));
            let control = host.control();
            session.prepare(host.workers()).ok()?;
            Taken::of(&mut session, host, &control, Unfinished::IsLeftOut).ok()?.rendering
        }
    };
    let exposure = (!rendering.partial).then_some(rendering.exposure)?;
    session.scene().film_times(&exposure).into_iter().find(|time| time.is_metered)
}

/// Develops a picture, exposed as another one was metered if that is said.
fn one(
    job: &Develop<'_>,
    plate: &Plate,
    metered: Option<&FilmTime>,
    unfinished: Unfinished,
    host: &dyn Host,
) -> Result<(Ended, Vec<FilmTime>), SessionError> {
    let (series, light) = scene(job, plate, metered).map_err(of_nobody)?;
    let of_picture = Names::of_picture(Path::new(&plate.output));
    let none = || SessionError::Request(format!("{}: no picture is written with that ending", plate.output));
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
        unit_of: job.unit_of,
    };
    picture(&job, unfinished, host).map_err(|error| match error {
        SessionError::Faults(faults) => SessionError::Faults(of_nobody(faults)),
        other => other,
    })
}

/// The scene of a picture, and where its light comes from.
fn scene(job: &Develop<'_>, plate: &Plate, metered: Option<&FilmTime>) -> Result<(Series, LightFrom), Faults> {
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
    // The pixels are square to the last digit, however whole their numbers are.
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
        // Who states a time wants that one; who meters beside it is told that one of them has no effect.
        None if overrides.iter().any(|text| path_of(text) == "film.exposure") => {}
        // Metered on request, photographs too, which are exposed as taken otherwise.
        None if job.meter_each => made.push(("film.metering", "camera".to_owned())),
        None => made.push(("film.exposure", "metered".to_owned())),
    }
    if has_lens {
        made.push(("render.noise", "1 %".to_owned()));
    }
    // The name asks for the picture on film; the light before it is an output that somebody sets.
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
        faults.take(put(&mut root, &setting.path, &setting.value, &setting.said));
    }
    faults.into_result(())?;
    // For the record: the scene as somebody would write it.
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

/// Shape and kind of a picture file.
fn header_of(file: &str, layer: Option<&str>, files: &dyn Resources) -> Result<Header, Faults> {
    let found = files.find(file, &["scenes"], &[], MAX_BYTES).map_err(|error| {
        let hint = match &error {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            _ => "OpenEXR, PNG, JPEG, TIFF, WebP, BMP and Radiance HDR files are read".to_owned(),
        };
        Fault::new(format!("picture `{file}`: {error}")).hint(hint)
    })?;
    let choice = Choice { name: file, layer, ..Choice::default() };
    header(&found, choice)
        .map_err(|trouble| Fault::new(format!("picture `{file}`: {}", trouble.text)).hint(trouble.advice()).into())
}

/// The largest frame of the picture's shape that a format holds, on its side where the picture stands upright: width and height, mm.
fn frame_mm(format: Option<&Setting>, header: &Header, files: &dyn Resources) -> Result<[f64; 2], Faults> {
    let mut node = yaml::parse(SourceFile::new(MADE, "{kind: film, format: 135, resolution: 1}"))?;
    if let Some(setting) = format {
        put(&mut node, "format", &setting.value, &setting.said)?;
    }
    let params = Params::stage(node, "imager")?;
    let size = registry::build::<dyn Imager>(&params, &Context::new(files, BAND))?.size();
    let [long, short] = [size.width_mm.max(size.height_mm), size.width_mm.min(size.height_mm)];
    let aspect = header.aspect();
    let [width, height] = if aspect >= 1.0 { [long, short] } else { [short, long] };
    Ok(if aspect > width / height { [width, width / aspect] } else { [height * aspect, height] })
}

/// Pixels across and down of the frame.
fn pixels(job: &Develop<'_>, header: &Header, has_lens: bool) -> Result<[u32; 2], Faults> {
    let own = [header.width, header.height];
    if (header.pixel_aspect - 1.0).abs() > 0.01 && !has_lens && job.side_px.is_none() {
        let text =
            format!("its pixels are {:.2} times as wide as high, and film needs square ones", header.pixel_aspect);
        return Err(Fault::new(text).hint("`--side` with fewer pixels than the picture has").into());
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
