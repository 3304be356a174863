//! Reads OpenEXR: scene-linear light with its primaries, alpha and depth, from one of several layers.
//!
//! The format has two kinds of layers: parts of the file with a name, and channels named `layer.R` (OpenEXR, "Technical Introduction",
//! 2013).
//! The picture is the display window. Pixels of a file outside it are overscan, which is read on request; pixels that the file does not
//! store are black.
//! Without a `chromaticities` attribute or the name of a linear space, the primaries are those of Rec. 709, as the format's documentation
//! says. sRGB shares them.

use super::block_check;
use super::linear_picture::{FileProblem, LinearPicture, OPAQUE, ReadOptions, check_size, finite, mend, over_black};
use super::picture_channels::{ChannelData, PictureChannels, are_of_xyz};
use super::space;
use exr::block::UncompressedBlock;
use exr::block::lines::LineRef;
use exr::block::reader::ChunksReader;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};
use spectra_color::matrix::{Matrix, product};
use spectra_color::{Adaptation, RgbSpace, Transfer, xyz_of_xy};
use std::io::{BufRead, Seek};

/// First bytes of an OpenEXR file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Largest number of bytes that all layers of a file may take in memory.
const MAX_BYTES: u64 = 4 << 30;
/// Upper limit of the compression ratio: no compression of the format exceeds deflate, which reaches about 1 032 to 1.
const MAX_RATIO: u64 = 1_100;

/// A group of channels that belong to one layer.
struct Group {
    /// Name by which `layer` chooses the group; empty for the plain channels of a file without names.
    name: String,
    part: usize,
    /// Name of each channel within the layer, and its index in the part.
    channels: Vec<(String, usize)>,
}

impl Group {
    fn channel(&self, name: &str) -> Option<(usize, usize)> {
        self.channels.iter().find(|(own, _)| own.eq_ignore_ascii_case(name)).map(|(_, at)| (self.part, *at))
    }

    /// Red, green and blue, or gray; `None` if the group has no light.
    fn light(&self) -> Option<Vec<(usize, usize)>> {
        let rgb: Vec<_> = ["R", "G", "B"].iter().filter_map(|c| self.channel(c)).collect();
        if rgb.len() == 3 {
            return Some(rgb);
        }
        let is_luma_chroma = self.channel("RY").is_some() || self.channel("BY").is_some();
        self.channel("Y").filter(|_| !is_luma_chroma).map(|gray| vec![gray])
    }
}

/// Channels chosen from a file, each by its part and its index there.
struct Chosen {
    /// Red, green and blue, or gray; empty if no light is wanted.
    light: Vec<(usize, usize)>,
    alpha: Option<(usize, usize)>,
    depth: Option<(usize, usize)>,
}

/// Chooses channels from a file of `bytes` bytes. Without `lit`, chooses only the depth.
fn chosen(headers: &[Header], bytes: u64, choice: ReadOptions<'_>, lit: bool) -> Result<Chosen, FileProblem> {
    check(headers, bytes)?;
    let groups = groups(headers);
    let (chosen, light) = if lit {
        let chosen = choose(&groups, choice.layer)?;
        let Some(light) = chosen.light() else { return Err(no_light(chosen, &groups)) };
        (chosen, light)
    } else {
        (groups.first().ok_or_else(|| FileProblem::file("the picture has no channels"))?, Vec::new())
    };
    let depth = choice.depth.map(|name| depth_channel(&groups, chosen, name)).transpose()?;
    let is_whole = |(part, at): &(usize, usize)| {
        let sampling = headers[*part].channels.list[*at].sampling;
        (sampling.0, sampling.1) == (1, 1)
    };
    // Alpha is read even if it is not wanted, to warn about what is lost.
    let alpha = chosen.channel("A").filter(|at| lit && (choice.alpha || is_whole(at)));
    for &(part, at) in light.iter().chain(&alpha).chain(&depth) {
        let channel = &headers[part].channels.list[at];
        if channel.sampling.0 != 1 || channel.sampling.1 != 1 {
            let text = format!("channel `{}` has fewer samples than the picture has pixels", channel.name);
            return Err(FileProblem::file(text).hint("write it without subsampling"));
        }
    }
    if let Some((part, _)) = depth.filter(|(part, _)| lit && *part != chosen.part) {
        let window = |part: usize| headers[part].data_window();
        let (a, b) = (window(chosen.part), window(part));
        if a != b {
            let size = |w: exr::meta::attribute::IntegerBounds| format!("{} x {}", w.size.0, w.size.1);
            let text = format!(
                "the depth has {} pixels and the picture {}, or their windows lie at different positions",
                size(b),
                size(a)
            );
            return Err(FileProblem::at("depth", text).hint("both must cover the same window"));
        }
    }
    Ok(Chosen { light, alpha, depth })
}

