//! Tests sessions: the bits of a picture after changes, and what is computed again.

use spectra_core::params::{Faults, Params};
use spectra_core::resources::{FoundFile, Resource, ResourceError, Resources};
use spectra_core::sink::Memory;
use spectra_plugins as _;
use spectra_render::{Light, RenderOptions, Renderer, Traced};
use spectra_scene::{Direction, FileResources, series_of_text};
use spectra_session::{Control, Effort, Session, SessionError, SessionOptions, SingleThread, Threads, Workers};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Small pictures that each cover another case: a film with a meter, colors, an imager by itself, forward light.
const SCENES: [(&str, &[&str]); 3] = [
    ("biotar-ortho", &["imager.resolution=[24, 16]"]),
    ("gray-card", &["imager.resolution=[24, 16]"]),
    ("gray-card", &["imager.resolution=[24, 16]", "render.direction=forward"]),
];

fn session(scene: &str, set: &[&str]) -> Session {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{scene}.yaml"));
    let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    Session::open(&path, &set, SessionOptions::default()).unwrap_or_else(|error| panic!("{scene}: {error}"))
}

/// Opens a draft of the same picture with another value.
fn draft(whole: &Session, text: &str) -> Session {
    let options = SessionOptions { effort: Effort::Draft, ..whole.options() };
    whole.branch(&[text.to_owned()], options).expect("the same scene")
}

/// Returns the bits of the exposure, channel after channel.
fn bits(session: &mut Session) -> Vec<u32> {
    let exposure = session.rendering().expect("there is memory").exposure;
    exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
}

/// Returns the bits of the pictures.
fn picture(session: &mut Session) -> Vec<u32> {
    let all = session.develop().expect("a picture");
    all.iter().flat_map(|(_, p)| p.rgb.as_flattened().iter().map(|v| v.to_bits())).collect()
}

fn go(session: &mut Session, samples: u64) {
    session.advance(samples, &Threads(2), &Control::new()).expect("rendered");
}

/// The picture after several steps equals that of one run with the same number of samples.
#[test]
fn steps_are_a_run_of_their_sum() {
    for (scene, set) in SCENES {
        let mut stepped = session(scene, set);
        for samples in [1, 6, 32, 25] {
            stepped.step(samples, &Threads(2), &Control::new()).expect("rendered");
        }
        let all = [set, &["render.samples=64"]].concat();
        let mut whole = session(scene, &all);
        go(&mut whole, 64);
        assert_eq!(bits(&mut stepped), bits(&mut whole), "{scene} {set:?}");
        assert_eq!(stepped.samples(), 64);
    }
}

/// A picture that is clean before its last sample is complete, so that nobody waits for the samples that it does not need.
#[test]
fn a_clean_picture_is_complete() {
    let mut session = session("gray-card", &["imager.resolution=[16, 16]", "render.noise=30 %", "render.samples=4096"]);
    assert!(!session.is_complete() && session.samples_in_all() == 4096);
    go(&mut session, 4096);
    assert!(session.is_complete() && session.samples() < 4096, "{} samples", session.samples());
    assert_eq!(session.samples_in_all(), session.samples());
}

#[test]
fn numbers_that_do_not_extend_refuse_to_step() {
    let mut session =
        session("gray-card", &["imager.resolution=[8, 8]", "render.numbers=stratified", "render.samples=16"]);
    let error = session.step(4, &SingleThread, &Control::new()).expect_err("strata are laid out for 16").to_string();
    assert!(error.contains("stratified"), "{error}");
    go(&mut session, 16);
}

