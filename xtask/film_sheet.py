#!/usr/bin/env python3
"""Writes docs/films.md and docs/images/films: one photograph on each bundled camera film, printed or projected as its maker recommends.

Run from the root of the repository:

    VENV/bin/python xtask/film_sheet.py target/release/spectra [NAME...]

With names, the script makes only the pictures of these films; `-` makes none. The page always covers all films. Making pictures needs
numpy.

The photograph is a still life by a window (xtask/still_life.py), through a lens at f/8. It is exposed half a stop below its gray card,
so that the white jug keeps its detail. All films for one light are developed from one render. Films for tungsten light are
photographed in tungsten light: the illuminant of the scene is theirs.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STOCKS = ROOT / "spectra" / "film"
IMAGES = ROOT / "docs" / "images" / "films"
SIZE = (360, 240)
ACROSS = 3
# Films developed from one render; the program takes up to 16.
TOGETHER = 12

SCENE = """spectra: 1
source: {{kind: picture, file: {picture}, distance: 1.5 m, width: fill, edge: mirror, illuminant: {light}, luminance: 300 cd/m2}}
lens: {{file: nikkor-100-f1.4, f-number: f/8, focus: 1.5 m}}
imager: {{kind: film, format: 135, crop: "3:2", resolution: [{width}, {height}]}}
film:
{films}
render: {{samples: 96, seed: 1}}
output: [png]
"""
# The middle of the gray card.
SPOT = "{center: [0.89, 0.635], diameter: 0.12}"
MADE_FOR = {"iso-7589-sensitometric-daylight": "D55", "iso-7589-sensitometric-studio-tungsten": "iso-7589-studio-tungsten"}
# Why people choose a film, in a sentence: from its maker's description and its reputation.
CHOSEN_FOR = {
    "cinestill-800t": "Night streets: wide red halos around lamps, cool where light is not tungsten.",
    "fuji-c200": "Plain daylight snapshots, greens that stay fresh.",
    "fuji-eterna-500": "Soft cinema for tungsten light, with open shadows.",
    "fuji-natura-1600": "Rooms by lamplight without a flash; hard, with coarse grain.",
    "fuji-pro-160s": "Weddings and portraits: the quietest skin of the negatives.",
    "fuji-pro-400h": "Airy portraits, often overexposed: pale greens, calm skin.",
    "fuji-provia-100f": "The slide that takes no side: neutral, fine grain.",
    "fuji-superia-reala-100": "Fine daylight color of the 1990s, true greens.",
    "fuji-superia-x-tra-400": "The holiday film: contrast and color in any light.",
    "fuji-velvia-50": "Landscapes: the most saturated slide, deep shadows.",
    "kodachrome-64": "Magazine color of the 1970s: deep reds, restrained rest, hard light.",
    "kodak-ektachrome-100d": "Clean, cool slides, brighter color than the scene.",
    "kodak-ektar-100": "The most saturated negative, for things rather than faces.",
    "kodak-exr-100t-5248": "Cinema of the 1990s in the studio: dense, quiet color.",
    "kodak-gold-200": "Warm family pictures in the sun.",
    "kodak-portra-160": "Studio portraits: soft, natural skin.",
    "kodak-portra-400": "The portrait film for any light: natural skin, wide latitude.",
    "kodak-portra-800": "Portraits by lamplight.",
    "kodak-ultramax-400": "Snapshots in any weather, cheerful color.",
    "kodak-vericolor-iii": "Portraits of the 1980s.",
    "kodak-vision3-200t-5213": "Cinema in the studio: clean shadows for grading.",
    "kodak-vision3-250d-5207": "Cinema by daylight: soft, with long highlights.",
    "kodak-vision3-500t-5219": "Cinema at night, by practical lamps.",
    "kodak-vision3-50d-5203": "Cinema in the sun, the finest grain of the four.",
    "blue-sensitive-plate": "The 19th century: white skies, dark lips, freckles.",
    "panchromatic-plate": "The 1930s: all colors as grays, softly.",
    "ilford-fp4-plus": "The all-round film for good light: smooth, fine grain.",
    "ilford-hp5-plus": "Reportage in any light; takes any push.",
    "ilford-ortho-plus": "Blind to red: dark lips and skies without clouds.",
    "kodak-double-x-5222": "Black-and-white cinema since 1959: long grays, grain that is seen.",
    "kodak-t-max-100": "The finest grain, clinical grays.",
    "kodak-t-max-400": "Speed with fine grain.",
    "kodak-tri-x-400": "The reportage film: gritty grain, hard when pushed.",
}
KINDS = (
    ("Color negatives", lambda s: len(s["layers"]) == 3 and s["process"] == "negative"),
    ("Color reversal films", lambda s: s["process"] == "reversal"),
    ("Black and white", lambda s: len(s["layers"]) == 1),
)


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr}")
    return done.stdout


def shoot(program, stocks, wanted):
    """Makes the pictures of the wanted films."""
    import still_life

    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "still-life.exr"
        still_life.write(picture)
        expose(program, picture, stocks, wanted)


def expose(program, picture, stocks, wanted):
    for illuminant, light in MADE_FOR.items():
        names = [n for n, s in stocks.items() if s["reference_illuminant"] == illuminant]
        if light == "D55":
            names.append("three-strip")
        names = [n for n in names if n in wanted]
        for k in range(0, len(names), TOGETHER):
            develop(program, picture, light, names[k:k + TOGETHER])


def develop(program, picture, light, names):
    """Makes the pictures of a few films from one render."""
    what = {n: "kind: three-strip" if n == "three-strip" else f"stock: {n}" for n in names}
    films = [f"  - {{name: {n}, {what[n]}, metering: spot, spot: {SPOT}, compensation: -0.5}}" for n in names]
    if films:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "sheet.yaml"
            path.write_text(SCENE.format(picture=picture, light=light, width=SIZE[0], height=SIZE[1], films="\n".join(films)),
                            encoding="utf-8")
            run(program, "run", path, "--output", folder, "--quiet")
            for name in names:
                (IMAGES / f"{name}.png").write_bytes((Path(folder) / f"sheet-{name}.png").read_bytes())


def facts(stock):
    speed = {"iso": "ISO", "exposure-index": "EI", "assumed": "ISO (assumed)"}[stock["speed_kind"]]
    light = ", tungsten" if "tungsten" in stock["reference_illuminant"] else ""
    said = [f"{speed} {stock['iso']:g}{light}"]
    if stock["year"]:
        said.append(str(stock["year"]))
    if stock["print"]:
        said.append(f"on {stock['print']}")
    return ", ".join(said)


def what_is_assumed(stock):
    parts = dict(stock["assumed"])
    if any(layer["assumed"] for layer in stock["layers"]):
        parts["sensitivity"] = ""
    if any(d["assumed"] for layer in stock["layers"] for d in layer["developments"]):
        parts["curve"] = ""
    for key in ("granularity", "interlayer", "halation", "minimum_density"):
        if stock.get(key) and stock[key].get("assumed"):
            parts[key.replace("_", " ")] = ""
    if any("(assumed)" in (d["remark"] or "") for layer in stock["layers"] for d in layer["developments"]):
        parts["gray balance"] = ""
    if any("(assumed)" in (layer["remark"] or "") for layer in stock["layers"]):
        parts["sensitivity by 3 nm"] = ""
    return sorted(parts)


def cells(row, of):
    row = [of(name) for name in row] + [""] * (ACROSS - len(row))
    return "| " + " | ".join(row) + " |"


def page(stocks, prints):
    lines = [
        "# The film library", "",
        "One photograph on each bundled film, as its maker wants it printed or projected: black and white on paper of grade 2, color",
        "negatives on the paper or print film that their file names, reversal films projected. The picture is a still life by a window",
        "(drawn by `xtask/still_life.py`), photographed through the Nikkor 100 mm at f/8. It is exposed half a stop below what the gray card",
        "asks for, in the light that the film is made for. Pictures are small here: 360 pixels for a frame 36 mm wide, so grain looks as on the",
        "whole frame at arm's length. `xtask/film_sheet.py` writes this page. Each file under `spectra/film/` says where its figures come from,",
        "what is assumed and why; `spectra film info NAME` shows it.", "",
    ]
    for title, belongs in KINDS:
        names = sorted((n for n, s in stocks.items() if belongs(s)), key=lambda n: stocks[n]["name"])
        lines += [f"## {title}", ""]
        rows = [names[i:i + ACROSS] for i in range(0, len(names), ACROSS)]
        for k, row in enumerate(rows):
            lines.append(cells(row, lambda n: f"![{stocks[n]['name']}](images/films/{n}.png)"))
            if k == 0:
                lines.append("|" + " --- |" * ACROSS)
            lines.append(cells(row, lambda n: f"**{stocks[n]['name']}**<br>`{n}`<br>{CHOSEN_FOR[n]}<br>{facts(stocks[n])}"))
        lines.append("")
    lines += ["## Three strips", "", "The film process `three-strip`: three separation negatives on Double-X, printed by dye transfer.", "",
              "![Three-strip camera](images/films/three-strip.png)", "", "## What is assumed", "",
              "| film | source | assumed |", "|---|---|---|"]
    everything = {**stocks, **prints}
    for name in sorted(everything):
        stock = everything[name]
        lines.append(f"| `{name}` | {stock['source']} | {', '.join(what_is_assumed(stock)) or 'nothing'} |")
    lines += ["", "## What negatives are printed on", "", "| stock | kind | made for |", "|---|---|---|"]
    for name, stock in sorted(prints.items()):
        medium = "paper" if "medium: paper" in (STOCKS / f"{name}.yaml").read_text(encoding="utf-8") else "film"
        made_for = ", ".join(f"`{n}`" for n, s in sorted(stocks.items()) if s["print"] == name) or "-"
        lines.append(f"| `{name}` | {stock['name']}, {medium} | {made_for} |")
    (ROOT / "docs" / "films.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    program = Path(sys.argv[1]).resolve()
    IMAGES.mkdir(parents=True, exist_ok=True)
    names = sorted(p.stem for p in STOCKS.glob("*.yaml"))
    infos = {n: json.loads(run(program, "film", "info", n, "--json")) for n in names}
    stocks = {n: s for n, s in infos.items() if s["process"] != "print"}
    wanted = sys.argv[2:] or [*stocks, "three-strip"]
    if wanted != ["-"]:
        shoot(program, stocks, wanted)
    page(stocks, {n: s for n, s in infos.items() if n not in stocks})
    total = sum(p.stat().st_size for p in IMAGES.glob("*"))
    print(f"{len(stocks)} films, {total / 1e6:.2f} MB of pictures")


if __name__ == "__main__":
    main()
