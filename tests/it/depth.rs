//! Tests pictures with depth and layers: occlusion at edges compared with the area of the pupil that sees each side.

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use spectra_plugins as _;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use std::path::Path;

const SEMI_DIAMETER: f64 = 6.25;
const NEAR: f64 = 1000.0;
const FAR: f64 = 2000.0;
/// Luminance of the foreground relative to the background.
const DIM: f64 = 0.2;
const COLUMNS: usize = 40;
const FRAME: f64 = 0.8;

fn exr_file(path: &Path, size: (usize, usize), planes: &[(&str, Vec<f32>)]) {
    let channels = planes.iter().map(|(name, v)| AnyChannel::new(*name, FlatSamples::F32(v.clone()))).collect();
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    Image::from_layer(layer).write().to_file(path).expect("written");
}

/// Writes a picture whose left half is a dim foreground and whose right half is a background.
fn halves(path: &Path, with: impl Fn(bool) -> Vec<(&'static str, f32)>) {
    let (width, height) = (64, 32);
    let sides = [with(true), with(false)];
    let plane = |k: usize| (0..width * height).map(|i| sides[usize::from(i % width >= width / 2)][k].1).collect();
    let planes: Vec<_> = (0..sides[0].len()).map(|k| (sides[0][k].0, plane(k))).collect();
    exr_file(path, (width, height), &planes);
}

/// Returns the mean Y of each column of the frame.
fn columns(scene: &Path, set: &[&str]) -> Vec<f64> {
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    let scene = spectra_scene::load(scene, &set).unwrap_or_else(|faults| panic!("{faults}"));
    let renderer = Renderer::new(scene.clone(), &RenderOptions::default()).expect("the scene can be rendered");
    let frame = renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure;
    let values = &frame.channel("Y").expect("an XYZ imager").values;
    (0..COLUMNS)
        .map(|c| {
            let column: Vec<f64> = values.iter().skip(c).step_by(COLUMNS).map(|v| f64::from(*v)).collect();
            column.iter().sum::<f64>() / column.len() as f64
        })
        .collect()
}

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let light = |v: f32| vec![("R", v), ("G", v), ("B", v)];
        halves(&at("deep.exr"), |near| {
            let mut planes = light(if near { DIM as f32 } else { 1.0 });
            planes.push(("Z", if near { NEAR } else { FAR } as f32 / 1000.0));
            planes
        });
        halves(&at("front.exr"), |near| {
            let mut planes = light(if near { DIM as f32 } else { 0.0 });
            planes.push(("A", f32::from(near)));
            planes
        });
        halves(&at("white.exr"), |_| light(1.0));
        std::fs::write(
            at("thin.yaml"),
            format!(
                "name: Thin lens\nsurfaces:\n  - {{kind: thin-lens, focal-length: 50, semi-diameter: {SEMI_DIAMETER}, stop: true, thickness: 50}}\n"
            ),
        )
        .expect("written");
        let scene = |source: &str| {
            format!(
                "spectra: 1\nsource: {source}\nlens: {{file: thin.yaml, focus: 2 m}}\n\
                 imager: {{kind: xyz, width: {FRAME}, height: 0.4, resolution: [{COLUMNS}, 20]}}\n\
                 render: {{samples: 512, seed: 3, direction: backward}}\n"
            )
        };
        let color = "luminance: 100 cd/m2";
        for (name, source) in [
            ("white", format!("{{kind: picture, file: white.exr, distance: 2 m, width: 400, {color}}}")),
            (
                "deep",
                format!("{{kind: picture, file: deep.exr, distance: 2 m, width: 400, depth: {{unit: m}}, {color}}}"),
            ),
            (
                "layers",
                format!(
                    "{{kind: layers, {color}, layers: [{{file: front.exr, distance: 1 m, width: 32 mm, center: [0, 0]}}, \
                     {{file: white.exr, distance: 2 m, width: 4 m}}]}}"
                ),
            ),
        ] {
            std::fs::write(at(&format!("{name}.yaml")), scene(&source)).expect("written");
        }
        Self { folder }
    }

    fn columns(&self, name: &str, set: &[&str]) -> Vec<f64> {
        columns(&self.folder.path().join(format!("{name}.yaml")), set)
    }
}

