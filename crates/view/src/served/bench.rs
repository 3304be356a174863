//! Link between a scene and the dispersion study: the prism with which the study starts, and saving it back into the scene.

use super::render_job::RenderJob;
use super::save::save;
use super::study::Prism;
use glam::DVec3;
use serde_json::{Value, json};
use spectra_core::math::atan2;
use spectra_core::params::{Length, Node, Quantity};
use spectra_files::write_atomically;
use spectra_glass::Medium;
use spectra_lens::Lens;
use spectra_scene::Scene;
use spectra_session::{Session, SessionOptions};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};

/// First line of a lens file that this page wrote, and which it may therefore overwrite.
const MARK: &str = "# A prism, as the dispersion study of `spectra view` has it.\n";

/// Returns whether a lens is a prism: one piece of glass between two plane faces that are tilted to each other.
pub(super) fn is_prism(lens: &Lens) -> bool {
    let [first, second] = &lens.elements[..] else { return false };
    let is_plane = |element: &spectra_lens::Element| element.surface.vertex_curvature_per_mm() == (0.0, 0.0);
    is_plane(first) && is_plane(second) && normals(lens).is_some_and(|[one, other]| one.dot(other).abs() < 0.9999)
}

fn normals(lens: &Lens) -> Option<[DVec3; 2]> {
    let [first, second] = &lens.elements[..] else { return None };
    Some([first, second].map(|element| element.pose.direction(DVec3::Z)))
}

/// Returns the prism, beam and light of the scene of an order as JSON for the page, as far as the study can show them. `None` if the scene
/// has no prism.
pub(super) fn start(order: &RenderJob) -> Option<Value> {
    let session = order.session().ok()?;
    let scene = session.scene();
    if !is_prism(&scene.lens) {
        return None;
    }
    let mut start = words(scene)?;
    start["text"] = std::fs::read_to_string(&order.scene).ok().map(|text| print_of(&text)).into();
    Some(start)
}

/// Returns the prism, beam and light of a scene as JSON.
fn words(scene: &Scene) -> Option<Value> {
    let lens = &scene.lens;
    let angles = normals(lens)?.map(|normal| atan2(-normal.y, normal.z).to_degrees());
    let first = lens.elements.first()?;
    let glass = match &lens.media.get(first.medium_after)?.medium {
        Medium::Glass(glass) => Some(format!("{}/{}", glass.maker, glass.name)),
        _ => None,
    };
    let root = scene.params.node();
    let text = |path: &str| root.at_path(path).and_then(Node::as_str).map(str::to_owned);
    let height = root.at_path("source.position").and_then(|position| position.element(1)).and_then(Node::as_str);
    let intensity = (0..16).find_map(|k| text(&format!("output[{k}].intensity")));
    Some(json!({
        "apex": angles[0] - angles[1],
        "side": first.semi_diameter_mm.map(|half| 2.0 * half),
        "incidence": angles[0],
        "beam": height.and_then(|text| Length::from_text(text).ok()).map_or(0.0, Length::mm),
        "glass": glass,
        "light": text("source.spectrum"),
        "intensity": intensity.filter(|word| word == "true").unwrap_or_else(|| "full".to_owned()),
    }))
}

