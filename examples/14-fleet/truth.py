"""Compares the results with the simulated truth: python3 truth.py FLEET DUE OUTLIERS COMPARE DAYS

DAYS is the value of `due --within`. Exit code 1: fewer than nine in ten of the tendons that exceed a limit are listed, or the
verdict of a group, worse or better, contradicts the truth.
"""

import csv
import sys
from statistics import median

DAY_S = 86400.0


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


fleet, due, outliers, compare, days = sys.argv[1:]
truth = {(row["robot"], row["joint"]): row for row in rows(f"{fleet}/truth/tendons.csv")}


def passes(row):
    """Whether a limit is exceeded, or will be within the given number of days."""
    soon = row["state"] == "passes" and float(row["passes_utc_s"]) - float(row["end_utc_s"]) <= float(days) * DAY_S
    return row["state"] == "passed" or soon


true = {key for key, row in truth.items() if passes(row)}
listed = {(row["robot"], row["joint"]) for row in rows(due) if row["is_due"] == "true"}
said = {(row["robot"], row["joint"]) for row in rows(due) if row["state"] == "passed"}
really = {key for key, row in truth.items() if row["state"] == "passed"}
print(f"{len(true)} of {len(truth)} tendons have passed a limit or will within {days} days; {len(true & listed)} of them are listed.")
print(f"{len(listed)} are listed: {len(listed - true)} will not pass one so soon.")
print(f"{len(said)} are said to have passed one; {len(said & really)} have.")

factor = {(row["rope"], row["batch"]): float(row["creep_factor"]) for row in rows(f"{fleet}/truth/batches.csv")}
groups, wrong = rows(compare), 0
for row in groups:
    others = [factor[o["within"], o["group"]] for o in groups if o["within"] == row["within"] and o is not row]
    ratio = factor[row["within"], row["group"]] / median(others)
    wrong += row["verdict"] == "worse" and ratio <= 1 or row["verdict"] == "better" and ratio >= 1
    if row["verdict"] == "worse":
        low, high = (100 * (float(row[name]) - 1) for name in ("creep_ratio_low", "creep_ratio_high"))
        print(f"{row['group']} is called worse, by {low:.0f} to {high:.0f} %; it creeps by {100 * (ratio - 1):.0f} % more.")
rope, bad = max(factor, key=factor.get)
print(f"The worst batch is {bad}: {next(row['verdict'] for row in groups if row['group'] == bad)}. Wrong verdicts: {wrong}.")

odd = {(row["robot"], row["joint"]) for row in rows(outliers)}
failed = {key for key in odd if truth[key]["failure_rad"]}
print(f"{len(odd)} tendons creep unlike their kind; of {len(failed)} a strand failed at some time.")
sys.exit(len(true & listed) < 0.9 * len(true) or wrong > 0)
