"""Writes scenes/night-lights.exr: lamps in the dark, for pictures of what a lens makes of lights out of focus.

Sixty lamps of one pixel each on black, placed by a fixed seed and at least 9 pixels apart, white, warm, red, green and blue
as along a street. R, G, B (linear, Rec. 709) as 16-bit floats, ZIP compressed.

    python3 xtask/night_lights.py
"""

import pathlib
import random

import half_exr

WIDTH, HEIGHT, LAMPS, APART = 180, 120, 60, 9
TINTS = [(1, 0.9, 0.7), (1, 0.7, 0.35), (1, 0.12, 0.06), (0.15, 0.9, 0.3), (0.3, 0.5, 1), (1, 1, 1)]


def lamps():
    dice = random.Random(7)
    placed = {}
    while len(placed) < LAMPS:
        x, y = dice.randrange(4, WIDTH - 4), dice.randrange(4, HEIGHT - 4)
        if all((x - a) ** 2 + (y - b) ** 2 >= APART**2 for a, b in placed):
            power = 2 ** dice.uniform(-1.5, 0)
            placed[x, y] = tuple(power * c for c in dice.choice(TINTS))
    return placed


def main():
    placed = lamps()
    rows = [[placed.get((x, y), (0, 0, 0))[::-1] for x in range(WIDTH)] for y in range(HEIGHT)]
    out = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "night-lights.exr"
    half_exr.write(out, "Synthetic, by xtask/night_lights.py; CC0-1.0", "BGR", rows)


if __name__ == "__main__":
    main()
