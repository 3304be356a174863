//! The depth of a picture, from what a file says to millimetres along the axis.

use super::edges::Mixed;
use super::planes::{self, Pixels};
use super::{find, trouble};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, Params, Positive, Ratio, StageNode, Warning};
use spectra_core::registry::Context;
use spectra_core::resources::Found;
use spectra_pictures::read::{self, Choice, Linear, Trouble};

/// `depth` of a picture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct DepthParams {
    /// A file of its own of the picture's size: an OpenEXR with the depth channel, or a PNG or TIFF, of which the first channel counts and
    /// integers run from 0 to 1; the picture's file if absent.
    file: Option<String>,
    /// The channel of the file that holds the depth; `Z` if absent.
    channel: Option<String>,
    /// What its numbers count: `mm`, `cm`, `m`, `in` or `ft`; `mm` if absent.
    unit: Option<DepthUnit>,
    /// What the numbers are multiplied by besides, not 0; 1 if absent. -1 where they count against the view, as from Houdini.
    scale: Option<f64>,
    /// What is nearer is taken to be there, mm if bare; nothing is moved if absent.
    near: Option<Positive<Length>>,
    /// What is farther, or infinitely far, is taken to be there, mm if bare; nothing is moved if absent.
    far: Option<Positive<Length>>,
    /// What the numbers are: distance along the axis, `z`, or along the line of sight, `ray`; or `inverse`, one over that along the axis, as
    /// Nuke and depth guessed from photographs have it; `z` if absent.
    kind: Option<DepthKind>,
    /// Depths of neighbors that differ by more than this part, 0 to 1, belong to different things; 5 % if absent.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    edge: Option<Ratio>,
    /// What becomes of pixels at edges that hold a mixture of two things, since a renderer averages color and not depth: `clean` takes them
    /// apart, so that the near thing covers its share of the pixel and what is behind goes on there; `as-is` leaves the mixture at the depth
    /// that the file says. `clean` if absent; a picture without such pixels is the same with both.
    edges: Option<Edges>,
    /// Distance of the center of projection behind the first vertex, mm if bare; at the vertex if absent.
    eye: Option<Length>,
}

/// Depth as the section says it.
pub(super) struct Depth {
    params: Params,
    p: DepthParams,
    unit_mm: f64,
    kind: DepthKind,
    pub edge: f64,
    /// Whether mixed pixels at edges are taken apart.
    pub cleans_edges: bool,
    pub eye_mm: f64,
    /// The file of its own.
    found: Option<Found>,
}

/// What becomes of mixed pixels.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Edges {
    Clean,
    AsIs,
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

