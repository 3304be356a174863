"""Writes scenes/night-lights.exr and scenes/far-lights.exr: lamps in the dark, for pictures of out-of-focus highlights.

Each lamp is one pixel on black, placed by a fixed seed with a distance between lamps, in white, warm, red, green and blue as along a
street. The first file has sixty lamps; the second has twenty-six smaller ones, which show fine structure in a blur disk. R, G, B (linear,
Rec. 709) as 16-bit floats, ZIP compressed.

    python3 xtask/night_lights.py
"""

import pathlib
import random

import half_exr

# Width, height, number of lamps, least distance in pixels between them.
FILES = {"night-lights": (180, 120, 60, 9), "far-lights": (480, 320, 26, 52)}
TINTS = [(1, 0.9, 0.7), (1, 0.7, 0.35), (1, 0.12, 0.06), (0.15, 0.9, 0.3), (0.3, 0.5, 1), (1, 1, 1)]


def lamps(width, height, many, apart):
    dice = random.Random(7)
    placed = {}
    while len(placed) < many:
        x, y = dice.randrange(4, width - 4), dice.randrange(4, height - 4)
        if all((x - a) ** 2 + (y - b) ** 2 >= apart**2 for a, b in placed):
            power = 2 ** dice.uniform(-1.5, 0)
            placed[x, y] = tuple(power * c for c in dice.choice(TINTS))
    return placed


def main():
    scenes = pathlib.Path(__file__).resolve().parent.parent / "scenes"
    for name, (width, height, many, apart) in FILES.items():
        placed = lamps(width, height, many, apart)
        rows = [[placed.get((x, y), (0, 0, 0))[::-1] for x in range(width)] for y in range(height)]
        half_exr.write(scenes / f"{name}.exr", "Synthetic, by xtask/night_lights.py; CC0-1.0", "BGR", rows)


if __name__ == "__main__":
    main()
