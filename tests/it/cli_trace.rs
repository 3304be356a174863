//! Tests `spectra lens trace` with rays computed to 40 digits and with closed forms.

use crate::common::{good, lens, rows, run, shown, spectra, text};
use std::io::Write;
use std::process::Stdio;

const HEADER: &str = "status,surface,x_mm,y_mm,z_mm,l,m,n,wavelength_nm,transmittance,optical_path_mm";

/// Splits the rows of the result into text fields.
fn table(output: &str) -> Vec<Vec<&str>> {
    let mut lines = output.lines();
    assert_eq!(lines.next(), Some(HEADER));
    lines.map(|line| line.split(',').collect()).collect()
}

fn number(field: &str) -> f64 {
    field.parse().unwrap_or_else(|_| panic!("`{field}` is no number"))
}

/// Traces rays given as text, from standard input to standard output.
fn trace(lens: &str, rays: &str, options: &[&str]) -> std::process::Output {
    let mut child = spectra()
        .args(["lens", "trace", lens, "--rays", "-"])
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("piped");
    let rays = rays.to_owned();
    // The program may stop reading at a faulty row.
    let writer = std::thread::spawn(move || drop(stdin.write_all(rays.as_bytes())));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("written");
    output
}

fn traced(lens: &str, rays: &str, options: &[&str]) -> String {
    let output = trace(lens, rays, options);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// All 1 540 reference rays through eleven lenses, with every medium at its stated nd, end in the same way. Hit points agree within
/// 1e-9 mm, directions within 1e-12.
#[test]
fn reference_rays_end_where_the_reference_says() {
    let reference = rows("reference-rays.csv");
    assert_eq!(reference.len(), 1540);
    let mut lenses: Vec<&str> = reference.iter().map(|row| row[0].as_str()).collect();
    lenses.dedup();
    assert_eq!(lenses.len(), 11);
    let folder = tempfile::tempdir().expect("a folder");
    let (mut point_error_mm, mut direction_error, mut hits) = (0.0_f64, 0.0_f64, 0);
    for name in lenses {
        let wanted: Vec<&Vec<String>> = reference.iter().filter(|row| row[0] == name).collect();
        let (input, output) = (folder.path().join("rays.csv"), folder.path().join("hits.csv"));
        let header = "lens,x_mm,y_mm,z_mm,l,m,n,status".to_owned();
        let lines = wanted.iter().map(|row| row[..8].join(","));
        let content: Vec<String> = std::iter::once(header).chain(lines).collect();
        std::fs::write(&input, content.join("\n")).expect("written");
        good(&["lens", "trace", &lens(name), "--nd", "--rays", shown(&input), "-o", shown(&output)]);
        let result = std::fs::read_to_string(&output).expect("a result");
        let found = table(&result);
        assert_eq!(found.len(), wanted.len(), "{name}");
        for (row, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            let status = format!("{} {}", found[0], found[1]);
            assert_eq!(status.trim(), wanted[7], "{name}, row {row}");
            if found[0] != "hit" {
                assert!(found[2..8].iter().chain(&found[9..]).all(|field| field.is_empty()));
                continue;
            }
            hits += 1;
            for (found, wanted) in found[2..4].iter().zip(&wanted[8..10]) {
                point_error_mm = point_error_mm.max((number(found) - number(wanted)).abs());
            }
            for (found, wanted) in found[5..8].iter().zip(&wanted[10..13]) {
                direction_error = direction_error.max((number(found) - number(wanted)).abs());
            }
        }
    }
    assert_eq!(hits, 912);
    assert!(point_error_mm <= 1e-9, "{point_error_mm} mm");
    assert!(direction_error <= 1e-12, "{direction_error}");
}

#[test]
fn a_hit_lies_on_the_image_plane_in_the_frame_of_the_lens() {
    let name = lens("zeiss-biotar-50-f1.4");
    let info: serde_json::Value = serde_json::from_str(&good(&["lens", "info", &name, "--json"])).expect("JSON");
    let result = traced(&name, "x_mm,y_mm,z_mm,l,m,n\n0,0,-10,0,0,1\n0,5,-10,0,0,1\n", &["--nd"]);
    let found = table(&result);
    assert_eq!(found[0][..2], ["hit", ""]);
    assert_eq!([2, 3].map(|at| number(found[0][at])), [0.0, 0.0]);
    for row in &found {
        assert_eq!(Some(number(row[4])), info["total_track_mm"].as_f64());
        let [l, m, n] = [5, 6, 7].map(|at| number(row[at]));
        assert!((l * l + m * m + n * n - 1.0).abs() < 1e-14);
    }
    // In first order, focusing at 2 m moves the image plane by about f^2 / (2 m - f) from the plane that is sharp for infinity. Wide
    // open, the plane of best focus moves less, because of the spherical aberration at f/1.4.
    let [near, far] = ["2m", "inf"].map(|distance| {
        let options = ["--nd", "--focus", distance, "--focus-by", "paraxial"];
        number(table(&traced(&name, "x_mm,y_mm,z_mm,l,m,n\n0,0,-10,0,0,1\n", &options))[0][4])
    });
    let extension = near - far;
    assert!((1.2..1.3).contains(&extension), "{extension}");
}

/// A meridional ray through one plane surface follows Snell's law in closed form.
#[test]
fn a_plane_follows_snell() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("block.yaml");
    let block = "name: Block\nsurfaces:\n  - {kind: plane, thickness: 10, glass: SCHOTT/N-BK7, semi-diameter: 8}\n";
    std::fs::write(&file, block).expect("written");
    let (sine, n) = (0.5_f64, 1.516_800);
    let ray = format!("x_mm,y_mm,z_mm,l,m,n\n0,1,0,0,{sine:?},{:?}\n", (1.0 - sine * sine).sqrt());
    for options in [&["--nd"][..], &["--line", "d"]] {
        let result = traced(shown(&file), &ray, options);
        let row = &table(&result)[0];
        let inside = sine / n;
        // The glass's index at d is printed with six decimals.
        assert!((number(row[6]) - inside).abs() < 5e-7);
        let y = 1.0 + 10.0 * inside / (1.0 - inside * inside).sqrt();
        assert!((number(row[3]) - y).abs() < 1e-5 && number(row[4]) == 10.0);
    }
}