/// Size in pixels, and width over height of a pixel.
fn shape(headers: &[Header]) -> ([u32; 2], f64) {
    let shared = &headers[0].shared_attributes;
    let size = shared.display_window.size;
    let aspect = f64::from(shared.pixel_aspect);
    ([size.0 as u32, size.1 as u32], if (0.05..=20.0).contains(&aspect) { aspect } else { 1.0 })
}

/// Returns the overscan of the chosen part: the number of pixels on each side beyond the display window, horizontally and vertically. Warns
/// if opposite sides differ, because the excess is not used.
fn overscan(headers: &[Header], part: usize) -> ([u32; 2], Option<FileProblem>) {
    let display = headers[0].shared_attributes.display_window;
    let data = headers[part].data_window();
    let sides = [
        (display.position.0, display.size.0, data.position.0, data.size.0),
        (display.position.1, display.size.1, data.position.1, data.size.1),
    ]
    .map(|(at, size, from, count)| {
        let [at, from] = [i64::from(at), i64::from(from)];
        [at - from, from + count as i64 - at - size as i64].map(|n| n.clamp(0, i64::from(u32::MAX)) as u32)
    });
    let even = sides.map(|[a, b]| a.min(b));
    let [[left, right], [top, bottom]] = sides;
    let uneven = (left != right || top != bottom).then(|| {
        let text = format!(
            "its data window reaches {left} pixels beyond the display window on the left, {right} on the right, {top} above, {bottom} \
             below: {} are used on the left and the right, {} above and below",
            even[0], even[1]
        );
        FileProblem::file(text).hint("render equal overscan on opposite sides to use all of it")
    });
    (even, uneven)
}

fn said(e: exr::error::Error) -> FileProblem {
    FileProblem::file(e.to_string())
}

/// Reads the header of a file of `bytes` bytes.
pub(super) fn header(
    reader: impl BufRead + Seek,
    bytes: u64,
    choice: ReadOptions<'_>,
) -> Result<super::header::Header, FileProblem> {
    let headers = exr::block::read(reader, false).map_err(said)?.headers().to_vec();
    let light = chosen(&headers, bytes, choice, true)?.light;
    let (_, doubt) = space::of(headers[0].shared_attributes.chromaticities, &texts(&headers));
    let ([width, height], pixel_aspect) = shape(&headers);
    let (overscan, uneven) = overscan(&headers, light.first().map_or(0, |(part, _)| *part));
    let [x, y] = overscan.map(u64::from);
    let fits = check_size(u64::from(width) + 2 * x, u64::from(height) + 2 * y).is_ok();
    let left = (!fits).then(|| {
        let text = format!(
            "with its overscan of {x} x {y} pixels on each side the picture exceeds the limit: the overscan is not used"
        );
        FileProblem::file(text).hint("crop the data window")
    });
    let overscan = if fits { overscan } else { [0; 2] };
    let doubts = doubt.filter(|_| light.len() == 3).into_iter().chain(uneven).chain(left).collect();
    Ok(super::header::Header {
        width,
        height,
        overscan,
        pixel_aspect,
        clips: false,
        is_for_display: false,
        is_jpeg: false,
        warnings: doubts,
    })
}

/// Returns how many pixels the chosen depth of a file of `bytes` bytes reaches beyond the display window on each side.
pub(super) fn depth_overscan(
    reader: impl BufRead + Seek,
    bytes: u64,
    choice: ReadOptions<'_>,
) -> Result<[u32; 2], FileProblem> {
    let headers = exr::block::read(reader, false).map_err(said)?.headers().to_vec();
    let part = chosen(&headers, bytes, choice, false)?.depth.map_or(0, |(part, _)| part);
    Ok(overscan(&headers, part).0)
}

