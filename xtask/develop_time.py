#!/usr/bin/env python3
"""Develops a JPEG file of 24 megapixels on some stocks, with all effects, and prints processor time, wall time and memory.

Run from the root of the repository, with numpy and Pillow, after `cargo build --release`:

    VENV/bin/python xtask/develop_time.py [--stocks tri-x 5207] [--frames 1] [--program target/release/spectra] [-- --lens helios-44-58-f2]

Wall time only means something if nothing else runs on the machine. The limits on two cores are 10 s and 1.5 GB for each picture, and
90 s with `--lens` at 1 % noise. `--frames` sets the number of pictures that are developed in one run; more than two must not need
more memory than two. Arguments after `--` go to `spectra film develop`. The exit code is 1 if memory or wall time exceeds its limit.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image

WIDTH, HEIGHT = 6000, 4000
MOST_MB, MOST_S, MOST_LENS_S = 1500, 10, 90


def photograph(path):
    """Writes a picture that is hard for codecs and tables: patches of color with fine structure, noise and lamps."""
    chance = np.random.default_rng(24)
    patches = (chance.random((HEIGHT // 100, WIDTH // 100, 3)) * 200 + 20).astype(np.uint8)
    picture = np.asarray(Image.fromarray(patches).resize((WIDTH, HEIGHT), Image.Resampling.BICUBIC)).astype(np.int16)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    picture = picture + (20 * np.sin(x / 7) * np.sin(y / 11)).astype(np.int16)[..., None]
    for row, column in zip(chance.integers(6, HEIGHT - 6, 60), chance.integers(6, WIDTH - 6, 60)):
        picture[row - 6:row + 6, column - 6:column + 6] = 255
    picture += chance.integers(-4, 5, size=picture.shape, dtype=np.int16)
    Image.fromarray(np.clip(picture, 0, 255).astype(np.uint8)).save(path, quality=92)


def developed(program, pictures, stock, more, folder):
    """Returns the processor time (s), wall time (s) and memory (MB) of one run."""
    out = folder / "out.png" if len(pictures) == 1 else folder / f"out-{stock}"
    begun = time.monotonic()
    child = subprocess.Popen([program, "film", "develop", *pictures, "--stock", stock, "-o", out, *more],
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = child.stderr.read().decode()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(said)
    return used.ru_utime + used.ru_stime, time.monotonic() - begun, used.ru_maxrss / 1000


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stocks", nargs="+", default=["tri-x", "5207", "portra-400", "ektachrome"])
    parser.add_argument("--frames", type=int, default=1)
    parser.add_argument("--program", default="target/release/spectra")
    at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    arguments, more = parser.parse_args(sys.argv[1:at]), sys.argv[at + 1:]
    most_s = MOST_LENS_S if "--lens" in more else MOST_S
    is_good = True
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        photograph(folder / "frame.0001.jpg")
        pictures = [folder / "frame.0001.jpg"]
        for number in range(2, arguments.frames + 1):
            pictures.append(folder / f"frame.{number:04}.jpg")
            pictures[-1].symlink_to(pictures[0])
        for stock in arguments.stocks:
            used_s, wall_s, mb = developed(arguments.program, pictures, stock, more, folder)
            used_s, wall_s = used_s / len(pictures), wall_s / len(pictures)
            print(f"{stock}: {used_s:.1f} s of processors, {wall_s:.1f} s, {mb:.0f} MB")
            is_good &= mb <= MOST_MB and wall_s <= most_s
    sys.exit(not is_good)


if __name__ == "__main__":
    main()
