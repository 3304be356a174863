use super::super::drawing::Drawing;
use super::super::ink::Ink;
use super::super::shape::Ring;
use spectra_core::numbers::SplitMix64;

const STARS: usize = 600;
/// Range of magnitudes from the brightest to the faintest star.
const MAGNITUDES: f64 = 3.5;
/// Radius of the brightest star, mm on a chart 1500 mm wide.
const RADIUS_MM: f64 = 2.2;
/// Smallest distance between two stars, mm.
const APART_MM: f64 = 12.0;

/// Draws stars of equal radiance, so that their light is proportional to their area. Each fainter magnitude has 10^0.6 times as
/// many stars, as for stars spread evenly through space.
pub fn star_field(seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, 1000.0, Ink::Gray(0.0));
    let tints = [[1.0, 1.0, 1.0], [0.8, 0.88, 1.0], [1.0, 0.95, 0.84], [1.0, 0.85, 0.68]];
    let mut random = SplitMix64::new(seed);
    let mut placed: Vec<[f64; 2]> = Vec::with_capacity(STARS);
    while placed.len() < STARS {
        let center = [(random.unit() - 0.5) * 1480.0, (random.unit() - 0.5) * 980.0];
        // Inverse of the cumulative counts 10^(0.6 m).
        let magnitude = MAGNITUDES + libm::log10(1.0 - random.unit()).max(-0.6 * MAGNITUDES) / 0.6;
        let tint = tints[(random.unit() * 4.0) as usize];
        let far = |p: &[f64; 2]| {
            let [dx, dy] = [p[0] - center[0], p[1] - center[1]];
            dx * dx + dy * dy > APART_MM * APART_MM
        };
        if placed.iter().all(far) {
            placed.push(center);
            drawing.add(Ring::disk(center, RADIUS_MM * libm::pow(10.0, -0.2 * magnitude)), Ink::Rgb(tint));
            drawing.mark(format!("star of magnitude {magnitude:.2}"), center, APART_MM - RADIUS_MM);
        }
    }
    drawing
}
