"""Writes scenes/night-lights.exr: lamps in the dark, for pictures of what a lens makes of lights out of focus.

Sixty lamps of one pixel each on black, placed by a fixed seed and at least 9 pixels apart, white, warm, red, green and blue
as along a street. R, G, B (linear, Rec. 709) as 16-bit floats, ZIP compressed.

    python3 xtask/night_lights.py
"""

import pathlib
import random
import struct

from depth_still_life import attribute, compressed

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
    channels = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", 1, 0, 1, 1) for n in "BGR") + b"\0"
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join(
        [
            attribute("channels", "chlist", channels),
            attribute("comments", "string", b"Synthetic, by xtask/night_lights.py; CC0-1.0"),
            attribute("compression", "compression", bytes([3])),
            attribute("dataWindow", "box2i", window),
            attribute("displayWindow", "box2i", window),
            attribute("lineOrder", "lineOrder", bytes([0])),
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
            attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
            b"\0",
        ]
    )
    blocks = []
    for first in range(0, HEIGHT, 16):
        raw = b""
        for y in range(first, min(first + 16, HEIGHT)):
            for of in (2, 1, 0):
                raw += struct.pack(f"<{WIDTH}e", *(placed.get((x, y), (0, 0, 0))[of] for x in range(WIDTH)))
        packed = compressed(raw)
        blocks.append(struct.pack("<ii", first, len(packed)) + packed)
    at = len(header) + 8 * len(blocks)
    offsets = b""
    for block in blocks:
        offsets += struct.pack("<Q", at)
        at += len(block)
    out = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "night-lights.exr"
    out.write_bytes(header + offsets + b"".join(blocks))
    print(out, out.stat().st_size, "bytes")


if __name__ == "__main__":
    main()
