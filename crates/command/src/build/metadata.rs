//! Output of `cargo metadata`.

use serde::Deserialize;
use std::path::PathBuf;

/// The parts of `cargo metadata` that are used here.
#[derive(Debug, Deserialize)]
pub(super) struct Metadata {
    pub packages: Vec<Package>,
    /// Graph of dependencies; `None` if only the manifest itself was read.
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

/// Purpose of a dependency: `None` for the code itself, otherwise tests or the build script.
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
    /// File with the terms, if the manifest names one instead of a usual license.
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
    /// Whether the package is a procedural macro, whose code runs in the compiler and is not linked.
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
