//! Picture files: finds them, reads them, and turns their problems into faults.

use spectra_core::params::{Fault, Faults, Params, Warning};
use spectra_core::registry::Context;
use spectra_core::resources::{FoundFile, ResourceError};
use spectra_pictures::read::{self, FileProblem, Header, LinearPicture, ReadOptions};

/// Size limit of a picture file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A picture file that was found, with its keys in the scene.
pub(crate) struct PictureFile {
    pub found: FoundFile,
    pub name: String,
    pub transfer: Option<String>,
    pub layer: Option<String>,
    /// Whether to read alpha, too.
    pub cover: bool,
    /// The depth channel; `None` if depth is not read from this file.
    pub depth: Option<String>,
    /// Parameters that hold the keys of this file.
    pub params: Params,
}

impl PictureFile {
    fn choice(&self) -> ReadOptions<'_> {
        ReadOptions {
            name: &self.name,
            transfer: self.transfer.as_deref(),
            alpha: self.cover,
            layer: self.layer.as_deref(),
            depth: self.depth.as_deref(),
            overscan: [0; 2],
            is_plain: false,
        }
    }

    /// Reads the header of the file.
    pub(crate) fn header(&self) -> Result<Header, Faults> {
        read::header(&self.found, self.choice()).map_err(|e| trouble(&self.name, &e, &self.params).into())
    }

    /// Reads the file in linear light, with this many pixels of its overscan on each side.
    pub(crate) fn read(&self, overscan: [u32; 2]) -> Result<LinearPicture, Faults> {
        read::decode(&self.found, ReadOptions { overscan, ..self.choice() })
            .map_err(|e| trouble(&self.name, &e, &self.params).into())
    }

    /// Returns the warnings about the pixels of the file.
    pub(crate) fn warnings(&self, linear: &LinearPicture) -> Vec<Warning> {
        linear.warnings.iter().map(|doubt| trouble(&self.name, doubt, &self.params).into()).collect()
    }

    /// Reports the warnings about the header, and warns of a photograph whose code values are taken as light.
    pub(crate) fn warn(&self, header: &Header, context: &Context<'_>) {
        header.warnings.iter().for_each(|doubt| context.warn(trouble(&self.name, doubt, &self.params)));
        if header.is_jpeg && self.transfer.as_deref() == Some("linear") {
            let text =
                format!("`{}` is a JPEG, whose code values are sRGB: as linear light it is far too pale", self.name);
            context.warn(self.params.fault("transfer", text).hint("leave `transfer` out"));
        }
    }
}

/// Returns the fault of a picture file, at the key to which it belongs.
pub(crate) fn trouble(file: &str, trouble: &FileProblem, params: &Params) -> Fault {
    let named = trouble.key == "depth" && trouble.text.starts_with("the file has no depth channel");
    let key = match trouble.key {
        "depth" if named && params.get("channel").is_some() => "channel",
        "depth" if named && params.get("depth").is_some_and(|depth| depth.get("channel").is_some()) => "depth.channel",
        key => key,
    };
    let fault = params.fault(key, format!("picture `{file}`: {}", trouble.text));
    fault.hint(trouble.advice())
}

/// Returns the hint for a numbered sequence of pictures: `plate.####.exr`, `plate.%04d.exr` or `plate.${frame}.exr`.
fn sequence_hint(file: &str) -> Option<String> {
    let from = file.find(['#', '%', '$', '*'])?;
    let (mark, behind) = file[from..].split_at(1);
    let rest = match mark {
        "%" => behind.split_once('d')?.1,
        "$" => behind.strip_prefix('{').and_then(|name| name.split_once('}')).map_or(behind, |(_, rest)| rest),
        _ => behind.trim_start_matches(mark),
    };
    let frame = |n: u32| format!("{}{n:04}{rest}", &file[..from]);
    Some(format!(
        "write a sequence as an animation with one picture per frame: `animation: {{frames: 2, animate: {{source.file: {{1: {}, 2: {}, \
         interpolation: hold}}}}}}`; `film develop` without a scene accepts a pattern with `####`",
        frame(1),
        frame(2)
    ))
}

/// Finds a picture file beside the scene or among the bundled ones.
pub(crate) fn find(file: &str, params: &Params, context: &Context<'_>) -> Result<FoundFile, Fault> {
    context.resources.find(file, &["scenes"], &[], MAX_BYTES).map_err(|e| {
        let sequence = if matches!(e, ResourceError::NotFound(_)) { sequence_hint(file) } else { None };
        let hint = sequence.unwrap_or_else(|| match &e {
            ResourceError::NotFound(near) if !near.is_empty() => format!("did you mean `{}`?", near.join("` or `")),
            ResourceError::NotFound(_) if file.contains('\\') => "write `/` between folders and file".to_owned(),
            ResourceError::NotFound(_) => "paths are relative to the folder of the scene".to_owned(),
            _ => "OpenEXR, PNG, JPEG, TIFF, WebP, BMP and Radiance HDR files are read".to_owned(),
        });
        params.fault("file", format!("picture `{file}`: {e}")).hint(hint)
    })
}
