"""Traces ghost rays with another program and writes tests/data/ghost-rays.csv.

The rays follow paths of two reflections. optiland (MIT; K. Harrison and contributors, https://github.com/HarrisonKramer/optiland), version
0.6.3, traces them by `Optic.add_sequence` with `(surface, "reflect")` steps, in double precision. The lenses are those of
tests/data/lenses at their stated indices, without clear apertures. Columns: the lens; the two surfaces that reflect, counted from 1; a
point of the ray and its direction before the lens (mm, vertex of the first surface at the origin); the point where it meets the image
plane, and its direction there.

    pip install optiland==0.6.3 pyyaml
    python xtask/ghost_rays.py > tests/data/ghost-rays.csv
"""

import math
import pathlib
import random

import numpy as np
import yaml
from optiland.materials import IdealMaterial
from optiland.optic import Optic
from optiland.rays import RealRays

LENSES = {
    "zeiss-biotar-50-f1.4": [(2, 1), (5, 3), (8, 5), (11, 1), (9, 7)],
    "helios-44-58-f2": [(3, 1), (4, 2), (7, 4), (11, 8), (10, 1)],
    "cooke-triplet-50-f5": [(2, 1), (3, 2), (6, 1), (5, 2), (4, 3)],
}
RAYS = 4
D_UM = 0.5875618
FOLDER = pathlib.Path(__file__).parent.parent / "tests/data/lenses"


def optic(surfaces):
    lens = Optic()
    lens.surfaces.add(index=0, thickness=np.inf)
    for at, row in enumerate(surfaces, 1):
        stop = row.get("kind") == "stop" or bool(row.get("stop"))
        glass = {"material": IdealMaterial(n=row["nd"])} if "nd" in row else {}
        radius = row.get("radius", math.inf)
        lens.surfaces.add(
            index=at, radius=float(radius), thickness=float(row["thickness"]), is_stop=stop, **glass
        )
    lens.surfaces.add(index=len(surfaces) + 1)
    lens.set_aperture(aperture_type="EPD", value=5)
    lens.fields.set_type(field_type="angle")
    lens.fields.add(y=0)
    lens.wavelengths.add(value=D_UM, is_primary=True)
    return lens


def main():
    draw = random.Random(15)
    print("lens,first,second,x_mm,y_mm,z_mm,l,m,n,image_x_mm,image_y_mm,image_l,image_m,image_n")
    for name, pairs in LENSES.items():
        surfaces = yaml.safe_load((FOLDER / f"{name}.yaml").read_text())["surfaces"]
        for first, second in pairs:
            lens = optic(surfaces)
            image = len(surfaces) + 1
            down = [(first, "reflect"), *range(first - 1, second, -1), (second, "reflect")]
            steps = [*range(first), *down, *range(second + 1, image + 1)]
            sequence = lens.add_sequence("ghost", steps)
            found = 0
            while found < RAYS:
                x, y = (draw.uniform(-4, 4) for _ in range(2))
                l, m = (draw.uniform(-0.05, 0.05) for _ in range(2))
                n = math.sqrt(1 - l * l - m * m)
                z = -10.0
                rays = RealRays(*([value] for value in (x - 10 * l / n, y - 10 * m / n, z, l, m, n, 1.0, D_UM)))
                out = sequence.surfaces.trace(rays)
                end = [float(v[0]) for v in (out.x, out.y, out.L, out.M, out.N)]
                if not all(math.isfinite(v) for v in end) or end[4] <= 0 or math.hypot(*end[:2]) > 200:
                    continue
                found += 1
                start = (x - 10 * l / n, y - 10 * m / n, z, l, m, n)
                print(",".join([name, str(first), str(second), *(repr(v) for v in (*start, *end))]))


main()
