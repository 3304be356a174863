//! Writes the linear exposure as OpenEXR.

use exr::meta::attribute::{AttributeValue, Chromaticities};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, LineOrder, Text, Vec2, WritableImage,
};
use spectra_core::frame::ExposureFrame;
use spectra_core::sink::Out;
use spectra_files::{WriteError, WriteFault, write_atomically};
use std::io::{BufReader, Read, SeekFrom};
use std::path::Path;

/// Writes the frame to an OpenEXR file at `path` as [`exr()`] does, without gains.
///
/// # Errors
/// [`WriteError`]: the errors of [`exr()`].
pub fn write_exr(path: &Path, frame: &ExposureFrame, attributes: &[(String, String)]) -> Result<(), WriteError> {
    write_atomically(path, |file| exr(file, frame, &[], 1.0, attributes))
}

/// Writes the frame as OpenEXR: 32-bit floats, scan lines in increasing order, lossless (zip), with a channel for each channel of the
/// frame, under the same name.
///
/// Each channel is multiplied by its gain; `gains` is in the order of the channels, and missing gains are 1.
/// The header holds `attributes` (name, text) and the unit of each channel (`unit NAME`). An attribute `framesPerSecond` with a value like
/// `24/1` is written as OpenEXR's rational number.
/// The header's pixel aspect is that of the film times `squeeze`, as pictures of an anamorphic lens are viewed. The same frame and
/// attributes give the same bytes.
///
/// # Errors
/// [`WriteFault`]: the system refuses, the frame has no channel, a channel has too few or too many values, or the name of an attribute is
/// empty, longer than 255 bytes, given twice, or reserved by OpenEXR.
pub fn exr(
    out: &mut dyn Out,
    frame: &ExposureFrame,
    gains: &[f64],
    squeeze: f64,
    attributes: &[(String, String)],
) -> Result<(), WriteFault> {
    let colors = Colors { chromaticities: None, pixel_aspect: f64::from(pixel_aspect(frame)) * squeeze };
    write(out, frame, attributes, &colors, &|at, values| FlatSamples::F32(times(values, gain(gains, at))))
}

/// Writes the frame as [`exr()`] does, but with 16-bit floats, which take half the space. They hold about three digits, up to
/// 65 504 (larger values become infinite).
///
/// # Errors
/// The errors of [`exr()`].
pub fn half_exr(
    out: &mut dyn Out,
    frame: &ExposureFrame,
    gains: &[f64],
    squeeze: f64,
    attributes: &[(String, String)],
) -> Result<(), WriteFault> {
    let colors = Colors { chromaticities: None, pixel_aspect: f64::from(pixel_aspect(frame)) * squeeze };
    let half = |value: f32| exr::prelude::f16::from_f32(value);
    write(out, frame, attributes, &colors, &|at, values| {
        FlatSamples::F16(times(values, gain(gains, at)).into_iter().map(half).collect())
    })
}

fn gain(gains: &[f64], channel: usize) -> f64 {
    gains.get(channel).copied().unwrap_or(1.0)
}

/// Multiplies values by a gain; with a gain of 1 they keep every bit.
pub(super) fn times(values: &[f32], gain: f64) -> Vec<f32> {
    if gain == 1.0 { values.to_vec() } else { values.iter().map(|v| (f64::from(*v) * gain) as f32).collect() }
}

/// A function that converts a channel, given its index and values, to the samples of a file.
pub(super) type Samples<'a> = &'a dyn Fn(usize, &[f32]) -> FlatSamples;

/// Color information for the header of a picture.
pub(super) struct Colors {
    /// Chromaticities of red, green, blue and white, and of the neutral color; `None` for values that are not colors.
    pub chromaticities: Option<([[f64; 2]; 4], [f64; 2])>,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
}

pub(super) fn write(
    mut out: &mut dyn Out,
    frame: &ExposureFrame,
    attributes: &[(String, String)],
    colors: &Colors,
    samples: Samples<'_>,
) -> Result<(), WriteFault> {
    let image = image_of(frame, attributes, colors, samples)?;
    image.write().to_unbuffered(&mut out).map_err(fault)?;
    sort_header(out)
}

fn fault(error: exr::error::Error) -> WriteFault {
    match error {
        exr::error::Error::Io(cause) => WriteFault::Io(cause),
        other => WriteFault::Format(other.to_string()),
    }
}

/// Attributes with the unit of each channel, followed by `attributes`.
pub(super) fn all_attributes(
    frame: &ExposureFrame,
    attributes: &[(String, String)],
) -> impl Iterator<Item = (String, String)> {
    let stated = frame.channels.iter().filter(|c| !c.unit.is_empty());
    let units = stated.map(|c| (format!("unit {}", c.name), c.unit.clone()));
    units.chain(attributes.iter().cloned())
}

