//! State of polarization of rays: Stokes parameters about an axis that each ray carries.
//!
//! Born and Wolf, Principles of Optics, section 1.4.2. With the field E_a along the axis a and E_b along b = d x a, where d is
//! the direction of the ray, and the time factor exp(i omega t): Q = |E_a|^2 - |E_b|^2, U = 2 Re(E_a E_b*), V = 2 Im(E_a E_b*).
//! They are stored relative to the intensity, which is the ray's weight, so anything that only dims light leaves them
//! unchanged.

use super::Column;

/// Polarization columns of a batch.
#[derive(Clone, Debug)]
pub(super) struct PolarizationColumns {
    q: Column<f64>,
    u: Column<f64>,
    v: Column<f64>,
    axis: [Column<f64>; 3],
}

impl PolarizationColumns {
    pub(super) fn new(capacity: usize) -> Self {
        let column = || Column::new(capacity);
        Self { q: column(), u: column(), v: column(), axis: std::array::from_fn(|_| column()) }
    }

    pub(super) fn view(&mut self, len: usize) -> Polarization<'_> {
        Polarization {
            q: self.q.slice_mut(len),
            u: self.u.slice_mut(len),
            v: self.v.slice_mut(len),
            axis: self.axis.each_mut().map(|column| column.slice_mut(len)),
        }
    }
}

/// The states of polarization of a batch, ray by ray.
///
/// `q`, `u` and `v` are Q / I, U / I and V / I. They are 0 for unpolarized light; their squares sum to 1 for fully polarized
/// light. The `axis` is a unit vector perpendicular to the ray, in the frame in which the ray's direction is given. It is (0, 0,
/// 0) as long as no surface has needed an axis, which only happens to unpolarized light.
#[derive(Debug, Default)]
pub struct Polarization<'a> {
    /// Q / I: 1 for light polarized along the axis, -1 for light polarized across it.
    pub q: &'a mut [f64],
    /// U / I: linear polarization at 45 degrees to the axis.
    pub u: &'a mut [f64],
    /// V / I: circular polarization.
    pub v: &'a mut [f64],
    /// Unit vector of the axis, or (0, 0, 0).
    pub axis: [&'a mut [f64]; 3],
}

impl Polarization<'_> {
    /// Returns whether the batch carries no polarization.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    pub(super) fn clear(&mut self) {
        let Self { q, u, v, axis } = self;
        for column in [q, u, v].into_iter().chain(axis) {
            column.fill(0.0);
        }
    }

    pub(super) fn keep(&mut self, from: usize, to: usize) {
        if !self.is_empty() {
            let Self { q, u, v, axis } = self;
            for column in [q, u, v].into_iter().chain(axis) {
                column[to] = column[from];
            }
        }
    }

    /// Changes the axis of ray `i` to the unit vector `onto`, and converts Q and U to it, so that the ray's polarization stays
    /// the same. `direction` is the ray's unit direction; both axes are perpendicular to it.
    pub fn turn(&mut self, i: usize, direction: [f64; 3], onto: [f64; 3]) {
        let a: [f64; 3] = std::array::from_fn(|k| self.axis[k][i]);
        if a != [0.0; 3] {
            let [d, s] = [direction, onto];
            let b = [d[1] * a[2] - d[2] * a[1], d[2] * a[0] - d[0] * a[2], d[0] * a[1] - d[1] * a[0]];
            let (along, across) = (a[0] * s[0] + a[1] * s[1] + a[2] * s[2], b[0] * s[0] + b[1] * s[1] + b[2] * s[2]);
            // Cosine and sine of twice the angle; the division by `size` allows for vectors that are off unit length by rounding.
            let size = along * along + across * across;
            let (cos, sin) = ((along * along - across * across) / size, 2.0 * along * across / size);
            let (q, u) = (self.q[i], self.u[i]);
            self.q[i] = q * cos + u * sin;
            self.u[i] = u * cos - q * sin;
        }
        for (axis, onto) in self.axis.iter_mut().zip(onto) {
            axis[i] = onto;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::RayBatch;

    /// Light along x: about an axis at 30 degrees Q = cos 60, U = -sin 60; then back.
    #[test]
    fn an_axis_turns_about_the_ray() {
        let mut rays = RayBatch::new(2).with_polarization();
        rays.restart(2);
        let mut p = rays.columns_mut().polarization;
        (p.q[1], p.v[1], p.axis[0][1]) = (0.8, 0.6, 1.0);
        let half_root3 = 0.75_f64.sqrt();
        p.turn(1, [0.0, 0.0, 1.0], [half_root3, 0.5, 0.0]);
        assert!((p.q[1] - 0.4).abs() < 1e-15 && (p.u[1] + 0.8 * half_root3).abs() < 1e-15 && p.v[1] == 0.6);
        p.turn(1, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        assert!((p.q[1] - 0.8).abs() < 1e-15 && p.u[1].abs() < 1e-15);
        // Unpolarized light only takes the axis.
        p.turn(0, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
        assert_eq!((p.q[0], p.u[0], p.axis[1][0]), (0.0, 0.0, 1.0));
        rays.columns_mut().state[0] = 1;
        rays.compact();
        assert_eq!(rays.columns_mut().polarization.v, [0.6]);
    }
}
