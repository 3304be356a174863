#!/usr/bin/env python3
"""Compares the colors of the program's raw files with those that the eye sees, by the DNG specification and by LibRaw.

Run from the root of the repository:

    cargo build && python3 xtask/dng_color.py target/debug/spectra

The program photographs a ColorChecker with the sensor under D65 and under A, white balanced for each. This script reads the DNG file
byte by byte and computes colors as chapter 6 of the specification says (Adobe, Digital Negative Specification 1.4.0.0): it finds the
chromaticity of white from AsShotNeutral by iteration, interpolates the matrices between the two lights by inverse correlated color
temperature, and goes to XYZ under D50 by ForwardMatrix. It does this once more without the forward matrices. The patches are compared
with what the eye sees of their reflectances in the same light, adapted to D50 (Bradford). By the specification, the mean CIEDE2000 of
the 24 patches must be at most 1.5.

If the packages are installed (`pip install rawpy exifread`), LibRaw opens the same file (it uses only the matrix for D65), and an EXIF
reader shows exposure and lens. Neither is required. With LibRaw through rawpy 0.28.0, the means are 1.02 (D65) and 1.27 (A) by the
specification, 1.05 and 3.07 by LibRaw.
"""

import csv
import math
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIMIT = 1.5
D50 = [0.3457 / 0.3585, 1.0, (1 - 0.3457 - 0.3585) / 0.3585]
BRADFORD = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
# Correlated color temperatures of EXIF light sources, K.
TEMPERATURES = {17: 2850, 21: 6500}
WIDTH, HEIGHT = 240, 162

# The lens of this scene absorbs nothing, so only the sensor is judged.
SCENE = """spectra: 1
source: {{kind: chart, chart: color-checker, distance: 4 m, width: 0.4 m, illuminant: {light}, luminance: 1000 cd/m2}}
lens: {{file: zeiss-biotar-50-f1.4, f-number: f/8, focus: 4 m, coating: ideal, absorption: false}}
imager:
  kind: sensor
  width: 5.03 mm
  height: 3.39 mm
  resolution: [{width}, {height}]
  pitch: 4.78 um
  exposure: 1/40 s
  white-balance: {light}
render: {{samples: 256}}
output: [dng]
"""


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def apply(m, v):
    return [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]


def inverse(m):
    (a, b, c), (d, e, f), (g, h, i) = m
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return [
        [(e * i - f * h) / det, (c * h - b * i) / det, (b * f - c * e) / det],
        [(f * g - d * i) / det, (a * i - c * g) / det, (c * d - a * f) / det],
        [(d * h - e * g) / det, (b * g - a * h) / det, (a * e - b * d) / det],
    ]


def diagonal(v):
    return [[v[i] if i == j else 0.0 for j in range(3)] for i in range(3)]


def bradford(start, end):
    before, after = apply(BRADFORD, start), apply(BRADFORD, end)
    return product(inverse(BRADFORD), product(diagonal([a / b for a, b in zip(after, before)]), BRADFORD))


