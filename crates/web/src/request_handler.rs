//! The state behind a page without a server: one session, changed by the page's requests.

use serde_json::{Value, json};
use spectra_core::{Isa, registry};
use spectra_scene::{Negatives, bundled::Bundled};
use spectra_session::{Control as Stop, Session, SessionError, SessionOptions, SingleThread};
use spectra_view::page::{AspectRatio, PagePicture, PageState, SceneControls};
use spectra_view::parts::{error_json, head, spectra, svg};
use std::path::Path;

/// The session behind a page, which answers the page's requests.
#[derive(Default)]
pub struct RequestHandler {
    open: Option<OpenScene>,
}

/// An open scene and its session.
struct OpenScene {
    name: String,
    session: Session,
    shape: AspectRatio,
    page: PageState,
    fault: Option<Value>,
}

type Answer = Result<Vec<u8>, Value>;

impl RequestHandler {
    /// Answers `request`, which is JSON, with JSON; the answer has `faults` if the request failed. The answer to a request `look`
    /// is a picture in the format of `spectra view` instead.
    #[must_use]
    pub fn answer(&mut self, request: &[u8]) -> Vec<u8> {
        let answer = match serde_json::from_slice::<Value>(request) {
            Ok(request) => self.asked(&request),
            Err(error) => Err(wrong(&format!("the request is not JSON: {error}"))),
        };
        answer.unwrap_or_else(|error| error.to_string().into_bytes())
    }

    fn asked(&mut self, request: &Value) -> Answer {
        let word = |key: &str| request[key].as_str().unwrap_or_default();
        let number = |key: &str| request[key].as_u64().unwrap_or_default();
        match word("do") {
            "about" => Ok(json(&about())),
            "open" => {
                self.open = None;
                let set = request["set"].as_array().into_iter().flatten();
                let set: Vec<String> = set.filter_map(|text| text.as_str().map(str::to_owned)).collect();
                let open = OpenScene::scene(word("scene"), &set).map_err(|error| error_json(&error, ""))?;
                Ok(json(&self.open.insert(open).state()))
            }
            "width" => self.open()?.turn("width", &request["width"]),
            "turn" => self.open()?.turn(word("path"), &request["value"]),
            "step" => self.open()?.step(number("samples").max(1)),
            "look" => self.open()?.look(),
            "controls" => self
                .open()
                .map(|open| json(&open.page.controls(Some(&open.name), json!({"saves": false, "changes": 0})))),
            "pixel" => {
                let at = ["x", "y"].map(|key| u32::try_from(number(key)).unwrap_or(u32::MAX));
                self.open()?.page.pixel(at).map(|pixel| json(&pixel)).ok_or_else(|| wrong("no such pixel"))
            }
            "section" => {
                let drawn = svg(self.open()?.session.scene(), word("ground") == "dark");
                drawn.map(String::into_bytes).map_err(|why| wrong(&why.to_string()))
            }
            "spectra" => self.open().map(|open| json(&spectra(open.session.scene()))),
            "fingerprint" => self.open()?.fingerprint(),
            other => Err(wrong(&format!("no such request: {other}"))),
        }
    }

    fn open(&mut self) -> Result<&mut OpenScene, Value> {
        self.open.as_mut().ok_or_else(|| wrong("no scene is open"))
    }
}

/// Describes the program and its registered stages.
fn about() -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "stages": registry::list().len(),
        "scenes": Bundled::Scene.names(),
        "isa": Isa::detect().name(),
    })
}

fn json(value: &Value) -> Vec<u8> {
    value.to_string().into_bytes()
}

fn wrong(message: &str) -> Value {
    json!({"faults": [{"message": message}]})
}

impl OpenScene {
    /// Opens a bundled scene.
    fn scene(name: &str, set: &[String]) -> Result<Self, SessionError> {
        let session = Session::open(Path::new(name), set, SessionOptions::default())?;
        let (shape, page) = (AspectRatio::of(&session), PageState::of(&session));
        Ok(Self { name: name.to_owned(), session, shape, page, fault: None })
    }

    /// Returns the size and progress of the picture.
    fn state(&self) -> Value {
        let scene = self.session.scene();
        let size = scene.imager.size();
        json!({
            "width": size.width_px,
            "height": size.height_px,
            "samples": self.session.samples(),
            "of": self.session.samples_in_all(),
            "light": self.session.has_light(),
        })
    }

