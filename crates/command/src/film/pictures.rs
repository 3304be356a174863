//! Finds the pictures that the arguments name, and the output files for them.

use crate::folder::Target;
use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_darkroom::{PICTURES, PictureJob, is_picture, last_number};
use spectra_session::Names;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A numbered file name: `plate.####.exr`, `plate.%04d.exr`.
struct Numbered {
    folder: PathBuf,
    before: String,
    after: String,
    /// Smallest number of digits.
    digits: usize,
}

impl Numbered {
    /// Parses a path; `None` if its file name has no placeholder for a number.
    fn of(path: &str) -> Option<Self> {
        let path = Path::new(path);
        let name = path.file_name()?.to_str()?;
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_owned);
        let of = |from: usize, to: usize, digits: usize| Self {
            folder: folder.clone(),
            before: name[..from].to_owned(),
            after: name[to..].to_owned(),
            digits,
        };
        if let Some(from) = name.find('#') {
            let count = name[from..].chars().take_while(|c| *c == '#').count();
            return Some(of(from, from + count, count));
        }
        let from = name.find('%')?;
        let (digits, _) = name[from + 1..].split_once('d')?;
        let count = digits.trim_start_matches('0');
        let count = if count.is_empty() { Some(1) } else { count.parse().ok().filter(|n| (1..=20).contains(n)) }?;
        Some(of(from, from + 2 + digits.len(), count))
    }

    /// Returns the number in a file name, or `None` if the name does not match.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(self.before.as_str())?.strip_suffix(self.after.as_str())?;
        let is_number = digits.len() >= self.digits && digits.bytes().all(|b| b.is_ascii_digit());
        is_number.then(|| digits.parse().ok()).flatten()
    }

    /// Returns the file name with a number.
    fn name(&self, number: u64) -> String {
        format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits)
    }
}

/// Returns the sorted names of all files in a folder.
fn names_in(folder: &Path) -> Result<Vec<String>, Failure> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries =
        std::fs::read_dir(folder).map_err(|error| Failure::Input(format!("{}: {error}", folder.display())))?;
    let mut names: Vec<String> = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    Ok(names)
}

/// A picture file, and the number in its name if it has one.
type Numbering = (PathBuf, Option<u64>);

/// Returns the files that one argument names, with their numbers, and whether the argument can name several.
fn files(argument: &str) -> Result<(Vec<Numbering>, bool), Failure> {
    let path = Path::new(argument);
    if path.is_dir() {
        let is_picture = |name: &String| !name.starts_with('.') && is_picture(Path::new(name));
        let names: Vec<String> = names_in(path)?.into_iter().filter(is_picture).collect();
        if names.is_empty() {
            let fault = Fault::new(format!("there are no pictures in `{argument}`"));
            return Err(fault.hint(format!("pictures are files that end in .{}", PICTURES.join(", ."))).into());
        }
        let all = names.into_iter().map(|name| {
            let stem = Path::new(&name).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
            (path.join(&name), last_number(&stem))
        });
        return Ok((all.collect(), true));
    }
    let numbered = Numbered::of(argument).filter(|_| !path.exists());
    let Some(numbered) = numbered else {
        let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        return Ok((vec![(path.to_owned(), last_number(&stem))], false));
    };
    let mut all: Vec<(u64, String)> =
        names_in(&numbered.folder)?.into_iter().filter_map(|name| Some((numbered.number(&name)?, name))).collect();
    all.sort();
    if all.is_empty() {
        let text = format!("no numbered file matches `{argument}`");
        return Err(Fault::new(text)
            .hint(format!("a file would match if it were named `{}`", numbered.folder.join(numbered.name(1)).display()))
            .into());
    }
    Ok((all.into_iter().map(|(number, name)| (numbered.folder.join(name), Some(number))).collect(), true))
}

/// Pictures to develop and their output files.
pub(super) struct DevelopFiles {
    /// Folder and names of the output files.
    pub target: Target,
    /// Pictures to develop, in order.
    pub plates: Vec<PictureJob>,
    /// Whether the arguments ask for several pictures, however many are found.
    pub is_series: bool,
    /// Message about frame numbers missing from a sequence.
    pub missing: Option<String>,
}