/// Returns the share of a unit disk on the side x > u.
fn segment(u: f64) -> f64 {
    let u = u.clamp(-1.0, 1.0);
    (u.acos() - u * (1.0 - u * u).sqrt()) / std::f64::consts::PI
}

/// Returns the light of each column relative to the background alone. The edge is at x = 0 at `NEAR`, and the lens is focused at
/// `focus`. A ray from px in the pupil to X on the plane in focus crosses the plane of the edge at px (1 - NEAR / focus) + X NEAR /
/// focus.
fn closed_form(focus: f64) -> Vec<f64> {
    let magnification = 50.0 / (focus - 50.0);
    (0..COLUMNS)
        .map(|c| {
            let parts = 64;
            let covered = (0..parts).map(|k| {
                let at = (c as f64 + (f64::from(k) + 0.5) / f64::from(parts)) / COLUMNS as f64 - 0.5;
                let x = at * FRAME / magnification * NEAR / focus;
                let radius = SEMI_DIAMETER * (1.0 - NEAR / focus);
                if radius > 0.0 { segment(x / radius) } else { f64::from(x < 0.0) }
            });
            let covered = covered.sum::<f64>() / f64::from(parts);
            covered * DIM + (1.0 - covered)
        })
        .collect()
}

fn compare(files: &Files, name: &str) {
    let open = files.columns("white", &[]);
    let seen = files.columns(name, &[]);
    let mut worst = 0.0_f64;
    for (column, want) in closed_form(FAR).iter().enumerate() {
        let got = seen[column] / open[column];
        worst = worst.max((got / want - 1.0).abs());
        assert!((got / want - 1.0).abs() < 0.02, "{name} column {column}: {got:.4}, closed form {want:.4}");
    }
    println!("{name}: worst of {COLUMNS} columns {:.2} % from the closed form", 100.0 * worst);
}

#[test]
fn a_blurred_edge_of_a_picture_with_depth_is_the_segment_of_the_pupil() {
    compare(&Files::new(), "deep");
}

#[test]
fn a_blurred_edge_of_a_layer_is_the_segment_of_the_pupil() {
    compare(&Files::new(), "layers");
}

