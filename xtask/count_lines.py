#!/usr/bin/env python3
"""Counts lines of code by folder, and the total: Rust and the C++ of the bridge, without tests, comments and blank lines.

    xtask/count_lines.py                counts the working tree
    xtask/count_lines.py --commit NAME  counts a commit as git has it
    xtask/count_lines.py --all          also prints a line for every folder below the crates

The script counts the files that git tracks below src/, crates/ and plugins/, except plugins/examples. It does not count

- blank lines, and lines that hold only a comment (`//`, `///`, `//!`, `/* */`) or a part of one;
- tests: folders `tests`, `benches` and `examples` of a crate, items under `#[cfg(test)]`, `#[cfg(all(test, ..))]` or `#[test]`,
  and the files of modules that are declared in this way (`#[cfg(test)] mod tests;`);
- texts: a file that is compiled in by `include_str!` is not Rust.

Every line inside a string counts, even if it looks like a comment.
"""

import argparse
import re
import subprocess
from collections import Counter
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent

TOKEN = re.compile(
    r"""(?P<line>//[^\n]*)
      | (?P<block>/\*)
      | (?P<raw>\b(?:br|r|cr)(?P<hashes>\#*)"(?:.*?)"(?P=hashes))
      | (?P<string>"(?:\\.|[^"\\])*")
      | (?P<char>'(?:\\(?:x..|u\{[^}]*\}|.)|[^\\'\n])')""",
    re.VERBOSE | re.DOTALL,
)


def end_of_block_comment(text, start):
    """Returns the end of a block comment. Block comments of Rust nest."""
    depth = 0
    for mark in re.finditer(r"/\*|\*/", text[start:]):
        depth += 1 if mark.group() == "/*" else -1
        if depth == 0:
            return start + mark.end()
    return len(text)


def bare(text):
    """Returns the text without comments. Every character of a string except line breaks becomes an `_`."""
    out, at = [], 0
    while found := TOKEN.search(text, at):
        out.append(text[at:found.start()])
        at = found.end()
        if found.lastgroup == "block" or found.group("block"):
            at = end_of_block_comment(text, found.start())
            out.append("\n" * text.count("\n", found.start(), at))
        elif not found.group("line"):
            out.append(re.sub(r"[^\n]", "_", found.group()))
    out.append(text[at:])
    return "".join(out)


def attribute_end(text, start):
    depth = 0
    for i in range(start + 1, len(text)):
        depth += {"[": 1, "]": -1}.get(text[i], 0)
        if depth == 0:
            return i + 1
    return len(text)


def is_for_tests(attribute):
    words = re.findall(r"\w+", attribute)
    return words == ["test"] or words[:1] == ["cfg"] and "test" in words and not {"not", "any"} & set(words)


def item_end(text, start):
    """Returns the position behind the first block, or behind the first semicolon outside all brackets."""
    depth = 0
    for i in range(start, len(text)):
        depth += {"{": 1, "(": 1, "[": 1, "}": -1, ")": -1, "]": -1}.get(text[i], 0)
        if depth == 0 and text[i] in "};":
            return i + 1
    return len(text)


def without_tests(code):
    """Returns the code without its test items, and the names of the test modules that have files of their own."""
    out, modules, at = [], [], 0
    while (start := code.find("#[", at)) >= 0:
        end = attribute_end(code, start)
        if is_for_tests(code[start:end]):
            out.append(code[at:start])
            at = item_end(code, end)
            if name := re.search(r"\bmod\s+(\w+)\s*;$", code[end:at]):
                modules.append(name.group(1))
        else:
            out.append(code[at:end])
            at = end
    out.append(code[at:])
    return "".join(out), modules


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def files(commit):
    folders = ["src", "crates", "plugins"]
    if commit:
        names = git("ls-tree", "-r", "--name-only", commit, "--", *folders)
    else:
        names = git("ls-files", "--", *folders)
    for name in names.splitlines():
        path = PurePosixPath(name)
        if path.suffix not in (".rs", ".cc", ".h") or path.parts[:2] == ("plugins", "examples"):
            continue
        if {"tests", "benches", "examples"} & set(path.parts[2:3]):
            continue
        if commit:
            yield path, git("show", f"{commit}:{name}")
        elif (ROOT / path).is_file():
            yield path, (ROOT / path).read_text(encoding="utf-8")


def counted(commit):
    lines, skipped = {}, set()
    for path, text in files(commit):
        code, modules = without_tests(bare(text))
        inside = path.parent if path.stem in ("lib", "main", "mod") else path.parent / path.stem
        for module in modules:
            skipped |= {inside / f"{module}.rs", inside / module}
        lines[path] = sum(1 for line in code.splitlines() if line.strip())
    return {path: n for path, n in lines.items() if path not in skipped and not skipped & set(path.parents)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--commit", help="count this commit instead of the working tree")
    parser.add_argument("--all", action="store_true", help="also print the folders within the crates")
    arguments = parser.parse_args()
    sums = Counter()
    for path, number in counted(arguments.commit).items():
        depth = 1 if path.parts[0] == "src" else 2
        sums["/".join(path.parts[:-1] if arguments.all else path.parts[:depth])] += number
    for folder in sorted(sums):
        print(f"{sums[folder]:8}  {folder}")
    print(f"{sum(sums.values()):8}  in all")


if __name__ == "__main__":
    main()
