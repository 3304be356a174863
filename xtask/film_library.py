#!/usr/bin/env python3
"""Writes the named color films and papers under spectra/film/ that import_film.py does not write itself.

Run from the root of the repository, with the wheel that import_film.py names:

    VENV/bin/python xtask/film_library.py WHEEL

Like import_film.py, it reads the tables of spectral-film-lut 0.18.13 (MIT), which are digitized figures of makers' data sheets, and
none of its code. It prepares them as follows:
  - exposures and running maxima and minima as in import_film.py;
  - sheets of still negatives show no spectra of single dyes, only of a midscale neutral and of unexposed film. The dyes are then those
    of Vision3 250D, all scaled wavelength by wavelength by one factor, so that together they make the sheet's neutral;
  - if the sheet has no granularity over density, it is that of a similar film times one factor (see GRAIN);
  - curves are corrected by a few numbers so that a gray scale is gray. xtask/fit_film_library.py fits them and writes them to
    xtask/film_library.json. The remark of each curve says how far it moved;
  - the influence of the layers on each other is assumed: xtask/film_families.py.
"""

import json
import pathlib
import sys
from math import log10
from types import SimpleNamespace

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import import_film as base  # noqa: E402

NUMBERS = pathlib.Path(__file__).with_name("film_library.json")
DAYLIGHT = "iso-7589-sensitometric-daylight"
TUNGSTEN = "iso-7589-sensitometric-studio-tungsten"

