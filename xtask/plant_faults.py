#!/usr/bin/env python3
"""Plants faults in the program, one at a time, and reports whether a test catches each.

    xtask/plant_faults.py               all of them, in a temporary copy of the repository
    xtask/plant_faults.py --list        lists them as a table and checks that each still fits the source; builds nothing
    xtask/plant_faults.py --only 3,7    some of them
    --folder DIR                        keeps the copy there, so that the next run builds less
    --target DIR                        where cargo builds; by default in the copy
    --no-sound                          does not check first that all tests pass without a fault
    --own                               runs only the tests of the crate that each fault is in: minutes

The faults are chosen by hand: slips that a tired person makes, in code whose results a user sees. The copy contains the last
commit, without uncommitted changes. All faults are compiled in at once, so one build is enough. The environment variable
SPECTRA_FAULT holds the number of the active fault; without it, the program is correct. For each fault the tests of its own
crate run first, then all others, those of the whole program first, until one fails. A test program counts as having caught the
fault if it hangs: if it takes 300 seconds, or three times its usual time if that is longer. The exit code is 1 if a fault
escapes.
"""

import argparse
import collections
import contextlib
import functools
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIMIT_S = 300.0
SOUND_LIMIT_S = 3600.0
FAILED = re.compile(r"test (.*?)(?: - should panic)? \.\.\. FAILED")