/// Rays traced from the source give the same edge: the foreground shadows what lies behind it, and what is guessed there shines too.
#[test]
fn a_blurred_edge_is_the_same_from_the_source() {
    let files = Files::new();
    // Averages pairs of columns, because few rays reach a dim one.
    let pairs = |columns: Vec<f64>| columns.chunks(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
    // The source is little wider than what the frame sees; rays that start elsewhere are lost.
    let many = ["render.direction=forward", "render.rays=10000000"];
    let forward = |name: &str, width| pairs(files.columns(name, &[&many[..], &[width]].concat()));
    let open = forward("white", "source.width=48 mm");
    for (name, width) in [("deep", "source.width=48 mm"), ("layers", "source.layers[1].width=48 mm")] {
        let seen = forward(name, width);
        for (pair, want) in pairs(closed_form(FAR)).iter().enumerate() {
            let got = seen[pair] / open[pair];
            assert!(
                (got / want - 1.0).abs() < 0.02,
                "{name} columns from {}: {got:.4}, closed form {want:.4}",
                2 * pair
            );
        }
    }
}

/// The edge of a foreground in focus is sharp. No background leaks into it, and no foreground appears beside it, although much of
/// what is seen there is hidden from the picture's own viewpoint.
#[test]
fn an_edge_in_focus_leaks_nothing_either_way() {
    let files = Files::new();
    let focus = ["lens.focus=1 m"];
    let open = files.columns("white", &focus);
    for name in ["deep", "layers"] {
        let seen = files.columns(name, &focus);
        for column in 0..COLUMNS {
            let got = seen[column] / open[column];
            let want = if column < COLUMNS / 2 { DIM } else { 1.0 };
            // The cover of a layer falls off over one of its pixels, 0.5 mm: 1.3 columns around the edge.
            if name == "deep" || !(COLUMNS / 2 - 2..COLUMNS / 2 + 2).contains(&column) {
                assert!((got / want - 1.0).abs() < 1e-4, "{name} column {column}: {got}");
            }
        }
    }
}

#[test]
fn faults_of_depth_say_where_and_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let gray: Vec<f32> = vec![0.5; 4];
    let file = |name: &str, depth: Option<[f32; 4]>| {
        let mut planes = vec![("R", gray.clone()), ("G", gray.clone()), ("B", gray.clone())];
        planes.extend(depth.map(|d| ("Z", d.to_vec())));
        exr_file(&folder.path().join(name), (2, 2), &planes);
    };
    file("flat.exr", None);
    file("zero.exr", Some([1.0, 0.0, 1.0, 1.0]));
    file("nan.exr", Some([1.0, 1.0, f32::NAN, 1.0]));
    file("sky.exr", Some([1.0, 1.0, 1.0, f32::INFINITY]));
    exr_file(&folder.path().join("small.exr"), (2, 1), &[("Z", vec![1.0, 1.0])]);
    let load = |file: &str, depth: &str| {
        let scene = folder.path().join("scene.yaml");
        let text = format!(
            "spectra: 1\nsource: {{kind: picture, file: {file}, distance: 2 m, width: 1 m, depth: {depth}}}\n\
             lens: {{file: zeiss-biotar-50-f1.4}}\nimager: {{kind: xyz, format: 135, resolution: [6, 4]}}\n"
        );
        std::fs::write(&scene, text).expect("written");
        // Numbers in the scene are checked when it is loaded, pixels when light is traced.
        spectra_scene::load(&scene, &[]).and_then(|scene| scene.source.prepare()).map_err(|faults| faults.to_string())
    };
    for (file, depth, words) in [
        ("flat.exr", "{unit: m}", ["no depth channel `Z`", "`R`"]),
        ("zero.exr", "{unit: m}", ["0 or less at column 1, row 0", "`far`"]),
        ("nan.exr", "{unit: m}", ["not a number at column 0, row 1", "`far`"]),
        ("sky.exr", "{unit: m}", ["infinite at column 1, row 1", "far: 1 km"]),
        ("sky.exr", "{unit: yard}", ["unknown value `yard` for `unit`", "known: mm"]),
        ("sky.exr", "{scale: 0}", ["all depths would be 0", "-1 if depth is negative in front of the camera"]),
        ("flat.exr", "{file: small.exr}", ["2 x 1 pixels, the picture 2 x 2", "the picture's size"]),
        ("sky.exr", "{kind: radial}", ["unknown value `radial` for `kind`", "known: z, ray, inverse"]),
        ("sky.exr", "{far: 1 m, near: 2 m}", ["farther than `near`", "2:80"]),
    ] {
        let faults = load(file, depth).expect_err(file);
        assert!(words.iter().all(|word| faults.contains(word)), "{file} {depth}: {faults}");
    }
    load("sky.exr", "{unit: m, far: 100 m}").expect("a backdrop");
}

