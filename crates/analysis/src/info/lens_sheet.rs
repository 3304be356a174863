//! The sheet of a lens.

use super::{LensReport, MountReport};
use spectra_sheet::{Column, Sheet, Table, percent};

/// Text for a figure that the lens does not have.
const UNKNOWN: &str = "unknown";

/// Formats a length in mm, or says why there is none.
fn mm(value: Option<f64>) -> String {
    match value {
        // Write no sign for a value that rounds to zero.
        Some(value) if value.abs() < 5e-5 => "0.0000 mm".to_owned(),
        Some(value) if value.is_finite() => format!("{value:.4} mm"),
        Some(_) => "infinite".to_owned(),
        None => UNKNOWN.to_owned(),
    }
}

impl LensReport {
    /// Returns the sheet of the lens: all fields of this report as data; its figures, field points and surfaces are also shown.
    #[must_use]
    pub fn sheet(&self) -> Sheet {
        let year = self.year.map_or(String::new(), |year| format!(" ({year})"));
        let mut sheet = Sheet::new(&format!("{}{year}", self.name));
        sheet.fields(self);
        let origin =
            [("maker", &self.maker), ("patent", &self.patent), ("source", &self.source), ("remark", &self.remark)];
        for (label, text) in origin {
            sheet.line(label, text.as_ref().map(|text| text.trim().to_owned()));
        }
        sheet.line("rims", self.rims.as_ref().map(ToString::to_string));
        let wavelength = match (self.wavelength_nm, self.line) {
            (Some(nm), Some(line)) => format!("{nm} nm (line {line})"),
            (Some(nm), None) => format!("{nm} nm"),
            (None, _) => "none; every glass has the index that the prescription states".to_owned(),
        };
        sheet.line("wavelength", Some(wavelength));
        sheet.note("distances along the axis are positive toward the image");
        sheet.show(self.figures());
        self.field(&mut sheet);
        self.room(&mut sheet);
        self.prescription(&mut sheet);
        super::media::note(&self.assumed_media, &mut sheet);
        self.notes.iter().for_each(|note| sheet.note(&format!("note: {note}")));
        self.warnings.iter().for_each(|warning| sheet.note(&format!("warning: {warning}")));
        sheet
    }

    fn figures(&self) -> Table {
        let f_number = self.f_number.map_or(UNKNOWN.to_owned(), |n| format!("f/{n:.4}"));
        let t_number = self.t_number.map_or(UNKNOWN.to_owned(), |n| format!("T/{n:.4}"));
        let max_field = self.max_field_deg.map_or(UNKNOWN.to_owned(), |field| format!("{field:.3} deg"));
        let limit = self.max_field_limit.map_or("half angle of view".to_owned(), |l| {
            format!("half angle of view; rays beyond it end at surface {} ({})", l.surface, l.cause)
        });
        let contrast =
            format!("from the image plane; highest contrast at {} lp/mm, real rays", self.contrast_frequency_per_mm);
        let (stop, stop_remark) = match (self.has_stop, self.stop_semi_diameter_mm) {
            (_, Some(_)) => (mm(self.stop_semi_diameter_mm), "semi-diameter"),
            (true, None) if self.entrance_pupil_diameter_mm.is_none() => {
                ("open".to_owned(), "no semi-diameter in the file, and no rim of the lens limits the light")
            }
            (true, None) => ("open".to_owned(), "no semi-diameter in the file: the rims of the lens limit the light"),
            (false, None) => ("none".to_owned(), ""),
        };
        let f_remark = match self.nominal_f_number {
            Some(nominal) => format!("from the real marginal ray; f/{nominal} in the lens's name"),
            None => "from the real marginal ray".to_owned(),
        };
        let efl_remark = self.efl_x_mm.map_or("", |_| "in the y-z section (vertical)");
        let mut rows = vec![("focal length", mm(Some(self.efl_mm)), efl_remark)];
        if self.efl_x_mm.is_some() {
            rows.push(("  across", mm(self.efl_x_mm), "in the x-z section (horizontal)"));
        }
        rows.extend([
            ("f-number", f_number, f_remark.as_str()),
            ("T-number", t_number, &self.losses),
            ("largest field", max_field, &limit),
            ("stop", stop, stop_remark),
            ("entrance pupil", mm(self.entrance_pupil_z_mm), "from the first vertex"),
            ("  diameter", mm(self.entrance_pupil_diameter_mm), "from the real marginal ray"),
            ("exit pupil", mm(self.exit_pupil_z_mm), "from the first vertex"),
            ("  diameter", mm(self.exit_pupil_diameter_mm), "from the real marginal ray"),
            ("front focal length", mm(Some(self.ffl_mm)), "front focal point from the first vertex"),
            ("back focal length", mm(Some(self.bfl_mm)), "rear focal point from the last vertex"),
            ("front principal plane", mm(Some(self.front_principal_z_mm)), "from the first vertex"),
            ("rear principal plane", mm(Some(self.rear_principal_z_mm)), "from the first vertex"),
            ("front nodal point", mm(Some(self.front_nodal_z_mm)), "from the first vertex"),
            ("rear nodal point", mm(Some(self.rear_nodal_z_mm)), "from the first vertex"),
            ("length", mm(Some(self.vertex_length_mm)), "first vertex to last vertex"),
            ("total track", mm(Some(self.total_track_mm)), "first vertex to image plane"),
            ("image plane", mm(Some(self.image_distance_mm)), "from the last vertex"),
            ("focused at", mm(Some(self.focus_distance_mm)), "object distance from the first vertex"),
            ("  magnification", format!("{:.6}", self.magnification), ""),
            ("  paraxial image", mm(self.paraxial_focus_shift_mm), "from the image plane"),
            ("  smallest spot", mm(self.rms_focus_shift_mm), "from the image plane; RMS radius, real rays"),
            ("  best contrast", mm(self.contrast_focus_shift_mm), &contrast),
        ]);
        let mut table =
            Table::new("figures", [Column::text("figure", ""), Column::plain("value", ""), Column::text("remark", "")]);
        for (name, value, remark) in rows {
            // Drop the remark of an unknown figure, which would mislead. The remark of the T-number is on the losses and stays.
            let remark = if value == UNKNOWN && name != "T-number" { "" } else { remark };
            table.push((name, value, remark));
        }
        self.glare(&mut table);
        table
    }