/// Light that is stopped in the middle of the work, saved, loaded by another session and finished has the bits of one run.
#[test]
fn light_is_saved_and_taken_up() {
    for (scene, set) in SCENES {
        let set = [set, &["render.samples=96"]].concat();
        let mut whole = session(scene, &set);
        go(&mut whole, 96);
        let mut first = session(scene, &set);
        let third = whole.rendering().expect("a picture").rays / 3;
        stopped(&mut first, 96, third);
        let mut file = Vec::new();
        first.save(&mut file).expect("saved");
        let mut second = session(scene, &set);
        second.load(&mut file.as_slice()).expect("taken up");
        assert_eq!(bits(&mut first), bits(&mut second), "{scene}: the loaded light differs");
        go(&mut second, 96);
        assert_eq!(bits(&mut second), bits(&mut whole), "{scene} {set:?}");
        // Damaged light, or light of another scene, is refused and changes nothing.
        let last = file.len() - 20;
        file[last] ^= 1;
        assert!(matches!(second.load(&mut file.as_slice()), Err(SessionError::Light(_))));
        let mut other = session(scene, &[&set[..], &["render.seed=5"]].concat());
        assert!(other.load(&mut file.as_slice()).is_err());
        assert_eq!(bits(&mut second), bits(&mut whole));
        // A surface number that the lens does not have is rejected before memory is allocated for all surfaces up to it.
        file[last] ^= 1;
        let magic = b"spectra light 7\n";
        let state = file.windows(16).position(|w| w == magic).expect("light") + 16 + 8;
        if file[state - 8..state] != [0; 8] {
            file[state + 3] = 0xf0;
            let error = second.load(&mut file.as_slice()).expect_err("no such surface").to_string();
            assert!(error.contains("belongs to another scene"), "{error}");
        }
    }
}

/// Renders until about this many rays are traced.
fn stopped(session: &mut Session, samples: u64, rays: u64) {
    let control = Control::stopping_after(rays);
    session.advance(samples, &Threads(2), &control).expect("stopped");
    assert!(control.is_stopped());
}

/// Two estimators of unequal work in one scene add up to one picture, whenever they were stopped.
#[test]
fn estimators_of_one_scene_add() {
    let session = session("gray-card", &["imager.resolution=[16, 12]", "render.samples=64", "render.rays=300000"]);
    let both = [Direction::Forward, Direction::Backward];
    let renderer = |which: &[Direction]| {
        Renderer::new(
            Arc::clone(session.scene()),
            &RenderOptions { traced: Traced::Directions(which.to_vec()), ..RenderOptions::default() },
        )
        .expect("ready")
    };
    let look = |renderer: &Renderer, light: &Light| -> Vec<f32> {
        let exposure = renderer.rendering(session.scene(), light).expect("memory").exposure;
        exposure.channels.iter().flat_map(|c| c.values.clone()).collect()
    };
    let whole = renderer(&both);
    let mut light = whole.begin().expect("memory");
    whole.advance(&mut light, 64, &Threads(2), &Control::new()).expect("rendered");
    // Stops before the second estimator begins, within it, and elsewhere.
    for rays in [1, 250_000, 301_000, 305_000] {
        let mut part = whole.begin().expect("memory");
        let control = Control::new();
        struct Until<'a>(&'a Control, u64);
        impl Workers for Until<'_> {
            fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
                std::thread::scope(|scope| {
                    let worker = scope.spawn(work);
                    while self.0.rays() < self.1 && !worker.is_finished() {
                        std::hint::spin_loop();
                    }
                    if self.0.rays() >= self.1 {
                        self.0.stop();
                    }
                });
            }
        }
        whole.advance(&mut part, 64, &Until(&control, rays), &control).expect("stopped");
        let mut file = Vec::new();
        part.save(&mut file).expect("saved");
        let again = renderer(&both);
        let mut part = Light::load(&again, &mut file.as_slice()).expect("taken up");
        again.advance(&mut part, 64, &SingleThread, &Control::new()).expect("ended");
        assert_eq!(look(&again, &part), look(&whole, &light), "{rays}");
    }
    // Each estimator gives the whole picture, so both together give twice the light: their sums add.
    let sum = |which: &[Direction]| {
        let one = renderer(which);
        let mut light = one.begin().expect("memory");
        one.advance(&mut light, 64, &Threads(2), &Control::new()).expect("rendered");
        look(&one, &light).iter().map(|v| f64::from(*v)).sum::<f64>()
    };
    let both = look(&whole, &light).iter().map(|v| f64::from(*v)).sum::<f64>();
    let apart = sum(&[Direction::Forward]) + sum(&[Direction::Backward]);
    assert!((both / apart - 1.0).abs() < 1e-6, "{both} {apart}");
}

