//! Depth of a picture: converts the numbers of a file to millimeters along the axis.

use super::edges::Mixed;
use super::picture_file::{find, trouble};
use super::planes::{self, Pixels};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, Params, Positive, Ratio, StageNode, Warning};
use spectra_core::registry::Context;
use spectra_core::resources::FoundFile;
use spectra_pictures::read::{self, FileProblem, LinearPicture, ReadOptions};

/// `depth` of a picture, as written in a scene.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct DepthParams {
    /// Separate depth file of the same size as the picture: an OpenEXR with the depth channel, or a PNG or TIFF. In a PNG or TIFF the
    /// first channel is used, and integers run from 0 to 1. The picture's own file if left out.
    file: Option<String>,
    /// Channel of the file that holds the depth; `Z` if left out.
    channel: Option<String>,
    /// Unit of the numbers: `mm`, `cm`, `m`, `in` or `ft`; `mm` if left out.
    unit: Option<DepthUnit>,
    /// Further factor of the numbers, not 0; 1 if left out. Write -1 if depth is negative in front of the camera, as from Houdini.
    scale: Option<f64>,
    /// Smallest distance, mm if bare: nearer pixels are moved there; no pixel is moved if left out.
    near: Option<Positive<Length>>,
    /// Largest distance, mm if bare: pixels that are farther, or infinitely far, are moved there; no pixel is moved if left out.
    far: Option<Positive<Length>>,
    /// Meaning of the numbers: `z` for distance along the axis (the default), `ray` for distance along the line of sight, or `inverse` for
    /// one over the distance along the axis, as from Nuke and from depth estimated from photographs.
    kind: Option<DepthKind>,
    /// Largest relative difference in depth, 0 to 1, between neighbors that belong to the same object; 5 % if left out.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    edge: Option<Ratio>,
    /// Treatment of pixels at edges that contain a mixture of two objects, since a renderer averages color but not depth. `clean` separates
    /// them: the near object covers its fraction of the pixel, and the background continues behind it. `as-is` leaves the mixture at the
    /// depth that the file states. `clean` if left out; a picture without such pixels looks the same with both.
    edges: Option<Edges>,
    /// Distance of the center of projection behind the first vertex, mm if bare; at the vertex if left out.
    eye: Option<Length>,
}

/// The depth of a picture, as read from the section.
pub(super) struct Depth {
    params: Params,
    p: DepthParams,
    unit_mm: f64,
    kind: DepthKind,
    pub edge: f64,
    /// Whether mixed pixels at edges are separated.
    pub cleans_edges: bool,
    pub eye_mm: f64,
    /// Separate depth file, if there is one.
    found: Option<FoundFile>,
}

/// Treatment of mixed pixels at edges.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Edges {
    Clean,
    AsIs,
}

/// Unit of the numbers of a depth channel.
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
    /// Length of the unit, mm.
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

/// Meaning of the numbers of a depth channel.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum DepthKind {
    Z,
    Ray,
    Inverse,
}

impl Depth {
    pub(super) fn read(node: &StageNode, context: &Context<'_>) -> Result<Self, Faults> {
        let params = Params::section(node.node().clone(), node.path())?;
        let p: DepthParams = params.parse()?;
        let mut faults = Faults::new();
        let unit_mm = p.unit.map_or(1.0, DepthUnit::mm) * p.scale.unwrap_or(1.0);
        if p.scale == Some(0.0) {
            faults.push(
                params
                    .fault("scale", "all depths would be 0")
                    .hint("write 1, or -1 if depth is negative in front of the camera"),
            );
        }
        let edge = p.edge.map_or(0.05, Ratio::number);
        if let (Some(near), Some(far)) = (p.near, p.far)
            && near.mm() >= far.mm()
        {
            faults.push(params.fault("far", "`far` must be farther than `near`"));
        }
        let eye_mm = p.eye.map_or(0.0, Length::mm);
        let found = p.file.as_ref().and_then(|file| faults.take(find(file, &params, context)));
        faults.into_result(())?;
        let (kind, cleans_edges) = (p.kind.unwrap_or(DepthKind::Z), p.edges != Some(Edges::AsIs));
        Ok(Self { unit_mm, kind, edge, cleans_edges, eye_mm, found, params, p })
    }

