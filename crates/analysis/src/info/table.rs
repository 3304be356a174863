//! The report as a person reads it.

use super::{LensReport, MountReport};
use std::fmt;

/// A length, or why there is none.
fn mm(value: Option<f64>) -> String {
    match value {
        Some(value) if value.is_finite() => format!("{value:.4} mm"),
        Some(_) => "infinite".to_owned(),
        None => "unknown".to_owned(),
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
        match (self.wavelength_nm, self.line) {
            (Some(nm), Some(line)) => writeln!(f, "at {nm} nm, the line {line}")?,
            (Some(nm), None) => writeln!(f, "at {nm} nm")?,
            (None, _) => writeln!(f, "at the indices that the prescription states")?,
        }
        writeln!(f)?;
        self.figures(f)?;
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
        let f_number = self.f_number.map_or("unknown".to_owned(), |n| format!("f/{n:.4}"));
        let t_number = self.t_number.map_or("unknown".to_owned(), |n| format!("T/{n:.4}"));
        let max_field = self.max_field_deg.map_or("unknown".to_owned(), |field| format!("{field:.3} deg"));
        let limit =
            self.max_field_limit.map_or(String::new(), |l| format!("then {} at surface {}", l.cause, l.surface));
        let contrast = format!("where contrast at {} lp/mm is highest", self.contrast_frequency_per_mm);
        let (stop, stop_remark) = match (self.has_stop, self.stop_semi_diameter_mm) {
            (_, Some(_)) => (mm(self.stop_semi_diameter_mm), "semi-diameter"),
            (true, None) => ("open".to_owned(), "the file gives it no semi-diameter: rims limit the light"),
            (false, None) => ("none".to_owned(), ""),
        };
        let f_remark = match self.nominal_f_number {
            Some(nominal) => format!("by the real marginal ray; f/{nominal} in its name"),
            None => "by the real marginal ray".to_owned(),
        };
        let rows = [
            ("focal length", mm(Some(self.efl_mm)), ""),
            ("f-number", f_number, &f_remark),
            ("T-number", t_number, &self.losses),
            ("back focal length", mm(Some(self.bfl_mm)), "from the last vertex"),
            ("front focal length", mm(Some(self.ffl_mm)), "from the first vertex"),
            ("front principal plane", mm(Some(self.front_principal_z_mm)), "from the first vertex"),
            ("rear principal plane", mm(Some(self.rear_principal_z_mm)), "from the first vertex"),
            ("front nodal point", mm(Some(self.front_nodal_z_mm)), "from the first vertex"),
            ("rear nodal point", mm(Some(self.rear_nodal_z_mm)), "from the first vertex"),
            ("entrance pupil", mm(self.entrance_pupil_z_mm), "from the first vertex"),
            ("  its diameter", mm(self.entrance_pupil_diameter_mm), "by the real marginal ray"),
            ("exit pupil", mm(self.exit_pupil_z_mm), "from the first vertex"),
            ("  its diameter", mm(self.exit_pupil_diameter_mm), "by the real marginal ray"),
            ("stop", stop, stop_remark),
            ("length", mm(Some(self.vertex_length_mm)), "first vertex to last"),
            ("image plane", mm(Some(self.image_distance_mm)), "from the last vertex"),
            ("total track", mm(Some(self.total_track_mm)), "first vertex to image plane"),
            ("focused at", mm(Some(self.focus_distance_mm)), "from the first vertex"),
            ("  magnification", format!("{:.6}", self.magnification), ""),
            ("  paraxial image", mm(self.paraxial_focus_shift_mm), "behind the image plane"),
            ("  smallest spot", mm(self.rms_focus_shift_mm), "behind it, root mean square, real rays"),
            ("  best contrast", mm(self.contrast_focus_shift_mm), &contrast),
            ("largest field", max_field, &limit),
        ];
        if let Some(efl_x_mm) = self.efl_x_mm {
            writeln!(f, "{:<22} {:>16}   in the x-z section", "focal length", mm(Some(efl_x_mm)))?;
        }
        for (name, value, remark) in rows {
            let line = format!("{name:<22} {value:>16}   {remark}");
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }

    fn field(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.chief_ray_exit_angle_deg.is_empty() {
            return Ok(());
        }
        writeln!(f, "{:>10} {:>16} {:>16}   chief ray", "field", "exit angle", "image height")?;
        for ray in &self.chief_ray_exit_angle_deg {
            writeln!(f, "{:>8.2} ° {:>14.3} ° {:>13.4} mm", ray.field_deg, ray.angle_deg, ray.image_height_mm)?;
        }
        writeln!(f)
    }

    fn room(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dips =
            |m: &MountReport| (m.clearance_mm < 0.0).then(|| format!(" ({:.1} behind the flange)", -m.clearance_mm));
        let words = |m: &MountReport| format!("{} {}{}", m.name, m.flange_mm, dips(m).unwrap_or_default());
        let mounts: Vec<String> = self.mounts.iter().map(words).collect();
        if !mounts.is_empty() {
            writeln!(f, "fits the mounts (flange to image in mm): {}", mounts.join(", "))?;
            writeln!(f)?;
        }
        Ok(())
    }

    fn prescription(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = self.surfaces.iter().map(|s| s.kind.len()).max().unwrap_or(0).max(7);
        writeln!(
            f,
            "{:>3}  {:<kinds$} {:>13} {:>11} {:>13} {:>10}  medium behind",
            "#", "surface", "radius", "thickness", "semi-diameter", "index"
        )?;
        for s in &self.surfaces {
            let radius = s.radius_mm.map_or("flat".to_owned(), |r| format!("{r:.4}"));
            let semi_diameter = s.semi_diameter_mm.map_or("-".to_owned(), |d| format!("{d:.4}"));
            let medium = if s.mirror { "mirror" } else { &s.medium };
            writeln!(
                f,
                "{:>3}  {:<kinds$} {radius:>13} {:>11.4} {semi_diameter:>13} {:>10.6}  {medium}",
                s.number, s.kind, s.thickness_mm, s.index
            )?;
        }
        Ok(())
    }
}
