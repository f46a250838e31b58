"""Joins PNG pictures into an icon of Windows: make_ico.py OUT.ico PNG..."""

import struct
import sys


def size_of(png):
    """Returns width and height from the header of a PNG picture."""
    return struct.unpack(">II", png[16:24])


def main():
    out, *paths = sys.argv[1:]
    pictures = []
    for path in paths:
        with open(path, "rb") as file:
            pictures.append(file.read())
    # Header: reserved, type (1: icon), number of pictures. Then 16 bytes for each picture.
    head = struct.pack("<HHH", 0, 1, len(pictures))
    offset = len(head) + 16 * len(pictures)
    for png in pictures:
        width, height = size_of(png)
        # A size of 256 is written as 0.
        head += struct.pack("<BBBBHHII", width % 256, height % 256, 0, 0, 1, 32, len(png), offset)
        offset += len(png)
    with open(out, "wb") as file:
        file.write(head + b"".join(pictures))


main()
