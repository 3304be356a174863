//! First-order (paraxial) optics by the ray-transfer method.
//!
//! A paraxial ray has a height y (mm) and a slope u = dy/dz. A surface of curvature c between media
//! n and n' maps it by n' u' = n u - y c (n' - n) (W. J. Smith, Modern Optical Engineering, ch. 3). Behind a mirror light
//! runs toward -z: indices count as negative there, and a mirror is a surface with n' = -n. A folded axis is treated
//! as straight.

use crate::Lens;
use spectra_core::surface::Action;

/// The first-order (paraxial) figures of a lens at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder {
    /// Wavelength, nm; `None` if every medium has its stated index.
    pub wavelength_nm: Option<f64>,
    /// Effective focal length, mm; positive for a converging lens.
    pub efl_mm: f64,
    /// Back focal length: from the last vertex to the rear focal point, mm.
    pub bfl_mm: f64,
    /// Front focal length: from the first vertex to the front focal point, mm (negative if the point lies in front of the vertex).
    pub ffl_mm: f64,
    /// Position of the rear principal plane, mm from the first vertex.
    pub rear_principal_z_mm: f64,
    /// Position of the front principal plane, mm from the first vertex.
    pub front_principal_z_mm: f64,
    /// Position of the front nodal point, mm from the first vertex. A ray aimed at it leaves the rear nodal point in the same direction.
    pub front_nodal_z_mm: f64,
    /// Position of the rear nodal point, mm from the first vertex.
    pub rear_nodal_z_mm: f64,
    /// Position of the entrance pupil, mm from the first vertex; `None` if the lens has no stop.
    pub entrance_pupil_z_mm: Option<f64>,
    /// Position of the exit pupil, mm from the first vertex; `None` if the lens has no stop.
    pub exit_pupil_z_mm: Option<f64>,
    /// Size of the entrance pupil divided by that of the stop; `None` if the lens has no stop.
    pub entrance_pupil_magnification: Option<f64>,
    /// Size of the exit pupil divided by that of the stop; `None` if the lens has no stop.
    pub exit_pupil_magnification: Option<f64>,
}

/// A plane that contains the axis, in which first-order optics is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// The plane of x and z.
    X,
    /// The plane of y and z: the plane of a drawing on paper.
    Y,
}

impl Section {
    fn of(self, (x, y): (f64, f64)) -> f64 {
        match self {
            Self::X => x,
            Self::Y => y,
        }
    }
}

/// The paraxial map through a lens, from the first vertex plane to the last.
#[derive(Clone, Copy, Debug)]
struct Matrix {
    /// Matrix elements: height' = a height + b slope; slope' = c height + d slope.
    a: f64,
    b: f64,
    c: f64,
    d: f64,
}

impl Matrix {
    const UNIT: Self = Self { a: 1.0, b: 0.0, c: 0.0, d: 1.0 };

    /// Appends a surface of this power (1/mm) between media of these signed indices.
    fn bend(self, power: f64, n: f64, after: f64) -> Self {
        let power = power / after;
        let ratio = n / after;
        Self { a: self.a, b: self.b, c: ratio * self.c - power * self.a, d: ratio * self.d - power * self.b }
    }

    fn advance(self, distance: f64) -> Self {
        Self { a: self.a + distance * self.c, b: self.b + distance * self.d, ..self }
    }
}

impl Lens {
    fn matrix(&self, elements: std::ops::Range<usize>, section: Section, index: &dyn Fn(usize) -> f64) -> Matrix {
        let mut m = Matrix::UNIT;
        let end = elements.end;
        for at in elements {
            let e = &self.elements[at];
            let sign = if e.along == e.reversed { -1.0 } else { 1.0 };
            let (n, after) = (sign * index(e.medium_before), sign * index(e.medium_after));
            match e.action {
                // A reversed surface stands between the same media in reverse order.
                Action::Refract => {
                    let (first, second) = if e.reversed { (after, n) } else { (n, after) };
                    m = m.bend(section.of(e.surface.paraxial_power_per_mm(first, second)), n, after);
                }
                Action::Reflect => {
                    let (first, second) = if e.reversed { (-n, n) } else { (n, -n) };
                    m = m.bend(section.of(e.surface.paraxial_power_per_mm(first, second)), n, -n);
                }
                Action::Pass => {}
            }
            if at + 1 < end {
                m = m.advance(self.gap_mm(at));
            }
        }
        m
    }