/// Decodes the chosen channels of a file; without `lit`, only the depth. Blocks are unpacked one by one to where they belong, so channels
/// that are not chosen take no memory.
pub(super) fn decode(
    mut reader: impl BufRead + Seek + Send,
    bytes: u64,
    choice: ReadOptions<'_>,
    lit: bool,
) -> Result<LinearPicture, FileProblem> {
    block_check::check(&mut reader)?;
    let reader = exr::block::read(reader, false).map_err(said)?;
    let headers = reader.headers().to_vec();
    let Chosen { light, alpha: alpha_at, depth: depth_at } = chosen(&headers, bytes, choice, lit)?;
    let (size, pixel_aspect) = shape(&headers);
    let sides = [0, 1].map(|i| u64::from(size[i]) + 2 * u64::from(choice.overscan[i]));
    check_size(sides[0], sides[1])?;
    let [width, height] = sides.map(|side| side as u32);
    let pixels = width as usize * height as usize;
    // Pixels that the file does not store have no light and infinite depth.
    let mut rgb = vec![[0.0_f32; 3]; if lit { pixels } else { 0 }];
    let mut alpha = alpha_at.filter(|_| choice.alpha).map(|_| vec![0.0_f32; pixels]);
    let mut opaque = 0_usize;
    let mut depth = depth_at.map(|_| vec![f32::INFINITY; pixels]);
    let wanted: Vec<(usize, usize)> = light.iter().chain(&alpha_at).chain(&depth_at).copied().collect();
    let chunks = reader.filter_chunks(false, |_, _, block| {
        block.level == Vec2(0, 0) && wanted.iter().any(|(part, _)| *part == block.layer)
    });
    let window = headers[0].shared_attributes.display_window.position;
    let take = |_: &MetaData, block: UncompressedBlock| {
        let part = block.index.layer;
        let header = &headers[part];
        let position = header.own_attributes.layer_position;
        let [across, down] = choice.overscan.map(i64::from);
        let offset =
            [i64::from(position.0) - i64::from(window.0) + across, i64::from(position.1) - i64::from(window.1) + down];
        for line in block.lines(&header.channels) {
            let at = (part, line.location.channel);
            if !wanted.contains(&at) {
                continue;
            }
            let samples = samples(&line, header.channels.list[at.1].sample_type)?;
            let row = line.location.position.1 as i64 + offset[1];
            let from = line.location.position.0 as i64 + offset[0];
            if !(0..i64::from(height)).contains(&row) {
                continue;
            }
            for (i, value) in samples.into_iter().enumerate() {
                let column = from + i as i64;
                if !(0..i64::from(width)).contains(&column) {
                    continue;
                }
                let pixel = row as usize * width as usize + column as usize;
                for (channel, _) in light.iter().enumerate().filter(|(_, own)| **own == at) {
                    if light.len() == 1 { rgb[pixel] = [value; 3] } else { rgb[pixel][channel] = value }
                }
                opaque += usize::from(alpha_at == Some(at) && value >= OPAQUE);
                if let Some(alpha) = alpha.as_mut().filter(|_| alpha_at == Some(at)) {
                    alpha[pixel] = if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
                }
                if let Some(depth) = depth.as_mut().filter(|_| depth_at == Some(at)) {
                    depth[pixel] = value;
                }
            }
        }
        Ok(())
    };
    chunks.and_then(|chunks| chunks.decompress_parallel(false, take)).map_err(said)?;
    let (chromaticities, _) = space::of(headers[0].shared_attributes.chromaticities, &texts(&headers));
    let thin = if alpha_at.is_some() && !choice.alpha { pixels.saturating_sub(opaque) } else { 0 };
    let doubts = mend(&mut rgb).into_iter().chain(over_black(thin, pixels)).collect();
    let neutral = headers[0].own_attributes.adopted_neutral.map(|v| [f64::from(v.0), f64::from(v.1)]);
    let to_srgb = chromaticities.filter(|_| light.len() == 3).map(|c| matrix(c, neutral)).transpose()?.flatten();
    for pixel in &mut rgb {
        let converted = to_srgb
            .map_or(*pixel, |m| m.map(|row| row.iter().zip(*pixel).map(|(a, b)| a * f64::from(b)).sum::<f64>() as f32));
        *pixel = converted.map(finite);
    }
    Ok(LinearPicture { width, height, pixel_aspect, rgb, alpha, depth, clipped_at: None, warnings: doubts })
}

