//! Reads a whole file.

use super::record::{Record, Records, sort};
use super::surface::{Block, GlassRecord};
use super::{keywords, system};
use crate::glass::{Catalogs, UserCatalog};
use crate::prescription::{
    AxisItem, CoordinateBreak, Medium, Note, Prescription, Surface, SurfaceShape, SystemAperture,
};
use crate::source::{Source, shortened};
use crate::{MAX_ITEMS, glass};
use spectra_core::params::Faults;
use std::collections::BTreeMap;

/// Distance (mm) from which on an object counts as at infinity.
const INFINITY_MM: f64 = 1e10;

/// Reads the text of a `.zmx` file. `name` is the name of the file in error messages; glasses are searched for in the catalogs
/// `own` first.
///
/// # Errors
/// The file is not sequential, has no surfaces or more than [`MAX_ITEMS`], or a value that the lens needs is not a number.
pub fn read(name: &str, text: &str, own: &[UserCatalog]) -> Result<Prescription, Faults> {
    let source = Source::new(name, text);
    let records = sort(source.text());
    let mut lens = Prescription::default();
    let mut faults = Faults::new();
    let system = system::read(&records.system, &source, &mut lens, &mut faults);
    if records.surfaces.len() > MAX_ITEMS {
        let found = records.surfaces.len();
        return Err(source.fault_here(format!("{found} surfaces; at most {MAX_ITEMS} are read")).into());
    }
    let mut blocks = Vec::with_capacity(records.surfaces.len());
    let mut unknown = BTreeMap::new();
    for lines in &records.surfaces {
        blocks.push(Block::read(lines, &source, system.unit_mm, &mut lens, &mut unknown, &mut faults));
    }
    if blocks.len() < 3 && faults.is_empty() {
        let what = if blocks.is_empty() { "no surfaces" } else { "no surfaces between object and image" };
        faults.push(source.fault_here(what).hint("is this a sequential .zmx file?"));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let catalogues = Catalogs { own, makers: &system.makers };
    Reader { lens: &mut lens, media: Vec::new(), catalogues, is_turned: false, ran_back: false }.surfaces(&blocks);
    note_solves(&records, &mut lens);
    for (keyword, (line, count)) in unknown {
        let times = if count > 1 { format!(" ({count} lines)") } else { String::new() };
        lens.leave_out(line, true, format!("{keyword}: an unknown record of a surface{times}"));
    }
    note_coatings(&records, &mut lens);
    note_rest(&records.rest, &mut lens);
    if lens.system_aperture == Some(SystemAperture::StopSize) {
        float_by_stop(&mut lens, &blocks, system.aperture_line);
    } else if !system.open_stop {
        if let (Some(SystemAperture::FNumber(n)), true, Some(_)) =
            (lens.system_aperture, system.working, lens.object_distance_mm)
        {
            lens.system_aperture = Some(SystemAperture::ImageNumericalAperture(0.5 / n));
        }
        crate::stop::size(&mut lens, system.aperture_line, "STOP");
    }
    crate::reference::set(&mut lens);
    lens.left_out.sort_by_key(|note| note.line);
    Ok(lens)
}

struct Reader<'a> {
    lens: &'a mut Prescription,
    /// Medium behind each surface of the file, mirrors included.
    media: Vec<Medium>,
    catalogues: Catalogs<'a>,
    /// Whether light runs toward smaller z, behind an odd number of mirrors.
    is_turned: bool,
    /// Whether the last gap ran against the light.
    ran_back: bool,
}

