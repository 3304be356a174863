//! Finds how far around a ray of the pilot there is light that reaches the same block.
//!
//! A block may be known from few rays, and the next ray that reaches it does not enter exactly where one of them did. Where the pilot saw
//! nothing of the block, the picture would have few rays, and each would weigh many times as much as the others. Without correction, a
//! quarter of a picture's rays in such a block came in where the search had seen none, and caused four fifths of its variance. Four fifths
//! of the weight of a ray are therefore shared with eight places around it. They are as far away as the rays that reached the same block
//! are spread, and closer if many of these rays describe its shape.

use super::pilot_hit::PilotHit;

/// Fraction that goes to each of eight places around a ray; the rest stays.
const SHARE: f64 = 0.1;
/// Offsets of the eight places: four at this fraction of the two vectors, and four at the corners between them.
const NEAR: f64 = 0.6;
/// Length of the vectors, in standard deviations, if few rays are known. With more rays the places are nearer.
const WIDTH: f64 = 1.2;
/// Number of rays up to which the vectors have their full length.
const FEW: f64 = 80.0;
/// Number of rays up to which their spread is not known.
const LEAST: f64 = 3.0;

/// Returns the offsets of a ray's place and of the eight around it, with the fraction of its weight that each gets.
pub(super) fn parts([a, b]: [[f64; 2]; 2]) -> [([f64; 2], f64); 9] {
    let at = |along: f64, across: f64| ([along * a[0] + across * b[0], along * a[1] + across * b[1]], SHARE);
    let [n, s, e, w] = [at(NEAR, 0.0), at(-NEAR, 0.0), at(0.0, NEAR), at(0.0, -NEAR)];
    [([0.0; 2], 1.0 - 8.0 * SHARE), n, s, e, w, at(1.0, 1.0), at(1.0, -1.0), at(-1.0, 1.0), at(-1.0, -1.0)]
}

/// Returns two vectors for each ray, in units of places.
pub(super) fn around(seen: &[PilotHit]) -> Vec<[[f64; 2]; 2]> {
    // Order the rays by zone and block.
    let mut order: Vec<u32> = (0..seen.len() as u32).collect();
    let of = |number: &u32| (seen[*number as usize].zone, seen[*number as usize].block);
    order.sort_by_key(of);
    let mut around = vec![[[0.0; 2]; 2]; seen.len()];
    for numbers in order.chunk_by(|a, b| of(a) == of(b)) {
        let own = ways(numbers.iter().map(|number| &seen[*number as usize]));
        for number in numbers {
            let alone = || {
                // The mean distance between rays there.
                let away = 1.0 / seen[*number as usize].aim.density.sqrt();
                [[away, away], [-away, away]]
            };
            around[*number as usize] = own.unwrap_or_else(alone);
        }
    }
    around
}

/// Returns the vectors given by the spread of some rays: the columns of the Cholesky factor of their covariance. `None` for few rays.
fn ways<'a>(rays: impl Iterator<Item = &'a PilotHit>) -> Option<[[f64; 2]; 2]> {
    let (mut many, mut squares, mut first, mut second) = (0.0, 0.0, [0.0; 2], [0.0; 3]);
    for PilotHit { aim, .. } in rays {
        // The area of the front that the ray stands for.
        let (area, [x, y]) = (1.0 / aim.density, aim.place);
        many += area;
        squares += area * area;
        first.iter_mut().zip([x, y]).for_each(|(sum, value)| *sum += area * value);
        second.iter_mut().zip([x * x, x * y, y * y]).for_each(|(sum, value)| *sum += area * value);
    }
    let [x, y] = first.map(|sum| sum / many);
    let [xx, xy, yy] = second.map(|sum| sum / many);
    let across = (xx - x * x).max(0.0).sqrt();
    let alike = many * many / squares;
    if !(alike > LEAST && across > 0.0) {
        return None;
    }
    let along = (xy - x * y) / across;
    let up = (yy - y * y - along * along).max(0.0).sqrt();
    let width = WIDTH * (FEW / alike).sqrt().min(1.0);
    Some([[width * across, width * along], [0.0, width * up]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ghosts::guide::Aim;
    use crate::ghosts::pilot_hit::Contribution;
    use spectra_core::numbers::Numbers;

    fn seen(block: usize, place: [f64; 2]) -> PilotHit {
        PilotHit { zone: 0, aim: Aim { place, density: 1e4 }, block, brought: Contribution { all: 1.0, judged: 1.0 } }
    }

    /// A sliver at 45 degrees, 0.2 long and 0.002 wide: a uniform distribution over a length has that length over the root of 12 as its
    /// standard deviation. The test checks this along and across, whatever rays of other blocks lie between.
    #[test]
    fn the_places_around_lie_along_what_a_block_is_lit_through() {
        let numbers = Numbers::sobol(7);
        let on = |length: f64, i: u64| {
            let along = length * (numbers.one(1, i, 0) - 0.5);
            let across = 0.01 * length * (numbers.one(1, i, 1) - 0.5);
            let half = 0.5_f64.sqrt();
            [0.3 + half * (along - across), -0.1 + half * (along + across)]
        };
        for (many, width) in [(64, 1.2), (2000, 0.24)] {
            let both = |i: u64| [seen(1, on(0.2, i)), seen(2, on(0.7, i))];
            let all: Vec<PilotHit> = (0..many).flat_map(both).collect();
            let around = around(&all);
            for (at, length) in [(0, 0.2), (1, 0.7)] {
                // The covariance of the two vectors.
                let [a, b] = around[at];
                let along = (a[0] + a[1]).powi(2) + (b[0] + b[1]).powi(2);
                let across = (a[0] - a[1]).powi(2) + (b[0] - b[1]).powi(2);
                let want = width * length / 12_f64.sqrt();
                assert!(((0.5 * along).sqrt() / want - 1.0).abs() < 0.05, "{many} {along} {want}");
                assert!(((0.5 * across).sqrt() / (0.01 * want) - 1.0).abs() < 0.05, "{many} {across} {want}");
            }
        }
    }

    /// The fractions sum to 1, and their mean place is the ray's.
    #[test]
    fn the_parts_are_all_of_it() {
        let parts = parts([[0.3, 0.1], [-0.2, 0.5]]);
        let sum = |of: fn(&([f64; 2], f64)) -> f64| parts.iter().map(of).sum::<f64>();
        assert!((sum(|part| part.1) - 1.0).abs() < 1e-15);
        assert!(sum(|part| part.0[0] * part.1).abs() < 1e-15 && sum(|part| part.0[1] * part.1).abs() < 1e-15);
    }

    /// Rays whose spread is unknown use the mean distance between rays.
    #[test]
    fn few_rays_stay_near() {
        let alone = [seen(0, [0.1, 0.2]), seen(0, [0.5, -0.2]), seen(3, [0.0, 0.0])];
        assert_eq!(around(&alone), [[[0.01, 0.01], [-0.01, 0.01]]; 3]);
        // All rays in one place.
        assert_eq!(around(&[seen(0, [0.25, 0.5]); 8]), [[[0.01, 0.01], [-0.01, 0.01]]; 8]);
    }
}
