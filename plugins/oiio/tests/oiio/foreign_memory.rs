//! Memory that OpenImageIO needs to read a picture of another format.

use crate::cost::{Case, HEIGHT, WIDTH, ramp};
use spectra_plugin_oiio::{Samples, Written, make_texture, write};
use std::fs::File;
use std::path::Path;

fn planes<T>(samples: Samples, then: impl FnOnce(&Written<'_>) -> T) -> T {
    let plane = ramp(1, |i| i as f32 / 256.0);
    then(&Written {
        format: "dpx",
        ending: "dpx",
        width_px: WIDTH,
        height_px: HEIGHT,
        pixel_aspect: None,
        samples,
        tile_px: None,
        channels: &[("R", &plane), ("G", &plane), ("B", &plane)],
        texts: &[],
        integers: &[],
    })
}

fn foreign(path: &Path) {
    let mut file = File::options().read(true).write(true).create_new(true).open(path).expect("a file");
    planes(Samples::U16, |picture| write(&mut file, picture)).expect("written");
}

/// Writes half floats, which only OpenImageIO reads.
fn texture(path: &Path) {
    planes(Samples::F16, |picture| make_texture(path, picture)).expect("written");
}

#[test]
fn a_foreign_picture_costs_twelve_bytes_a_pixel_and_its_header_none() {
    let cases: &[Case] = &[("film.dpx", foreign), ("tiles.tx", texture)];
    crate::cost::holds(cases);
}
