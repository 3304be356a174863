//! Tests picture files in formats that the program does not know itself, with and without the feature `oiio`. This is a separate
//! program, because it is built again with the feature.

#[path = "it/common/mod.rs"]
mod common;

#[cfg(feature = "oiio")]
use common::run;
use common::{repository, run_in, text};
use std::path::Path;
use std::process::Output;

const LENS: &str = "lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\n";

fn scene(file: &str, more: &str) -> String {
    let source = format!(
        "spectra: 1\nsource:\n  kind: picture\n  file: {file}\n  distance: 2 m\n  width: 1.5 m\n  luminance: 300 cd/m2\n"
    );
    let rest = "imager: {kind: film, format: 135, resolution: [48, 32]}\nfilm: {stock: ilford-ortho-plus, exposure: 1/60 s}\n\
                render: {samples: 4}\n";
    format!("{source}{more}{LENS}{rest}")
}

fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    run_in(folder, arguments)
}

#[test]
fn plain_and_tiled_are_not_asked_for_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let ortho = std::fs::read_to_string(repository("scenes/biotar-ortho.yaml")).expect("a scene");
    std::fs::write(folder.path().join("a.yaml"), ortho).expect("written");
    let set = "output=[exr, {kind: exr, tiled: maybe}]";
    let output = in_folder(folder.path(), &["check", "a.yaml", "--set", set]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("tiled"), "{}", text(&output.stderr));
}

#[cfg(not(feature = "oiio"))]
mod without {
    use super::*;

    #[test]
    fn other_formats_say_where_and_how_to_get_them() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("scan.dpx"), b"SDPX and so on").expect("written");
        let text_of_scene = format!("{}output: [png, {{kind: exr, tiled: true}}]\n", scene("scan.dpx", ""));
        std::fs::write(folder.path().join("a.yaml"), text_of_scene).expect("written");
        for command in ["check", "run"] {
            let output = in_folder(folder.path(), &[command, "a.yaml"]);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            for word in
                ["a.yaml:4:9", "`.dpx` files", "a.yaml:12:34", "tiled OpenEXR", "cargo build --release --features oiio"]
            {
                assert!(message.contains(word), "{word}: {message}");
            }
            assert!(!folder.path().join("out").exists(), "something was rendered");
        }
    }
}

#[cfg(feature = "oiio")]
mod with {
    use super::*;
    use crate::common::shown;
    use exr::prelude::*;

    fn image(path: &Path) -> FlatImage {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_file(path)
            .unwrap()
    }