def table(path):
    """Reads a CSV file with front matter. Returns its wavelengths, and a list of values for each column name."""
    rows = list(csv.reader(line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")))
    columns = list(zip(*rows[1:]))
    return [float(v) for v in columns[0]], {n: [float(v) for v in c] for n, c in zip(rows[0][1:], columns[1:])}


def at(wavelengths, values, nm):
    """Interpolates linearly between the rows. Beyond them the value is constant."""
    if nm <= wavelengths[0]:
        return values[0]
    for i in range(1, len(wavelengths)):
        if nm <= wavelengths[i]:
            share = (nm - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1])
            return values[i - 1] + share * (values[i] - values[i - 1])
    return values[-1]


NM, CMF = table(ROOT / "spectra/cie/cie-1931-2deg.csv")
EYE = [list(v) for v in zip(*list(CMF.values())[:3])]


def xyz(power):
    """Returns XYZ of a function of the wavelength."""
    seen = [power(nm) for nm in NM]
    return [sum(p * e[i] for p, e in zip(seen, EYE)) for i in range(3)]


def seen(light):
    """Returns XYZ of the 24 patches in a light (a perfect white has Y = 1), and of that white."""
    light_nm, light_columns = table(ROOT / f"spectra/illuminants/{light}.csv")
    patch_nm, patches = table(ROOT / "spectra/reflectances/colorchecker.csv")
    power = {nm: at(light_nm, list(light_columns.values())[0], nm) for nm in NM}
    white = xyz(lambda nm: power[nm])
    of = lambda values: [v / white[1] for v in xyz(lambda nm: power[nm] * at(patch_nm, values, nm))]
    return {name: of(values) for name, values in patches.items()}, [v / white[1] for v in white]


def uv(x, y):
    return 4 * x / (12 * y - 2 * x + 3), 6 * y / (12 * y - 2 * x + 3)


def temperature(x, y):
    """Returns the correlated color temperature, K: that of the nearest blackbody in the CIE 1960 uniform diagram."""
    u, v = uv(x, y)

    def distance(kelvin):
        planck = lambda nm: 1 / (nm**5 * math.expm1(1.438776877e7 / (nm * kelvin)))
        s = xyz(planck)
        pu, pv = uv(s[0] / sum(s), s[1] / sum(s))
        return math.hypot(u - pu, v - pv)

    # Golden section search over mired.
    low, high, golden = 20.0, 700.0, (math.sqrt(5) - 1) / 2
    for _ in range(40):
        a, b = high - golden * (high - low), low + golden * (high - low)
        if distance(1e6 / a) < distance(1e6 / b):
            high = b
        else:
            low = a
    return 2e6 / (low + high)


FORMATS = {1: "B", 2: "c", 3: "H", 4: "I", 7: "B", 12: "d"}


def directory(data, start):
    """Reads the tags of a TIFF directory with their values."""
    tags = {}
    for i in range(struct.unpack_from("<H", data, start)[0]):
        tag, kind, count = struct.unpack_from("<HHI", data, start + 2 + 12 * i)
        size = count * {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 7: 1, 10: 8, 12: 8}[kind]
        where = start + 2 + 12 * i + 8
        if size > 4:
            where = struct.unpack_from("<I", data, where)[0]
        if kind == 2:
            tags[tag] = data[where : where + count - 1].decode()
        elif kind in (5, 10):
            pairs = struct.unpack_from(f"<{2 * count}{'I' if kind == 5 else 'i'}", data, where)
            tags[tag] = [n / d if d else math.inf for n, d in zip(pairs[::2], pairs[1::2])]
        else:
            tags[tag] = list(struct.unpack_from(f"<{count}{FORMATS[kind]}", data, where))
    return tags


class Raw:
    """The contents of a DNG file."""

    def __init__(self, path):
        data = path.read_bytes()
        assert data[:4] == b"II*\0", "no little-endian TIFF"
        self.tags = directory(data, struct.unpack_from("<I", data, 4)[0])
        self.exif = directory(data, self.tags[34665][0])
        self.width, self.height = self.tags[256][0], self.tags[257][0]
        self.values = struct.unpack_from(f"<{self.width * self.height}H", data, self.tags[273][0])
        self.lights = [TEMPERATURES[self.tags[t][0]] for t in (50778, 50779)]
        rows = lambda tag: [self.tags[tag][i : i + 3] for i in (0, 3, 6)]
        self.color = [rows(50721), rows(50722)]
        self.forward = [rows(50964), rows(50965)]
        self.neutral = self.tags[50728]

    def mean(self, left, top, right, bottom):
        """Returns the mean red, green and blue of an area, 0 to 1."""
        black, white = self.tags[50714][0], self.tags[50717][0]
        sums, counts = [0.0] * 3, [0] * 3
        for row in range(top, bottom):
            for column in range(left, right):
                color = self.tags[33422][row % 2 * 2 + column % 2]
                sums[color] += self.values[row * self.width + column] - black
                counts[color] += 1
        return [s / n / (white - black) for s, n in zip(sums, counts)]

    def share(self, x, y):
        """Returns the weight of the first light at a chromaticity."""
        first, second = self.lights
        share = (1 / temperature(x, y) - 1 / second) / (1 / first - 1 / second)
        return min(max(share, 0.0), 1.0)

    def between(self, matrices, share):
        return [[share * a + (1 - share) * b for a, b in zip(*rows)] for rows in zip(*matrices)]

    def white(self):
        """Returns the chromaticity of white, by iteration from D50."""
        x, y = 0.3457, 0.3585
        for _ in range(30):
            found = apply(inverse(self.between(self.color, self.share(x, y))), self.neutral)
            nx, ny = found[0] / sum(found), found[1] / sum(found)
            if abs(nx - x) + abs(ny - y) < 1e-7:
                break
            x, y = nx, ny
        return x, y

    def to_d50(self, forward=True):
        """Returns the matrix from the camera's colors to XYZ under D50."""
        x, y = self.white()
        share = self.share(x, y)
        if forward:
            return product(self.between(self.forward, share), diagonal([1 / n for n in self.neutral]))
        camera = inverse(self.between(self.color, share))
        return product(bradford([x / y, 1, (1 - x - y) / y], D50), camera)


def lab(color):
    f = lambda t: t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    fx, fy, fz = (f(c / w) for c, w in zip(color, D50))
    return 116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)


