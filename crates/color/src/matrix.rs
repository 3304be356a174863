//! Functions for 3 x 3 matrices, stored by rows.

/// A 3 x 3 matrix, stored by rows.
pub type Matrix = [[f64; 3]; 3];

/// Multiplies the matrix `m` by the column `v`.
#[must_use]
pub fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Multiplies two matrices: the product applies `b` first, then `a`.
#[must_use]
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// Inverts a matrix by cofactors; the result is not finite if `m` is singular.
#[must_use]
pub fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |i: usize, j: usize| {
        let (r, s) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| cofactor(j, i) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes() {
        let m = [[2.0, -1.0, 0.5], [0.3, 4.0, -2.0], [1.0, 0.0, 3.0]];
        let one = product(&inverse(&m), &m);
        for i in 0..3 {
            for j in 0..3 {
                assert!((one[i][j] - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
        let v = apply(&inverse(&m), apply(&m, [1.0, 2.0, 3.0]));
        assert!(v.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-14));
    }
}
