//! What `cargo metadata` says.

use serde::Deserialize;
use std::path::PathBuf;

/// The part of `cargo metadata` that is asked for.
#[derive(Debug, Deserialize)]
pub(super) struct Metadata {
    pub packages: Vec<Package>,
    /// What depends on what; not asked for where a manifest is read alone.
    #[serde(default)]
    pub resolve: Option<Resolve>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Resolve {
    pub nodes: Vec<Node>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub id: String,
    pub deps: Vec<Link>,
}

/// A crate that another one depends on.
#[derive(Debug, Deserialize)]
pub(super) struct Link {
    pub pkg: String,
    pub dep_kinds: Vec<LinkKind>,
}

/// For what: `None` for the code itself, else tests or the build script.
#[derive(Debug, Deserialize)]
pub(super) struct LinkKind {
    pub kind: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Package {
    pub id: String,
    pub name: String,
    pub version: String,
    pub manifest_path: PathBuf,
    pub license: Option<String>,
    /// A file with terms of its own, where no usual license is named.
    pub license_file: Option<PathBuf>,
    #[serde(default)]
    pub targets: Vec<Target>,
    #[serde(default)]
    pub dependencies: Vec<Dependency>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub name: String,
    pub crate_types: Vec<String>,
    #[serde(default)]
    pub kind: Vec<String>,
}

impl Package {
    /// Whether its code runs in the compiler and is not linked.
    pub(super) fn is_macro(&self) -> bool {
        self.targets.iter().any(|target| target.kind.iter().any(|kind| kind == "proc-macro"))
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct Dependency {
    pub name: String,
    pub req: String,
    pub kind: Option<String>,
    pub source: Option<String>,
    pub path: Option<PathBuf>,
}
