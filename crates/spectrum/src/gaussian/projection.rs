//! Least-squares fit of a sum of Gaussians: heights are solved for, centers and widths are searched.
//!
//! Variable projection (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 413, 1973): for given centers and widths, the heights of
//! least squared error are the solution of a linear problem, solved by orthogonalization. Only the two shape parameters of each
//! term are left to the Levenberg-Marquardt method. Its Jacobian is analytic, in L. Kaufman's form (BIT 15, 49, 1975).

/// Center (nm) and natural logarithm of the standard deviation in nm.
pub(super) type CenterAndWidth = [f64; 2];

/// A function counts as linearly dependent on those before it if less than this share of its length is left after orthogonalization.
const DEPENDENT: f64 = 1e-11;

/// Sampled function to fit, and the bounds within which its terms may lie.
pub(super) struct Problem<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    /// Bounds of the centers (nm) and of the logarithms of the standard deviations.
    pub centers: [f64; 2],
    pub log_sigmas: [f64; 2],
}

/// Result of a projection: the heights of least squared error for given centers and widths.
#[derive(Clone)]
pub(super) struct Projected {
    pub places: Vec<CenterAndWidth>,
    pub heights: Vec<f64>,
    /// Residual: y minus the fitted sum.
    pub residual: Vec<f64>,
    /// Sum of squares of the residual.
    pub sum: f64,
    /// Values of each term at height 1.
    bells: Vec<Vec<f64>>,
    /// Orthonormal basis of the terms; empty for a term that depends on those before it.
    basis: Vec<Vec<f64>>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four independent sums, because a single one would wait for each addition.
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

fn subtract(a: &mut [f64], factor: f64, b: &[f64]) {
    for (x, y) in a.iter_mut().zip(b) {
        *x -= factor * y;
    }
}

/// Subtracts from `v` its component along each of `basis`, and adds that component to `along`. It does so twice, as roundoff
/// requires.
fn orthogonalize(v: &mut [f64], basis: &[Vec<f64>], along: &mut [f64]) {
    for _ in 0..2 {
        for (q, a) in basis.iter().zip(along.iter_mut()).filter(|(q, _)| !q.is_empty()) {
            let part = dot(v, q);
            subtract(v, part, q);
            *a += part;
        }
    }
}

impl Problem<'_> {
    fn bell(&self, [center, log_sigma]: CenterAndWidth) -> Vec<f64> {
        let inverse = libm::exp(-log_sigma);
        let value = |x: &f64| {
            let t = (x - center) * inverse;
            libm::exp(-0.5 * t * t)
        };
        self.x.iter().map(value).collect()
    }

    /// Finds the heights of least squared error for terms at `places`.
    pub fn project(&self, places: &[CenterAndWidth]) -> Projected {
        let empty = Projected {
            places: Vec::new(),
            heights: Vec::new(),
            residual: self.y.to_vec(),
            sum: dot(self.y, self.y),
            bells: Vec::new(),
            basis: Vec::new(),
        };
        self.extend(&empty, places)
    }

    /// Adds terms at further `places` to `start` and finds the heights of least squared error of all terms.
    pub fn extend(&self, start: &Projected, places: &[CenterAndWidth]) -> Projected {
        let mut p = start.clone();
        let mut triangle: Vec<Vec<f64>> = Vec::new();
        let new: Vec<Vec<f64>> = places.iter().map(|place| self.bell(*place)).collect();
        p.places.extend(places);
        p.bells.extend(new);
        let count = p.bells.len();
        p.basis.clear();
        for bell in &p.bells {
            let mut along = vec![0.0; count];
            let mut q = bell.clone();
            let length = dot(&q, &q).sqrt();
            orthogonalize(&mut q, &p.basis, &mut along);
            let left = dot(&q, &q).sqrt();
            if left > DEPENDENT * length {
                along[p.basis.len()] = left;
                q.iter_mut().for_each(|v| *v /= left);
                p.basis.push(q);
            } else {
                p.basis.push(Vec::new());
            }
            triangle.push(along);
        }
        let mut onto = vec![0.0; count];
        p.residual.copy_from_slice(self.y);
        orthogonalize(&mut p.residual, &p.basis, &mut onto);
        p.sum = dot(&p.residual, &p.residual);
        p.heights = vec![0.0; count];
        for i in (0..count).rev().filter(|i| !p.basis[*i].is_empty()) {
            let above: f64 = (i + 1..count).map(|j| triangle[j][i] * p.heights[j]).sum();
            p.heights[i] = (onto[i] - above) / triangle[i][i];
        }
        p
    }

