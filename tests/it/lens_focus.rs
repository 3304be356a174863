//! Tests focusing by laws and by real rays, misaligned groups, and reversed lenses.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::math::j0;
use spectra_lens::{FocusError, Lens, Misalignment, Section};
use spectra_optics::{Beam, Criterion, FocusSearch, ObjectPoint, Optics, stop_down};
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::f64::consts::TAU;
use std::path::Path;

fn load(path: &Path) -> Result<Lens, String> {
    spectra_lens::load(&path.to_string_lossy(), &FileResources::beside(Path::new("."))).map_err(|f| f.to_string())
}

fn bundled(path: &str) -> Lens {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a lens")
}

fn written(text: &str) -> Result<Lens, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lens.yaml");
    std::fs::write(&path, text).expect("written");
    load(&path)
}

/// Returns a lens of two nearly thin groups with the given focusing laws.
fn two_groups(laws: &str) -> Result<Lens, String> {
    written(&format!(
        "name: two groups\nsurfaces:\n\
         \x20 - {{kind: sphere, radius: 60, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 10}}\n\
         \x20 - {{kind: sphere, radius: -200, thickness: 8, semi-diameter: 10}}\n\
         \x20 - {{kind: stop, thickness: 8, semi-diameter: 6}}\n\
         \x20 - {{kind: sphere, radius: 150, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 10}}\n\
         \x20 - {{kind: sphere, radius: -70, thickness: 40.5, semi-diameter: 10}}\n\
         groups: [{{name: front, surfaces: [1, 2]}}, {{name: rear, surfaces: [4, 5]}}]\n{laws}"
    ))
}

fn paraxial_miss(lens: &Lens, object_mm: f64) -> f64 {
    lens.paraxial_image_gap_mm(object_mm, lens.reference_nm) - lens.image_gap_mm()
}

fn rms(object_mm: f64, field_deg: f64) -> FocusSearch {
    let light = vec![(587.5618, 1.0)];
    FocusSearch { object_mm, field_rad: field_deg.to_radians(), criterion: Criterion::Rms, light }
}

fn contrast(object_mm: f64, field_deg: f64, per_mm: f64) -> FocusSearch {
    FocusSearch { criterion: Criterion::Contrast { per_mm }, ..rms(object_mm, field_deg) }
}

/// Floating groups: the image plane stays fixed and each group travels in proportion to its factor. The image keeps the distance from
/// the plane that it has at infinity.
#[test]
fn groups_float_by_their_factors() {
    let lens = two_groups("focus: [{group: front, factor: 1}, {group: rear, factor: 0.6}]\n").expect("good");
    for object_mm in [5000.0, 1000.0, 400.0] {
        let near = lens.clone().focused_at(object_mm).expect("focused");
        assert!((paraxial_miss(&near, object_mm) - paraxial_miss(&lens, f64::INFINITY)).abs() < 1e-9);
        // Distances from the image plane, which stays fixed.
        let place = |lens: &Lens, at: usize| lens.image_z_mm() - lens.elements[at].vertex_z_mm();
        let travel = |at: usize| place(&near, at) - place(&lens, at);
        assert!(travel(0) > 0.0 && (travel(0) - travel(1)).abs() < 1e-12);
        assert!((travel(3) / travel(0) - 0.6).abs() < 1e-9 && (travel(3) - travel(4)).abs() < 1e-12);
        assert!(travel(2).abs() < 1e-12, "the stop moved without belonging to a group");
        assert_eq!(near.focused_mm, object_mm);
    }
    assert_eq!(lens.clone().focused_at(f64::INFINITY).expect("as it is").image_z_mm(), lens.image_z_mm());
    // At this distance the groups would have to pass through each other, or no travel is enough.
    assert!(lens.focused_at(20.0).is_err());
}

