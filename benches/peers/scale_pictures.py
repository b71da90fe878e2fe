#!/usr/bin/env python3
"""Pictures of a half-millimetre scale from another camera, read by `sinew bench read-camera`.

    pip install numpy pillow
    benches/peers/scale_pictures.py [--sinew target/release/sinew] [--frames 24]

The tests of `sinew-camera` draw their own pictures; these are made by a program that shares nothing
with them: rays through a pinhole camera (true perspective, radial distortion) onto a printed plane,
24 per pixel, a blur in both directions, vignetting, a highlight, a gamma curve, shot and read noise,
and JPEG where said. The scale moves along itself by a random walk with steps up to 3 mm.
Prints error, stated deviation and worst frame per condition, and fails above the aim of 0.02 mm.
"""

import argparse
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

WIDTH, HEIGHT = 640, 200
PITCH_MM = 0.5
# Across and down within a pixel.
RAYS = (8, 3)


def print_at(u, v):
    """1 where ink is; `u` along the scale, `v` up from the edge, mm. Lines are 0.1 mm wide."""
    line = np.rint(u / PITCH_MM)
    off = np.abs(u - line * PITCH_MM)
    length = np.where(line % 20 == 0, 4.5, np.where(line % 10 == 0, 3.8, np.where(line % 2 == 0, 3.0, 2.3)))
    ink = (off < 0.05) & (v > 0) & (v < length)
    # A number every centimetre: bars whose pattern differs from number to number.
    number = np.rint(u / 10.0)
    column = np.floor((u - number * 10.0 + 1.2) / 0.3)
    bit = (number.astype(int) * 37 + 11) >> np.clip(column, 0, 7).astype(int) & 1
    return ink | ((v > 5.0) & (v < 6.4) & (column >= 0) & (column < 8) & (bit == 1))


def picture(rng, moved_mm, tilt_deg, pixels, look_deg, distortion, blur, noise, gamma):
    """Grey levels of one frame."""
    grid = lambda n, k: (np.arange(n * k) + 0.5) / k - 0.5  # noqa: E731
    x, y = np.meshgrid(grid(WIDTH, RAYS[0]), grid(HEIGHT, RAYS[1]))
    x, y = x - (WIDTH - 1) / 2, y - (HEIGHT - 1) / 2
    # The lens: straight rays bend by the third power; focal length 4000 px.
    focal = 4000.0
    r2 = (x * x + y * y) / (WIDTH / 2) ** 2
    x, y = x * (1 + distortion * r2), y * (1 + distortion * r2)
    # The plane leans away by `look_deg` about its vertical axis.
    a = np.radians(look_deg)
    depth = np.cos(a) / (np.cos(a) - x / focal * np.sin(a))
    mm_per_px = PITCH_MM / pixels
    px, py = x * depth / np.cos(a) * mm_per_px, y * depth * mm_per_px
    t = np.radians(tilt_deg)
    u, v = px * np.cos(t) + py * np.sin(t), px * np.sin(t) - py * np.cos(t)
    ink = print_at(u + 45.0 - moved_mm, v + 2.0)
    ink = ink.reshape(HEIGHT, RAYS[1], WIDTH, RAYS[0]).mean(axis=(1, 3))
    light = 0.9 * (1 - 0.35 * r2.reshape(HEIGHT, RAYS[1], WIDTH, RAYS[0]).mean(axis=(1, 3)))
    spot = np.hypot(*np.meshgrid(np.arange(WIDTH) - 480, np.arange(HEIGHT) - 60))
    level = light * (1 - 0.75 * ink) + 0.15 * np.exp(-((spot / 60) ** 2))
    level = smooth(level, blur)
    # Shot noise grows with the light, read noise does not; 4000 electrons are white.
    electrons = rng.poisson(np.clip(level, 0, None) * 4000 / noise**2) * noise**2
    level = np.clip(electrons / 4000 + rng.normal(0, 0.004 * noise, level.shape), 0, 1)
    return np.rint(255 * level ** (1 / gamma)).astype(np.uint8)


def smooth(level, sigma):
    reach = int(4 * sigma) + 1
    k = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    k /= k.sum()
    padded = np.pad(level, reach, mode="edge")
    rows = np.apply_along_axis(lambda m: np.convolve(m, k, "valid"), 1, padded)
    return np.apply_along_axis(lambda m: np.convolve(m, k, "valid"), 0, rows)


PLAIN = dict(tilt_deg=1.5, pixels=10.0, look_deg=0.0, distortion=0.0, blur=1.2, noise=1.0, gamma=1.0)
CONDITIONS = {
    "10 px, noise, blur, light, 1.5°": {},
    "the same, gamma 2.2": dict(gamma=2.2),
    "three times the noise": dict(noise=3.0),
    "blur 2.5 px": dict(blur=2.5),
    "seen 12° from the side": dict(look_deg=12.0),
    "lens distortion 1 %": dict(distortion=0.01),
    "turned by -6°": dict(tilt_deg=-6.0),
    "7.3 px": dict(pixels=7.3),
    "JPEG, quality 60": dict(jpeg=60),
    "all of it": dict(gamma=2.2, noise=2.0, blur=1.8, look_deg=8.0, distortion=0.005, tilt_deg=3.0, jpeg=80),
}


def measure(sinew, condition, frames, seed):
    options = {**PLAIN, **condition}
    jpeg = options.pop("jpeg", None)
    rng = np.random.default_rng(seed)
    moved = np.concatenate([[0.0], np.cumsum(rng.uniform(-1.0, 3.0, frames - 1))])
    with tempfile.TemporaryDirectory() as folder:
        for i, at in enumerate(moved):
            image = Image.fromarray(picture(rng, at, **options))
            image.save(f"{folder}/f_{i:04d}s." + ("jpg" if jpeg else "png"), **({"quality": jpeg} if jpeg else {}))
        out = Path(folder) / "out.csv"
        command = [sinew, "bench", "read-camera", folder, "--out", out, "--quiet"]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode not in (0, 3):
            sys.exit(run.stderr)
        rows = list(csv.DictReader(out.open()))
    used = [int(float(r["time_s"])) for r in rows]
    error = np.array([float(r["elongation_mm"]) for r in rows]) - moved[used] + moved[used[0]]
    std = np.array([float(r["elongation_std_mm"]) for r in rows])
    return len(used), np.sqrt(np.mean(error[1:] ** 2)), np.abs(error).max(), np.sqrt(np.mean(std[1:] ** 2))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--sinew", default=Path(__file__).resolve().parents[2] / "target/release/sinew", type=Path)
    parser.add_argument("--frames", type=int, default=24)
    args = parser.parse_args()
    print("condition                        used   RMS, mm  worst, mm  stated, mm")
    bad = 0
    for seed, (name, condition) in enumerate(CONDITIONS.items()):
        used, rms, worst, stated = measure(args.sinew, condition, args.frames, seed)
        print(f"{name:32} {used:4}  {rms:8.5f}   {worst:8.5f}    {stated:8.5f}", flush=True)
        bad += rms > 0.02 or used < 0.9 * args.frames
    sys.exit(bad > 0)


main()
