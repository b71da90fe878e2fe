#!/usr/bin/env python3
"""Writes the recordings of this example: three simulated ropes on a bench, 60 N for 85 min.

The data are simulated: immediate strain 0.6 or 0.4 %, creep b ln(1 + t/30 s), one sample per 5 s with
0.0002 % of noise and a slow wave of 0.0004 %, as caused by the room temperature.
"""
import math
import random

ROPES = [("rope A", 0.60, 0.030, 5), ("rope B", 0.40, 0.018, 6), ("rope C", 0.45, 0.041, 7)]

for name, at_once, b, seed in ROPES:
    random.seed(seed)
    with open(f"{name.replace(' ', '-')}.csv", "w") as out:
        out.write(f"Rope,{name}\nL0 (mm),350\nTemperature (C),23.0\n")
        out.write("time_s,force_N,elongation_mm\n")
        load = 2.0
        for i in range(0, 5700, 5):
            if i < 60:
                load, creep = 2.0, 0.0
            elif i < 60 + 5100:
                load = 60.0
                creep = b * math.log1p((i - 57.5) / 30)
            else:
                load = 2.0
                creep = b * (math.log1p((i - 57.5) / 30) - math.log1p((i - 5157.5) / 30))
            strain = at_once * (load - 2) / 58 + creep
            strain += 0.0002 * random.gauss(0, 1) + 0.0004 * math.sin(i / 700)
            # The grip of rope C slips by 0.02 mm after half an hour.
            slip = 0.02 if name == "rope C" and i > 1800 else 0.0
            force = load + 0.05 * random.gauss(0, 1)
            out.write(f"{i},{force:.2f},{3.5 * strain + slip:.5f}\n")