/// One law that moves all surfaces equals focusing with the whole lens.
#[test]
fn a_law_for_all_is_the_whole_lens() {
    let text = |laws: &str| {
        format!(
            "name: s\nsurfaces:\n  - {{kind: sphere, radius: 60, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 10}}\n  \
             - {{kind: sphere, radius: -60, thickness: 57, semi-diameter: 10}}\n\
             groups: [{{name: all, surfaces: [1, 2]}}]\n{laws}"
        )
    };
    let whole = written(&text("")).expect("good").focused_at(700.0).expect("focused");
    let law = written(&text("focus: [{group: all, factor: 1}]\n")).expect("good").focused_at(700.0).expect("focused");
    assert!((whole.image_gap_mm() - law.image_gap_mm()).abs() < 1e-9);
}

#[test]
fn groups_follow_their_tables() {
    let lens = two_groups("focus: [{group: rear, table: [[inf, 0], [2 m, 0.4], [500, 1.9]]}]\n").expect("good");
    for (object_mm, shift) in [(f64::INFINITY, 0.0), (2000.0, 0.4), (500.0, 1.9)] {
        let near = lens.clone().focused_at(object_mm).expect("in the table");
        assert!((near.elements[3].vertex_z_mm() - (lens.elements[3].vertex_z_mm() - shift)).abs() < 1e-12);
        assert!((near.image_z_mm() - lens.image_z_mm()).abs() < 1e-12);
    }
    assert!(matches!(lens.clone().focused_at(400.0), Err(FocusError::BeyondTable { .. })));
    let far = two_groups("focus: [{group: rear, table: [[inf, 0], [500, 9]]}]\n").expect("good");
    assert!(matches!(far.focused_at(500.0), Err(FocusError::Collision { surface: 3, .. })));
}

/// A group follows the section across, so both sections keep the separation that they have at infinity. Focusing with the whole lens
/// separates them by f^2 / distance, where f differs by the squeeze: 60.5^2 / 1500 - 31.5^2 / 1500 = 1.8 mm.
#[test]
fn both_sections_of_an_anamorphic_lens_are_focused() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/lenses/schneider-anamorphic-60.yaml"));
    let text = text.expect("bundled");
    let whole = written(text.split("focus:\n").next().expect("a lens")).expect("good");
    let both = written(&text).expect("good");
    assert!(both.squeeze == 1.9 && both.focus_laws.len() == 1 && whole.focus_laws.is_empty());
    let apart = |lens: &Lens, object_mm: f64| {
        let [x, y] = [Section::X, Section::Y];
        let gap = |section| lens.paraxial_image_gap_in_mm(section, object_mm, lens.reference_nm);
        (gap(x) - gap(y), gap(y) - lens.image_gap_mm())
    };
    let far = apart(&both, f64::INFINITY);
    for object_mm in [700.0, 1500.0, 5000.0, 1e5] {
        let near = both.clone().focused_at(object_mm).expect("focused");
        let found = apart(&near, object_mm);
        assert!((found.0 - far.0).abs() < 1e-6 && (found.1 - far.1).abs() < 1e-6, "{object_mm}: {found:?} {far:?}");
        // The front group travels a distance that a mount can provide.
        let travel = near.elements[2].thickness_mm - both.elements[2].thickness_mm;
        assert!(travel.abs() < 30.0, "{object_mm}: {travel}");
    }
    let split = apart(&whole.clone().focused_at(1500.0).expect("focused"), 1500.0).0 - far.0;
    assert!((split.abs() / 1.8 - 1.0).abs() < 0.25, "{split}");
}

#[test]
fn faults_of_laws_say_what_to_do() {
    for (laws, word) in [
        ("focus: [{group: raer, factor: 1}]\n", "did you mean `rear`"),
        ("focus: [{group: rear}]\n", "either by a `factor` or by a `table`"),
        ("focus: [{group: rear, factor: 0}]\n", "does not move"),
        ("focus: [{group: rear, factor: 1, section: x}]\n", "follows a section"),
        ("focus: [{group: rear, table: [[500, 1], [inf, 0]]}]\n", "the farthest first"),
        ("focus: [{group: rear, factor: 1}, {group: rear, factor: 2}]\n", "two focusing laws"),
        ("coating: bear\n", "unknown coating"),
        ("coating: {layer: 1.38}\n", "either a `thickness`"),
        ("coating: {layer: 0.2, thickness: 100}\n", "found 0.2, which is out of range"),
        ("coating: {layer: 1.38, thickness: 1 mm}\n", "at most 100 um thick"),
    ] {
        let faults = two_groups(laws).expect_err(laws);
        assert!(faults.contains(word), "{laws}: {faults}");
    }
}