/// Returns a hash of a text, as 16 hexadecimal digits.
fn print_of(text: &str) -> String {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Writes a prism and its beam into the scene of an order, if the scene's file still has the hash `print`. The prism goes into a separate
/// lens file beside the scene, the rest where a person would write it. Returns the number of changed values, the lens file and the new
/// hash as JSON.
///
/// # Errors
/// The reason why nothing is written.
pub(super) fn keep(order: &RenderJob, prism: &Prism, print: &str) -> Result<Value, String> {
    let file = &order.scene;
    let before = std::fs::read_to_string(file)
        .map_err(|_| "a bundled scene cannot be changed: make one of your own with `spectra new scene`".to_owned())?;
    if print_of(&before) != print {
        return Err(format!("{} has changed meanwhile: reload the page", file.display()));
    }
    let options = SessionOptions { isa: order.isa, ..SessionOptions::default() };
    let session = Session::open(file, &order.overrides, options).map_err(|error| error.to_string())?;
    let scene = session.scene();
    let known = words(scene).filter(|_| is_prism(&scene.lens)).ok_or("the scene no longer has a prism")?;
    let root = scene.params.node();
    let lens = lens_file(file, root.at_path("lens.file").and_then(Node::as_str).unwrap_or_default())?;
    let mut changes = Vec::new();
    let mut set = |path: &str, value: String| changes.push((path.to_owned(), format!("{path}={value}")));
    if known["light"] != prism.light.as_str() {
        set("source.spectrum", format!("{:?}", prism.light));
    }
    if known["beam"].as_f64().is_none_or(|height| (height - prism.beam_mm).abs() > 1e-9) {
        set("source.position", format!("[0 mm, {} mm]", prism.beam_mm));
    }
    if !lens.is_named {
        set("lens.file", lens.name.clone());
    }
    let text = format!("{MARK}{}", prism.file()?);
    let old = std::fs::read(&lens.path).ok();
    let put =
        |bytes: &[u8]| write_atomically(&lens.path, |out| Ok(out.write_all(bytes)?)).map_err(|error| error.to_string());
    put(text.as_bytes())?;
    let saved = if changes.is_empty() { Ok(before.clone()) } else { save(file, &before, &order.overrides, &changes) };
    match saved {
        Ok(now) => Ok(json!({"saved": changes.len(), "lens": lens.path.display().to_string(), "text": print_of(&now)})),
        Err(why) => {
            // The lens file is restored, so that either both files change or neither.
            match old {
                Some(old) => put(&old)?,
                None => drop(std::fs::remove_file(&lens.path)),
            }
            Err(why)
        }
    }
}

/// The lens file into which the prism is written.
struct LensFile {
    path: PathBuf,
    /// Name of the file in the scene.
    name: String,
    /// Whether the scene already names this file.
    is_named: bool,
}

/// Returns the lens file of a scene if this page wrote it, otherwise a new one. Fails if the new name is taken by another file.
fn lens_file(scene: &Path, named: &str) -> Result<LensFile, String> {
    let folder = scene.parent().unwrap_or(Path::new(""));
    let is_own = |path: &Path| std::fs::read_to_string(path).is_ok_and(|text| text.starts_with(MARK));
    let path = folder.join(named);
    if is_own(&path) {
        return Ok(LensFile { path, name: named.to_owned(), is_named: true });
    }
    let stem = scene.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy());
    let name = format!("{stem}-prism.yaml");
    let path = folder.join(&name);
    if path.exists() && !is_own(&path) {
        return Err(format!("{} exists and was written by somebody else", path.display()));
    }
    Ok(LensFile { path, name, is_named: false })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::Isa;
    use spectra_plugins as _;

    fn order(scene: PathBuf) -> RenderJob {
        RenderJob { scene, photograph: None, overrides: Vec::new(), isa: Isa::detect(), threads: 1 }
    }

    #[test]
    fn the_study_starts_from_the_scene_and_saves_into_it() {
        let bundled = start(&order("prism-5800k".into())).expect("a prism");
        let number = |start: &Value, name: &str| start[name].as_f64().expect("a number");
        assert!(
            (number(&bundled, "apex") - 60.0).abs() < 1e-9 && (number(&bundled, "incidence") - 63.1713).abs() < 1e-9
        );
        assert_eq!((number(&bundled, "side"), number(&bundled, "beam")), (30.0, 0.0));
        assert_eq!((&bundled["glass"], &bundled["light"]), (&json!("SCHOTT/N-SF11"), &json!("blackbody:5800")));
        assert!(start(&order("biotar-ortho".into())).is_none());

        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("mine.yaml");
        let text = "spectra: 1 # mine\nsource: {kind: beam, distance: 60 mm, slit: [6 mm, 0.3 mm], spectrum: \"blackbody:5800\"}\n\
            lens: {file: prism-60-sf11}\nimager: {kind: xyz, width: 12 mm, height: 36 mm, resolution: [24, 72]}\n\
            render: {rays: 1e4}\n";
        std::fs::write(&file, text).expect("written");
        let order = order(file.clone());
        let begun = start(&order).expect("a prism");
        let print = begun["text"].as_str().expect("a print").to_owned();
        let prism = Prism {
            apex_deg: 45.0,
            side_mm: 40.0,
            glass: "SCHOTT/N-BK7".to_owned(),
            incidence_deg: 35.0,
            beam_mm: 2.5,
            light: "hydrogen".to_owned(),
            is_true: false,
        };
        let kept = keep(&order, &prism, &print).unwrap_or_else(|why| panic!("{why}"));
        assert_eq!(kept["saved"], 3);
        let now = std::fs::read_to_string(&file).expect("there");
        assert!(now.starts_with("spectra: 1 # mine\n") && now.contains("mine-prism.yaml"), "{now}");
        let again = start(&order).expect("a prism");
        for (name, value) in [("apex", 45.0), ("side", 40.0), ("incidence", 35.0), ("beam", 2.5)] {
            assert!((number(&again, name) - value).abs() < 1e-9, "{name}: {again}");
        }
        assert_eq!(
            (&again["glass"], &again["light"], &again["text"]),
            (&json!("SCHOTT/N-BK7"), &json!("hydrogen"), &kept["text"])
        );

        // The page's own lens file is overwritten; a scene that somebody changed meanwhile, or somebody else's lens file, is not.
        assert!(keep(&order, &prism, &print).expect_err("an older text").contains("has changed"));
        let print = kept["text"].as_str().expect("a print");
        assert_eq!(keep(&order, &Prism { apex_deg: 50.0, ..prism.clone() }, print).expect("saved")["saved"], 0);
        assert!((number(&start(&order).expect("a prism"), "apex") - 50.0).abs() < 1e-9);
        std::fs::write(&file, text).expect("written");
        std::fs::write(folder.path().join("mine-prism.yaml"), "name: of somebody else\n").expect("written");
        assert!(keep(&order, &prism, &print_of(text)).expect_err("not its own").contains("somebody else"));
        assert_eq!(std::fs::read_to_string(&file).expect("there"), text);
    }
}
