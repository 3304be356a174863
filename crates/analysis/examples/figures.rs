//! Writes spectrum plots and a chromaticity diagram to the given folder (default: the current one).

use spectra_analysis::figure;
use spectra_color::{chromaticity, xyz_of_light};
use spectra_spectrum::{AnySpectrum, Observer, find};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let load = |name: &str| find(name).map(|found| (name.to_owned(), found));
    figure::spectrum(&[load("D65")?]).write(&folder.join("d65.png"))?;
    figure::spectrum(&[load("mercury")?]).write(&folder.join("mercury.png"))?;
    let lights = [load("A")?, load("D65")?, load("FL11")?, load("line:C'")?];
    figure::spectrum(&lights).write(&folder.join("lights.png"))?;
    let mut points = Vec::new();
    for name in ["A", "D65", "FL11", "LED-B3", "line:C'", "gaussian:550,20"] {
        if let (name, AnySpectrum::Emission(light)) = load(name)? {
            let xy = xyz_of_light(&light, Observer::cie_1931_2deg()).and_then(chromaticity);
            points.extend(xy.map(|xy| (name, xy)));
        }
    }
    let diagram = figure::chromaticity(&points);
    diagram.write(&folder.join("chromaticity.png"))?;
    diagram.write(&folder.join("chromaticity.svg"))?;
    Ok(())
}
