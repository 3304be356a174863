"""Interimage effects: how the layers of a color film influence each other in development.

There is one matrix for each family of films and one strength for each class.

No sheet states them. Makers use them to correct the unwanted absorption of the dyes, which is published:
W. T. Hanson and C. A. Horton, "Subtractive color reproduction: interimage effects", J. Opt. Soc. Am. 42, 663 (1952); C. R. Barr,
J. R. Thirtle and P. W. Vittum, "Development-inhibitor-releasing couplers and their use in color photography", Photogr. Sci. Eng. 13, 74
(1969). How strong they are in which film is assumed: xtask/fit_film_families.py fits both for all films at once and writes
xtask/film_families.json.
"""

import json
import pathlib

NUMBERS = pathlib.Path(__file__).with_name("film_families.json")

# Films of each process; the time is named if a process has films of both times.
FAMILIES = {
    "c-41 to 1999": ("kodak-vericolor-iii", "kodak-portra-800", "fuji-superia-reala-100", "fuji-superia-x-tra-400"),
    "c-41": ("kodak-portra-160", "kodak-portra-400", "kodak-ektar-100", "kodak-gold-200", "kodak-ultramax-400", "fuji-pro-160s",
             "fuji-pro-400h", "fuji-c200", "fuji-natura-1600"),
    "ecn-2": ("kodak-vision3-250d-5207", "kodak-vision3-50d-5203", "kodak-vision3-200t-5213", "kodak-vision3-500t-5219",
              "kodak-exr-100t-5248", "fuji-eterna-500"),
    "e-6": ("kodak-ektachrome-100d", "fuji-velvia-50", "fuji-provia-100f"),
    "k-14": ("kodachrome-64",),
}
WORDS = {"c-41 to 1999": "color negatives (process C-41) of the years to 1999", "c-41": "color negatives (process C-41) since 2000",
         "ecn-2": "color negatives for cinema (process ECN-2)", "e-6": "slide films (process E-6)", "k-14": "Kodachrome"}

# Saturation of the films of a class: CIE 1976 saturation of the 18 chromatic patches of the ColorChecker relative to what the eye
# sees, as a mean. The values follow what the makers promise: "ultra-vivid" (Ektar), "the world's most saturated" (Velvia), "natural"
# skins (Portra, Pro). Consumer films and slides lie between; cinema films and Kodachrome are like negatives for portraits.
CLASSES = {
    "portrait": (0.97, ("kodak-vericolor-iii", "kodak-portra-160", "kodak-portra-400", "kodak-portra-800", "fuji-pro-160s", "fuji-pro-400h")),
    "cinema": (0.97, FAMILIES["ecn-2"]),
    "consumer": (1.11, ("kodak-gold-200", "kodak-ultramax-400", "fuji-c200", "fuji-superia-reala-100", "fuji-superia-x-tra-400",
                        "fuji-natura-1600")),
    "slide": (1.11, ("kodak-ektachrome-100d", "fuji-provia-100f")),
    "saturated": (1.25, ("kodak-ektar-100", "fuji-velvia-50")),
    "Kodachrome": (0.97, ("kodachrome-64",)),
}


def family_of(slug):
    return next(family for family, members in FAMILIES.items() if slug in members)


def class_of(slug):
    return next(name for name, (_, members) in CLASSES.items() if slug in members)


def inhibition(slug):
    """Returns the matrix of inhibitions: log10 of the exposure that a layer (row) loses per unit of dye in another (column); blue,
    green, red."""
    numbers = json.loads(NUMBERS.read_text(encoding="utf-8"))
    strength = numbers["strengths"][class_of(slug)]
    return [[round(strength * v, 3) for v in row] for row in numbers["matrices"][family_of(slug)]]


def remark(slug):
    return (f"One matrix for all {WORDS[family_of(slug)]}, times a strength for the class `{class_of(slug)}`, fitted for all films "
            "together so that skies, leaves and skins keep their hue as far as one matrix allows, and each class is as saturated as its "
            "makers promise (xtask/fit_film_families.py). Rows and columns are blue, green, red. No sheet states it.")
