//! Surfaces that are given by their sag alone.

/// A surface given by its sag z(x, y).
pub trait SagShape: Send + Sync + std::fmt::Debug + 'static {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Returns the slopes dz/dx and dz/dy; `None` where the surface does not reach. The default takes differences of the sag.
    /// Implement it if you know the slopes: tracing is then faster and exact.
    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        // At this step the rounding of the sag and the error of the differences are both near 1e-11.
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

    /// Returns the sag and the slopes at once. Implement it if both together cost less than one after the other.
    fn sag_and_slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, (f64, f64))> {
        Some((self.sag_mm(x_mm, y_mm)?, self.slope(x_mm, y_mm)?))
    }

    /// Returns this shape with all lengths times `factor`; see [`super::Surface::scaled`].
    fn scaled(&self, _factor: f64) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Smallest and largest sag within a radius of the axis, mm; see [`super::ScalarShape::extent_mm`]. Implement it if the sag
    /// is costly and most rays of a search pass beside the surface.
    fn extent_mm(&self, _radius_mm: f64) -> Option<[f64; 2]> {
        None
    }

    /// Curvature at the vertex along x and y, 1/mm; see [`super::Surface::vertex_curvature_per_mm`]. The default takes
    /// differences of the sag.
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let h = 1e-3;
        let second = |dx: f64, dy: f64| {
            let at = |x: f64, y: f64| self.sag_mm(x, y).unwrap_or(0.0);
            (at(dx, dy) - 2.0 * at(0.0, 0.0) + at(-dx, -dy)) / (h * h)
        };
        (second(h, 0.0), second(0.0, h))
    }
}