# Number, area, kind, effect, file, a text that occurs there once, and the faulty replacement of its part in «».
FAULTS = [
    (1, "lens", "sign", "A group of a lens that a scene shifts toward the image goes toward the object.",
     "crates/lens/src/misalignment.rs", "elements.clone(), «-by.shift_mm»);", "by.shift_mm"),
    (2, "lens", "swap", "A toroid's curvatures across and along are taken for each other in first order.",
     "plugins/surfaces/src/toroid.rs", "«(self.rotation_per_mm, self.section.curvature_per_mm + 2.0 * a2)»",
     "(self.section.curvature_per_mm + 2.0 * a2, self.rotation_per_mm)"),
    (3, "lens", "off by one", "The blades of an iris stand half a blade farther round.",
     "crates/lens/src/aperture/iris.rs", "half * f64::from(«2 * k + 1»);", "2 * k"),
    (4, "lens", "unit", "Glass absorbs by the millimeter what it absorbs by the centimeter.",
     "crates/tracer/src/absorption.rs", "«4.0e6» * std::f64::consts::PI * k / wavelength_nm", "4.0e7"),
    (5, "render", "factor of two", "The noise of a picture is judged twice as large as it is.",
     "crates/render/src/block_noise.rs", "let own = «0.5» * (square / cell.lit).sqrt()", "1.0"),
    (6, "render", "swap", "In the account of ghosts, light out of the front and light beside the frame are taken for each other.",
     "crates/render/src/ghosts/ledger.rs",
     "self.front_w += «other.front_w»;\n        self.beside_w += «other.beside_w»;", ("other.beside_w", "other.front_w")),
    (7, "render", "off by one", "Not the last row of the veil's lattice is weighed as an edge, but the one before.",
     "crates/render/src/veil.rs", "if at == 0 || «at == last» { 2.0 }", "at + 1 == last"),
    (8, "render", "sign", "The layer of the star holds what diffraction takes away as what it adds.",
     "crates/render/src/renderer.rs", ".map(|(now, before)| «now - before»);", "before - now"),
    (9, "film", "factor of two", "A spot meter looks at a circle of twice its diameter.",
     "plugins/films/src/metering.rs", "x * x + y * y <= «0.25» * self.spot.diameter", "1.0"),
    (10, "film", "unit", "Specks of dust by the square centimeter are scattered as if ten square millimeters were one.",
     "plugins/films/src/frame/dust.rs", "per_cm2 * CELL_MM * CELL_MM / «MM2_PER_CM2»;", "10.0"),
    (11, "film", "swap", "Who inhibits and who is inhibited are taken for each other among the layers of a color film.",
     "crates/film/src/emulsion.rs", "«self.inhibition[i].get(j)».copied()", "self.inhibition[j].get(i)"),
    (12, "film", "off by one", "The last row of a table of reciprocity is not read.",
     "crates/film/src/stock/reciprocity.rs", ".clamp(1, «points.len() - 1»);", "(points.len() - 2).max(1)"),
    (13, "spectrum", "sign", "One sign in the polynomial between measured points is wrong.",
     "crates/spectrum/src/sprague.rs",
     "let a4 = «(13.0 * a - 64.0 * b + 126.0 * c - 124.0 * d + 61.0 * e - 12.0 * f)» / 24.0;",
     "(13.0 * a - 64.0 * b + 126.0 * c - 124.0 * d + 61.0 * e + 12.0 * f)"),
    (14, "spectrum", "factor of two", "The narrow part of the spectrum of an LED has half of its share.",
     "crates/spectrum/src/kind/led.rs", "GaussianTerm::new(«2.0 / 3.0», peak_nm", "1.0 / 3.0"),
    (15, "spectrum", "unit", "The radiance of a black body is by the micrometer, not by the nanometer.",
     "crates/spectrum/src/planck.rs", "per_metre * «1e-9»", "1e-6"),
    (16, "glass", "sign", "What heat does to the index of a glass is taken off where it is to be added.",
     "crates/glass/src/glass.rs", "air_at(reference)) + «change»", "-change"),
    (17, "glass", "off by one", "The status of a glass in a catalogue file is read from the column before it.",
     "crates/glass/src/agf.rs", "status: match number(«7»)", "6"),
    (18, "glass", "swap", "Whose absorption a glass borrows goes by distances with the units of index and Abbe number swapped.",
     "crates/glass/src/catalog/absorption_substitute.rs",
     "((candidate.nd - borrower.nd) / «UNIT_ND», (candidate.vd - borrower.vd) / «UNIT_VD»)", ("UNIT_VD", "UNIT_ND")),
    (19, "scene", "sign", "A value that changes smoothly swings beyond the keyframe that it comes to.",
     "crates/scene/src/language/law.rs", "3.0 * u * t * t * («b - to / 3.0»)", "b + to / 3.0"),
    (20, "scene", "off by one", "A sweep over a range stops one step before its end.",
     "crates/scene/src/language/sweep.rs", "(range.steps.get() - «1») as f64", "0"),
    (21, "scene", "factor of two", "Light is reflected at one face of a glass filter in front of the lens, not at two.",
     "crates/scene/src/filters.rs", "«(1.0 - r) * (1.0 - r)» * t / (1.0 - r * r * t * t)", "(1.0 - r)"),
    (22, "pictures", "swap", "Pictures of a camera that was held on its side are turned the wrong way.",
     "crates/pictures/src/read/orientation.rs",
     "6 => «[y, last_row - x]»,\n        7 => [last_column - y, last_row - x],\n        8 => «[last_column - y, x]»,",
     ("[last_column - y, x]", "[y, last_row - x]")),
    (23, "pictures", "off by one", "A picture that is stretched to square pixels moves by a pixel.",
     "crates/pictures/src/write/resample.rs", "(place.floor() as i64 + «k»)", "k + 1"),
    (24, "pictures", "unit", "A raw file states the pixels of its sensor by the millimeter and calls it a centimeter.",
     "crates/pictures/src/write/dng.rs",
     "rationals(41_486, &[«MM_PER_CM» / frame.pixel_mm[0]]), // FocalPlaneXResolution\n"
     "        rationals(41_487, &[«MM_PER_CM» / frame.pixel_mm[1]]), // FocalPlaneYResolution", ("1.0", "1.0")),
    (25, "exchange", "factor of two", "Diameters in a table of a lens are read as semi-diameters.",
     "crates/exchange/src/csv/table.rs", ".map(|d| «d / 2.0»)", "d"),
    (26, "exchange", "sign", "A tilt about x in a lens file of another program turns the other way.",
     "crates/exchange/src/seq/lens.rs", "tilt_deg: [«0.0 - a», 0.0 - b, c],", "a"),
    (27, "exchange", "off by one", "Coefficients of an asphere in inches are scaled by one power too many.",
     "crates/exchange/src/zmx/shape.rs", "coefficients.push(self.parameters.get(at) / power_of(self.unit_mm, «power - 1»));", "power"),
    (28, "view", "swap", "The values of a pixel that the page points at are those of another, with row and column swapped.",
     "crates/view/src/parts.rs", "let at = («y * width + x») as usize;", "x * width + y"),
    (29, "view", "factor of two", "The study of dispersion begins with a prism of half the size.",
     "crates/view/src/served/bench.rs", "\"side\": first.semi_diameter_mm.map(|half| «2.0 * half»),", "half"),
    (30, "view", "unit", "The study of dispersion shows the least deviation in radians, not in degrees.",
     "crates/view/src/served/study.rs", "[incidence.to_degrees(), «(2.0 * (incidence - half_apex)).to_degrees()»]",
     "2.0 * (incidence - half_apex)"),
]

