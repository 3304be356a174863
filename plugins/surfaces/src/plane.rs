//! `kind: plane` and `kind: stop`: planes perpendicular to the axis.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
pub use spectra_core::surface::Plane;
use spectra_core::surface::{Kernel, Surface};

/// A plane perpendicular to the axis.
///
/// Use it for the flat face of a plano-convex lens, a window or a filter in the beam; with `mirror: true` it is a flat
/// mirror. It has no parameters of its own. `{kind: sphere, radius: inf}` is the same surface. For a plane that is not
/// perpendicular to the axis use `kind: tilted-plane`.
///
/// # Example
/// ```yaml
/// {kind: plane, thickness: 2, glass: SCHOTT/N-BK7, semi-diameter: 15}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PlaneParams {}

spectra_core::register!(surface "plane": PlaneParams, build_plane);

/// The aperture stop: it clips rays, and its size sets the f-number.
///
/// The stop is a plane perpendicular to the axis, in the surrounding medium, and does not refract. A lens has one stop:
/// either a surface of this kind, or a glass surface with `stop: true`. The scene's `f-number` opens or closes it until
/// the real marginal ray has that f-number; without one, `semi-diameter` is its size.
///
/// For blades, or an opening of any other shape, write `aperture`.
///
/// # Example
/// ```yaml
/// {kind: stop, thickness: 4}
/// ```
/// ```yaml
/// kind: stop
/// thickness: 4
/// semi-diameter: 10
/// aperture: {shape: iris, blades: 8, blade-radius: 14, rotation: 10 deg}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct StopParams {}

spectra_core::register!(surface "stop": StopParams, build_stop);

fn build_plane(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    params.parse::<PlaneParams>()?;
    Ok(Box::new(Kernel(Plane::refracting())))
}

fn build_stop(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    params.parse::<StopParams>()?;
    Ok(Box::new(Kernel(Plane::stop())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::surface::{KernelShape, Ray};

    #[test]
    fn a_ray_along_the_plane_misses_it() {
        let hit = |n: f64| {
            Plane::refracting().hit(Ray::<f64, true> {
                position: [0.0, 0.0, -1.0],
                direction: [0.0, 1.0, n],
                radius2: 0.0,
            })
        };
        assert!(!(hit(0.0).valid >= 0.0));
        assert!(hit(1e-3).valid >= 0.0);
        assert_eq!(hit(0.5).distance, 2.0);
    }
}
