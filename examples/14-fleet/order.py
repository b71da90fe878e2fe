"""Writes the work order of one day at one site from the results of `sinew-fleet`.

python3 order.py SITE ROBOTS DUE OUTLIERS COMPARE

A tendon that exceeds a limit requires maintenance, and so does an outlier in creep. The order contains at most ROBOTS robots: those
that exceed a limit most. An outlier, or a rope of a worse batch, is replaced by a rope of another batch; the other ropes are
re-tensioned.
"""

import csv
import sys


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


site, robots, due, outliers, compare = sys.argv[1:]
here = [row for row in rows(due) if row["site"] == site]
passed = {(row["robot"], row["joint"]): row for row in here if row["state"] == "passed"}
odd = {(row["robot"], row["joint"]): row for row in rows(outliers) if row["site"] == site and float(row["creep_ratio"]) > 1}
worse = {row["group"] for row in rows(compare) if row["verdict"] == "worse"}

needs = {}  # for each robot: joint, batch, action, reason, ratio to the limit
for key in sorted(set(passed) | set(odd)):
    beyond, why = 0.0, []
    if key in passed:
        offset, limit = (1e3 * float(passed[key][name]) for name in ("offset_rad", "limit_rad"))
        beyond = offset / limit
        why.append(f"{offset:.0f} of {limit:.0f} mrad")
    row = passed.get(key) or odd[key]
    work = "re-tension"
    if key in odd:
        work = "replace rope, inspect clamp"
        why.append(f"creeps {float(odd[key]['creep_ratio']):.0f} times as much as usual")
    elif row["batch"] in worse:
        work = "replace rope"
        why.append("its batch is worse")
    needs.setdefault(key[0], []).append((key[1], row["batch"], work, ", ".join(why), beyond))

order = sorted(needs, key=lambda robot: -max(line[4] for line in needs[robot]))
today = order[: int(robots)]
lines = [(robot, *line[:4]) for robot in today for line in needs[robot]]
print(f"Work order: {site}, {len(today)} robots, {len(lines)} tendons")
print(f"Required ropes: {sum(line[3] != 're-tension' for line in lines)}, none of {', '.join(sorted(worse)) or 'the batches with the verdict worse'}")
print(f"Postponed: {len(order) - len(today)} robots\n")
heads = ("robot", "joint", "batch", "action", "reason")
widths = [max(len(line[i]) for line in [heads, *lines]) for i in range(len(heads))]
for line in [heads, *lines]:
    print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())
