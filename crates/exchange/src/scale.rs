//! Scaling of a prescription: all lengths times a factor, while angles, f-number and glasses stay the same.

use crate::{
    Aperture, ApertureShape, AxisItem, Displacement, FieldKind, Prescription, Surface, SurfaceShape, SystemAperture,
};

impl Prescription {
    /// Returns the prescription with all lengths multiplied by `factor`: radii, gaps, rims, apertures and displacements. A
    /// coefficient of r^k is multiplied by `factor`^(1-k). Patents state many lenses for a focal length of 1 or 100.
    ///
    /// Quantities that relate to wavelengths stay as they are: a grating keeps its lines per mm.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for item in &mut self.items {
            *item.thickness_mm_mut() *= factor;
            match item {
                AxisItem::Surface(surface) => scale_surface(surface, factor),
                AxisItem::Break(axis) => scale_displacement(&mut axis.by, factor),
            }
        }
        self.object_distance_mm = self.object_distance_mm.map(|mm| mm * factor);
        if let Some(SystemAperture::EntrancePupilDiameter(mm)) = &mut self.system_aperture {
            *mm *= factor;
        }
        if let Some(fields) = self.fields.as_mut().filter(|fields| fields.kind != FieldKind::Angle) {
            fields.points.iter_mut().flatten().for_each(|mm| *mm *= factor);
        }
        self
    }
}

fn scale_displacement(by: &mut Displacement, factor: f64) {
    by.decenter_mm.iter_mut().for_each(|mm| *mm *= factor);
}

fn scale_surface(surface: &mut Surface, factor: f64) {
    scale_shape(&mut surface.shape, factor);
    for size in [&mut surface.semi_diameter_mm, &mut surface.outer_semi_diameter_mm].into_iter().flatten() {
        *size *= factor;
    }
    surface.apertures.iter_mut().for_each(|aperture| scale_aperture(aperture, factor));
    scale_displacement(&mut surface.displacement, factor);
}

/// Scales coefficients of r^first, r^(first + step), ..., which are in mm^(1-power).
fn scale_powers(coefficients: &mut [f64], first: i32, step: i32, factor: f64) {
    for (at, coefficient) in coefficients.iter_mut().enumerate() {
        let power = 1 - first - step * at as i32;
        let each = if power < 0 { 1.0 / factor } else { factor };
        *coefficient = (0..power.unsigned_abs()).fold(*coefficient, |value, _| value * each);
    }
}

fn scale_shape(shape: &mut SurfaceShape, factor: f64) {
    match shape {
        SurfaceShape::Plane | SurfaceShape::Stop | SurfaceShape::TiltedPlane { .. } | SurfaceShape::Other { .. } => {}
        SurfaceShape::Sphere { radius }
        | SurfaceShape::Conic { radius, .. }
        | SurfaceShape::Cylinder { radius, .. }
        | SurfaceShape::Grating { radius, .. } => {
            *radius *= factor;
        }
        SurfaceShape::EvenAsphere { radius, coefficients, .. } => {
            *radius *= factor;
            scale_powers(coefficients, 2, 2, factor);
        }
        SurfaceShape::OddAsphere { radius, coefficients, .. } => {
            *radius *= factor;
            scale_powers(coefficients, 1, 1, factor);
        }
        SurfaceShape::Toroid { radius, coefficients, rotation_radius, .. } => {
            *radius *= factor;
            *rotation_radius *= factor;
            scale_powers(coefficients, 2, 2, factor);
        }
        SurfaceShape::Biconic { radius_x, radius_y, .. } => {
            *radius_x *= factor;
            *radius_y *= factor;
        }
        SurfaceShape::ThinLens { focal_length } => *focal_length *= factor,
        SurfaceShape::Zernike { radius, normalization_radius, coefficients, .. } => {
            *radius *= factor;
            *normalization_radius *= factor;
            coefficients.iter_mut().for_each(|mm| *mm *= factor);
        }
    }
}

fn scale_aperture(aperture: &mut Aperture, factor: f64) {
    aperture.center_mm.iter_mut().for_each(|mm| *mm *= factor);
    match &mut aperture.shape {
        ApertureShape::Ring { inner, outer } => {
            *inner *= factor;
            *outer *= factor;
        }
        ApertureShape::Rectangle { half_width, half_height } | ApertureShape::Ellipse { half_width, half_height } => {
            *half_width *= factor;
            *half_height *= factor;
        }
        ApertureShape::Polygon { points } => points.iter_mut().flatten().for_each(|mm| *mm *= factor),
        ApertureShape::Other { .. } => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sag of an asphere from its definition.
    fn sag(radius: f64, conic: f64, terms: &[(i32, f64)], r: f64) -> f64 {
        let c = 1.0 / radius;
        let quadric = c * r * r / (1.0 + (1.0 - (1.0 + conic) * c * c * r * r).sqrt());
        quadric + terms.iter().map(|(power, a)| a * r.powi(*power)).sum::<f64>()
    }

    #[test]
    fn a_scaled_asphere_has_scaled_sags() {
        let factor = 0.37;
        let even = vec![1e-3, -2e-5, 3e-8];
        let odd = vec![1e-3, -2e-4, 3e-6, 1e-7];
        let (mut a, mut b) = (
            SurfaceShape::EvenAsphere { radius: 60.0, conic: -0.7, coefficients: even.clone() },
            SurfaceShape::OddAsphere { radius: 60.0, conic: -0.7, coefficients: odd.clone() },
        );
        scale_shape(&mut a, factor);
        scale_shape(&mut b, factor);
        let (
            SurfaceShape::EvenAsphere { radius, coefficients, .. },
            SurfaceShape::OddAsphere { coefficients: others, .. },
        ) = (a, b)
        else {
            panic!("shapes stay")
        };
        let terms = |c: &[f64], first: i32, step: i32| -> Vec<(i32, f64)> {
            c.iter().enumerate().map(|(i, v)| (first + step * i as i32, *v)).collect()
        };
        for r in [1.0, 7.0, 20.0] {
            let before = [sag(60.0, -0.7, &terms(&even, 2, 2), r), sag(60.0, -0.7, &terms(&odd, 1, 1), r)];
            let after = [
                sag(radius, -0.7, &terms(&coefficients, 2, 2), factor * r),
                sag(radius, -0.7, &terms(&others, 1, 1), factor * r),
            ];
            for (before, after) in before.iter().zip(after) {
                assert!((after - factor * before).abs() < 1e-13, "{r}: {before} {after}");
            }
        }
    }
}
