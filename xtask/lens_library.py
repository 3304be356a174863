#!/usr/bin/env python3
"""Writes the lens library, lenses/*.yaml, from the prescriptions in tests/data/lenses.csv.

Run from the root of the repository, with the program itself for the choice of glasses:

    python3 xtask/lens_library.py target/release/spectra

- Three prescriptions of the CSV are left out because they are not consistent as lenses, although their focal lengths are:
  leica-summilux-35-f1.4 and nikon-28-70-f2.8-wide have 4 and 1.4 mm of spherical aberration wide open (the transcription
  seems to have lost aspheres), kodak-100-f3.8 has 0.4 % of lateral color (a glass seems to be wrong).
- Radii, thicknesses, nd and Vd are copied; a lens of unit focal length is scaled, figure by figure. If a transcription was compared with
  the print of the patent, the print's figures are used (`printed`: by surface and column), and the remark lists them.
- A catalog glass is named if one of the time agrees within 0.0005 in nd and 0.5 in Vd (`spectra glass match`).
  Otherwise only nd and Vd are written.
- The f-number of a lens is the nominal one in its name. No source states coatings, so the files have those usual at the time, marked
  as assumed (see `coating`).
- Semi-diameters are copied if they are clear apertures. If the source has none, or says that they are not reliable, they are computed
  here by tracing real rays: the axial beam at the stated f-number sets the stop; the other surfaces pass that beam and the middle half
  of the beam at the edge of the format.
- `rims` of a lens says where its semi-diameters come from. Only the patent of the Primoplan states any; those of transcriptions are
  guesses. If a real lens was measured, `fitted` has the semi-diameters that reproduce its light (see `xtask/measured_light.py`).
"""

import csv
import json
import math
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "tests" / "data"
KINDS = {"spherical": "sphere", "plane": "plane", "stop": "stop"}

LENTIL = "transcription of the lentil project (MIT)"
ISS = "transcription of the ISS project (MIT)"
OPTRACE = "transcription of the optrace project (MIT)"
OPTILAND = "transcription of the Optiland project (MIT)"
REALFLARE = "transcription of the realflare project (MIT)"

