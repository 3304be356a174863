"""Makes pictures for the tests of crates/pictures: printing inks (CMYK), with their colors by LittleCMS 2, and a lossy WebP.

    python3 xtask/picture_samples.py

Needs Pillow (with LittleCMS) and imagecodecs. The profile is our own: eight Neugebauer primaries of offset inks, and black, by a simple
model (Yule-Nielsen, n = 2), so it contains nobody's data. Writes into crates/pictures/tests/data `lossy.webp` with the picture of
`lossy.png`, and into its folder `inks`:

- `mft2.tif`, `mft1.tif`, `mab.tif`: twelve patches of 8 bits with the profile in each of the three kinds of tables;
- `cmyk.jpg`, `ycck.jpg`: the same patches as Adobe's programs save them;
- `lcms2.csv`: the middle of each patch in sRGB, 8 bits, relative colorimetry, by LittleCMS from the same files.
"""

import io
import itertools
import pathlib
import struct

import imagecodecs
import numpy as np
from PIL import Image, ImageCms

OUT = pathlib.Path(__file__).parent.parent / "crates/pictures/tests/data/inks"
D50 = np.array([0.9642, 1.0, 0.8249])
# XYZ under D50 of paper and of solid inks in the order C, M, Y (bits), with plausible values for offset on coated paper.
SOLIDS = {
    (0, 0, 0): (0.9642, 1.0, 0.8249),
    (1, 0, 0): (0.155, 0.215, 0.470),
    (0, 1, 0): (0.290, 0.150, 0.170),
    (0, 0, 1): (0.700, 0.760, 0.080),
    (1, 1, 0): (0.055, 0.042, 0.150),
    (1, 0, 1): (0.075, 0.165, 0.065),
    (0, 1, 1): (0.275, 0.155, 0.028),
    (1, 1, 1): (0.032, 0.030, 0.025),
}
BLACK = 0.018
GRID = 5


def xyz(c, m, y, k):
    grow = lambda a: a**0.8  # dot gain in print
    c, m, y, k = map(grow, (c, m, y, k))
    total = np.zeros(3)
    for bits, color in SOLIDS.items():
        share = 1.0
        for on, amount in zip(bits, (c, m, y)):
            share *= amount if on else 1 - amount
        total += share * np.sqrt(np.array(color))
    total = total * (1 - k) + k * np.sqrt(BLACK) * np.sqrt(D50) * (0.5 + 0.5 * total / np.sqrt(D50))
    return total**2


def lab(color):
    f = lambda t: np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    fx, fy, fz = f(np.array(color) / D50)
    return np.array([116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)])


def table():
    steps = [i / (GRID - 1) for i in range(GRID)]
    return [lab(xyz(*inks)) for inks in itertools.product(steps, repeat=4)]


def tag_mft2():
    head = b"mft2" + bytes(4) + bytes([4, 3, GRID, 0]) + struct.pack(">9i", 65536, 0, 0, 0, 65536, 0, 0, 0, 65536)
    ramp = [round(65535 * i / 255) for i in range(256)]
    bent = [round(65535 * (i / 255) ** 0.9) for i in range(256)]
    body = struct.pack(">HH", 256, 2)
    for curve in (ramp, bent, ramp, bent):
        body += struct.pack(">256H", *curve)
    for l, a, b in table():
        old = [l * 652.8, (a + 128) * 256, (b + 128) * 256]
        body += struct.pack(">3H", *(min(65535, max(0, round(v))) for v in old))
    return head + body + struct.pack(">2H", 0, 65535) * 3


def tag_mft1():
    head = b"mft1" + bytes(4) + bytes([4, 3, GRID, 0]) + struct.pack(">9i", 65536, 0, 0, 0, 65536, 0, 0, 0, 65536)
    body = bytes(range(256)) * 4
    for l, a, b in table():
        body += bytes(min(255, max(0, round(v))) for v in (l * 2.55, a + 128, b + 128))
    return head + body + bytes(range(256)) * 3


def tag_mab():
    plain = b"curv" + bytes(4) + struct.pack(">I", 0)
    power = b"para" + bytes(4) + struct.pack(">HHi", 0, 0, round(1.1 * 65536))
    a_curves = power + plain + power + plain
    clut = bytes([GRID] * 4 + [0] * 12 + [2, 0, 0, 0])
    for l, a, b in table():
        clut += struct.pack(">3H", *(min(65535, max(0, round(v * 65535))) for v in (l / 100, (a + 128) / 255, (b + 128) / 255)))
    clut += bytes(-len(clut) % 4)
    m_curves = plain * 3
    matrix = struct.pack(">12i", 65536, 0, 0, 0, 65536, 0, 0, 0, 65536, 0, 0, 0)
    b_curves = plain * 3
    at, parts = 32, []
    offsets = []
    for part in (b_curves, matrix, m_curves, clut, a_curves):
        offsets.append(at)
        parts.append(part)
        at += len(part)
    return b"mAB " + bytes(4) + bytes([4, 3, 0, 0]) + struct.pack(">5I", *offsets) + b"".join(parts)


