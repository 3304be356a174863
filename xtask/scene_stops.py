#!/usr/bin/env python3
"""Measures how much the losses of its lens dim each stock scene, in stops.

The result is the mean exposure of a small, noisy frame with `lens.coating=ideal` and `lens.absorption=false` relative to that of the
unchanged scene, in log2, for each channel.

    python3 xtask/scene_stops.py target/release/spectra [SCENE ...]

Both renders use the same seed and the same rays, so they have the same noise. Sweeps are rendered as the scene that they start from.
"""

import math
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
IDEAL = ["lens.coating=ideal", "lens.absorption=false"]


def means(path):
    """Returns the mean of each channel of an EXR file of scan lines, uncompressed or ZIP compressed."""
    data = path.read_bytes()
    at, header = 8, {}
    while data[at]:
        end = data.index(0, at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(0, at)
        at = end + 1
        (size,) = struct.unpack_from("<i", data, at)
        header[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    at += 1
    channels, k = [], 0
    while header["channels"][k]:
        end = header["channels"].index(0, k)
        channels.append((header["channels"][k:end].decode(), struct.unpack_from("<i", header["channels"], end + 1)[0]))
        k = end + 17
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    lines = {0: 1, 2: 1, 3: 16}[header["compression"][0]]
    blocks = -(-height // lines)
    sums = dict.fromkeys((name for name, _ in channels), 0.0)
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        raw = data[offset + 8 : offset + 8 + size]
        rows = min(lines, y1 - y + 1)
        full = rows * width * sum(2 if kind == 1 else 4 for _, kind in channels)
        if size < full:
            raw = bytearray(zlib.decompress(raw))
            for i in range(1, len(raw)):
                raw[i] = (raw[i - 1] + raw[i] - 128) & 255
            half = (len(raw) + 1) // 2
            joined = bytearray(len(raw))
            joined[0::2], joined[1::2] = raw[:half], raw[half:]
            raw = bytes(joined)
        k = 0
        for _ in range(rows):
            for name, kind in channels:
                form, bytes_each = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}[kind]
                sums[name] += sum(struct.unpack_from(f"<{width}{form}", raw, k))
                k += width * bytes_each
    return {name: total / (width * height) for name, total in sums.items()}


def render(program, scene, sets):
    text = scene.read_text(encoding="utf-8")
    more = ["output=[exr]"] + [f"{key}=null" for key in ("sweep", "animation") if f"\n{key}:" in text]
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", str(scene), "-q", "--samples", "8", "-o", folder]
        for text in [*sets, *more, "render.rays=300000", "imager.resolution=[60, 40]"]:
            command += ["--set", text]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            return None
        (path,) = list(Path(folder).glob("*.exr"))[:1]
        return means(path)


def main():
    program = str(Path(sys.argv[1]).resolve())
    scenes = [Path(s) for s in sys.argv[2:]] or sorted(ROOT.glob("scenes/*.yaml")) + sorted(ROOT.glob("scenes/surfaces/*.yaml"))
    for scene in scenes:
        now, ideal = render(program, scene, []), render(program, scene, IDEAL)
        if not now or not ideal:
            print(f"{scene.stem}: not rendered")
            continue
        stops = [f"{name} {math.log2(now[name] / ideal[name]):+.2f}" for name in now if now[name] > 0 and ideal[name] > 0]
        print(f"{scene.stem}: {', '.join(stops)}")


if __name__ == "__main__":
    main()