/// One wavelength per ray gives the same result as that wavelength for all rays, inside and outside the fitted band, for any
/// neighbors in the batch.
#[test]
fn wavelengths_per_ray_agree_with_one_for_all() {
    let name = "zeiss-biotar-50-f1.4";
    let lines = [("h", 404.6561), ("F", 486.1327), ("e", 546.074), ("C", 656.2725), ("t", 1013.98)];
    let mut all = String::from("wavelength_nm,n,m,l,z_mm,y_mm,x_mm\n");
    let mut alone = Vec::new();
    for (line, nm) in lines {
        alone.push(traced(name, "x_mm,y_mm,z_mm,l,m,n\n3,9,-5,0.02,-0.1,0.9947864091\n", &["--line", line]));
        all.push_str(&format!("{nm},0.9947864091,-0.1,0.02,-5,9,3\n"));
    }
    let together = traced(name, &all, &[]);
    let together = table(&together);
    let mut heights = Vec::new();
    for (row, alone) in together.iter().zip(&alone) {
        let alone = table(alone);
        for at in 2..8 {
            // n is fitted to 1e-9, which over about 50 mm of glass and air is less than 1e-6 mm.
            assert!((number(row[at]) - number(alone[0][at])).abs() < 1e-6, "{row:?} {alone:?}");
        }
        heights.push(number(row[3]));
    }
    // Lateral color is present: the colors do not meet.
    assert!(heights.windows(2).all(|pair| (pair[0] - pair[1]).abs() > 1e-4), "{heights:?}");
}

/// Micrometers under a heading in nanometers are refused; the message names the row and says what to write.
#[test]
fn micrometers_are_no_nanometers() {
    let output = trace("zeiss-biotar-50-f1.4", "x_mm,y_mm,z_mm,l,m,n,wavelength_nm\n0,1,-5,0,0,1,0.55\n", &[]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("wavelength_nm") && said.contains("0.55") && said.contains("550"), "{said}");
}

