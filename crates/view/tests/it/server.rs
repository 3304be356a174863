//! Tests of the server through its socket: what a page does, and what others try.

use half::f16;
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_plugins as _;
use spectra_view::{ViewerSettings, view};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::mpsc;
use std::time::{Duration, Instant};

const SCENE: &str = "spectra: 1\nsource: {kind: chart, chart: resolution, distance: 2 m, luminance: 300 cd/m2, width: fill}\n\
    lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\nimager: {kind: film, format: 135, resolution: [60, 40]}\n\
    film: {stock: kodak-tri-x-400, exposure: 1/80 s}\nrender: {samples: 4}\noutput: [png]\n";

struct Browser {
    host: String,
    token: String,
    cookie: String,
    _folder: tempfile::TempDir,
    file: std::path::PathBuf,
}

struct Got {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Got {
    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).expect("JSON")
    }
}

/// Sends these bytes and reads until the server closes the connection; `None` if it closes it without an answer.
fn raw(host: &str, bytes: &[u8]) -> Option<Got> {
    let mut stream = TcpStream::connect(host).expect("a server");
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
    // The server may close the connection before it has read everything.
    let _ = stream.write_all(bytes);
    let mut all = Vec::new();
    let mut some = [0; 65536];
    while let Ok(count) = stream.read(&mut some) {
        if count == 0 {
            break;
        }
        all.extend(&some[..count]);
    }
    let end = all.windows(4).position(|w| w == b"\r\n\r\n")?;
    let head = String::from_utf8(all[..end].to_vec()).expect("text");
    let status = head.split(' ').nth(1)?.parse().ok()?;
    Some(Got { status, head, body: all[end + 4..].to_vec() })
}

impl Browser {
    /// Starts a server with a scene; the browser does not have the cookie yet.
    fn start() -> Self {
        Self::start_with("scene.yaml", SCENE.as_bytes())
    }

