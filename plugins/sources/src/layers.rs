//! `kind: layers`: pictures one behind the other, each with its own coverage (alpha).
//!
//! A ray from the lens meets the layers from front to back. Each adds its light, which is already multiplied by its
//! coverage, times the transmission of the layers in front of it (T. Porter and T. Duff, "Compositing digital images",
//! SIGGRAPH 1984). Hidden parts are not guessed: the layer behind has them.

use crate::deferred_source::DeferredSource;
use crate::frame::{Edge, PlanePlacement, Width};
use crate::picture::picture_texture::PictureTexture;
use crate::picture::{PictureFile, PictureSettings, color_model, find};
use crate::plane_source::Texture;
use crate::split_source::{LightPart, SplitSource};
use crate::white;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::RayBatch;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::params::{Deferred, Faults, Length, Luminance, Params, Positive, Quantity, Warning};
use spectra_core::registry::{Context, StageOf};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{ColorModel, Emit, Radiance, Source};
use spectra_pictures::read::Header;
use std::sync::Arc;

/// Picture files one behind the other, each with alpha.
///
/// Use it for composed scenes: a foreground, people and a backdrop, each with its alpha. A ray from the lens meets the
/// layers from front to back. Each adds its light, times the transmission of the layers in front of it. Behind the edges of
/// a blurred foreground the hidden parts are correct, since the layer behind has them.
///
/// Colors are handled as in `kind: picture`. Alpha is taken as straight in integer files and as premultiplied in
/// floating-point files, as OpenEXR defines it. A picture without alpha covers everything behind it. If a layer has
/// `edge: clamp` or `edge: mirror`, light is traced from the imager only (`direction: backward`).
///
/// # Example
/// ```yaml
/// kind: layers
/// layers:
///   - {file: leaves.png, distance: 80 cm, width: 50 cm}
///   - {file: portrait.png, distance: 2 m, width: 1.4 m, center: [10 cm, 0]}
///   - {file: holiday.png, distance: 20 m, width: fill, luminance: 2000 cd/m2}
/// luminance: 300 cd/m2
/// ```
/// # References
/// - T. Porter and T. Duff, "Compositing digital images", SIGGRAPH 1984.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LayersParams {
    /// List of layers, 1 to 64, from front to back.
    #[schemars(length(min = 1, max = 64))]
    layers: Vec<Deferred<LayerParams>>,
    /// Light whose chromaticity is white: the name of a spectrum, a file beside the scene, or an expression such as
    /// `blackbody:3200`.
    #[serde(default = "daylight")]
    illuminant: String,
    /// Luminance of white (255 of 8 bits, 1.0 of floating point), cd/m2 if bare.
    #[serde(default = "luminance")]
    luminance: Positive<Luminance>,
    /// Color model that turns RGB into a spectrum; `smooth` if left out.
    color: Option<Deferred<StageOf<dyn ColorModel>>>,
}

/// One layer, as written in a scene.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LayerParams {
    /// Picture file beside the scene, as for `kind: picture`; at most 1 GiB.
    file: String,
    /// Encoding of the code values, as for `kind: picture`.
    transfer: Option<String>,
    /// Layer of an OpenEXR file; its plain R, G and B if left out.
    layer: Option<String>,
    /// Distance of the layer from the first vertex, mm if bare; larger than that of the layer before it in the list.
    distance: Positive<Length>,
    /// Width of the picture on that plane, mm if bare, or `fill`, as for `kind: picture`; the height follows.
    width: Width,
    /// Light and alpha beyond the picture: `black` (none, the default), `clamp` or `mirror`.
    edge: Option<Edge>,
    /// Center of the picture on that plane (to the photographer's right, and up), mm if bare; on the axis if left out.
    center: Option<[Length; 2]>,
    /// Luminance of this layer's white, cd/m2 if bare; that of all layers if left out.
    luminance: Option<Positive<Luminance>>,
}

fn daylight() -> String {
    "D65".to_owned()
}

fn luminance() -> Positive<Luminance> {
    Positive::from_bare(100.0)
}