/// A change that only affects development traces no ray, and gives the picture of a fresh run.
#[test]
fn development_traces_no_ray() {
    for (scene, set, changes) in [
        (
            "biotar-ortho",
            &["imager.resolution=[48, 32]", "render.samples=8"][..],
            &["film.exposure=1/250 s", "film.grain=false", "film.scatter=false", "film.paper={range: 1.0}"][..],
        ),
        (
            "biotar-trix",
            &["imager.resolution=[48, 32]", "render.samples=8"],
            &[
                "film.push=1",
                "film.halation={entering: 0.5, transmittance: 0.2, thickness: 130 um, index: 1.5}",
                "film.view=scan",
            ],
        ),
        (
            "biotar-color-negative",
            &["imager.resolution=[48, 32]", "render.samples=8"],
            &["film.compensation=1", "film.light=D65"],
        ),
    ] {
        let mut changed = session(scene, set);
        go(&mut changed, 8);
        let rays = changed.rendering().expect("memory").rays;
        let mut all = set.to_vec();
        for change in changes {
            let kept = match changed.change(change) {
                Ok(kept) => kept,
                Err(error) => panic!("{scene} {change}: {error}"),
            };
            assert!(kept.light && kept.density && kept.lens && kept.source, "{scene} {change}: {kept:?}");
            all.push(change);
            assert_eq!(changed.rendering().expect("memory").rays, rays);
            let mut fresh = session(scene, &all);
            go(&mut fresh, 8);
            assert_eq!(bits(&mut changed), bits(&mut fresh), "{scene} {change}");
            assert_eq!(picture(&mut changed), picture(&mut fresh), "{scene} {change}");
        }
    }
}

/// Resources that count how often a file is read from disk.
struct Counting(FileResources, Arc<AtomicUsize>);

impl Resources for Counting {
    fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit: u64) -> Result<Resource, ResourceError> {
        self.1.fetch_add(1, Relaxed);
        self.0.read(path, folders, endings, limit)
    }
    fn find(&self, path: &str, folders: &[&str], endings: &[&str], limit: u64) -> Result<FoundFile, ResourceError> {
        self.1.fetch_add(1, Relaxed);
        self.0.find(path, folders, endings, limit)
    }
    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults> {
        self.1.fetch_add(1, Relaxed);
        self.0.document(path, folders, endings)
    }
}

/// Another stop causes new focusing and tracing, and nothing else; another stock causes a new wavelength density.
#[test]
fn a_change_makes_again_what_rests_on_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("scenes/biotar-ortho.yaml")).expect("there");
    // A source that fills the frame depends on the lens; this one does not.
    let small = ["imager.resolution=[24, 16]", "render.samples=8", "source.width=1.5 m"];
    let reads = Arc::new(AtomicUsize::new(0));
    let files = Arc::new(Counting(FileResources::beside(&root.join("scenes")), Arc::clone(&reads)));
    let series = series_of_text("biotar-ortho.yaml", &text, &[], files).expect("a scene");
    let mut changed = Session::new(series, SessionOptions::default()).expect("a scene");
    for set in small {
        changed.change(set).expect("set");
    }
    go(&mut changed, 8);
    let before = reads.load(Relaxed);
    let density = |session: &Session| Arc::clone(session.density().expect("ready"));
    let old = density(&changed);
    let kept = changed.change("lens.f-number=f/8").expect("a stop");
    assert!(!kept.light && kept.density && !kept.lens && kept.source, "{kept:?}");
    assert!(Arc::ptr_eq(&old, &density(&changed)), "the density was computed again");
    assert_eq!(reads.load(Relaxed), before, "a file was read for another stop");
    go(&mut changed, 8);
    let mut fresh = session("biotar-ortho", &[&small[..], &["lens.f-number=f/8"]].concat());
    go(&mut fresh, 8);
    assert_eq!(bits(&mut changed), bits(&mut fresh));
    let kept = changed.change("film.stock=kodak-tri-x-400").expect("a stock");
    assert!(!kept.light && !kept.density && kept.source, "{kept:?}");
    go(&mut changed, 8);
    let mut fresh =
        session("biotar-ortho", &[&small[..], &["lens.f-number=f/8", "film.stock=kodak-tri-x-400"]].concat());
    go(&mut fresh, 8);
    assert_eq!(bits(&mut changed), bits(&mut fresh));
    // A faulty change leaves everything as it was.
    assert!(changed.change("lens.f-number=f/0.1").is_err() && changed.change("film.stock=none-such").is_err());
    assert_eq!(bits(&mut changed), bits(&mut fresh));
}