/// Returns a message about the frames that are missing from a sequence of numbers; `None` if none are missing.
fn missing(mut numbers: Vec<u64>) -> Option<String> {
    /// Largest number of gaps that are named.
    const NAMED: usize = 4;
    numbers.sort_unstable();
    let gaps: Vec<(u64, u64)> =
        numbers.windows(2).filter(|pair| pair[1] - pair[0] > 1).map(|pair| (pair[0] + 1, pair[1] - 1)).collect();
    if let [(first, last)] = gaps[..]
        && first == last
    {
        return Some(format!("frame {first} is missing"));
    }
    let one = |&(first, last): &(u64, u64)| {
        if first == last { first.to_string() } else { format!("{first} to {last}") }
    };
    let mut named: Vec<String> = gaps.iter().take(NAMED).map(one).collect();
    let more: u64 = gaps.iter().skip(NAMED).map(|(first, last)| last - first + 1).sum();
    named.extend((more > 0).then(|| format!("{more} more")));
    let last = named.pop()?;
    let before = if named.is_empty() { String::new() } else { format!("{} and ", named.join(", ")) };
    Some(format!("frames {before}{last} are missing"))
}

/// Function that returns the file extension for output files without a given name.
pub(super) type Ending<'a> = &'a dyn Fn() -> Result<String, Failure>;

/// Finds the pictures and decides their output files. Without an output name, `suffix` is added to the name of a single picture, so
/// that the output file differs from it.
pub(super) fn of(
    arguments: &[String],
    output: Option<&str>,
    suffix: &str,
    ending: Ending<'_>,
) -> Result<DevelopFiles, Failure> {
    let (mut found, mut several) = (Vec::new(), arguments.len() > 1);
    for argument in arguments {
        let (files, many) = files(argument)?;
        found.extend(files);
        several |= many;
    }
    let stem = |path: &Path| path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let shown = |path: &Path| path.to_string_lossy().into_owned();
    if let ([(file, own)], false) = (&found[..], several) {
        let (folder, name) = match output.map(Path::new) {
            None => (Path::new("."), format!("{}-{suffix}.{}", stem(file), ending()?)),
            Some(path) if path.is_dir() || shown(path).ends_with('/') => {
                (path, format!("{}.{}", stem(file), ending()?))
            }
            Some(path) if Names::of_picture(path).is_some() => (folder_of(path), name_of(file, *own, path)?),
            Some(path) => return Err(unknown(path)),
        };
        let target = Target { folder: folder.to_owned(), names: Names::of_scene() };
        let plates = vec![PictureJob { file: shown(file), output: name, number: *own }];
        return apart(DevelopFiles { target, plates, is_series: false, missing: None });
    }
    // Numbers are used only if each picture has its own.
    let mut known = BTreeMap::new();
    found.iter().for_each(|(_, number)| *known.entry(*number).or_insert(0) += 1);
    let is_numbered = !known.contains_key(&None) && known.values().all(|count| *count == 1);
    let number = |at: usize, number: Option<u64>| number.filter(|_| is_numbered).unwrap_or(at as u64 + 1);
    let numbered = output.and_then(Numbered::of);
    let folder = match (&numbered, output) {
        (Some(numbered), _) => {
            if Names::of_picture(Path::new(&numbered.name(1))).is_none() {
                return Err(unknown(Path::new(output.unwrap_or_default())));
            }
            let folder = &numbered.folder;
            if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.clone() }
        }
        (None, Some(folder)) => {
            let path = Path::new(folder);
            if path.is_file() || (!path.is_dir() && Names::of_picture(path).is_some()) {
                let text = format!("`{folder}` names one picture, but there are {} to develop", found.len());
                return Err(Fault::new(text).hint("write `-o out/`, or a numbered sequence: `-o out/####.png`").into());
            }
            path.to_owned()
        }
        (None, None) => PathBuf::from("out"),
    };
    let ending = if numbered.is_some() { String::new() } else { ending()? };
    let name = |at: usize, file: &Path, own: Option<u64>| match &numbered {
        Some(numbered) => numbered.name(number(at, own)),
        None => format!("{}.{ending}", stem(file)),
    };
    let plates: Vec<PictureJob> = found
        .iter()
        .enumerate()
        .map(|(at, (file, own))| PictureJob {
            file: shown(file),
            output: name(at, file, *own),
            number: Some(number(at, *own)),
        })
        .collect();
    let mut outputs = BTreeMap::new();
    for plate in &plates {
        if let Some(other) = outputs.insert(&plate.output, &plate.file) {
            let text = format!("`{other}` and `{}` would both be written as `{}`", plate.file, plate.output);
            return Err(Fault::new(text).hint("number the output files: `-o out/####.png`").into());
        }
    }
    // Files given one by one are a selection, not a sequence. Files of a folder are a sequence if they differ only in their numbers.
    let before = |file: &Path| stem(file).trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    let is_sequence = is_numbered
        && arguments.len() == 1
        && (Numbered::of(&arguments[0]).is_some() || found.iter().all(|(file, _)| before(file) == before(&found[0].0)));
    let missing = if is_sequence { missing(found.iter().filter_map(|(_, own)| *own).collect()) } else { None };
    apart(DevelopFiles { target: Target { folder, names: Names::of_scene() }, plates, is_series: true, missing })
}

