//! Turns pictures that are stored on their side or upside down.
//!
//! TIFF 6.0, `Orientation`, says which sides of the picture the first stored row and the first stored column are: 1 top left, 2 top right,
//! 3 bottom right, 4 bottom left, 5 left top, 6 right top, 7 right bottom, 8 left bottom.

/// Returns whether rows of the picture are stored as columns.
pub(super) fn is_on_its_side(orientation: u8) -> bool {
    (5..=8).contains(&orientation)
}

/// Returns width over height of a pixel as the picture is seen, from that of a stored pixel.
pub(super) fn seen_aspect(stored: Option<f64>, turned: bool) -> f64 {
    stored.map_or(1.0, |aspect| if turned { 1.0 / aspect } else { aspect })
}

/// Returns the stored index of pixel `i` of the upright picture; both are row by row. `width` and `height` are those of the stored picture.
pub(super) fn stored(i: usize, [width, height]: [usize; 2], orientation: u8) -> usize {
    let columns = if is_on_its_side(orientation) { height } else { width };
    let (last_column, last_row) = (width - 1, height - 1);
    let (x, y) = (i % columns, i / columns);
    let [column, row] = match orientation {
        2 => [last_column - x, y],
        3 => [last_column - x, last_row - y],
        4 => [x, last_row - y],
        5 => [y, x],
        6 => [y, last_row - x],
        7 => [last_column - y, last_row - x],
        8 => [last_column - y, x],
        _ => [x, y],
    };
    row * width + column
}

/// Reorders the pixels of a stored picture in place into the order in which they are seen.
/// Follows each cycle of the permutation once. A negative sign of a pixel's first value, which is otherwise 0 or more, marks a finished
/// pixel.
pub(super) fn upright<const N: usize>(pixels: &mut [[f32; N]], size: [usize; 2], orientation: u8) {
    if !(2..=8).contains(&orientation) {
        return;
    }
    let unmarked = |pixel: &mut [f32; N]| pixel[0] = pixel[0].abs();
    pixels.iter_mut().for_each(unmarked);
    for start in 0..pixels.len() {
        let first = pixels[start];
        let mut to = start;
        while pixels[to][0].is_sign_positive() {
            let from = stored(to, size, orientation);
            pixels[to] = if from == start { first } else { pixels[from] };
            pixels[to][0] = -pixels[to][0];
            to = from;
        }
    }
    pixels.iter_mut().for_each(unmarked);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// TIFF 6.0, page 36: where the first stored corner is seen, and in which direction its row continues.
    #[test]
    fn corners_come_to_lie_where_tiff_says() {
        for (orientation, want) in [
            (1, [1, 2, 3, 4, 5, 6]),
            (2, [3, 2, 1, 6, 5, 4]),
            (3, [6, 5, 4, 3, 2, 1]),
            (4, [4, 5, 6, 1, 2, 3]),
            (5, [1, 4, 2, 5, 3, 6]),
            (6, [4, 1, 5, 2, 6, 3]),
            (7, [6, 3, 5, 2, 4, 1]),
            (8, [3, 6, 2, 5, 1, 4]),
        ] {
            // Three columns, two rows.
            let mut pixels = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0].map(|value| [value, -value]);
            upright(&mut pixels, [3, 2], orientation);
            assert_eq!(pixels, want.map(|value| [value as f32, -(value as f32)]), "{orientation}");
        }
    }

    #[test]
    fn black_of_either_sign_is_moved_too() {
        let mut pixels = [[0.0_f32], [-0.0], [3.0], [0.0]];
        upright(&mut pixels, [4, 1], 3);
        assert_eq!(pixels.map(|[value]| value.to_bits()), [0.0_f32, 3.0, 0.0, 0.0].map(f32::to_bits));
    }
}
