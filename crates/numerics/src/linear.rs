//! Small dense linear algebra: square systems and least squares.

/// Solves the square system `a x = b` (row-major, `b.len()` unknowns) by elimination with row scaling and partial
/// pivoting, and one step of iterative refinement. `None` if the matrix is singular.
#[must_use]
pub fn solve(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    let factors = Factors::new(a, n)?;
    let mut x = factors.apply(b);
    let residual: Vec<f64> = (0..n).map(|i| b[i] - (0..n).map(|j| a[i * n + j] * x[j]).sum::<f64>()).collect();
    for (x, d) in x.iter_mut().zip(factors.apply(&residual)) {
        *x += d;
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

struct Factors {
    lu: Vec<f64>,
    order: Vec<usize>,
    n: usize,
}

impl Factors {
    fn new(a: &[f64], n: usize) -> Option<Factors> {
        let mut lu = a.to_vec();
        let mut order: Vec<usize> = (0..n).collect();
        let scale: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a[i * n + j].abs()).fold(0.0, f64::max)).collect();
        for k in 0..n {
            let size = |row: usize| lu[row * n + k].abs() / scale[row].max(f64::MIN_POSITIVE);
            let pivot = (k..n).max_by(|&i, &j| size(order[i]).total_cmp(&size(order[j])))?;
            order.swap(k, pivot);
            let p = order[k];
            if lu[p * n + k] == 0.0 || lu[p * n + k].is_nan() {
                return None;
            }
            eliminate(&mut lu, n, &order, k);
        }
        Some(Factors { lu, order, n })
    }

    fn apply(&self, b: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut x = vec![0.0; n];
        for i in 0..n {
            let row = self.order[i] * n;
            x[i] = b[self.order[i]] - (0..i).map(|j| self.lu[row + j] * x[j]).sum::<f64>();
        }
        substitute_back(&self.lu, n, &self.order, &mut x);
        x
    }
}

/// Eliminates unknown `k` from the rows after the one at `k` in `order`, and leaves the factors in its place. Rows are `width` long.
fn eliminate(rows: &mut [f64], width: usize, order: &[usize], k: usize) {
    let p = order[k] * width;
    for r in order[k + 1..].iter().map(|r| r * width) {
        let factor = rows[r + k] / rows[p + k];
        rows[r + k] = factor;
        for j in k + 1..width {
            rows[r + j] -= factor * rows[p + j];
        }
    }
}

/// Solves the upper triangle of eliminated rows in place: `x` holds the right side before and the unknowns afterwards.
fn substitute_back(rows: &[f64], width: usize, order: &[usize], x: &mut [f64]) {
    for i in (0..x.len()).rev() {
        let row = order[i] * width;
        let sum: f64 = (i + 1..x.len()).map(|j| rows[row + j] * x[j]).sum();
        x[i] = (x[i] - sum) / rows[row + i];
    }
}

/// Solves the square system `a x = b` (row-major, `b.len()` unknowns) by elimination without pivoting, which suits a positive definite
/// matrix. `None` if the matrix is not positive definite.
#[must_use]
pub fn solve_definite(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    let width = n + 1;
    let mut rows: Vec<f64> = (0..n).flat_map(|i| a[i * n..(i + 1) * n].iter().chain([&b[i]])).copied().collect();
    let order: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let pivot = rows[k * width + k];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        eliminate(&mut rows, width, &order, k);
    }
    let mut x: Vec<f64> = (0..n).map(|i| rows[i * width + n]).collect();
    substitute_back(&rows, width, &order, &mut x);
    x.iter().all(|v| v.is_finite()).then_some(x)
}

/// Returns the least-squares solution of `a x = b` with `columns` unknowns, by Householder reflections. `None` if there are
/// fewer rows than unknowns or the columns are dependent.
#[must_use]
pub fn least_squares(a: &[f64], b: &[f64], columns: usize) -> Option<Vec<f64>> {
    let rows = b.len();
    if rows < columns {
        return None;
    }
    let mut a = a.to_vec();
    let mut b = b.to_vec();
    let largest = a.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mut diagonal = vec![0.0; columns];
    for k in 0..columns {
        let norm = (k..rows).map(|i| a[i * columns + k] * a[i * columns + k]).sum::<f64>().sqrt();
        if norm <= largest * 1e-15 || norm.is_nan() {
            return None;
        }
        let alpha = if a[k * columns + k] > 0.0 { -norm } else { norm };
        a[k * columns + k] -= alpha;
        let length: f64 = (k..rows).map(|i| a[i * columns + k] * a[i * columns + k]).sum();
        for j in k + 1..columns {
            let dot: f64 = (k..rows).map(|i| a[i * columns + k] * a[i * columns + j]).sum();
            for i in k..rows {
                let v = a[i * columns + k];
                a[i * columns + j] -= 2.0 * dot / length * v;
            }
        }
        let dot: f64 = (k..rows).map(|i| a[i * columns + k] * b[i]).sum();
        for i in k..rows {
            b[i] -= 2.0 * dot / length * a[i * columns + k];
        }
        diagonal[k] = alpha;
    }
    let mut x = vec![0.0; columns];
    for k in (0..columns).rev() {
        let sum: f64 = (k + 1..columns).map(|j| a[k * columns + j] * x[j]).sum();
        x[k] = (b[k] - sum) / diagonal[k];
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_hilbert_system() {
        let n = 6;
        let a: Vec<f64> = (0..n * n).map(|k| 1.0 / ((k / n + k % n + 1) as f64)).collect();
        let b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a[i * n + j] * (j as f64 + 1.0)).sum()).collect();
        for (j, x) in solve(&a, &b).expect("regular").iter().enumerate() {
            assert!((x - (j as f64 + 1.0)).abs() < 1e-8);
        }
        assert!(solve(&[1.0, 2.0, 2.0, 4.0], &[1.0, 2.0]).is_none());
        for (j, x) in solve_definite(&a, &b).expect("positive definite").iter().enumerate() {
            assert!((x - (j as f64 + 1.0)).abs() < 1e-8);
        }
        assert!(solve_definite(&[1.0, 2.0, 2.0, 1.0], &[1.0, 2.0]).is_none());
    }

    #[test]
    fn least_squares_of_a_line_is_the_textbook_line() {
        // y = 1, 2, 2 at x = 0, 1, 2: slope 1/2, intercept 7/6.
        let x = least_squares(&[1.0, 0.0, 1.0, 1.0, 1.0, 2.0], &[1.0, 2.0, 2.0], 2).expect("full rank");
        assert!((x[0] - 7.0 / 6.0).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14);
        assert!(least_squares(&[1.0, 1.0, 1.0, 1.0], &[1.0, 1.0], 2).is_none());
    }
}
