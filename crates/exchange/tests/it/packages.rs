//! Compares files that come with two other open-source programs with what those programs compute from them: `tests/data/README.md`.

use spectra_exchange::{AxisItem, Format, Medium, Prescription, SurfaceShape, read};
use spectra_glass::Catalog;
use std::path::{Path, PathBuf};

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(file)
}

fn load(file: &str) -> Prescription {
    let format = Format::of_name(file).expect("a known ending");
    let bytes = std::fs::read(data(file)).expect("test data");
    read(format, file, &bytes).unwrap_or_else(|faults| panic!("{faults}"))
}

fn index(medium: &Medium, nm: f64) -> f64 {
    match medium {
        Medium::Air => 1.0,
        Medium::Glass { name, .. } => Catalog::bundled().medium(name).expect("a full name").index(nm),
        Medium::Model { nd, vd, .. } => {
            spectra_glass::Medium::from_nd_vd(*nd, vd.unwrap_or(0.0)).expect("a glass").index(nm)
        }
        Medium::Unknown { name } => panic!("unknown glass {name}"),
    }
}

/// Returns the curvature at the vertex in y-z and the power of an ideal lens, both in 1/mm.
fn bend(shape: &SurfaceShape) -> (f64, f64) {
    match shape {
        SurfaceShape::Plane | SurfaceShape::Stop | SurfaceShape::TiltedPlane { .. } => (0.0, 0.0),
        SurfaceShape::Sphere { radius } | SurfaceShape::Conic { radius, .. } | SurfaceShape::Grating { radius, .. } => {
            (1.0 / radius, 0.0)
        }
        SurfaceShape::EvenAsphere { radius, coefficients, .. } | SurfaceShape::Toroid { radius, coefficients, .. } => {
            (1.0 / radius + 2.0 * coefficients.first().unwrap_or(&0.0), 0.0)
        }
        SurfaceShape::Cylinder { radius, along_x } => (if *along_x { 1.0 / radius } else { 0.0 }, 0.0),
        SurfaceShape::Biconic { radius_y, .. } => (1.0 / radius_y, 0.0),
        SurfaceShape::ThinLens { focal_length } => (0.0, 1.0 / focal_length),
        other => panic!("{other:?}"),
    }
}

/// Absolute focal length from a paraxial ray, mm: n' u' = n u - y (n' - n) c, where each mirror reverses the sign of n (W. J. Smith, Modern
/// Optical Engineering, chapter 3). Tilts are ignored.
fn focal_length_mm(lens: &Prescription, nm: f64) -> f64 {
    let (mut y, mut slope, mut n) = (1.0, 0.0, 1.0);
    for item in &lens.items {
        if let AxisItem::Surface(surface) = item {
            let after = if surface.mirror { -n } else { index(&surface.medium, nm).copysign(n) };
            let (curvature, power) = bend(&surface.shape);
            slope = (n * slope - y * ((after - n) * curvature + power)) / after;
            n = after;
        }
        y += item.thickness_mm() * slope;
    }
    (1.0 / slope).abs()
}

/// The last column of the table is the allowed relative difference: 0.1 %, and less if both programs have the same glass data.
#[test]
fn focal_lengths_are_those_of_the_other_programs() {
    let table = std::fs::read_to_string(data("efl.csv")).expect("test data");
    let mut rows = 0;
    for row in table.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [nm, wanted, allowed] = [cells[1], cells[2], cells[4]].map(|cell| cell.parse::<f64>().expect("a number"));
        let found = focal_length_mm(&load(cells[0]), nm);
        let off = (found / wanted.abs() - 1.0).abs();
        assert!(off <= allowed && allowed <= 1e-3, "{row}: {found}, {off:.1e}");
        rows += 1;
    }
    assert!(rows >= 16, "{rows}");
}

