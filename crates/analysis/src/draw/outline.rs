//! Elements as areas: the section of a lens through its axis.

use super::SectionView;
use glam::DVec3;
use spectra_core::math::sin;
use spectra_core::surface::Action;
use spectra_glass::lines;
use spectra_lens::{Element, Lens, LensMedium, Section};

/// Number of points along a surface from edge to edge.
const POINTS: usize = 97;

/// The cut area of a piece of glass.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Closed outline, in mm, in the frame of the lens.
    pub outline: Vec<DVec3>,
    /// Refractive index at the d line.
    pub nd: f64,
    /// Abbe number Vd; 0 if it is not known.
    pub vd: f64,
}

/// The parts of a lens in one section, in mm, in the frame of the lens.
#[derive(Clone, Debug, Default)]
pub struct Outlines {
    /// Pieces of glass.
    pub solids: Vec<Solid>,
    /// Refracting surfaces without glass on either side, such as ideal lenses and gratings in air.
    pub sheets: Vec<Vec<DVec3>>,
    /// Mirrors: the profile from edge to edge, and a point behind the vertex that marks the side to hatch.
    pub mirrors: Vec<(Vec<DVec3>, DVec3)>,
    /// The stop: two blades, each from the edge of the opening outward.
    pub stops: Vec<[DVec3; 2]>,
}

/// Cuts a lens in the section of `view`. `reach_mm` holds for each element the height up to which rays meet it
/// ([`super::reach_mm`]). It sizes elements without a stated size.
pub fn outlines(lens: &Lens, view: &SectionView, reach_mm: &[f64]) -> Outlines {
    let mut all = Outlines::default();
    let sizes: Vec<f64> = (0..lens.elements.len()).map(|at| size_mm(lens, at, reach_mm)).collect();
    for (at, e) in lens.elements.iter().enumerate() {
        let next = lens.elements.get(at + 1);
        if let Some(solid) = &e.solid {
            if view.section == Section::Y {
                let outline = solid.corners().iter().map(|[y, z]| e.pose.point(DVec3::new(0.0, *y, *z))).collect();
                let (nd, vd) = figures(&lens.media[solid.medium]);
                all.solids.push(Solid { outline, nd, vd });
            }
            continue;
        }
        let solid_behind = is_solid(&lens.media[e.medium_after]) && e.action != Action::Reflect;
        if let Some(next) = next.filter(|_| solid_behind && e.medium_after != 0) {
            let outer = sizes[at].max(sizes[at + 1]);
            let (nd, vd) = figures(&lens.media[e.medium_after]);
            all.solids.push(Solid { outline: cut(e, next, [sizes[at], sizes[at + 1]], outer, view), nd, vd });
        }
        let in_glass = is_solid(&lens.media[e.medium_before]) || is_solid(&lens.media[e.medium_after]);
        if e.action == Action::Reflect {
            let normal = if e.along { DVec3::Z } else { DVec3::NEG_Z };
            all.mirrors.push((profile(e, sizes[at], view), e.pose.point(normal)));
        } else if e.action == Action::Refract && !in_glass {
            all.sheets.push(profile(e, sizes[at], view));
        }
        // A stop without a stated size is drawn as wide as the light on it.
        let open = e.semi_diameter_mm.or_else(|| reach_mm.get(at).copied().filter(|reach| *reach > 0.0));
        if e.stop
            && let Some(open) = open
        {
            let blade = 0.45 * open.max(0.4 * sizes.iter().copied().fold(0.0, f64::max));
            for side in [-1.0, 1.0] {
                let at = |h: f64| e.pose.point(view.across(side * h, sag(e, side * h, view)));
                all.stops.push([at(open), at(open) + e.pose.direction(view.across(side * blade, 0.0))]);
            }
        }
    }
    all
}

/// Returns the index at the d line and the Abbe number Vd (0 without dispersion).
fn figures(medium: &LensMedium) -> (f64, f64) {
    let nd = medium.medium.index(lines::D.wavelength_nm);
    let (nf, nc) = (medium.medium.index(lines::F.wavelength_nm), medium.medium.index(lines::C.wavelength_nm));
    (nd, if nf > nc { (nd - 1.0) / (nf - nc) } else { 0.0 })
}