/// Light of a far point on the axis: radii in the image plane, their change along z, and shares of the light (sum 1). Simpson's rule
/// is applied over the area of the front of the lens, with many more rays than a search uses.
struct AxialLight(Vec<[f64; 3]>);

impl AxialLight {
    const STEPS: usize = 8000;

    fn of(lens: &Lens) -> Self {
        let rays_at = |heights: &[f64]| {
            let rays: Vec<_> = heights.iter().map(|h| (DVec3::new(0.0, *h, -100.0), DVec3::Z)).collect();
            trace_weighed(lens, &rays, Travel::Forward)
        };
        let front_mm = lens.elements[0].semi_diameter_mm.expect("a size") * 1.01;
        let steps: Vec<f64> = (0..=1000).map(|k| front_mm * f64::from(k) / 1000.0).collect();
        let alive: Vec<bool> = rays_at(&steps).iter().map(Option::is_some).collect();
        let edge = alive.iter().position(|lives| !lives).expect("a rim");
        assert!(alive[0] && alive[edge..].iter().all(|lives| !lives), "one zone");
        let (mut passes, mut ends) = (steps[edge - 1], steps[edge]);
        for _ in 0..50 {
            let middle = 0.5 * (passes + ends);
            *(if rays_at(&[middle])[0].is_some() { &mut passes } else { &mut ends }) = middle;
        }
        let heights: Vec<f64> = (0..=Self::STEPS).map(|k| passes * (k as f64 / Self::STEPS as f64).sqrt()).collect();
        let simpson = |k: usize| match k {
            0 | Self::STEPS => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let rings = rays_at(&heights).into_iter().enumerate().map(|(k, ray)| {
            let (p, d, weight) = ray.expect("it passes");
            let slope = d.y / d.z;
            [p.y - p.z * slope, slope, weight * simpson(k)]
        });
        let mut rings: Vec<_> = rings.collect();
        let total: f64 = rings.iter().map(|r| r[2]).sum();
        rings.iter_mut().for_each(|r| r[2] /= total);
        Self(rings)
    }

    fn mean(&self, of: impl Fn(f64) -> f64, z_mm: f64) -> f64 {
        self.0.iter().map(|[r, slope, share]| share * of(r + slope * z_mm)).sum()
    }

    fn rms_mm(&self, z_mm: f64) -> f64 {
        self.mean(|r| r * r, z_mm).sqrt()
    }

    /// Returns the contrast: that of a ring of radius r is J0(2 pi f r).
    fn contrast(&self, z_mm: f64, per_mm: f64) -> f64 {
        self.mean(|r| j0(TAU * per_mm * r), z_mm)
    }

    /// Returns the position of the highest contrast, from a scan that is repeated ever more finely around its best position.
    fn sharpest_mm(&self, per_mm: f64) -> f64 {
        let (mut middle, mut step) = (0.0, 0.01);
        let mut steps = 200;
        while step > 1e-7 {
            let around = (-steps..=steps).map(|k| middle + step * f64::from(k));
            let best = around.max_by(|a, b| self.contrast(*a, per_mm).total_cmp(&self.contrast(*b, per_mm)));
            (middle, step, steps) = (best.expect("steps"), 0.1 * step, 10);
        }
        middle
    }
}

/// On a fast lens the smallest spot and the best contrast differ, and each is the best by its own measure in a scan. On the axis the
/// scan uses rays of this test, off the axis the grid of the search.
#[test]
fn spot_and_contrast_differ_on_fast_lenses() {
    for (path, least_mm) in
        [("lenses/zeiss-biotar-50-f1.4.yaml", 0.02), ("tests/data/lenses/meyer-primoplan-100-f1.5.yaml", 0.3)]
    {
        let lens = bundled(path);
        let axial = AxialLight::of(&lens);
        for field_deg in [0.0, 10.0] {
            let small = rms(f64::INFINITY, field_deg).shift_mm(&Optics::new(lens.clone())).expect("light");
            let sharp = contrast(f64::INFINITY, field_deg, 30.0).shift_mm(&Optics::new(lens.clone())).expect("light");
            let point = ObjectPoint::on_plane(&lens, f64::INFINITY, f64::to_radians(field_deg));
            let beam = Beam::trace(&Optics::new(lens.clone()), point, &[(lens.reference_nm, 1.0)], 96)
                .expect("media")
                .expect("light");
            let on_axis = field_deg == 0.0;
            let spot = |z: f64| if on_axis { axial.rms_mm(z) } else { beam.rms_mm(z) };
            let sharpness = |z: f64| if on_axis { axial.contrast(z, 30.0) } else { beam.contrast(z, 30.0) };
            for step in -200..=200 {
                let z = 0.01 * f64::from(step);
                assert!(spot(z) >= spot(small) - 1e-12, "{path} {field_deg}: {z}");
                assert!(sharpness(z) <= sharpness(sharp) + 1e-9, "{path} {field_deg}: {z}");
            }
            if on_axis {
                assert!((small - sharp).abs() > least_mm, "{path}: {small} {sharp}");
            }
        }
        // Stopped down, both agree with each other and with the paraxial focus.
        let slow = stop_down(lens, 22.0).expect("f/22");
        let small = rms(f64::INFINITY, 0.0).shift_mm(&Optics::new(slow.clone())).expect("light");
        assert!((small - paraxial_miss(&slow, f64::INFINITY)).abs() < 0.02, "{small}");
    }
}

/// On the axis the highest contrast is found to 1 um wide open: the rings of the search are compared with 8000 rays of this test.
#[test]
fn the_sharpest_plane_is_found_to_a_micrometer() {
    for path in [
        "lenses/nikkor-100-f1.4.yaml",
        "lenses/zeiss-biotar-50-f1.4.yaml",
        "tests/data/lenses/meyer-primoplan-100-f1.5.yaml",
    ] {
        let lens = bundled(path);
        let axial = AxialLight::of(&lens);
        for per_mm in [10.0, 30.0, 60.0] {
            let found = contrast(f64::INFINITY, 0.0, per_mm).shift_mm(&Optics::new(lens.clone())).expect("light");
            let want = axial.sharpest_mm(per_mm);
            assert!((found - want).abs() < 1e-3, "{path} at {per_mm}/mm: {found} {want}");
        }
    }
}

/// The smallest RMS spot under primary spherical aberration lies two thirds of the way from the paraxial to the marginal focus (W. T.
/// Welford, Aberrations of Optical Systems, section 8.2). Checked for a singlet at f/10.
#[test]
fn the_smallest_spot_is_where_theory_has_it() {
    let lens = written(
        "name: singlet\nsurfaces:\n  - {kind: stop, thickness: 0, semi-diameter: 5}\n  \
         - {kind: sphere, radius: 100, thickness: 3, glass: SCHOTT/N-BK7, semi-diameter: 20}\n  \
         - {kind: sphere, radius: -100, thickness: 96, semi-diameter: 20}\n",
    )
    .expect("good");
    let tracer = Tracer::new(&lens, Indices::At(587.5618)).expect("media");
    let path = tracer.path(DVec3::new(0.0, 4.999_999, -1.0), DVec3::Z, 587.5618);
    let last = path.points.last().expect("points");
    let marginal = last.z - last.y * path.direction.z / path.direction.y - lens.image_z_mm();
    let paraxial = paraxial_miss(&lens, f64::INFINITY);
    let small = rms(f64::INFINITY, 0.0).shift_mm(&Optics::new(lens.clone())).expect("light");
    let part = (small - paraxial) / (marginal - paraxial);
    // Higher orders and the edge of a grid with 96 rays across account for half a per cent.
    assert!((part - 2.0 / 3.0).abs() < 0.005, "{part}");
}

/// Moving the lens to the best focus, also by groups, puts the best focus on the image plane.
#[test]
fn the_lens_moves_to_its_best_focus() {
    let biotar = bundled("lenses/zeiss-biotar-50-f1.4.yaml");
    for search in [rms(2000.0, 0.0), contrast(2000.0, 0.0, 30.0), rms(2000.0, 12.0)] {
        let start = biotar.clone().focused_at(2000.0).expect("focused");
        let found = search.focus(start.clone()).expect("light");
        assert!(search.shift_mm(&Optics::new(found.clone())).expect("light").abs() < 1e-5);
        assert!((found.image_gap_mm() - start.image_gap_mm()).abs() > 1e-4);
    }
    let floating = two_groups("focus: [{group: front, factor: 1}, {group: rear, factor: 0.6}]\n").expect("good");
    let start = floating.focused_at(800.0).expect("focused");
    let found = rms(800.0, 0.0).focus(start.clone()).expect("light");
    assert!((found.image_gap_mm() - start.image_gap_mm()).abs() > 1e-3);
    let shift = rms(800.0, 0.0).shift_mm(&Optics::new(found.clone())).expect("light");
    assert!(shift.abs() < 1e-3, "{shift}");
}

/// Shifting a group equals changing the gaps of the lens, and decentering a group equals stating it in the file.
#[test]
fn groups_go_out_of_place() {
    let lens = two_groups("").expect("good");
    let by = Misalignment { decenter_mm: Some([0.05, 0.0]), tilt_rad: Some([0.002, 0.0, 0.0]), shift_mm: 0.1 };
    let moved = lens.clone().with_misalignment("rear", &by).expect("the group");
    let mut want = lens.clone();
    want.elements[2].thickness_mm += 0.1;
    want.elements[4].thickness_mm -= 0.1;
    want.groups[1].displacement.decenter_mm = [0.05, 0.0];
    want.groups[1].displacement.tilt_rad = [0.002, 0.0, 0.0];
    want.arrange();
    for (a, b) in moved.elements.iter().zip(&want.elements) {
        assert!((a.pose.origin_mm - b.pose.origin_mm).length() < 1e-13 && a.pose.rotation == b.pose.rotation);
    }
    assert!((moved.image_z_mm() - lens.image_z_mm()).abs() < 1e-12);
    assert!(!moved.has_axis_of_revolution());
    assert!(lens.with_misalignment("middle", &by).is_none());
}

fn trace(lens: &Lens, rays: &[(DVec3, DVec3)], travel: Travel) -> Vec<Option<(DVec3, DVec3)>> {
    trace_weighed(lens, rays, travel).into_iter().map(|ray| ray.map(|(p, d, _)| (p, d))).collect()
}

/// Traces rays; returns positions, directions and the remaining weights.
fn trace_weighed(lens: &Lens, rays: &[(DVec3, DVec3)], travel: Travel) -> Vec<Option<(DVec3, DVec3, f64)>> {
    let tracer = Tracer::new(lens, Indices::At(lens.reference_nm)).expect("media");
    let mut batch = RayBatch::new(rays.len());
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = lens.reference_nm;
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), travel);
    let (p, d) = (batch.positions(), batch.directions());
    (0..rays.len())
        .map(|i| {
            let at = |c: [&[f64]; 3]| DVec3::new(c[0][i], c[1][i], c[2][i]);
            batch.loss(i).is_none().then(|| (at(p), at(d), batch.weights()[i]))
        })
        .collect()
}