    /// Returns 1 if light that runs forward leaves the lens in the +z direction, otherwise -1.
    pub fn sense_behind(&self) -> f64 {
        let mirrors = self.elements.iter().filter(|e| e.action == Action::Reflect).count();
        if mirrors.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// Computes the first-order figures in the y-z section at a wavelength, nm.
    #[must_use]
    pub fn first_order(&self, wavelength_nm: f64) -> FirstOrder {
        self.first_order_in(Section::Y, wavelength_nm)
    }

    /// Computes the first-order figures in one section of the lens at a wavelength, nm. The sections of a lens with cylinders
    /// differ.
    #[must_use]
    pub fn first_order_in(&self, section: Section, wavelength_nm: f64) -> FirstOrder {
        let by = self.first_order_by(section, &|m| self.index(m, wavelength_nm));
        FirstOrder { wavelength_nm: Some(wavelength_nm), ..by }
    }

    /// Computes the first-order figures in the y-z section with every medium at the index that the prescription states. A medium
    /// without a stated index has the index of its formula at the reference line.
    #[must_use]
    pub fn first_order_at_stated_nd(&self) -> FirstOrder {
        let index = |m: usize| self.media[m].stated_nd.unwrap_or_else(|| self.index(m, self.reference_nm));
        self.first_order_by(Section::Y, &index)
    }

    fn first_order_by(&self, section: Section, index: &dyn Fn(usize) -> f64) -> FirstOrder {
        let count = self.elements.len();
        let last_z = self.elements.last().map_or(0.0, |e| e.along_axis_mm);
        let m = self.matrix(0..count, section, index);
        let n_object = self.elements.first().map_or(1.0, |e| index(e.medium_before));
        let n_image = self.elements.last().map_or(1.0, |e| index(e.medium_after));
        // One over the power: positive for a lens that converges light, whichever way the light leaves.
        let focal = -1.0 / m.c;
        let efl = focal * self.sense_behind();
        let bfl = -m.a / m.c;
        // A ray that leaves parallel to the axis enters with slope s and height h: c h + d s = 0.
        let ffl = m.d / m.c;
        let front_focal = efl * n_object / n_image;
        let (mut enp, mut exp, mut enp_m, mut exp_m) = (None, None, None, None);
        if let Some(stop) = self.stop() {
            // From the first vertex plane to the stop: this gives the image of the stop in object space.
            let to_stop = self.matrix(0..stop, section, index);
            let gap = if stop > 0 { self.gap_mm(stop - 1) } else { 0.0 };
            let front = to_stop.advance(gap);
            // A ray through the center of the stop has a h + b s = 0; it crosses the axis at -h / s = b / a.
            enp = Some(front.b / front.a);
            enp_m = Some(1.0 / front.a);
            // Behind the center of the stop, including the refraction there if the stop is an optical surface.
            let rear = self.matrix(stop..count, section, index);
            let z = -rear.b / rear.d;
            exp = Some(last_z + z);
            exp_m = Some(rear.a + z * rear.c);
        }
        FirstOrder {
            wavelength_nm: None,
            efl_mm: efl,
            bfl_mm: bfl,
            ffl_mm: ffl,
            rear_principal_z_mm: last_z + bfl - focal,
            front_principal_z_mm: ffl + front_focal,
            front_nodal_z_mm: ffl + focal,
            rear_nodal_z_mm: last_z + bfl - front_focal,
            entrance_pupil_z_mm: enp,
            exit_pupil_z_mm: exp,
            entrance_pupil_magnification: enp_m,
            exit_pupil_magnification: exp_m,
        }
    }

    /// Returns the distance (mm) from the last vertex to the paraxial image of an axial point, in the y-z section. The point lies
    /// `object_mm` in front of the first vertex (infinity allowed).
    #[must_use]
    pub fn paraxial_image_gap_mm(&self, object_mm: f64, wavelength_nm: f64) -> f64 {
        self.paraxial_image_gap_in_mm(Section::Y, object_mm, wavelength_nm)
    }

    /// Returns the distance (mm) from the last vertex to the paraxial image of an axial point, in one section of the lens. The
    /// point lies `object_mm` in front of the first vertex (infinity allowed).
    #[must_use]
    pub fn paraxial_image_gap_in_mm(&self, section: Section, object_mm: f64, wavelength_nm: f64) -> f64 {
        let m = self.matrix(0..self.elements.len(), section, &|medium| self.index(medium, wavelength_nm));
        // A ray from the point with slope s has the height `object_mm` * s at the first vertex.
        let (height, slope) =
            if object_mm.is_finite() { (m.a * object_mm + m.b, m.c * object_mm + m.d) } else { (m.a, m.c) };
        -height / slope
    }

    /// Returns the lateral magnification of an object `object_mm` in front of the first vertex, in the y-z section; negative
    /// means upside down.
    #[must_use]
    pub fn paraxial_magnification(&self, object_mm: f64, wavelength_nm: f64) -> f64 {
        let m = self.matrix(0..self.elements.len(), Section::Y, &|medium| self.index(medium, wavelength_nm));
        let gap = self.paraxial_image_gap_mm(object_mm, wavelength_nm);
        m.a + gap * m.c
    }
}