    #[test]
    fn the_tiled_file_holds_what_the_plain_one_does() {
        let folder = tempfile::tempdir().expect("a folder");
        let ortho = repository("scenes/biotar-ortho.yaml");
        // Sizes that are no multiple of the tile size.
        let base = ["run", shown(&ortho), "--set", "imager.resolution=[150, 100]", "--samples", "2", "--set"];
        let run = |output: &str, to: &str| {
            let (output, to) = (format!("output={output}"), folder.path().join(to));
            let done = run(&[&base[..], &[&output, "--output", shown(&to)]].concat());
            assert!(done.status.success(), "{}", text(&done.stderr));
            to.join("biotar-ortho.exr")
        };
        let paths = [
            run("[exr]", "plain"),
            run("[{kind: exr, tiled: true}]", "tiled"),
            run("[{kind: exr, tiled: true}]", "again"),
        ];
        assert_eq!(std::fs::read(&paths[1]).unwrap(), std::fs::read(&paths[2]).unwrap(), "the bits differ");
        let [plain, tiled] = [image(&paths[0]), image(&paths[1])];
        let [a, b] = [&plain.layer_data[0], &tiled.layer_data[0]];
        assert_eq!(b.encoding.blocks, Blocks::Tiles(Vec2(64, 64)));
        assert_eq!((a.encoding.blocks, a.encoding.compression), (Blocks::ScanLines, b.encoding.compression));
        assert_eq!(
            (plain.attributes.pixel_aspect, plain.attributes.display_window),
            (tiled.attributes.pixel_aspect, tiled.attributes.display_window)
        );
        assert_eq!(a.size, b.size);
        let names = |layer: &Layer<AnyChannels<FlatSamples>>| -> Vec<String> {
            layer.channel_data.list.iter().map(|c| c.name.to_string()).collect()
        };
        assert_eq!(names(a), names(b));
        for (a, b) in a.channel_data.list.iter().zip(&b.channel_data.list) {
            let (FlatSamples::F32(a), FlatSamples::F32(b)) = (&a.sample_data, &b.sample_data) else {
                panic!("32-bit floats")
            };
            assert!(a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()) && a.iter().any(|v| *v > 0.0));
        }
        assert!(!a.attributes.other.is_empty());
        for (name, value) in &a.attributes.other {
            // The scene recorded in the file names its output, so it differs.
            if name != "spectra:scene" {
                assert_eq!(b.attributes.other.get(name), Some(value), "{name}");
            }
        }
        let scene = Text::from("spectra:scene");
        assert!(b.attributes.other.contains_key(&scene));
        let beyond: Vec<_> = b.attributes.other.keys().filter(|name| !a.attributes.other.contains_key(*name)).collect();
        println!("beyond the plain file: {beyond:?}");
        let left: Vec<_> =
            std::fs::read_dir(folder.path().join("tiled")).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left.len(), 2, "the picture and the report: {left:?}");
    }

    #[test]
    fn plain_and_tiled_together_are_a_fault() {
        let ortho = repository("scenes/biotar-ortho.yaml");
        let set = "output=[exr, {kind: exr, tiled: true}]";
        let output = run(&["check", shown(&ortho), "--set", set]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("two outputs write `SCENE.exr`"), "{}", text(&output.stderr));
    }

    /// A portable pixmap, which only the library can read, and a PNG with the same codes give the same light to the bit. Both are
    /// declared in the same encoding, ITU-R BT.709, which Netpbm's page on the format specifies.
    #[test]
    fn a_scene_is_lit_by_another_format_as_by_its_own() {
        let folder = tempfile::tempdir().expect("a folder");
        let codes: Vec<u8> = (0..60 * 40 * 3_u32).map(|i| (i * 37 % 256) as u8).collect();
        let mut pixmap = b"P6\n60 40\n255\n".to_vec();
        pixmap.extend(&codes);
        std::fs::write(folder.path().join("a.ppm"), pixmap).unwrap();
        let rgb = codes
            .chunks_exact(3)
            .map(|c| [0, 1, 2].map(|i| spectra_color::Transfer::Srgb.decode(f64::from(c[i]) / 255.0) as f32));
        let picture = spectra_core::frame::DisplayPicture { width_px: 60, height_px: 40, rgb: rgb.collect() };
        spectra_pictures::write::write_png8(&folder.path().join("a.png"), &picture).unwrap();
        for (name, file, more) in [("ppm", "a.ppm", ""), ("png", "a.png", "  transfer: rec709\n")] {
            std::fs::write(folder.path().join(format!("{name}.yaml")), scene(file, more)).unwrap();
            let done = in_folder(folder.path(), &["run", &format!("{name}.yaml"), "--output", "out"]);
            assert!(done.status.success(), "{}", text(&done.stderr));
        }
        let [a, b] = ["out/ppm.exr", "out/png.exr"].map(|path| image(&folder.path().join(path)));
        for (a, b) in a.layer_data[0].channel_data.list.iter().zip(&b.layer_data[0].channel_data.list) {
            assert_eq!(a.sample_data, b.sample_data);
        }
    }

    #[test]
    fn a_broken_file_has_its_place_and_hint() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("scan.dpx"), b"This is a text.").unwrap();
        std::fs::write(folder.path().join("a.yaml"), scene("scan.dpx", "")).unwrap();
        let output = in_folder(folder.path(), &["check", "a.yaml"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in ["a.yaml:4:9", "scan.dpx", "OpenImageIO", "is the file complete"] {
            assert!(message.contains(word), "{word}: {message}");
        }
    }
}