# This code is added to the copy and checks which fault is requested. It avoids the spelling `env::`, because a test checks which
# files access the environment.
PLANTED = """
/// Whether `SPECTRA_FAULT` asks for this fault.
#[must_use]
pub fn planted(number: u32) -> bool {
    use std::{env as surroundings, sync::OnceLock};
    static ASKED: OnceLock<u32> = OnceLock::new();
    *ASKED.get_or_init(|| surroundings::var("SPECTRA_FAULT").ok().and_then(|text| text.parse().ok()).unwrap_or(0)) == number
}
"""
HOME = "crates/numerics/src/lib.rs"
HANDED_ON = ("crates/core/src/lib.rs", "pub use spectra_numerics::{isa, math};", "pub use spectra_numerics::{isa, math, planted};")

Fault = collections.namedtuple("Fault", "number area kind words file marked faulty")
Test = collections.namedtuple("Test", "program folder name is_lib")


def faults():
    return [Fault(*f[:6], f[6] if isinstance(f[6], tuple) else (f[6],)) for f in FAULTS]


def original(fault):
    return fault.marked.replace("«", "").replace("»", "")


def planted(fault):
    faulty, asked = iter(fault.faulty), f"spectra_core::planted({fault.number})"
    either = lambda found: f"(if {asked} {{ {next(faulty)} }} else {{ {found[1]} }})"
    return re.sub("«(.*?)»", either, fault.marked)


def place(root, fault):
    """Returns the line of a fault, and the file's text; exits if the fault does not fit."""
    path = root / fault.file
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    count = text.count(original(fault))
    if count != 1:
        sys.exit(f"fault {fault.number}, {fault.words}\n{fault.file} has its text {count} times, not once: {original(fault)!r}")
    return text[: text.index(original(fault)) + fault.marked.index("«")].count("\n") + 1, text


def listed(all_faults):
    print("| no. | area | kind | fault | place |\n|---:|---|---|---|---|")
    for fault in all_faults:
        line, _ = place(ROOT, fault)
        print(f"| {fault.number} | {fault.area} | {fault.kind} | {fault.words} | `{fault.file}:{line}` |")


def git(folder, *words):
    return subprocess.run(["git", "-C", str(folder), *words], stdout=subprocess.PIPE, check=True, text=True).stdout.strip()


def copied(folder, all_faults):
    """Makes a copy of the last commit with all faults in it. A copy that is up to date is kept."""
    if changed := git(ROOT, "status", "--porcelain"):
        print(f"{len(changed.splitlines())} files are not as they were committed: the copy has them as committed", file=sys.stderr)
    head, mark = git(ROOT, "rev-parse", "HEAD"), folder / ".git/planted"
    wanted = f"{head} {hashlib.sha256(Path(__file__).read_bytes()).hexdigest()}"
    if not folder.exists() or not any(folder.iterdir()):
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    elif not mark.is_file():
        sys.exit(f"{folder} is there and is no copy that this script made: name another folder")
    elif mark.read_text() == wanted:
        return
    else:
        git(folder, "fetch", "--quiet", str(ROOT), "HEAD")
    mark.write_text("not done")
    git(folder, "checkout", "--quiet", "--force", "--detach", head)
    for fault in all_faults:
        _, text = place(folder, fault)
        (folder / fault.file).write_text(text.replace(original(fault), planted(fault)), encoding="utf-8")
    with (folder / HOME).open("a", encoding="utf-8") as home:
        home.write(PLANTED)
    path, old, new = folder / HANDED_ON[0], *HANDED_ON[1:]
    text = path.read_text(encoding="utf-8")
    if text.count(old) != 1:
        sys.exit(f"{path} has `{old}` {text.count(old)} times, not once")
    path.write_text(text.replace(old, new), encoding="utf-8")
    mark.write_text(wanted)


