#!/usr/bin/env python3
"""Runs every bundled scene with a time limit and checks how it ends.

    xtask/time_limits.py PROGRAM [--limit 5] [--slack 1] [SCENE ...]

A scene must end within the limit and the slack (seconds), either with all of its files or with exit code 1 and the sentence that the
limit is too short. Prints one line for each scene; the exit code is 1 if one of them breaks the rule.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCENES = Path(__file__).resolve().parent.parent / "scenes"


def ending(program, scene, limit):
    """Returns the seconds, the exit code, the files and the last line of standard error."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        ran = subprocess.run(
            [program, "run", str(scene), "--time-limit", f"{limit}s", "--output", folder, "--quiet"],
            capture_output=True, text=True, check=False,
        )
        seconds = time.monotonic() - began
        files = sorted(file.name for file in Path(folder).iterdir())
        said = (ran.stderr.strip().splitlines() or [""])[-1]
        return seconds, ran.returncode, files, said


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--limit", type=float, default=5.0)
    parser.add_argument("--slack", type=float, default=1.0)
    arguments = parser.parse_args()
    bad = 0
    for scene in arguments.scenes or sorted(SCENES.glob("*.yaml")):
        seconds, code, files, said = ending(arguments.program, scene, arguments.limit)
        is_picture = code == 0 and any(not name.endswith(".json") for name in files)
        is_told = code == 1 and not files and "the time limit of" in said
        is_good = seconds <= arguments.limit + arguments.slack and (is_picture or is_told)
        bad += not is_good
        what = f"{len(files)} files" if is_picture else said
        print(f"{'ok ' if is_good else 'BAD'} {scene.stem}: {seconds:.1f} s, exit code {code}, {what}", flush=True)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
