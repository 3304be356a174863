//! Reads files with OpenImageIO and converts the pixels to a [`FilePicture`].

use crate::bridge::ffi::{self, Header, Wanted};
use crate::header_size;
use spectra_core::resources::{FoundFile, ResourceError};
use spectra_pictures::library::{FilePicture, PictureLimits};
use std::io::Write;
use std::path::Path;

/// Formats that are not still pictures of light: pictures generated from the file name, depth, movies, volumes.
const NO_PICTURES: [&str; 5] = ["null", "zfile", "ffmpeg", "openvdb", "term"];
/// Formats that can store a million identical pixels in a few bytes.
const DENSE: [&str; 3] = ["webp", "jpeg2000", "heif"];
/// Upper limit of pixels per byte for all other formats: deflate reaches about 1 032 to 1, at one bit per pixel or more.
const MAX_PIXELS_PER_BYTE: u64 = 1_100 * 8;

/// Returns the name of the format that has this file extension.
fn format_of(ending: &str) -> Result<String, String> {
    let all = ffi::endings().map_err(|e| e.to_string())?;
    let mut formats = all.split(';').filter_map(|entry| entry.split_once(':'));
    let found = formats.find(|(_, endings)| endings.split(',').any(|own| own.eq_ignore_ascii_case(ending)));
    let Some((format, _)) = found else {
        return Err(format!("OpenImageIO {} does not read `.{ending}` files", ffi::version()));
    };
    if NO_PICTURES.contains(&format) {
        return Err(format!("a `.{ending}` file is not a still picture"));
    }
    Ok(format.to_owned())
}

/// Returns the extensions of all files that can be read, in the library's order.
pub(crate) fn endings() -> Vec<String> {
    let all = ffi::endings().unwrap_or_default();
    let formats = all.split(';').filter_map(|entry| entry.split_once(':'));
    let pictures = formats.filter(|(format, _)| !NO_PICTURES.contains(format));
    pictures.flat_map(|(_, endings)| endings.split(',').map(str::to_owned)).collect()
}

/// Number of bytes at the start of a file that are searched for the stated size.
const BEGINNING_BYTES: u64 = 1 << 20;

/// Reads the first picture of a file; without `pixels`, only its header.
pub(crate) fn read(ending: &str, file: &FoundFile, limits: PictureLimits, pixels: bool) -> Result<FilePicture, String> {
    let format = format_of(ending)?;
    let text = |cause: cxx::Exception| tidy(cause.what());
    let system = |cause: ResourceError| cause.to_string();
    let mut receiver = Receiver::new(&format, limits, file.size_bytes().map_err(system)?, pixels);
    if let Some([width, height]) = header_size::size(&format, &file.read(BEGINNING_BYTES).map_err(system)?) {
        receiver.check([width, height])?;
    }
    // The library reads as little of a file on disk as it can.
    let from = |path: &str, receiver: &mut Receiver| {
        let known = |cause: cxx::Exception| tidy(&cause.what().replace(path, "the file"));
        ffi::read(&format, path, false, &[], receiver).map_err(known)
    };
    if let Some(path) = file.path().and_then(Path::to_str) {
        from(path, &mut receiver)?;
        return receiver.picture();
    }
    let bytes = file.read(u64::MAX).map_err(system)?;
    if ffi::reads_memory(&format).map_err(text)? {
        ffi::read(&format, &format!("picture.{ending}"), true, &bytes, &mut receiver).map_err(text)?;
    } else {
        // These readers accept only a path.
        let system = |cause: std::io::Error| format!("a temporary copy cannot be written: {cause}");
        let mut copy = tempfile::Builder::new().suffix(&format!(".{ending}")).tempfile().map_err(system)?;
        copy.write_all(&bytes).map_err(system)?;
        copy.flush().map_err(system)?;
        let Some(path) = copy.path().to_str() else {
            return Err("the path of the folder for temporary files is not valid UTF-8".to_owned());
        };
        from(path, &mut receiver)?;
    }
    receiver.picture()
}

/// Joins a message of the library into one line of at most 400 characters, without a final full stop.
fn tidy(said: &str) -> String {
    let mut words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some((end, _)) = words.char_indices().nth(400) {
        words.truncate(end);
    }
    words.trim_end_matches('.').to_owned()
}

/// The parts of the header that are needed while the pixels arrive, and the pixels.
struct Begun {
    header: Header,
    /// Positions of red, green and blue among the channels read.
    rgb: [usize; 3],
    alpha: Option<usize>,
    /// Number of channels read.
    step: usize,
    colors: Vec<[f32; 3]>,
    cover: Vec<f32>,
}

/// Receives a file from the bridge: checks the header, allocates the pixels and accepts them row by row.
pub(crate) struct Receiver {
    format: String,
    limits: PictureLimits,
    /// Size of the file, bytes; `None` for formats in which it does not limit the number of pixels.
    file_bytes: Option<u64>,
    /// Whether pixels are read, or only the header.
    pixels: bool,
    begun: Option<Begun>,
}

impl Receiver {
    fn new(format: &str, limits: PictureLimits, bytes: u64, pixels: bool) -> Self {
        let file_bytes = (!DENSE.contains(&format)).then_some(bytes);
        Self { format: format.to_owned(), limits, file_bytes, pixels, begun: None }
    }