/// Overscan, the pixels beyond the display window of an OpenEXR file, continues the picture beside it, with and without depth.
#[test]
fn overscan_lies_beside_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    // 60 x 50 different pixels; the display window is the middle 40 x 30.
    let (data, shown, margin) = ((60, 50), (40, 30), 10);
    let values = |f: &dyn Fn(usize, usize) -> f32| (0..data.0 * data.1).map(|i| f(i % data.0, i / data.0)).collect();
    let planes: Vec<(&str, Vec<f32>)> = vec![
        ("R", values(&|x, _| 0.1 + 0.01 * x as f32)),
        ("G", values(&|_, y| 0.1 + 0.01 * y as f32)),
        ("B", values(&|x, y| 0.1 + 0.005 * (x + y) as f32)),
        ("Z", values(&|x, _| if x < 25 { 1.5 } else { 2.5 })),
    ];
    exr_file(&at("plain.exr"), data, &planes);
    let windowed = |name: &str, position: (i32, i32)| {
        let channels = planes.iter().map(|(name, v)| AnyChannel::new(*name, FlatSamples::F32(v.clone()))).collect();
        let mut layer =
            Layer::new(data, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
        layer.attributes.layer_position = position.into();
        let display = exr::prelude::IntegerBounds::new((0, 0), shown);
        let image = Image::new(exr::prelude::ImageAttributes::new(display), layer);
        image.write().to_file(at(name)).expect("written");
    };
    windowed("overscan.exr", (-margin, -margin));
    windowed("uneven.exr", (-20, -20));
    let exposure = |source: &str| {
        let text = format!(
            "spectra: 1\nsource: {{kind: picture, distance: 2 m, {source}}}\nlens: {{file: zeiss-biotar-50-f1.4}}\n\
             imager: {{kind: xyz, format: 135, resolution: [36, 24]}}\nrender: {{samples: 8, seed: 1, direction: backward}}\n"
        );
        std::fs::write(at("scene.yaml"), text).expect("written");
        let scene = spectra_scene::load(&at("scene.yaml"), &[]).unwrap_or_else(|faults| panic!("{faults}"));
        let told: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
        let renderer = Renderer::new(scene, &RenderOptions::default()).expect("the scene can be rendered");
        let frame = renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure;
        (frame.channel("Y").expect("an XYZ imager").values.clone(), told.join("\n"))
    };
    for depth in ["", ", depth: {unit: m}"] {
        // The display window alone would leave the border black; with overscan the frame equals that of the whole picture at its
        // width.
        let (over, told) = exposure(&format!("file: overscan.exr, width: 1.2 m{depth}"));
        assert_eq!(told, "", "{depth}");
        let (whole, _) = exposure(&format!("file: plain.exr, width: 1.8 m{depth}"));
        assert_eq!(over, whole, "{depth}");
        assert!(over.iter().all(|v| *v > 0.0), "the frame is filled {depth}");
        // `fill` sets the width of the display window.
        let (fill, _) = exposure(&format!("file: overscan.exr, width: fill{depth}"));
        assert!(fill.iter().all(|v| *v > 0.0));
    }
    // Overscan on one side only cannot be used, and a warning says so.
    let (_, told) = exposure("file: uneven.exr, width: fill");
    assert!(told.contains("20 pixels beyond the display window on the left, 0 on the right"), "{told}");
}