# By name: the CSV's name if it differs, scale, name, year, maker, patent, source, remark, makers of glass (in order of preference),
# era, semi-diameters to compute: (f-number, half diagonal of the format in mm), figures of the patent's print.
LENSES = {
    "angenieux-100-f1.1": dict(
        name="Angénieux 100 mm f/1.1", year=1953, maker="P. Angénieux, Paris", patent="US 2701982", source=LENTIL,
        remark="Normalized to 100 mm; it was built with a shorter focal length. Compared with the print of the patent, which calls it "
        "1:1 and states indices for the D line and no semi-diameters. The glasses named in the transcription are Schott's.",
        makers=["SCHOTT", "CORNING"], era="1953"),
    "meyer-primoplan-100-f1.5": dict(
        name="Meyer Primoplan 100 mm f/1.5", year=1936, maker="Meyer-Optik Görlitz", patent="DE 1387593",
        source=LENTIL, rims="stated", gap=51.8854,
        printed={1: dict(nd_after="1.657"), 2: dict(radius_mm="1450.1"), 3: dict(semi_diameter_mm="31"), 6: dict(semi_diameter_mm="23.3")},
        remark="A utility model, at its own scale: 1:1.5, 100 mm, free opening 66.7 mm. Compared with its print, by which three figures "
        "of the transcription were corrected: nd of the first lens 1.657 (was 1.66), radius 2 1450.1 (was 1450.01), diameter of "
        "the second lens 62 (was 58). The stop is that of the free opening (23.3 mm, 25 in the transcription). The stated "
        "diameters are those of the lenses. Spherical aberration at f/1.5 (a ray at the edge meets the axis 1.1 mm behind the "
        "focus) is therefore the design's own; it was built as f/1.9. The image plane is at the smallest axial spot.",
        makers=["SCHOTT"], era="1936"),
    "nikon-retrofocus-100-f2.8": dict(
        name="Nikon retrofocus 100 mm f/2.8", year=1971, maker="Nippon Kogaku", patent="US 3583791", source=LENTIL,
        remark="Example 1, normalized to 100 mm: a wide-angle design for a short focal length; the image circle is that of 66 degrees. "
        "Compared with the print of the patent, by which three figures of the transcription were corrected: the Abbe number of "
        "the fourth lens 46.2 (was 27.5), nd of the first 1.6425 (was 1.64), the second gap 17.83 (was 17.38). The computed back "
        "focus is 130.92 mm; the patent states 131.19. The image plane is at the smallest axial spot.",
        printed={1: dict(nd_after="1.6425"), 2: dict(thickness_mm="17.83"), 7: dict(vd_after="46.2")}, gap=130.3501,
        makers=["OHARA", "HOYA", "SCHOTT"], era="1971"),
    "zeiss-biotar-100-f1.4": dict(
        name="Zeiss Biotar 100 mm f/1.4", year=1927, maker="Carl Zeiss Jena (W. Merté)", patent="DE 485798", source=LENTIL,
        remark="The same design as example 2 of US 1786916, at the scale of the patent. Compared with the print of the patent, which states no "
        "semi-diameters.", makers=["SCHOTT"], era="1927"),
    "asahi-takumar-100-f1.2": dict(
        name="Asahi Takumar 100 mm f/1.2", year=1969, maker="Asahi Kogaku", patent="US 3451745", source=LENTIL,
        remark="Normalized to 100 mm; the type of the Super Takumar 50 mm f/1.4. Compared with the print of the patent, which states no "
        "semi-diameters; its space of 32.50 for the stop is 32.51 here.", makers=["OHARA", "HOYA"], era="1969"),
    "canon-35-f1.8": dict(
        csv="canon-35-f1.8-unit", scale=35, name="Canon 35 mm f/1.8", year=1956, maker="Canon", patent="US 2854890", source=LENTIL,
        remark="The patent's unit focal length times 35. The patent states three decimals, so radii are known to about 1 %. The image "
        "plane is at the smallest axial spot, 0.49 mm behind that of the source.", gap=24.1152,
        makers=["OHARA", "SCHOTT", "HOYA"], era="1956"),
    "kodak-petzval-100-f2.2": dict(
        name="Kodak Petzval 100 mm f/2.2", year=1948, maker="Eastman Kodak", patent="US 2500046", source=LENTIL,
        remark="Normalized to 100 mm: a projection lens for small angles. Compared with the print of the patent, which states no "
        "semi-diameters and by which one figure of the transcription was corrected: the thickness of the last lens 7.5 (was 7.4).",
        printed={7: dict(thickness_mm="7.5")}, makers=["SCHOTT", "CORNING", "CHANCE"], era="1948"),
    "minolta-fisheye-16-f2.7": dict(
        csv="minolta-fisheye-1-f2.7", scale=16, name="Minolta fisheye 16 mm f/2.7", year=1978, maker="Minolta", patent="US 4256373",
        source=LENTIL,
        remark="The patent's unit focal length times 16. The filter before the stop is plane; the transcription writes radii of 9999, which are kept.",
        makers=["OHARA", "HOYA"], era="1978"),
    "schneider-anamorphic-60": dict(
        csv="schneider-anamorphic", squeeze=1.9, groups=["{name: front, surfaces: [1, 3]}"], focus=["{group: front, section: x}"],
        name="Schneider anamorphic 60 mm, squeeze 1.9", year=2001, maker="Schneider", patent="US 6310731",
        source=LENTIL,
        remark="Not compared with the print of the patent, but the transcription is consistent: horizontally, the cylinders in front are "
        "afocal to 1.3e-5 per mm with a magnification of 0.5195, and the images of both sections lie within 0.025 mm of each "
        "other. With the sign of any of the five radii changed, neither is true. The plane before the biconvex cylinder has no "
        "power. The source does not state the f-number: it follows from the stated stop. Nor does it say how the lens is focused: "
        "here the whole lens moves, and the negative cylinders in front move in addition, so far that both sections stay "
        "together.",
        makers=["SCHOTT", "OHARA", "HIKARI"], era="2001"),
    "zeiss-biotar-50-f1.4": None,  # kept as it is: a hand-written file with its own remarks
    "helios-44-58-f2": dict(
        name="Helios-44 58 mm f/2", year=1958, maker="KMZ Krasnogorsk", source=OPTRACE,
        remark="The source cites no patent; a Soviet Biotar. The image plane is at the smallest axial spot: the source's 37.12 lies 0.88 "
        "mm in front of it. The source's semi-diameters are round guesses; of them, the front's 15 became 14.3 and the rear's "
        "13.25 became 12.3.",
        fitted={1: 14.3, 2: 14.3, 10: 12.3, 11: 12.3},
        rims="the light of a Helios-44 58 mm f/2 at f/2 and f/2.8, as Lensfun measured it (CC BY-SA 3.0). Relative to the middle, at "
        "5.4, 10.8, 16.2 and 21.6 mm: 0.914, 0.712, 0.507, 0.317 at f/2, here 0.955, 0.759, 0.515, 0.285; 0.995, 0.948, 0.801, "
        "0.556 at f/2.8, here 0.985, 0.937, 0.781, 0.501", makers=["LZOS"], gap=37.9975),
    "canon-fd-50-f1.8": dict(
        name="Canon FD 50 mm f/1.8", year=1979, maker="Canon", patent="JP 1988-081312", source=REALFLARE,
        remark="The source calls it 50 mm; the computed focal length is 48.9 mm. The image plane is at the smallest axial spot: the "
        "source's 34.81 lies 2.15 mm behind it, as for an object at 1.2 m. A glass is very likely misread: the foci of F and C "
        "lie 0.27 mm apart, 0.56 % of the focal length, compared with 0.11 to 0.29 % for the other normal lenses. At 14 mm, blue "
        "is drawn 11.7 um larger than green and red 4.4 um smaller; the lens that was measured (Lensfun, New FD 50 mm f/1.8) has "
        "-0.6 and +0.6. The source names catalog glasses of other makers and decades (M-NBFD130, F5, PBH4W, E-FD10), and states "
        "their nd and Vd. One Abbe number would explain it: 25.3 instead of 27.51 behind surface 4, or 40 instead of 35.93 behind "
        "surface 3. The patent was not seen, so the figures are those of the source.", makers=["OHARA", "HOYA", "SCHOTT"], era="1979", gap=32.6629),
    "zeiss-hologon-15-f8": dict(
        name="Zeiss Hologon 15 mm f/8", year=1969, maker="Carl Zeiss", source=REALFLARE,
        remark="The source cites no patent. The stop lies in the glass of the middle element, between two planes.",
        makers=["SCHOTT", "HOYA", "CDGM"], era="1969"),
    "canon-ef-70-200-f2.8-at-72": dict(
        name="Canon EF 70-200 mm f/2.8L at 72 mm", year=1995, maker="Canon", patent="US 5537259", source=ISS,
        remark="One position of a zoom. The image plane is at the smallest axial spot, since the source states none.",
        wider={(1, 17): 0.8, (18, 28): 0.4, (29, 34): 0.8},
        rims="the light of a Canon EF 70-200 mm f/2.8L USM wide open, as Lensfun measured it at 70 and 80 mm (CC BY-SA 3.0). Relative "
        "to the middle, at 5.4, 10.8, 16.2 and 21.6 mm: 0.972, 0.894, 0.768, 0.517, here 0.976, 0.885, 0.741, 0.507",
        makers=["OHARA", "HOYA"], era="1995", sizes=(2.923, 21.633), gap=52.1753),
    "nikkor-100-f1.4": dict(
        name="Nikkor 100 mm f/1.4", year=1981, maker="Nippon Kogaku (K. Wakamiya)", patent="US 4448497, example 1", source=OPTRACE,
        remark="Normalized to 100 mm; a 50 mm lens. Two rows may differ from the patent in the last digit.",
        makers=["HIKARI", "OHARA"], era="1983"),
    "cooke-triplet-50-f5": dict(
        name="Cooke triplet 50 mm f/5", source="textbook design; " + OPTILAND, stop_at=4,
        remark="No patent: the design that textbooks optimize after H. D. Taylor (1893). The rear surface of the flint is the stop.",
        makers=["SCHOTT"], sizes=(5.0, 18.2)),
    "tessar-50-f4.5": dict(
        csv="tessar-4-f4.5", scale=12.5, name="Tessar 50 mm f/4.5", source="M. Laikin, Lens Design, 4th ed.; " + OPTILAND,
        remark="No patent: a textbook Tessar of 4 inches, its numbers times 12.5.", makers=["SCHOTT"], sizes=(4.5, 21.633)),
    "double-gauss-100-f5": dict(
        name="Double Gauss 100 mm f/5", source="textbook design; " + OPTILAND, remark="No patent.", makers=["SCHOTT"],
        sizes=(5.0, 25.0)),
}  # fmt: skip