fn is_solid(medium: &LensMedium) -> bool {
    !matches!(medium.medium, spectra_glass::Medium::Air) && medium.label != "air"
}

/// Returns the semi-diameter to which an element is drawn, mm.
fn size_mm(lens: &Lens, at: usize, reach_mm: &[f64]) -> f64 {
    let e = &lens.elements[at];
    if let Some(size) = e.outer_semi_diameter_mm.or(e.semi_diameter_mm) {
        return size;
    }
    let stated = |e: &Element| e.outer_semi_diameter_mm.or(e.semi_diameter_mm);
    // Use the size of the surface before in a cemented group, else that of the other side of the same glass.
    let before = (is_solid(&lens.media[e.medium_before]) && at > 0).then(|| stated(&lens.elements[at - 1])).flatten();
    let after = is_solid(&lens.media[e.medium_after]).then(|| lens.elements.get(at + 1).and_then(stated)).flatten();
    before.or(after).unwrap_or_else(|| (1.08 * reach_mm.get(at).copied().unwrap_or(0.0)).max(1e-3))
}

fn sag(e: &Element, height_mm: f64, view: &SectionView) -> f64 {
    let local = view.across(height_mm, 0.0);
    e.surface.sag_mm(local.x, local.y).unwrap_or(0.0)
}

/// Returns the profile of a surface from its lower to its upper edge, as far as the surface is defined, mm.
fn profile(e: &Element, size_mm: f64, view: &SectionView) -> Vec<DVec3> {
    let points = (0..POINTS).filter_map(|i| {
        // Points are closer together toward the edges, where steep surfaces bend away.
        let h = size_mm * sin(std::f64::consts::PI * (i as f64 / (POINTS - 1) as f64 - 0.5));
        let local = view.across(h, 0.0);
        e.surface.sag_mm(local.x, local.y).map(|z| e.pose.point(local + DVec3::new(0.0, 0.0, z)))
    });
    let mut points: Vec<DVec3> = points.collect();
    // A reversed surface runs the other way only where x is cut: keep the order from lower to upper.
    if let (Some(first), Some(last)) = (points.first(), points.last())
        && view.vertical(*first) > view.vertical(*last)
        && e.reversed
    {
        points.reverse();
    }
    points
}

/// Returns the outline between two surfaces: each within its clear size, flat annuli out to the common edge, and chamfers.
fn cut(front: &Element, back: &Element, [a, b]: [f64; 2], outer: f64, view: &SectionView) -> Vec<DVec3> {
    let side = |e: &Element, size: f64| {
        let mut points = profile(e, size, view);
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return points };
        if outer > size * (1.0 + 1e-9) {
            let annulus = e.pose.direction(view.across(outer - size, 0.0));
            let annulus = if view.vertical(annulus) < 0.0 { -annulus } else { annulus };
            points.insert(0, first - annulus);
            points.push(last + annulus);
        }
        chamfer(&mut points, e, view);
        points
    };
    let mut outline = side(front, a);
    let mut rear = side(back, b);
    rear.reverse();
    outline.extend(rear);
    outline
}

/// Bevels both ends of a profile: by the chamfer leg along z, and by the same length inward.
fn chamfer(points: &mut Vec<DVec3>, e: &Element, view: &SectionView) {
    let leg = e.chamfer_mm;
    if leg == 0.0 || points.len() < 2 {
        return;
    }
    let along = e.pose.direction(DVec3::new(0.0, 0.0, leg));
    let inward = e.pose.direction(view.across(leg.abs(), 0.0));
    let inward = if view.vertical(inward) < 0.0 { -inward } else { inward };
    let (first, last) = (points[0], points[points.len() - 1]);
    let end = points.len() - 1;
    points[0] = first + inward;
    points[end] = last - inward;
    points.insert(0, first + along);
    points.push(last + along);
}
