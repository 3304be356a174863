//! `cargo run -p xtask -- web`: the page without a server, as a folder of files that any web server can give out.

mod link;
mod web;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let done = if std::env::var_os(link::ASKED).is_some() {
        link::link(std::env::args_os().skip(1).collect())
    } else {
        match (arguments.next().as_deref(), arguments.next()) {
            (Some("web"), folder) => web::web(folder.as_deref().unwrap_or("target/web").as_ref()),
            _ => Err("usage: cargo run -p xtask -- web [FOLDER]".to_owned()),
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}
