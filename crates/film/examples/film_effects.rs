//! Measures the time that halation, scatter, adjacency and grain take on a frame, and writes example pictures: `film_effects FOLDER
//! [MEGAPIXELS]`.

use spectra_film::adjacency::{Adjacency, Edges};
use spectra_film::grain::Grain;
use spectra_film::halation::{Halation, HalationBase};
use spectra_film::raster::Raster;
use spectra_film::scatter::{Mtf, Scatter};
use std::path::Path;
use std::time::Instant;

const BASE: HalationBase =
    HalationBase { thickness_mm: 0.125, index: 1.48, entering: 0.3, transmittance: 0.9, reflected: 0.3 };

fn save(folder: &Path, name: &str, width: usize, height: usize, value: impl Fn(usize) -> f64) {
    let pixel =
        |x: u32, y: u32| image::Luma([(value(y as usize * width + x as usize) * 255.0).clamp(0.0, 255.0) as u8]);
    let picture = image::GrayImage::from_fn(width as u32, height as u32, pixel);
    let path = folder.join(name);
    match picture.save(&path) {
        Ok(()) => println!("{}", path.display()),
        Err(error) => eprintln!("{}: {error}", path.display()),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = Path::new(arguments.get(1).map_or(".", String::as_str));
    let grain = Grain::calibrated(17.0, 35.0, 1, 0)?;
    for pitch_um in [0.25, 1.0, 3.0, 6.0, 7.3, 24.0] {
        // An even gray and steps of density, at this pixel size.
        let (width, height) = (512, 384);
        let mut plane: Vec<f32> = (0..width * height)
            .map(|k| if k / width < 256 { 0.8 } else { 0.1 + 0.25 * (k % width / 64) as f32 })
            .collect();
        grain.apply(&mut plane, &Raster::new(width, height, pitch_um / 1e3));
        save(folder, &format!("grain-{pitch_um}um.png"), width, height, |k| 10_f64.powf(-f64::from(plane[k]) / 2.2));
    }
    // Lamps on a dark street: points, a disk, a bar.
    let (width, height) = (900, 600);
    let raster = Raster::new(width, height, 0.006);
    let mut street = vec![0.02_f32; raster.pixels()];
    for (k, v) in street.iter_mut().enumerate() {
        let (x, y) = ((k % width) as f64, (k / width) as f64);
        let near = |cx: f64, cy: f64, r: f64| (x - cx) * (x - cx) + (y - cy) * (y - cy) < r * r;
        if near(200.0, 200.0, 2.0) || near(450.0, 420.0, 6.0) || near(700.0, 150.0, 25.0) {
            *v = 300.0;
        }
        if x > 600.0 && x < 880.0 && y > 450.0 && y < 453.0 {
            *v = 100.0;
        }
    }
    Scatter::new(&Mtf::frieser(0.0147)?, &raster)?.apply(&mut street);
    Halation::new(&BASE, &raster)?.apply(&mut street);
    save(folder, "halation.png", width, height, |k| (f64::from(street[k]) / (f64::from(street[k]) + 0.5)).powf(0.6));
    let megapixels: f64 = arguments.get(2).map_or(Ok(2.0), |a| a.parse())?;
    let width = (megapixels * 1e6 * 1.5).sqrt().round() as usize;
    let raster = Raster::new(width, width * 2 / 3, 36.0 / width as f64);
    let mut total = 0.0;
    let mut timed = |what: &str, work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        let seconds = start.elapsed().as_secs_f64();
        total += seconds;
        println!("{what}: {seconds:.2} s, {:.1} ns a pixel", seconds * 1e9 / raster.pixels() as f64);
    };
    let mut planes: Vec<Vec<f32>> =
        (0..3).map(|l| (0..raster.pixels()).map(|k| ((k * 7919 + l) % 1013) as f32 / 700.0).collect()).collect();
    for (layer, plane) in planes.iter_mut().enumerate() {
        let (mut scatter, mut halation, mut edges, mut grain) = (None, None, None, None);
        timed("prepare", &mut || {
            scatter = Mtf::frieser(0.0147).and_then(|mtf| Scatter::new(&mtf, &raster)).ok();
            halation = Halation::new(&BASE, &raster).ok();
            edges = Some(Edges::new(&Adjacency { gain: 0.2, length_mm: 0.035 }, &raster));
            grain = Grain::calibrated(17.0, 35.0, 1, layer as u32).ok();
        });
        let (Some(scatter), Some(halation), Some(edges), Some(grain)) = (scatter, halation, edges, grain) else {
            return Err("an effect has bad values".into());
        };
        timed("scatter", &mut || scatter.apply(plane));
        timed("halation", &mut || halation.apply(plane));
        timed("adjacency", &mut || edges.apply(plane, 0.0, (0.0, 2.5)));
        timed("grain", &mut || grain.apply(plane, &raster));
    }
    println!("{} pixels, 3 layers: {total:.1} s on {} threads", raster.pixels(), rayon::current_num_threads());
    Ok(())
}
