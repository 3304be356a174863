"""Writes the lens files of tests/data/lenses from the prescriptions in tests/data/lenses.csv.

One row of the CSV is one surface, and becomes one line of the file. Figures are copied digit by digit; nothing is computed.
Run from the root of the repository: python3 xtask/lenses_from_csv.py
"""

import csv
from pathlib import Path

DATA = Path(__file__).resolve().parent.parent / "tests" / "data"
# Lenses with reference values of their own: rays, first-order values, or both.
NAMES = """
    angenieux-100-f1.1 asahi-takumar-100-f1.2 canon-fd-50-f1.8 cooke-triplet-50-f5 helios-44-58-f2
    kodak-petzval-100-f2.2 leica-summilux-35-f1.4 meyer-primoplan-100-f1.5 minolta-fisheye-1-f2.7
    nikkor-100-f1.4 nikon-retrofocus-100-f2.8 zeiss-biotar-50-f1.4 zeiss-hologon-15-f8
""".split()
KINDS = {"spherical": "sphere", "plane": "plane", "stop": "stop"}


def rows(name):
    with open(DATA / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def quoted(text):
    """Quotes a text so that YAML reads it as text and nothing else."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def surface(row):
    kind = KINDS[row["type"]]
    if row["asphere_coefficients"]:
        raise ValueError(f"{row['lens']} {row['surface']}: an asphere")
    entries = [("kind", kind)]
    if kind == "sphere":
        entries.append(("radius", row["radius_mm"]))
    elif row["radius_mm"] != "inf":
        raise ValueError(f"{row['lens']} {row['surface']}: a {kind} with a radius")
    entries.append(("thickness", row["thickness_mm"]))
    # A stop keeps its surrounding medium. Without an entry the medium is air.
    if kind != "stop" and float(row["nd_after"]) != 1.0:
        entries += [("nd", row["nd_after"]), ("vd", row["vd_after"])]
    if float(row["semi_diameter_mm"] or 0) > 0:
        entries.append(("semi-diameter", row["semi_diameter_mm"]))
    return "  - {" + ", ".join(f"{key}: {value}" for key, value in entries) + "}"


def lens(entry, surfaces):
    lines = ["# Written by xtask/lenses_from_csv.py from tests/data/lenses.csv."]
    lines.append(f"name: {quoted(entry['name'])}")
    if entry["year"]:
        lines.append(f"year: {entry['year']}")
    if entry["patent"]:
        lines.append(f"patent: {quoted(entry['patent'])}")
    lines.append("reference-line: d")
    lines.append("surfaces:")
    lines += [surface(row) for row in surfaces]
    return "\n".join(lines) + "\n"


def main():
    index = {entry["lens"]: entry for entry in rows("lenses-index.csv")}
    surfaces = rows("lenses.csv")
    for name in NAMES:
        text = lens(index[name], [row for row in surfaces if row["lens"] == name])
        (DATA / "lenses" / f"{name}.yaml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