def built(folder, target):
    """Builds the copy and returns its test programs."""
    command = ["cargo", "test", "--workspace", "--locked", "--no-run", "--message-format=json-render-diagnostics"]
    env = {**os.environ, "CARGO_INCREMENTAL": "0", "CARGO_TARGET_DIR": str(target)}
    done = subprocess.run(command, cwd=folder, env=env, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"the copy in {folder} does not build")
    tests = []
    for said in (json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")):
        if said["reason"] == "compiler-artifact" and said["profile"]["test"] and said["executable"]:
            package = Path(said["manifest_path"]).resolve().parent
            is_lib = "lib" in said["target"]["kind"]
            name = package.relative_to(folder).as_posix() + ("" if is_lib else "/" + said["target"]["name"])
            tests.append(Test(said["executable"], package, name.removeprefix("./"), is_lib))
    # Tests of the whole program come first; within a crate, its unit tests do.
    return sorted(tests, key=lambda test: (test.folder != folder, not test.is_lib, test.name))


def run(test, number, limit_s):
    """Runs a test program. Returns its first failing test, or how else it failed (None if all passed), and its time, s."""
    env = {**os.environ, "SPECTRA_FAULT": str(number), "CARGO_MANIFEST_DIR": str(test.folder)}
    begun, wrong = time.monotonic(), None
    program = subprocess.Popen(
        [test.program], cwd=test.folder, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        text=True, errors="replace", start_new_session=True,
    )
    late = threading.Event()

    def end():
        with contextlib.suppress(OSError):
            os.killpg(program.pid, signal.SIGKILL)

    timer = threading.Timer(limit_s, lambda: (late.set(), end()))
    timer.start()
    try:
        for line in program.stdout:
            if found := FAILED.match(line):
                wrong = found[1]
                break
        else:
            program.wait()
            if late.is_set():
                wrong = f"hangs for {limit_s:.0f} s"
            elif program.returncode != 0:
                wrong = f"ends with code {program.returncode}"
    finally:
        timer.cancel()
        end()
        program.wait()
        program.stdout.close()
    return wrong, time.monotonic() - begun


def crate(folder, fault):
    return folder / "/".join(fault.file.split("/")[:2])


def search(fault, tests, own, sound, only_own):
    """Returns where a fault is caught, by which test, and how long its runs took, s. Skips tests that fail without a fault."""
    all_s = 0.0
    for where, is_own in (("crate", True), ("workspace", False))[: 1 if only_own else 2]:
        for test in (test for test in tests if (test.folder == own) == is_own):
            wrong, usual_s = sound(test)
            if wrong:
                print(f"{test.name} is left out: without a fault, {wrong}", file=sys.stderr)
                continue
            wrong, took_s = run(test, fault.number, max(LIMIT_S, 3.0 * usual_s))
            all_s += took_s
            if wrong:
                return where, f"{test.name}: {wrong}", all_s
    return "ESCAPED", "", all_s


def tried(chosen, tests, folder, is_sound_asked, only_own):
    """Tries the faults, and returns whether all are caught."""
    # Result of each test program without a fault, computed once.
    sound = functools.cache(lambda test: run(test, 0, SOUND_LIMIT_S) if is_sound_asked else (None, 0.0))
    for test in (test for test in tests if test.folder in {crate(folder, fault) for fault in chosen}):
        if wrong := sound(test)[0]:
            sys.exit(f"{test.name} fails without a fault: {wrong}")
    print("| no. | area | kind | caught by | test | s |\n|---:|---|---|---|---|---:|", flush=True)
    found = collections.Counter()
    for fault in chosen:
        where, name, all_s = search(fault, tests, crate(folder, fault), sound, only_own)
        found[where] += 1
        print(f"| {fault.number} | {fault.area} | {fault.kind} | {where} | {name} | {all_s:.0f} |", flush=True)
    print(f"\n{len(chosen) - found['ESCAPED']} of {len(chosen)} caught, {found['crate']} by the tests of their own crate")
    return found["ESCAPED"] == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="lists the faults as a table and builds nothing")
    parser.add_argument("--only", metavar="NUMBERS", help="numbers of the faults to try, separated by commas")
    parser.add_argument("--folder", type=Path, metavar="DIR", help="where to make and keep the copy")
    parser.add_argument("--target", type=Path, metavar="DIR", help="folder in which cargo builds; by default in the copy")
    parser.add_argument("--no-sound", action="store_true", help="do not check first that all tests pass without a fault")
    parser.add_argument("--own", action="store_true", help="run only the tests of the crate that each fault is in")
    args = parser.parse_args()
    all_faults = faults()
    if args.list:
        return listed(all_faults)
    numbers = [int(n) for n in args.only.split(",")] if args.only else [fault.number for fault in all_faults]
    if unknown := set(numbers) - {fault.number for fault in all_faults}:
        sys.exit(f"there is no fault {min(unknown)}")
    chosen = [fault for fault in all_faults if fault.number in numbers]
    with tempfile.TemporaryDirectory() as temporary:
        folder = (args.folder or Path(temporary) / "spectra").resolve()
        target = (args.target or folder / "target").resolve()
        copied(folder, all_faults)
        if not tried(chosen, built(folder, target), folder, not args.no_sound, args.own):
            sys.exit(1)


if __name__ == "__main__":
    main()
