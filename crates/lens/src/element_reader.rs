//! Reads the items of `surfaces` in a lens file: surfaces, prisms and bends of the axis.

use crate::prism::{self, PRISM, PrismParams};
use crate::schema::SurfaceOrBreak;
use crate::stated_medium::{add_medium, medium, warn_of_constant_indices};
use crate::surface_file::{BREAK, BreakParams, SurfaceKeys, displacement};
use crate::{AxisBreak, Element, Lens, aperture, read_coating, read_layers, read_separation, separation};
use spectra_core::names;
use spectra_core::params::{Deferred, Faults, Length, Node, Params, Quantity, Ratio, StageNode, Value, keys_of};
use spectra_core::registry::{self, Context};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::surface::{Action, Kernel, Plane, Surface};
use std::sync::Arc;

/// Shortest radius of a surface, mm; anything shorter is less than a wavelength.
const SHORTEST_RADIUS_MM: f64 = 1e-6;

/// Reader that appends the elements of a lens file to a lens, in order, and collects the faults.
pub(crate) struct ElementReader<'a> {
    lens: &'a mut Lens,
    faults: &'a mut Faults,
    context: Context<'a>,
    /// Keys that every surface may have, whatever its kind.
    shared_keys: Vec<String>,
    /// Kind of a surface that states none.
    default_kind: &'static str,
    /// Medium behind the last surface: index into [`Lens::media`].
    medium: usize,
    /// Whether light runs along +z of the axis, as it does before the first mirror.
    along: bool,
    /// Bends of the axis since the last surface.
    breaks: Vec<AxisBreak>,
}

impl<'a> ElementReader<'a> {
    /// Creates a reader for a lens that has no elements yet.
    pub(crate) fn new(lens: &'a mut Lens, faults: &'a mut Faults, resources: &'a dyn Resources) -> Self {
        let default = registry::list().into_iter().find(|l| l.stage == "surface" && l.default);
        Self {
            lens,
            faults,
            context: Context::new(resources, BAND),
            shared_keys: keys_of::<SurfaceKeys>(),
            default_kind: default.map_or("surface", |l| l.name),
            medium: 0,
            along: true,
            breaks: Vec::new(),
        }
    }

    /// Reads all items into the lens. An item with a fault that hides the others is left out.
    pub(crate) fn read(mut self, items: &[Deferred<SurfaceOrBreak>]) {
        for (at, node) in items.iter().enumerate() {
            let Some(params) = self.faults.take(node.params()) else { continue };
            if params.kind() == Some(BREAK) {
                let own = self.faults.take(params.parse::<BreakParams>());
                self.breaks.extend(own.map(|p| p.axis_break()));
                continue;
            }
            let (place, shape) = params.split(&self.shared_keys);
            let element = if params.kind() == Some(PRISM) {
                self.prism(&place, shape)
            } else {
                // If a bend of the axis follows, it states the distance itself.
                let distance_follows = items.get(at + 1).is_none_or(|next| kind_of(next) == Some(BREAK));
                self.surface(&place, shape, distance_follows)
            };
            if let Some(element) = element {
                self.medium = element.medium_after;
                self.lens.elements.push(element);
            }
        }
        warn_of_constant_indices(self.lens);
        self.lens.image_breaks = self.breaks;
    }

    /// Reads a prism: the keys of all surfaces from `place`, its own from `shape`.
    fn prism(&mut self, place: &Params, shape: Params) -> Option<Element> {
        let resources = self.context.resources;
        let stated = self.faults.take(place.parse::<SurfaceKeys>());
        let own = self.faults.take(shape.parse::<PrismParams>());
        let (stated, own) = stated.zip(own)?;
        self.faults.extend(prism::misplaced(place));
        let Some(glass) = self.faults.take(medium(&stated, place, resources, self.lens))? else {
            let fault = place.fault("glass", "missing key `glass`: a prism is of glass");
            self.faults.push(fault.hint("add `glass: SCHOTT/N-BK7`"));
            return None;
        };
        let glass = add_medium(&mut self.lens.media, glass);
        let reference_nm = self.lens.reference_nm;
        let index = self.lens.index(glass, reference_nm) / self.lens.index(self.medium, reference_nm);
        let solid = self.faults.take(own.solid(&shape, glass, index))?;
        let plane = Arc::new(Kernel(Plane::refracting()));
        Some(Element {
            semi_diameter_mm: Some(solid.reach_mm()),
            solid: Some(Arc::new(solid)),
            parameters: Some(shape),
            breaks: std::mem::take(&mut self.breaks),
            displacement: displacement(stated.decenter, stated.tilt),
            thickness_mm: stated.thickness.map_or(0.0, |t| t.mm()),
            coating: stated.coating.as_ref().and_then(|node| self.faults.take(read_coating(node, resources))),
            reflectance: stated.reflectance.map_or(1.0, Ratio::number),
            ..Element::new(PRISM, plane, self.medium, self.medium)
        })
    }

