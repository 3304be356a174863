//! Tests that read OpenEXR files written by the `exr` crate.

use super::decode::decode_bytes as decode;
use super::linear_picture::{FileProblem, LinearPicture, ReadOptions};
use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
    Text, Vec2, WritableImage, f16,
};
use std::io::Cursor;

type Plane<'a> = (&'a str, FlatSamples);

fn halves(values: &[f32]) -> FlatSamples {
    FlatSamples::F16(values.iter().map(|v| f16::from_f32(*v)).collect())
}

fn floats(values: &[f32]) -> FlatSamples {
    FlatSamples::F32(values.to_vec())
}

fn layer(name: Option<&str>, size: (usize, usize), planes: Vec<Plane<'_>>) -> Layer<AnyChannels<FlatSamples>> {
    let channels = planes.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let attributes = LayerAttributes { layer_name: name.map(Text::from), ..LayerAttributes::default() };
    Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels))
}

fn file(attributes: ImageAttributes, layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let image = Image { attributes, layer_data: exr::image::Layers::<AnyChannels<FlatSamples>>::from(layers) };
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn window(width: usize, height: usize) -> ImageAttributes {
    ImageAttributes::with_size((width, height))
}

fn rgb(size: (usize, usize), of: impl Fn(usize) -> [f32; 3], make: fn(&[f32]) -> FlatSamples) -> Vec<Plane<'static>> {
    let plane = |c: usize| make(&(0..size.0 * size.1).map(|i| of(i)[c]).collect::<Vec<_>>());
    vec![("R", plane(0)), ("G", plane(1)), ("B", plane(2))]
}

fn trouble(result: Result<LinearPicture, FileProblem>) -> FileProblem {
    result.expect_err("the file has a fault")
}

#[test]
fn both_floating_point_kinds_keep_highlights_and_rows_start_at_the_top() {
    let of = |i: usize| [i as f32, 0.25, if i == 5 { 1000.0 } else { 0.0 }];
    for make in [halves as fn(&[f32]) -> FlatSamples, floats] {
        let bytes = file(window(3, 2), vec![layer(None, (3, 2), rgb((3, 2), of, make))]);
        let read = decode(&bytes, ReadOptions::default()).unwrap();
        assert_eq!((read.width, read.height, read.clipped_at), (3, 2, None));
        assert_eq!(read.rgb, (0..6).map(of).collect::<Vec<_>>());
        assert!(read.alpha.is_none() && read.depth.is_none());
    }
}

/// An infinite value becomes as bright as the brightest finite value of the picture, and at least white. A pixel with NaN in any channel
/// becomes black.
#[test]
fn infinite_values_are_bright_and_counted() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let of = |i: usize| [[0.5, 0.25, 0.125], [inf; 3], [nan, 0.2, 0.3], [inf, 0.2, 0.0], [-0.5, 12.0, 0.1]][i];
    let bytes = file(window(5, 1), vec![layer(None, (5, 1), rgb((5, 1), of, floats))]);
    let read = decode(&bytes, ReadOptions::default()).unwrap();
    assert_eq!(read.rgb, [[0.5, 0.25, 0.125], [12.0; 3], [0.0; 3], [12.0, 0.2, 0.0], [-0.5, 12.0, 0.1]]);
    let [doubt] = &read.warnings[..] else { panic!("{:?}", read.warnings) };
    assert!(doubt.text.contains("2 pixels with infinite values, which count as 12"), "{}", doubt.text);
    assert!(doubt.text.contains("1 pixel with values that are not numbers"), "{}", doubt.text);
    let dim = file(window(2, 1), vec![layer(None, (2, 1), rgb((2, 1), |i| [[0.2; 3], [inf; 3]][i], halves))]);
    assert_eq!(
        decode(&dim, ReadOptions::default()).unwrap().rgb,
        [[0.2; 3], [1.0; 3]].map(|p| p.map(|v| f16::from_f32(v).to_f32()))
    );
    let sound = file(window(1, 1), vec![layer(None, (1, 1), rgb((1, 1), |_| [0.2; 3], floats))]);
    assert!(decode(&sound, ReadOptions::default()).unwrap().warnings.is_empty());
}

