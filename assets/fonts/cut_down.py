"""Cuts the Inter typeface down to what the window uses.

python3 cut_down.py FOLDER: reads Inter-Regular.woff2 and Inter-Medium.woff2 of Inter 4.1 (SIL Open Font License, OFL.txt) from
FOLDER and writes Inter-Regular.ttf and Inter-Medium.ttf beside this file: Latin, Greek, arrows, signs of mathematics and marks,
with figures of equal width as the usual ones, for egui chooses no features of a font. Needs fonttools and brotli.
"""

import pathlib
import sys

from fontTools import subset
from fontTools.ttLib import TTFont

MARKS = "−–—…‘’“”·•→←↑↓↔⇧⌘×÷±≈≤≥≠∞√∑∂∫Δ°′″½¼¾²³¹⁰⁴⁵⁶⁷⁸⁹⁻⁺₀₁₂₃₄₅₆₇₈₉ⁿ★☆●○◆◇■□▲△▼▽✓✗⚠⏎\u2007\u2009\u202f\u2060"
WANTED = {*range(0x20, 0x7F), *range(0xA0, 0x180), *range(0x370, 0x400), 0x302, 0x303, 0x304, *map(ord, MARKS)}
OF_EQUAL_WIDTH = set(map(ord, "0123456789+−±"))


def figures_of_equal_width(font):
    table = font["GSUB"].table
    lookups = [index for record in table.FeatureList.FeatureRecord if record.FeatureTag == "tnum"
               for index in record.Feature.LookupListIndex]
    replaced = {}
    for index in lookups:
        for part in table.LookupList.Lookup[index].SubTable:
            replaced.update(getattr(getattr(part, "ExtSubTable", part), "mapping", {}))
    for table in font["cmap"].tables:
        table.cmap.update({code: replaced[glyph] for code, glyph in table.cmap.items()
                           if code in OF_EQUAL_WIDTH and glyph in replaced})


def main():
    here = pathlib.Path(__file__).parent
    for weight in ("Regular", "Medium"):
        font = TTFont(pathlib.Path(sys.argv[1]) / f"Inter-{weight}.woff2")
        font.flavor = None
        figures_of_equal_width(font)
        options = subset.Options(layout_features=["kern", "mark", "mkmk", "ccmp"], hinting=False)
        subsetter = subset.Subsetter(options)
        subsetter.populate(unicodes=WANTED)
        subsetter.subset(font)
        font.save(here / f"Inter-{weight}.ttf")


main()