    /// Reads a surface: the keys of all surfaces from `place`, those of its kind from `shape`. `distance_follows` says whether the distance
    /// to the next surface is stated elsewhere.
    fn surface(&mut self, place: &Params, shape: Params, distance_follows: bool) -> Option<Element> {
        let surface = registry::build::<dyn Surface>(&shape, &self.context);
        let surface = self.faults.take(surface.map_err(|faults| with_keys_of_all(faults, &self.shared_keys)));
        let stated = self.faults.take(place.parse::<SurfaceKeys>());
        let (surface, stated) = surface.zip(stated)?;
        let medium_after = self.medium_behind(&*surface, &stated, place)?;
        self.along ^= stated.mirror;
        let kind = shape.kind().unwrap_or(self.default_kind);
        let plain = Element::new(kind, Arc::from(surface), self.medium, medium_after);
        let mut element = Element {
            breaks: std::mem::take(&mut self.breaks),
            displacement: displacement(stated.decenter, stated.tilt),
            reversed: stated.reversed,
            thickness_mm: stated.thickness.map_or(0.0, |t| t.mm()),
            semi_diameter_mm: stated.semi_diameter.map(|s| s.mm()),
            outer_semi_diameter_mm: stated.outer_semi_diameter.map(|s| s.mm()),
            chamfer_mm: stated.chamfer.map_or(0.0, Length::mm),
            reflectance: stated.reflectance.map_or(1.0, Ratio::number),
            ..plain
        };
        self.check_lengths(&element, stated.thickness.is_some() || distance_follows, place, &shape);
        element.parameters = Some(shape);
        self.set_mirror_and_stop(&mut element, &stated, place);
        self.check_extent(&element, place);
        self.set_coating_and_layers(&mut element, &stated, place);
        Some(element)
    }

    /// Returns the medium behind a surface: air if it states none, the medium in front of it for a mirror or a stop.
    fn medium_behind(&mut self, surface: &dyn Surface, stated: &SurfaceKeys, place: &Params) -> Option<usize> {
        let is_stated = stated.glass.is_some() || stated.nd.is_some() || stated.ne.is_some();
        if stated.mirror && is_stated {
            let fault = place.fault("mirror", "there is no glass behind a mirror");
            self.faults.push(fault.hint("leave the glass out: the medium in front of the mirror continues"));
        }
        if stated.mirror || (surface.is_stop() && !is_stated) {
            return Some(self.medium);
        }
        let medium = self.faults.take(medium(stated, place, self.context.resources, self.lens))?;
        Some(medium.map_or(0, |medium| add_medium(&mut self.lens.media, medium)))
    }

    /// Checks the thickness and the radius of a surface.
    fn check_lengths(&mut self, element: &Element, is_distance_stated: bool, place: &Params, shape: &Params) {
        let bends = element.medium_after != element.medium_before;
        if !is_distance_stated && element.medium_after != 0 && bends {
            let fault = place.fault("thickness", "missing key `thickness`: the glass behind this surface needs one");
            self.faults.push(fault.hint("add `thickness: ...`, the distance to the next surface; 0 where they touch"));
        }
        let radius_mm = shape.get("radius").and_then(length_mm).map_or(f64::INFINITY, f64::abs);
        if radius_mm > 0.0 && radius_mm < SHORTEST_RADIUS_MM {
            let fault = shape.fault("radius", format!("{radius_mm:e} mm is too small a radius for a lens"));
            self.faults.push(fault.hint(format!("at least {SHORTEST_RADIUS_MM:e} mm; 0 for a plane")));
        }
        // Behind a mirror light runs the other way; between two planes in air the step may be a formal one.
        let thickness_mm = element.thickness_mm;
        if thickness_mm < 0.0 && self.along && bends {
            let fault = place.fault("thickness", format!("the thickness is negative: {thickness_mm} mm"));
            let hint = "thicknesses follow the direction of the light: write it without the minus sign";
            self.faults.push(fault.hint(hint));
        }
    }