/// A room whose depth is measured along the ray but read as along the axis, or the other way round, causes a question; so do things
/// nearer than two focal lengths. Checked in OpenEXR and in 16-bit TIFF and PNG.
#[test]
fn kinds_of_depth_and_near_things_are_asked_about() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (width, height) = (96_usize, 54_usize);
    let gray: Vec<f32> = vec![0.5; width * height];
    // A wall at 4 m and a floor 1 m below the camera. The plane of the picture, 2 m wide, is at 2 m.
    let depth = |ray: bool, near_mm: f32| -> Vec<f32> {
        let place = |i: usize, n: usize| (i as f64 + 0.5 - 0.5 * n as f64) / width as f64;
        let pixel = |i: usize| {
            let (u, v) = (place(i % width, width), place(i / width, height));
            let z = if v > 0.0 { (1000.0 / v).min(4000.0) } else { 4000.0 };
            let along = if ray { (1.0 + u * u + v * v).sqrt() } else { 1.0 };
            if i == 0 && near_mm > 0.0 { near_mm } else { (z * along) as f32 }
        };
        (0..width * height).map(pixel).collect()
    };
    let file = |name: &str, depth: Vec<f32>| {
        let channels = [("R", gray.clone()), ("G", gray.clone()), ("B", gray.clone()), ("Z", depth)];
        exr_file(&at(name), (width, height), &channels);
    };
    file("z.exr", depth(false, 0.0));
    file("ray.exr", depth(true, 0.0));
    file("near.exr", depth(false, 60.0));
    for name in ["ray.png", "ray.tif"] {
        let codes: Vec<u16> = depth(true, 0.0).iter().map(|mm| mm.round() as u16).collect();
        let deep =
            image::ImageBuffer::<image::Luma<u16>, _>::from_vec(width as u32, height as u32, codes).expect("all");
        deep.save(at(name)).expect("written");
    }
    let asked = |file: &str, depth: &str| {
        let text = format!(
            "spectra: 1\nsource: {{kind: picture, file: {file}, distance: 2 m, width: 2 m, depth: {depth}}}\n\
             lens: {{file: zeiss-biotar-50-f1.4}}\nimager: {{kind: xyz, format: 135, resolution: [6, 4]}}\n"
        );
        std::fs::write(at("scene.yaml"), text).expect("written");
        let scene = spectra_scene::load(&at("scene.yaml"), &[]).unwrap_or_else(|faults| panic!("{faults}"));
        scene.source.prepare().unwrap_or_else(|faults| panic!("{faults}"));
        scene.source.warnings().iter().map(|doubt| format!("{doubt}\n")).collect::<String>()
    };
    for (file, wrong, words, right) in [
        ("ray.exr", "{}", "did you mean `kind: ray`?", "{kind: ray}"),
        ("z.exr", "{kind: ray}", "did you mean `kind: z`?", "{kind: z}"),
        (
            "z.exr",
            "{file: ray.png, scale: 65535}",
            "did you mean `kind: ray`?",
            "{file: ray.png, scale: 65535, kind: ray}",
        ),
        (
            "z.exr",
            "{file: ray.tif, scale: 65535}",
            "did you mean `kind: ray`?",
            "{file: ray.tif, scale: 65535, kind: ray}",
        ),
        ("near.exr", "{}", "`near: 11 cm`", "{near: 11 cm}"),
    ] {
        let said = asked(file, wrong);
        assert!(said.contains(words), "{file} {wrong}: {said}");
        assert_eq!(asked(file, right), "", "{file} {right}");
    }
}