/// A session works on one thread, without disk or clock: its files are in memory and have the same bits.
#[test]
fn it_works_without_threads_and_disk() {
    let text = "spectra: 1\nsource: {kind: chart, chart: gray-card, distance: 2 m, width: 3 m, illuminant: D65, luminance: 300 cd/m2}\n\
                lens: {file: zeiss-biotar-50-f1.4, focus: 2 m, f-number: f/4}\n\
                imager: {kind: film, format: '135', resolution: [24, 16]}\n\
                film: {stock: kodak-tri-x-400, exposure: 1/125 s}\nrender: {samples: 4}\noutput: [exr, png, tiff]\n";
    /// Resources that contain only bundled files.
    struct Bundled;
    impl Resources for Bundled {
        fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit: u64) -> Result<Resource, ResourceError> {
            FileResources::beside(Path::new("/nowhere/at/all")).read(path, folders, endings, limit)
        }
        fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults> {
            FileResources::beside(Path::new("/nowhere/at/all")).document(path, folders, endings)
        }
    }
    let made = |workers: &dyn Workers| {
        let series =
            series_of_text("card.yaml", text, &[], Arc::new(Bundled)).unwrap_or_else(|error| panic!("{error}"));
        let mut session = Session::new(series, SessionOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        session.advance(4, workers, &Control::new()).expect("rendered");
        let memory = Memory::default();
        session.write(&memory).expect("written");
        memory.into_files()
    };
    let (alone, threads) = (made(&SingleThread), made(&Threads(3)));
    let mut names: Vec<&str> = alone.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["card.exr", "card.png", "card.tiff"]);
    for (name, bytes) in &alone {
        let other = threads.iter().find(|(other, _)| other == name).expect("the same files");
        assert!(*bytes == other.1, "{name}");
    }
}

/// Workers that were asked to stop.
struct Stopped;

impl Workers for Stopped {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
    fn should_stop(&self) -> bool {
        true
    }
}

/// Stopped down so far that a corner of the frame sees nothing through the paraxial pupil, the view of the frame is searched as
/// closely as for a picture. The given workers do the search with the same result on any number of threads. Workers that stop do not
/// search, and a draft uses less effort.
#[test]
fn what_a_frame_sees_is_searched_by_those_who_are_asked() {
    /// Workers that count how often they are called.
    struct Counting(AtomicUsize);
    impl Workers for Counting {
        fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
            self.0.fetch_add(1, Relaxed);
            Threads(3).run_on_all(work);
        }
    }
    let small = ["imager.resolution=[24, 16]", "render.samples=4"];
    let f15 = "lens.f-number=f/15";
    let mut whole = session("biotar-ortho", &small);
    go(&mut whole, 4);
    let before = bits(&mut whole);
    let draft = draft(&whole, "imager.resolution=[12, 8]");
    assert!(whole.change_unprepared(&[f15], 0, Some(&draft), &Stopped).is_err());
    assert_eq!(bits(&mut whole), before, "the refused change had an effect");
    let counting = Counting(AtomicUsize::new(0));
    whole.change_unprepared(&[f15], 0, Some(&draft), &counting).expect("it stops down");
    assert!(counting.0.load(Relaxed) > 0, "the given workers did no search");
    go(&mut whole, 4);
    let mut fresh = session("biotar-ortho", &[&small[..], &[f15]].concat());
    go(&mut fresh, 4);
    assert_eq!(bits(&mut whole), bits(&mut fresh));
}

