//! Measurement of the time that tests take.
//!
//! Cargo starts each test program through a runner (`cargo config`, `target.<triple>.runner`). Ours, [`timed`], asks the test harness for
//! the time of each test, passes on what it prints, and appends the times to a file. [`times`] runs all tests this way and prints a table.
//! [`slow`] reads the file and runs tests that took too long again, alone, since every test is slow while others run.

use crate::TaskResult;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Instant;

/// Environment variable with the path of the file to which [`timed`] appends.
pub const FILE: &str = "SPECTRA_TIMES";

/// Runs a test program and records how long it and each of its tests took. `arguments` are the program's path and its own arguments.
///
/// # Errors
/// The program is missing or cannot be run, or the times cannot be written.
pub fn timed(mut arguments: impl Iterator<Item = String>) -> TaskResult<ExitStatus> {
    let program = arguments.next().ok_or("usage: xtask timed PROGRAM [ARGUMENTS]")?;
    let begun = Instant::now();
    let mut child = harness(&program).args(arguments).spawn().map_err(|error| format!("{program}: {error}"))?;
    let mut lines = String::new();
    let mut out = std::io::stdout();
    for line in BufReader::new(child.stdout.take().ok_or("no pipe")?).split(b'\n') {
        let line = String::from_utf8_lossy(&line?).into_owned();
        if let Some((test, seconds)) = reported(&line) {
            let _ = writeln!(lines, "{program}\t{}\t{test}\t{seconds}", folder()?);
        }
        writeln!(out, "{line}")?;
    }
    let status = child.wait()?;
    let _ = writeln!(lines, "{program}\t{}\t\t{:.3}", folder()?, begun.elapsed().as_secs_f64());
    if let Some(file) = std::env::var_os(FILE) {
        let mut file = std::fs::File::options().create(true).append(true).open(&file)?;
        file.write_all(lines.as_bytes())?;
    }
    Ok(status)
}

/// Returns the command that runs a test program and makes it print the time of each test. The option works in the stable harness, but must
/// be enabled as if it were unstable.
fn harness(program: &str) -> Command {
    let mut command = Command::new(program);
    command.env("RUSTC_BOOTSTRAP", "1").args(["-Zunstable-options", "--report-time"]).stdout(Stdio::piped());
    command
}

fn folder() -> TaskResult<String> {
    Ok(std::env::current_dir()?.display().to_string())
}

/// Parses the name and the seconds from a line such as `test NAME ... ok <1.234s>`; `None` for other lines.
fn reported(line: &str) -> Option<(&str, f64)> {
    let (name, rest) = line.strip_prefix("test ")?.split_once(" ... ")?;
    let (_, time) = rest.rsplit_once('<')?;
    Some((name.split(" - ").next()?, time.strip_suffix("s>")?.parse().ok()?))
}

/// One line of the file of times.
struct TimeRecord {
    program: String,
    folder: String,
    /// Name of the test; empty for the program as a whole.
    test: String,
    seconds: f64,
}

fn rows(file: &Path) -> TaskResult<Vec<TimeRecord>> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let row = |line: &str| {
        let mut cells = line.split('\t').map(str::to_owned);
        let (program, folder, test) = (cells.next()?, cells.next()?, cells.next()?);
        Some(TimeRecord { program, folder, test, seconds: cells.next()?.parse().ok()? })
    };
    Ok(text.lines().filter_map(row).collect())
}

/// Returns the name of a program without its folder and the hash that cargo adds.
fn plain(program: &str) -> &str {
    let name = program.rsplit(['/', '\\']).next().unwrap_or(program);
    name.rsplit_once('-').map_or(name, |(name, _)| name)
}

/// Formats a table of the `most` slowest programs and the `most` slowest tests, slowest first.
fn table(rows: &[TimeRecord], most: usize) -> String {
    let mut programs: BTreeMap<&str, f64> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.test.is_empty()) {
        *programs.entry(plain(&row.program)).or_default() += row.seconds;
    }
    let mut programs: Vec<_> = programs.into_iter().collect();
    programs.sort_by(|a, b| b.1.total_cmp(&a.1));
    let all: f64 = programs.iter().map(|(_, seconds)| seconds).sum();
    let mut text = format!("{} test programs, {all:.0} s one after the other\n", programs.len());
    for (name, seconds) in programs.iter().take(most) {
        let _ = writeln!(text, "{seconds:8.1} s  {name}");
    }
    let mut tests: Vec<&TimeRecord> = rows.iter().filter(|row| !row.test.is_empty()).collect();
    tests.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    let _ = writeln!(text, "{} tests; the slowest of them, while others ran", tests.len());
    for row in tests.iter().take(most) {
        let _ = writeln!(text, "{:8.1} s  {} {}", row.seconds, plain(&row.program), row.test);
    }
    text
}

/// Runs all tests, or those that cargo's `arguments` choose, and prints programs and tests sorted by time.
///
/// # Errors
/// Cargo cannot be run, or a test fails.
pub fn times(arguments: impl Iterator<Item = String>) -> TaskResult {
    let own = std::env::current_exe()?;
    let file = std::env::temp_dir().join(format!("spectra-times-{}", std::process::id()));
    let version = Command::new("rustc").arg("-vV").output().map_err(|error| format!("rustc: {error}"))?.stdout;
    let version = String::from_utf8_lossy(&version).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc names no host")?;
    let runner = format!("CARGO_TARGET_{}_RUNNER", host.to_uppercase().replace('-', "_"));
    let mut cargo = Command::new("cargo");
    cargo.args(["test", "--workspace", "--locked", "--no-fail-fast"]).args(arguments);
    cargo.env(runner, format!("{} timed", own.display())).env(FILE, &file);
    let status = cargo.status().map_err(|error| format!("cargo: {error}"))?;
    let read = rows(&file);
    let _ = std::fs::remove_file(&file);
    println!("{}", table(&read?, 50));
    if status.success() { Ok(()) } else { Err(format!("cargo test: {status}").into()) }
}

/// Prints the ten slowest programs and tests of a file of times; fails if a test takes more than `limit_s` seconds when run alone.
///
/// # Errors
/// The file cannot be read, a program cannot be run, or a test takes too long.
pub fn slow(file: &Path, limit_s: f64) -> TaskResult {
    let rows = rows(file)?;
    println!("{}", table(&rows, 10));
    let mut wrong = String::new();
    for row in rows.iter().filter(|row| !row.test.is_empty() && row.seconds > limit_s) {
        let begun = Instant::now();
        let mut alone = harness(&row.program);
        alone.args(["--exact", &row.test]).current_dir(&row.folder).stdout(Stdio::null());
        let status = alone.status().map_err(|error| format!("{}: {error}", row.program))?;
        let seconds = begun.elapsed().as_secs_f64();
        println!("{}: {:.1} s with others, {seconds:.1} s alone, {status}", row.test, row.seconds);
        if seconds > limit_s {
            let _ = writeln!(wrong, "{} {} takes {seconds:.1} s alone", plain(&row.program), row.test);
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{wrong}a test may take at most {limit_s} s: make it faster, or mark it `#[ignore]` and name it in a long step of .ci/run"
    )
    .into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_from_what_the_harness_prints() {
        assert_eq!(reported("test a::b ... ok <1.250s>"), Some(("a::b", 1.25)));
        assert_eq!(reported("test c - should panic ... FAILED <0.001s>"), Some(("c", 0.001)));
        assert_eq!(reported("test d ... ignored, minutes"), None);
        assert_eq!(reported("running 2 tests"), None);
        assert_eq!(plain("/x/target/debug/deps/it-0123456789abcdef"), "it");
    }
}
