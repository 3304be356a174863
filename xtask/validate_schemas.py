#!/usr/bin/env python3
"""Validates every scene, lens, stock and spectrum file of the repository against the schemas that `spectra schema` writes.

An independent check of the schemas: the validator is Python's `jsonschema`, the YAML reader is ruamel's (YAML 1.2, as ours).
The schemas must also reject broken files, since a schema that accepts everything would pass the first half.

Usage: validate_schemas.py PATH/TO/spectra
Needs: jsonschema >= 4, ruamel.yaml (Debian: python3-jsonschema, python3-ruamel.yaml).
"""

import json
import pathlib
import subprocess
import sys

import jsonschema
from ruamel.yaml import YAML

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Example plugins whose stage belongs to a lens file, so their scenes are valid without them.
IN_LENSES = ("axicon", "diffusion-filter")

FILES = {
    "scene": ["scenes/**/*.yaml", "plugins/examples/*/scene.yaml"],
    "lens": ["lenses/**/*.yaml", "plugins/examples/*/lens.yaml"],
    "stock": ["spectra/film/*.yaml"],
    "spectrum": ["spectra/**/*.yaml"],
}
# Values that a schema must reject: the file, the path of the value, and the new value (None: the key is removed).
BROKEN = [
    ("scene", "scenes/biotar-ortho.yaml", ["source", "kind"], "chrat"),
    ("scene", "scenes/biotar-ortho.yaml", ["source", "distance"], "2 lx"),
    ("scene", "scenes/biotar-ortho.yaml", ["source", "distance"], -5),
    ("scene", "scenes/biotar-ortho.yaml", ["source", "no-such-key"], 1),
    ("scene", "scenes/biotar-ortho.yaml", ["lens", "file"], None),
    ("scene", "scenes/biotar-ortho.yaml", ["film", "exposure"], "fast"),
    ("scene", "scenes/biotar-ortho.yaml", ["render", "direction"], "sideways"),
    ("scene", "scenes/biotar-ortho.yaml", ["output"], ["gif"]),
    ("lens", "lenses/zeiss-biotar-50-f1.4.yaml", ["surfaces", 0, "radius"], "41 deg"),
    ("lens", "lenses/zeiss-biotar-50-f1.4.yaml", ["surfaces", 0, "kind"], "speher"),
    ("lens", "lenses/zeiss-biotar-50-f1.4.yaml", ["surfaces", 0, "coefficients"], [1]),
    ("stock", "spectra/film/ilford-ortho-plus.yaml", ["iso"], 0),
    ("stock", "spectra/film/ilford-ortho-plus.yaml", ["layers"], None),
]
# Values that a schema must accept: variables can replace values of any kind.
GOOD = [
    ("scene", "scenes/biotar-ortho.yaml", ["source", "distance"], "$distance"),
    ("scene", "scenes/biotar-ortho.yaml", ["source"], "$subject"),
    ("scene", "scenes/biotar-ortho.yaml", ["imager", "resolution"], "$size"),
    ("scene", "scenes/biotar-ortho.yaml", ["variables"], {"distance": "2 m", "size": [3, 2]}),
    ("scene", "scenes/biotar-ortho.yaml", ["sweep"], {"lens.f-number": [2, 4]}),
]


def plain(value):
    """Converts ruamel's types to plain Python types."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list):
        return [plain(v) for v in value]
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value)
    return str(value)


def read(path):
    return plain(YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8")))


def said(error):
    where = "/".join(str(p) for p in error.absolute_path)
    return f"{where}: {error.message[:300]}"


def main():
    program = sys.argv[1]
    validators = {}
    for kind in FILES:
        schema = json.loads(subprocess.run([program, "schema", kind], check=True, capture_output=True).stdout)
        jsonschema.Draft202012Validator.check_schema(schema)
        validators[kind] = jsonschema.Draft202012Validator(schema)
    listed = json.loads(subprocess.run([program, "list", "--json"], check=True, capture_output=True).stdout)
    with_examples = any(stage["name"] == "axicon" for stage in listed)
    faulty = checked = 0
    for kind, patterns in FILES.items():
        for path in sorted(p for pattern in patterns for p in ROOT.glob(pattern)):
            if kind == "spectrum" and path.parent.name in ("film", "sensors"):
                continue
            # A program without the example plugins does not know their stages.
            if "examples" in path.parts and not with_examples and kind == "scene" and path.parent.name not in IN_LENSES:
                if validators[kind].is_valid(read(path)):
                    faulty += 1
                    print(f"{path.relative_to(ROOT)}: is accepted without its plugin")
                continue
            if "examples" in path.parts and not with_examples:
                continue
            checked += 1
            for error in validators[kind].iter_errors(read(path)):
                faulty += 1
                print(f"{path.relative_to(ROOT)}: {said(error)}")
    for kind, name, where, value in BROKEN:
        document = read(ROOT / name)
        if not validators[kind].is_valid(document):
            continue
        at = document
        for step in where[:-1]:
            at = at[step]
        if value is None:
            at.pop(where[-1])
        else:
            at[where[-1]] = value
        if validators[kind].is_valid(document):
            faulty += 1
            print(f"{name}: {'/'.join(map(str, where))} = {value!r} is accepted")
    for kind, name, where, value in GOOD:
        document = read(ROOT / name)
        at = document
        for step in where[:-1]:
            at = at[step]
        at[where[-1]] = value
        for error in validators[kind].iter_errors(document):
            faulty += 1
            print(f"{name} with {'/'.join(map(str, where))} = {value!r}: {said(error)}")
    print(f"{checked} files against 4 schemas, {len(BROKEN)} broken ones: {faulty} faults")
    sys.exit(1 if faulty or checked < 50 else 0)


main()