spectra_core::register!(source "layers": LayersParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Source>, Faults> {
    let p: LayersParams = params.parse()?;
    let mut faults = Faults::new();
    let light = faults.take(white::illuminant(&p.illuminant, params, context));
    let model = light.and_then(|light| faults.take(color_model(p.color, &light, params, context)));
    let mut layers: Vec<Pending> = Vec::new();
    let mut before_mm = 0.0;
    for (i, node) in p.layers.iter().enumerate() {
        let Some(own) = faults.take(Params::section(node.node().clone(), node.path())) else { continue };
        let Some(layer) = faults.take(own.parse::<LayerParams>()) else { continue };
        let distance_mm = layer.distance.mm();
        if distance_mm <= before_mm {
            let text = format!("a layer at {distance_mm} mm is not behind the previous one, at {before_mm} mm");
            faults.push(own.fault("distance", text).hint("list layers from front to back"));
        }
        before_mm = distance_mm;
        let center_mm = layer.center.map_or([0.0; 2], |c| c.map(Length::mm));
        let Some(found) = faults.take(find(&layer.file, &own, context)) else { continue };
        let file = PictureFile {
            found,
            name: layer.file.clone(),
            transfer: layer.transfer.clone(),
            layer: layer.layer.clone(),
            cover: true,
            depth: None,
            params: own.clone(),
        };
        let header = faults.take(file.header());
        let (Some(header), Some(model)) = (header, &model) else { continue };
        let (width, edge) = (layer.width, layer.edge.unwrap_or_default());
        let wide = width.mm(header.aspect(), distance_mm, center_mm, context.view, &own).map_err(Faults::from);
        let Some(shown_mm) = faults.take(wide) else { continue };
        let width_mm = shown_mm * header.widened(header.overscan);
        let aspect = header.aspect_with(header.overscan);
        let luminance_cd_m2 = layer.luminance.unwrap_or(p.luminance).cd_per_m2();
        let making = PictureSettings { model: std::sync::Arc::clone(model), width_mm, luminance_cd_m2, edge };
        let placed = PlanePlacement { width_mm, height_mm: width_mm / aspect, distance_mm, center_mm };
        // Only the last layer must fill the frame, since there is nothing behind it.
        let is_last = i + 1 == p.layers.len();
        if is_last && width.is_fill() {
            placed.warn_of_fisheye("the last layer", &own, context);
        } else if is_last && layer.edge.is_none() && faults.is_empty() {
            placed.warn_unless_filled("the last layer", &own, context);
        }
        file.warn(&header, context);
        layers.push(Pending { file, header, making, distance_mm, center_mm });
    }
    faults.into_result(())?;
    let stand_in = Layers::new(layers.iter().map(Pending::white).collect());
    let emits = layers.iter().all(|layer| layer.making.edge == Edge::Black);
    Ok(Box::new(DeferredSource::new(Box::new(stand_in), emits, move || {
        let mut faults = Faults::new();
        let read: Vec<(Layer, Vec<Warning>)> = layers.iter().filter_map(|layer| faults.take(layer.read())).collect();
        faults.into_result(())?;
        let (read, doubts): (Vec<Layer>, Vec<Vec<Warning>>) = read.into_iter().unzip();
        let doubts = doubts.concat();
        let lights = read.iter().filter_map(|layer| layer.map.lights.as_ref().map(|lights| lights.pays));
        let Some(pays) = lights.reduce(|a, b| a || b).filter(|_| emits) else {
            return Ok((Box::new(Layers::new(read)), doubts));
        };
        let half = |half| Layers::new(read.iter().map(|layer| layer.half(half)).collect());
        let (lights, rest) = (half(LightPart::Lights), half(LightPart::Rest));
        Ok((Box::new(SplitSource { lights, rest, whole: Layers::new(read), pays }), doubts))
    })))
}

/// A layer whose file has not been read yet.
struct Pending {
    file: PictureFile,
    header: Header,
    making: PictureSettings,
    distance_mm: f64,
    center_mm: [f64; 2],
}

impl Pending {
    fn white(&self) -> Layer {
        let map = self.making.white(self.header.aspect_with(self.header.overscan), &self.file.name);
        Layer { map, cover: None, distance_mm: self.distance_mm, center_mm: self.center_mm }
    }

    /// Reads the layer. Also returns warnings about its file.
    fn read(&self) -> Result<(Layer, Vec<Warning>), Faults> {
        let mut linear = self.making.read(&self.file, self.header.overscan)?;
        let doubts = self.file.warnings(&linear);
        let cover = linear.alpha.take().map(Arc::new);
        let map = self.making.map(linear, &self.file.name);
        Ok((Layer { map, cover, distance_mm: self.distance_mm, center_mm: self.center_mm }, doubts))
    }
}

struct Layer {
    map: PictureTexture,
    /// Coverage (alpha) of each pixel, 0 to 1; `None` if the layer covers everything.
    cover: Option<Arc<Vec<f32>>>,
    distance_mm: f64,
    center_mm: [f64; 2],
}

impl Layer {
    /// Returns this layer with one half of its light, and with the same coverage.
    fn half(&self, half: LightPart) -> Self {
        Self { map: self.map.half(half), cover: self.cover.clone(), ..*self }
    }

    /// Returns, where a ray meets the layer, the coefficients of the light, the fraction of it that belongs to this half, and the
    /// coverage.
    fn at(&self, [x, y, z]: [f64; 3], [l, m, n]: [f64; 3]) -> ([f32; 3], f32, f32) {
        let t = (-self.distance_mm - z) / n;
        let place = self.map.place(x + t * l - self.center_mm[0], y + t * m - self.center_mm[1]);
        let Some(place) = place else { return ([0.0; 3], 1.0, 0.0) };
        let spot = self.map.spot(place);
        let cover = self.cover.as_ref().map_or(1.0, |cover| spot.mix(|cell| [cover[cell]])[0]);
        (spot.mix(|cell| self.map.coefficients[cell]), self.map.share(&spot, |cell| cell), cover)
    }

    /// Returns the coverage where a ray meets the layer; 0 beside it.
    fn cover_at(&self, at: [f64; 3], way: [f64; 3]) -> f32 {
        let t = (-self.distance_mm - at[2]) / way[2];
        let place = self.map.place(at[0] + t * way[0] - self.center_mm[0], at[1] + t * way[1] - self.center_mm[1]);
        let Some(place) = place else { return 0.0 };
        let spot = self.map.spot(place);
        self.cover.as_ref().map_or(1.0, |cover| spot.mix(|cell| [cover[cell]])[0])
    }
}

struct Layers {
    layers: Vec<Layer>,
    spectrum: SpectralPower,
    peak_over_mean: f64,
    /// Cumulative fractions of rays that start on each layer, from front to back.
    sums: Vec<f64>,
}

impl Layers {
    fn new(layers: Vec<Layer>) -> Self {
        // Weight layers by their size as seen from the lens. Occlusion matters little for the choice of wavelengths.
        let seen = |l: &Layer| l.map.width_mm * l.map.height_mm / (l.distance_mm * l.distance_mm);
        let mut spectrum = layers[0].map.mean.scaled(seen(&layers[0]));
        for layer in &layers[1..] {
            let more = layer.map.mean.scaled(seen(layer));
            spectrum.continuum.iter_mut().zip(&more.continuum).for_each(|(a, b)| *a += b);
            spectrum.lines.iter_mut().zip(&more.lines).for_each(|(a, b)| a.power += b.power);
        }
        let peak_over_mean = layers.iter().map(|l| l.map.peak_over_mean).fold(1.0, f64::max) * layers.len() as f64;
        // Layers with little light get some rays, too.
        let light = |l: &Layer| white::luminance_cd_m2(&l.map.mean).max(0.0) * seen(l);
        let all: f64 = layers.iter().map(light).sum();
        let bright = layers.iter().filter(|l| light(l) > 0.0).count().max(1) as f64;
        let part = |l: &Layer| if light(l) > 0.0 { 0.8 * light(l) / all + 0.2 / bright } else { 0.0 };
        let mut sum = 0.0;
        let sums = layers.iter().map(|l| {
            sum += part(l);
            sum
        });
        Self { sums: sums.collect(), layers, spectrum, peak_over_mean }
    }
}

impl Source for Layers {
    fn spectrum(&self) -> &SpectralPower {
        &self.spectrum
    }
    fn peak_over_mean(&self) -> f64 {
        self.peak_over_mean
    }
    fn distance_mm(&self) -> f64 {
        self.layers[0].distance_mm
    }
    fn emit(&self) -> Option<&dyn Emit> {
        self.layers.iter().all(|layer| layer.map.is_bounded()).then_some(self as &dyn Emit)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        Some(self)
    }
    fn describe(&self) -> String {
        let each: Vec<String> = self.layers.iter().map(|l| format!("{} at {} mm", l.map.name, l.distance_mm)).collect();
        format!("layers: {}", each.join(", "))
    }
}

const CHUNK: usize = 64;

impl Radiance for Layers {
    fn radiance(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for start in (0..c.x.len()).step_by(CHUNK) {
            let end = (start + CHUNK).min(c.x.len());
            let len = end - start;
            let mut passes = [0.0_f64; CHUNK];
            for i in start..end {
                if c.state[i] == ALIVE && !(c.n[i] < 0.0) {
                    c.state[i] = Loss::Absorbed.state(0);
                }
                passes[i - start] = f64::from(c.state[i] == ALIVE);
            }
            let (wavelength, line) = (&c.wavelength_nm[start..end], &c.line[start..end]);
            let mut sum = [0.0_f64; CHUNK];
            for layer in &self.layers {
                let mut colors = [[0.0_f32; 3]; CHUNK];
                let mut own = passes;
                for k in 0..len {
                    if passes[k] > 0.0 {
                        let i = start + k;
                        let (color, share, cover) = layer.at([c.x[i], c.y[i], c.z[i]], [c.l[i], c.m[i], c.n[i]]);
                        colors[k] = color;
                        own[k] *= f64::from(share);
                        passes[k] *= 1.0 - f64::from(cover);
                    }
                    own[k] *= layer.map.scale;
                }
                layer.map.model.evaluate(&colors[..len], wavelength, line, &mut own[..len]);
                sum.iter_mut().zip(&own).take(len).for_each(|(sum, own)| *sum += own);
            }
            c.weight[start..end].iter_mut().zip(&sum).for_each(|(weight, sum)| *weight *= sum);
        }
    }
}

impl Emit for Layers {
    fn place(&self, rays: &mut RayBatch, u: &[f64], v: &[f64]) {
        let c = rays.columns_mut();
        let total = self.sums.last().copied().unwrap_or(0.0);
        for i in 0..c.x.len() {
            let at = u[i] * total;
            let k = self.sums.partition_point(|sum| *sum <= at).min(self.sums.len() - 1);
            let from = if k > 0 { self.sums[k - 1] } else { 0.0 };
            let part = self.sums[k] - from;
            let rest = if part > 0.0 { ((at - from) / part).clamp(0.0, 1.0) } else { u[i] };
            let layer = &self.layers[k];
            let (x, y, area) = layer.map.draw(rest, v[i]);
            (c.x[i], c.y[i], c.z[i]) = (x + layer.center_mm[0], y + layer.center_mm[1], -layer.distance_mm);
            c.weight[i] *= layer.map.scale * if part > 0.0 { area * total / part } else { 0.0 };
            c.tag[i] = k as u32;
        }
    }

    /// Multiplies by the transmission of the layers in front, which is known once the direction is set.
    fn radiate(&self, rays: &mut RayBatch) {
        let c = rays.columns_mut();
        for start in (0..c.x.len()).step_by(CHUNK) {
            let end = (start + CHUNK).min(c.x.len());
            let mut colors = [[0.0_f32; 3]; CHUNK];
            for i in start..end {
                let (from, way) = ([c.x[i], c.y[i], c.z[i]], [c.l[i], c.m[i], c.n[i]]);
                let (before, from_layer) = self.layers.split_at(c.tag[i] as usize);
                let passes = before.iter().fold(1.0, |a, layer| a * (1.0 - f64::from(layer.cover_at(from, way))));
                if c.state[i] == ALIVE && passes == 0.0 {
                    c.state[i] = Loss::Absorbed.state(0);
                }
                if c.state[i] == ALIVE {
                    let (color, share, _) = from_layer[0].at(from, way);
                    colors[i - start] = color;
                    c.weight[i] *= f64::from(share) * passes * way[2].abs();
                }
            }
            let (wavelength, line) = (&c.wavelength_nm[start..end], &c.line[start..end]);
            // All layers have one color model.
            self.layers[0].map.model.evaluate(&colors[..end - start], wavelength, line, &mut c.weight[start..end]);
        }
    }
}
