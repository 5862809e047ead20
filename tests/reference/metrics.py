#!/usr/bin/env python3
"""Makes metrics.json: PSNR, SSIM and FLIP of pairs of pictures, computed by packages that others wrote.

    python3 -m venv venv && venv/bin/pip install flip-evaluator==1.7 scikit-image==0.26.0
    venv/bin/python tests/reference/metrics.py

PSNR and SSIM: scikit-image (Gaussian windows of 11 x 11, sigma 1.5, population covariance, range 1, luma of the stored
values). FLIP: flip-evaluator, by the authors of FLIP: LDR-FLIP of 8-bit pictures taken as sRGB, HDR-FLIP with exposures
of its own choice and ACES. Pictures come from the formulas below, which tests/program/metrics repeats in integers, and from
the PNG files beside this script, both drawn by rastray:
    rastray render SCENE --size 160x120 [--mode trace]
"""

import json
import os

import flip_evaluator
import numpy as np
import skimage
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

HERE = os.path.dirname(os.path.abspath(__file__))
MASK = 0xFFFFFFFF


def noise(x, y, c, seed):
    """32 bits that look random."""
    h = (x * 374761393 + y * 668265263 + c * 2246822519 + seed * 3266489917) & MASK
    h ^= h >> 13
    h = (h * 1274126177) & MASK
    return h ^ (h >> 16)


def clamp(v):
    return max(0, min(255, v))


def gradient(x, y, c):
    return clamp(2 * x + y * (c + 1) - 40 * c)


def blocks(x, y, c):
    return noise(x // 7, y // 5, c, 3) % 256


def lines(x, y, c):
    return 20 if (x % 9 == 4 or (x + 2 * y) % 23 == 0) else 200 + 20 * c


def light(x, y, c):
    """Sixteenths of light: a dim gradient with lamps of up to 40."""
    lamp = 640 if (x - 20) ** 2 + (y - 15) ** 2 < 30 else 0
    return x // 4 + y // 3 + lamp // (c + 1)


def spark(x, y, c):
    """A few lit pixels on black."""
    return noise(x, y, c, 5) % 100 if (x // 6 + y // 6) % 4 == 0 else 0


# name, kind, width, height, pixels per degree, reference, test; values in 255ths (ldr) or sixteenths (hdr)
PAIRS = [
    ("gradient and noise", "ldr", 96, 64, 67.02, gradient,
     lambda x, y, c: clamp(gradient(x, y, c) + noise(x, y, c, 1) % 13 - 6)),
    ("blocks and blocks one pixel aside", "ldr", 80, 60, 67.02, blocks, lambda x, y, c: blocks(x + 1, y, c)),
    ("the same from near", "ldr", 80, 60, 20.0, blocks, lambda x, y, c: blocks(x + 1, y, c)),
    ("the same from afar", "ldr", 80, 60, 120.0, blocks, lambda x, y, c: blocks(x + 1, y, c)),
    ("lines and lines with gaps", "ldr", 64, 64, 67.02, lines,
     lambda x, y, c: 230 if y // 16 == 2 and x > 30 else lines(x, y, c)),
    ("colours turned", "ldr", 60, 50, 67.02, blocks, lambda x, y, c: blocks(x, y, (c + 1) % 3)),
    ("two noises", "ldr", 48, 48, 67.02, lambda x, y, c: noise(x, y, c, 7) % 256,
     lambda x, y, c: noise(x, y, c, 8) % 256),
    ("one step brighter", "ldr", 40, 30, 67.02, gradient, lambda x, y, c: clamp(gradient(x, y, c) + 1)),
    ("one window", "ldr", 11, 11, 67.02, gradient, lambda x, y, c: clamp(gradient(x, y, c) + 20 * (x % 2))),
    ("smaller than a window", "ldr", 9, 7, 67.02, gradient, lambda x, y, c: clamp(gradient(x, y, c) + 9)),
    ("lamps and dimmer lamps", "hdr", 72, 56, 67.02, light, lambda x, y, c: light(x, y, c) * 7 // 8 + 1),
    ("sparks on black", "hdr", 48, 40, 67.02, spark, lambda x, y, c: spark(x, y, c) + (x * y) % 3),
]
FILES = [("whitted", "metrics-whitted-raster.png", "metrics-whitted-trace.png"),
         ("highlight", "metrics-highlight-raster.png", "metrics-highlight-trace.png")]


def picture(formula, width, height, scale):
    values = [[[formula(x, y, c) for c in range(3)] for x in range(width)] for y in range(height)]
    return np.asarray(values, dtype=np.float64) / scale


def luma(p):
    return 0.2126 * p[..., 0] + 0.7152 * p[..., 1] + 0.0722 * p[..., 2]


def measure(name, kind, ppd, reference, test):
    height, width, _ = reference.shape
    found = {"name": name, "kind": kind, "size": [width, height], "ppd": ppd}
    if kind == "ldr":
        found["psnr"] = float(peak_signal_noise_ratio(reference, test, data_range=1.0))
        if min(width, height) >= 11:
            found["ssim"] = float(structural_similarity(
                luma(test), luma(reference), data_range=1.0, gaussian_weights=True, sigma=1.5,
                use_sample_covariance=False))
    f32 = [np.ascontiguousarray(p.astype(np.float32)) for p in (reference, test)]
    errors, mean, parameters = flip_evaluator.evaluate(
        f32[0], f32[1], kind.upper(), applyMagma=False, parameters={"ppd": ppd})
    errors = errors.reshape(height, width)
    # Nearest rank, as all percentiles of rastray.
    median = np.sort(errors.ravel())[(errors.size + 1) // 2 - 1]
    found["flip"] = {"mean": float(mean), "median": float(median), "max": float(errors.max())}
    if kind == "hdr":
        found["exposures"] = [parameters[key] for key in ("startExposure", "stopExposure", "numExposures")]
    points = [(x, y) for y in range(3, height, 13) for x in range(2, width, 17)]
    found["flip_at"] = [[x, y, float(errors[y, x])] for x, y in points]
    return found


def main():
    cases = []
    for name, kind, width, height, ppd, reference, test in PAIRS:
        scale = 255.0 if kind == "ldr" else 16.0
        both = [picture(f, width, height, scale) for f in (reference, test)]
        cases.append(measure(name, kind, ppd, *both))
    for name, reference, test in FILES:
        both = [skimage.io.imread(os.path.join(HERE, f)).astype(np.float64) / 255.0 for f in (reference, test)]
        case = measure(name, "ldr", 67.02, *both)
        case["files"] = [reference, test]
        cases.append(case)
    versions = {"scikit-image": skimage.__version__, "flip-evaluator": "1.7", "numpy": np.__version__}
    with open(os.path.join(HERE, "metrics.json"), "w") as file:
        file.write(json.dumps({"versions": versions, "cases": cases}, indent=None, separators=(",", ":")) + "\n")
    print(json.dumps([{k: v for k, v in c.items() if k != "flip_at"} for c in cases], indent=1))


if __name__ == "__main__":
    import skimage.io

    main()