# slug: (module, variable in it, display name, maker, sheet, year, speed, light, print stock, backing)
KODAK, FUJI = "Eastman Kodak", "Fujifilm"
# Papers for optical printing. Those for digital printers are steeper; users select them by name.
ENDURA, CINE = "kodak-portra-endura", "kodak-vision-2383"
NEGATIVES = {
    "kodak-portra-160": ("kodak_portra_160", "KODAK_PORTRA_160", "Kodak Portra 160", KODAK,
                         "Kodak Professional Portra 160 Film, technical data E-4051", 2011, 160, DAYLIGHT, ENDURA),
    "kodak-portra-400": ("kodak_portra_400", "KODAK_PORTRA_400", "Kodak Portra 400", KODAK,
                         "Kodak Professional Portra 400 Film, technical data E-4050", 2010, 400, DAYLIGHT, ENDURA),
    "kodak-portra-800": ("kodak_portra_800", "KODAK_PORTRA_800", "Kodak Portra 800", KODAK,
                         "Kodak Professional Portra 800 Film, technical data E-4040", 1998, 800, DAYLIGHT, ENDURA),
    "kodak-ektar-100": ("kodak_ektar_100", "KODAK_EKTAR_100", "Kodak Ektar 100", KODAK,
                        "Kodak Professional Ektar 100 Film, technical data E-4046", 2008, 100, DAYLIGHT, ENDURA),
    "kodak-gold-200": ("kodak_gold_200", "KODAK_GOLD_200", "Kodak Gold 200", KODAK,
                       "Kodak Gold 200 Film, technical data E-7022", 2007, 200, DAYLIGHT, ENDURA),
    "kodak-ultramax-400": ("kodak_ultramax_400", "KODAK_ULTRAMAX_400", "Kodak UltraMax 400", KODAK,
                           "Kodak UltraMax 400 Film, technical data E-7023", 2007, 400, DAYLIGHT, ENDURA),
    "kodak-vericolor-iii": ("kodak_vericolor_iii", "KODAK_VERICOLOR_III", "Kodak Vericolor III", KODAK,
                            "Kodak Vericolor III Professional Film, technical data", 1983, 160, DAYLIGHT, ENDURA),
    "fuji-pro-160s": ("fuji_pro_160s", "FUJI_PRO_160S", "Fujicolor Pro 160S", FUJI,
                      "Fujicolor Pro 160S Professional, data sheet", 2004, 160, DAYLIGHT, ENDURA),
    "fuji-pro-400h": ("fuji_pro_400h", "FUJI_PRO_400H", "Fujicolor Pro 400H", FUJI,
                      "Fujicolor Pro 400H Professional, data sheet", 2004, 400, DAYLIGHT, ENDURA),
    "fuji-c200": ("fuji_c200", "FUJI_C200", "Fujicolor C200", FUJI, "Fujicolor C200, data sheet", 2017, 200, DAYLIGHT, ENDURA),
    "fuji-superia-reala-100": ("fuji_superia_reala", "FUJI_SUPERIA_REALA", "Fujicolor Superia Reala 100", FUJI,
                               "Fujicolor Superia Reala, data sheet", 1998, 100, DAYLIGHT, ENDURA),
    "fuji-superia-x-tra-400": ("fuji_superia_xtra_400", "FUJI_SUPERIA_XTRA_400", "Fujicolor Superia X-TRA 400", FUJI,
                               "Fujicolor Superia X-TRA 400, data sheet", 1998, 400, DAYLIGHT, ENDURA),
    "fuji-natura-1600": ("fuji_natura_1600", "FUJI_NATURA_1600", "Fujicolor Natura 1600", FUJI,
                         "Fujicolor Natura 1600, data sheet", 2003, 1600, DAYLIGHT, ENDURA),
    "kodak-vision3-50d-5203": ("kodak_5203", "KODAK_5203", "Kodak Vision3 50D 5203", KODAK,
                               "Kodak Vision3 50D Color Negative Film 5203/7203, technical data H-1-5203", 2011, 50, DAYLIGHT, CINE),
    "kodak-vision3-200t-5213": ("kodak_5213", "KODAK_5213", "Kodak Vision3 200T 5213", KODAK,
                                "Kodak Vision3 200T Color Negative Film 5213/7213, technical data H-1-5213", 2010, 200, TUNGSTEN, CINE),
    "kodak-vision3-500t-5219": ("kodak_5219", "KODAK_5219", "Kodak Vision3 500T 5219", KODAK,
                                "Kodak Vision3 500T Color Negative Film 5219/7219, technical data H-1-5219", 2007, 500, TUNGSTEN, CINE),
    "kodak-exr-100t-5248": ("kodak_exr_5248", "KODAK_EXR_5248", "Eastman EXR 100T 5248", KODAK,
                            "Eastman EXR 100T Color Negative Film 5248/7248, technical data H-1-5248", 1990, 100, TUNGSTEN, CINE),
    "fuji-eterna-500": ("fuji_eterna_500", "FUJI_ETERNA_500", "Fujicolor Eterna 500", FUJI,
                        "Fujicolor Negative Film Eterna 500, type 8573, data sheet", 2007, 500, TUNGSTEN, CINE),
}
SLIDES = {
    "fuji-velvia-50": ("fuji_velvia_50", "FUJI_VELVIA_50", "Fujichrome Velvia 50", FUJI,
                       "Fujichrome Velvia 50, data sheet", 2007, 50),
    "fuji-provia-100f": ("fuji_provia_100f", "FUJI_PROVIA_100F", "Fujichrome Provia 100F", FUJI,
                         "Fujichrome Provia 100F, data sheet", 2000, 100),
    "kodachrome-64": ("kodachrome_64", "KODACHROME_64", "Kodachrome 64", KODAK,
                      "Kodachrome 64 Professional Film, technical data E-55", 1974, 64),
}
# slug: (module, variable in it, display name, maker, sheet, year, medium, lamp, LAD)
PRINTS = {
    "kodak-portra-endura": ("kodak_portra_endura", "KODAK_PORTRA_ENDURA", "Kodak Professional Portra Endura Paper", KODAK,
                            "Kodak Professional Portra Endura Paper, technical data E-4021", 2002, "paper", None),
    "kodak-endura-premier": ("kodak_endura_premier", "KODAK_ENDURA_PREMIER", "Kodak Professional Endura Premier Paper", KODAK,
                             "Kodak Professional Endura Premier Paper, technical data", None, "paper", None),
    "fuji-crystal-archive-dpii": ("fuji_ca_dpII", "FUJI_CA_DPII", "Fujicolor Crystal Archive DP II", FUJI,
                                  "Fujicolor Crystal Archive Digital Paper Type DP II, data sheet", 2006, "paper", None),
    "kodak-vision-premier-2393": ("kodak_2393", "KODAK_2393", "Kodak Vision Premier Color Print Film 2393", KODAK,
                                  "Kodak Vision Premier Color Print Film 2393, technical data H-1-2393", 1998, "film",
                                  (1.09, 1.06, 1.03)),
    "fuji-eterna-cp-3513di": ("fuji_3513di", "FUJI_3513", "Fujicolor Positive Film Eterna-CP 3513DI", FUJI,
                              "Fujicolor Positive Film Eterna-CP Type 3513DI, data sheet", 2002, "film", None),
}

