#!/usr/bin/env python3
"""Writes crates/command/src/notices.txt: the licenses of all crates that are linked into the program, with their notices.

    xtask/notices.py            writes the file
    xtask/notices.py --check    checks that the file is up to date

Cargo lists these crates (`cargo metadata`, for the systems below, with the default features): the program's direct and indirect
dependencies, without build scripts, tests and procedural macros, whose code is not linked. The texts are the license files in the
crates' packages, as cargo has them on disk; identical texts are written once. If a crate offers a choice, a short license that contains
the copyright line is preferred to a long one.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "crates/command/src/notices.txt"
PROGRAM = "spectra-camera"
SYSTEMS = ["x86_64-unknown-linux-gnu", "aarch64-apple-darwin", "x86_64-pc-windows-msvc"]

# Licenses in order of preference, each with a pattern for the name of its file, in capitals.
LICENCES = [
    ("MIT", r"MIT"),
    ("ISC", r"ISC"),
    ("Zlib", r"ZLIB"),
    ("BSD-3-Clause", r"BSD"),
    ("BSD-2-Clause", r"BSD"),
    ("Unicode-3.0", r"UNICODE"),
    ("0BSD", r"0BSD"),
    ("Unlicense", r"UNLICENSE"),
    ("Apache-2.0", r"APACHE"),
]
ALLOWED = {name for name, _ in LICENCES}


def metadata(system):
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", system]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def linked():
    """Returns the packages that are linked on any of the systems, by name and version."""
    found = {}
    for system in SYSTEMS:
        data = metadata(system)
        packages = {p["id"]: p for p in data["packages"]}
        nodes = {n["id"]: n for n in data["resolve"]["nodes"]}
        todo = [p["id"] for p in data["packages"] if p["name"] == PROGRAM]
        seen = set(todo)
        while todo:
            here = todo.pop()
            for dep in nodes[here]["deps"]:
                package = packages[dep["pkg"]]
                is_macro = any("proc-macro" in target["kind"] for target in package["targets"])
                is_normal = any(kind["kind"] is None for kind in dep["dep_kinds"])
                if is_normal and not is_macro and package["id"] not in seen:
                    seen.add(package["id"])
                    todo.append(package["id"])
        for package in (packages[i] for i in seen):
            if package["source"] is not None:
                found[(package["name"], package["version"])] = package
    return found


def choices(expression):
    """Returns the sets of licenses that satisfy an SPDX expression, as OR of AND."""
    tokens = re.findall(r"\(|\)|[A-Za-z0-9.+-]+", expression.replace("/", " OR "))

    def either():
        sets = every()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            sets = sets + every()
        return sets

    def every():
        sets = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            more = one()
            sets = [a | b for a in sets for b in more]
        return sets

    def one():
        token = tokens.pop(0)
        if token == "(":
            sets = either()
            tokens.pop(0)
            return sets
        if tokens and tokens[0] == "WITH":
            tokens.pop(0)
            tokens.pop(0)
            # An exception removes an obligation. The expression offers the choice without it elsewhere.
            return [frozenset()] if token not in ALLOWED else [frozenset([token])]
        return [frozenset([token])]

    return either()


def chosen(package):
    rank = {name: at for at, (name, _) in enumerate(LICENCES)}
    sets = [s for s in choices(package["license"] or "") if s and s <= ALLOWED]
    if not sets:
        sys.exit(f"{package['name']}: the licence `{package['license']}` is not among those that are allowed")
    return sorted(min(sets, key=lambda s: (max(rank[name] for name in s), len(s))), key=rank.get)


def texts(package, licence):
    """Returns the files in the package that hold this license. A file `LICENSE` without a license name holds the only one."""
    folder = Path(package["manifest_path"]).parent
    pattern = dict(LICENCES)[licence]
    files = [f for f in sorted(folder.iterdir()) if f.is_file() and re.match(r"(LICEN[CS]E|COPYING|UNLICENSE)", f.name.upper())]
    named = [f for f in files if re.search(pattern, f.name.upper())]
    others = [name for name, _ in LICENCES if name != licence]
    plain = [f for f in files if not any(re.search(dict(LICENCES)[o], f.name.upper()) for o in others)]
    return [f.read_text(encoding="utf-8", errors="replace") for f in named or plain]


def tidy(text):
    return "\n".join(line.rstrip() for line in text.replace("\r\n", "\n").replace("\f", "").strip().split("\n"))


def notices():
    by_text = {}
    heads = []
    for (name, version), package in sorted(linked().items()):
        licences = chosen(package)
        people = [re.sub(r"\s*<[^>]*>", "", author) for author in package["authors"]]
        by = " by " + ", ".join(people) if people else ""
        heads.append(f"{name} {version}: {package['license']}")
        for licence in licences:
            found = [tidy(t) for t in texts(package, licence)]
            if not found:
                where = package["repository"] or "its package"
                found = [f"{licence}, as its package states; copyright{by or ' of its authors'} ({where})."]
            for text in found:
                by_text.setdefault((licence, text), []).append(f"{name} {version}")
    out = ["# Written by xtask/notices.py; changes are lost.", ""]
    out += heads + [""]
    order = sorted(by_text.items(), key=lambda item: ([n for n, _ in LICENCES].index(item[0][0]), item[1]))
    for (licence, text), crates in order:
        out += ["-" * 100, f"{licence}: " + ", ".join(crates), "", text, ""]
    return "\n".join(out)


def main():
    text = notices()
    if "--check" in sys.argv[1:]:
        if not OUTPUT.is_file() or OUTPUT.read_text(encoding="utf-8") != text:
            sys.exit(f"{OUTPUT.relative_to(ROOT)} is not of these crates: run xtask/notices.py")
        return
    OUTPUT.write_text(text, encoding="utf-8")
    print(f"{OUTPUT.relative_to(ROOT)}: {len(text.encode())} bytes")


main()