/// Depth that was probably read in a wrong way causes a question that says what to write, in OpenEXR, PNG and TIFF. With that
/// written there is no question.
#[test]
fn mistaken_depths_are_asked_about() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    // One pixel at 1.5 m, two at 2 m, and the wall at 4 m. The plane of the picture is at 2 m.
    let meters = [1.5_f32, 2.0, 2.0, 4.0];
    let gray: Vec<f32> = vec![0.5; 4];
    let file = |name: &str, of: &dyn Fn(f32) -> f32| {
        let depth: Vec<f32> = meters.iter().map(|m| of(*m)).collect();
        exr_file(&at(name), (2, 2), &[("R", gray.clone()), ("G", gray.clone()), ("B", gray.clone()), ("Z", depth)]);
    };
    file("m.exr", &|m| m);
    file("mm.exr", &|m| 1000.0 * m);
    file("cm.exr", &|m| 100.0 * m);
    file("negative.exr", &|m| -m);
    file("inverse.exr", &|m| 1.0 / m);
    file("normalised.exr", &|m| (m - 1.0) / 3.0);
    file("mask.exr", &|m| f32::from(u8::from(m < 3.0)));
    let codes: Vec<u16> = meters.iter().map(|m| (1000.0 * m) as u16).collect();
    let deep = image::ImageBuffer::<image::Luma<u16>, _>::from_vec(2, 2, codes).expect("four");
    deep.save(at("deep.png")).expect("written");
    deep.save(at("deep.tif")).expect("written");
    // An alpha channel is not part of the depth.
    let covered = image::ImageBuffer::<image::LumaA<u16>, _>::from_fn(2, 2, |x, y| {
        image::LumaA([deep.get_pixel(x, y).0[0], 30_000])
    });
    covered.save(at("covered.png")).expect("written");
    let asked = |file: &str, depth: &str| {
        let text = format!(
            "spectra: 1\nsource: {{kind: picture, file: {file}, distance: 2 m, width: 1 m, depth: {depth}}}\n\
             lens: {{file: zeiss-biotar-50-f1.4}}\nimager: {{kind: xyz, format: 135, resolution: [6, 4]}}\n"
        );
        std::fs::write(at("scene.yaml"), text).expect("written");
        let scene = spectra_scene::load(&at("scene.yaml"), &[]).map_err(|faults| faults.to_string())?;
        scene.source.prepare().map_err(|faults| faults.to_string())?;
        Ok::<String, String>(scene.source.warnings().iter().map(|doubt| format!("{doubt}\n")).collect())
    };
    // Each case: the file, the depth settings as written, the words of the question, and the settings to write.
    for (file, wrong, words, right) in [
        ("m.exr", "{}", "did you mean `unit: m`?", "{unit: m}"),
        ("m.exr", "{unit: cm}", "did you mean `unit: m`?", "{unit: m}"),
        ("cm.exr", "{unit: m}", "did you mean `unit: cm`?", "{unit: cm}"),
        ("mm.exr", "{unit: m}", "did you mean `unit: mm`?", "{}"),
        ("negative.exr", "{unit: m}", "measured against the view: write `scale: -1`", "{unit: m, scale: -1}"),
        ("inverse.exr", "{}", "did you mean `unit: m, kind: inverse`?", "{unit: m, kind: inverse}"),
        ("normalised.exr", "{}", "if this is normalized depth, export it in meters", ""),
        ("mask.exr", "{}", "if it is alpha, another `channel`", ""),
        (
            "m.exr",
            "{file: deep.png}",
            "write what 1 stands for: `scale: 65535, unit: mm`",
            "{file: deep.png, scale: 65535}",
        ),
        (
            "m.exr",
            "{file: deep.tif}",
            "write what 1 stands for: `scale: 65535, unit: mm`",
            "{file: deep.tif, scale: 65535}",
        ),
        (
            "m.exr",
            "{file: deep.png, scale: 65535, unit: m}",
            "did you mean `unit: mm`?",
            "{file: deep.png, scale: 65535}",
        ),
    ] {
        let said = asked(file, wrong).unwrap_or_else(|faults| faults);
        println!("{file} {wrong}: {said}");
        assert!(said.contains(words), "{file} {wrong}: {said}");
        if !right.is_empty() {
            assert_eq!(asked(file, right).as_deref(), Ok(""), "{file} {right}");
        }
    }
}

