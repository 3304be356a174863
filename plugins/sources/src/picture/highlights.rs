//! Estimates the light of clipped highlights in pictures of 8 or 16 bits.
//!
//! A pixel with a channel at the top of its range was at least that bright; the file does not tell how much brighter. The rule models
//! a lamp or a reflection: brightest at its center, and the brighter the larger its clipped area, since glare and blur widen light far
//! beyond white. Let d be the distance (pixels) to the nearest pixel that is not clipped. All channels are multiplied by
//! 2^(stops d / (d + 4)). This gain rises without a step from the rim, reaches half of the stops 4 pixels inside, and never
//! exceeds `stops`. Pixels that are not clipped keep their values.

use spectra_core::math;

/// Distance from the rim at which half of the stops are reached, pixels.
const REACH: f64 = 4.0;

/// Multiplies clipped pixels according to the rule. Pixels are in rows of `width`, clipped from the value `clipped_at` on.
pub(super) fn recover(rgb: &mut [[f32; 3]], width: usize, clipped_at: f32, stops: f64) {
    let clipped: Vec<bool> = rgb.iter().map(|p| p.iter().any(|v| *v >= clipped_at)).collect();
    if !clipped.contains(&true) {
        return;
    }
    for (pixel, squared) in rgb.iter_mut().zip(squared_distances(&clipped, width)) {
        if squared > 0.0 {
            let d = squared.sqrt();
            let gain = math::exp(std::f64::consts::LN_2 * stops * d / (d + REACH)) as f32;
            *pixel = pixel.map(|v| v * gain);
        }
    }
}

/// Computes the squared distance, pixels^2, from each pixel to the nearest one that is not marked: exactly, in linear time
/// (P. Felzenszwalb and D. Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 8, 2012). If all pixels are
/// marked, it is the distance to the first pixel beyond the rim of the picture.
fn squared_distances(marked: &[bool], width: usize) -> Vec<f64> {
    let height = marked.len() / width;
    let everywhere = marked.iter().all(|m| *m);
    // Farther than any pixel of the picture is from another.
    let far = ((width * width + height * height) as f64) * 4.0;
    let mut all: Vec<f64> = marked.iter().map(|m| if *m { far } else { 0.0 }).collect();
    if everywhere {
        for (i, value) in all.iter_mut().enumerate() {
            let (column, row) = (i % width, i / width);
            let rim = (column + 1).min(width - column).min(row + 1).min(height - row) as f64;
            *value = rim * rim;
        }
        return all;
    }
    let mut line = vec![0.0; height];
    for column in 0..width {
        (0..height).for_each(|row| line[row] = all[row * width + column]);
        let done = envelope(&line);
        (0..height).for_each(|row| all[row * width + column] = done[row]);
    }
    for row in all.chunks_mut(width) {
        let done = envelope(row);
        row.copy_from_slice(&done);
    }
    all
}

/// Computes, for each q, the minimum of f(p) + (q - p)^2 over p: the lower envelope of parabolas.
fn envelope(f: &[f64]) -> Vec<f64> {
    let meet = |p: usize, q: usize| {
        let (a, b) = (p as f64, q as f64);
        ((f[q] + b * b) - (f[p] + a * a)) / (2.0 * (b - a))
    };
    let mut parabolas: Vec<(usize, f64)> = vec![(0, f64::NEG_INFINITY)];
    for q in 1..f.len() {
        while let Some(&(p, from)) = parabolas.last() {
            let at = meet(p, q);
            if at > from || parabolas.len() == 1 {
                parabolas.push((q, at));
                break;
            }
            parabolas.pop();
        }
    }
    let mut k = 0;
    let value = |q: usize| {
        while k + 1 < parabolas.len() && parabolas[k + 1].1 < q as f64 {
            k += 1;
        }
        let p = parabolas[k].0;
        let d = q as f64 - p as f64;
        f[p] + d * d
    };
    (0..f.len()).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disk(radius: f64, width: usize) -> Vec<[f32; 3]> {
        let middle = width as f64 / 2.0 - 0.5;
        let at = |i: usize| ((i % width) as f64 - middle, (i / width) as f64 - middle);
        (0..width * width)
            .map(|i| {
                let (x, y) = at(i);
                let inside = x * x + y * y <= radius * radius;
                if inside { [1.0, 0.9, 0.8] } else { [0.5 + 0.4 * (i % 3) as f32 / 3.0, 0.3, 0.2] }
            })
            .collect()
    }

    #[test]
    fn distances_are_those_of_all_pairs() {
        let (width, height) = (13, 9);
        let marked: Vec<bool> = (0..width * height).map(|i| (i * 7919) % 11 > 1).collect();
        let fast = squared_distances(&marked, width);
        for i in 0..marked.len() {
            let slow = (0..marked.len()).filter(|j| !marked[*j]).map(|j| {
                let (x, y) = ((i % width).abs_diff(j % width), (i / width).abs_diff(j / width));
                (x * x + y * y) as f64
            });
            assert_eq!(fast[i], slow.fold(f64::INFINITY, f64::min), "{i}");
        }
    }

    /// Highlights rise toward their centers, and pixels below white do not change. Energy grows by no more than the stops, and
    /// larger highlights become brighter.
    #[test]
    fn highlights_rise_toward_their_middle_and_nothing_else_changes() {
        let (width, stops) = (41, 3.0);
        let sum = |p: &[[f32; 3]]| p.iter().flatten().map(|v| f64::from(*v)).sum::<f64>();
        let mut peak_before = 1.0;
        for radius in [0.8, 2.0, 5.0, 12.0] {
            let before = disk(radius, width);
            let mut after = before.clone();
            recover(&mut after, width, 1.0, stops);
            for (a, b) in before.iter().zip(&after) {
                let gain = b[0] / a[0];
                assert!(if a[0] < 1.0 { a == b } else { gain > 1.0 && f64::from(gain) < 8.0 }, "{a:?} {b:?}");
                assert!((b[2] / a[2] - gain).abs() < 1e-6);
            }
            let row = &after[width / 2 * width..][..width];
            let inside: Vec<f32> = row[width / 2..].iter().map(|p| p[0]).take_while(|v| *v >= 1.0).collect();
            assert!(inside.windows(2).all(|w| w[0] >= w[1]), "{inside:?}");
            let (a, b) = (sum(&before), sum(&after));
            assert!(b > a && b < 8.0 * a);
            let peak = after.iter().fold(0.0_f32, |m, p| m.max(p[0]));
            assert!(peak > peak_before);
            peak_before = peak;
        }
    }

    #[test]
    fn a_picture_that_is_clipped_everywhere_stays_finite() {
        let mut all = vec![[1.0_f32; 3]; 20];
        recover(&mut all, 5, 1.0, 2.0);
        assert!(all.iter().flatten().all(|v| *v > 1.0 && *v < 4.0));
    }
}