#[test]
fn every_file_of_the_folders_is_read_and_written() {
    let mut count = 0;
    for folder in ["rayoptics", "optiland"] {
        for entry in std::fs::read_dir(data(folder)).expect("test data") {
            let name = entry.expect("an entry").file_name().into_string().expect("plain letters");
            if Format::of_name(&name).is_none() {
                continue;
            }
            let lens = load(&format!("{folder}/{name}"));
            let text = spectra_exchange::yaml::write(&lens, Some(&name));
            assert!(text.contains("\nsurfaces:\n  - {kind: "), "{name}: {text}");
            // What is written is read back as the same lens, to the last bits of a curvature.
            let written = spectra_exchange::zmx::write(&lens);
            let again =
                read(Format::Zmx, "again.zmx", &spectra_exchange::zmx::encode(&written.text)).expect("readable");
            assert_eq!(again.surfaces().count(), lens.surfaces().count(), "{name}");
            let (a, b) = (focal_length_mm(&lens, 555.0), focal_length_mm(&again, 555.0));
            // A medium that no catalog of the other program has is written as two figures, which is noted.
            let by_figures = written.left_out.iter().any(|note| note.text.contains("is written by its nd and Vd"));
            let allowed = if by_figures { 1e-4 } else { 1e-12 };
            assert!(a.is_infinite() && b.is_infinite() || (a / b - 1.0).abs() < allowed, "{name}: {a} {b}");
            count += 1;
        }
    }
    assert!(count >= 25, "{count}");
}

/// Checks data in these files other than radii and glasses.
#[test]
fn details_of_some_files() {
    let lens = load("optiland/lens_floa.zmx");
    let stop = lens.surfaces().find(|surface| surface.stop).expect("a stop");
    assert_eq!((stop.semi_diameter_mm, &stop.shape), (Some(8.5), &SurfaceShape::Stop), "floats by its size: it clips");

    let lens = load("optiland/inactive_wavelengths.zmx");
    assert_eq!(lens.wavelengths.len(), 1, "five are listed, one counts");
    assert_eq!((lens.wavelengths[0].nm, lens.object_distance_mm), (780.0, Some(10.0)));
    let stop = lens.surfaces().next().expect("a surface");
    assert_eq!(
        (stop.semi_diameter_mm, stop.outer_semi_diameter_mm),
        (Some(2.0), None),
        "its entrance pupil is 4 mm wide"
    );

    let lens = load("optiland/lens_offset_aperture.zmx");
    let aperture = &lens.surfaces().next().expect("a surface").apertures[0];
    assert_eq!(aperture.center_mm, [2.25, -3.5]);

    let lens = load("optiland/simple_fold_mirror_up.zmx");
    let tilts: Vec<f64> = lens
        .items
        .iter()
        .filter_map(|item| match item {
            AxisItem::Break(axis) => Some(axis.by.tilt_deg[0]),
            AxisItem::Surface(_) => None,
        })
        .collect();
    assert_eq!(tilts, [45.0, 45.0, 0.0, -45.0, -45.0, 0.0]);

    let lens = load("rayoptics/US00583336-2-scaled.zmx");
    assert!(lens.left_out.iter().all(|note| !note.alters), "{:?}", lens.left_out);
    assert!(lens.left_out.iter().any(|note| note.text.starts_with("solves and pickups (11 lines)")));
    assert!(lens.left_out.iter().any(|note| note.text.starts_with("vignetting factors")));
}

/// Compares the size of the stop from a paraxial ray with that which the other program computed by real rays over the whole field.
#[test]
fn stops_are_as_large_as_the_other_program_has_them() {
    for (name, wanted_mm) in [
        ("rayoptics/US00583336-2-scaled.zmx", 4.215),
        ("rayoptics/HoO-V2C18Ex03.zmx", 10.031),
        ("rayoptics/HoO-V2C18Ex27.zmx", 9.848),
        ("rayoptics/HoO-V2C18Ex46.zmx", 10.022),
        ("rayoptics/HoO-V2C18Ex66.zmx", 20.024),
        ("rayoptics/US05331467-1.zmx", 61.80),
    ] {
        let lens = load(name);
        let size = lens.surfaces().find(|surface| surface.stop).and_then(|stop| stop.semi_diameter_mm);
        // Pupil aberrations make a difference, most of all where mirrors are tilted.
        assert!(size.is_some_and(|size| (size / wanted_mm - 1.0).abs() < 0.06), "{name}: {size:?} {wanted_mm}");
    }
}