/// Reads every channel of a file of `bytes` bytes unchanged, and the texts of its header. Pixels that the file does not store are 0.
pub(super) fn planes(mut reader: impl BufRead + Seek + Send, bytes: u64) -> Result<PictureChannels, FileProblem> {
    block_check::check(&mut reader)?;
    let reader = exr::block::read(reader, false).map_err(said)?;
    let headers = reader.headers().to_vec();
    check(&headers, bytes)?;
    let ([width, height], pixel_aspect) = shape(&headers);
    let pixels = width as usize * height as usize;
    let attributes = texts(&headers);
    let unit = |name: &str| {
        let key = format!("unit {name}");
        attributes.iter().find(|(own, _)| *own == key).map(|(_, text)| text.clone()).unwrap_or_default()
    };
    // `first` holds the index of the first channel of each part.
    let (mut channels, mut first) = (Vec::new(), Vec::new());
    let count: usize = headers.iter().map(|header| header.channels.list.len()).sum();
    if (count as u64).saturating_mul(pixels as u64).saturating_mul(size_of::<f32>() as u64) > MAX_BYTES {
        return Err(FileProblem::file(format!(
            "{count} channels of {width} x {height} pixels are too large: at most {MAX_BYTES} bytes can be read"
        )));
    }
    for header in &headers {
        first.push(channels.len());
        let part = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for channel in &header.channels.list {
            let own = channel.name.to_string();
            if channel.sampling.0 != 1 || channel.sampling.1 != 1 {
                let text = format!("channel `{own}` has fewer samples than the picture has pixels");
                return Err(FileProblem::file(text).hint("write it without subsampling"));
            }
            let repeats = part.is_empty() || own.starts_with(&format!("{part}."));
            let name = if repeats { own } else { format!("{part}.{own}") };
            channels.push(ChannelData { unit: unit(&name), name, values: vec![0.0; pixels] });
        }
    }
    let window = headers[0].shared_attributes.display_window.position;
    let take = |_: &MetaData, block: UncompressedBlock| {
        let part = block.index.layer;
        let header = &headers[part];
        let position = header.own_attributes.layer_position;
        let offset = [i64::from(position.0) - i64::from(window.0), i64::from(position.1) - i64::from(window.1)];
        for line in block.lines(&header.channels) {
            let row = line.location.position.1 as i64 + offset[1];
            let from = line.location.position.0 as i64 + offset[0];
            if !(0..i64::from(height)).contains(&row) {
                continue;
            }
            let at = line.location.channel;
            let values = &mut channels[first[part] + at].values;
            for (i, value) in samples(&line, header.channels.list[at].sample_type)?.into_iter().enumerate() {
                let column = from + i as i64;
                if (0..i64::from(width)).contains(&column) {
                    values[row as usize * width as usize + column as usize] = value;
                }
            }
        }
        Ok(())
    };
    let chunks = reader.filter_chunks(false, |_, _, block| block.level == Vec2(0, 0));
    chunks.and_then(|chunks| chunks.decompress_parallel(false, take)).map_err(said)?;
    let place = |v: Vec2<f32>| [f64::from(v.0), f64::from(v.1)];
    let (stated, doubt) = space::of(headers[0].shared_attributes.chromaticities, &attributes);
    let has = |name: &str| channels.iter().any(|c| c.name == name);
    let doubts = doubt.filter(|_| ["R", "G", "B"].into_iter().all(has)).into_iter().collect();
    // Chromaticities that span no colors are refused here too.
    stated.map(|c| matrix(c, None)).transpose()?;
    let chromaticities = stated.map(|c| [c.red, c.green, c.blue, c.white].map(place));
    Ok(PictureChannels {
        format: "OpenEXR",
        width,
        height,
        pixel_aspect,
        channels,
        chromaticities,
        attributes,
        clipped_at: None,
        warnings: doubts,
    })
}