def rows(name):
    with open(DATA / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(x):
    """Formats a number with ten digits at most and no trailing zeros. Products of printed figures carry no more digits."""
    text = f"{x:.10g}"
    return text.replace("e+", "e")


class Surface:
    def __init__(self, row, scale, index_before):
        self.kind = row["type"]
        self.radius = float(row["radius_mm"]) * scale
        self.thickness = float(row["thickness_mm"]) * scale
        self.n = index_before if self.kind == "stop" else float(row["nd_after"])
        self.v = row["vd_after"]
        self.nd_text = row["nd_after"]
        self.hint = row["glass_after"]
        self.size = float(row["semi_diameter_mm"] or 0) * scale
        self.cylinder = self.kind == "cyl-y"


class System:
    """Spherical and plane surfaces on one axis, for tracing real rays."""

    def __init__(self, surfaces):
        self.surfaces = surfaces

    def paraxial(self):
        y, u, n = 1.0, 0.0, 1.0
        for i, s in enumerate(self.surfaces):
            c = 0.0 if math.isinf(s.radius) or s.cylinder else 1 / s.radius
            u = (n * u - y * c * (s.n - n)) / s.n
            n = s.n
            if i + 1 < len(self.surfaces):
                y += u * s.thickness
        return -1 / u, -y / u

    def trace(self, y, z, angle):
        """Returns the heights at each surface of a ray in the plane of the paper, and its last slope; None if the ray is lost."""
        m, l, n = math.sin(angle), math.cos(angle), 1.0
        heights = []
        for s in self.surfaces:
            if math.isinf(s.radius):
                t = -z / l
                y, z, normal = y + t * m, 0.0, (0.0, 1.0)
            else:
                zc = z - s.radius
                b = y * m + zc * l
                disc = b * b - (y * y + zc * zc - s.radius**2)
                if disc < 0:
                    return None
                roots = [-b - math.sqrt(disc), -b + math.sqrt(disc)]
                t = min(roots, key=lambda r: abs(z + r * l))
                y, z = y + t * m, z + t * l
                normal = (y / s.radius, (z - s.radius) / s.radius)
            heights.append(y)
            c = normal[0] * m + normal[1] * l
            if c < 0:
                normal, c = (-normal[0], -normal[1]), -c
            r = n / s.n
            under = 1 - r * r * (1 - c * c)
            if under < 0:
                return None
            k = math.sqrt(under) - r * c
            m, l, n = r * m + k * normal[0], r * l + k * normal[1], s.n
            z -= s.thickness
        return heights, m

    def marginal(self, f_number):
        """Returns the heights of the axial ray that leaves with sin = 1 / (2 N)."""
        wanted = 0.5 / f_number
        low, high = 0.0, 2.0 * self.paraxial()[0] * wanted
        for _ in range(80):
            middle = 0.5 * (low + high)
            ray = self.trace(middle, -1e-9, 0.0)
            if ray and abs(ray[1]) < wanted:
                low = middle
            else:
                high = middle
        return self.trace(low, -1e-9, 0.0)[0]

    def beam(self, stop, height, start, edge):
        """Traces rays that meet the stop at a given height, from the axis to the edge of the field in steps of half a degree. Each
        ray starts from the previous one, so that the search does not jump to another path through the glass. Stops at the first angle
        without such a ray. Returns (angle, heights) of each ray."""
        y, found, steps = start, [], max(1, math.ceil(math.degrees(edge) / 0.5))
        for k in range(steps + 1):
            angle = edge * k / steps
            off = None
            for _ in range(40):
                ray = self.trace(y, -1e-9, angle)
                beside = self.trace(y + 1e-6, -1e-9, angle)
                if not ray or not beside:
                    return found
                off = ray[0][stop] - height
                if abs(off) < 1e-9:
                    break
                slope = (beside[0][stop] - ray[0][stop]) / 1e-6
                if abs(slope) < 1e-3:
                    return found
                y -= max(-1.0, min(1.0, off / slope))
            if abs(off) > 1e-6:
                return found
            found.append((angle, ray[0]))
        return found

    def sizes(self, stop, f_number, half_diagonal):
        axial = [abs(h) for h in self.marginal(f_number)]
        need = list(axial)
        edge = math.atan(half_diagonal / self.paraxial()[0])
        for share in (-0.5, 0.0, 0.5):
            rays = self.beam(stop, share * axial[stop], share * axial[0], edge)
            if not rays or rays[-1][0] < edge:
                reached = math.degrees(rays[-1][0]) if rays else 0.0
                print(f"  {share} of the stop: rays to {reached:.1f} degrees only", file=sys.stderr)
            for _, heights in rays:
                need = [max(a, abs(h)) for a, h in zip(need, heights)]
        # A margin of 0.05 to 0.1 mm, so that only the stop limits the axial beam.
        return [round(axial[i], 4) if i == stop else math.ceil(20 * need[i] + 1) / 20 for i in range(len(need))]


def coating(year):
    """Returns the usual coating of lenses of a year: none before 1940 (or for an unknown year), one layer before 1970, then three."""
    return "bare" if not year or year < 1940 else "single-layer" if year < 1970 else "three-layer"


def nominal_f_number(name):
    """Returns the f-number in a lens's name."""
    found = re.search(r"f/([0-9.]+)", name)
    return found.group(1) if found else None


def glass(program, surface, entry, seen):
    """Returns the catalog glass for nd and Vd from the first maker that has one near enough; None if none has."""
    key = (surface.nd_text, surface.v)
    if key in seen:
        return seen[key]
    best = None
    for maker in entry["makers"]:
        command = [program, "glass", "match", "--nd", surface.nd_text, "--vd", surface.v, "--json", "--limit", "40", "--maker", maker]
        if entry.get("era"):
            command += ["--era", entry["era"]]
        found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["matches"]
        near = [m for m in found if abs(m["delta_n"]) <= 0.0005 and abs(m["delta_v"]) <= 0.5]
        # Ultraviolet glass was not used in camera lenses.
        near = [m for m in near if not m["name"].split("/")[1].startswith("UBK")]
        hinted = [m for m in near if m["name"].split("/")[1] == surface.hint.removeprefix("LZ_")] if surface.hint else []
        if hinted or near:
            best = (hinted or near)[0]["name"]
            break
    seen[key] = best
    return best


def text_block(key, text):
    """Formats a folded YAML text with at most 110 characters on a line."""
    lines, line = [], ""
    for word in text.split():
        if len(line) + len(word) + 1 > 106:
            lines.append(line)
            line = ""
        line = f"{line} {word}" if line else word
    lines.append(line)
    return [f"{key}: >-"] + [f"  {line}" for line in lines]


def write(name, entry, table, program):
    scale = entry.get("scale", 1)
    source_name = entry.get("csv", name)
    surfaces, n = [], 1.0
    for row in table[source_name]:
        row = {**row, **entry.get("printed", {}).get(int(row["surface"]), {})}
        surfaces.append(Surface(row, scale, n))
        n = surfaces[-1].n
    stop_at = entry.get("stop_at")
    stop = stop_at - 1 if stop_at else next(i for i, s in enumerate(surfaces) if s.kind == "stop")
    system = System(surfaces)
    efl, bfl = system.paraxial()
    remark = entry["remark"]
    if entry.get("sizes"):
        f_number, half = entry["sizes"]
        for s, size in zip(surfaces, system.sizes(stop, f_number, half)):
            s.size = size
        remark += (
            f" Semi-diameters are computed: they pass the axial beam at f/{number(f_number)}, and the middle half of the beam at "
            f"{math.degrees(math.atan(half / efl)):.0f} degrees."
        )
    rims = entry.get("rims", "computed" if entry.get("sizes") else "guessed")
    for surface, size in entry.get("fitted", {}).items():
        surfaces[surface - 1].size = size
    if entry.get("wider"):
        parts = ", ".join(f"{first} to {last} by {number(by)} mm" for (first, last), by in entry["wider"].items())
        remark += f" Then all except the stop were enlarged: surfaces {parts}."
    for (first, last), by in entry.get("wider", {}).items():
        for i in range(first - 1, last):
            surfaces[i].size = round(surfaces[i].size + by * (i != stop), 4)
    if entry.get("gap"):
        surfaces[-1].thickness = entry["gap"]
    seen = {}
    lines = ["# Written by xtask/lens_library.py from tests/data/lenses.csv.", f"name: {entry['name']}"]
    for key in ("year", "maker", "patent"):
        if entry.get(key):
            lines.append(f"{key}: {entry[key]}")
    if nominal_f_number(entry["name"]):
        lines.append(f"f-number: {nominal_f_number(entry['name'])}")
    if entry.get("squeeze"):
        lines.append(f"squeeze: {number(entry['squeeze'])}")
    lines += ["reference-line: d", f"coating: {{kind: {coating(entry.get('year'))}, assumed: true}}", f"source: {entry['source']}"]
    body = []
    for i, s in enumerate(surfaces):
        if s.cylinder:
            keys = [("kind", "cylinder"), ("axis", "y"), ("radius", number(s.radius))]
        elif s.kind == "stop":
            keys = [("kind", "stop")]
        elif math.isinf(s.radius):
            keys = [("kind", "plane")]
        else:
            keys = [("kind", "sphere"), ("radius", number(s.radius))]
        if stop_at and i == stop:
            keys.append(("stop", "true"))
        if s.thickness:
            keys.append(("thickness", number(s.thickness)))
        if s.kind != "stop" and s.n != 1.0:
            found = glass(program, s, entry, seen)
            if found:
                keys.append(("glass", found))
            keys += [("nd", number(float(s.nd_text))), ("vd", number(float(f"{float(s.v):.6g}")))]
        if s.size > 0:
            keys.append(("semi-diameter", number(s.size)))
        body.append("  - {" + ", ".join(f"{k}: {v}" for k, v in keys) + "}")
    named = [g for g in seen.values() if g]
    plain = [f"{k[0]}/{k[1]}" for k, g in seen.items() if not g]
    if named and plain:
        remark += " Catalog glasses of the time are named if they have the stated nd and Vd; the other media are given only by these."
    elif named and entry.get("era"):
        remark += " Catalog glasses of the time with the stated nd and Vd were chosen."
    elif named:
        remark += " The glasses are those that the source names, or were chosen by the stated nd and Vd."
    else:
        remark += " No catalog glass of the time has the stated nd and Vd, so only these are given."
    lines += text_block("remark", remark.strip())
    lines += [f"rims: {rims}"] if rims in ("stated", "computed", "guessed") else ["rims:"] + ["  " + line for line in text_block("fitted", rims)]
    lines.append("surfaces:")
    for key in ("groups", "focus"):
        if entry.get(key):
            body += [f"{key}:"] + [f"  - {item}" for item in entry[key]]
    (ROOT / "lenses" / f"{name}.yaml").write_text("\n".join(lines + body) + "\n", encoding="utf-8")
    print(f"{name}: EFL {efl:.6f} BFL {bfl:.6f}; {len(named)} glasses named, by figures: {plain}")


def main():
    program = str(Path(sys.argv[1]).resolve())
    table = {}
    for row in rows("lenses.csv"):
        table.setdefault(row["lens"], []).append(row)
    for name, entry in LENSES.items():
        if entry:
            write(name, entry, table, program)


if __name__ == "__main__":
    main()
