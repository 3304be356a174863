//! Measures the memory that reading a picture takes: the peak of a separate process that reads it, as the system counts it.

use spectra_core::resources::FoundFile;
use spectra_pictures::read::{ReadOptions, decode, header};
use std::path::Path;
use std::process::Command;

pub const WIDTH: u32 = 2896;
pub const HEIGHT: u32 = 1930;
const PIXELS: f64 = (WIDTH * HEIGHT) as f64;
/// Memory for decoders and what they unpack at a time.
const SPARE_BYTES: f64 = (12 << 20) as f64;

/// Returns the largest memory of this process so far, bytes (proc(5), `VmHWM`).
fn peak_bytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says it");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line of it");
    line.trim().trim_end_matches("kB").trim().parse::<f64>().expect("a number") * 1024.0
}

/// Reads the file that a test names, and prints how much memory that took.
#[test]
#[ignore = "started by a test, in a process of its own"]
fn reader() {
    let Some(path) = std::env::var_os("SPECTRA_TEST_PICTURE") else { return };
    let found = FoundFile::on_disk("a file".to_owned(), path.clone().into());
    let name = path.to_string_lossy();
    let choice =
        ReadOptions { name: &name, transfer: name.ends_with(".dpx").then_some("srgb"), ..ReadOptions::default() };
    let before = peak_bytes();
    let header = header(&found, choice).unwrap_or_else(|trouble| panic!("{name}: {}", trouble.text));
    let of_header = peak_bytes() - before;
    let read = decode(&found, choice).unwrap_or_else(|trouble| panic!("{name}: {}", trouble.text));
    println!("cost {} {}", of_header, peak_bytes() - before);
    assert_eq!((read.width, read.height), (header.width, header.height), "{name}");
    assert_eq!(read.clipped_at.is_some(), header.clips, "{name}");
}

pub fn ramp<T: Copy>(channels: u32, of: impl Fn(u32) -> T) -> Vec<T> {
    let row: Vec<T> = (0..WIDTH * channels).map(|i| of(i / channels / 16)).collect();
    row.repeat(HEIGHT as usize)
}

/// A file name, and a function that writes the file.
pub type Case = (&'static str, fn(&Path));

/// Checks that each of these files takes at most twelve bytes per pixel, and its header none.
pub fn holds(cases: &[Case]) {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, write) in cases {
        let path = folder.path().join(name);
        write(&path);
        let own = std::env::current_exe().expect("this program");
        let mut reader = Command::new(own);
        reader.args(["--exact", "cost::reader", "--ignored", "--nocapture", "--test-threads", "1"]);
        let output = reader.env("SPECTRA_TEST_PICTURE", &path).output().expect("it runs");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&output.stderr));
        let said = text.split("cost ").nth(1).expect("what it cost").lines().next().expect("a line");
        let cost: Vec<f64> = said.split(' ').map(|word| word.parse().expect("a number")).collect();
        println!("{name}: {:.2} B a pixel, {:.2} of them for the header", cost[1] / PIXELS, cost[0] / PIXELS);
        assert!(cost[0] < SPARE_BYTES, "{name}: the header took {} bytes", cost[0]);
        assert!(cost[1] < 12.0 * PIXELS + SPARE_BYTES, "{name}: {:.2} B a pixel", cost[1] / PIXELS);
        std::fs::remove_file(&path).expect("it was there");
    }
}
