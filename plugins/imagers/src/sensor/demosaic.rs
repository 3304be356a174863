//! Demosaicing, from one color per pixel to three: H. S. Malvar, L. He, R. Cutler, "High-quality linear interpolation for
//! demosaicing of Bayer-patterned color images", ICASSP 2004.

use super::pattern::Pattern;

/// Interpolates the missing colors of a Bayer mosaic. `values` holds one value per pixel, row by row; the result is red, green
/// and blue of each pixel. Without filters, all three equal the value of the pixel.
#[must_use]
pub fn demosaic(values: &[f32], width: usize, height: usize, pattern: Pattern) -> Vec<[f32; 3]> {
    if pattern == Pattern::Monochrome {
        return values.iter().map(|v| [*v; 3]).collect();
    }
    // Mirror the picture about its edge pixels, which preserves the filter pattern.
    let reflect = |at: i64, len: usize| {
        let last = len as i64 - 1;
        let at = at.abs();
        (if at > last { (2 * last - at).max(0) } else { at }) as usize
    };
    let at = |column: i64, row: i64| values[reflect(row, height) * width + reflect(column, width)];
    let mut out = Vec::with_capacity(values.len());
    for row in 0..height as i64 {
        for column in 0..width as i64 {
            let p = |dx: i64, dy: i64| at(column + dx, row + dy);
            let own = pattern.channel(column as u32, row as u32);
            let here = p(0, 0);
            let near_x = p(-1, 0) + p(1, 0);
            let near_y = p(0, -1) + p(0, 1);
            let far_x = p(-2, 0) + p(2, 0);
            let far_y = p(0, -2) + p(0, 2);
            let corners = p(-1, -1) + p(1, -1) + p(-1, 1) + p(1, 1);
            let mut rgb = [here; 3];
            if own == 1 {
                // Interpolate the color of the neighbors in the row, then of those in the column.
                let in_row = (5.0 * here + 4.0 * near_x - corners - far_x + 0.5 * far_y) / 8.0;
                let in_column = (5.0 * here + 4.0 * near_y - corners - far_y + 0.5 * far_x) / 8.0;
                let row_color = pattern.channel(column as u32 + 1, row as u32) as usize;
                rgb[row_color] = in_row;
                rgb[2 - row_color] = in_column;
            } else {
                rgb[1] = (4.0 * here + 2.0 * (near_x + near_y) - far_x - far_y) / 8.0;
                rgb[2 - own as usize] = (6.0 * here + 2.0 * corners - 1.5 * (far_x + far_y)) / 8.0;
            }
            out.push(rgb);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The filters sum to 1 and reproduce linear functions: a ramp in which the colors differ by constants is restored
    /// exactly, except at the edges.
    #[test]
    fn ramps_of_constant_hue_come_back() {
        let (width, height) = (12, 10);
        use super::super::PatternName as Name;
        for pattern in [Name::Rggb, Name::Bggr, Name::Grbg, Name::Gbrg].map(Name::pattern) {
            let value =
                |c: usize, r: usize, color: usize| 3.0 + 0.5 * c as f32 - 0.25 * r as f32 + [0.0, 2.0, 5.0][color];
            let mosaic: Vec<f32> = (0..width * height)
                .map(|i| value(i % width, i / width, pattern.channel((i % width) as u32, (i / width) as u32) as usize))
                .collect();
            let rgb = demosaic(&mosaic, width, height, pattern);
            for row in 2..height - 2 {
                for column in 2..width - 2 {
                    for color in 0..3 {
                        let (got, want) = (rgb[row * width + column][color], value(column, row, color));
                        assert!((got - want).abs() < 1e-5, "{pattern:?} {column} {row} {color}: {got} {want}");
                    }
                }
            }
        }
    }
}
