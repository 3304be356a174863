//! Built-in optical surfaces.

mod plane;
mod sphere;

pub use plane::Plane;
pub use sphere::Sphere;