/// Returns the output file name of a single picture, where `output` is a file or a numbered sequence. Fails if the picture has no
/// number for a numbered sequence.
fn name_of(picture: &Path, number: Option<u64>, output: &Path) -> Result<String, Failure> {
    let plain = || output.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let Some(numbered) = Numbered::of(&output.to_string_lossy()) else { return Ok(plain()) };
    number.map(|number| numbered.name(number)).ok_or_else(|| {
        let text = format!("`{}` has no number to put into `{}`", picture.display(), output.display());
        Fault::new(text)
            .hint(format!("name the file: `-o {}`", numbered.folder.join(numbered.name(1)).display()))
            .into()
    })
}

/// Returns the folder of a file, `.` if the path has none.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn unknown(path: &Path) -> Failure {
    let text = format!("a picture cannot be written as `{}`", path.display());
    Fault::new(text).hint("name a file that ends in .png, .jpg, .tiff or .exr, or a folder: `-o out/`").into()
}

/// Checks that no output file overwrites an input picture.
fn apart(found: DevelopFiles) -> Result<DevelopFiles, Failure> {
    let DevelopFiles { target, plates, .. } = &found;
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    for plate in plates {
        let written = real(&target.folder.join(&plate.output));
        if written.is_some() && plates.iter().any(|other| real(Path::new(&other.file)) == written) {
            let text = format!(
                "`{}` is an input picture and would be overwritten",
                target.folder.join(&plate.output).display()
            );
            return Err(Fault::new(text).hint("choose another folder or file with `-o`").into());
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names() {
        let hashes = Numbered::of("a/plate.####.exr").expect("numbered");
        assert_eq!((hashes.name(7), hashes.folder), ("plate.0007.exr".to_owned(), PathBuf::from("a")));
        let percent = Numbered::of("p%03d.png").expect("numbered");
        assert_eq!((percent.name(12), percent.number("p012.png")), ("p012.png".to_owned(), Some(12)));
        assert_eq!(
            (percent.number("p1000.png"), percent.number("p12.png"), percent.number("px12.png")),
            (Some(1000), None, None)
        );
        assert!(Numbered::of("100%.png").is_none() && Numbered::of("photo.jpg").is_none());
        let gaps = |numbers: &[u64]| missing(numbers.to_vec());
        assert_eq!((gaps(&[3]), gaps(&[4, 2, 3])), (None, None));
        assert_eq!(gaps(&[1003, 1005]).as_deref(), Some("frame 1004 is missing"));
        assert_eq!(gaps(&[1, 3, 7, 8]).as_deref(), Some("frames 2 and 4 to 6 are missing"));
        let many = [1, 3, 5, 7, 9, 11, 15, 17];
        assert_eq!(gaps(&many).as_deref(), Some("frames 2, 4, 6, 8 and 5 more are missing"));
        assert_eq!((last_number("dsc_0042"), last_number("holiday"), last_number("12")), (Some(42), None, Some(12)));
    }
}
