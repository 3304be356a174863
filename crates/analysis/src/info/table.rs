//! The report of a lens as text.

use super::{LensReport, MountReport};
use std::fmt;

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

impl fmt::Display for LensReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name)?;
        if let Some(year) = self.year {
            write!(f, " ({year})")?;
        }
        writeln!(f)?;
        let origin =
            [("maker", &self.maker), ("patent", &self.patent), ("source", &self.source), ("remark", &self.remark)];
        for (name, text) in origin {
            if let Some(text) = text {
                writeln!(f, "{name}: {}", text.trim())?;
            }
        }
        if let Some(rims) = &self.rims {
            writeln!(f, "rims: {rims}")?;
        }
        match (self.wavelength_nm, self.line) {
            (Some(nm), Some(line)) => writeln!(f, "wavelength: {nm} nm (line {line})")?,
            (Some(nm), None) => writeln!(f, "wavelength: {nm} nm")?,
            (None, _) => writeln!(f, "wavelength: none; every glass has the index that the prescription states")?,
        }
        writeln!(f, "distances along the axis are positive toward the image")?;
        writeln!(f)?;
        self.figures(f)?;
        self.glare(f)?;
        writeln!(f)?;
        self.field(f)?;
        self.room(f)?;
        self.prescription(f)?;
        super::media::write(&self.assumed_media, f)?;
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        Ok(())
    }
}

impl LensReport {
    fn figures(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        for (name, value, remark) in rows {
            // Drop the remark of an unknown figure, which would mislead. The remark of the T-number is on the losses and stays.
            let remark = if value == UNKNOWN && name != "T-number" { "" } else { remark };
            let line = format!("{name:<22} {value:>16}   {remark}");
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }

    fn glare(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(glare) = &self.glare else { return Ok(()) };
        let percent = |part: f64| format!("{:.*} %", if part < 0.01 { 3 } else { 2 }, 100.0 * part);
        let row = |f: &mut fmt::Formatter<'_>, name: &str, value: String, remark: String| {
            writeln!(f, "{}", format!("{name:<22} {value:>16}   {remark}").trim_end())
        };
        let of = |what: &str, part: f64| {
            if part > 0.0 { format!(", {what} reflects {}", percent(part)) } else { String::new() }
        };
        row(
            f,
            "veiling glare",
            percent(glare.index),
            format!(
                "+- {} (standard error); ISO 9358, integral, a black disk of {:.2} mm in the image{}{}",
                percent(glare.standard_error),
                glare.disk_mm,
                of("paint", glare.paint),
                of("film", glare.imager)
            ),
        )?;
        let by_glass = (glare.index - glare.scattered).max(0.0);
        row(f, "  by glass alone", percent(by_glass), "reflected twice or more, never scattered".to_owned())
    }

    fn field(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.chief_ray_exit_angle_deg.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "field points (sagittal, tangential: focus of close rays from the image plane; light: relative to the center)"
        )?;
        writeln!(
            f,
            "{:>10} {:>12} {:>15} {:>12} {:>14} {:>14} {:>9}",
            "field", "exit angle", "image height", "distortion", "sagittal", "tangential", "light"
        )?;
        let percent = |part: Option<f64>, digits: usize, sign: bool| match part.map(|part| 100.0 * part) {
            // Write no sign for a value that rounds to zero.
            Some(percent) if percent.abs() < 0.5 * 0.1_f64.powi(digits as i32) => format!("{:.digits$} %", 0.0),
            Some(percent) if sign => format!("{percent:+.digits$} %"),
            Some(percent) => format!("{percent:.digits$} %"),
            None => "-".to_owned(),
        };
        let focus = |focus_mm: Option<f64>| focus_mm.map_or("-".to_owned(), |z| mm(Some(z)));
        for p in &self.chief_ray_exit_angle_deg {
            writeln!(
                f,
                "{:>8.2} ° {:>10.3} ° {:>12.4} mm {:>12} {:>14} {:>14} {:>9}",
                p.field_deg,
                p.angle_deg,
                p.image_height_mm,
                percent(p.distortion, 2, true),
                focus(p.sagittal_focus_mm),
                focus(p.tangential_focus_mm),
                percent(p.relative_illuminance, 1, false),
            )?;
        }
        if self.is_cut {
            writeln!(f, "  shown to the corner of 135 film: no rim limits the field to a useful size")?;
        }
        writeln!(f)
    }

    fn room(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
            writeln!(f, "fits these mounts (flange focal distance in mm): {}", mounts.join(", "))?;
            writeln!(f)?;
        }
        Ok(())
    }

    fn prescription(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let nm = self.wavelength_nm.map_or(String::new(), |nm| format!("; index at {nm} nm"));
        let across = if self.surfaces.iter().any(|s| s.radius_x_mm.is_some()) { "; x: in the x-z section" } else { "" };
        writeln!(f, "surfaces (lengths in mm{nm}{across})")?;
        let kinds = self.surfaces.iter().map(|s| s.kind.len()).max().unwrap_or(0).max(7);
        writeln!(
            f,
            "{:>3}  {:<kinds$} {:>13} {:>11} {:>13} {:>10}  medium behind",
            "#", "surface", "radius", "thickness", "semi-diameter", "index"
        )?;
        for s in &self.surfaces {
            let radius = match (s.radius_mm, s.radius_x_mm) {
                (Some(radius_mm), _) => format!("{radius_mm:.4}"),
                (None, Some(radius_x_mm)) => format!("x {radius_x_mm:.4}"),
                (None, None) => "flat".to_owned(),
            };
            let semi_diameter = s.semi_diameter_mm.map_or("-".to_owned(), |d| format!("{d:.4}"));
            let medium = if s.mirror { "mirror" } else { &s.medium };
            let across = match (s.radius_mm, s.radius_x_mm) {
                (Some(_), Some(radius_x_mm)) => format!(" (radius x {radius_x_mm:.4})"),
                _ => String::new(),
            };
            writeln!(
                f,
                "{:>3}  {:<kinds$} {radius:>13} {:>11.4} {semi_diameter:>13} {:>10.6}  {medium}{across}",
                s.number, s.kind, s.thickness_mm, s.index
            )?;
        }
        Ok(())
    }
}
