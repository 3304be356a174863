//! The depth of a picture, from what a file says to millimetres along the axis.

use super::{find, trouble};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, Params, Positive, Ratio, StageNode};
use spectra_core::registry::Context;
use spectra_core::resources::Found;
use spectra_pictures::read::{self, Choice, Linear};

/// `depth` of a picture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct DepthParams {
    /// A file of its own with the depth channel, an OpenEXR of the picture's size; the picture's file if absent.
    file: Option<String>,
    /// The channel of the file that holds the depth; `Z` if absent.
    channel: Option<String>,
    /// What its numbers count: `mm`, `cm`, `m`, `in` or `ft`; `mm` if absent.
    unit: Option<DepthUnit>,
    /// What the numbers are multiplied by besides, above 0; 1 if absent.
    #[schemars(extend("exclusiveMinimum" = 0))]
    scale: Option<f64>,
    /// What is nearer is taken to be there, mm if bare; nothing is moved if absent.
    near: Option<Positive<Length>>,
    /// What is farther, or infinitely far, is taken to be there, mm if bare; nothing is moved if absent.
    far: Option<Positive<Length>>,
    /// Along what the numbers count: `z`, the axis, or `ray`, the line of sight; `z` if absent.
    kind: Option<Along>,
    /// Depths of neighbors that differ by more than this part, 0 to 1, belong to different things; 5 % if absent.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    edge: Option<Ratio>,
    /// Distance of the center of projection behind the first vertex, mm if bare; at the vertex if absent.
    eye: Option<Length>,
}

/// Depth as the section says it.
pub(super) struct Depth {
    params: Params,
    p: DepthParams,
    unit_mm: f64,
    pub along_ray: bool,
    pub edge: f64,
    pub eye_mm: f64,
    /// The file of its own.
    found: Option<Found>,
}

/// The units that depth channels come in.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum DepthUnit {
    Mm,
    Cm,
    M,
    In,
    Ft,
}

impl DepthUnit {
    /// One of it, mm.
    fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::In => 25.4,
            Self::Ft => 304.8,
        }
    }
}

/// Along what depth counts: the axis or the line of sight.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Along {
    Z,
    Ray,
}

impl Depth {
    pub(super) fn read(node: &StageNode, context: &Context<'_>) -> Result<Self, Faults> {
        let params = Params::section(node.node().clone(), node.path())?;
        let p: DepthParams = params.parse()?;
        let mut faults = Faults::new();
        let unit_mm = p.unit.map_or(1.0, DepthUnit::mm) * p.scale.unwrap_or(1.0);
        let edge = p.edge.map_or(0.05, Ratio::number);
        if let (Some(near), Some(far)) = (p.near, p.far)
            && near.mm() >= far.mm()
        {
            faults.push(params.fault("far", "`far` must be farther than `near`"));
        }
        let eye_mm = p.eye.map_or(0.0, Length::mm);
        let found = p.file.as_ref().and_then(|file| faults.take(find(file, &params, context)));
        faults.into_result(())?;
        Ok(Self { unit_mm, along_ray: p.kind == Some(Along::Ray), edge, eye_mm, found, params, p })
    }

    /// The channel, where the picture's own file holds it.
    pub(super) fn channel(&self) -> Option<&str> {
        self.p.file.is_none().then(|| self.name())
    }

    fn name(&self) -> &str {
        self.p.channel.as_deref().unwrap_or("Z")
    }

    /// Depth of each pixel along the axis from the center of projection, mm. `plane_mm` is the distance of the plane from
    /// there on which the picture measures `width_mm`.
    pub(super) fn of(&self, picture: &Linear, plane_mm: f64, width_mm: f64) -> Result<Vec<f32>, Faults> {
        let own = match (&self.p.file, &self.found) {
            (None, _) | (_, None) => None,
            (Some(file), Some(found)) => {
                let choice = Choice { depth: Some(self.name()), ..Choice::default() };
                let read = read::depth(found, choice).map_err(|e| Faults::from(trouble(file, &e, &self.params)))?;
                if (read.width, read.height) != (picture.width, picture.height) {
                    let [a, b] = [(read.width, read.height), (picture.width, picture.height)];
                    let text = format!("the depth has {} x {} pixels, the picture {} x {}", a.0, a.1, b.0, b.1);
                    return Err(self.params.fault("file", text).hint("both must have the same size").into());
                }
                read.depth
            }
        };
        let raw = own.as_ref().or(picture.depth.as_ref()).map_or(&[][..], Vec::as_slice);
        let (near, far) = (self.p.near.map(|l| l.mm()), self.p.far.map(|l| l.mm()));
        let (width, height) = (f64::from(picture.width), f64::from(picture.height));
        let pixel_mm = width_mm / width;
        let mut bad: [Option<usize>; 3] = [None; 3];
        let mut depth = Vec::with_capacity(raw.len());
        for (i, value) in raw.iter().enumerate() {
            let mut mm = f64::from(*value) * self.unit_mm;
            if self.along_ray && mm.is_finite() {
                let x = ((i % picture.width as usize) as f64 + 0.5 - 0.5 * width) * pixel_mm;
                let y = ((i / picture.width as usize) as f64 + 0.5 - 0.5 * height) * pixel_mm / picture.pixel_aspect;
                mm *= plane_mm / (plane_mm * plane_mm + x * x + y * y).sqrt();
            }
            let fault = if mm.is_nan() {
                Some(0)
            } else if mm <= 0.0 {
                Some(1)
            } else {
                mm = mm.max(near.unwrap_or(mm)).min(far.unwrap_or(mm));
                // Beyond what 32 bits hold of millimetres is as good as infinite.
                (mm > 1e30).then_some(2)
            };
            if let Some(kind) = fault {
                bad[kind].get_or_insert(i);
            }
            depth.push(mm as f32);
        }
        let mut faults = Faults::new();
        let texts = [
            ("is not a number", "the renderer wrote no depth there: fill it with a large one, and give `far`"),
            (
                "is 0 or less",
                "depth is measured from the camera; give pixels without depth a large value, and set `far`",
            ),
            ("is infinite", "say where the backdrop stands, such as `far: 1 km`"),
        ];
        for (first, (what, hint)) in bad.iter().zip(texts) {
            if let Some(i) = first {
                let (column, row) = (i % picture.width as usize, i / picture.width as usize);
                let key = if self.p.channel.is_some() { "channel" } else { "file" };
                let text = format!("depth {what} at column {column}, row {row} from the upper left");
                faults.push(self.params.fault(key, text).hint(hint));
            }
        }
        let nearest = depth.iter().fold(f32::INFINITY, |a, b| a.min(*b));
        if faults.is_empty() && f64::from(nearest) <= self.eye_mm {
            let text = format!("the nearest depth, {nearest} mm, lies inside the lens");
            faults.push(self.params.fault("unit", text).hint("are its numbers in another unit? `unit: m`"));
        }
        faults.into_result(depth)
    }
}