# slug: (display name, maker, sheet, year, speed, RMS granularity of the sheet or None, Frieser's k in mm, average gradient). No free
# digitization of these sheets is known. The numbers that they state in words are here; the rest is taken from similar films.
SILVER = {
    "kodak-t-max-100": ("Kodak T-Max 100", KODAK, "Kodak Professional T-Max 100 Film, technical data F-4016", 1986, 100, 8, 0.009, 0.58),
    "kodak-t-max-400": ("Kodak T-Max 400", KODAK, "Kodak Professional T-Max 400 Film, technical data F-4043, 2007", 1986, 400, 10,
                        0.011, 0.58),
    "ilford-fp4-plus": ("Ilford FP4 Plus", "Harman Technology (Ilford Photo)", "Ilford FP4 Plus, technical information", 1990, 125, None,
                        0.012, 0.62),
    "ilford-hp5-plus": ("Ilford HP5 Plus", "Harman Technology (Ilford Photo)", "Ilford HP5 Plus, technical information", 1989, 400, None,
                        0.014, 0.62),
}

# RMS granularity at density 1 above the minimum, as the makers state it. None if they state only an index of prints (Kodak still
# negatives) or if the layers have curves of their own.
GRAIN = {"fuji-pro-160s": 3, "fuji-pro-400h": 4, "fuji-c200": 4, "fuji-superia-reala-100": 4, "fuji-superia-x-tra-400": 4,
         "fuji-natura-1600": 7, "fuji-eterna-500": 3.5,
         "fuji-velvia-50": 9, "fuji-provia-100f": 9, "kodachrome-64": 10}
# Loss in long exposures, by the makers' sheets. The other sheets state none, or only that 1 s counts in full.
RECIPROCITY = {
    "kodak-t-max-100": ["# F-4016: a third of a stop more at 1 s, half a stop (15 s) at 10 s, a stop (200 s) at 100 s.",
        "reciprocity: {table: [[1, 1.26], [10, 15], [100, 200]], above: 0.1 s}"],
    "kodak-t-max-400": ["# F-4016: a third of a stop more at 1 s, half a stop (15 s) at 10 s, one and a half stops (300 s) at 100 s.",
        "reciprocity: {table: [[1, 1.26], [10, 15], [100, 300]], above: 0.1 s}"],
    "ilford-fp4-plus": ["# Harman, \"Film reciprocity failure compensation\": beyond 1 s a metered time Tm becomes Tm^1.26.",
        "reciprocity: {exponent: 1.26, above: 1 s}"],
    "ilford-hp5-plus": ["# Harman, \"Film reciprocity failure compensation\": beyond 1 s a metered time Tm becomes Tm^1.31.",
        "reciprocity: {exponent: 1.31, above: 1 s}"],
    "fuji-velvia-50": ["# Fuji's data sheet: 1/3, 1/2, 2/3 and 1 stop more at 4, 8, 16 and 32 s; the filters that it also "
                       "recommends are left out.",
        "reciprocity: {table: [[4, 5.04], [8, 11.3], [16, 25.4], [32, 64]], above: 1 s}"],
    "fuji-provia-100f": ["# Fuji's data sheet: no correction up to 128 s, a third of a stop more at 4 minutes.",
        "reciprocity: {table: [[240, 302]], above: 128 s}"],
}
# Weights of red, green and blue in a visual density.
VISUAL = {"red": 0.26, "green": 0.57, "blue": 0.17}
# Visual RMS granularity of Vision3 grows with about this power of the speed: 3.1, 4.7 and 5.5 of 5203, 5213 and 5219.
BY_SPEED = 0.25