def text(words):
    return b"desc" + bytes(4) + struct.pack(">I", len(words) + 1) + words + b"\0" + bytes(78)


def profile(lut, version):
    white = b"XYZ " + bytes(4) + struct.pack(">3i", *(round(v * 65536) for v in D50))
    right = b"text" + bytes(4) + b"no rights reserved\0"
    tags = [(b"A2B0", lut), (b"A2B1", lut), (b"desc", text(b"inks of a test")), (b"cprt", right), (b"wtpt", white)]
    if version == 4:
        multi = lambda words: (
            b"mluc" + bytes(4) + struct.pack(">II", 1, 12) + b"enUS" + struct.pack(">II", 2 * len(words), 28) + words.encode("utf-16-be")
        )
        tags[2], tags[3] = (b"desc", multi("inks of a test")), (b"cprt", multi("no rights reserved"))
    at = 128 + 4 + 12 * len(tags)
    entries, data, placed = b"", b"", {}
    for name, body in tags:
        if body not in placed:
            placed[body] = at + len(data)
            data += body + bytes(-len(body) % 4)
        entries += name + struct.pack(">II", placed[body], len(body))
    size = at + len(data)
    head = struct.pack(">I4sI4s4s4s", size, b"\0" * 4, version << 24, b"prtr", b"CMYK", b"Lab ")
    head += struct.pack(">6H", 2026, 1, 1, 0, 0, 0) + b"acsp" + bytes(24) + struct.pack(">I", 0)
    head += struct.pack(">3i", *(round(v * 65536) for v in D50))
    head += bytes(128 - len(head))
    return head + struct.pack(">I", len(tags)) + entries + data


PATCHES = [
    (0, 0, 0, 0), (40, 20, 30, 0), (10, 60, 40, 5), (20, 15, 80, 10), (70, 60, 10, 0), (50, 40, 40, 30),
    (5, 5, 5, 60), (60, 30, 70, 20), (15, 70, 75, 0), (33, 27, 12, 8), (80, 70, 60, 50), (0, 0, 0, 100),
]


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    pixels = np.zeros((24, 32, 4), np.uint8)
    for i, patch in enumerate(PATCHES):
        y, x = divmod(i, 4)
        pixels[8 * y : 8 * y + 8, 8 * x : 8 * x + 8] = [round(2.55 * v) for v in patch]
    picture = Image.fromarray(pixels, "CMYK")
    old = profile(tag_mft2(), 2)
    for name, icc in [("mft2", old), ("mft1", profile(tag_mft1(), 2)), ("mab", profile(tag_mab(), 4))]:
        picture.save(OUT / f"{name}.tif", icc_profile=icc, compression="tiff_deflate")
    picture.save(OUT / "cmyk.jpg", icc_profile=old, quality=95)
    # YCCK with inverted amounts; the profile is inserted by hand.
    stored = 255 - pixels
    jpeg = imagecodecs.jpeg8_encode(stored, level=95, colorspace="CMYK", outcolorspace="YCCK", subsampling="444")
    chunk = b"ICC_PROFILE\0\x01\x01" + old
    (OUT / "ycck.jpg").write_bytes(jpeg[:2] + b"\xff\xe2" + struct.pack(">H", len(chunk) + 2) + chunk + jpeg[2:])
    rows = ["file,patch,r,g,b"]
    srgb = ImageCms.createProfile("sRGB")
    for name in ["mft2.tif", "mft1.tif", "mab.tif", "cmyk.jpg", "ycck.jpg"]:
        read = Image.open(OUT / name)
        own = ImageCms.ImageCmsProfile(io.BytesIO(read.info["icc_profile"]))
        # Not optimized: LittleCMS then uses the tables of the profile and not its own.
        through = ImageCms.buildTransform(own, srgb, "CMYK", "RGB", renderingIntent=1, flags=0x0100)
        rgb = np.asarray(ImageCms.applyTransform(read, through))
        for i in range(len(PATCHES)):
            y, x = divmod(i, 4)
            r, g, b = rgb[8 * y + 4, 8 * x + 4]
            rows.append(f"{name},{i},{r},{g},{b}")
    smooth = np.stack([*np.meshgrid(np.linspace(40, 220, 64), np.linspace(30, 200, 48)), np.full((48, 64), 120.0)], -1)
    smooth = Image.fromarray(smooth.round().astype(np.uint8), "RGB")
    smooth.save(OUT.parent / "lossy.webp", quality=90, method=6)
    smooth.save(OUT.parent / "lossy.png")
    (OUT / "lcms2.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
