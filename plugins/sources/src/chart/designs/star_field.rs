use super::super::drawing::Drawing;
use super::super::ink::Ink;
use super::super::shape::Ring;

const STARS: usize = 600;
/// From the brightest to the faintest.
const MAGNITUDES: f64 = 3.5;
/// Radius of the brightest, mm on a chart 1500 mm wide.
const RADIUS_MM: f64 = 2.2;
/// Least distance between two, mm.
const APART_MM: f64 = 12.0;

/// Stars of equal radiance, so that their light goes with their area. There are 10^0.6 times as many of each
/// fainter magnitude, as among stars spread evenly through space.
pub fn star_field(seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, 1000.0, Ink::Gray(0.0));
    let tints = [[1.0, 1.0, 1.0], [0.8, 0.88, 1.0], [1.0, 0.95, 0.84], [1.0, 0.85, 0.68]];
    let mut random = SplitMix(seed);
    let mut placed: Vec<[f64; 2]> = Vec::with_capacity(STARS);
    while placed.len() < STARS {
        let center = [(random.unit() - 0.5) * 1480.0, (random.unit() - 0.5) * 980.0];
        // Cumulative counts 10^(0.6 m), inverted.
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

/// Random numbers by G. L. Steele, D. Lea and C. H. Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014.
struct SplitMix(u64);

impl SplitMix {
    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