    /// Starts a server with a file of this name and content; the browser does not have the cookie yet.
    fn start_with(name: &str, bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).expect("written");
        let (tell, hear) = mpsc::channel();
        let own = ViewerSettings {
            scene: file.clone(),
            stock: None,
            overrides: Vec::new(),
            port: 0,
            isa: Isa::detect(),
            threads: 2,
        };
        // The thread ends with the process.
        std::thread::spawn(move || view(own, |address| tell.send(address.to_owned()).expect("heard")));
        let address = hear.recv_timeout(Duration::from_secs(60)).expect("an address");
        let (host, token) =
            address.strip_prefix("http://").and_then(|a| a.split_once("/?token=")).expect("as documented");
        assert!(host.starts_with("127.0.0.1:") && token.len() == 32, "{address}");
        Self { host: host.to_owned(), token: token.to_owned(), cookie: String::new(), _folder: folder, file }
    }

    /// Starts a server with a scene and opens its address, so that the browser has the cookie.
    fn let_in() -> Self {
        Self::start().entered()
    }

    /// Starts a server with a file and opens its address.
    fn viewing(name: &str, bytes: &[u8]) -> Self {
        Self::start_with(name, bytes).entered()
    }

    fn entered(self) -> Self {
        let mut browser = self;
        let got = browser.get(&format!("/?token={}", browser.token)).expect("an answer");
        assert_eq!(got.status, 303, "{}", got.head);
        let cookie = got.head.lines().find_map(|line| line.strip_prefix("Set-Cookie: ")).expect("a cookie");
        assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
        browser.cookie = cookie.split(';').next().expect("a value").to_owned();
        browser
    }

    fn get(&self, path: &str) -> Option<Got> {
        raw(
            &self.host,
            format!("GET {path} HTTP/1.1\r\nHost: {}\r\nCookie: {}\r\n\r\n", self.host, self.cookie).as_bytes(),
        )
    }

    fn post(&self, path: &str, body: &str) -> Got {
        let (host, cookie) = (&self.host, &self.cookie);
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nCookie: {cookie}\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        );
        raw(host, head.as_bytes()).expect("an answer")
    }

    fn open(&self) -> u64 {
        self.post("/open", "").json()["desk"].as_u64().expect("a number")
    }

    /// Requests frames after this number until one is wanted, and returns its head and its light.
    fn frame(&self, desk: u64, mut after: u64, is_wanted: impl Fn(&Value) -> bool) -> (Value, Vec<f32>) {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            assert!(Instant::now() < end, "no such frame");
            let got = self.get(&format!("/frame?desk={desk}&after={after}")).expect("an answer");
            if got.status == 204 {
                continue;
            }
            assert_eq!(got.status, 200, "{}", String::from_utf8_lossy(&got.body));
            let length = u32::from_le_bytes(got.body[..4].try_into().expect("four")) as usize;
            let head: Value = serde_json::from_slice(&got.body[4..4 + length]).expect("a head");
            after = head["frame"].as_u64().expect("a number");
            if is_wanted(&head) {
                let halves = got.body[4 + length..].chunks_exact(2);
                return (head, halves.map(|b| f16::from_le_bytes(b.try_into().expect("two")).to_f32()).collect());
            }
        }
    }

    /// Returns the controls once this many changes are applied or refused.
    fn controls(&self, desk: u64, turns: u64) -> Value {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let said = self.get(&format!("/controls?desk={desk}")).expect("an answer").json();
            if said["turns"].as_u64().expect("a number") >= turns {
                return said;
            }
            assert!(Instant::now() < end, "{said}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Changes a control, waits until the change is applied or refused, and returns the controls.
    fn turned(&self, desk: u64, path: &str, value: Value) -> Value {
        let got = self.turn(desk, path, value);
        assert_eq!(got.status, 200, "{path}: {}", String::from_utf8_lossy(&got.body));
        self.controls(desk, got.json()["turn"].as_u64().expect("a number"))
    }

    fn turn(&self, desk: u64, path: &str, value: Value) -> Got {
        self.post(&format!("/turn?desk={desk}"), &json!({"path": path, "value": value}).to_string())
    }
}

/// Returns the value of a control.
fn value_of(said: &Value, path: &str) -> Value {
    let all = said["controls"].as_array().expect("a list");
    all.iter().find(|control| control["path"] == path).unwrap_or_else(|| panic!("no {path}"))["value"].clone()
}

/// Opens the text of a scene.
fn opened(text: &str) -> spectra_session::Session {
    let resources = std::sync::Arc::new(spectra_scene::FileResources::beside(".".as_ref()));
    let series = spectra_scene::series_of_text("scene.yaml", text, &[], resources).expect("a scene");
    spectra_session::Session::new(series, spectra_session::SessionOptions::default()).expect("a scene")
}

/// Renders the text of a scene with all its samples, and returns the picture as a page receives it.
fn picture_of(text: &str) -> Vec<f32> {
    let mut session = opened(text);
    let samples = u64::from(session.scene().render.samples);
    session.step(samples, &spectra_session::Threads(2), &spectra_session::Control::new()).expect("light");
    as_sent(&session.develop().expect("a picture").remove(0).1.rgb.concat())
}

fn is_done(head: &Value) -> bool {
    head["samples"].is_u64() && head["samples"] == head["of"]
}

/// Returns light as a page receives it, rounded to 16 bits.
fn as_sent(light: &[f32]) -> Vec<f32> {
    light.iter().map(|v| f16::from_f32(*v).to_f32()).collect()
}

fn mean(light: &[f32]) -> f64 {
    light.iter().map(|v| f64::from(*v)).sum::<f64>() / light.len() as f64
}

#[test]
fn a_picture_follows_what_is_turned_and_is_saved() {
    let browser = Browser::let_in();
    for (path, kind) in [("/", "text/html"), ("/page.js", "text/javascript"), ("/page.css", "text/css")] {
        let got = browser.get(path).expect("an answer");
        assert!(
            got.status == 200 && got.head.contains(kind) && got.head.contains("default-src 'none'"),
            "{}",
            got.head
        );
    }
    let desk = browser.open();
    let (head, first) = browser.frame(desk, 0, is_done);
    assert_eq!((head["width"].as_u64(), head["height"].as_u64()), (Some(480), Some(320)));
    assert_eq!(first.len(), 3 * 480 * 320);
    let controls = browser.get(&format!("/controls?desk={desk}")).expect("an answer").json();
    assert!(controls["controls"].as_array().expect("a list").len() > 40 && controls["name"] == "scene", "{controls}");
    let section = browser.get(&format!("/section?desk={desk}&ground=dark")).expect("an answer");
    assert!(section.status == 200 && section.body.starts_with(b"<svg"));
    let pixel = browser.get(&format!("/pixel?desk={desk}&x=240&y=160")).expect("an answer").json();
    assert!(
        pixel["channels"][0]["value"].as_f64().expect("lux seconds") > 0.0 && pixel["channels"][0]["unit"] == "lx s"
    );
    assert_eq!(browser.get(&format!("/pixel?desk={desk}&x=480&y=0")).expect("an answer").status, 404);

    let spectra = browser.get(&format!("/spectra?desk={desk}")).expect("an answer").json();
    let values = spectra["layers"][0]["values"].as_array().expect("a list");
    assert_eq!(values.iter().filter_map(Value::as_f64).fold(0.0, f64::max), 1.0);
    assert_eq!(spectra["light"]["values"].as_array().expect("a list").len(), values.len());

    // A change of the development alone keeps the rays, and makes the print lighter or darker.
    let rays = head["rays"].clone();
    let at = head["frame"].as_u64().expect("a number");
    assert_eq!(browser.turn(desk, "film.push", json!(1)).status, 200);
    let (pushed, light) = browser.frame(desk, at, is_done);
    assert_eq!(pushed["rays"], rays);
    assert!((mean(&light) - mean(&first)).abs() > 0.005, "{} {}", mean(&light), mean(&first));

    // A change that is traced: the picture is bit by bit that of a run with this value.
    assert_eq!(browser.turn(desk, "lens.f-number", json!(4)).status, 200);
    let (closed, light) = browser.frame(desk, pushed["frame"].as_u64().expect("a number"), is_done);
    let text = SCENE.replace("[60, 40]", "[480, 320]").replace("f/2", "f/4").replace("1/80 s", "1/80 s, push: 1");
    let mut session = opened(&text);
    session.step(4, &spectra_session::Threads(2), &spectra_session::Control::new()).expect("light");
    let wanted = session.develop().expect("a picture").remove(0).1;
    assert!(light == as_sent(&wanted.rgb.concat()), "{closed}");

    // A value that the scene cannot have is reported with its path, and the picture stays.
    assert_eq!(browser.turn(desk, "lens.f-number", json!(0.01)).status, 200);
    let (faulty, _) =
        browser.frame(desk, closed["frame"].as_u64().expect("a number"), |head| head["fault"].is_object());
    assert_eq!(faulty["fault"]["path"], "lens.f-number");
    assert!(faulty["fault"]["faults"][0]["message"].as_str().is_some_and(|m| !m.is_empty()), "{faulty}");
    assert_eq!(browser.turn(desk, "lens.f-number", json!(4)).status, 200);
    browser.frame(desk, faulty["frame"].as_u64().expect("a number"), |head| head["fault"].is_null() && is_done(head));

    let got = browser.post(&format!("/save?desk={desk}"), "");
    assert_eq!(got.status, 200, "{}", String::from_utf8_lossy(&got.body));
    let saved = std::fs::read_to_string(&browser.file).expect("a file");
    assert_eq!(saved, SCENE.replace("f/2", "f/4").replace("1/80 s", "1/80 s, push: 1"));
    // The page continues from there, until somebody else writes to the file.
    assert_eq!(browser.turn(desk, "film.push", json!(0)).status, 200);
    let at = browser.frame(desk, 0, |_| true).0["frame"].as_u64().expect("a number");
    assert_eq!(browser.turn(desk, "film.compensation", json!(0)).status, 200);
    browser.frame(desk, at, |head| !head["width"].is_null());
    assert_eq!(browser.post(&format!("/save?desk={desk}"), "").status, 200);
    assert!(std::fs::read_to_string(&browser.file).expect("a file").contains("push: 0"));
    assert_eq!(browser.turn(desk, "film.push", json!(1)).status, 200);
    // If somebody else writes something that is not a scene, the page cannot load it and must not overwrite it.
    let broken = SCENE.replace("f/2", "f/2, fnumber: 3");
    std::fs::write(&browser.file, &broken).expect("written by somebody else");
    let refused = browser.post(&format!("/save?desk={desk}"), "");
    assert_eq!(refused.status, 409, "{}", refused.head);
    assert_eq!(std::fs::read_to_string(&browser.file).expect("a file"), broken);
    // Once the page has loaded the file, whose values replace those of the page, nothing is left to write.
    std::fs::write(&browser.file, SCENE).expect("written by somebody else");
    browser.frame(desk, 0, |head| head["reread"] == 1);
    let nothing = browser.post(&format!("/save?desk={desk}"), "");
    assert_eq!((nothing.status, &nothing.json()["saved"]), (200, &json!(0)));
    assert_eq!(std::fs::read_to_string(&browser.file).expect("a file"), SCENE);

    assert_eq!(browser.post(&format!("/close?desk={desk}"), "").status, 204);
    assert_eq!(browser.get(&format!("/frame?desk={desk}&after=0")).expect("an answer").status, 404);
}

#[test]
fn a_draft_comes_first_and_the_whole_picture_is_that_of_a_run() {
    let browser = Browser::let_in();
    let desk = browser.open();
    let (head, _) = browser.frame(desk, 0, is_done);
    let at = head["frame"].as_u64().expect("a number");
    assert_eq!(browser.turn(desk, "lens.focus", json!(1.5)).status, 200);
    let (draft, light) = browser.frame(desk, at, |head| head["width"].is_u64());
    assert_eq!((&draft["draft"], &draft["width"], &draft["light"]), (&json!(true), &json!(480), &json!([120, 80])));
    assert_eq!(light.len(), 3 * 120 * 80);
    // A pixel of the whole picture can be read from the draft, too.
    assert_eq!(browser.get(&format!("/pixel?desk={desk}&x=479&y=319")).expect("an answer").status, 200);
    let (whole, light) = browser.frame(desk, draft["frame"].as_u64().expect("a number"), is_done);
    assert_eq!((&whole["draft"], &whole["light"]), (&json!(false), &json!([480, 320])));
    let text = SCENE.replace("[60, 40]", "[480, 320]").replace("focus: 2 m", "focus: 1.5 m");
    let mut session = opened(&text);
    session.step(4, &spectra_session::Threads(2), &spectra_session::Control::new()).expect("light");
    let wanted = session.develop().expect("a picture").remove(0).1;
    assert!(light == as_sent(&wanted.rgb.concat()), "{whole}");

    // Print, push, grade and grain need no draft and no rays: the whole picture comes at once, or a smaller one first if it is large.
    assert_eq!(browser.turn(desk, "width", json!(960)).status, 200);
    let large = |head: &Value| is_done(head) && head["width"] == 960;
    let (head, _) = browser.frame(desk, whole["frame"].as_u64().expect("a number"), large);
    assert_eq!(browser.turn(desk, "film.paper.grade", json!("4")).status, 200);
    let (first, _) = browser.frame(desk, head["frame"].as_u64().expect("a number"), |head| head["width"].is_u64());
    assert_eq!(first["rays"], head["rays"]);
    assert!(first["light"] == json!([480, 320]) || first["light"] == json!([960, 640]), "{first}");
    let (last, _) = browser.frame(desk, head["frame"].as_u64().expect("a number"), |head| head["light"][0] == 960);
    assert_eq!(last["rays"], head["rays"]);
}

/// Refused values leave the scene as it was, whatever else is changed. They are reported until they are changed again.
#[test]
fn controls_never_say_what_the_picture_does_not_have() {
    let browser = Browser::let_in();
    let desk = browser.open();
    browser.frame(desk, 0, is_done);
    // A value out of range is refused at once, with the range, and nothing changes.
    let far = browser.turn(desk, "film.compensation", json!(99));
    let why = String::from_utf8_lossy(&far.body).into_owned();
    assert!(far.status == 400 && why.contains("99 is out of range: it goes from -10 to 10"), "{why}");
    for (path, value) in [("lens.f-number", json!(1.0)), ("lens.focus", json!(0.001))] {
        let before = browser.controls(desk, 0);
        let said = browser.turned(desk, path, value);
        assert!(said["refused"][path]["faults"][0]["message"].is_string(), "{path}: {}", said["refused"]);
        assert_eq!(value_of(&said, path), value_of(&before, path));
    }
    // After another change, the refused values are still reported, and the picture has what the controls say.
    let said = browser.turned(desk, "film.push", json!(1));
    let refused = said["refused"].as_object().expect("a map");
    assert_eq!(refused.len(), 2, "{refused:?}");
    let stop = value_of(&said, "lens.f-number");
    assert_eq!((stop, value_of(&said, "film.push")), (json!(2.0), json!(1.0)));
    let (head, light) = browser.frame(desk, 0, |head| is_done(head) && head["draft"] == false);
    let text = SCENE.replace("[60, 40]", "[480, 320]").replace("1/80 s", "1/80 s, push: 1");
    assert!(light == picture_of(&text), "{head}");
    // A valid value ends the refusal.
    let said = browser.turned(desk, "lens.f-number", json!(4));
    assert!(said["refused"]["lens.f-number"].is_null() && value_of(&said, "lens.f-number") == json!(4.0));
}

#[test]
fn a_swept_key_chooses_among_the_pictures() {
    let swept = format!("{SCENE}sweep: {{lens.f-number: [f/2, f/8], film.push: [0, 1]}}\n");
    let browser = Browser::viewing("swept.yaml", swept.as_bytes());
    let desk = browser.open();
    let (head, first) = browser.frame(desk, 0, is_done);
    let said = browser.controls(desk, 0);
    let control =
        said["controls"].as_array().expect("a list").iter().find(|c| c["path"] == "lens.f-number").expect("it");
    assert_eq!((&control["kind"]["words"], &control["value"]), (&json!(["f/2", "f/8"]), &json!("f/2")));
    let said = browser.turned(desk, "lens.f-number", json!("f/8"));
    assert_eq!((value_of(&said, "lens.f-number"), value_of(&said, "film.push")), (json!("f/8"), json!("0")));
    assert_eq!(value_of(&said, "picture"), "3: lens.f-number = f/8, film.push = 0");
    let at = head["frame"].as_u64().expect("a number");
    let (_, light) = browser.frame(desk, at, |head| is_done(head) && head["draft"] == false);
    assert!(light != first);
    let text = SCENE.replace("[60, 40]", "[480, 320]").replace("f/2", "f/8").replace("1/80 s", "1/80 s, push: 0");
    assert!(light == picture_of(&text));
    // Other values can be changed as usual; a value that the sweep does not have is refused.
    browser.turned(desk, "lens.focus", json!(3));
    assert_eq!(browser.turn(desk, "lens.f-number", json!("f/4")).status, 400);
    let said = browser.turned(desk, "picture", json!("2: lens.f-number = f/2, film.push = 1"));
    assert_eq!((value_of(&said, "lens.f-number"), value_of(&said, "lens.focus")), (json!("f/2"), json!(3.0)));
    let command = browser.get(&format!("/command?desk={desk}")).expect("an answer").json();
    let command = command["command"].as_str().expect("a command").to_owned();
    let end = "swept.yaml --set 'lens.focus=3 m' --set sweep=null --set lens.f-number=f/2 --set film.push=1";
    assert!(command.starts_with("spectra run ") && command.ends_with(end), "{command}");
}

/// A truncated picture file is noticed only when light is needed; the scene then goes back to the picture that it had.
#[test]
fn what_turns_out_to_have_no_picture_is_taken_back() {
    let scene = "spectra: 1\nsource: {kind: picture, distance: 2 m, luminance: 300 cd/m2, width: fill}\n\
        lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\nimager: {kind: film, format: 135, resolution: [60, 40]}\n\
        film: {stock: kodak-tri-x-400, exposure: 1/80 s}\nrender: {samples: 4}\nsweep: {source.file: [good.png, cut.png]}\n";
    let png = photograph();
    let browser = Browser::start_with("good.png", &png);
    let folder = browser.file.parent().expect("a folder");
    std::fs::write(folder.join("cut.png"), &png[..png.len() / 2]).expect("written");
    std::fs::write(folder.join("scene.yaml"), scene).expect("written");
    let browser = browser.entered();
    let desk =
        browser.post("/open", r#"{"name": "scene.yaml", "bundled": false}"#).json()["desk"].as_u64().expect("a desk");
    let (head, first) = browser.frame(desk, 0, |head| is_done(head) && head["draft"] == false);
    assert_eq!(browser.turn(desk, "source.file", json!("cut.png")).status, 200);
    let at = head["frame"].as_u64().expect("a number");
    let (head, _) = browser.frame(desk, at, |head| head["fault"]["path"] == "source.file");
    let why = head["fault"]["faults"][0]["message"].as_str().expect("a message");
    assert!(why.contains("cut.png"), "{why}");
    let said = browser.controls(desk, 0);
    assert_eq!((value_of(&said, "source.file"), &said["undos"]), (json!("good.png"), &json!(0)));
    assert!(said["refused"]["source.file"].is_object(), "{}", said["refused"]);
    // The page works on from there.
    browser.turned(desk, "lens.f-number", json!(4));
    browser.turned(desk, "lens.f-number", json!(2));
    let (_, again) =
        browser.frame(desk, head["frame"].as_u64().expect("a number"), |head| is_done(head) && head["draft"] == false);
    assert!(again.len() == first.len());
}

/// Returns the file of a small photograph.
fn photograph() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let color = |x: u32, y: u32| image::Rgb([(x * 4) as u8, (y * 5) as u8, ((x + y) * 2) as u8]);
    image::RgbImage::from_fn(60, 40, color).write_to(&mut png, image::ImageFormat::Png).expect("a picture");
    png.into_inner()
}

#[test]
fn steps_are_taken_back_and_what_is_seen_is_a_scene_of_its_own() {
    let browser = Browser::let_in();
    let desk = browser.open();
    let (_, first) = browser.frame(desk, 0, is_done);
    let said = browser.turned(desk, "lens.f-number", json!(8));
    assert_eq!(said["undos"], 1);
    let said = browser.turned(desk, "film.push", json!(1));
    assert_eq!((&said["undos"], &said["changes"]), (&json!(2), &json!(2)));
    let got = browser.get(&format!("/scene?desk={desk}")).expect("an answer");
    assert_eq!(String::from_utf8_lossy(&got.body), SCENE.replace("f/2", "f/8").replace("1/80 s", "1/80 s, push: 1"));
    for (left, stop, push) in [(1, json!(8.0), Value::Null), (0, json!(2.0), Value::Null)] {
        let turn = browser.post(&format!("/back?desk={desk}"), "").json()["turn"].as_u64().expect("a number");
        let said = browser.controls(desk, turn);
        assert_eq!((&said["undos"], &said["changes"]), (&json!(left), &json!(left)));
        assert_eq!((value_of(&said, "lens.f-number"), value_of(&said, "film.push")), (stop, push));
        browser.frame(desk, 0, |head| is_done(head) && head["turns"] == turn && head["draft"] == false);
    }
    let (_, again) = browser.frame(desk, 0, |head| is_done(head) && head["draft"] == false);
    assert!(again == first);
    // A scene from the list can be opened, and nothing else.
    assert_eq!(browser.post("/open", r#"{"name": "../scene.yaml", "bundled": false}"#).status, 400);
    let listed = browser.get("/openable").expect("an answer").json();
    assert_eq!(listed["files"], json!(["scene.yaml"]));
    let other =
        browser.post("/open", r#"{"name": "gray-card", "bundled": true}"#).json()["desk"].as_u64().expect("a desk");
    browser.frame(other, 0, |head| head["width"].is_u64());
    assert_eq!(browser.controls(other, 0)["name"], "gray-card");
}

/// A photograph is developed with the same bits as by `film develop`, and through a lens once one is chosen.
#[test]
fn a_photograph_is_developed() {
    let browser = Browser::viewing("photo.png", &photograph());
    let desk = browser.open();
    let (head, light) = browser.frame(desk, 0, is_done);
    assert_eq!((&head["width"], &head["flat"], &head["rays"]), (&json!(60), &json!(true), &json!(0)));
    let said = browser.controls(desk, 0);
    assert_eq!((&said["photograph"], &said["widths"], &said["saves"]), (&json!(true), &json!([60]), &json!(false)));
    assert!(said["controls"].as_array().expect("a list").iter().all(|control| control["path"] != "lens.f-number"));
    let wanted = |stock: &str, light: &str| {
        let setting = |path: &str, value: &str| spectra_darkroom::Setting {
            path: path.to_owned(),
            value: value.to_owned(),
            as_typed: String::new(),
        };
        let file = browser.file.to_string_lossy().into_owned();
        let photograph = spectra_darkroom::Photograph {
            plate: spectra_darkroom::PictureJob { file, output: "photo.png".to_owned(), number: None },
            settings: vec![setting("film.stock", stock), setting("source.illuminant", light)],
            format: None,
        };
        let series = photograph.series(&[]).expect("a scene");
        let session =
            spectra_session::Session::new(series, spectra_session::SessionOptions::default()).expect("a scene");
        let exposure = session.expose().expect("light").exposure;
        let times = session.scene().film_times(&exposure);
        let shot = spectra_scene::Shot::new(session.scene(), &exposure, &times, &[], Isa::detect());
        as_sent(&shot.pictures().expect("a picture")[0].1.rgb.concat())
    };
    assert!(light == wanted("kodak-portra-400", "iso-7589-sensitometric-daylight"));
    // A film for tungsten light gets the light for which it is made.
    let at = head["frame"].as_u64().expect("a number");
    let said = browser.turned(desk, "film.stock", json!("kodak-vision3-500t-5219"));
    let own = value_of(&said, "source.illuminant");
    let (_, light) = browser.frame(desk, at, is_done);
    assert!(light == wanted("kodak-vision3-500t-5219", own.as_str().expect("a name")), "{own}");
    let command = |ending: &str| {
        let command = browser.get(&format!("/command?desk={desk}")).expect("an answer").json();
        let command = command["command"].as_str().expect("a command").to_owned();
        assert!(command.starts_with("spectra film develop ") && command.ends_with(ending), "{command}");
    };
    command("photo.png --stock kodak-vision3-500t-5219");
    let said = browser.turned(desk, "lens.file", json!("helios-44-58-f2"));
    assert_eq!(value_of(&said, "lens.file"), "helios-44-58-f2");
    let (seen, _) = browser.frame(desk, at, |head| head["rays"].as_u64().is_some_and(|rays| rays > 0));
    assert!(seen["lens"].as_str().is_some_and(|name| name.contains("Helios")), "{seen}");
    browser.turned(desk, "lens.f-number", json!(5.6));
    command("--lens=helios-44-58-f2 --f-number=f/5.6");
    // Without the lens again, the pixels are as before.
    browser.turned(desk, "lens.file", json!("no-lens"));
    let (_, again) = browser.frame(desk, seen["frame"].as_u64().expect("a number"), |head| head["flat"] == true);
    assert!(again == light);
    command("photo.png --stock kodak-vision3-500t-5219");
    let text = browser.get(&format!("/scene?desk={desk}")).expect("an answer");
    assert!(String::from_utf8_lossy(&text.body).contains("kodak-vision3-500t-5219"));
}

#[test]
fn a_file_that_is_saved_is_rendered_again_and_a_broken_one_is_told() {
    let browser = Browser::let_in();
    let desk = browser.open();
    let (head, first) = browser.frame(desk, 0, is_done);
    let at = |head: &Value| head["frame"].as_u64().expect("a number");
    // Values of the page stay, except those that the file itself has changed.
    assert_eq!(browser.turn(desk, "film.push", json!(1)).status, 200);
    assert_eq!(browser.turn(desk, "lens.f-number", json!(8)).status, 200);
    let (head, _) = browser.frame(desk, at(&head), |head| is_done(head) && head["draft"] == false);
    std::fs::write(&browser.file, SCENE.replace("f/2", "f/4")).expect("written");
    let (again, light) = browser.frame(desk, at(&head), |head| is_done(head) && head["reread"] == 1);
    assert!(light != first);
    let controls = browser.get(&format!("/controls?desk={desk}")).expect("an answer").json();
    let value = |path: &str| {
        let all = controls["controls"].as_array().expect("a list");
        all.iter().find(|control| control["path"] == path).expect("a control")["value"].clone()
    };
    assert_eq!((value("lens.f-number"), value("film.push")), (json!(4.0), json!(1.0)));

    // A broken file is reported with the place, and the picture stays.
    std::fs::write(&browser.file, SCENE.replace("f/2", "f/2, fnumber: 3")).expect("written");
    let (broken, _) = browser.frame(desk, at(&again), |head| head["fault"].is_object());
    let fault = &broken["fault"]["faults"][0];
    assert!(fault["message"].as_str().is_some_and(|m| m.contains("fnumber")), "{fault}");
    assert!(fault["place"].as_str().is_some_and(|p| p.contains(":3:")), "{fault}");
    assert!(broken["width"].is_null());
    std::fs::write(&browser.file, SCENE).expect("written");
    browser.frame(desk, at(&broken), |head| is_done(head) && head["reread"] == 2 && head["fault"].is_null());
}

#[test]
fn pages_do_not_disturb_each_other_and_the_oldest_makes_room() {
    let browser = Browser::let_in();
    let (one, two) = (browser.open(), browser.open());
    assert_eq!(browser.turn(two, "lens.f-number", json!(8)).status, 404 - 4, "no control before the scene is there");
    let (_, first) = browser.frame(one, 0, is_done);
    let (before, _) = browser.frame(two, 0, is_done);
    assert_eq!(browser.turn(two, "lens.f-number", json!(8)).status, 200);
    let (_, second) = browser.frame(two, before["frame"].as_u64().expect("a number"), is_done);
    assert!(first != second);
    let again = browser.get(&format!("/frame?desk={one}&after=0")).expect("an answer");
    assert!(again.body.ends_with(&first.iter().flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect::<Vec<u8>>()));
    for _ in 0..3 {
        browser.open();
    }
    assert_eq!(browser.get(&format!("/controls?desk={one}")).expect("an answer").status, 404);
    assert_eq!(browser.get(&format!("/controls?desk={two}")).expect("an answer").status, 200);
}

/// The page is answered although 150 connections send nothing, or half a request, and reconnect when they are closed.
#[test]
fn whoever_asks_nothing_makes_room() {
    let browser = Browser::start().entered();
    let is_over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        for i in 0..150 {
            let (host, is_over) = (&browser.host, &is_over);
            scope.spawn(move || {
                while !is_over.load(std::sync::atomic::Ordering::SeqCst) {
                    let Ok(mut stream) = TcpStream::connect(host) else { continue };
                    let _ = stream.write_all(if i % 2 == 0 { b"" } else { b"GET /page.css HT" });
                    let _ = stream.set_read_timeout(Some(Duration::from_millis(200)));
                    let _ = stream.read(&mut [0]);
                }
            });
        }
        std::thread::sleep(Duration::from_millis(300));
        let answers = (0..40).filter_map(|_| browser.get("/page.css")).filter(|got| got.status == 200).count();
        is_over.store(true, std::sync::atomic::Ordering::SeqCst);
        assert!(answers >= 38, "{answers} of 40");
    });
}

/// Each of these requests is refused or dropped, and the server answers the next one.
#[test]
fn what_others_try_is_refused() {
    let browser = Browser::start();
    let (host, token) = (browser.host.clone(), browser.token.clone());
    let port = host.rsplit(':').next().expect("a port").to_owned();
    let field = |name: &str, value: &str| format!("{name}: {value}\r\n");
    let own = field("Host", &host);
    let get = |path: &str, fields: &str| format!("GET {path} HTTP/1.1\r\n{fields}\r\n").into_bytes();
    // Requests before the address was opened.
    let mut tries: Vec<(String, Vec<u8>, &[u16])> = Vec::new();
    for path in [
        "/",
        "/page.js",
        "/controls?desk=1",
        "/frame?desk=1&after=0",
        "/?token=",
        "/?token=00000000000000000000000000000000",
    ] {
        tries.push((format!("without a token: {path}"), get(path, &own), &[403]));
    }
    tries.push(("token in upper case".into(), get(&format!("/?token={}x", token.to_uppercase()), &own), &[403]));
    tries.push(("token elsewhere".into(), get(&format!("/page.js?token={token}"), &own), &[403]));
    tries.push(("token by post".into(), format!("POST /?token={token} HTTP/1.1\r\n{own}\r\n").into_bytes(), &[403]));
    for name in [
        "evil.example",
        "localhost",
        &format!("localhost:{port}"),
        "127.0.0.1",
        &format!("127.0.0.2:{port}"),
        &format!("{host}.evil.example"),
        "",
    ] {
        tries.push((format!("host {name}"), get(&format!("/?token={token}"), &field("Host", name)), &[403]));
    }
    tries.push(("no host".into(), get(&format!("/?token={token}"), ""), &[403]));
    tries.push(("two hosts".into(), get(&format!("/?token={token}"), &format!("{own}{own}")), &[400]));
    for (name, bytes, wanted) in &tries {
        let got = raw(&host, bytes).unwrap_or_else(|| panic!("{name}: no answer"));
        assert!(wanted.contains(&got.status), "{name}: {}", got.head);
    }
    let mut count = tries.len();

    let mut browser = browser;
    let got = browser.get(&format!("/?token={token}")).expect("an answer");
    browser.cookie = got
        .head
        .lines()
        .find_map(|l| l.strip_prefix("Set-Cookie: "))
        .expect("a cookie")
        .split(';')
        .next()
        .expect("one")
        .to_owned();
    let desk = browser.open();
    browser.frame(desk, 0, |head| head["width"].is_u64());
    let cookie = field("Cookie", &browser.cookie);
    let mut tries: Vec<(String, Vec<u8>, &[u16])> = Vec::new();
    tries.push(("the token a second time".into(), get(&format!("/?token={token}"), &own), &[403]));
    let wrong = browser.cookie.replace(|c: char| c.is_ascii_hexdigit(), "0");
    tries.push(("a wrong cookie".into(), get("/", &format!("{own}{}", field("Cookie", &wrong))), &[403]));
    for origin in [
        "http://evil.example",
        "null",
        "https://127.0.0.1",
        &format!("https://{host}"),
        &format!("http://localhost:{port}"),
        &format!("http://{host}.evil.example"),
    ] {
        let fields = format!("{own}{cookie}{}", field("Origin", origin));
        tries.push((format!("get from {origin}"), get("/", &fields), &[403]));
        tries.push((
            format!("post from {origin}"),
            format!("POST /open HTTP/1.1\r\n{fields}\r\n").into_bytes(),
            &[403],
        ));
    }
    tries.push((
        "post without an origin".into(),
        format!("POST /open HTTP/1.1\r\n{own}{cookie}\r\n").into_bytes(),
        &[403],
    ));
    for site in ["cross-site", "same-site"] {
        tries.push((site.into(), get("/", &format!("{own}{cookie}{}", field("Sec-Fetch-Site", site))), &[403]));
    }
    for method in ["PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "HEAD"] {
        tries.push((method.into(), format!("{method} / HTTP/1.1\r\n{own}{cookie}\r\n").into_bytes(), &[405]));
    }
    for path in [
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/..\\..\\etc\\passwd",
        "/page/../page.js",
        "/page.js/",
        "/.git/config",
        "/scene.yaml",
        "*",
        "http://evil.example/",
    ] {
        tries.push((format!("path {path}"), get(path, &format!("{own}{cookie}")), &[404, 400, 403]));
    }
    let post = format!("{own}{cookie}{}", field("Origin", &format!("http://{host}")));
    let body = |text: &str| {
        format!("POST /turn?desk={desk} HTTP/1.1\r\n{post}Content-Length: {}\r\n\r\n{text}", text.len()).into_bytes()
    };
    for text in [
        "",
        "{",
        "[]",
        "null",
        "{\"path\": 1}",
        "{\"path\": \"lens.file\"}",
        "{\"path\": \"lens.file\", \"value\": \"../../etc/passwd\"}",
        "{\"path\": \"lens.file\", \"value\": \"/etc/passwd\"}",
        "{\"path\": \"lens.file\", \"value\": \"scene.yaml\"}",
        "{\"path\": \"film.stock\", \"value\": \"a\\\\b\"}",
        "{\"path\": \"include\", \"value\": \"/etc/passwd\"}",
        "{\"path\": \"output\", \"value\": \"png\"}",
        "{\"path\": \"imager.resolution\", \"value\": 100000}",
        "{\"path\": \"width\", \"value\": 100000}",
        "{\"path\": \"width\", \"value\": -1}",
        "{\"path\": \"lens.f-number\", \"value\": \"2]\"}",
        "{\"path\": \"lens.f-number\", \"value\": 1e999}",
        "{\"path\": \"render.samples\", \"value\": 1e18}",
    ] {
        tries.push((format!("turn {text}"), body(text), &[400]));
    }
    tries.push((
        "a body of a gigabyte".into(),
        format!("POST /open HTTP/1.1\r\n{post}Content-Length: 1073741824\r\n\r\n").into_bytes(),
        &[413],
    ));
    tries.push((
        "a length that is none".into(),
        format!("POST /open HTTP/1.1\r\n{post}Content-Length: -1\r\n\r\n").into_bytes(),
        &[400],
    ));
    tries.push((
        "two lengths".into(),
        format!("POST /open HTTP/1.1\r\n{post}Content-Length: 0\r\nContent-Length: 5\r\n\r\n").into_bytes(),
        &[400],
    ));
    tries.push((
        "chunks".into(),
        format!("POST /open HTTP/1.1\r\n{post}Transfer-Encoding: chunked\r\n\r\n").into_bytes(),
        &[501],
    ));
    tries.push(("no HTTP".into(), b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03".to_vec(), &[400]));
    tries.push(("words".into(), b"hello\r\n\r\n".to_vec(), &[400]));
    tries.push(("a long head".into(), get("/", &field("X", &"y".repeat(1 << 20))), &[431]));
    tries.push(("many fields".into(), get("/", &field("X", "y").repeat(500)), &[431]));
    tries.push(("an endless path".into(), get(&format!("/{}", "a".repeat(100_000)), &own), &[431]));
    tries.push(("a desk that is none".into(), get("/frame?desk=99&after=0", &format!("{own}{cookie}")), &[404]));
    tries.push(("a desk without a number".into(), get("/frame?desk=../1&after=0", &format!("{own}{cookie}")), &[400]));
    tries.push((
        "a frame far away".into(),
        get("/frame?desk=1&after=99999999999999999999999", &format!("{own}{cookie}")),
        &[400],
    ));
    for (name, bytes, wanted) in &tries {
        // If the server closes the connection while it is still being written to, its answer may be lost.
        let Some(got) = raw(&host, bytes) else {
            assert!(bytes.len() > 60_000, "{name}: no answer");
            continue;
        };
        assert!(wanted.contains(&got.status), "{name}: {}", got.head);
    }
    count += tries.len();
    assert!(count >= 60, "{count} tries");

    // The number of silent connections is limited; they are dropped after a few seconds, and the page is answered after that.
    let idle: Vec<Option<TcpStream>> = (0..1000).map(|_| TcpStream::connect(&host).ok()).collect();
    let end = Instant::now() + Duration::from_secs(30);
    let answered = || browser.get("/page.css").is_some_and(|got| got.status == 200);
    while !answered() {
        assert!(Instant::now() < end, "the server does not answer any more");
        std::thread::sleep(Duration::from_millis(200));
    }
    drop(idle);
    browser.frame(desk, 0, |head| head["width"].is_u64());
    println!("{count} tries refused");
}