/// Writes a bright card at 1 m in front of a dark wall at 8 m, with a slanted, antialiased edge like that of a renderer: with depth
/// sampled once per pixel, with averaged depth, and as two layers.
fn card(folder: &Path) {
    const SIZE: (usize, usize) = (64, 32);
    let share: Vec<f32> = (0..SIZE.0 * SIZE.1)
        .map(|i| {
            let near = |k: usize| {
                let (x, y) = (i % SIZE.0 * 16 + k % 16, i / SIZE.0 * 16 + k / 16);
                (x as f64) < 32.0 * 16.0 + 0.23 * (y as f64 - 256.0)
            };
            (0..256).filter(|k| near(*k)).count() as f32 / 256.0
        })
        .collect();
    let mixed = |front: f32, back: f32| -> Vec<f32> { share.iter().map(|s| s * front + (1.0 - s) * back).collect() };
    let light = |front: f32, back: f32| ["R", "G", "B"].map(|name| (name, mixed(front, back)));
    let with = |more: (&'static str, Vec<f32>)| [light(1.0, 0.05).to_vec(), vec![more]].concat();
    let sampled = share.iter().map(|s| if *s >= 0.5 { 1.0 } else { 8.0 }).collect();
    exr_file(&folder.join("sampled.exr"), SIZE, &with(("Z", sampled)));
    exr_file(&folder.join("averaged.exr"), SIZE, &with(("Z", mixed(1.0, 8.0))));
    exr_file(&folder.join("card.exr"), SIZE, &[light(1.0, 0.0).to_vec(), vec![("A", share.clone())]].concat());
    exr_file(&folder.join("wall.exr"), SIZE, &light(0.05, 0.05));
    let plate =
        |name: &str| format!("{{kind: picture, file: {name}.exr, distance: 1 m, width: 200, depth: {{unit: m}}}}");
    let layers = "{kind: layers, layers: [{file: card.exr, distance: 1 m, width: 200}, {file: wall.exr, distance: 8 m, width: 1600}]}";
    for (name, source) in
        [("sampled", plate("sampled")), ("averaged", plate("averaged")), ("card-layers", layers.to_owned())]
    {
        let text = format!(
            "spectra: 1\nsource: {source}\nlens: {{file: thin.yaml, focus: 1 m}}\n\
             imager: {{kind: xyz, width: 4, height: 2, resolution: [{COLUMNS}, 20]}}\n\
             render: {{samples: 256, seed: 3, direction: backward}}\n"
        );
        std::fs::write(folder.join(format!("{name}.yaml")), text).expect("written");
    }
}

/// A renderer averages color over a pixel but cannot average depth. The light of a card in focus that pixels on its edge contain must
/// not be blurred with the wall behind.
#[test]
fn mixed_pixels_of_a_plate_leave_no_rim() {
    let files = Files::new();
    card(files.folder.path());
    let layers = files.columns("card-layers", &[]);
    // The edge covers about three pixels of the plate in the frame, each 1.6 columns wide; the rim would cover three more.
    let first = COLUMNS / 2 + 4;
    for name in ["sampled", "averaged"] {
        let ratio = |set: &[&str]| {
            let seen = files.columns(name, set);
            (first..COLUMNS).map(|c| seen[c] / layers[c]).fold(0.0, f64::max)
        };
        let (clean, as_is) = (ratio(&[]), ratio(&["source.depth.edges=as-is"]));
        println!(
            "{name}: light beside the card at most {clean:.3} times that of layers, {as_is:.3} with `edges: as-is`"
        );
        assert!(clean < 1.02 && as_is > 1.1, "{name}: {clean} {as_is}");
        // Inside the card and on its edge the light equals that of layers too.
        let seen = files.columns(name, &[]);
        for column in 4..COLUMNS {
            let off = seen[column] - layers[column];
            assert!(off.abs() < 0.02 * layers[4], "{name} column {column}: {} {}", seen[column], layers[column]);
        }
    }
}

/// Rays from the source give the same light through partly covered pixels, with either side in focus.
#[test]
fn mixed_pixels_are_the_same_from_the_source() {
    let files = Files::new();
    card(files.folder.path());
    let fours = |columns: Vec<f64>| columns.chunks(4).map(|four| four.iter().sum::<f64>() / 4.0).collect::<Vec<_>>();
    for focus in ["lens.focus=1 m", "lens.focus=8 m"] {
        let backward = fours(files.columns("sampled", &[focus]));
        let many = ["render.direction=forward", "render.rays=3000000", focus];
        let forward = fours(files.columns("sampled", &many));
        // The first columns see light that starts beyond the plate's border.
        for (k, (forward, backward)) in forward.iter().zip(&backward).enumerate() {
            assert!((forward / backward - 1.0).abs() < 0.03, "{focus}, {k}: {forward} {backward}");
        }
    }
}