    fn check(&self, [width, height]: [u64; 2]) -> Result<(), String> {
        let PictureLimits { side_px, pixels } = self.limits;
        if width == 0 || height == 0 {
            return Err("the picture has no pixels".to_owned());
        }
        if width.max(height) > u64::from(side_px) || width * height > pixels {
            return Err(format!(
                "the picture is too large: {width} x {height} pixels; at most {pixels} in total and {side_px} per side"
            ));
        }
        match self.file_bytes {
            Some(bytes) if width * height > bytes.saturating_mul(MAX_PIXELS_PER_BYTE) => Err(format!(
                "the header states {width} x {height} pixels, but a file of {bytes} bytes cannot hold them"
            )),
            _ => Ok(()),
        }
    }

    /// Checks the header and returns the channels to read. The bridge calls it once the file is open.
    pub(crate) fn begin(&mut self, header: &Header) -> Result<Wanted, String> {
        for window in [header.display, header.data] {
            self.check([2, 3].map(|i| u64::try_from(window[i]).unwrap_or(0)))?;
        }
        if header.deep || header.slices != 1 {
            return Err("the file holds a volume or several samples per pixel, not a flat picture".to_owned());
        }
        if self.format == "dpx" && header.orientation > 4 {
            // OpenImageIO 2.4 takes the length of a column for the length of a row.
            return Err("DPX files stored column by column cannot be read".to_owned());
        }
        let place = |name: &str| header.channels.iter().position(|own| own.eq_ignore_ascii_case(name));
        let alpha = usize::try_from(header.alpha).ok().filter(|at| *at < header.channels.len());
        let rgb = match (place("R"), place("G"), place("B")) {
            (Some(r), Some(g), Some(b)) => [r, g, b],
            _ => {
                let colors: Vec<usize> = (0..header.channels.len()).filter(|at| Some(*at) != alpha).collect();
                let [gray] = colors[..] else {
                    let names: Vec<String> = header.channels.iter().take(12).map(|c| format!("`{c}`")).collect();
                    return Err(format!(
                        "the file has neither channels R, G and B nor a single channel, but {}",
                        names.join(", ")
                    ));
                };
                [gray; 3]
            }
        };
        let all = rgb.into_iter().chain(alpha);
        let (first, last) = all.fold((usize::MAX, 0), |(first, last), at| (first.min(at), last.max(at)));
        let step = last + 1 - first;
        // Channels between the wanted ones are read with them.
        if step > 16 {
            return Err("the color channels lie too far apart: they span more than 16 channels".to_owned());
        }
        // Parts of the display window that the file does not store have no light.
        let shown = if self.pixels { header.display[2] as usize * header.display[3] as usize } else { 0 };
        self.begun = Some(Begun {
            header: header.clone(),
            rgb: rgb.map(|at| at - first),
            alpha: alpha.map(|at| at - first),
            step,
            colors: vec![[0.0; 3]; shown],
            cover: if alpha.is_some() { vec![0.0; shown] } else { Vec::new() },
        });
        Ok(Wanted { first: first as i32, end: if self.pixels { last as i32 + 1 } else { first as i32 } })
    }

    /// Accepts whole rows of the stored pixels, from row `first` on; the channels of a pixel follow each other. The bridge calls it.
    pub(crate) fn rows(&mut self, first: i64, values: &[f32]) {
        let Some(Begun { header, rgb, alpha, step, colors, cover }) = &mut self.begun else { return };
        let [x, y, width, height] = header.display;
        let [own_x, own_y, own_width, _] = header.data;
        let inside = |own: i64, own_start: i64, start: i64, size: i64| {
            let at = own.checked_add(own_start)?.checked_sub(start)?;
            (0..size).contains(&at).then_some(at)
        };
        for (row, values) in (first..).zip(values.chunks_exact(own_width as usize * *step)) {
            let Some(row) = inside(row, own_y, y, height) else { continue };
            for (column, pixel) in (0..).zip(values.chunks_exact(*step)) {
                let Some(column) = inside(column, own_x, x, width) else { continue };
                let at = (row * width + column) as usize;
                colors[at] = rgb.map(|channel| pixel[channel]);
                if let Some(channel) = *alpha {
                    cover[at] = pixel[channel];
                }
            }
        }
    }

    fn picture(self) -> Result<FilePicture, String> {
        let Some(Begun { header, alpha, colors, cover, .. }) = self.begun else {
            return Err("the library returned no picture".to_owned());
        };
        let [_, _, width, height] = header.display;
        let pixel_aspect = f64::from(header.pixel_aspect);
        Ok(FilePicture {
            width_px: width as u32,
            height_px: height as u32,
            pixel_aspect: if (0.05..=20.0).contains(&pixel_aspect) { pixel_aspect } else { 1.0 },
            rgb: colors,
            alpha: alpha.map(|_| cover),
            multiplied: !header.straight,
            integers: header.integers,
            color_space: (!header.color_space.is_empty()).then_some(header.color_space),
            orientation: u8::try_from(header.orientation).ok().filter(|o| (1..=8).contains(o)).unwrap_or(1),
            format: self.format,
        })
    }
}