    /// Returns the amount by which one more term at `place` would lower the sum of squares.
    pub fn gain(&self, p: &Projected, place: CenterAndWidth) -> f64 {
        let mut bell = self.bell(place);
        let length = dot(&bell, &bell);
        let along = dot(&bell, &p.residual);
        orthogonalize(&mut bell, &p.basis, &mut vec![0.0; p.basis.len()]);
        let left = dot(&bell, &bell);
        if left > 1e-8 * length { along * along / left } else { 0.0 }
    }

    /// Lowers the sum of squares by moving centers and widths, in at most `steps` steps.
    pub fn refine(&self, start: Projected, steps: usize) -> Projected {
        let mut now = start;
        let mut damping = 1e-2;
        let mut idle = 0;
        for _ in 0..steps {
            let (matrix, gradient) = self.normal_equations(&now);
            let mut better = None;
            while damping < 1e10 {
                if let Some(step) = damped_step(&matrix, &gradient, damping) {
                    let next = self.project(&self.moved(&now.places, &step));
                    if next.sum < now.sum {
                        better = Some(next);
                        break;
                    }
                }
                damping *= 4.0;
            }
            let Some(next) = better else { break };
            // In a flat valley the steps stay small for a long time and then grow.
            idle = if next.sum > now.sum * (1.0 - 1e-5) { idle + 1 } else { 0 };
            now = next;
            damping = (damping * 0.15).max(1e-12);
            if idle == 8 {
                break;
            }
        }
        now
    }

    fn moved(&self, places: &[CenterAndWidth], step: &[f64]) -> Vec<CenterAndWidth> {
        let moved = |(place, d): (&CenterAndWidth, &[f64])| {
            let sigma = libm::exp(place[1]);
            let center = place[0] + sigma * d[0].clamp(-1.5, 1.5);
            let log_sigma = place[1] + d[1].clamp(-0.7, 0.7);
            [center.clamp(self.centers[0], self.centers[1]), log_sigma.clamp(self.log_sigmas[0], self.log_sigmas[1])]
        };
        places.iter().zip(step.chunks_exact(2)).map(moved).collect()
    }

    /// Returns J'J and -J'r for the centers (in units of the width) and the logarithms of the widths.
    fn normal_equations(&self, p: &Projected) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut columns = Vec::with_capacity(2 * p.places.len());
        for ((bell, [center, log_sigma]), height) in p.bells.iter().zip(&p.places).zip(&p.heights) {
            let inverse = libm::exp(-log_sigma);
            let mut by_center = Vec::with_capacity(bell.len());
            let mut by_sigma = Vec::with_capacity(bell.len());
            for (x, g) in self.x.iter().zip(bell) {
                let t = (x - center) * inverse;
                by_center.push(height * g * t);
                by_sigma.push(height * g * t * t);
            }
            columns.push(by_center);
            columns.push(by_sigma);
        }
        for column in &mut columns {
            orthogonalize(column, &p.basis, &mut vec![0.0; p.basis.len()]);
        }
        let matrix = columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
        let gradient = columns.iter().map(|c| dot(c, &p.residual)).collect();
        (matrix, gradient)
    }
}

/// Solves (M + damping diag M) step = g by Cholesky's method; `None` if the matrix is singular.
fn damped_step(matrix: &[Vec<f64>], gradient: &[f64], damping: f64) -> Option<Vec<f64>> {
    let n = gradient.len();
    // A parameter without effect stays unchanged.
    let floor = 1e-14 * (0..n).map(|i| matrix[i][i]).fold(0.0, f64::max);
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let diagonal = if i == j { damping * matrix[i][i] + floor } else { 0.0 };
            let sum = matrix[i][j] + diagonal - dot(&l[i][..j], &l[j][..j]);
            l[i][j] = if i == j {
                if sum.is_nan() || sum <= 0.0 {
                    return None;
                }
                sum.sqrt()
            } else {
                sum / l[j][j]
            };
        }
    }
    let mut step = gradient.to_vec();
    for i in 0..n {
        step[i] = (step[i] - dot(&l[i][..i], &step[..i])) / l[i][i];
    }
    for i in (0..n).rev() {
        let below: f64 = (i + 1..n).map(|k| l[k][i] * step[k]).sum();
        step[i] = (step[i] - below) / l[i][i];
    }
    Some(step)
}
