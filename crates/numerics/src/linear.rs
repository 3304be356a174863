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
            for i in k + 1..n {
                let r = order[i];
                let factor = lu[r * n + k] / lu[p * n + k];
                lu[r * n + k] = factor;
                for j in k + 1..n {
                    lu[r * n + j] -= factor * lu[p * n + j];
                }
            }
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
        for i in (0..n).rev() {
            let row = self.order[i] * n;
            let sum: f64 = (i + 1..n).map(|j| self.lu[row + j] * x[j]).sum();
            x[i] = (x[i] - sum) / self.lu[row + i];
        }
        x
    }
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
    }

    #[test]
    fn least_squares_of_a_line_is_the_textbook_line() {
        // y = 1, 2, 2 at x = 0, 1, 2: slope 1/2, intercept 7/6.
        let x = least_squares(&[1.0, 0.0, 1.0, 1.0, 1.0, 2.0], &[1.0, 2.0, 2.0], 2).expect("full rank");
        assert!((x[0] - 7.0 / 6.0).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14);
        assert!(least_squares(&[1.0, 1.0, 1.0, 1.0], &[1.0, 1.0], 2).is_none());
    }
}