    fn glare(&self, table: &mut Table) {
        let Some(glare) = &self.glare else { return };
        let percent = |part: f64| percent(part, if part < 0.01 { 3 } else { 2 });
        let of = |what: &str, part: f64| {
            if part > 0.0 { format!(", {what} reflects {}", percent(part)) } else { String::new() }
        };
        let remark = format!(
            "+- {} (standard error); ISO 9358, integral, a black disk of {:.2} mm in the image{}{}",
            percent(glare.standard_error),
            glare.disk_mm,
            of("paint", glare.paint),
            of("film", glare.imager)
        );
        table.push(("veiling glare", percent(glare.index), remark));
        let by_glass = (glare.index - glare.scattered).max(0.0);
        table.push(("  by glass alone", percent(by_glass), "reflected twice or more, never scattered"));
    }

    fn field(&self, sheet: &mut Sheet) {
        let focus = |key: &str, label: &str| Column::fixed(key, &format!("{label} mm"), 4);
        let mut table = Table::new(
            "chief_ray_exit_angle_deg",
            [
                Column::fixed("field_deg", "field deg", 2),
                Column::fixed("angle_deg", "exit angle deg", 3),
                focus("image_height_mm", "image height"),
                Column::plain("distortion", "distortion"),
                focus("sagittal_focus_mm", "sagittal"),
                focus("tangential_focus_mm", "tangential"),
                Column::percent("relative_illuminance", "light", 1),
            ],
        );
        let signed = |part: f64| match percent(part, 2) {
            shown if part > 0.0 && shown != "0.00 %" => format!("+{shown}"),
            shown => shown,
        };
        for p in &self.chief_ray_exit_angle_deg {
            table.push((
                p.field_deg,
                p.angle_deg,
                p.image_height_mm,
                p.distortion.map(signed),
                p.sagittal_focus_mm,
                p.tangential_focus_mm,
                p.relative_illuminance,
            ));
        }
        if table.is_empty() {
            return;
        }
        sheet.heading(
            "field points (sagittal, tangential: focus of close rays from the image plane; light: relative to the center)",
        );
        sheet.show(table);
        if self.is_cut {
            sheet.note("shown to the corner of 135 film: no rim limits the field to a useful size");
        }
    }

    fn room(&self, sheet: &mut Sheet) {
        let dips =
            |m: &MountReport| (m.clearance_mm < 0.0).then(|| format!(" ({:.1} behind the flange)", -m.clearance_mm));
        let words = |m: &MountReport| format!("{} {}{}", m.name, m.flange_mm, dips(m).unwrap_or_default());
        let mut mounts: Vec<String> =
            self.mounts.iter().filter(|m| self.every_mount || m.is_common()).map(words).collect();
        match self.mounts.len() - mounts.len() {
            0 => {}
            more if mounts.is_empty() => mounts.push(format!("{more} less common ones (`--mounts` lists them)")),
            more => mounts.push(format!("and {more} less common ones (`--mounts` lists them)")),
        }
        if !mounts.is_empty() {
            sheet.note(&format!("fits these mounts (flange focal distance in mm): {}", mounts.join(", ")));
        }
    }

    fn prescription(&self, sheet: &mut Sheet) {
        let nm = self.wavelength_nm.map_or(String::new(), |nm| format!("; index at {nm} nm"));
        let across = if self.surfaces.iter().any(|s| s.radius_x_mm.is_some()) { "; x: in the x-z section" } else { "" };
        sheet.heading(&format!("surfaces (lengths in mm{nm}{across})"));
        let mut table = Table::new(
            "surfaces",
            [
                Column::plain("number", "#"),
                Column::text("kind", "surface"),
                Column::plain("radius_mm", "radius"),
                Column::fixed("thickness_mm", "thickness", 4),
                Column::fixed("semi_diameter_mm", "semi-diameter", 4),
                Column::fixed("index", "index", 6),
                Column::text("medium", "medium behind"),
            ],
        );
        for s in &self.surfaces {
            let radius = match (s.radius_mm, s.radius_x_mm) {
                (Some(radius_mm), _) => format!("{radius_mm:.4}"),
                (None, Some(radius_x_mm)) => format!("x {radius_x_mm:.4}"),
                (None, None) => "flat".to_owned(),
            };
            let across = match (s.radius_mm, s.radius_x_mm) {
                (Some(_), Some(radius_x_mm)) => format!(" (radius x {radius_x_mm:.4})"),
                _ => String::new(),
            };
            let medium = format!("{}{across}", if s.mirror { "mirror" } else { &s.medium });
            table.push((s.number, &s.kind, radius, s.thickness_mm, s.semi_diameter_mm, s.index, medium));
        }
        sheet.show(table);
    }
}