#[test]
fn chromaticities_are_honored() {
    let acescg = Chromaticities {
        red: Vec2(0.713, 0.293),
        green: Vec2(0.165, 0.830),
        blue: Vec2(0.128, 0.044),
        white: Vec2(0.32168, 0.33767),
    };
    let colors = [[1.0, 1.0, 1.0], [0.5, 0.4, 0.3], [0.02, 0.03, 0.2], [1.0, 0.0, 0.0]];
    let attributes = ImageAttributes { chromaticities: Some(acescg), ..window(4, 1) };
    let bytes = file(attributes, vec![layer(None, (4, 1), rgb((4, 1), |i| colors[i], floats))]);
    let read = decode(&bytes, ReadOptions::default()).unwrap();
    // ACEScg to linear sRGB by Bradford, as colour-science 0.4 prints it (colour.matrix_RGB_to_RGB).
    let matrix = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
    for (got, color) in read.rgb.iter().zip(colors) {
        for (value, row) in got.iter().zip(matrix) {
            let want: f64 = row.iter().zip(color).map(|(a, b)| a * f64::from(b)).sum();
            assert!((f64::from(*value) - want).abs() < 5e-5, "{got:?} {color:?}");
        }
    }
}

/// Reads a file with the chromaticities of CIE XYZ, as this program writes them. D65 is white, and so is another white if the file says
/// that it is neutral.
#[test]
fn xyz_is_read_by_its_chromaticities() {
    let xyz = Chromaticities {
        red: Vec2(1.0, 0.0),
        green: Vec2(0.0, 1.0),
        blue: Vec2(0.0, 0.0),
        white: Vec2(1.0 / 3.0, 1.0 / 3.0),
    };
    // D65 (0.3127, 0.3290), half of it, and the red of sRGB (IEC 61966-2-1).
    let colors = [[0.950_456, 1.0, 1.089_058], [0.475_228, 0.5, 0.544_529], [0.412_391, 0.212_639, 0.019_331]];
    let attributes = || ImageAttributes { chromaticities: Some(xyz), ..window(3, 1) };
    let bytes = file(attributes(), vec![layer(None, (3, 1), rgb((3, 1), |i| colors[i], floats))]);
    let read = decode(&bytes, ReadOptions::default()).unwrap();
    for (got, want) in read.rgb.iter().zip([[1.0; 3], [0.5; 3], [1.0, 0.0, 0.0]]) {
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-4), "{got:?} {want:?}");
    }
    let mut warm = layer(None, (1, 1), rgb((1, 1), |_| [1.0, 1.0, 1.0], floats));
    warm.attributes.adopted_neutral = Some(Vec2(1.0 / 3.0, 1.0 / 3.0));
    let bytes = file(ImageAttributes { chromaticities: Some(xyz), ..window(1, 1) }, vec![warm]);
    let white = decode(&bytes, ReadOptions::default()).unwrap().rgb[0];
    assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-4), "{white:?}");
    let planes = super::exr::planes(Cursor::new(&bytes[..]), bytes.len() as u64).unwrap();
    assert!(planes.holds_xyz());
}

#[test]
fn layers_are_chosen_by_part_and_by_prefix() {
    let gray = |v: f32| rgb((2, 1), move |_| [v; 3], halves);
    let prefixed: Vec<Plane<'_>> = ["key.R", "key.G", "key.B"].map(|name| (name, halves(&[0.5, 0.5]))).into();
    let bytes = file(
        window(2, 1),
        vec![layer(Some("beauty"), (2, 1), gray(1.0)), layer(Some("fill"), (2, 1), gray(2.0)), {
            let mut planes = gray(3.0);
            planes.extend(prefixed);
            layer(Some("lights"), (2, 1), planes)
        }],
    );
    let read = |layer: Option<&str>| decode(&bytes, ReadOptions { layer, ..ReadOptions::default() });
    for (name, want) in [("beauty", 1.0), ("fill", 2.0), ("lights", 3.0), ("lights.key", 0.5)] {
        assert_eq!(read(Some(name)).unwrap().rgb[1], [want; 3], "{name}");
    }
    let unsaid = trouble(read(None));
    assert_eq!(unsaid.key, "layer");
    assert!(unsaid.hint.unwrap().contains("`lights.key`"));
    let unknown = trouble(read(Some("rim")));
    assert!(unknown.text.contains("`rim`") && unknown.hint.unwrap().contains("`fill`"));
}

#[test]
fn alpha_and_depth_come_along() {
    let mut planes = rgb((2, 1), |_| [0.25; 3], floats);
    planes.extend([("A", halves(&[0.5, 1.0])), ("Z", floats(&[1.5, 1e10]))]);
    let bytes = file(window(2, 1), vec![layer(None, (2, 1), planes)]);
    let read = decode(&bytes, ReadOptions { depth: Some("Z"), alpha: true, ..ReadOptions::default() }).unwrap();
    assert_eq!(read.alpha.unwrap(), [0.5, 1.0]);
    assert_eq!(read.depth.unwrap(), [1.5, 1e10]);
    let lost = decode(&bytes, ReadOptions::default()).unwrap();
    assert!(lost.alpha.is_none() && lost.warnings[0].text.contains("1 of its 2 pixels"), "{:?}", lost.warnings);
    let missing = trouble(decode(&bytes, ReadOptions { depth: Some("depth.Z"), ..ReadOptions::default() }));
    assert_eq!(missing.key, "depth");
    assert!(missing.hint.unwrap().contains("`Z`"));
}

