//! Development tasks of this repository.
//!
//! - `cargo run -p xtask -- web [FOLDER]` builds the page that needs no server, as a folder of files for any web server.
//! - `cargo run -p xtask -- times [ARGUMENTS OF CARGO TEST]` runs the tests and prints the slowest programs and tests.
//! - `xtask timed PROGRAM` runs a test program and records its times for `.ci/run`; `xtask slow FILE SECONDS` fails on slow tests.

mod link;
mod times;
mod web;

use std::error::Error;
use std::process::ExitCode;

/// Result of a task, or the error to print.
pub(crate) type TaskResult<T = ()> = Result<T, Box<dyn Error>>;

const USAGE: &str =
    "usage: cargo run -p xtask -- web [FOLDER] | times [ARGUMENTS OF CARGO TEST] | timed PROGRAM | slow FILE SECONDS";

fn main() -> ExitCode {
    if std::env::var_os(link::ASKED).is_some() {
        return ended(link::link(std::env::args_os().skip(1).collect()));
    }
    let mut arguments = std::env::args().skip(1);
    match arguments.next().as_deref() {
        Some("web") => ended(web::web(arguments.next().as_deref().unwrap_or("target/web").as_ref())),
        Some("times") => ended(times::times(arguments)),
        Some("timed") => match times::timed(arguments) {
            Ok(status) if status.success() => ExitCode::SUCCESS,
            // Cargo shows this as the exit code of the test program.
            Ok(status) => ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1)),
            Err(why) => ended(Err(why)),
        },
        Some("slow") => match (arguments.next(), arguments.next().and_then(|limit| limit.parse().ok())) {
            (Some(file), Some(limit_s)) => ended(times::slow(file.as_ref(), limit_s)),
            _ => ended(Err(USAGE.into())),
        },
        _ => ended(Err(USAGE.into())),
    }
}

fn ended(done: TaskResult) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}
