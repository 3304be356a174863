//! `spectra view`: shows a scene or a photograph in the browser.

use crate::arguments;
use crate::console;
use crate::film::called;
use crate::limits;
use crate::outcome::{Failure, Outcome};
use spectra_core::Isa;
use spectra_core::params::Fault;
use spectra_darkroom::{PICTURES, is_picture};
use spectra_view::ViewerSettings;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

/// Serves a scene, or the color tester, to a browser until the process ends.
pub(crate) fn view(arguments: &arguments::View, isa: Isa) -> Outcome {
    let ready = |address: &str| {
        // It is not an error if the reader of standard output has gone away.
        let _ = console::out(&format!("{address}\n"));
        if arguments.no_open {
            console::note("open this address in a browser; Ctrl-C ends the viewer");
        } else if open(address) {
            console::note("the page opens in your browser; Ctrl-C ends the viewer");
        } else {
            console::note("no browser could be started: open this address in one; Ctrl-C ends the viewer");
        }
    };
    let ended = match &arguments.scene {
        // The parser allows a missing scene only with --color-tester.
        None => spectra_view::color_tester(arguments.port, ready),
        Some(scene) => {
            let (stock, overrides) = film(arguments, scene)?;
            let view = ViewerSettings {
                scene: scene.clone(),
                stock,
                overrides,
                port: arguments.port,
                isa,
                threads: arguments.threads.map_or_else(limits::processors, usize::from),
            };
            spectra_view::view(view, ready)
        }
    };
    match ended {
        Ok(never) => match never {},
        Err(error) => Err(Failure::from(error)),
    }
}

/// Returns the film for a photograph, from `--stock` or `--set film.stock=...`, and the remaining `--set` values. The film decides which
/// light the photograph is taken to be in. For a scene the film is `None`.
fn film(arguments: &arguments::View, scene: &Path) -> Result<(Option<String>, Vec<String>), Failure> {
    let is_stock = |text: &String| text.split_once('=').is_some_and(|(path, _)| path.trim() == "film.stock");
    let all = &arguments.set.overrides;
    if !is_picture(scene) {
        if let Some(stock) = &arguments.stock {
            let fault = Fault::new("`--stock` is only for photographs, and this is a scene");
            return Err(fault.hint(format!("write `--set film.stock={stock}`")).into());
        }
        return if is_text(scene) { Ok((None, all.clone())) } else { Err(no_text(scene)) };
    }
    let set = all.iter().rev().find(|text| is_stock(text)).and_then(|text| text.split_once('='));
    let said = set.map(|(_, stock)| stock.trim().to_owned()).or_else(|| arguments.stock.clone());
    let stock = said.map(|name| called(&name)).transpose()?;
    Ok((stock, all.iter().filter(|text| !is_stock(text)).cloned().collect()))
}

/// Whether a file begins like text. An unreadable file counts as text: the scene reader reports the error.
fn is_text(file: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(file).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.is_err() || !head.iter().any(|byte| *byte < 8)
}

/// Returns the error for a file that is neither a scene nor a picture.
fn no_text(file: &Path) -> Failure {
    let fault = Fault::new(format!("`{}` is neither a scene nor a picture with a known extension", file.display()));
    let known = format!(
        "pictures end in .{}; save it as one of these, for example a camera's raw file as a 16-bit TIFF",
        PICTURES.join(", .")
    );
    fault.hint(known).into()
}

/// Asks the system to open an address in a browser. Returns whether that command could be started.
fn open(address: &str) -> bool {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    };
    command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().is_ok()
}