impl Reader<'_> {
    /// Converts blocks to items. The first block is the object, the last one the image.
    fn surfaces(&mut self, blocks: &[Block]) {
        let (object, image) = (&blocks[0], &blocks[blocks.len() - 1]);
        let distance = object.thickness_mm.unwrap_or(f64::INFINITY);
        if distance.abs() < INFINITY_MM {
            self.lens.object_distance_mm = Some(distance);
        }
        if object.glass.is_some() {
            self.lens.leave_out(object.line, true, "the object is in a glass: here air is in front of the lens");
        }
        if object.curvature_radius_mm.is_finite() {
            self.lens.leave_out(object.line, false, "the object is curved");
        }
        object.note_unused(0, self.lens);
        self.media.push(Medium::Air);
        for (number, block) in blocks.iter().enumerate().take(blocks.len() - 1).skip(1) {
            self.surface(number, block);
        }
        if image.curvature_radius_mm.is_finite() {
            let radius = crate::number::shortest(image.curvature_radius_mm);
            self.lens.leave_out(
                image.line,
                true,
                format!("the image surface is curved, radius {radius} mm: here it is a plane"),
            );
        }
        if image.conic != 0.0 && image.curvature_radius_mm.is_finite() || image.kind != "STANDARD" {
            let kind = shortened(&image.kind);
            self.lens.leave_out(
                image.line,
                true,
                format!("the type of the image surface ({kind}): here it is a plane"),
            );
            image.parameters.set_all_aside();
            image.extra.set_all_aside();
        }
        image.note_unused(blocks.len() - 1, self.lens);
        if !image.aperture.is_none() {
            self.lens.leave_out(image.line, false, "the aperture of the image surface");
        }
        for tilt in &image.before {
            self.lens.items.push(AxisItem::Break(*tilt));
        }
        if !image.after.is_empty() {
            self.lens.leave_out(image.line, false, "a tilt behind the image surface");
        }
        // Keep a break in front of the image; the gap before it was that of the last surface.
        if self.lens.items.iter().all(|item| matches!(item, AxisItem::Break(_))) {
            // Add a plane without effect, since a lens needs a surface.
            self.lens.items.push(AxisItem::Surface(Box::default()));
        }
    }

    fn surface(&mut self, number: usize, block: &Block) {
        let mut thickness_mm = block.thickness_mm.unwrap_or(0.0);
        if !thickness_mm.is_finite() {
            self.lens.leave_out(block.line, true, format!("surface {number}: its infinite thickness is set to 0"));
            thickness_mm = 0.0;
        }
        for tilt in &block.before {
            self.lens.items.push(AxisItem::Break(*tilt));
        }
        let before = self.media.last().cloned().unwrap_or_default();
        // The thickness behind a tilt is measured along the new axis.
        let own_mm = if block.after.is_empty() { thickness_mm } else { 0.0 };
        if block.is_break() {
            self.media.push(before);
            let axis = CoordinateBreak { thickness_mm: own_mm, ..block.coordinate_break() };
            self.lens.items.push(AxisItem::Break(axis));
        } else {
            let mirror = block.glass.as_ref().is_some_and(GlassRecord::is_mirror);
            let medium = if mirror { before.clone() } else { self.medium(number, block) };
            let mut surface = Surface {
                shape: block.shape(number, self.lens),
                thickness_mm: own_mm,
                medium: medium.clone(),
                mirror,
                stop: block.stop,
                comment: block.comment.clone(),
                ..Surface::default()
            };
            let bends = mirror
                || before != medium
                || matches!(surface.shape, SurfaceShape::ThinLens { .. } | SurfaceShape::Grating { .. });
            block.aperture.place(&mut surface, bends);
            let bends_nothing =
                surface.shape == SurfaceShape::Plane && !mirror && before == Medium::Air && medium == Medium::Air;
            if block.stop && bends_nothing && surface.apertures.is_empty() {
                surface.shape = SurfaceShape::Stop;
            }
            let is_dummy = surface.shape == SurfaceShape::Plane && !bends && !surface.stop && block.aperture.is_none();
            self.media.push(medium);
            self.is_turned ^= mirror;
            let runs_back = if self.is_turned { own_mm > 0.0 } else { own_mm < 0.0 };
            if is_dummy && (runs_back || self.ran_back) {
                self.move_along(own_mm);
            } else if runs_back && bends && !mirror {
                surface.thickness_mm = 0.0;
                self.lens.items.push(AxisItem::Surface(Box::new(surface)));
                self.move_along(own_mm);
            } else {
                self.lens.items.push(AxisItem::Surface(Box::new(surface)));
            }
            self.ran_back = runs_back;
        }
        block.note_unused(number, self.lens);
        for (at, tilt) in block.after.iter().enumerate() {
            let thickness_mm = if at + 1 == block.after.len() { thickness_mm } else { 0.0 };
            self.lens.items.push(AxisItem::Break(CoordinateBreak { thickness_mm, ..*tilt }));
        }
    }

    /// Adds an empty step along the axis. Such a step runs against the light on the way to a point about which the following surfaces are
    /// tilted.
    fn move_along(&mut self, thickness_mm: f64) {
        match self.lens.items.last_mut() {
            Some(AxisItem::Break(axis)) if axis.by.is_none() => axis.thickness_mm += thickness_mm,
            _ => self.lens.items.push(AxisItem::Break(CoordinateBreak { thickness_mm, ..CoordinateBreak::default() })),
        }
    }

    /// Returns the medium behind a surface that is not a mirror.
    fn medium(&mut self, number: usize, block: &Block) -> Medium {
        let Some(stated) = &block.glass else { return Medium::Air };
        let found = match (stated.is_model, stated.pickup.and_then(|from| self.media.get(from))) {
            (true, Some(medium)) => glass::FoundMedium { medium: medium.clone(), note: None },
            (true, None) if !(1.0..=4.0).contains(&stated.nd) => glass::FoundMedium {
                medium: Medium::Unknown { name: format!("nd {}", stated.nd) },
                note: Some((true, format!("a glass with an index of {}", stated.nd))),
            },
            (true, None) => glass::model_off_normal(stated.nd, stated.vd, stated.deviation),
            // Ignore 1.5 and 40, which the program writes if nothing is known.
            (false, _) => {
                let known =
                    (1.0..=4.0).contains(&stated.nd) && stated.nd != 1.0 && (stated.nd, stated.vd) != (1.5, 40.0);
                glass::look_up(&stated.name, known.then_some((stated.nd, stated.vd)), self.catalogues)
            }
        };
        if let Some((alters, text)) = found.note {
            self.lens.leave_out(block.line, alters, format!("surface {number}: {text}"));
        }
        found.medium
    }
}