/// A reversed lens, with tilted surfaces, a bent axis and a misaligned group, equals the lens traced backward.
#[test]
fn a_reversed_lens_is_the_lens_from_behind() {
    let crooked = written(
        "name: crooked\nsurfaces:\n\
         \x20 - {kind: sphere, radius: 60, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 12, decenter: [0.3, -0.2]}\n\
         \x20 - {kind: sphere, radius: -90, thickness: 5, semi-diameter: 12, tilt: [1, 2, 3]}\n\
         \x20 - {kind: coordinate-break, decenter: [0.4, 0.7], tilt: [3, -2, 10], thickness: 2}\n\
         \x20 - {kind: coordinate-break, decenter: [-0.1, 0.2], tilt: [-1, 4, 5], order: tilt-first, thickness: 1}\n\
         \x20 - {kind: stop, thickness: 3, semi-diameter: 9}\n\
         \x20 - {kind: sphere, radius: 150, thickness: 4, glass: SCHOTT/F2, semi-diameter: 12}\n\
         \x20 - {kind: sphere, radius: -70, thickness: 80, semi-diameter: 12}\n\
         groups: [{name: rear, surfaces: [4, 5], decenter: [0.2, 0.1], tilt: [0.5, -1, 2]}]\n",
    )
    .expect("good");
    let biotar = bundled("lenses/zeiss-biotar-50-f1.4.yaml");
    for lens in [biotar, crooked] {
        let reversed = lens.reversed().expect("no mirrors");
        let rays: Vec<_> = (0..60)
            .map(|k| {
                let k = f64::from(k);
                let d = DVec3::new(0.04 * k.sin(), 0.06 * (0.7 * k).cos(), 1.0).normalize();
                (DVec3::new(5.0 * (3.0 * k).cos(), 5.0 * (2.0 * k).sin(), -10.0), d)
            })
            .collect();
        // Rotates by half a turn about y, then to the last vertex of the original lens.
        let last = lens.elements.last().expect("surfaces");
        let group = lens.groups.first();
        let axis = match group {
            // Pose of the last vertex without the misalignment of the group.
            Some(_) => {
                let mut straight = lens.clone();
                straight.groups.clear();
                straight.arrange();
                straight.elements.last().expect("surfaces").pose
            }
            None => last.pose,
        };
        let turned = axis.reversed();
        let out = trace(&reversed, &rays, Travel::Forward);
        let backward: Vec<_> = rays
            .iter()
            .map(|(p, d)| {
                let (p, d) = (turned.point(*p), turned.direction(*d));
                (lens.image_pose.local_point(p), lens.image_pose.local_direction(d))
            })
            .collect();
        let want = trace(&lens, &backward, Travel::Backward);
        let mut arrived = 0;
        for (got, want) in out.iter().zip(&want) {
            assert_eq!(got.is_some(), want.is_some());
            let (Some((p, d)), Some((q, e))) = (got, want) else { continue };
            arrived += 1;
            let (p, d) = (reversed.image_pose.point(*p), reversed.image_pose.direction(*d));
            let (p, d) = (turned.point(p), turned.direction(d));
            assert!((d - *e).length() < 1e-12, "{d} {e}");
            assert!((p - *q).cross(*e).length() < 1e-10, "{p} {q}");
        }
        assert!(arrived > 20, "{arrived}");
        let again = reversed.reversed().expect("no mirrors");
        for (a, b) in again.elements.iter().zip(&lens.elements) {
            assert!((a.pose.origin_mm - b.pose.origin_mm).length() < 1e-10 && a.reversed == b.reversed);
        }
        let (there, back) = (lens.first_order(587.5618), reversed.first_order(587.5618));
        if group.is_none() {
            assert!((there.efl_mm - back.efl_mm).abs() < 1e-9 && (there.ffl_mm + back.bfl_mm).abs() < 1e-9);
            assert!((reversed.image_gap_mm() - back.bfl_mm).abs() < 1e-9);
        }
    }
    let mirror = written("name: m\nsurfaces:\n  - {kind: sphere, radius: -100, mirror: true, thickness: -50}\n");
    assert!(mirror.expect("good").reversed().is_err());
}
