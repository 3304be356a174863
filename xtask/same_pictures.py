#!/usr/bin/env python3
"""Records digests of every bundled scene and the figures of every bundled lens, and compares two such records.

    xtask/same_pictures.py record target/release/spectra -o after.json   renders everything: about a quarter of an hour on two cores
    xtask/same_pictures.py compare benches/pictures.json after.json      lists the differences, and fails if one is too large

Each scene is rendered 240 pixels wide with a sixteenth of its samples: all pictures of a sweep, the first picture of an animation.
A record holds, for every file, a digest of its pixels (for an EXR file everything behind the header, for a PNG file its image data) and
for an EXR file the mean of each channel. A refactoring of the program must keep the digests. If it replaces a search for focus, stop or
field, the means must agree within 1e-5, the figures of lenses within 1e-6, and focus positions within 1e-4 mm. Needs numpy.
"""

import argparse
import hashlib
import json
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import exr_lines

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 240
FEWER = 16
MEAN = 1e-5
FIGURE = 1e-6
FOCUS_MM = 1e-4


def scenes():
    return [path for folder in ("", "surfaces", "bench") for path in sorted((ROOT / "scenes" / folder).glob("*.yaml"))]


def text_with_includes(path):
    text = path.read_text(encoding="utf-8")
    for name in re.findall(r"^include:\s*\[?([^\]#\n]+)", text, re.MULTILINE):
        for part in name.split(","):
            text += text_with_includes(path.parent / part.strip().strip("'\""))
    return text


def number(text, key):
    found = re.search(rf"\b{key}:\s*([0-9.e_]+)", text)
    return float(found.group(1).replace("_", "")) if found else None


def settings(path):
    """Returns the settings of a scene that make its picture small."""
    text = text_with_includes(path)
    sets = ["output=[exr, png]"]
    size = re.search(r"resolution:\s*\[\s*(\d+),\s*(\d+)\s*\]", text)
    part = 1.0
    if size:
        width, height = int(size.group(1)), int(size.group(2))
        small = min(WIDTH, width)
        part = (small / width) ** 2
        sets.append(f"imager.resolution=[{small}, {round(height * small / width)}]")
    if samples := number(text, "samples"):
        sets.append(f"render.samples={max(1, int(samples) // FEWER)}")
    if rays := number(text, "rays"):
        sets.append(f"render.rays={max(1000, int(rays * part / FEWER))}")
    own = path.read_text(encoding="utf-8")
    sets += ["animation=null"] if re.search(r"^animation:", own, re.MULTILINE) else []
    return sets


def pixels(path):
    """Returns the bytes of a picture that hold its pixels."""
    data = path.read_bytes()
    if path.suffix == ".png":
        out, at = b"", 8
        while at < len(data):
            (size,) = struct.unpack_from(">I", data, at)
            if data[at + 4 : at + 8] == b"IDAT":
                out += data[at + 8 : at + 8 + size]
            at += size + 12
        return out
    at = 8
    while data[at]:
        for _ in range(2):
            at = data.index(0, at) + 1
        (size,) = struct.unpack_from("<i", data, at)
        at += 4 + size
    # The header is followed by the offsets of the chunks in the file, which depend on the length of the header.
    (first,) = struct.unpack_from("<Q", data, at + 1)
    return data[first:]


def picture(program, scene):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", str(scene), "-q", "-o", folder]
        for text in settings(scene):
            command += ["--set", text]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            return {"error": done.stderr.strip()}
        files = {}
        for path in sorted(Path(folder).iterdir()):
            if path.suffix not in (".exr", ".png"):
                continue
            entry = {"pixels": hashlib.sha256(pixels(path)).hexdigest()[:16]}
            if path.suffix == ".exr":
                entry["means"] = {name: float(plane.mean()) for name, plane in exr_lines.read(path).items()}
            files[path.name] = entry
        return files


def figures(value, path=""):
    """Yields all numbers of a JSON value with their paths."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from figures(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for at, inner in enumerate(value):
            yield from figures(inner, f"{path}[{at}]")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


def lens(program, name):
    done = subprocess.run([program, "lens", "info", name, "--json"], capture_output=True, text=True)
    if done.returncode:
        return {"error": done.stderr.strip()}
    wanted = ("efl", "f_number", "t_number", "pupil", "shift", "field", "chief")
    return {path: value for path, value in figures(json.loads(done.stdout)) if path.startswith(wanted) or "focus" in path}


def record(program):
    program = str(Path(program).resolve())
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    out = {"version": version, "scenes": {}, "lenses": {}}
    for path in scenes():
        name = str(path.relative_to(ROOT / "scenes"))[: -len(".yaml")]
        out["scenes"][name] = picture(program, path)
        print(name, out["scenes"][name].get("error", ""), file=sys.stderr, flush=True)
    for path in sorted((ROOT / "lenses").glob("*.yaml")):
        out["lenses"][path.stem] = lens(program, path.stem)
    return out


def apart(a, b):
    return abs(a - b) / max(abs(a), abs(b), 1e-30)


def compare(before, after):
    """Yields the differences as lines, each with whether it is too large."""
    for name, files in before["scenes"].items():
        now = after["scenes"].get(name)
        if now is None or files.keys() != now.keys() or "error" in files:
            if files != now:
                yield f"{name}: other files, or an error", True
            continue
        for file, entry in files.items():
            if entry["pixels"] == now[file]["pixels"]:
                continue
            worst = max((apart(mean, now[file]["means"][c]) for c, mean in entry.get("means", {}).items()), default=None)
            means = "" if worst is None else f", means within {worst:.1e}"
            yield f"{file}: other pixels{means}", worst is not None and worst > MEAN
    for name, numbers in before["lenses"].items():
        now = after["lenses"].get(name, {})
        for path in sorted(numbers.keys() | now.keys()):
            a, b = numbers.get(path), now.get(path)
            if a == b:
                continue
            if not isinstance(a, (int, float)) or not isinstance(b, (int, float)):
                yield f"{name}: {path} {a} -> {b}", True
            elif path.endswith("_mm") and "focus" in path:
                yield f"{name}: {path} {a} -> {b}", abs(a - b) > FOCUS_MM
            else:
                yield f"{name}: {path} {a} -> {b}", apart(a, b) > FIGURE


def main():
    parser = argparse.ArgumentParser()
    tasks = parser.add_subparsers(dest="task", required=True)
    task = tasks.add_parser("record")
    task.add_argument("program")
    task.add_argument("-o", "--output", type=Path, required=True)
    task = tasks.add_parser("compare")
    task.add_argument("before", type=Path)
    task.add_argument("after", type=Path)
    arguments = parser.parse_args()
    if arguments.task == "record":
        arguments.output.write_text(json.dumps(record(arguments.program), indent=1) + "\n")
        return 0
    before, after = (json.loads(path.read_text()) for path in (arguments.before, arguments.after))
    found = list(compare(before, after))
    for line, too_large in found:
        print(("TOO LARGE: " if too_large else "") + line)
    print(f"{len(found)} differences, {sum(too_large for _, too_large in found)} too large")
    return int(any(too_large for _, too_large in found))


if __name__ == "__main__":
    sys.exit(main())