/// A change can be prepared later, when light is requested, and preparation can be stopped. The bits are then those of one run.
#[test]
fn a_change_can_be_made_ready_later() {
    let small = ["imager.resolution=[24, 16]", "render.samples=4"];
    let mut later = session("biotar-ortho", &small);
    go(&mut later, 4);
    let kept = later.change_unprepared(&["lens.f-number=f/8"], 0, None, &SingleThread).expect("it stops down");
    assert!(!kept.light && kept.density && !kept.lens, "{kept:?}");
    // A second change before the first was prepared.
    later.change_unprepared(&["imager.tilt=[3 deg, 0 deg]"], 0, None, &SingleThread).expect("it tilts");
    later.advance(4, &Stopped, &Control::new()).expect("nobody waits for it");
    assert_eq!((later.samples(), later.has_light()), (0, false));
    go(&mut later, 4);
    let mut whole =
        session("biotar-ortho", &[&small[..], &["lens.f-number=f/8", "imager.tilt=[3 deg, 0 deg]"]].concat());
    go(&mut whole, 4);
    assert_eq!(bits(&mut later), bits(&mut whole));
    // A change that only affects development keeps the light.
    assert!(later.change_unprepared(&["film.grain=false"], 0, None, &SingleThread).expect("it has no grain").light);
    assert_eq!(bits(&mut later), bits(&mut whole));
}

/// A lens that a draft has focused is not focused again, and tilting the frame keeps the focus. The picture equals that of one run.
#[test]
fn a_lens_is_focused_once() {
    let small = ["imager.resolution=[24, 16]", "render.samples=4"];
    let mut whole = session("biotar-ortho", &small);
    go(&mut whole, 4);
    let mut draft = draft(&whole, "imager.resolution=[12, 8]");
    let before = Arc::clone(&whole.scene().lens);
    for change in ["lens.focus=1.5 m", "imager.tilt=[3 deg, 0 deg]"] {
        draft.change(change).expect("it can be");
        whole.change_unprepared(&[change], 0, Some(&draft), &SingleThread).expect("it can be");
        assert!(Arc::ptr_eq(&whole.scene().lens, &draft.scene().lens), "{change}");
    }
    assert!(!Arc::ptr_eq(&whole.scene().lens, &before));
    let focused = Arc::clone(&whole.scene().lens);
    go(&mut whole, 4);
    let mut fresh =
        session("biotar-ortho", &[&small[..], &["lens.focus=1.5 m", "imager.tilt=[3 deg, 0 deg]"]].concat());
    go(&mut fresh, 4);
    assert_eq!(bits(&mut whole), bits(&mut fresh));
    // Another kind of light requires new focusing, whatever was drafted.
    whole.change_unprepared(&["film.stock=kodak-tri-x-400"], 0, Some(&draft), &SingleThread).expect("it can be");
    assert!(!Arc::ptr_eq(&whole.scene().lens, &focused));
}

/// A draft shows the same light with the same exposure, at less effort: its mean is known to 0.3 %.
#[test]
fn a_draft_is_as_bright_as_the_whole() {
    for set in [
        &[][..],
        &["lens.f-number=f/15"],
        &["imager.tilt=[10 deg, -5 deg]"],
        &["lens.aperture={shape: iris, blades: 5}"],
    ] {
        let mut whole = session("biotar-trix", &["imager.resolution=[48, 32]", "render.samples=64"]);
        let mut draft = draft(&whole, "render.samples=64");
        for text in set {
            draft.change(text).expect("it can be");
            whole.change(text).expect("it can be");
        }
        go(&mut whole, 64);
        go(&mut draft, 64);
        let mean = |session: &mut Session| {
            let exposure = session.rendering().expect("light").exposure;
            let time_s = session.scene().film_times(&exposure).first().expect("a film").time_s;
            let values = &exposure.channels[0].values;
            (values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64, time_s)
        };
        let ((a, a_s), (b, b_s)) = (mean(&mut whole), mean(&mut draft));
        assert!((b / a - 1.0).abs() < 0.01, "{set:?}: {a} and {b}");
        assert!((b_s / a_s - 1.0).abs() < 0.03, "{set:?}: {a_s} s and {b_s} s");
    }
}
