#!/usr/bin/env python3
"""Writes docs/lenses.md and docs/images/lenses: each lens of the library as a drawing and as a picture of a chart.

Run from the root of the repository:

    python3 xtask/lens_sheet.py target/release/spectra [NAME...]

With names, the script makes only the pictures of these lenses; the page always covers all lenses.
"""

import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LENSES = ROOT / "lenses"
IMAGES = ROOT / "docs" / "images" / "lenses"

# Frames other than 135 in which some lenses are shown: lenses normalized to 100 mm have larger image circles.
FORMATS = {
    "angenieux-100-f1.1": "6x4.5",
    "meyer-primoplan-100-f1.5": "6x4.5",
    "nikon-retrofocus-100-f2.8": "6x9",
    "zeiss-biotar-100-f1.4": "6x4.5",
    "asahi-takumar-100-f1.2": "6x4.5",
    "nikkor-100-f1.4": "6x4.5",
    "kodak-petzval-100-f2.2": "academy",
    "schneider-anamorphic-60": "super-35",
}
SIZES = {"135": (36, 24), "6x4.5": (56, 41.5), "6x9": (84, 56), "academy": (22, 16), "super-35": (24.89, 18.67)}

SCENE = """spectra: 1
source: {{kind: chart, chart: resolution, distance: {distance} mm, width: {width} mm, illuminant: D65, luminance: 300 cd/m2}}
lens: {{file: {name}, focus: {focus}}}
imager: {{kind: xyz, format: {format}, resolution: [{columns}, {rows}]}}
render: {{samples: 256, seed: 1}}
output: [png]
"""


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr}")
    return done.stdout


def names():
    """Returns the names of the lenses with a stop, which leaves out prisms."""
    has_stop = re.compile(r"kind: stop|stop: true")
    return sorted(p.stem for p in LENSES.glob("*.yaml") if has_stop.search(p.read_text(encoding="utf-8")))


def pictures(program, name, info):
    section = "x" if info.get("efl_x_mm") else "y"
    run(program, "lens", "draw", name, "--section", section, "--width", "640", "--wavelengths", "e", "-o", IMAGES / f"{name}.svg")
    frame = FORMATS.get(name, "135")
    width, height = SIZES[frame]
    # The chart stands at 2 m, or at forty focal lengths if that is farther; the cylinders of an anamorphic are set for infinity. The
    # chart fills the frame; that of a fisheye is wider.
    focal = info.get("efl_x_mm") or info["efl_mm"]
    distance = 1e6 if info.get("efl_x_mm") else max(2000.0, 40 * info["efl_mm"])
    across = width / focal * distance * (2.2 if "fisheye" in name else 1.0)
    rows = 160
    scene = SCENE.format(
        name=name, format=frame, distance=round(distance), width=round(1.02 * across), columns=round(rows * width / height / 2) * 2,
        rows=rows, focus=f"{round(distance)} mm",
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        # The file must not be named like the lens: files in the folder of a scene take precedence over bundled ones.
        path = Path(folder) / "shot.yaml"
        path.write_text(scene, encoding="utf-8")
        run(program, "run", path, "--output", folder, "--quiet", "--threads", "1")
        (IMAGES / f"{name}-chart.png").write_bytes((Path(folder) / "shot.png").read_bytes())


def head(name):
    """Returns the plain keys of a lens file."""
    found = {}
    for line in (LENSES / f"{name}.yaml").read_text(encoding="utf-8").splitlines():
        if match := re.match(r"([a-z-]+): (.+)", line):
            found[match[1]] = match[2].strip('"')
    return found


def page(infos):
    lines = [
        "# The lens library",
        "",
        "Every lens in `lenses/`, with a drawing and a picture. The drawing has rays of the e line on the axis, and at 0.6 and 0.95 of the largest",
        "field that passes. The picture is the resolution chart through the lens, wide open and focused at 2 m or forty focal lengths (the",
        "anamorphic at 1 km). Focal length and f-number are those of the reference line, by the real marginal ray. The file of each lens says where",
        "it comes from and what is doubtful; `tests/it/lenses.rs` compares the lenses with the figures of their patents. `xtask/lens_sheet.py`",
        "writes this page.",
        "",
        "Rims decide the light of corners and the shapes of blurs, but patents seldom state them. Rims that are *computed* pass the axial beam and",
        "half of the beam at the edge of the field. Rims that are *guessed* are figures of whoever drew the lens. Rims that are *fitted* give the",
        "light that was measured with a real copy.",
        "",
        "A lens named 100 mm whose image circle is larger than 135 is shown as its patent has it, normalized; the name of its frame follows.",
        "",
    ]
    for name, info in infos.items():
        about = head(name)
        facts = [f"f = {info['efl_mm']:.2f} mm"]
        across = info.get("efl_x_mm")
        if across and abs(across / info["efl_mm"] - 1) > 1e-3:
            facts.append(f"across {across:.2f} mm")
        if info.get("f_number"):
            facts.append(f"f/{info['f_number']:.2f}")
        facts += [about[k] for k in ("year", "patent") if k in about]
        facts.append(FORMATS.get(name, "135"))
        rims = info["rims"] if isinstance(info["rims"], str) else f"fitted to {info['rims']['fitted']}"
        lines += [
            f"## {about['name']}",
            "",
            f"`{name}`: {', '.join(facts)}. Source: {about['source']}. Rims: {rims}.",
            "",
            f"![{about['name']}, drawing](images/lenses/{name}.svg)",
            f"![{about['name']}, chart](images/lenses/{name}-chart.png)",
            "",
        ]
    (ROOT / "docs" / "lenses.md").write_text("\n".join(lines), encoding="utf-8")


def main():
    program = Path(sys.argv[1]).resolve()
    IMAGES.mkdir(parents=True, exist_ok=True)
    infos = {name: json.loads(run(program, "lens", "info", name, "--json")) for name in names()}
    wanted = sys.argv[2:] or list(infos)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda name: pictures(program, name, infos[name]), wanted))
    page(infos)
    total = sum(p.stat().st_size for p in IMAGES.glob("*"))
    print(f"{len(infos)} lenses, {total / 1e6:.2f} MB of pictures")


if __name__ == "__main__":
    main()