    /// Makes a surface the mirror and the stop that it is stated to be, and reads its apertures.
    fn set_mirror_and_stop(&mut self, element: &mut Element, stated: &SurfaceKeys, place: &Params) {
        if stated.mirror && element.stop {
            let fault = place.fault("mirror", "a stop does not refract light");
            self.faults.push(fault.hint("`kind: plane` with `stop: true`"));
        } else if stated.mirror {
            element.action = Action::Reflect;
        }
        let apertures = stated.aperture.as_ref().map(|node| aperture::read(node, self.context.resources));
        element.apertures = apertures.and_then(|read| self.faults.take(read)).unwrap_or_default();
        element.stop |= stated.stop;
        if let Some(first) = self.lens.stop().filter(|_| element.stop) {
            let fault = place.fault_here(format!("a second stop: surface {} is one already", first + 1));
            let hint = "a lens has one stop; other surfaces limit the light by `semi-diameter` or `aperture`";
            self.faults.push(fault.hint(hint));
        }
    }

    /// Checks that a surface exists at its vertex and out to its semi-diameter.
    fn check_extent(&mut self, element: &Element, place: &Params) {
        // Some tilted surfaces have no point on their axis. A sag that is not a number is an error in the code of the surface.
        if element.surface.sag_mm(0.0, 0.0).is_some_and(|sag| !sag.is_finite()) {
            let fault = place.fault_here("the sag of this surface at its vertex is not a number");
            let hint = "check its keys, and the code of its kind: where there is no surface it must return `None`";
            self.faults.push(fault.hint(hint));
        } else if let Some(semi_diameter_mm) = element.semi_diameter_mm.filter(|s| *s > 0.0)
            && let Some(reach_mm) = reach_mm(&*element.surface, semi_diameter_mm)
        {
            let text =
                format!("the surface ends {reach_mm} mm from its axis: it has no point at {semi_diameter_mm} mm");
            self.faults
                .push(place.fault("semi-diameter", text).hint("use a smaller semi-diameter, or a longer radius"));
        }
    }

    /// Reads the coating of a surface, what scatters light on it, and its separated cement.
    fn set_coating_and_layers(&mut self, element: &mut Element, stated: &SurfaceKeys, place: &Params) {
        let resources = self.context.resources;
        element.coating = stated.coating.as_ref().and_then(|node| self.faults.take(read_coating(node, resources)));
        if stated.reflectance.is_some() && !stated.mirror {
            let fault = place.fault("reflectance", "only a mirror has a `reflectance`");
            self.faults.push(fault.hint("what a lens surface reflects follows from its `coating`"));
        }
        let soils = [stated.haze.as_deref(), stated.dust.as_deref(), stated.scratches.as_deref()];
        element.layers = read_layers(soils, resources, self.faults);
        let rings = stated.onion_rings.as_ref().and_then(|node| self.faults.take(node.read()));
        element.onion_rings = rings.map(|rings| rings.rings());
        let separation = stated.separation.as_ref();
        element.separation = separation.and_then(|node| self.faults.take(read_separation(node, resources)));
        self.check_separation(element, place);
        let is_bent = element.surface.is_directional() || element.surface.draws() || element.surface.is_stop();
        let bends = element.action == Action::Reflect || element.medium_before != element.medium_after;
        let scatterer = element.layers.first().map(|layer| layer.soil.key());
        let scatterer = scatterer.or(element.onion_rings.map(|_| "onion-rings"));
        if let Some(key) = scatterer.filter(|_| is_bent || !bends) {
            let fault = place.fault(key, format!("`{key}` belongs where glass meets another medium, or on a mirror"));
            self.faults.push(fault.hint("move it to a glass surface or to a mirror"));
        }
    }

