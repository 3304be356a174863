#!/usr/bin/env python3
"""Measures how clean the edges of a rendered plate with depth are, compared with the same scene in two layers.

    VENV/bin/python xtask/plate_edges.py target/debug/spectra [FOLDER]

Needs numpy. The plates have 600 x 400 pixels, antialiased colors, and either the depth of one sample per pixel or averaged depth:

- a white card in focus at 1 m before a dark wall at 8 m, f/1.4. Printed: light of the wall near the card relative to that of the same
  card and wall as two layers, by distance from the edge in pixels of the frame;
- hair around a dark ball before that wall, the wall in focus: for visual inspection;
- threads of 0.7 and of 2 pixels at 1 m before the wall, the wall in focus. Printed: contrast relative to that of the same plate without
  depth.

Each is rendered by default and with `depth: {edges: as-is}`. With FOLDER, the pictures are kept there, also as PNG.
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

WIDTH, HEIGHT, FINE = 600, 400, 16
NEAR_M, FAR_M = 1.0, 8.0
CARD, WALL, THREAD = (1.0, 1.0, 1.0), (0.05, 0.06, 0.1), (0.02, 0.015, 0.01)
PALE = (0.5, 0.55, 0.6)
SCENE = """spectra: 1
source: {source}
lens: {{file: zeiss-biotar-50-f1.4, focus: {focus} m}}
imager: {{kind: xyz, format: 135, resolution: [{width}, {height}]}}
render: {{samples: {samples}, reflections: {{order: 0}}, diffraction: false}}
output: [png, exr]
"""
PLATE = "{{kind: picture, file: {name}.exr, distance: {distance} m, width: {wide} cm, luminance: 300 cd/m2{depth}}}"
LAYERS = (
    "{kind: layers, luminance: 300 cd/m2, layers: [{file: card.exr, distance: 1 m, width: 84 cm}, "
    "{file: wall.exr, distance: 8 m, width: 672 cm}]}"
)


def plate(path, near, front, back, averaged=False, cover=False):
    """Writes a plate. `near` says for each of its fine pixels whether it belongs to the foreground."""
    share = near.reshape(HEIGHT, FINE, WIDTH, FINE).mean((1, 3))
    sample = share if averaged else near[FINE // 2 :: FINE, FINE // 2 :: FINE].astype(float)
    mix = lambda part: [part * front[k] + (1 - part) * back[k] for k in range(3)]
    red, green, blue = mix(share)
    if cover:
        names, planes = "ABGR", [share, share * front[2], share * front[1], share * front[0]]
    else:
        names, planes = "BGRZ", [blue, green, red, sample * NEAR_M + (1 - sample) * FAR_M]
    with contextlib.redirect_stdout(io.StringIO()):
        half_exr.write(path, "xtask/plate_edges.py", names, np.stack(planes, -1).tolist())
    return share


def render(program, folder, name, source, focus, samples):
    scene = folder / f"{name}.yaml"
    scene.write_text(SCENE.format(source=source, focus=focus, width=WIDTH, height=HEIGHT, samples=samples))
    done = subprocess.run([program, "run", str(scene), "-q", "-o", str(folder)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return exr_lines.read(folder / f"{name}.exr")["Y"]


def source(name, distance, depth):
    wide = 84 * distance
    return PLATE.format(name=name, distance=distance, wide=wide, depth=depth)


def cards(program, folder, x, y):
    near = x < 260 + (y - 200) * 0.18
    plate(folder / "card.exr", near, CARD, WALL, cover=True)
    plate(folder / "wall.exr", near, WALL, WALL)
    layers = render(program, folder, "card-layers", LAYERS, 1, 64)
    # Edge in the frame: half of the card's light, fitted by a straight line through all rows.
    half = 0.5 * (np.median(layers[:, :100]) + np.median(layers[:, -100:]))
    rows = np.arange(HEIGHT)
    edge = np.array([WIDTH - np.argmax(row[::-1] > half) for row in layers])
    edge = np.polyval(np.polyfit(rows, edge, 1), rows)
    off = np.arange(WIDTH)[None, :] + 0.5 - edge[:, None]
    bands = [(3, 4), (4, 6), (6, 10), (10, 20), (20, 40)]
    print("light beside the card over that of layers, pixels", ", ".join(f"{a} to {b}" for a, b in bands))
    for averaged in (False, True):
        name = "card-averaged" if averaged else "card-sampled"
        plate(folder / f"{name}-plate.exr", near, CARD, WALL, averaged=averaged)
        for edges in ("clean", "as-is"):
            depth = f", depth: {{unit: m, edges: {edges}}}"
            seen = render(program, folder, f"{name}-{edges}", source(f"{name}-plate", 1, depth), 1, 64)
            ratios = [seen[m].mean() / layers[m].mean() for m in ((off >= a) & (off < b) for a, b in bands)]
            print(f"  {name[5:]}, {edges}:", ", ".join(f"{r:.3f}" for r in ratios))


def detail(frame, reach):
    """Returns the relative deviation of each pixel from the mean of its neighbors in the row."""
    smooth = np.apply_along_axis(np.convolve, 1, frame, np.ones(reach) / reach, "same")
    return frame / smooth - 1


def threads(program, folder, x, y):
    print("contrast of threads at 1 m before the wall in focus over that of the plate")
    for width, period in ((0.7, 12), (2, 8), (2, 4)):
        near = (x + 0.1 * y) % period < width
        for averaged in (False, True):
            name = f"threads-{width}-{period}-{'averaged' if averaged else 'sampled'}"
            plate(folder / f"{name}-plate.exr", near, THREAD, PALE, averaged=averaged)
            flat = render(program, folder, f"{name}-flat", source(f"{name}-plate", 8, ""), 8, 16)
            for edges in ("clean", "as-is"):
                depth = f", depth: {{unit: m, edges: {edges}}}"
                seen = render(program, folder, f"{name}-{edges}", source(f"{name}-plate", 8, depth), 8, 64)
                a, b = (detail(frame, 2 * period)[60:-60, 80:-80] for frame in (flat, seen))
                print(f"  {width} pixels every {period}, {name.split('-')[-1]}, {edges}: {(a * b).sum() / (a * a).sum():.4f}")


def hair(program, folder):
    """Renders a ball with hair of 0.3 to 1.2 pixels."""
    random = np.random.default_rng(7)
    y, x = (np.mgrid[: HEIGHT * FINE, : WIDTH * FINE] + 0.5) / FINE
    near = (x - 300) ** 2 + (y - 230) ** 2 < 90**2
    along = np.linspace(0, 1, 4000)
    for _ in range(400):
        turn, long, bend, wide = random.uniform((-3.4, 20, -1.2, 0.3), (0.3, 90, 1.2, 1.2))
        way = turn + bend * along
        column = 300 + np.cos(turn) * 88 + np.cumsum(np.cos(way)) * long / 4000
        row = 230 + np.sin(turn) * 88 + np.cumsum(np.sin(way)) * long / 4000
        reach = np.maximum(wide * (1 - 0.7 * along) * FINE / 2, 0.5).astype(int)
        for dy in range(-10, 11):
            for dx in range(-10, 11):
                inside = dx * dx + dy * dy <= reach**2
                near[(row[inside] * FINE).astype(int) + dy, (column[inside] * FINE).astype(int) + dx] = True
    for averaged in (False, True):
        name = f"hair-{'averaged' if averaged else 'sampled'}"
        plate(folder / f"{name}-plate.exr", near, (0.08, 0.05, 0.03), PALE, averaged=averaged)
        for edges in ("clean", "as-is"):
            depth = f", depth: {{unit: m, edges: {edges}}}"
            for focus in (NEAR_M, FAR_M):
                render(program, folder, f"{name}-{edges}-{focus:.0f}m", source(f"{name}-plate", FAR_M, depth), focus, 64)


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else temporary).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        y, x = (np.mgrid[: HEIGHT * FINE, : WIDTH * FINE] + 0.5) / FINE
        cards(program, folder, x, y)
        if len(sys.argv) > 2:
            hair(program, folder)
        threads(program, folder, x, y)


if __name__ == "__main__":
    main()