    fn turn(&mut self, path: &str, value: &Value) -> Answer {
        let change = self.page.change(path, value, None).map_err(|why| wrong(&why.to_string()))?;
        let changed = match change.texts(&self.shape).first() {
            Some(text) => self.session.change(text),
            // Another picture of the series.
            None => {
                let index = change.picture().unwrap_or(self.session.index());
                self.session.change_unprepared(&[""; 0], index, None, &SingleThread)
            }
        };
        self.fault = changed.as_ref().err().map(|error| error_json(error, path));
        let kept = changed.map_err(|error| error_json(&error, path))?;
        self.page.draw(self.session.scene(), false);
        self.page.adopt(&self.session, SceneControls::of(&self.session));
        let mut state = self.state();
        state["kept"] = kept.light.into();
        Ok(json(&state))
    }

    fn step(&mut self, samples: u64) -> Answer {
        let left = u64::from(self.session.scene().render.samples).saturating_sub(self.session.samples());
        let stepped = self.session.step(samples.min(left), &SingleThread, &Stop::new());
        self.fault = stepped.as_ref().err().map(|error| error_json(error, ""));
        stepped.map_err(|error| error_json(&error, ""))?;
        Ok(json(&self.state()))
    }

    /// Develops the light so far and packs the picture.
    fn look(&mut self) -> Answer {
        let failed = |error: SessionError| error_json(&error, "");
        let rendering = self.session.rendering().map_err(failed)?;
        let scene = self.session.scene();
        let times = scene.film_times(&rendering.exposure);
        let head = head(&self.session, &times, rendering.rays);
        let negatives = Negatives::default();
        let picture = PagePicture::develop(scene, rendering.exposure.into(), times, &negatives, Isa::detect());
        let picture = picture.map_err(failed)?.ok_or_else(|| wrong("the imager gives no picture"))?;
        let size_px = picture.size_px();
        Ok(self.page.show(picture, size_px, head, self.fault.as_ref()).to_vec())
    }

    /// Returns a hash of the exposure's bits, as in the report of `spectra run`.
    fn fingerprint(&mut self) -> Answer {
        let rendering = self.session.rendering().map_err(|error| error_json(&error, ""))?;
        let fingerprint = format!("{:016x}", rendering.exposure.fingerprint());
        Ok(json(&json!({"fingerprint": fingerprint, "rays": rendering.rays, "samples": self.session.samples()})))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(desk: &mut RequestHandler, request: &Value) -> Value {
        serde_json::from_slice(&desk.answer(request.to_string().as_bytes())).expect("JSON")
    }

    #[test]
    fn a_page_has_the_bits_of_the_command_and_a_second_render_too() {
        let set = ["imager.resolution=[48, 32]", "render.samples=4"];
        let mut desk = RequestHandler::default();
        let mut found = Vec::new();
        for steps in [vec![4], vec![1, 3]] {
            let opened = ask(&mut desk, &json!({"do": "open", "scene": "biotar-ortho", "set": set}));
            assert_eq!(opened["of"], 4, "{opened}");
            for samples in steps {
                ask(&mut desk, &json!({"do": "step", "samples": samples}));
            }
            found.push(ask(&mut desk, &json!({"do": "fingerprint"})));
        }
        let mut session =
            Session::open(Path::new("biotar-ortho"), &set.map(str::to_owned), SessionOptions::default()).expect("it");
        session.step(4, &SingleThread, &Stop::new()).expect("light");
        let command = format!("{:016x}", session.rendering().expect("light").exposure.fingerprint());
        assert!(found.iter().all(|answer| answer["fingerprint"] == command.as_str()), "{found:?}, {command}");
    }

    #[test]
    fn what_is_wrong_is_said_and_the_scene_stays() {
        let mut desk = RequestHandler::default();
        let faulty = |answer: &Value| answer["faults"][0]["message"].is_string();
        for request in [json!({"do": "step"}), json!({"do": "x"}), json!([]), json!({"do": "open", "scene": "no-such"})]
        {
            assert!(faulty(&ask(&mut desk, &request)), "{request}");
        }
        ask(&mut desk, &json!({"do": "open", "scene": "biotar-ortho", "set": ["imager.resolution=[24, 16]"]}));
        let turn = |path: &str, value: Value| json!({"do": "turn", "path": path, "value": value});
        assert!(faulty(&ask(&mut desk, &turn("lens.file", "../../etc/passwd".into()))));
        assert!(faulty(&ask(&mut desk, &turn("lens.f-number", 0.1.into()))));
        assert_eq!(ask(&mut desk, &turn("lens.f-number", 4.into()))["kept"], false);
        assert_eq!(ask(&mut desk, &json!({"do": "step", "samples": 1}))["samples"], 1);
        let frame = desk.answer(json!({"do": "look"}).to_string().as_bytes());
        let head = u32::from_le_bytes(frame[..4].try_into().expect("four bytes")) as usize;
        assert_eq!(frame.len(), 4 + head + 24 * 16 * 3 * 2);
        assert!(desk.answer(json!({"do": "section", "ground": "light"}).to_string().as_bytes()).starts_with(b"<svg"));
    }
}