#[test]
fn an_f_number_clips_at_its_marginal_ray() {
    let name = "zeiss-biotar-50-f1.4";
    let info = good(&["lens", "info", name, "--f-number", "f/2.8", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&info).expect("JSON");
    assert!((info["f_number"].as_f64().expect("a number") - 2.8).abs() < 1e-9);
    let radius = info["entrance_pupil_diameter_mm"].as_f64().expect("a number") / 2.0;
    let rays = format!("x_mm,y_mm,z_mm,l,m,n\n0,{},0,0,0,1\n0,{},0,0,0,1\n", radius - 1e-6, radius + 1e-6);
    let result = traced(name, &rays, &["--line", "d", "--f-number", "f/2.8"]);
    let found = table(&result);
    assert_eq!(found[0][0], "hit");
    assert_eq!(found[1][..2], ["vignetted", "6"]);
    // Wide open, both rays pass.
    let open = traced(name, &rays, &["--line", "d"]);
    assert!(table(&open).iter().all(|row| row[0] == "hit"));
}

#[test]
fn json_lines_say_the_same() {
    let name = lens("cooke-triplet-50-f5");
    let rays = "x_mm,y_mm,z_mm,l,m,n\n0,1,-5,0,0,1\n0,500,-5,0,0,1\n";
    let (csv, json) = (traced(&name, rays, &["--nd"]), traced(&name, rays, &["--nd", "--json"]));
    let names: Vec<&str> = HEADER.split(',').collect();
    assert_eq!(json.lines().count(), 2);
    for (row, line) in table(&csv).iter().zip(json.lines()) {
        let object: serde_json::Value = serde_json::from_str(line).expect("JSON");
        for (name, field) in names.iter().zip(row) {
            match &object[*name] {
                serde_json::Value::Null => assert!(field.is_empty()),
                serde_json::Value::String(text) => assert_eq!(text, field),
                value => assert_eq!(value.as_f64(), Some(number(field))),
            }
        }
    }
}

#[test]
fn faults_in_the_table_name_file_row_and_column() {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("rays.csv"), folder.path().join("hits.csv"));
    let header = "x_mm,y_mm,z_mm,l,m,n\n";
    for (rays, options, place, word) in [
        (format!("{header}0,0,0,0,0,1\n0,0,0,0,zero,1\n"), &["--nd"][..], ":3:9: ", "column `m`: found `zero`"),
        (format!("{header}0,0,0,0,0,2\n"), &["--nd"], ":2:7: ", "expected a unit vector"),
        (format!("{header}0,0,0,0,0,0\n"), &["--nd"], ":2:7: ", "expected a unit vector"),
        (format!("{header}0,0,5,0,0,1\n"), &["--nd"], ":2:5: ", "the ray begins 5.000 mm behind the first surface"),
        (format!("{header}0,0,0,1e300,0,1e300\n"), &["--nd"], ":2:7: ", "expected a unit vector"),
        (format!("{header}0,0,0,0,0,1\n"), &[], ":1:1: ", "`wavelength_nm` is missing"),
        (
            "wavelength_nm,x_mm,y_mm,z_mm,l,m,n\n-5,0,0,0,0,0,1\n".to_owned(),
            &[],
            ":2:1: ",
            "expected a positive number",
        ),
        ("wavelength_nm,x_mm,y_mm,z_mm,l,m,n\n90,0,0,0,0,0,1\n".to_owned(), &[], ":2:1: ", "no refractive index"),
        ("x,y\n".to_owned(), &["--nd"], ":1:1: ", "`x_mm`"),
        (String::new(), &["--nd"], ":1:1: ", "the file is empty"),
    ] {
        std::fs::write(&input, &rays).expect("written");
        let mut arguments =
            vec!["lens", "trace", "zeiss-biotar-50-f1.4", "--rays", shown(&input), "-o", shown(&output)];
        arguments.extend(options);
        let result = run(&arguments);
        let message = text(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{rays}: {message}");
        assert!(message.contains(&format!("{}{place}", shown(&input))) && message.contains(word), "{rays}: {message}");
        assert!(!output.exists(), "a partial result was written");
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "a temporary file was left");
}

#[test]
fn nearly_unit_directions_are_scaled() {
    let name = lens("helios-44-58-f2");
    let rays = "x_mm,y_mm,z_mm,l,m,n\n1,2,-3,0,0.28,0.96\n1,2,-3,0,0.2800002,0.9600003\n";
    let result = traced(&name, rays, &["--nd"]);
    let found = table(&result);
    for at in 2..8 {
        assert!((number(found[0][at]) - number(found[1][at])).abs() < 1e-4);
    }
}

#[test]
fn a_ray_along_the_image_plane_misses_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("nothing.yaml");
    std::fs::write(&file, "name: Only a plane\nsurfaces:\n  - {kind: stop, thickness: 10}\n").expect("written");
    let result = traced(shown(&file), "x_mm,y_mm,z_mm,l,m,n\n0,0,-1,0,1,0\n", &["--nd"]);
    assert_eq!(table(&result)[0][..2], ["missed", "1"]);
}

/// More rays than a batch holds, sent through a pipe, come out in the same number and order.
#[test]
fn many_rays_keep_their_order() {
    let name = lens("cooke-triplet-50-f5");
    let mut rays = String::from("x_mm,y_mm,z_mm,l,m,n\n");
    let count = 5000;
    for i in 0..count {
        rays.push_str(&format!("0,{:?},-5,0,0,1\n", f64::from(i) * 0.001));
    }
    let result = traced(&name, &rays, &["--nd"]);
    let found = table(&result);
    assert_eq!(found.len(), count as usize);
    // The rays turn toward the axis, more strongly the higher they entered.
    assert!(found.windows(2).all(|pair| number(pair[0][6]) > number(pair[1][6])));
}