/// Returns the texts of the headers, sorted by name. Of several parts, the first with a name counts.
fn texts(headers: &[Header]) -> Vec<(String, String)> {
    let mut all = std::collections::BTreeMap::new();
    for header in headers {
        let other = header.shared_attributes.other.iter().chain(&header.own_attributes.other);
        for (name, value) in other {
            if let AttributeValue::Text(text) = value {
                let text = String::from_utf8_lossy(text.as_slice()).into_owned();
                all.entry(name.to_string()).or_insert(text);
            }
        }
    }
    all.into_iter().collect()
}

/// Returns the samples of a line in single precision.
fn samples(line: &LineRef<'_>, kind: SampleType) -> exr::error::Result<Vec<f32>> {
    match kind {
        SampleType::F16 => line.read_samples::<f16>().map(|v| v.map(f16::to_f32)).collect(),
        SampleType::F32 => line.read_samples::<f32>().collect(),
        SampleType::U32 => line.read_samples::<u32>().map(|v| v.map(|v| v as f32)).collect(),
    }
}

/// Checks the sizes before anything is allocated.
fn check(headers: &[Header], file_bytes: u64) -> Result<(), FileProblem> {
    let mut total = 0_u64;
    for header in headers {
        if header.deep {
            return Err(
                FileProblem::file("deep data (several samples per pixel) are not supported").hint("flatten it first")
            );
        }
        for size in [header.layer_size, header.shared_attributes.display_window.size] {
            check_size(size.0 as u64, size.1 as u64)?;
        }
        let samples: u64 = header.channels.list.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
        total = total.saturating_add(samples.saturating_mul(header.layer_size.area() as u64));
    }
    if headers.is_empty() {
        return Err(FileProblem::file("the picture has no layers"));
    }
    if total > MAX_BYTES {
        return Err(FileProblem::file(format!(
            "all layers together take {total} bytes; at most {MAX_BYTES} can be read"
        )));
    }
    if total > file_bytes.saturating_mul(MAX_RATIO) {
        return Err(FileProblem::file(format!(
            "the header states {total} bytes of pixels, but a file of {file_bytes} bytes cannot hold them"
        )));
    }
    Ok(())
}

fn groups(headers: &[Header]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (part, header) in headers.iter().enumerate() {
        let part_name = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for (at, channel) in header.channels.list.iter().enumerate() {
            let full = channel.name.to_string();
            let (prefix, short) = full.rsplit_once('.').unwrap_or(("", &full));
            // A channel may repeat the name of its part.
            let name = match (part_name.as_str(), prefix) {
                (part, "") => part.to_owned(),
                ("", prefix) => prefix.to_owned(),
                (part, prefix) if prefix == part || prefix.starts_with(&format!("{part}.")) => prefix.to_owned(),
                (part, prefix) => format!("{part}.{prefix}"),
            };
            match groups.iter_mut().find(|g| g.part == part && g.name == name) {
                Some(group) => group.channels.push((short.to_owned(), at)),
                None => groups.push(Group { name, part, channels: vec![(short.to_owned(), at)] }),
            }
        }
    }
    groups
}

/// Names of the layers that hold light, for a message.
fn names(groups: &[Group]) -> String {
    let names: Vec<_> = groups.iter().filter(|g| g.light().is_some() && !g.name.is_empty()).collect();
    let shown: Vec<_> = names.iter().take(12).map(|g| format!("`{}`", g.name)).collect();
    shown.join(", ")
}

fn choose<'a>(groups: &'a [Group], layer: Option<&str>) -> Result<&'a Group, FileProblem> {
    if let Some(layer) = layer {
        return groups.iter().find(|g| g.name == layer).ok_or_else(|| {
            let known = names(groups);
            let trouble = FileProblem::at("layer", format!("the file has no layer `{layer}`"));
            trouble.hint(if known.is_empty() { "it has no named layers".to_owned() } else { format!("it has {known}") })
        });
    }
    // Order of preference: plain channels, then a single layer with light.
    let with_light: Vec<&Group> = groups.iter().filter(|g| g.light().is_some()).collect();
    match (with_light.iter().find(|g| g.name.is_empty()), with_light.as_slice()) {
        (Some(plain), _) => Ok(plain),
        (None, [only]) => Ok(only),
        (None, []) => groups.first().ok_or_else(|| FileProblem::file("the picture has no channels")),
        (None, _) => {
            let trouble = FileProblem::at("layer", "the file has several layers, none of them plain R, G, B");
            Err(trouble.hint(format!("choose one: {}", names(groups))))
        }
    }
}