    /// Returns the depth channel if the picture's own file holds it.
    pub(super) fn channel(&self) -> Option<&str> {
        self.p.file.is_none().then(|| self.name())
    }

    fn name(&self) -> &str {
        self.p.channel.as_deref().unwrap_or("Z")
    }

    /// Computes the depth of each pixel along the axis, in mm from the center of projection. `plane_mm` is the distance from
    /// there to the plane on which the picture with its `overscan` is `width_mm` wide. Fails for depths that are not positive and
    /// finite.
    pub(super) fn of(
        &self,
        picture: &LinearPicture,
        plane_mm: f64,
        width_mm: f64,
        overscan: [u32; 2],
    ) -> Result<Vec<f32>, Faults> {
        let own = match (&self.p.file, &self.found) {
            (None, _) | (_, None) => None,
            (Some(file), Some(found)) => {
                let read =
                    self.own(file, found, overscan).map_err(|e| Faults::from(trouble(file, &e, &self.params)))?;
                if (read.width, read.height) != (picture.width, picture.height) {
                    let [a, b] = [(read.width, read.height), (picture.width, picture.height)];
                    let text = format!("the depth has {} x {} pixels, the picture {} x {}", a.0, a.1, b.0, b.1);
                    return Err(self.params.fault("file", text).hint("name a depth file of the picture's size").into());
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
            let mut mm = match self.kind {
                DepthKind::Inverse => self.unit_mm / f64::from(*value),
                DepthKind::Z | DepthKind::Ray => f64::from(*value) * self.unit_mm,
            };
            if self.kind == DepthKind::Ray && mm.is_finite() {
                let x = ((i % picture.width as usize) as f64 + 0.5 - 0.5 * width) * pixel_mm;
                let y = ((i / picture.width as usize) as f64 + 0.5 - 0.5 * height) * pixel_mm / picture.pixel_aspect;
                mm *= plane_mm / (plane_mm * plane_mm + x * x + y * y).sqrt();
            }
            let fault = if mm.is_nan() {
                Some(0)
            } else if mm <= 0.0 {
                Some(1)
            } else {
                mm = mm.max(near.unwrap_or(0.0)).min(far.unwrap_or(f64::INFINITY));
                // A distance that 32 bits cannot hold in millimeters counts as infinite.
                (mm > 1e30).then_some(2)
            };
            if let Some(kind) = fault {
                bad[kind].get_or_insert(i);
            }
            depth.push(mm as f32);
        }
        let mut faults = Faults::new();
        let against = raw.iter().filter(|v| **v < 0.0).count() > raw.len() / 2;
        let texts = [
            ("is not a number", "the renderer wrote no depth there: replace it with a large value, and set `far`"),
            (
                "is 0 or less",
                if against && self.unit_mm > 0.0 {
                    "most of it is negative, measured against the view: write `scale: -1`, or reverse the sign of your `scale`"
                } else if self.kind == DepthKind::Z && raw.iter().all(|v| (0.0..=1.0).contains(v)) {
                    "give pixels without depth a large value, and set `far`. The depth runs from 0 to 1: if it is the inverse of the \
                     distance, write `kind: inverse`; if it is alpha, another `channel`; if it is normalized, export it in meters"
                } else {
                    "depth is measured from the camera; give pixels without depth a large value, and set `far`"
                },
            ),
            ("is infinite", "write the distance of the backdrop, such as `far: 1 km`"),
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
            faults.push(self.params.fault("unit", text).hint("is the depth in a different unit, such as `unit: m`?"));
        }
        faults.into_result(depth)
    }

    /// Describes for the summary how the numbers were read: channel, kind, unit and factor, which of them are assumed, and how many of
    /// the picture's pixels were mixed.
    pub(super) fn describe(&self, pixels: usize, mixed: Option<&Mixed>) -> String {
        let unit = match self.p.unit {
            None => "mm, assumed",
            Some(DepthUnit::Mm) => "mm",
            Some(DepthUnit::Cm) => "cm",
            Some(DepthUnit::M) => "m",
            Some(DepthUnit::In) => "in",
            Some(DepthUnit::Ft) => "ft",
        };
        let kind = match self.kind {
            DepthKind::Z => "along the axis",
            DepthKind::Ray => "along the ray",
            DepthKind::Inverse => "inverse, along the axis",
        };
        let assumed = if self.p.kind.is_none() { ", assumed" } else { "" };
        let scale = self.p.scale.map(|scale| format!(" times {scale}")).unwrap_or_default();
        let mixed = mixed.map(|mixed| {
            format!(
                "; {:.2} % of its pixels were mixed at edges and separated",
                100.0 * mixed.parted as f64 / pixels as f64
            )
        });
        format!("`{}`{scale} in {unit}; {kind}{assumed}{}", self.name(), mixed.unwrap_or_default())
    }

    /// Returns the overscan of the depth, pixels on each side: at most `overscan`, that of the picture.
    pub(super) fn overscan(&self, overscan: [u32; 2]) -> [u32; 2] {
        let (Some(name), Some(found)) = (&self.p.file, &self.found) else { return overscan };
        if overscan == [0; 2] {
            return overscan;
        }
        let choice = ReadOptions { name, depth: Some(self.name()), ..ReadOptions::default() };
        let [x, y] = read::depth_overscan(found, choice);
        [overscan[0].min(x), overscan[1].min(y)]
    }

    /// Reads a separate depth file: the channel of an OpenEXR, or the first channel of any other picture as linear numbers.
    fn own(&self, name: &str, found: &FoundFile, overscan: [u32; 2]) -> Result<LinearPicture, FileProblem> {
        let choice = ReadOptions { name, depth: Some(self.name()), overscan, ..ReadOptions::default() };
        if read::is_exr(found)? {
            return read::depth(found, choice);
        }
        let choice = ReadOptions { name, transfer: Some("linear"), is_plain: true, ..ReadOptions::default() };
        let mut read = read::decode(found, choice)?;
        if read.clipped_at.is_some() && self.p.scale.is_none() {
            return Err(FileProblem {
                key: "file",
                text: "its integers are read as values from 0 to 1, which are not yet distances".to_owned(),
                hint: Some(
                    "write what 1 stands for: `scale: 65535, unit: mm` if one step of 16 bits is a millimeter, `scale: 10, unit: m` if \
                     white is 10 m away; with `kind: inverse` write the distance of white, such as `scale: 1, unit: m` for 1 m"
                        .to_owned(),
                ),
            });
        }
        read.depth = Some(read.rgb.iter().map(|[first, ..]| *first).collect());
        Ok(read)
    }

    /// Returns a warning if depth that was read as distance along the axis is probably distance along the ray, or vice versa, which curves
    /// walls and floors.
    pub(super) fn kind_warning(&self, depth: &[f32], plane_mm: f64, pixels: Pixels) -> Option<Warning> {
        let (is_ray, other, bend) = match self.kind {
            DepthKind::Inverse => return None,
            DepthKind::Z => (false, "ray", "toward the edges they bend away from the lens"),
            DepthKind::Ray => (true, "z", "toward the edges they bend toward the lens"),
        };
        let farthest_mm = self.p.far.map_or(f64::INFINITY, |l| l.mm());
        if !planes::are_straighter_as(!is_ray, depth, plane_mm, farthest_mm, pixels) {
            return None;
        }
        let read = if is_ray { "`kind: ray`" } else { "`kind: z`, distance along the axis" };
        let text = format!("read as {read}, the depth has walls and floors that are not flat: {bend}");
        let hint = format!("did you mean `kind: {other}`? Then they are flat");
        Some(self.params.fault(if self.p.kind.is_some() { "kind" } else { "channel" }, text).hint(hint).into())
    }

    /// Returns a warning if the depths (mm) were probably read wrongly. It is given if most depths lie far from the plane but a
    /// different unit or kind would bring them near, or if the depths run from 0 to 1. It is also given if the nearest depth is
    /// less than two focal lengths from the lens and the plane is not.
    pub(super) fn scale_warning(&self, depth: &[f32], plane_mm: f64, focal_length_mm: Option<f64>) -> Option<Warning> {
        let farthest = self.p.far.map_or(f64::INFINITY, |l| l.mm());
        let mut all: Vec<f32> = depth.iter().copied().filter(|mm| f64::from(*mm) < farthest && *mm < 1e10).collect();
        if all.is_empty() {
            return None;
        }
        let middle = all.len() / 2;
        let median_mm = f64::from(*all.select_nth_unstable_by(middle, f32::total_cmp).1);
        let off = |mm: f64| (mm / plane_mm).max(plane_mm / mm);
        let [least, most] = all.iter().fold([f32::INFINITY, 0.0], |[a, b]: [f32; 2], d| [a.min(*d), b.max(*d)]);
        let is_normalised = self.kind == DepthKind::Z
            && (f64::from(most) / self.unit_mm - 1.0).abs() < 1e-6
            && f64::from(least) < 0.5 * self.unit_mm;
        // Alpha or normalized depth, read as meters, lies within the first meter, and the plane beyond it.
        let is_within_one = is_normalised && plane_mm > f64::from(most);
        // In a view into the distance the plane lies in front of most objects, but not of all.
        let is_view = median_mm > plane_mm && f64::from(least) < 3.0 * plane_mm;
        let near = focal_length_mm.filter(|f| f64::from(least) < NEAR * f && plane_mm > 2.0 * NEAR * f);
        if !is_within_one && (off(median_mm) < FAR_OFF || is_view) {
            return near.map(|f| {
                let text = format!(
                    "the nearest depth is {}, less than two focal lengths of the lens ({}), but the plane of the picture is at {}",
                    length(f64::from(least)),
                    length(f),
                    length(plane_mm)
                );
                // A little beyond two focal lengths, in whole centimeters.
                let near_cm = (0.22 * f).ceil();
                let hint = format!(
                    "is the depth in a different unit, or are a few values wrong? `near: {near_cm} cm` moves nearer pixels to that distance"
                );
                self.params.fault("unit", text).hint(hint).into()
            });
        }
        let said = match self.kind {
            DepthKind::Inverse => self.unit_mm / median_mm,
            DepthKind::Z | DepthKind::Ray => median_mm / self.unit_mm,
        };
        let stretch = self.p.scale.unwrap_or(1.0);
        // With the right unit or kind the plane lies among the objects, near the middle of them.
        let kind = if self.kind == DepthKind::Z { "" } else { ", kind: z" };
        let mut others: Vec<(String, f64)> = [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("in", 25.4), ("ft", 304.8)]
            .into_iter()
            .filter(|(unit, _)| self.p.unit.is_none() || !matches!(*unit, "in" | "ft"))
            .map(|(unit, mm)| (format!("`unit: {unit}{kind}`"), said * stretch * mm))
            .collect();
        others.push(("`unit: m, kind: inverse`".to_owned(), 1000.0 * stretch / said));
        // A view, with the plane in front of most objects, is accepted, too. Feet and inches are suggested last.
        let as_view = |mm: f64| mm > plane_mm && f64::from(least) * (mm / median_mm) < plane_mm;
        let is_z = |remedy: &str| !remedy.contains("inverse");
        let other = others
            .into_iter()
            .filter(|(remedy, mm)| off(*mm) < 0.5 * FAR_OFF || is_z(remedy) && off(*mm) < FAR_OFF && as_view(*mm))
            .min_by(|a, b| {
                let rank = |(remedy, mm): &(String, f64)| {
                    let is_rare = remedy.starts_with("`unit: ft") || remedy.starts_with("`unit: in");
                    off(*mm) * if is_rare { 4.0 } else { 1.0 }
                };
                rank(a).total_cmp(&rank(b))
            });
        let text = format!(
            "half of the depth is nearer than {}, but the plane of the picture is at {}",
            length(median_mm),
            length(plane_mm)
        );
        let hint = match other {
            _ if is_normalised => {
                "the values run to exactly 1: if this is normalized depth, export it in meters; if it is alpha, name another `channel`"
                    .to_owned()
            }
            Some((remedy, fits)) => format!("did you mean {remedy}? Then half would be nearer than {}", length(fits)),
            None => return None,
        };
        Some(self.params.fault("unit", text).hint(hint).into())
    }
}

/// Distance, in focal lengths, within which there is no object in front of a lens except in close-ups.
const NEAR: f64 = 2.0;
/// Ratio of the median depth to the distance of the plane, or its inverse, from which the depth is doubted.
const FAR_OFF: f64 = 10.0;

/// Formats a length for a message.
fn length(mm: f64) -> String {
    if mm >= 1000.0 { format!("{:.3} m", mm / 1000.0) } else { format!("{mm:.2} mm") }
}
