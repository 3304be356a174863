//! `--json`: a report as JSON.

use clap::Args;

/// Argument `--json`, shared by commands that print one report.
#[derive(Debug, Args)]
pub(crate) struct JsonReport {
    /// Write a JSON object to standard output.
    #[arg(long)]
    pub json: bool,
}
