//! `kind: my-stage`, an imager.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::loss::ALIVE;
use spectra_core::math::log10;
use spectra_core::prelude::*;

/// A radiometer: irradiance in W m^-2, weighted equally at every wavelength, shown on a logarithmic scale.
///
/// The brightest pixel is white; black is `decades` powers of ten below it.
///
/// # Example
/// ```yaml
/// {kind: my-stage, width: 36, height: 24, resolution: [720, 480], decades: 4}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MyStageParams {
    /// Width of the frame, mm if bare.
    width: Positive<Length>,
    /// Height of the frame, mm if bare.
    height: Positive<Length>,
    /// Pixels across and down, 1 to 8192 each.
    #[schemars(inner(range(min = 1, max = 8192)))]
    resolution: [u32; 2],
    /// Range from black to white, in powers of ten.
    #[serde(default = "three")]
    decades: Positive<f64>,
}

fn three() -> Positive<f64> {
    Positive::new(3.0).expect("it is positive")
}

spectra_core::register!(imager "my-stage": MyStageParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let p: MyStageParams = params.parse()?;
    let [width_px, height_px] = p.resolution;
    let size = FrameSize { width_px, height_px, width_mm: p.width.mm(), height_mm: p.height.mm() };
    let response = vec![1.0; context.grid.count];
    let irradiance = Channel { name: "irradiance".into(), unit: "W m^-2".into(), response };
    Ok(Box::new(MyStage { size, irradiance, decades: p.decades.get() }))
}

struct MyStage {
    size: FrameSize,
    irradiance: Channel,
    decades: f64,
}

impl Imager for MyStage {
    fn size(&self) -> FrameSize {
        self.size
    }
    fn response(&self) -> Option<&dyn Response> {
        Some(self)
    }
    fn receive(&self) -> Option<&dyn Receive> {
        Some(self)
    }
    fn launch(&self) -> Option<&dyn Launch> {
        Some(self)
    }
}

/// What the imager records without a film: irradiance, and a picture of it.
impl Response for MyStage {
    fn channels(&self) -> Vec<Channel> {
        vec![self.irradiance.clone()]
    }
    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        let values = exposure.values("irradiance").ok()?;
        let most = f64::from(values.iter().copied().fold(f32::MIN_POSITIVE, f32::max));
        let show = |value: &f32| shade(f64::from(*value) / most, self.decades);
        Some(DisplayPicture::of(self.size, values, show))
    }
}

/// Returns the gray of a fraction of the brightest value: 1 is white, `decades` powers of ten below is black.
fn shade(part: f64, decades: f64) -> [f32; 3] {
    let step = (1.0 + log10(part.max(1e-300)) / decades).clamp(0.0, 1.0);
    [(step * step) as f32; 3] // squared, so that steps look even on a screen
}

/// Forward tracing: finds the pixel that a ray hits.
impl Receive for MyStage {
    fn receive(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let t = -c.z[i] / c.n[i];
            let (x, y) = (c.x[i] + t * c.l[i], c.y[i] + t * c.m[i]);
            (c.x[i], c.y[i], c.z[i]) = (x, y, 0.0);
            match self.size.pixel_at(x, y) {
                Some(pixel) => c.tag[i] = pixel,
                None => c.state[i] = Loss::OutOfFrame.state(0),
            }
        }
    }
}

/// Backward tracing: chooses the point of a pixel where a ray starts.
impl Launch for MyStage {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let (x, y) = self.size.point_of(c.tag[i], u[i], v[i]);
            (c.x[i], c.y[i], c.z[i]) = (x, y, 0.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, -1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::shade;
    use spectra_testing::{ImagerLaws, assert_fault, imager};

    #[test]
    fn a_decade_is_a_step() {
        let steps = [1.0, 0.1, 0.01, 0.001, 0.0].map(|part| shade(part, 4.0)[0].sqrt());
        for (got, want) in steps.into_iter().zip([1.0, 0.75, 0.5, 0.25, 0.0]) {
            assert!((got - want).abs() < 1e-6, "{got} {want}");
        }
    }

    #[test]
    fn it_keeps_the_laws_of_imagers() {
        let frame = "{kind: my-stage, width: 36, height: 24, resolution: [90, 60]}";
        ImagerLaws::default().hold(&*imager(frame));
    }

    #[test]
    fn what_cannot_be_is_said() {
        let empty = "{kind: my-stage, width: 36, height: 24, resolution: [0, 60]}";
        assert_fault("imager", empty, "resolution[0]");
    }
}