/// Makes the stop of a system that floats by its size clip at that size.
fn float_by_stop(lens: &mut Prescription, blocks: &[Block], line: usize) {
    let size = blocks.iter().find(|block| block.stop).and_then(|block| block.aperture.semi_diameter_mm);
    let stop = lens.items.iter_mut().find_map(|item| match item {
        AxisItem::Surface(surface) if surface.stop => Some(surface),
        _ => None,
    });
    let Some(stop) = stop else { return };
    if stop.semi_diameter_mm.is_some() {
        return;
    }
    match size.filter(|size| *size > 0.0) {
        Some(size) => {
            stop.semi_diameter_mm = Some(size);
            stop.outer_semi_diameter_mm = stop.outer_semi_diameter_mm.filter(|outer| *outer > size);
        }
        None if !stop.apertures.is_empty() => {}
        None => {
            let text = "FLOA: the stop states no size, so it does not limit the light; write DIAM at the stop, or \
                        `semi-diameter: ...` in the imported lens file";
            lens.leave_out(line, true, text);
        }
    }
}

/// Notes values that the program derives from others; they are carried as saved.
fn note_solves(records: &Records<'_>, lens: &mut Prescription) {
    let is_solve = |record: &&Record<'_>| {
        let keyword = record.keyword.to_ascii_uppercase();
        match keyword.as_str() {
            "PPAR" | "PZUP" | "PKUP" | "MAZH" | "CHZH" => true,
            "CURV" => record.number(1).is_some_and(|kind| kind > 1.0),
            _ => false,
        }
    };
    let solves: Vec<&Record<'_>> = records.surfaces.iter().flatten().filter(is_solve).collect();
    if let Some(first) = solves.first() {
        let text = format!("solves and pickups ({} lines): their values are carried as saved", solves.len());
        lens.leave_out(first.line, false, text);
    }
}

/// Notes coatings, which change how much light continues, but not where.
fn note_coatings(records: &Records<'_>, lens: &mut Prescription) {
    let coats = || records.surfaces.iter().flatten().filter(|record| record.keyword.eq_ignore_ascii_case("COAT"));
    let Some(first) = coats().next() else { return };
    let mut names: Vec<String> = coats().map(|record| shortened(record.rest)).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    names.truncate(12);
    lens.leave_out(first.line, false, format!("coatings of {count} surfaces ({})", names.join(", ")));
}

/// Notes merit function, tolerances and configurations.
fn note_rest(rest: &[Record<'_>], lens: &mut Prescription) {
    let silent = |keyword: &str| ["BLNK", "MOFF"].contains(&keyword) || keywords::is_harmless_in_system(keyword);
    let mut operands: Vec<(usize, String)> = Vec::new();
    let mut count = 0;
    let mut configurations: Option<(usize, usize, usize)> = None;
    let mut varied: Vec<String> = Vec::new();
    for record in rest {
        let keyword = record.keyword.to_ascii_uppercase();
        let is_tolerance = keyword == "TOL";
        if keyword == "MNUM" {
            let number = |at| record.number(at).map_or(1, |n| n as usize);
            configurations = Some((record.line, number(0), number(1)));
        } else if is_tolerance && record.word(0).is_some_and(|word| word == "TOFF") || silent(&keyword) {
            // Skip an empty line of the editor.
        } else if configurations.is_some_and(|(_, count, _)| count > 1) && !is_tolerance {
            let text = shortened(&format!("{keyword} {}", record.words().take(3).collect::<Vec<_>>().join(" ")));
            if varied.len() < 12 {
                varied.push(text);
            }
        } else {
            count += 1;
            let text = shortened(&keyword);
            if operands.len() < 12 && !operands.iter().any(|(_, known)| *known == text) {
                operands.push((record.line, text));
            }
        }
    }
    if let Some((line, _)) = operands.first() {
        let names: Vec<&str> = operands.iter().map(|(_, name)| name.as_str()).collect();
        let text = format!("merit function and tolerances ({count} lines: {})", names.join(", "));
        lens.left_out.push(Note { line: *line, text, alters: false });
    }
    if let Some((line, count, current)) = configurations
        && count > 1
    {
        let what = if varied.is_empty() { String::new() } else { format!(" ({})", varied.join("; ")) };
        let text = format!(
            "{count} configurations: the values of number {current}, which was current when saved, are carried{what}"
        );
        lens.leave_out(line, false, text);
    }
}
