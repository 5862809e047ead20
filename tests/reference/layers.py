#!/usr/bin/env python3
"""Reads layers.exr with the reference implementation of OpenEXR: names, grouping, values, sum.

    python3 -m venv venv && venv/bin/pip install OpenEXR==3.5.3 numpy
    rastray compare whitted --shading phong --size 160x120 -o out
    rastray render whitted --shading phong --size 160x120 --mode trace -o trace.pfm
    rastray render whitted --shading phong --size 160x120 --mode raster -o raster.pfm
    venv/bin/python tests/reference/layers.py out/layers.exr trace.pfm raster.pfm

Exits 1 where something is not as it says: every layer has R, G and B; the layers add up to the picture bit for bit, in
the order that the file states; the picture is that of the .pfm file bit for bit, and the rasterizer's layers add up to the
other .pfm file (both are optional).
"""

import sys

import numpy as np
import OpenEXR


def read_pfm(path):
    with open(path, "rb") as file:
        magic, size, scale = (file.readline().strip() for _ in range(3))
        assert magic == b"PF", f"{path} is not a colour PFM"
        width, height = map(int, size.split())
        kind = "<f4" if float(scale) < 0 else ">f4"
        return np.frombuffer(file.read(), kind).reshape(height, width, 3)[::-1]


def same_bits(a, b):
    return np.array_equal(np.ascontiguousarray(a, np.float32).view(np.uint32),
                          np.ascontiguousarray(b, np.float32).view(np.uint32))


def main():
    with OpenEXR.File(sys.argv[1], separate_channels=True) as file:
        assert len(file.parts) == 1, "one part"
        comments = file.header()["comments"]
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    layers = {}
    for name, pixels in channels.items():
        assert pixels.dtype == np.float32, name
        layer, _, channel = name.rpartition(".")
        layers.setdefault(layer, {})[channel] = pixels
    print(f"OpenEXR {OpenEXR.__version__}: {len(channels)} channels in {len(layers)} layers")
    for layer, found in layers.items():
        assert sorted(found) == ["B", "G", "R"], f"{layer}: {sorted(found)}"
        largest = max(float(np.abs(p).max()) for p in found.values())
        print(f"  {layer or '(the picture)':28} largest value {largest:.6g}")

    def plane(layer):
        return np.stack([layers[layer][c] for c in "RGB"], axis=-1)

    order = comments.split("in this order:\n")[1].split("\n")
    failures = []
    for prefix, picture, path in [("", plane(""), 2), ("raster.", None, 3)]:
        total = np.zeros_like(plane(""))
        for name in order:
            total = total + plane(prefix + name)  # float32, in the stated order
        who = prefix or "the picture"
        if picture is not None and not same_bits(total, picture):
            failures.append(f"{who}: the layers do not add up to it")
        if len(sys.argv) > path and not same_bits(total, read_pfm(sys.argv[path])):
            failures.append(f"{who}: it is not {sys.argv[path]}")
    print("\n".join(failures) or "all layers complete; sums and pictures equal bit for bit")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