#[test]
fn depth_of_another_size_is_refused() {
    let bytes = file(
        window(2, 2),
        vec![
            layer(Some("color"), (2, 2), rgb((2, 2), |_| [1.0; 3], halves)),
            layer(Some("depth"), (2, 1), vec![("Z", floats(&[1.0, 2.0]))]),
        ],
    );
    let fault =
        trouble(decode(&bytes, ReadOptions { layer: Some("color"), depth: Some("depth.Z"), ..ReadOptions::default() }));
    assert_eq!(fault.key, "depth");
    assert!(fault.text.contains("2 x 1") && fault.text.contains("2 x 2"), "{}", fault.text);
}

#[test]
fn a_file_without_light_says_what_it_has() {
    let bytes = file(window(1, 1), vec![layer(None, (1, 1), vec![("N.X", floats(&[1.0])), ("Z", floats(&[1.0]))])]);
    let fault = trouble(decode(&bytes, ReadOptions::default()));
    assert!(fault.text.contains("R, G, B"), "{}", fault.text);
}

#[test]
fn the_display_window_is_the_picture() {
    // Two pixels of data; the display window shows the right one and one pixel to the right of the data.
    let attributes = ImageAttributes::new(IntegerBounds::new((1, 0), (2, 1)));
    let bytes = file(attributes, vec![layer(None, (2, 1), rgb((2, 1), |i| [1.0 + i as f32; 3], floats))]);
    let read = decode(&bytes, ReadOptions::default()).unwrap();
    assert_eq!(read.rgb, [[2.0; 3], [0.0; 3]]);
}

#[test]
fn broken_and_hostile_files_are_refused_before_anything_is_allocated() {
    let good = file(window(8, 8), vec![layer(None, (8, 8), rgb((8, 8), |i| [i as f32; 3], halves))]);
    for cut in [4, 5, 20, 100, good.len() / 2, good.len() - 1] {
        assert!(decode(&good[..cut], ReadOptions::default()).is_err(), "cut at {cut}");
    }
    // Headers that claim other windows.
    for name in ["dataWindow", "displayWindow"] {
        let at = good.windows(name.len()).position(|w| w == name.as_bytes()).unwrap()
            + name.len()
            + 1
            + "box2i".len()
            + 1
            + 4;
        for side in [60_000_i32, i32::MAX - 1] {
            let mut bad = good.clone();
            bad[at + 8..at + 12].copy_from_slice(&side.to_le_bytes());
            bad[at + 12..at + 16].copy_from_slice(&side.to_le_bytes());
            assert!(decode(&bad, ReadOptions::default()).is_err(), "{name} {side}");
        }
    }
}

/// Refuses blocks that claim to unpack to gigabytes, in any of the counters at the start of a block.
#[test]
fn blocks_that_promise_too_much_are_refused() {
    let of = |i: usize| [(i as f32 * 0.37).sin() + 1.5, 0.5, i as f32 / 4096.0];
    let mut one = layer(None, (64, 64), rgb((64, 64), of, halves));
    one.encoding.compression = exr::compression::Compression::DWAA(Some(45.0));
    let good = file(window(64, 64), vec![one]);
    assert!(decode(&good, ReadOptions::default()).is_ok());
    // Two blocks of 32 lines. After the offset table, each block has its line, its size, and then the counters.
    let place = |at: usize| good.get(at..at + 8).map(|b| u64::from_le_bytes(b.try_into().unwrap()) as usize);
    let table = (8..good.len()).find(|at| place(*at) == Some(at + 16)).expect("a table of places");
    let numbers = place(table).unwrap() + 8;
    for number in [1, 6, 7, 8, 9] {
        for promise in [1_u64 << 33, 1 << 62, u64::MAX] {
            let mut bad = good.clone();
            bad[numbers + 8 * number..][..8].copy_from_slice(&promise.to_le_bytes());
            let text = trouble(decode(&bad, ReadOptions::default())).text;
            assert!(text.contains("unpack to more than its pixels can hold"), "{number}, {promise}: {text}");
        }
    }
}
