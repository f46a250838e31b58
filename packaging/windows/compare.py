"""Compares two JSON files of results: compare.py A.json B.json prints the largest relative difference of their numbers.

Status 1 if they differ in anything but numbers, or by more than 1e-6.
"""

import json
import sys

LARGEST = 1e-6
# Keys whose values may differ: the program that wrote the file, and folders.
IGNORED = {"software"}


class Difference:
    """Largest relative difference so far, and other differences."""

    def __init__(self):
        self.largest = 0.0
        self.at = ""
        self.others = []

    def compare(self, a, b, path):
        if isinstance(a, bool) or isinstance(b, bool) or type(a) in (str, type(None)):
            if a != b:
                self.others.append(f"{path}: {a!r}, {b!r}")
        elif isinstance(a, (int, float)) and isinstance(b, (int, float)):
            # Values near zero, such as entries that consist of rounding errors, are compared absolutely.
            difference = abs(a - b) / max(abs(a), abs(b), 1e-6)
            if difference > self.largest:
                self.largest, self.at = difference, path
        elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
            for index, (x, y) in enumerate(zip(a, b)):
                self.compare(x, y, f"{path}[{index}]")
        elif isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
            for key in a:
                if key not in IGNORED:
                    self.compare(a[key], b[key], f"{path}.{key}")
        else:
            self.others.append(f"{path}: different structure")


def main():
    documents = []
    for path in sys.argv[1:3]:
        with open(path, encoding="utf-8") as file:
            documents.append(json.load(file))
    difference = Difference()
    difference.compare(documents[0], documents[1], "")
    print(f"{sys.argv[1]}: largest relative difference {difference.largest:.1e} at {difference.at or 'none'}")
    for text in difference.others[:5]:
        print(f"  {text[:160]}")
    sys.exit(1 if difference.others or difference.largest > LARGEST else 0)


main()
