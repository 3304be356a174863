//! Reads the medium that a surface of a lens file states, by name, by figures or written out.

use crate::surface_file::SurfaceKeys;
use crate::{Lens, LensMedium};
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::resources::Resources;
use spectra_glass::file::{self, Figures};
use spectra_glass::{Catalog, GlassFacts, LineTriple, Medium, ModelGlass};

/// Difference between a stated index and the glass's own above which a warning is given.
const INDEX_TOLERANCE: f64 = 0.002;

/// Returns the medium that the next surface of a lens states, or `None` for air. `nd` and `vd` of a surface refer to the reference lines.
pub(crate) fn medium(
    stated: &SurfaceKeys,
    place: &Params,
    resources: &dyn Resources,
    lens: &mut Lens,
) -> Result<Option<LensMedium>, Faults> {
    let number = lens.elements.len() + 1;
    let figures = stated_figures(stated, place, lens.abbe_lines)?;
    let reference_nm = lens.reference_nm;
    // The stated index, if it is stated at the reference line.
    let stated_nd = figures.filter(|(_, _, lines)| lines.mid.wavelength_nm == reference_nm).map(|(n, ..)| n);
    let Some(glass) = &stated.glass else {
        let Some((n, v, lines)) = figures else { return Ok(None) };
        let medium = match v {
            None => Medium::Constant(n),
            Some(v) => {
                let (key, n_key) = if stated.ne.is_some() { ("ve", "ne") } else { ("vd", "nd") };
                let fault = || place.fault(key, format!("no glass has {n_key} {n} and {key} {v}"));
                let unusual = LineTriple::of_reference(lines.mid) != Some(lines);
                let model = ModelGlass::new(n, v, lines).filter(|model| !unusual || model.falls()).map(Medium::Model);
                model.ok_or_else(|| fault().hint("an index near 1 has no such dispersion"))?
            }
        };
        let label = match v {
            None => format!("n = {n}"),
            Some(v) => {
                let usual = LineTriple::of_reference(lines.mid) == Some(lines);
                let of_v = if usual { lines.mid.indexed("v") } else { lines.abbe_label() };
                format!("{} = {n}, {of_v} = {v}", lines.mid.indexed("n"))
            }
        };
        let stated_nd = stated_nd.unwrap_or_else(|| medium.index(reference_nm));
        return Ok(Some(LensMedium { medium, stated_nd: Some(stated_nd), label }));
    };
    if let Some(name) = glass.node().as_str() {
        if name == "air" {
            return Ok(None);
        }
        let medium = if file::is_file(name) || name.eq_ignore_ascii_case("vacuum") {
            file::medium(name, place, "glass", resources)?
        } else {
            let beside = GlassFacts { figures, maker: lens.maker.as_deref(), year: lens.year };
            let chosen = Catalog::bundled().choose(name, beside);
            let chosen = chosen.map_err(|e| place.fault("glass", e.message()).hint(e.hint()))?;
            lens.warnings.extend(chosen.note.map(|note| format!("surface {number}: {note}")));
            Medium::from(chosen.glass)
        };
        if let Some((n, _, lines)) = figures {
            let own = medium.index(lines.mid.wavelength_nm);
            if (n - own).abs() > INDEX_TOLERANCE {
                let called = lines.mid.indexed("n");
                let text = format!("surface {number}: {name} has {called} {own:.5}, but the prescription states {n}");
                lens.warnings.push(text);
            }
        }
        let stated_nd = stated_nd.unwrap_or_else(|| medium.index(reference_nm));
        return Ok(Some(LensMedium { medium, stated_nd: Some(stated_nd), label: name.to_owned() }));
    }
    let params = Params::section(glass.node().clone(), glass.path())?;
    // A glass written out in place, with the keys of a glass file. A map of figures alone is a model glass.
    if ["formula", "table", "file", "name"].iter().any(|key| glass.node().get(key).is_some()) {
        let called = format!("surface {number}");
        let medium = Medium::from(file::from_params(&params, &called, resources)?);
        let label = medium.name();
        return Ok(Some(LensMedium {
            stated_nd: Some(stated_nd.unwrap_or_else(|| medium.index(reference_nm))),
            medium,
            label,
        }));
    }
    let figures: Figures = params.parse()?;
    let (medium, label) = figures.medium(&params)?;
    let stated_nd = stated_nd.or(figures.index_at(reference_nm)).unwrap_or_else(|| medium.index(reference_nm));
    Ok(Some(LensMedium { stated_nd: Some(stated_nd), medium, label }))
}

/// Returns the index that a surface states besides its glass or instead of one, with its Abbe number and the lines of both.
fn stated_figures(
    stated: &SurfaceKeys,
    place: &Params,
    reference: LineTriple,
) -> Result<Option<(f64, Option<f64>, LineTriple)>, Fault> {
    let needs = |v: &str, n: &str| Err(place.fault(v, format!("`{v}` needs `{n}`")).hint(format!("add `{n}: ...`")));
    match (stated.nd, stated.ne) {
        (Some(_), Some(_)) => {
            let fault = place.fault("ne", "the index of this surface is stated at two lines");
            Err(fault.hint("`glass: {nd: ..., ne: ...}` takes all that a patent states"))
        }
        (None, _) if stated.vd.is_some() => needs("vd", "nd"),
        (_, None) if stated.ve.is_some() => needs("ve", "ne"),
        (Some(nd), None) => Ok(Some((nd, stated.vd, reference))),
        (None, Some(ne)) => Ok(Some((ne, stated.ve, LineTriple::F_PRIME_E_C_PRIME))),
        (None, None) => Ok(None),
    }
}

/// Returns the index of a medium in the list, and adds the medium if no equal one is there.
pub(crate) fn add_medium(media: &mut Vec<LensMedium>, medium: LensMedium) -> usize {
    let same = |m: &LensMedium| m.label == medium.label && m.stated_nd == medium.stated_nd && m.medium == medium.medium;
    media.iter().position(same).unwrap_or_else(|| {
        media.push(medium);
        media.len() - 1
    })
}

/// Warns where an Abbe number was probably forgotten: at a glass without dispersion in a lens whose other glasses have one.
pub(crate) fn warn_of_constant_indices(lens: &mut Lens) {
    let is_constant = |number: &usize| matches!(lens.media[*number].medium, Medium::Constant(_));
    let disperses = |number: &usize| matches!(lens.media[*number].medium, Medium::Model(_) | Medium::Glass(_));
    let behind = || lens.elements.iter().map(|e| e.medium_after);
    if !behind().any(|number| disperses(&number)) {
        return;
    }
    let text = |(at, number): (usize, usize)| {
        format!(
            "surface {}: its glass ({}) has no dispersion, unlike the other glasses of this lens: add `vd: ...`, or `vd: 0` if \
             there is none",
            at + 1,
            lens.media[number].label
        )
    };
    // Only where light enters the glass, not where a stop or a mirror stands in it.
    let into = lens.elements.iter().enumerate().filter(|(_, e)| e.medium_after != e.medium_before);
    let constant: Vec<String> =
        into.map(|(at, e)| (at, e.medium_after)).filter(|(_, number)| is_constant(number)).map(text).collect();
    lens.warnings.extend(constant);
}
