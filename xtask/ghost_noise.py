#!/usr/bin/env python3
"""Measures noise and bias of ghosts in three scenes at their defaults: footprints against rays that add to one pixel each.

    python3 xtask/ghost_noise.py target/release/spectra [SCENE ...] [--times 30]

Needs numpy. For each scene the script renders only the layer of the ghosts, with `render.reflections.spread` `footprint` and `none`, and
with `none` and `--times` times the samples (the reference, which takes nearly all of the time). It prints, for red, green and blue:

noise      standard deviation about the plane fitted to each block of 16 x 16 pixels, relative to the block's mean: the median of blocks
           over 8 pixels from edges and caustics, and the 90th percentile
means      block means of footprints relative to those of the reference, less 1: root mean square, and the part of blocks within 2 %;
           then the same numbers for `none` with as many rays
totals     light of each of the strongest paths with more than 1 % of the ghosts, footprints relative to `none` with the same rays, less 1
edges      blur that best turns the reference into the footprints in blocks with edges: sigma of a Gaussian, pixels
seconds    processor time of both ways, without layers of single paths
"""

import argparse
import re
import resource
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import exr_lines

ROOT = Path(__file__).resolve().parent.parent
# Rows of blocks that are compared, as fractions of the frame: grass below the sky, sky above the street. The zoom's whole frame has
# grass or sky.
SCENES = {"sun-biotar": (0.55, 1.0), "sun-zoom": (0.55, 1.0), "night-street": (0.0, 0.4)}
PATHS = 12
SIDE = 16
FAR = 8
# Blocks with less light than this fraction of the median are ignored.
DARK = 0.01
COLORS = ("red", "green", "blue")


def rendered(program, scene, folder, *sets, paths=PATHS):
    """Returns the layers of a scene, and the processor time, s."""
    output = f"output=[{{kind: exr, layers: [direct, ghosts]{f', ghost-paths: {paths}' if paths else ''}}}]"
    command = [program, "run", scene, "--set", "sweep=null", "--set", output, "-o", folder]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command + [a for s in sets for a in ("--set", s)], cwd=ROOT, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    (path,) = Path(folder).glob("*.exr")
    return exr_lines.read(path), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ghosts(planes):
    """Returns the light of all ghosts, one plane for each color, and the light of each path."""
    paths = sorted({name.rsplit(".", 1)[0] for name in planes if "ghost" in name.lower()})
    each = {path: np.stack([planes[f"{path}.{color}"] for color in COLORS]) for path in paths}
    whole = each.pop("ghosts") if "ghosts" in each else sum(each.values())
    return whole, each


def blocks(image):
    """Cuts an image into whole blocks. Returns their pixels for each color."""
    colors, height, width = image.shape
    rows, columns = height // SIDE, width // SIDE
    cut = image[:, : rows * SIDE, : columns * SIDE].reshape(colors, rows, SIDE, columns, SIDE)
    return cut.transpose(0, 1, 3, 2, 4).reshape(colors, rows, columns, SIDE * SIDE)


def noise(image):
    """Returns the standard deviation about a plane relative to the mean, for each block."""
    y, x = np.mgrid[:SIDE, :SIDE] - (SIDE - 1) / 2
    plane, _ = np.linalg.qr(np.stack([np.ones(SIDE * SIDE), x.ravel(), y.ravel()], 1))
    pixels = blocks(image)
    left = pixels - (pixels @ plane) @ plane.T
    return left.std(-1) / np.maximum(pixels.mean(-1), 1e-30)


def blurred(image, sigma):
    if sigma == 0:
        return image
    reach = int(4 * sigma) + 1
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    weights /= weights.sum()
    for axis in (1, 2):
        padded = np.pad(image, [(0, 0)] + [(reach, reach) if a == axis else (0, 0) for a in (1, 2)], "symmetric")
        image = sum(w * np.take(padded, range(k, k + image.shape[axis]), axis) for k, w in enumerate(weights))
    return image


def edges(reference):
    """Marks blocks near an edge or a caustic: the slightly blurred reference changes there by more than its noise."""
    smooth = blurred(reference, 2.0).sum(0)
    step = np.maximum(np.abs(np.gradient(smooth, axis=0)), np.abs(np.gradient(smooth, axis=1)))
    is_edge = step > 0.04 * np.maximum(smooth, 1e-30)
    near = blurred(is_edge[None].astype(float), FAR / 2)[0] > 0.02
    return blocks(near[None].astype(float))[0].max(-1) > 0


def shown(values, digits=2):
    return ", ".join(f"{100 * v:.{digits}f} %" for v in values)


def report(program, scene, times):
    low, high = SCENES[scene]
    text = (ROOT / f"scenes/{scene}.yaml").read_text()
    samples = int(re.search(r"^render: .*samples: (\d+)", text, re.M).group(1))
    with tempfile.TemporaryDirectory() as a, tempfile.TemporaryDirectory() as b, tempfile.TemporaryDirectory() as c:
        none = "render.reflections.spread=none"
        seconds, before = (rendered(program, scene, c, *sets, paths=0)[1] for sets in ([], [none]))
        (ours, _), (plain, _) = rendered(program, scene, a), rendered(program, scene, b, none)
        many, _ = rendered(program, scene, c, none, f"render.samples={times * samples}")
    (ours, by_path), (plain, plain_paths), (many, _) = map(ghosts, (ours, plain, many))
    rows = blocks(many).shape[1]
    part = np.zeros(blocks(many).shape[1:3], bool)
    part[int(low * rows) : int(high * rows)] = True
    # Blocks with hardly any light have no meaningful relative error.
    light = blocks(many).mean(-1).min(0)
    part &= light > DARK * np.median(light)
    edge = edges(many)
    print(f"{scene}: {part.sum()} blocks, {(part & edge).sum()} of them near edges")
    for name, image in (("footprint", ours), ("none", plain)):
        found = noise(image)[:, part & ~edge]
        print(f"  noise   {name}: {shown(np.median(found, 1))}; 90th percentile {shown(np.percentile(found, 90, 1))}")
    want = blocks(many).mean(-1)[:, part]
    for name, image in (("footprint", ours), ("none", plain)):
        apart = blocks(image).mean(-1)[:, part] / np.maximum(want, 1e-30) - 1
        within = (np.abs(apart) < 0.02).mean(1)
        print(f"  means   {name}: {shown(np.sqrt((apart**2).mean(1)))}; within 2 %: {shown(within, 0)}; mean {shown(apart.mean(1))}")
    share = plain.sum()
    for path, light in by_path.items():
        total = plain_paths[path].sum((1, 2))
        if total.sum() > 0.01 * share:
            print(f"  totals  {path}: {shown(light.sum((1, 2)) / total - 1, 5)}")
    where = np.kron(edge & part, np.ones((SIDE, SIDE), bool))
    cut = lambda image: image[:, : where.shape[0], : where.shape[1]][:, where]
    sigmas = np.arange(0, 4.1, 0.25)
    errors = [((cut(blurred(many, s)) - cut(ours)) ** 2).sum() for s in sigmas]
    print(f"  edges   blurred by {sigmas[int(np.argmin(errors))]:.2f} pixels")
    print(f"  seconds {seconds:.1f}, before {before:.1f}: {seconds / before:.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--times", type=int, default=30)
    chosen = parser.parse_args()
    for scene in chosen.scenes or SCENES:
        report(str(Path(chosen.program).resolve()), scene, chosen.times)


main()
