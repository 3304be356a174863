#!/usr/bin/env python3
"""Measures the noise of bright things out of focus: the disks of `onion-rings`, and a window at three times white.

    VENV/bin/python xtask/speckle.py target/debug/spectra [FOLDER] [--samples N]

Needs numpy. Run from the root of the repository. With FOLDER, the pictures are kept there.

- `onion-rings` with its defaults, and again with another seed. For the disk nearest to the middle of the frame, within nine tenths of
  its radius, the script prints the standard deviation about the mean of each ring, relative to that mean, by channel. The rings have a
  center of their own, which the script finds. Then it prints the difference of the two seeds over the square root of two, which is pure
  noise.
- the window, out of focus, with 64 samples by default: in blocks of 12 x 12 pixels inside it, across its bars and at its edges, the
  standard deviation about a plane fitted to each block, of Y and of the ratios X/Y and Z/Y, which show as colored dots.
"""

import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import exr_lines
import half_exr

WINDOW = """spectra: 1
source: {{kind: picture, file: window.exr, distance: 6 m, width: fill, illuminant: D65, luminance: 200 cd/m2}}
lens: {{file: zeiss-biotar-50-f1.4, focus: 0.5 m}}
imager: {{kind: xyz, format: 135, resolution: [600, 400]}}
render: {{samples: {samples}}}
output: [png, exr]
"""
BLOCK = 12
# Left, right, top and bottom of each part, in pixels of the frame.
PARTS = {"inside": (110, 160, 60, 105), "bars": (188, 224, 60, 108), "edges": (335, 359, 60, 240)}


def run(program, folder, scene, *settings):
    name = pathlib.Path(scene).stem
    out = folder / "-".join([name, *(s.split("=")[1] for s in settings)])
    more = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run([program, "run", str(scene), "-q", *more, "-o", str(out)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return exr_lines.read(out / f"{name}.exr")


def about_rings(plane, inside, middle, y, x):
    """Returns the relative deviation of each pixel from the mean of its ring."""
    radius = np.hypot(x - middle[0], y - middle[1])[inside]
    ring = radius.astype(int)
    values = plane[inside]
    means = np.bincount(ring, values) / np.maximum(np.bincount(ring), 1)
    return values / np.interp(radius, np.arange(len(means)) + 0.5, means) - 1


def disk(program, folder):
    both = [run(program, folder, "onion-rings", f"render.seed={seed}") for seed in (1, 2)]
    light = both[0]["Y"]
    height, width = light.shape
    y, x = np.mgrid[:height, :width] + 0.5
    lit = light > 0.05 * np.percentile(light, 99)
    near = lit & (np.hypot(x - width / 2, y - height / 2) < 120)
    # Light of other disks at the rim of the search does not count: the disk is the light around the common center.
    for _ in range(4):
        middle = [x[near].mean(), y[near].mean()]
        size = np.sqrt(near.sum() / np.pi)
        near = lit & (np.hypot(x - middle[0], y - middle[1]) < 1.15 * size)
    inside = np.hypot(x - middle[0], y - middle[1]) < 0.9 * size
    steps = np.linspace(-6, 6, 25)
    places = [(middle[0] + a, middle[1] + b) for a in steps for b in steps]
    rings = min(places, key=lambda place: about_rings(light, inside, place, y, x).std())
    print(f"disk of onion-rings, radius {size:.1f} pixels, rings about ({rings[0] - middle[0]:+.1f}, {rings[1] - middle[1]:+.1f})")
    for channel in "XYZ":
        own = about_rings(both[0][channel], inside, rings, y, x).std()
        a, b = (frame[channel][inside] for frame in both)
        seeds = ((a - b) / (a + b)).std() * np.sqrt(2)
        print(f"  {channel}: {own:.4f} about the mean of each ring, {seeds:.4f} between seeds")


def write_window(path):
    """Writes a picture of a window with bars in a dim room with a dark floor, and a lit picture on the wall."""
    rows = []
    for y in range(240):
        row = []
        for x in range(360):
            wall = 0.10 + 0.06 * x / 360 - 0.03 * y / 240
            color = (wall, 0.85 * wall, 0.7 * wall) if y <= 185 else (0.05, 0.035, 0.025)
            if 60 <= x < 200 and 30 <= y < 150:
                glass = 5 <= (x - 60) % 70 < 65 and 5 <= (y - 30) % 60 < 55
                color = (2.6, 2.95, 3.6) if glass else (0.2, 0.19, 0.17)
            if 270 <= x < 300 and 90 <= y < 120:
                color = (1.6, 1.1, 0.6)
            row.append(color[::-1])
        rows.append(row)
    with contextlib.redirect_stdout(io.StringIO()):
        half_exr.write(path, "xtask/speckle.py", "BGR", rows)


def about_plane(block):
    y, x = np.mgrid[: block.shape[0], : block.shape[1]]
    terms = np.stack([np.ones(block.size), x.ravel(), y.ravel(), (x * x).ravel(), (x * y).ravel(), (y * y).ravel()], -1)
    fit = terms @ np.linalg.lstsq(terms, block.ravel(), rcond=None)[0]
    return ((block.ravel() - fit) / fit.mean()).tolist()


def window(program, folder, samples):
    write_window(folder / "window.exr")
    scene = folder / "window.yaml"
    scene.write_text(WINDOW.format(samples=samples))
    frame = run(program, folder, scene)
    planes = {"Y": frame["Y"], "X/Y": frame["X"] / frame["Y"], "Z/Y": frame["Z"] / frame["Y"]}
    print(f"window at 3 times white, {samples} samples, about a curved plane in each block")
    for part, (left, right, top, bottom) in PARTS.items():
        said = []
        for name, plane in planes.items():
            off = []
            for row in range(top, bottom - BLOCK + 1, BLOCK):
                for column in range(left, right - BLOCK + 1, BLOCK):
                    off += about_plane(plane[row : row + BLOCK, column : column + BLOCK])
            said.append(f"{name} {np.std(off):.4f}")
        print(f"  {part}:", ", ".join(said))


def main():
    words = sys.argv[1:]
    samples = 64
    if "--samples" in words:
        at = words.index("--samples")
        samples = int(words[at + 1])
        del words[at : at + 2]
    program = str(pathlib.Path(words[0]).resolve())
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(words[1] if len(words) > 1 else temporary).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        disk(program, folder)
        window(program, folder, samples)


if __name__ == "__main__":
    main()
