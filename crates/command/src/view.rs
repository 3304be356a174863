//! `spectra view`.

use crate::arguments;
use crate::console;
use crate::film::called;
use crate::limits;
use crate::outcome::{Failure, Outcome};
use spectra_core::Isa;
use spectra_core::params::Fault;
use spectra_session::{PICTURES, is_picture};
use spectra_view::View;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

/// Serves a scene, or the color tester, to a browser until the process ends.
pub(crate) fn view(arguments: &arguments::View, isa: Isa) -> Outcome {
    let ready = |address: &str| {
        // A reader that has gone away is no failure.
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
        // The parser lets nothing else through.
        None => spectra_view::color_tester(arguments.port, ready),
        Some(scene) => {
            let (stock, overrides) = film(arguments, scene)?;
            let view = View {
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

/// The film of a photograph, by `--stock` or by `--set film.stock=...`, and what else is set: what light the picture is in follows from it.
fn film(arguments: &arguments::View, scene: &Path) -> Result<(Option<String>, Vec<String>), Failure> {
    let is_stock = |text: &String| text.split_once('=').is_some_and(|(path, _)| path.trim() == "film.stock");
    let all = &arguments.set.overrides;
    if !is_picture(scene) {
        if let Some(stock) = &arguments.stock {
            let fault = Fault::new("`--stock` is for a photograph, and this is a scene");
            return Err(fault.hint(format!("`--set film.stock={stock}`")).into());
        }
        return if is_text(scene) { Ok((None, all.clone())) } else { Err(no_text(scene)) };
    }
    let set = all.iter().rev().find(|text| is_stock(text)).and_then(|text| text.split_once('='));
    let said = set.map(|(_, stock)| stock.trim().to_owned()).or_else(|| arguments.stock.clone());
    let stock = said.map(|name| called(&name)).transpose()?;
    Ok((stock, all.iter().filter(|text| !is_stock(text)).cloned().collect()))
}

/// Whether a file begins as text does; what cannot be read is told of where it is read.
fn is_text(file: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(file).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.is_err() || !head.iter().any(|byte| *byte < 8)
}

/// That a file is neither a scene nor a picture.
fn no_text(file: &Path) -> Failure {
    let fault =
        Fault::new(format!("`{}` is neither a scene nor a picture that is known by its ending", file.display()));
    let known = format!(
        "pictures end in .{}; save it as one of these, such as TIFF of 16 bits from a camera's raw file",
        PICTURES.join(", .")
    );
    fault.hint(known).into()
}

/// Asks the system to open an address; whether it could be asked.
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
