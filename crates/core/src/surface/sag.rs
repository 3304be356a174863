//! The least that makes a surface: its sag.

/// A surface given by its sag z(x, y).
pub trait SagShape: Send + Sync + std::fmt::Debug + 'static {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Slopes dz/dx and dz/dy. By default taken from the sag by differences; give them where you know them, and tracing is
    /// faster and exact.
    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        // Rounding of the sag over the step, and the fourth power of the step, meet near 1e-11 here.
        let h = 1e-3;
        let along = |dx: f64, dy: f64| -> Option<f64> {
            let a = self.sag_mm(x_mm - dx, y_mm - dy)?;
            let b = self.sag_mm(x_mm + dx, y_mm + dy)?;
            let a2 = self.sag_mm(x_mm - 2.0 * dx, y_mm - 2.0 * dy)?;
            let b2 = self.sag_mm(x_mm + 2.0 * dx, y_mm + 2.0 * dy)?;
            Some((8.0 * (b - a) - (b2 - a2)) / (12.0 * h))
        };
        Some((along(h, 0.0)?, along(0.0, h)?))
    }

    /// Sag and slopes at once: give it where both cost less together than apart.
    fn sag_and_slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, (f64, f64))> {
        Some((self.sag_mm(x_mm, y_mm)?, self.slope(x_mm, y_mm)?))
    }

    /// As [`super::Surface::scaled`].
    fn scaled(&self, _factor: f64) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// As [`super::ScalarShape::extent_mm`]: give it where the sag is costly, and most rays of a search pass beside the surface.
    fn extent_mm(&self, _radius_mm: f64) -> Option<[f64; 2]> {
        None
    }

    /// As [`super::Surface::vertex_curvature_per_mm`]; by default from differences of the sag.
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let h = 1e-3;
        let second = |dx: f64, dy: f64| {
            let at = |x: f64, y: f64| self.sag_mm(x, y).unwrap_or(0.0);
            (at(dx, dy) - 2.0 * at(0.0, 0.0) + at(-dx, -dy)) / (h * h)
        };
        (second(h, 0.0), second(0.0, h))
    }
}