/// What depth counts.
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
                params.fault("scale", "all depths would be 0").hint("1, or -1 where depth counts against the view"),
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

    /// The channel, where the picture's own file holds it.
    pub(super) fn channel(&self) -> Option<&str> {
        self.p.file.is_none().then(|| self.name())
    }

    fn name(&self) -> &str {
        self.p.channel.as_deref().unwrap_or("Z")
    }

    /// Depth of each pixel along the axis from the center of projection, mm. `plane_mm` is the distance of the plane from
    /// there on which the picture with its `overscan` measures `width_mm`.
    pub(super) fn of(
        &self,
        picture: &Linear,
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
                // Beyond what 32 bits hold of millimetres is as good as infinite.
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
            ("is not a number", "the renderer wrote no depth there: fill it with a large one, and give `far`"),
            (
                "is 0 or less",
                if against && self.unit_mm > 0.0 {
                    "most of it is negative: it counts against the view, so write `scale: -1`, or turn the sign of the `scale` that is there"
                } else if self.kind == DepthKind::Z && raw.iter().all(|v| (0.0..=1.0).contains(v)) {
                    "give pixels without depth a large value, and set `far`; or, since it runs from 0 to 1, write `kind: inverse` for one \
                     over the distance, another `channel` where it is alpha, and normalised depth anew in meters"
                } else {
                    "depth is measured from the camera; give pixels without depth a large value, and set `far`"
                },
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

    /// What its numbers are taken for, for the summary: channel, kind, unit and factor, which of them are assumed, and how many of
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
            format!("; {:.2} % of its pixels, mixed at edges, taken apart", 100.0 * mixed.parted as f64 / pixels as f64)
        });
        format!("`{}`{scale} in {unit}; {kind}{assumed}{}", self.name(), mixed.unwrap_or_default())
    }

    /// How far the depth reaches beyond the picture, at most as far as the picture does itself, `overscan` pixels.
    pub(super) fn overscan(&self, overscan: [u32; 2]) -> [u32; 2] {
        let (Some(name), Some(found)) = (&self.p.file, &self.found) else { return overscan };
        if overscan == [0; 2] {
            return overscan;
        }
        let choice = Choice { name, depth: Some(self.name()), ..Choice::default() };
        let [x, y] = read::depth_overscan(found, choice);
        [overscan[0].min(x), overscan[1].min(y)]
    }

    /// A file of its own: the channel of an OpenEXR, or the first one of any other picture as linear numbers.
    fn own(&self, name: &str, found: &Found, overscan: [u32; 2]) -> Result<Linear, Trouble> {
        let choice = Choice { name, depth: Some(self.name()), overscan, ..Choice::default() };
        if read::is_exr(found)? {
            return read::depth(found, choice);
        }
        let choice = Choice { name, transfer: Some("linear"), is_plain: true, ..Choice::default() };
        let mut read = read::decode(found, choice)?;
        if read.clipped_at.is_some() && self.p.scale.is_none() {
            return Err(Trouble {
                key: "file",
                text: "its integers are read as 0 to 1, which is no distance yet".to_owned(),
                hint: Some(
                    "write what 1 stands for: `scale: 65535, unit: mm` if each of 16 bits is a millimeter, `scale: 10, unit: m` if white \
                     is 10 m away; with `kind: inverse` how far away white is, `scale: 1, unit: m` for 1 m"
                        .to_owned(),
                ),
            });
        }
        read.depth = Some(read.rgb.iter().map(|[first, ..]| *first).collect());
        Ok(read)
    }

    /// Whether depth that was read as distance along the axis is one along the ray, or the other way round, which bends walls and floors.
    pub(super) fn doubt_kind(&self, depth: &[f32], plane_mm: f64, pixels: Pixels) -> Option<Warning> {
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
        let text = format!("read as {read}, its walls and floors are not plane: {bend}");
        let hint = format!("did you mean `kind: {other}`? Then they are");
        Some(self.params.fault(if self.p.kind.is_some() { "kind" } else { "channel" }, text).hint(hint).into())
    }

    /// What makes depths doubtful that were read as millimetres: most of them lie far from the plane, where another unit or kind would
    /// bring them near, or they run from 0 to 1; or the nearest lies under two focal lengths from the lens, while the plane is no close-up.
    pub(super) fn doubt(&self, depth: &[f32], plane_mm: f64, focal_length_mm: Option<f64>) -> Option<Warning> {
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
        // Alpha, and what is normalised, as meters: all of it lies within the first one, and the plane beyond.
        let is_within_one = is_normalised && plane_mm > f64::from(most);
        // A view into the distance has its plane in front of most things, but not of all.
        let is_view = median_mm > plane_mm && f64::from(least) < 3.0 * plane_mm;
        let near = focal_length_mm.filter(|f| f64::from(least) < NEAR * f && plane_mm > 2.0 * NEAR * f);
        if !is_within_one && (off(median_mm) < FAR_OFF || is_view) {
            return near.map(|f| {
                let text = format!(
                    "its nearest depth is {}, under two focal lengths of the lens ({}), while the plane of the picture stands at {}",
                    length(f64::from(least)),
                    length(f),
                    length(plane_mm)
                );
                // A little beyond two focal lengths, in whole centimeters.
                let near_cm = (0.22 * f).ceil();
                let hint = format!(
                    "are its numbers in another unit, or a few of them wrong? `near: {near_cm} cm` takes what is nearer to be there"
                );
                self.params.fault("unit", text).hint(hint).into()
            });
        }
        let said = match self.kind {
            DepthKind::Inverse => self.unit_mm / median_mm,
            DepthKind::Z | DepthKind::Ray => median_mm / self.unit_mm,
        };
        let stretch = self.p.scale.unwrap_or(1.0);
        // With another unit or kind the plane would lie among the things, and about the middle of them.
        let kind = if self.kind == DepthKind::Z { "" } else { ", kind: z" };
        let mut others: Vec<(String, f64)> = [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("in", 25.4), ("ft", 304.8)]
            .into_iter()
            .filter(|(unit, _)| self.p.unit.is_none() || !matches!(*unit, "in" | "ft"))
            .map(|(unit, mm)| (format!("`unit: {unit}{kind}`"), said * stretch * mm))
            .collect();
        others.push(("`unit: m, kind: inverse`".to_owned(), 1000.0 * stretch / said));
        // Where the plane stands in front of most things a view fits, too; feet and inches are asked about last.
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
            "half of the depth lies nearer than {}, while the plane of the picture stands at {}",
            length(median_mm),
            length(plane_mm)
        );
        let hint = match other {
            _ if is_normalised => {
                "its numbers run to exactly 1: normalised depth has to be written anew in meters; of alpha name another `channel`".to_owned()
            }
            Some((remedy, fits)) => format!("did you mean {remedy}? Half would lie nearer than {}", length(fits)),
            None => return None,
        };
        Some(self.params.fault("unit", text).hint(hint).into())
    }
}

/// Focal lengths within which nothing stands before a lens but in close-ups.
const NEAR: f64 = 2.0;
/// How many times farther or nearer than the plane the middle depth is doubted.
const FAR_OFF: f64 = 10.0;

/// A length for people.
fn length(mm: f64) -> String {
    if mm >= 1000.0 { format!("{:.3} m", mm / 1000.0) } else { format!("{mm:.2} mm") }
}
