//! Writes pictures in any format that OpenImageIO writes, and textures.

use crate::bridge::ffi::{self, Plan};
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::library::TiledExr;
use std::io::{self, SeekFrom};
use std::path::Path;

/// Data types in which samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// 8-bit integers: 255 is 1.
    U8,
    /// 16-bit integers, or fewer bits if the attribute `oiio:BitsPerSample` says so. The largest value is 1.
    U16,
    /// 16-bit floating point.
    F16,
    /// 32-bit floating point.
    F32,
}

impl Samples {
    fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::U16 => "uint16",
            Self::F16 => "half",
            Self::F32 => "float",
        }
    }
}

/// A picture to write with [`write()`] or [`make_texture`].
#[derive(Clone, Debug)]
pub struct Written<'a> {
    /// Name of the format, for example `jpeg2000`.
    pub format: &'a str,
    /// File extension, for example `jp2`. It may select a variant of the format.
    pub ending: &'a str,
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Width over height of a pixel; `None` leaves it out of the file.
    pub pixel_aspect: Option<f32>,
    /// Data type of the samples.
    pub samples: Samples,
    /// Side of a square tile, pixels; `None` writes rows without tiles.
    pub tile_px: Option<u32>,
    /// Name and values of each channel, in the order of the file. Values go row by row from the top.
    pub channels: &'a [(&'a str, &'a [f32])],
    /// Names and values of text attributes.
    pub texts: &'a [(String, String)],
    /// Names and values of integer attributes.
    pub integers: &'a [(String, i32)],
}

impl Written<'_> {
    fn plan(&self) -> Result<Plan, String> {
        let pixels = u64::from(self.width_px) * u64::from(self.height_px);
        if pixels == 0 || self.channels.is_empty() {
            return Err("the picture has no pixels or no channels".to_owned());
        }
        for (name, values) in self.channels {
            if values.len() as u64 != pixels {
                return Err(format!("channel `{name}` has {} values for {pixels} pixels", values.len()));
            }
        }
        let side = |px: u32| i32::try_from(px).map_err(|_| format!("a side of {px} pixels is too long"));
        Ok(Plan {
            format: self.format.to_owned(),
            path: format!("picture.{}", self.ending),
            width: side(self.width_px)?,
            height: side(self.height_px)?,
            channels: self.channels.iter().map(|(name, _)| (*name).to_owned()).collect(),
            samples: self.samples.name().to_owned(),
            tile: side(self.tile_px.unwrap_or(0))?,
            pixel_aspect: self.pixel_aspect.unwrap_or(0.0),
            names: self.texts.iter().map(|(name, _)| name.clone()).collect(),
            texts: self.texts.iter().map(|(_, text)| text.clone()).collect(),
            integer_names: self.integers.iter().map(|(name, _)| name.clone()).collect(),
            integers: self.integers.iter().map(|(_, value)| *value).collect(),
        })
    }
}

/// Writes a picture to `to`, which must be empty. The format must support writing to an open file.
///
/// # Errors
/// The message of the system or of the library.
pub fn write(to: &mut dyn Out, picture: &Written<'_>) -> Result<(), WriteFault> {
    let plan = picture.plan().map_err(WriteFault::Format)?;
    let mut sink = Sink { file: to, size: 0, fault: None };
    let written = ffi::write(&plan, &Pixels::new(picture), &mut sink);
    match (sink.fault, written) {
        // An error of the system is the cause of the library's error.
        (Some(fault), _) => Err(WriteFault::Io(fault)),
        (None, written) => written.map_err(|e| WriteFault::Format(e.what().trim().to_owned())),
    }
}

/// Writes a texture to the file `path`, as the program `maketx` does: tiled, with all mipmap levels down to one pixel. The
/// extension of the path, `tx` or `exr`, selects the format.
///
/// # Errors
/// The message of the library, or a path that is not valid UTF-8.
pub fn make_texture(path: &Path, picture: &Written<'_>) -> Result<(), WriteFault> {
    let plan = picture.plan().map_err(WriteFault::Format)?;
    let path = path.to_str().ok_or_else(|| WriteFault::Format("the path is not valid UTF-8".to_owned()))?;
    let made = ffi::make_texture(&plan, &Pixels::new(picture), path);
    made.map_err(|e| WriteFault::Format(e.what().trim().to_owned()))
}

/// Implements `spectra_pictures::library::PictureLibrary::write_tiled_exr`.
pub(crate) fn tiled_exr(to: &mut dyn Out, picture: &TiledExr<'_>) -> Result<(), WriteFault> {
    let mut texts = picture.attributes.to_vec();
    let said = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    // The order of lines is fixed so that the file does not depend on threads. The empty `DateTime` keeps the library from writing the time
    // of day.
    texts.extend([said("compression", "zip"), said("openexr:lineOrder", "increasingY"), said("DateTime", "")]);
    write(
        to,
        &Written {
            format: "openexr",
            ending: "exr",
            width_px: picture.width_px,
            height_px: picture.height_px,
            pixel_aspect: Some(picture.pixel_aspect),
            samples: Samples::F32,
            tile_px: Some(picture.tile_px),
            channels: picture.channels,
            texts: &texts,
            integers: &[],
        },
    )
}

/// The pixels of a picture, handed out some rows at a time.
pub(crate) struct Pixels<'a> {
    width: usize,
    channels: &'a [(&'a str, &'a [f32])],
}

impl<'a> Pixels<'a> {
    fn new(picture: &Written<'a>) -> Self {
        Self { width: picture.width_px as usize, channels: picture.channels }
    }

    /// Fills whole rows from `first` on; the channels of a pixel follow each other. The bridge calls it.
    pub(crate) fn fill(&self, first: i32, to: &mut [f32]) {
        let start = first as usize * self.width;
        for (pixel, to) in to.chunks_exact_mut(self.channels.len()).enumerate() {
            for (to, (_, values)) in to.iter_mut().zip(self.channels) {
                *to = values[start + pixel];
            }
        }
    }
}

/// The file to which the library writes.
pub(crate) struct Sink<'a> {
    file: &'a mut dyn Out,
    /// Bytes written so far.
    size: i64,
    fault: Option<io::Error>,
}

impl Sink<'_> {
    /// Writes bytes at an offset and returns whether that succeeded. The bridge calls it.
    pub(crate) fn write_at(&mut self, bytes: &[u8], offset: i64) -> bool {
        let mut attempt = || -> io::Result<()> {
            let offset = u64::try_from(offset).map_err(|_| io::ErrorKind::InvalidInput)?;
            self.file.seek(SeekFrom::Start(offset))?;
            self.file.write_all(bytes)
        };
        match attempt() {
            Ok(()) => {
                self.size = self.size.max(offset.saturating_add_unsigned(bytes.len() as u64));
                true
            }
            Err(fault) => {
                self.fault.get_or_insert(fault);
                false
            }
        }
    }

    /// Bytes written so far. The bridge calls it.
    pub(crate) fn size(&self) -> i64 {
        self.size
    }
}