fn no_light(group: &Group, groups: &[Group]) -> FileProblem {
    let own: Vec<_> = group.channels.iter().take(12).map(|(name, _)| format!("`{name}`")).collect();
    let of = if group.name.is_empty() { String::new() } else { format!(" in layer `{}`", group.name) };
    let trouble = FileProblem::file(format!("the file has no channels R, G, B or Y{of}; it has {}", own.join(", ")));
    match names(groups) {
        known if known.is_empty() => trouble.hint("write it with R, G and B"),
        known => trouble.hint(format!("choose a layer with light: {known}")),
    }
}

/// Finds the depth channel: one of this name in the chosen layer, or of this full name anywhere, or the only one of this name in the file.
fn depth_channel(groups: &[Group], chosen: &Group, name: &str) -> Result<(usize, usize), FileProblem> {
    let full = |g: &Group, own: &str| if g.name.is_empty() { own.to_owned() } else { format!("{}.{own}", g.name) };
    let anywhere = || {
        groups.iter().find_map(|g| {
            g.channels.iter().find(|(own, _)| full(g, own).eq_ignore_ascii_case(name)).map(|(_, at)| (g.part, *at))
        })
    };
    let alone = || {
        let all: Vec<_> = groups.iter().filter_map(|g| g.channel(name)).collect();
        if let [one] = all.as_slice() { Some(*one) } else { None }
    };
    chosen.channel(name).or_else(anywhere).or_else(alone).ok_or_else(|| {
        let all = groups.iter().flat_map(|g| g.channels.iter().map(move |(own, _)| format!("`{}`", full(g, own))));
        let all: Vec<_> = all.take(24).collect();
        let trouble = FileProblem::at("depth", format!("the file has no depth channel `{name}`"));
        trouble.hint(format!("its channels are {}; name one with `depth: {{channel: ...}}`", all.join(", ")))
    })
}

/// Returns the matrix from the file's primaries to those of sRGB, white to white (Bradford); `None` if they are the same. The
/// chromaticities of CIE XYZ do not define the picture's white: `neutral` does, or D65 if the file states none.
fn matrix(c: Chromaticities, neutral: Option<[f64; 2]>) -> Result<Option<Matrix>, FileProblem> {
    let xy = [c.red, c.green, c.blue, c.white].map(|v| [f64::from(v.0), f64::from(v.1)]);
    let [r, g, b, white] = xy;
    if are_of_xyz(&xy) {
        let srgb = RgbSpace::srgb();
        let sound = neutral.filter(|xy| xy.iter().all(|v| (0.1..0.7).contains(v)));
        let white = sound.map_or(srgb.white_xyz(), |xy| xyz_of_xy(xy, 1.0));
        return Ok(Some(product(&srgb.rgb_from_xyz, &Adaptation::Bradford.matrix(white, srgb.white_xyz()))));
    }
    let area = (g[0] - r[0]) * (b[1] - r[1]) - (g[1] - r[1]) * (b[0] - r[0]);
    // ACES AP0 has a blue primary of negative y (SMPTE ST 2065-1); no space has a y of 0.
    let sound = xy.iter().all(|[x, y]| x.abs() < 2.0 && y.abs() < 2.0 && y.abs() > 1e-4) && area.abs() > 1e-4;
    let white_is_sound = (0.1..0.7).contains(&white[0]) && (0.1..0.7).contains(&white[1]);
    if !(sound && white_is_sound) {
        return Err(FileProblem::file("its `chromaticities` do not span a range of colors")
            .hint("remove the attribute if Rec. 709 is right"));
    }
    let srgb = RgbSpace::srgb();
    let primaries = [r, g, b];
    let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4;
    if primaries.iter().zip(&srgb.primaries_xy).all(|(a, b)| near(a, b)) && near(&white, &srgb.white_xy) {
        return Ok(None);
    }
    let own = RgbSpace::new("chromaticities", primaries, white, Transfer::Linear);
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|unit| srgb.from_xyz(Adaptation::Bradford.adapt(own.to_xyz(unit), own.white_xyz(), srgb.white_xyz())));
    Ok(Some([0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]))))
}