/// Width over height of a pixel.
pub(super) fn pixel_aspect(frame: &ExposureFrame) -> f32 {
    let pixel_width = frame.size.width_mm / f64::from(frame.size.width_px);
    let pixel_height = frame.size.height_mm / f64::from(frame.size.height_px);
    (pixel_width / pixel_height) as f32
}

fn image_of(
    frame: &ExposureFrame,
    attributes: &[(String, String)],
    colors: &Colors,
    samples: Samples<'_>,
) -> Result<Image<Layer<AnyChannels<FlatSamples>>>, WriteFault> {
    let size = Vec2(frame.size.width_px as usize, frame.size.height_px as usize);
    if frame.channels.is_empty() {
        return Err(WriteFault::Format("the frame has no channel".into()));
    }
    let mut layer = LayerAttributes::default();
    for (name, value) in all_attributes(frame, attributes) {
        if name == "framesPerSecond"
            && let Some(rate) = rational(&value)
        {
            layer.frames_per_second = Some(rate);
            continue;
        }
        // The bytes are written unchanged: OpenEXR leaves the encoding open, and its tools expect UTF-8.
        let value = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
        if layer.other.insert(Text::from_slice_unchecked(name.as_bytes()), value).is_some() {
            return Err(WriteFault::Format(format!("the attribute `{name}` is given twice")));
        }
    }
    let channels = frame.channels.iter().enumerate().map(|(at, channel)| {
        let name = Text::from_slice_unchecked(channel.name.as_bytes());
        if channel.values.len() != frame.size.pixels() {
            let (found, wanted) = (channel.values.len(), frame.size.pixels());
            return Err(WriteFault::Format(format!(
                "channel `{}` has {found} values for {wanted} pixels",
                channel.name
            )));
        }
        Ok(AnyChannel::new(name, samples(at, &channel.values)))
    });
    let channels = AnyChannels::sort(channels.collect::<Result<_, _>>()?);
    // The lossless presets of the library leave the order of the chunks to the threads.
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut shared = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    shared.pixel_aspect = colors.pixel_aspect as f32;
    let place = |xy: [f64; 2]| Vec2(xy[0] as f32, xy[1] as f32);
    if let Some((all, neutral)) = colors.chromaticities {
        let [red, green, blue, white] = all.map(place);
        shared.chromaticities = Some(Chromaticities { red, green, blue, white });
        layer.adopted_neutral = Some(place(neutral));
    }
    Ok(Image { attributes: shared, layer_data: Layer::new(size, layer, encoding, channels) })
}

/// Parses a rational number like `24000/1001`.
fn rational(text: &str) -> Option<(i32, u32)> {
    let (above, below) = text.split_once('/')?;
    Some((above.parse().ok()?, below.parse().ok()?))
}

/// Sorts the header attributes by name, in place. The library writes custom attributes in the order of a hash table, which differs from run
/// to run. Sizes, and thus all offsets, do not change.
fn sort_header(file: &mut dyn Out) -> Result<(), WriteFault> {
    const START: u64 = 8; // magic number and version
    file.seek(SeekFrom::Start(START))?;
    let mut from = BufReader::new(&mut *file);
    let mut attributes: Vec<(Vec<u8>, Vec<u8>)> = Vec::new();
    loop {
        let mut bytes = Vec::new();
        let name = null_terminated(&mut from, &mut bytes)?;
        if name.is_empty() {
            break;
        }
        null_terminated(&mut from, &mut bytes)?;
        let mut size = [0; 4];
        from.read_exact(&mut size)?;
        bytes.extend_from_slice(&size);
        let size = u64::from(u32::from_le_bytes(size));
        if from.by_ref().take(size).read_to_end(&mut bytes)? as u64 != size {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into());
        }
        attributes.push((name, bytes));
    }
    attributes.sort();
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|(_, bytes)| bytes).collect();
    file.seek(SeekFrom::Start(START))?;
    file.write_all(&sorted)?;
    Ok(())
}

