#!/usr/bin/env python3
"""Develops given photographs with `spectra film develop` and compares lightness before and after, and clipping to black or white.

Run from the root of the repository, with a folder of photographs (JPEG, PNG), numpy and Pillow:

    VENV/bin/python xtask/photographs.py target/release/spectra FOLDER [OUT]

For seven widely available photographs (astronaut, rocket, coffee and chelsea of scikit-image, grace_hopper of matplotlib, china and
flower of scikit-learn) the script reports which exceed the limits:
- the median L* is within 7 of the photograph's (within 11 for rocket, grace_hopper and flower), the 95th percentile within 12;
- the share of pixels within 1 L* of the medium's black is at most the share of the photograph below L* 8 plus 2 %;
- the share within 1 L* of its white is at most the share of the photograph above L* 97 plus 2 %.
Then it develops a render with lamps of 1000 times white on 0.5 % of it. The median L* of the result must be 20 to 45.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

STOCKS = ("kodak-portra-400", "kodak-vision3-250d-5207", "kodak-ektachrome-100d", "kodak-tri-x-400")
HARD = ("rocket", "grace_hopper", "flower")


def linear(code):
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def lightness(path):
    """Returns L* of each pixel of an sRGB-encoded file."""
    rgb = np.asarray(Image.open(path).convert("RGB")).astype(float) / 255
    y = linear(rgb) @ np.array([0.2126, 0.7152, 0.0722])
    return np.where(y > 216 / 24389, 116 * np.cbrt(y) - 16, y * 24389 / 27)


def developed(program, photograph, stock, out, *more):
    done = subprocess.run([program, "film", "develop", photograph, "--stock", stock, "-o", out, *more], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return done.stdout + done.stderr


def gray(photograph, folder):
    """Returns the photograph without color, for the comparison with a black-and-white film."""
    rgb = np.asarray(Image.open(photograph).convert("RGB")).astype(float) / 255
    y = linear(rgb) @ np.array([0.2126, 0.7152, 0.0722])
    code = np.where(y <= 0.0031308, 12.92 * y, 1.055 * np.maximum(y, 1e-9) ** (1 / 2.4) - 0.055)
    path = Path(folder) / f"{photograph.stem}-gray.png"
    Image.fromarray(np.repeat((255 * code + 0.5).astype(np.uint8)[..., None], 3, 2)).save(path)
    return path


def ends(program, stock, folder):
    """Returns L* of the medium's black and white, from a photograph that is half black and half far above white."""
    path = Path(folder) / "ends.png"
    both = np.zeros((64, 128, 3), np.uint8)
    both[:, 64:] = 255
    Image.fromarray(both).save(path)
    out = Path(folder) / "ends-out.png"
    plain = ("--grain", "off", "--halation", "off", "--set", "film.scatter=false", "--set", "film.optics=off")
    developed(program, path, stock, out, "--exposure", "6", *plain)
    return [float(np.median(lightness(out)[:, part])) for part in (slice(8, 56), slice(72, 120))]


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    failed = 0
    with tempfile.TemporaryDirectory() as temporary:
        out_folder = Path(sys.argv[3]) if len(sys.argv) > 3 else Path(temporary)
        out_folder.mkdir(exist_ok=True, parents=True)
        for stock in STOCKS:
            black, white = ends(program, stock, temporary)
            print(f"{stock}: black at L* {black:.1f}, white at {white:.1f}")
            for photograph in sorted(p for p in folder.iterdir() if p.suffix in (".png", ".jpg")):
                given = gray(photograph, temporary) if stock == "kodak-tri-x-400" else photograph
                out = out_folder / f"{photograph.stem}-{stock}.png"
                developed(program, given, stock, out)
                before, after = lightness(given), lightness(out)
                median, high = (np.percentile(after, q) - np.percentile(before, q) for q in (50, 95))
                blacks = 100 * ((after < black + 1).mean() - (before < 8).mean())
                whites = 100 * ((after > white - 1).mean() - (before > 97).mean())
                bound = 11 if photograph.stem in HARD else 7
                is_good = abs(median) <= bound and abs(high) <= 12 and blacks <= 2 and whites <= 2
                failed += not is_good
                print(f"  {'ok ' if is_good else 'NOT'} {photograph.stem:13} median {median:+5.1f}, 95 % {high:+5.1f}, "
                      f"black {blacks:+5.1f} %, white {whites:+5.1f} %")
        failed += not lamps(program, temporary, out_folder)
    print("all within bounds" if not failed else f"{failed} out of bounds")
    sys.exit(bool(failed))


def lamps(program, folder, out_folder):
    """Writes a render of grays with lamps of 1000 times white on 0.5 % of it, as Radiance HDR."""
    height, width = 120, 200
    random = np.random.default_rng(1)
    light = 0.18 * 2.0 ** random.uniform(-3, 2, (height // 8, width // 8)).repeat(8, 0).repeat(8, 1)
    at = random.choice(height * width, height * width // 200, replace=False)
    light.ravel()[at] = 1000
    path = Path(folder) / "lamps.hdr"
    mantissa, exponent = np.frexp(light)
    pixel = np.stack([(mantissa * 256).astype(np.uint8)] * 3 + [(exponent + 128).astype(np.uint8)], -1)
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode() + pixel.tobytes())
    out = out_folder / "lamps.png"
    said = developed(program, path, "kodak-vision3-250d-5207", out)
    median = float(np.median(lightness(out)))
    line = next((line for line in said.splitlines() if "metered" in line), "")
    is_good = 20 <= median <= 45 and "stops" in line and "camera" in line
    print(f"lamps: {'ok' if is_good else 'NOT'} median L* {median:.1f}; {line}")
    return is_good


if __name__ == "__main__":
    main()