def between(points, x):
    """Interpolates linearly between points. Beyond them the end values are used."""
    if x <= points[0][0]:
        return points[0][1]
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return points[-1][1]


def generic_dyes(folder):
    data = base.load(folder, "negative_film.kodak_5207", "KODAK_5207")
    return [base.pairs(t) for t in data.spectral_density]


def solve(matrix, right):
    """Solves a small system of linear equations by Gaussian elimination."""
    n = len(right)
    rows = [list(m) + [r] for m, r in zip(matrix, right)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(n):
            if k != i:
                f = rows[k][i] / rows[i][i]
                rows[k] = [a - f * b for a, b in zip(rows[k], rows[i])]
    return [rows[i][n] / rows[i][i] for i in range(n)]


def dyes_of_neutral(data, generic):
    """Returns dyes that together make the sheet's midscale neutral: the generic dyes, with amounts by least squares, all times one
    factor for each wavelength (0.5 to 2, smoothed over 20 nm). Also returns the root mean square difference of the factor from 1."""
    neutral, clear = base.pairs(data.d_ref_sd), base.pairs(data.d_min_sd)
    low, high = max(neutral[0][0], clear[0][0]), min(neutral[-1][0], clear[-1][0])
    grid = [w for w in range(400, 701, 5) if low <= w <= high]
    wanted = [between(neutral, w) - between(clear, w) for w in grid]
    shapes = [[between(d, w) for w in grid] for d in generic]
    matrix = [[sum(a * b for a, b in zip(p, q)) for q in shapes] for p in shapes]
    amounts = solve(matrix, [sum(a * b for a, b in zip(p, wanted)) for p in shapes])
    assert all(a > 0 for a in amounts), amounts
    ratio = [min(max(v / sum(a * s[i] for a, s in zip(amounts, shapes)), 0.5), 2.0) for i, v in enumerate(wanted)]
    smooth = [sum(ratio[max(i - 2, 0):i + 3]) / len(ratio[max(i - 2, 0):i + 3]) for i in range(len(ratio))]
    off = (sum((r - 1) ** 2 for r in smooth) / len(smooth)) ** 0.5
    curve = list(zip(grid, smooth))
    dyes = []
    for d in generic:
        table = {w: between(d, w) * between(curve, w) for w in range(400, 801, 10)}
        peak = max(table.values())
        dyes.append({w: v / peak for w, v in table.items()})
    return dyes, off


def prepared(folder, kind, slug):
    """Returns the tables of a stock, with the dyes of its layers."""
    row = {"negative": NEGATIVES, "slide": SLIDES, "print": PRINTS}[kind][slug]
    package = {"negative": "negative_film", "slide": "reversal_film", "print": "print_film"}[kind]
    data = base.load(folder, f"{package}.{row[0]}", row[1])
    dyes, off = data.spectral_density, None
    if not dyes:
        dyes, off = dyes_of_neutral(data, generic_dyes(folder))
    return SimpleNamespace(
        sensiometric_curve=data.sensiometric_curve, log_sensitivity=data.log_sensitivity, mtf=data.mtf,
        spectral_density=dyes, dyes_off=off, d_min_sd=data.d_min_sd, rms_curve=data.rms_curve, rms_density=data.rms_density,
        exposure_base=data.exposure_base)


def points_of(data, i, iso):
    """Returns a curve over log10 exposure in lx s."""
    points = base.pairs(data.sensiometric_curve[i])
    if data.exposure_base == 2:
        points = [(x * log10(2) + log10(10 / iso), y) for x, y in points]
    return points


# Correction of the curves, with the numbers that xtask/fit_film_library.py fits.
def moved(kind, numbers, points, gray):
    """Applies the correction to a curve of blue or red: see fit_film_library.py."""
    low = min(y for _, y in points)
    out, most = [], 0.0
    for x, y in points:
        if kind == "negative":
            u = min(max(x - gray, -1.0), 1.2)
            d = numbers[0] * (u + 1) + numbers[1] * (u * u - 1) + numbers[2] * (u + 1) * u * (u - 1.2)
        else:
            d = sum(n * bump(y - low, at) for n, at in zip(numbers, BUMPS[kind]))
        out.append((x, y + d))
        most = max(most, abs(d))
    shift = numbers[3] if kind == "slide" else 0.0
    return [(x + shift, y) for x, y in out], most, shift


# Densities above the minimum at which the corrections of positives are largest.
BUMPS = {"print": (0.3, 1.0, 2.4), "paper": (0.3, 0.9, 1.9), "slide": (0.4, 1.0, 2.2)}


def bump(density, at):
    t = max(density, 0.0) / at
    return (t * base.exp(1 - t)) ** 2


def grainy(folder, slug, iso, data, kind):
    """Returns the granularity of the layers, and the remark about it if it is assumed."""
    own = base.load(folder, "negative_film.kodak_5207", "KODAK_5207")
    tables = [base.granularity(data.rms_curve[i], data.rms_density[i]) for i in range(3)]
    copied = kind == "slide" or data.rms_curve == own.rms_curve
    if not copied and slug not in GRAIN:
        return tables, None
    if kind == "slide":
        like = base.load(folder, "reversal_film.kodak_ektachrome_100d", "KODAK_EKTACHROME_100D")
        name = "kodak-ektachrome-100d"
    else:
        like, name = own, "kodak-vision3-250d-5207"
    tables = [base.granularity(like.rms_curve[i], like.rms_density[i]) for i in range(3)]
    visual = sum((VISUAL[base.LAYERS[i]] * between(tables[i], 1.0)) ** 2 for i in range(3)) ** 0.5
    if slug in GRAIN:
        factor = GRAIN[slug] / visual
        remark = (f"The sheet states one figure, RMS {number(GRAIN[slug])} at density 1 through 48 um. Assumed: the layers have "
                  f"the curves of {name}, times {factor:.2f}, so that a visual density (0.26 red, 0.57 green, 0.17 blue) has "
                  "that figure.")
    else:
        factor = (iso / 250) ** BY_SPEED
        remark = (f"The sheet states only a Print Grain Index. Assumed: the curves of {name}, times {factor:.2f}, since grain grows as "
                  f"the speed to the power of {BY_SPEED}, as among Vision3 50D, 200T and 500T.")
    return [[(d, r * factor) for d, r in t] for t in tables], remark


def number(v):
    return base.number(float(v))


def layers_of(data, kind, iso, numbers, grain):
    gray = log10(10 / iso) if iso else None
    out = []
    for i in (2, 1, 0):
        layer = base.LAYERS[i]
        rising = kind != "slide"
        points, count, worst = base.monotone(points_of(data, i, iso), rising)
        remarks = []
        if count:
            word = "maximum" if rising else "minimum"
            remarks.append(f"running {word}; it moved {count} points of the digitization, by {worst:.4f} at most")
        if numbers and any(numbers.get(layer, [])):
            points, most, shift = moved(kind, numbers[layer], points, gray)
            points, _, _ = base.monotone(points, rising)
            along = f" and {abs(shift):.3f} in log10 exposure" if abs(shift) >= 0.0005 else ""
            if most >= 0.0005 or along:
                remarks.append(f"moved by up to {most:.3f} in density{along}, so that a gray scale is gray (assumed)")
        lines = [f"  - name: {layer}", "    sensitivity:", "      reading: log10", "      measured-under: equal-energy",
                 f"      table:{base.flow(base.pairs(data.log_sensitivity[i]), '        ')}",
                 "    dye:", f"      name: {base.DYES[i]}",
                 f"      table:{base.flow(base.pairs(data.spectral_density[i]), '        ')}"]
        if data.mtf:
            mtf = data.mtf[i] if len(data.mtf) == 3 else data.mtf[0]
            lines.append(f"    mtf:{base.flow(base.pairs(mtf), '      ')}")
        if grain:
            lines.append(f"    granularity:{base.flow(grain[i], '      ')}")
        lines += ["    curves:", "      - development: normal"]
        if remarks:
            text = "; ".join(remarks)
            lines.append(f"        remark: {base.folded(text, '          ') if len(text) > 96 else text}")
        lines.append(f"        points:{base.flow(points, '          ')}")
        out.append(lines)
    return out


def assumed(parts):
    """Returns the `assumed:` block of a stock: what is assumed for all layers, and why."""
    said = [f"  {key}: {base.folded(text, '    ')}" for key, text in parts if text]
    return ["assumed:\n" + "\n".join(said)] if said else []


def dye_remark(off):
    return off is not None and (
        "The sheet has the spectrum of a midscale neutral and of unexposed film, not of single dyes. Assumed: the dyes of "
        "kodak-vision3-250d-5207, all times one factor per wavelength (0.5 to 2; it differs from 1 by "
        f"{off:.2f}, root mean square), so that together they make the sheet's neutral.")


def mtf_remark(data):
    return bool(data.mtf) and len(data.mtf) == 1 and "The sheet has one curve for the whole film; it is assumed for each layer."


def negative(folder, slug, numbers):
    module, _, name, maker, sheet, year, iso, light, print_stock = NEGATIVES[slug]
    data = prepared(folder, "negative", slug)
    grain, grain_remark = grainy(folder, slug, iso, data, "negative")
    cine = print_stock == CINE
    speed = "the maker's exposure index" if cine else "an ISO speed"
    tungsten = " It is balanced for tungsten light: in daylight its prints are blue without an amber filter (Wratten 85) before the lens." if light == TUNGSTEN else ""
    stops = " counted in stops from the normal exposure, taken here as 10/S lx s of the reference light" if data.exposure_base == 2 else ""
    back = ("The black backing (rem-jet) absorbs nearly all of the light in the base. " if cine else
            "A layer of gray silver or of dye under the emulsion, cleared in processing, absorbs some of the light. ")
    remark = (f"Color negative for {'tungsten light' if light == TUNGSTEN else 'daylight'}; the speed is {speed}.{tungsten} The "
              f"sheet's curves are Status M densities of neutral exposures{stops}.")
    base.stock(
        slug, name=name, maker=maker, source=f"{sheet}, {base.CARRIED}", remark=remark,
        head=["", "process: negative", "density: status-m", f"year: {year}", f"iso: {iso}",
              *(["speed: exposure-index"] if cine else []), f"reference-illuminant: {light}", f"print: {print_stock}",
              *assumed([("dyes", dye_remark(data.dyes_off)), ("granularity", grain_remark), ("mtf", mtf_remark(data))]),
              base.halation("rem-jet" if cine else "dye", base.ENTERS + back + base.DEPTH, layers=[0.01, 0.25, 1]),
              base.ACETATE, f"minimum-density:\n  table:{base.flow(base.pairs(data.d_min_sd), '    ')}",
              base.interlayer(slug)],
        layers=layers_of(data, "negative", iso, numbers, grain))


def slide(folder, slug, numbers):
    _, _, name, maker, sheet, year, iso = SLIDES[slug]
    data = prepared(folder, "slide", slug)
    grain, grain_remark = grainy(folder, slug, iso, data, "slide")
    back = ("The black backing (rem-jet) absorbs nearly all of the light in the base. " if slug == "kodachrome-64" else
            "A layer of gray silver under the emulsion, bleached in processing, absorbs most of the light. ")
    base.stock(
        slug, name=name, maker=maker, source=f"{sheet}, {base.CARRIED}",
        remark="Color reversal film for daylight. The sheet's curves are Status A densities of neutral exposures.",
        head=["", "process: reversal", "density: status-a", f"year: {year}", f"iso: {iso}", f"reference-illuminant: {DAYLIGHT}",
              *assumed([("granularity", grain_remark), ("mtf", mtf_remark(data))]),
              base.halation("rem-jet" if slug == "kodachrome-64" else "silver", base.ENTERS + back + base.DEPTH, layers=[0.01, 0.25, 1]), base.ACETATE, *RECIPROCITY.get(slug, []),
              base.flat_minimum(*base.minima(data)),
              base.interlayer(slug)],
        layers=layers_of(data, "slide", iso, numbers, grain))


def print_stock(folder, slug, numbers):
    _, _, name, maker, sheet, year, medium, aim = PRINTS[slug]
    data = prepared(folder, "print", slug)
    if medium == "paper":
        remark = ("Color paper (process RA-4) for prints of still negatives. The exposures of its curves are relative to the "
                  "printing light, which is set for each negative; no speed is stated. Reflection densities are taken as sums "
                  "of its dyes' densities above the minimum.")
    else:
        remark = ("Print film for projection. The exposures of its curves are relative to the printing light, which is set for each "
                  "negative; no speed is stated.")
    head = ["", "process: print", *(["medium: paper"] if medium == "paper" else []), "density: status-a",
            *([f"year: {year}"] if year else []), "reference-illuminant: blackbody:3200"]
    if aim:
        head += ["# Kodak's laboratory aim density (LAD) for this stock, Status A.",
                 "aim-density: {red: %s, green: %s, blue: %s}" % aim]
    base.stock(slug, name=name, maker=maker, source=f"{sheet}, {base.CARRIED}", remark=remark,
               head=[*head, base.flat_minimum(*base.minima(data))],
               layers=layers_of(data, "paper" if medium == "paper" else "print", None, numbers, None))


def silver(folder, slug):
    name, maker, sheet, year, iso, rms, k_mm, gradient = SILVER[slug]
    seen = base.pairs(base.load(folder, "bw_negative_film.kodak_trix_400", "KODAK_TRI_X_400").log_sensitivity[0])
    lines = base.layer("panchromatic", seen, [], assumed_sensitivity=True, mtf=base.frieser(k_mm), sensitivity_remark=(
        "No free digitization of the sheet's figure is known. This is the sensitivity of Tri-X (F-4017), which is also "
        "panchromatic."))
    curve = [
        "    curves:", "      - development: pictorial", "        assumed: true", f"        average-gradient: {gradient}",
        "        maximum-density: 2.4", "        toe: 0.2", "        shoulder: 4", "        remark: " + base.folded(
            "No free digitization of the sheet's figure is known. The curve passes through the ISO speed point with a usual "
            "pictorial gradient; density above base and fog.", "          ")]
    if rms:
        grain = f"granularity: {{rms: {rms}, aperture: 0.048 mm, density: 1}}"
    else:
        rms = {125: 11, 400: 16}[iso]
        grain = f"granularity:\n  rms: {rms}\n  assumed: true\n  remark: " + base.folded(
            "The sheet states none. The value lies between those of similar films: 8 for T-Max 100, 14 for Double-X (EI 250), "
            "17 for Tri-X.",
            "    ")
    half = 2.302585 / (3.141593 * k_mm)
    base.stock(
        slug, name=name, maker=maker,
        source=f"{sheet} (speed{', granularity' if SILVER[slug][5] else ''}); sensitivity of Tri-X 400, F-4017, {base.CARRIED}",
        remark="Based on published figures, not on curves: speed" + (" and granularity are" if SILVER[slug][5] else " is")
        + " as stated; sensitivity, curve, modulation transfer and halation are those of similar films.",
        head=["", "process: negative", "density: visual", f"year: {year}", f"iso: {iso}", f"reference-illuminant: {DAYLIGHT}",
              *assumed([("mtf", f"By Frieser's formula with k = {k_mm} mm, half of the contrast is left at {half:.0f} cycles/mm. H. Frieser "
                         "(Photogr. Sci. Eng. 4, 324, 1960) gives k of 0.005 to 0.04 mm for emulsions.")]),
              grain, base.halation("dye", base.ENTERS + "Base and dye under the emulsion are as in Tri-X: they transmit 0.35 in "
                                                        "one pass."), base.ACETATE,
              *RECIPROCITY.get(slug, [])],
        layers=[[*lines[:-1], *curve]])


def main():
    folder = pathlib.Path(sys.argv[1])
    base.prepare(folder)
    numbers = json.loads(NUMBERS.read_text(encoding="utf-8")) if NUMBERS.exists() else {}
    for slug in NEGATIVES:
        negative(folder, slug, numbers.get(slug))
    for slug in SLIDES:
        slide(folder, slug, numbers.get(slug))
    for slug in SILVER:
        silver(folder, slug)
    for slug in PRINTS:
        print_stock(folder, slug, numbers.get(slug))


if __name__ == "__main__":
    main()