    /// Checks that cement can separate at a surface, and that its depth can be measured.
    fn check_separation(&mut self, element: &Element, place: &Params) {
        let Some(separation) = &element.separation else { return };
        if !self.lens.is_cemented(element) {
            let fault = place.fault(separation::KEY, "only cement can separate: no two glasses meet here");
            self.faults.push(fault.hint("state it at a surface between two glasses"));
        } else if separation.depth_mm.is_some() && element.semi_diameter_mm.is_none() {
            let fault = place.fault(separation::KEY, "`depth` is measured from the edge, but the surface has none");
            self.faults.push(fault.hint("add `semi-diameter: ...`, or leave `depth` out"));
        }
    }
}

/// Reads a length in mm; `None` if the node is not a length.
fn length_mm(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Number(number) => Some(number.value),
        Value::String(text) => Length::from_text(text).ok().map(Length::mm),
        _ => None,
    }
}

/// Corrects the hints for unknown keys of a kind of surface, which knows only its own keys: adds the keys that all surfaces have.
fn with_keys_of_all(mut faults: Faults, of_all: &[String]) -> Faults {
    for fault in &mut faults.0 {
        let key = fault.message.strip_prefix("unknown key `").and_then(|rest| rest.strip_suffix('`'));
        let Some((key, hint)) = key.zip(fault.hint.as_mut()) else { continue };
        if let Some(own) = hint.strip_prefix("known keys: ") {
            *hint = names::nearest(key, of_all.iter().map(String::as_str)).map_or_else(
                || format!("known keys: {own}, {}", of_all.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
        } else if hint == "no keys are allowed here" {
            *hint = names::hint(key, of_all, "");
        }
    }
    faults
}

/// Returns the `kind` of an item of `surfaces`.
fn kind_of(node: &StageNode) -> Option<&str> {
    node.node().get("kind").unwrap_or(node.node()).as_str()
}

/// Fraction by which a semi-diameter may exceed the surface. Published tables round the semi-diameter of a hemisphere up (the Minolta
/// fisheye's by 0.7 %).
const BEYOND: f64 = 0.02;

/// Returns where a surface ends, mm from its axis, if that is before `semi_diameter_mm` along both x and y.
fn reach_mm(surface: &dyn Surface, semi_diameter_mm: f64) -> Option<f64> {
    // There is no surface where the sag is not a number, just as for light.
    let reaches = |r: f64| [(r, 0.0), (0.0, r)].iter().any(|(x, y)| surface.sag_mm(*x, *y).is_some_and(f64::is_finite));
    if reaches(semi_diameter_mm * (1.0 - BEYOND)) || !reaches(0.0) {
        return None;
    }
    let (mut inside, mut outside) = (0.0, semi_diameter_mm);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if reaches(middle) { inside = middle } else { outside = middle }
    }
    // Rounded as a person would write it.
    Some((outside * 1e4).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::surface::{FromSag, PerRay, SagShape};

    /// A sphere computed with a root. Beyond its radius the sag is `None` if its author was careful, otherwise not a number.
    #[derive(Clone, Debug)]
    struct Root {
        radius_mm: f64,
        is_careful: bool,
    }

    impl SagShape for Root {
        fn sag_mm(&self, x: f64, y: f64) -> Option<f64> {
            let sag = self.radius_mm - (self.radius_mm * self.radius_mm - x * x - y * y).sqrt();
            (sag.is_finite() || !self.is_careful).then_some(sag)
        }
    }

    #[test]
    fn a_sag_that_is_no_number_ends_the_surface() {
        for is_careful in [true, false] {
            let surface = PerRay(FromSag(Root { radius_mm: 5.0, is_careful }));
            assert_eq!(reach_mm(&surface, 6.25), Some(5.0), "{is_careful}");
            assert_eq!(reach_mm(&surface, 4.0), None, "{is_careful}");
        }
    }
}