def ciede2000(one, two):
    """Color difference by G. Sharma, W. Wu, E. N. Dalal, Color Res. Appl. 30, 21 (2005)."""
    (l1, a1, b1), (l2, a2, b2) = one, two
    c7 = ((math.hypot(a1, b1) + math.hypot(a2, b2)) / 2) ** 7
    g = 0.5 * (1 - math.sqrt(c7 / (c7 + 25**7)))
    a1, a2 = a1 * (1 + g), a2 * (1 + g)
    c1, c2 = math.hypot(a1, b1), math.hypot(a2, b2)
    h1, h2 = math.degrees(math.atan2(b1, a1)) % 360, math.degrees(math.atan2(b2, a2)) % 360
    dh = 0 if c1 * c2 == 0 else (h2 - h1 + 180) % 360 - 180
    dl, dc, dH = l2 - l1, c2 - c1, 2 * math.sqrt(c1 * c2) * math.sin(math.radians(dh / 2))
    l, c = (l1 + l2) / 2, (c1 + c2) / 2
    h = h1 + h2 if c1 * c2 == 0 else (h1 + dh / 2) % 360
    t = (
        1 - 0.17 * math.cos(math.radians(h - 30)) + 0.24 * math.cos(math.radians(2 * h))
        + 0.32 * math.cos(math.radians(3 * h + 6)) - 0.20 * math.cos(math.radians(4 * h - 63))
    )
    sl = 1 + 0.015 * (l - 50) ** 2 / math.sqrt(20 + (l - 50) ** 2)
    sc, sh = 1 + 0.045 * c, 1 + 0.015 * c * t
    turn = 60 * math.exp(-(((h - 275) / 25) ** 2))
    rt = -math.sin(math.radians(turn)) * 2 * math.sqrt(c**7 / (c**7 + 25**7))
    return math.sqrt((dl / sl) ** 2 + (dc / sc) ** 2 + (dH / sh) ** 2 + rt * dc / sc * dH / sh)


def patches():
    """Yields the middle of each patch as (left, top, right, bottom). Patches are 40 wide, 46 apart, from 6 on, in a chart of 282 x
    190."""
    for row in range(4):
        for column in range(6):
            x, y = 26 + 46 * column, 26 + 46 * row
            yield (
                round((x - 10) / 282 * WIDTH), round((y - 10) / 190 * HEIGHT),
                round((x + 10) / 282 * WIDTH), round((y + 10) / 190 * HEIGHT),
            )


def errors(found, wanted):
    """Returns CIEDE2000 of each patch, after scaling the white patch to its correct brightness."""
    names = list(wanted)
    scale = wanted["white"][1] / found[names.index("white")][1]
    return {n: ciede2000(lab([scale * v for v in f]), lab(wanted[n])) for n, f in zip(names, found)}


def report(way, light, each):
    mean = sum(each.values()) / len(each)
    worst = max(each, key=each.get)
    print(f"{light:4} {way:34} CIEDE2000 mean {mean:.2f}, largest {each[worst]:.2f} ({worst})")
    return mean


def by_libraw(path):
    """Returns XYZ of the patches as LibRaw computes them. Its XYZ are relative to D65, and linear."""
    import rawpy

    with rawpy.imread(str(path)) as raw:
        picture = raw.postprocess(
            use_camera_wb=True, output_color=rawpy.ColorSpace.XYZ, gamma=(1, 1), no_auto_bright=True, output_bps=16,
            user_flip=0,
        )
    assert picture.shape == (HEIGHT, WIDTH, 3), picture.shape
    to_d50 = bradford([0.95047, 1.0, 1.08883], D50)
    of = lambda box: [float(picture[box[1] : box[3], box[0] : box[2], i].mean()) / 65535 for i in range(3)]
    return [apply(to_d50, of(box)) for box in patches()]


def by_exif_reader(path):
    import exifread

    with path.open("rb") as file:
        tags = exifread.process_file(file, details=False)
    wanted = ["ExposureTime", "FNumber", "ISOSpeedRatings", "FocalLength", "LensModel", "LightSource"]
    return ", ".join(f"{name} {tags[f'EXIF {name}']}" for name in wanted)


def optional(what, package):
    try:
        return what()
    except ImportError:
        print(f"     ({package} is not installed: left out)")
        return None


def main(program):
    failed = False
    for light in ("D65", "A"):
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "checker.yaml")
            scene.write_text(SCENE.format(light=light, width=WIDTH, height=HEIGHT), encoding="utf-8")
            subprocess.run([program, "run", str(scene), "-o", folder, "--quiet"], check=True)
            path = Path(folder, "checker.dng")
            raw = Raw(path)
            wanted, white = seen(light)
            adapt = bradford(white, D50)
            wanted = {name: apply(adapt, color) for name, color in wanted.items()}
            camera = [raw.mean(*box) for box in patches()]
            brightest = max(max(c) for c in camera)
            assert 0.2 < brightest < 0.98, f"the chart is exposed to {brightest:.2f} of the largest number"
            x, y = raw.white()
            true = white[0] / sum(white), white[1] / sum(white)
            print(f"{light:4} white at {x:.4f} {y:.4f}, {temperature(x, y):.0f} K (the light's own: {true[0]:.4f} {true[1]:.4f})")
            by_specification = [apply(raw.to_d50(), c) for c in camera]
            mean = report("by the specification", light, errors(by_specification, wanted))
            failed |= not mean <= LIMIT
            report("by it, without forward matrices", light, errors([apply(raw.to_d50(False), c) for c in camera], wanted))
            libraw = optional(lambda: by_libraw(path), "rawpy")
            if libraw:
                report("by LibRaw (matrix for D65 alone)", light, errors(libraw, wanted))
            exif = optional(lambda: by_exif_reader(path), "exifread")
            if exif:
                print(f"     {exif}")
    if failed:
        sys.exit(f"more than {LIMIT} on average")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "target/debug/spectra")