/// An uncoated plate of index 1.5 has Fresnel's transmittance at both faces and the optical path index times length, in closed form.
/// Every surface has its row.
#[test]
fn transmittance_and_optical_path_are_those_of_a_plate() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("plate.yaml");
    let plate = "name: Plate\ncoating: bare\nsurfaces:\n  - {kind: plane, thickness: 10, glass: {nd: 1.5}, semi-diameter: 30}\n  \
                 - {kind: plane, thickness: 20, semi-diameter: 30}\n";
    std::fs::write(&file, plate).expect("written");
    let n = 1.5_f64;
    for sine in [0.0_f64, 0.3, 0.8] {
        let (cosine, inside) = ((1.0 - sine * sine).sqrt(), (1.0 - sine * sine / n / n).sqrt());
        let rays = format!("x_mm,y_mm,z_mm,l,m,n\n0,0,-5,0,{sine:?},{cosine:?}\n");
        let result = traced(shown(&file), &rays, &["--nd"]);
        let row = &table(&result)[0];
        let [s, p] = [(cosine, n * inside), (n * cosine, inside)].map(|(a, b)| 1.0 - ((a - b) / (a + b)).powi(2));
        // Unpolarized light at each face: the mean of both polarizations.
        let transmittance = (0.5 * (s + p)).powi(2);
        let path = 5.0 / cosine + n * 10.0 / inside + 20.0 / cosine;
        assert!((number(row[9]) - transmittance).abs() < 1e-9, "{row:?} {transmittance}");
        assert!((number(row[10]) - path).abs() < 1e-9, "{row:?} {path}");
        assert!((number(row[8]) - 587.56).abs() < 0.01, "{row:?}");

        let every = traced(shown(&file), &rays, &["--nd", "--every-surface"]);
        let every: Vec<Vec<&str>> = every.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(every[0].join(","), format!("ray,{HEADER}"));
        assert_eq!([1, 2, 3].map(|i| every[i][..3].join(",")), ["1,passed,1", "1,passed,2", "1,hit,"]);
        assert_eq!(every[3][1..], row[..]);
        let heights = [5.0 * sine / cosine, 5.0 * sine / cosine + 10.0 * sine / n / inside];
        for (row, (z, y)) in every[1..3].iter().zip([0.0, 10.0].into_iter().zip(heights)) {
            assert!((number(row[5]) - z).abs() < 1e-12 && (number(row[4]) - y).abs() < 1e-9, "{row:?}");
        }
        // Inside the glass, after one face.
        assert!((number(every[1][10]) - 0.5 * (s + p)).abs() < 1e-9 && (number(every[1][7]) - sine / n).abs() < 1e-12);
        assert!((number(every[1][11]) - 5.0 / cosine).abs() < 1e-12);
    }
}

/// A ray that ends has rows for the surfaces up to that point; a wavelength outside the band is traced with the same columns.
#[test]
fn every_surface_is_told_up_to_the_end() {
    let name = "zeiss-biotar-50-f1.4";
    let rays = "x_mm,y_mm,z_mm,l,m,n,wavelength_nm\n0,1,-5,0,0,1,546.1\n0,17.5,-5,0,0.2,0.9797958971132712,546.1\n0,1,-5,0,0,1,1000\n";
    let result = traced(name, rays, &["--every-surface"]);
    let rows: Vec<Vec<&str>> = result.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let of = |ray: &str| rows.iter().filter(|row| row[0] == ray).collect::<Vec<_>>();
    let (first, second, third) = (of("1"), of("2"), of("3"));
    assert_eq!((first.len(), first[0][1], first[first.len() - 1][1]), (third.len(), "passed", "hit"));
    let (last, before) = second.split_last().expect("rows");
    assert!(last[1] == "vignetted" && last[2] == (before.len() + 1).to_string(), "{second:?}");
    assert!(third.iter().all(|row| row[9] == "1000.0") && first.iter().all(|row| row[9] == "546.1"));
    // Each surface can only reduce the light.
    assert!(first.windows(2).all(|pair| number(pair[1][10]) <= number(pair[0][10])) && number(first[0][10]) < 1.0);
    assert!(first.windows(2).all(|pair| number(pair[1][11]) > number(pair[0][11])));
}