/// Reads to the next zero byte. Appends what was read, with the zero, to `all`, and returns it without the zero.
fn null_terminated(from: &mut impl Read, all: &mut Vec<u8>) -> Result<Vec<u8>, WriteFault> {
    let mut text = Vec::new();
    loop {
        let mut byte = [0];
        from.read_exact(&mut byte)?;
        all.push(byte[0]);
        if byte[0] == 0 {
            return Ok(text);
        }
        text.push(byte[0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers};
    use spectra_core::frame::{ExposureChannel, FrameSize};

    fn frame() -> ExposureFrame {
        let size = FrameSize { width_px: 70, height_px: 50, width_mm: 36.0, height_mm: 24.0 };
        let channel = |name: &str, scale: f32| ExposureChannel {
            name: name.into(),
            unit: "lx s".into(),
            values: (0..size.pixels()).map(|i| ((i * 7919) % 1013) as f32 / 1013.0 * scale).collect(),
        };
        ExposureFrame { size, channels: vec![channel("X", 0.5), channel("Z", 3e-7), channel("Y", 1e5)] }
    }

    fn attributes() -> Vec<(String, String)> {
        (0..12).map(|i| (format!("spectra:key {i}"), format!("value {i}, \u{3bb} = 550 nm"))).collect()
    }

    #[test]
    fn what_is_written_is_read_back_to_the_bit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frame.exr");
        let frame = frame();
        write_exr(&path, &frame, &attributes()).expect("written");
        let read = exr::prelude::read();
        let image = read
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .expect("readable");
        let layer = &image.layer_data;
        assert_eq!(layer.encoding.line_order, LineOrder::Increasing);
        assert_eq!(layer.encoding.blocks, Blocks::ScanLines);
        let names: Vec<String> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["X", "Y", "Z"]);
        for channel in &layer.channel_data.list {
            let wanted = frame.channel(&channel.name.to_string()).expect("of that name");
            let FlatSamples::F32(values) = &channel.sample_data else { panic!("32-bit floats") };
            assert!(values.iter().zip(&wanted.values).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        for (name, value) in attributes() {
            let Some(AttributeValue::Text(text)) = layer.attributes.other.get(&Text::from(name.as_str())) else {
                panic!("{name} is missing")
            };
            assert_eq!(text.as_slice(), value.as_bytes());
        }
        assert_eq!(layer.attributes.other.len(), 12 + 3);
        assert_eq!(image.attributes.pixel_aspect, (36.0 / 70.0 / (24.0 / 50.0)) as f32);
    }

    #[test]
    fn the_rate_of_a_sequence_is_the_standard_attribute() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frame.exr");
        let rate = |value: &str| {
            write_exr(&path, &frame(), &[("framesPerSecond".into(), value.into())]).expect("written");
            let meta = exr::meta::MetaData::read_from_file(&path, true).expect("readable");
            meta.headers[0].own_attributes.frames_per_second
        };
        assert_eq!(rate("24000/1001"), Some((24000, 1001)));
    }

    /// Every channel has its own gain; half floats keep three digits.
    #[test]
    fn gains_multiply_the_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frame.exr");
        let (frame, gains) = (frame(), [0.125, 3.0, 1.0]);
        let read = || {
            let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
            read.first_valid_layer().all_attributes().from_file(&path).expect("readable").layer_data.channel_data.list
        };
        let wanted = |name: &str, i: usize| {
            let at = frame.channels.iter().position(|c| c.name == name).expect("of that name");
            (f64::from(frame.channels[at].values[i]) * gains[at]) as f32
        };
        write_atomically(&path, |file| exr(file, &frame, &gains, 1.0, &[])).expect("written");
        for channel in read() {
            let FlatSamples::F32(values) = &channel.sample_data else { panic!("32-bit floats") };
            assert!(values.iter().enumerate().all(|(i, v)| *v == wanted(&channel.name.to_string(), i)));
        }
        write_atomically(&path, |file| half_exr(file, &frame, &gains, 1.0, &[])).expect("written");
        for channel in read().into_iter().filter(|c| c.name.to_string() == "X") {
            let FlatSamples::F16(values) = &channel.sample_data else { panic!("16-bit floats") };
            assert!(
                values.iter().enumerate().all(|(i, v)| (v.to_f32() - wanted("X", i)).abs() <= 0.0005 * wanted("X", i))
            );
        }
    }

    #[test]
    fn the_same_frame_gives_the_same_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let files: Vec<Vec<u8>> = (0..8)
            .map(|i| {
                let path = folder.path().join(format!("{i}.exr"));
                write_exr(&path, &frame(), &attributes()).expect("written");
                std::fs::read(&path).expect("there")
            })
            .collect();
        assert!(files.windows(2).all(|w| w[0] == w[1]));
    }

    #[test]
    fn faulty_attributes_and_frames_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frame.exr");
        let pair = |a: &str| (a.to_owned(), String::new());
        for attributes in
            [vec![pair("")], vec![pair("a"), pair("a")], vec![pair(&"x".repeat(256))], vec![pair("owner")]]
        {
            assert!(
                matches!(write_exr(&path, &frame(), &attributes), Err(WriteError::Format { .. })),
                "{attributes:?}"
            );
        }
        let mut short = frame();
        short.channels[1].values.pop();
        assert!(matches!(write_exr(&path, &short, &[]), Err(WriteError::Format { .. })));
        short.channels.clear();
        assert!(matches!(write_exr(&path, &short, &[]), Err(WriteError::Format { .. })));
        assert!(!path.exists());
    }
}
