#!/usr/bin/env python3
"""The paper's bending bench written a second time: strains after four hours and capstan tensions.

    benches/peers/bending.py        # prints the values of crates/sinew-rope/src/bench/simulate.rs

Needs python3 with NumPy. The rope law is that of docs/src/science/rope.md with the values of
liros-dc000-0301. Tensions follow from the capstan equation of both strands; bedding-in is integrated
at its rate averaged through the cycle (Runge-Kutta), elastic strain is averaged, delayed elasticity
follows the mean tension.
"""

from math import cos, cosh, exp, pi, radians, tanh

import numpy as np

MBL, K, TOE, TOE_LOAD = 4450.0, 45.0, 0.2, 0.03
BEDDING, BEDDING_LOAD, BEDDING_S, JAMMING, GAIN, Q = 0.42, 0.02, 240.0, 3.0, 0.9, 0.8
DELAYED, TAU = 1.4, (1e1, 1e2, 1e3, 1e4, 1e5)
STRAND, STROKE, FORCE, DIAMETER, END_S = 0.6, 0.1, 200.0, 0.0015, 14400.0
AT = {"B": (0.16, 0.30, 0.44), "C": (0.14, 0.28, 0.44), "D": (0.28, 0.30, 0.32)}
WRAPS = {"B": (20, 20, 20), "C": (75, 215, 75), "D": (90, 90, 90)}


def sections(pulleys, part):
    """Length, place in the middle of the stroke, and passes over each pulley, of parts of the strand."""
    low = [(at - 0.5 * STROKE, at + contact - 0.5 * STROKE, contact) for at, contact in ((a, r * w) for a, r, w in pulleys)]
    edges = {0.0, STRAND}
    for entry, leave, _ in low:
        edges |= {min(max(e, 0.0), STRAND) for e in (entry, leave, entry + STROKE, leave + STROKE)}
    edges = sorted(edges)
    for a, b in zip(edges, edges[1:]):
        middle = 0.5 * (a + b)
        passes = [
            0.5 * (entry <= middle <= leave + STROKE) + 0.5 * (leave <= middle <= entry + STROKE) for entry, leave, _ in low
        ]
        count = max(1, int(np.ceil((b - a) / (part * STROKE)))) if any(passes) else 1
        for i in range(count):
            yield (b - a) / count, a + (b - a) * (i + 0.5) / count, passes


def tension(pulleys, mu, log_ratio, at, towards):
    sign = 1 if towards else -1
    wrapped = sum(w * min(max((at - a) / (r * w), 0.0), 1.0) for a, r, w in pulleys)
    return 0.5 * FORCE * (1 + sign * tanh(0.5 * log_ratio)) * exp(-sign * mu * wrapped)


def strain(pulleys, both, mu, p=0.0, m=0.0, n=0.5, driver="cycle", steps=6, part=0.25):
    """Mean strain of both strands after four hours, %."""
    log_ratio = mu * sum(w for _, _, w in pulleys) * (2 if both else 1)
    strands, total = [pulleys] if both else [pulleys, []], 0.0
    for strand in strands:
        cost = []
        for at, radius, wrap in strand:
            middle = at + 0.5 * radius * wrap
            local = 0.5 * sum(tension(strand, mu, log_ratio, middle, t) for t in (False, True))
            pressure = 0.5 * FORCE / MBL * DIAMETER / max(2 * radius, DIAMETER)
            cost.append((wrap / radians(60)) ** p * (local / 100) ** m * (pressure / 0.0021) ** n)
        parts = list(sections(strand, part))
        length = np.array([s[0] for s in parts])
        passes = np.array([sum(c * x for c, x in zip(cost, s[2])) for s in parts])
        phase = pi * (np.arange(steps) + 0.5) / steps
        tensions = np.array([
            [
                tension(strand, mu, log_ratio, s[1] + (0.5 if t else -0.5) * STROKE * cos(x), t)
                for t in (False, True)
                for x in phase
            ]
            for s in parts
        ])
        load = tensions / MBL
        elastic = (100 * load / K + TOE * -np.expm1(-load / TOE_LOAD)).mean(1)
        delayed = DELAYED * load.mean(1) * sum(1 - exp(-END_S / tau) for tau in TAU)
        driven = load.mean(1, keepdims=True) if driver == "mean" else load
        full = BEDDING * (1 + GAIN * passes**Q * (passes > 0))
        target = full[:, None] * -np.expm1(-driven / BEDDING_LOAD)
        rate = lambda b: np.maximum(target - b[:, None], 0).mean(1) * np.exp(-JAMMING * b / full) / BEDDING_S  # noqa: B023, E731
        b, times = np.zeros(len(parts)), END_S * np.linspace(0, 1, 3001) ** 2
        for h in np.diff(times):
            k1 = rate(b)
            k2 = rate(b + 0.5 * h * k1)
            k3 = rate(b + 0.5 * h * k2)
            k4 = rate(b + h * k3)
            b = b + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        total += (length * (elastic + delayed + b)).sum() / STRAND / len(strands)
    return total


def case(name, radius=0.008):
    return [(at, radius, radians(wrap)) for at, wrap in zip(AT[name], WRAPS[name])]


def main():
    print("tensions: x, far, drive low and high, work; one strand: bare low and high, mean at mid-wrap")
    for wrap, mu in ((60, 0.05), (270, 0.05), (365, 0.05), (270, 0.1), (365, 0.1)):
        x = mu * radians(wrap)
        half = tanh(x / 2)
        row = (100 / cosh(x), 100 * (1 - tanh(x)), 100 * (1 + tanh(x)), 40 * tanh(x), 100 * (1 - half), 100 * (1 + half))
        print(f"{wrap:4} {mu} {x:.6f}", *(f"{v:.4f}" for v in (*row, 100 / cosh(x / 2))))
    print("strain (%) of B, C, D")
    for label, options in (
        ("per pass, cycle", {}),
        ("pressure, cycle", {"m": 1.0}),
        ("per pass, mean", {"driver": "mean"}),
        ("per wrap, cycle", {"p": 1.0}),
    ):
        for mu in (0.02, 0.05, 0.1, 0.2):
            print(f"{label:16} {mu}", *(f"{strain(case(name), True, mu, **options):.4f}" for name in "BCD"), flush=True)
    print("strain (%) by radius, three guides of 90° on one strand")
    for n in (1.0, 0.5, 0.0):
        guides = lambda r: [(at, 1e-3 * r, radians(90)) for at in AT["B"]]  # noqa: E731
        print(n, *(f"{strain(guides(r), False, 0.05, n=n):.4f}" for r in (0.8, 2, 4, 8, 15, 30)), flush=True)


main()
