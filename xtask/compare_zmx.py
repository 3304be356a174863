#!/usr/bin/env python3
"""Compares the focal lengths of .zmx files: spectra against rayoptics and optiland.

Reads every .zmx file below the given folders. The unpacked source archives of the Python packages `rayoptics` (BSD-3) and `optiland`
(MIT) hold some. They include files of vendors that may not be passed on, so they are not in the repository. Prints for each file the
effective focal length (mm, at the primary wavelength of the file) by `spectra lens info` and by both packages, the ratio, and what
the import leaves out.

    pip install rayoptics optiland
    xtask/compare_zmx.py --spectra target/release/spectra FOLDER... > table.csv
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile


def text_of(path):
    """Returns the text of a file in UTF-16 or an 8-bit encoding."""
    data = path.read_bytes()
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16")
    return data.decode("latin-1")


def primary_nm(path):
    """Returns the primary wavelength that the file states, nm."""
    waves, primary = {}, 1
    for line in text_of(path).splitlines():
        words = line.split()
        if words[:1] == ["WAVM"]:
            waves[int(words[1])] = float(words[2]) * 1000
        elif words[:1] == ["PWAV"]:
            primary = int(words[1])
    return waves.get(primary)


def by_rayoptics(path):
    from rayoptics.gui.appcmds import open_model

    model = open_model(path)
    if isinstance(model, tuple):
        model = model[0]
    model.update_model()
    return model["analysis_results"]["parax_data"].fod.efl


def by_optiland(path):
    from optiland.fileio import load_zemax_file

    return float(load_zemax_file(str(path)).paraxial.f2())


def by_spectra(binary, path, nm):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "lens.yaml"
        run = subprocess.run([binary, "lens", "import", path, "-o", out, "--json"], capture_output=True, text=True)
        if run.returncode != 0:
            return None, run.stderr.strip().splitlines()[-1:]
        notes = json.loads(run.stdout)["not_carried"]
        light = ["--wavelength-nm", f"{nm:.6f}"] if nm else []
        run = subprocess.run([binary, "lens", "info", path, "--json", *light], capture_output=True, text=True)
        efl = json.loads(run.stdout)["efl_mm"] if run.returncode == 0 else None
        if run.returncode != 0:
            notes.append({"text": " ".join(run.stderr.split())[:120], "alters_light": True})
        return efl, [("! " if n["alters_light"] else "") + n["text"] for n in notes]


def attempt(how, path):
    """Returns the value that `how` computes for a file, or the first line of its error."""
    try:
        return how(path)
    except Exception as error:  # any error of the packages is a result of the comparison
        return f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"[:60]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spectra", default="target/release/spectra")
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    table = csv.writer(sys.stdout)
    table.writerow(["file", "wavelength_nm", "spectra_efl_mm", "rayoptics_efl_mm", "optiland_efl_mm", "ratio", "not_carried"])
    files = sorted(p for folder in arguments.folders for p in folder.rglob("*") if p.suffix.lower() == ".zmx")
    for path in files:
        nm = primary_nm(path)
        ours, notes = by_spectra(arguments.spectra, path, nm)
        theirs = [attempt(by_rayoptics, path), attempt(by_optiland, path)]
        number = next((t for t in theirs if isinstance(t, float) and abs(t) < 1e9), None)
        ratio = f"{ours / number:.6f}" if ours and number else ""
        table.writerow([path.name, nm, ours, *theirs, ratio, " | ".join(notes)])
        sys.stdout.flush()


if __name__ == "__main__":
    main()
