#!/usr/bin/env python3
"""Creep fits beside `scipy.optimize.least_squares`: same curves, laws, bounds, starts, one core.

    benches/peers/creep_fits.py FILE.csv        # such as the 204 spruce tests of Ferrara and Wittel
    benches/peers/creep_fits.py FILE.csv --quick

Needs python3 with venv and cargo; installs `scipy` from PyPI into a virtual environment under
target/peers. Sinew's search and SciPy's run in turn in one run of this script. SciPy fits the curves
as Sinew prepared them, with trust region reflective, the same bounds and tolerances, independent
errors, in five ways:

    projected   only the law's nonlinear parameters are searched, on the unit box; amplitudes (at
                least 0) and the zero follow from linear least squares, as in Sinew; Sinew's grid,
                its three best places as starts, central differences
    analytic    the same with the Jacobian in closed form (Kaufman's, as Sinew has it), which needs fewest
    forward     the same with forward differences, which need fewer evaluations than central ones
    together    all parameters searched together, from the same three starts
    plain       all together from one start, without a grid: what a laboratory script does

A fit has reached the minimum when its sum of squares is within 0.1 % of the least anyone found.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
WORK = TARGET / "peers"
# Linear algebra on one thread, as Sinew's.
for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"]:
    os.environ[name] = "1"


def environment():
    """Re-executes this script inside the virtual environment, making that first if needed."""
    python = WORK / "venv-scipy/bin/python"
    if Path(sys.prefix) == WORK / "venv-scipy":
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", WORK / "venv-scipy"], check=True)
    subprocess.run([python, "-m", "pip", "install", "-q", "scipy>=1.14"], check=True)
    os.execv(python, [python, __file__, *sys.argv[1:]])


environment()

import numpy as np  # noqa: E402
import scipy  # noqa: E402
from scipy.optimize import least_squares, nnls  # noqa: E402

HOUR = 3600.0


class Law:
    """Bounds of the nonlinear parameters (logarithmic where they are times) and the columns."""

    def __init__(self, name, short, long):
        short = max(short, 1e-6 * long)
        self.name = name
        time_ = lambda low, high: (np.log(low), np.log(high), True)  # noqa: E731
        self.bounds = {
            "log-time": [time_(0.1 * short, 10 * long)],
            "findley": [(0.01, 1.0, False)],
            "burgers": [time_(0.3 * short, 3 * long)],
            "kelvin-voigt": [time_(0.3 * short, long), time_(3.0, 1000.0)],
            "stretched": [time_(0.3 * short, 1000 * long), (0.05, 1.0, False)],
        }[name]

    def shape(self, place):
        values = [low + x * (high - low) for x, (low, high, _) in zip(place, self.bounds)]
        return [np.exp(v) if log else v for v, (_, _, log) in zip(values, self.bounds)]

    def columns(self, place, t):
        """Terms, without the zero; t > 0 or 0 before."""
        s = self.shape(place)
        t = np.maximum(t, 0.0)
        if self.name == "log-time":
            return [np.log1p(t / s[0])]
        if self.name == "findley":
            return [(t / HOUR) ** s[0]]
        if self.name == "burgers":
            return [t / HOUR, -np.expm1(-t / s[0])]
        if self.name == "kelvin-voigt":
            return [-np.expm1(-t / s[0]), -np.expm1(-t / (s[0] * s[1]))]
        return [-np.expm1(-((t / s[0]) ** s[1]))]


    def slopes(self, place, t):
        """How every term moves with every nonlinear parameter on the unit box: `[term][parameter]`."""
        s = self.shape(place)
        # Of a parameter over its place in the box.
        per = [(high - low) * (v if log else 1.0) for v, (low, high, log) in zip(s, self.bounds)]
        t = np.maximum(t, 0.0)
        none = np.zeros_like(t)
        lag = lambda tau: -np.exp(-t / tau) * t / tau**2  # noqa: E731
        if self.name == "log-time":
            return [[-per[0] * t / (s[0] * (s[0] + t))]]
        if self.name == "findley":
            log = np.log(np.where(t > 0, t / HOUR, 1.0))
            return [[per[0] * log * (t / HOUR) ** s[0]]]
        if self.name == "burgers":
            return [[none], [per[0] * lag(s[0])]]
        if self.name == "kelvin-voigt":
            slow = lag(s[0] * s[1])
            return [[per[0] * lag(s[0]), none], [per[0] * s[1] * slow, per[1] * s[0] * slow]]
        u = (t / s[0]) ** s[1]
        log = np.log(np.where(t > 0, t / s[0], 1.0))
        return [[per[0] * np.exp(-u) * -s[1] * u / s[0], per[1] * np.exp(-u) * u * log]]


LAWS = ["log-time", "findley", "burgers", "kelvin-voigt", "stretched"]
GRID = [1, 12, 7]
TOLERANCES = {"ftol": 1e-10, "xtol": 1e-8, "gtol": 1e-10, "max_nfev": 60}


class Projected:
    """Residuals where amplitudes and zero are eliminated."""

    def __init__(self, law, t, strain, weight):
        self.law, self.t = law, t
        self.scale = np.ptp(strain)
        self.y = strain / self.scale
        self.root = np.sqrt(weight)
        self.unit = self.root / np.linalg.norm(self.root)

    def without_zero(self, columns):
        """Returns the weighted columns after projection on the complement of the free zero."""
        a = np.column_stack([self.root * c for c in columns])
        return a - np.outer(self.unit, self.unit @ a)

    def linear(self, place):
        """Returns the non-negative amplitudes and the residual."""
        a = self.without_zero(self.law.columns(place, self.t))
        b = self.without_zero([self.y])[:, 0]
        if a.shape[1] == 1:
            beta = np.array([max(a[:, 0] @ b / max(a[:, 0] @ a[:, 0], 1e-300), 0.0)])
        else:
            beta = nnls(a, b)[0]
        return beta, b - a @ beta

    def __call__(self, place):
        return self.linear(place)[1]

    def jacobian(self, place):
        """Jacobian in Kaufman's approximation: changes within the span of the active terms are absorbed by their
        amplitudes."""
        beta = self.linear(place)[0]
        used = self.without_zero(self.law.columns(place, self.t))[:, beta > 0]
        slopes = self.law.slopes(place, self.t)
        moved = [sum(b * of[k] for b, of in zip(beta, slopes)) for k in range(len(place))]
        moved = self.without_zero(moved)
        q = np.linalg.qr(used)[0]
        return q @ (q.T @ moved) - moved

    def starts(self):
        n = len(self.law.bounds)
        axis = (np.arange(GRID[n]) + 0.5) / GRID[n]
        places = np.stack(np.meshgrid(*[axis] * n), -1).reshape(-1, n)
        return sorted(places, key=lambda x: float(np.sum(self(x) ** 2)))[:3]


def projected(problem, starts, jac):
    best = min(
        (least_squares(problem, x, jac=jac, bounds=(0, 1), method="trf", **TOLERANCES) for x in starts),
        key=lambda r: r.cost,
    )
    return 2.0 * best.cost * problem.scale**2


def together(problem, starts, jac):
    n = len(problem.law.bounds)

    def residuals(x):
        columns = problem.law.columns(x[:n], problem.t)
        model = x[-1] + sum(b * c for b, c in zip(x[n:-1], columns))
        return problem.root * (problem.y - model)

    best = np.inf
    for place in starts:
        beta = problem.linear(place)[0]
        model = sum(b * c for b, c in zip(beta, problem.law.columns(place, problem.t)))
        zero = np.average(problem.y - model, weights=problem.root**2)
        x = np.concatenate([place, beta, [zero]])
        low = np.concatenate([np.zeros(n + len(beta)), [-np.inf]])
        high = np.concatenate([np.ones(n), np.full(len(beta) + 1, np.inf)])
        # A start on the bound would be moved inside anyway.
        x[n:-1] = np.maximum(x[n:-1], 1e-9)
        found = least_squares(
            residuals, x, jac=jac, bounds=(low, high), method="trf", x_scale="jac", **TOLERANCES
        )
        best = min(best, found.cost)
    return 2.0 * best * problem.scale**2


def run(way, curves):
    """Returns the sums of squares and the processor time, s, which does not depend on the load of the machine."""
    squares, start = {}, time.process_time()
    for curve in curves:
        t, strain, weight = (np.array(curve[k]) for k in ["time_s", "strain", "count"])
        short, long = t[t > 0][0], t[-1]
        for name in curve["squares"]:
            problem = Projected(Law(name, short, long), t, strain, weight)
            middle = [np.full(len(problem.law.bounds), 0.5)]
            squares[curve["name"], name] = {
                "projected": lambda p: projected(p, p.starts(), "3-point"),
                "analytic": lambda p: projected(p, p.starts(), p.jacobian),
                "forward": lambda p: projected(p, p.starts(), "2-point"),
                "together": lambda p: together(p, p.starts(), "3-point"),
                "plain": lambda p: together(p, middle, "2-point"),
            }[way](problem)
    return squares, time.process_time() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--quick", action="store_true", help="every tenth curve")
    parser.add_argument("--profile", default="bench", help="cargo profile of Sinew's side")
    parser.add_argument("--program", type=Path, help="Sinew's side, built before (benches/creep_fits)")
    args = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    out = WORK / "creep_fits.json"
    WORK.mkdir(parents=True, exist_ok=True)
    bench = ["cargo", "bench", "-q", "--locked", "-p", "sinew-creep", "--bench", "creep_fits"]
    command = [args.program, args.file.resolve(), out] if args.program else [*bench, "--profile", args.profile, "--", args.file.resolve(), out]

    def sinew():
        print(subprocess.run(command, check=True, cwd=ROOT, capture_output=True, text=True).stdout.strip())
        return json.loads(out.read_text())

    before = sinew()
    curves = [c for c in before["curves"] if c["steps"] == [[0.0, 1.0]]]
    if args.quick:
        curves = curves[::10]
    share = len(curves) / len(before["curves"])
    print(f"SciPy {scipy.__version__}, NumPy {np.__version__}; {len(curves)} curves under one load")
    found = {"sinew": {(c["name"], law): s for c in curves for law, s in c["squares"].items()}}
    seconds = {}
    for way in ["projected", "analytic", "forward", "together", "plain"]:
        found[way], seconds[way] = run(way, curves)
    # Once more after SciPy: a machine that got busy in between shows.
    after = sinew()
    seconds["sinew"] = share * 0.5 * (before["seconds"] + after["seconds"])
    print(f"Sinew before and after: {before['seconds']:.3f}, {after['seconds']:.3f} s\n")
    least = {key: min(f[key] for f in found.values()) for key in found["sinew"]}
    print("way         s        ratio   within 0.1 % of the least found")
    for way in ["sinew", "projected", "analytic", "forward", "together", "plain"]:
        reached = np.mean([found[way][k] <= 1.001 * least[k] for k in least])
        ratio = seconds[way] / seconds["sinew"]
        print(f"{way:10} {seconds[way]:7.2f}  {ratio:7.1f}   {100 * reached:5.1f} %")
        if way != "sinew":
            by_law = [[found[way][k] <= 1.001 * least[k] for k in least if k[1] == law] for law in LAWS]
            print("           " + ", ".join(f"{n} {100 * np.mean(b):.0f}" for n, b in zip(LAWS, by_law)))


main()
