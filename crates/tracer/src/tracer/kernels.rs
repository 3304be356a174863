//! Loops over a batch that are compiled for each instruction set.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::isa::Vectorized;
use spectra_glass::Dispersion;
use spectra_lens::Pose;

/// Indices of one medium at each ray's wavelength.
pub(super) struct Evaluate<'a> {
    pub(super) medium: &'a Dispersion,
    pub(super) wavelength_nm: &'a [f64],
    pub(super) n: &'a mut [f64],
    pub(super) inverse: &'a mut [f64],
}

impl Vectorized for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.medium.index_and_inverse(self.wavelength_nm, self.n, self.inverse);
    }
}

/// Returns the position (mm) and the direction of a ray in the frame that `pose` is given in.
#[inline(always)]
fn reframed(pose: &Pose, [x, y, z]: [f64; 3], [l, m, n]: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let Pose { origin_mm: o, rotation: r } = pose;
    let position = [
        r.x_axis.x * x + r.y_axis.x * y + r.z_axis.x * z + o.x,
        r.x_axis.y * x + r.y_axis.y * y + r.z_axis.y * z + o.y,
        r.x_axis.z * x + r.y_axis.z * y + r.z_axis.z * z + o.z,
    ];
    let direction = [
        r.x_axis.x * l + r.y_axis.x * m + r.z_axis.x * n,
        r.x_axis.y * l + r.y_axis.y * m + r.z_axis.y * n,
        r.x_axis.z * l + r.y_axis.z * m + r.z_axis.z * n,
    ];
    (position, direction)
}

/// Brings rays from one frame into another.
pub(super) struct Reframe<'a> {
    pub(super) rays: &'a mut RayBatch,
    /// The frame they are in, seen from the one they go to.
    pub(super) pose: Pose,
}

impl Vectorized for Reframe<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let c = self.rays.columns_mut();
        let len = c.x.len();
        let (x, y, z) = (&mut c.x[..len], &mut c.y[..len], &mut c.z[..len]);
        let (l, m, n) = (&mut c.l[..len], &mut c.m[..len], &mut c.n[..len]);
        for i in 0..len {
            let (position, direction) = reframed(&self.pose, [x[i], y[i], z[i]], [l[i], m[i], n[i]]);
            (x[i], y[i], z[i]) = position.into();
            (l[i], m[i], n[i]) = direction.into();
        }
        let [ax, ay, az] = c.polarization.axis;
        for ((x, y), z) in ax.iter_mut().zip(ay).zip(az) {
            (*x, *y, *z) = (self.pose.rotation * DVec3::new(*x, *y, *z)).into();
        }
    }
}

/// Puts rays into the frame that they leave the lens in, and into the medium there.
pub(super) struct Leave<'a> {
    pub(super) rays: &'a mut RayBatch,
    pub(super) index: &'a [f64],
    pub(super) shift_mm: f64,
}

impl Vectorized for Leave<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let c = self.rays.columns_mut();
        c.index.copy_from_slice(self.index);
        for z in c.z.iter_mut() {
            *z += self.shift_mm;
        }
    }
}

/// Counts the rays in each of these states, in one pass.
pub(super) struct Count<'a, const N: usize> {
    pub(super) states: &'a [u64],
    pub(super) wanted: [u64; N],
}

impl<const N: usize> Vectorized for Count<'_, N> {
    type Output = [u64; N];
    #[inline(always)]
    fn run(self) -> [u64; N] {
        let mut many = [0; N];
        for state in self.states {
            for (many, wanted) in many.iter_mut().zip(&self.wanted) {
                *many += u64::from(state == wanted);
            }
        }
        many
    }
}
