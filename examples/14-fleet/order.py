"""Writes the work order of one day at one site from what `sinew-fleet` answered.

python3 order.py SITE ROBOTS DUE OUTLIERS COMPARE

A tendon that has passed a limit needs work, and so does one that creeps unlike its kind. As many robots are on the order as fit in a
day: those that are furthest beyond a limit. A rope that departs, or whose batch is worse, is replaced by one of another batch; the
others are tensioned.
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

needs = {}  # of each robot: joint, rope, batch, work, why, how far beyond the limit
for key in sorted(set(passed) | set(odd)):
    beyond, why = 0.0, []
    if key in passed:
        offset, limit = (1e3 * float(passed[key][name]) for name in ("offset_rad", "limit_rad"))
        beyond = offset / limit
        why.append(f"{offset:.0f} of {limit:.0f} mrad")
    row = passed.get(key) or odd[key]
    work = "tension"
    if key in odd:
        work = "replace rope, look at clamp"
        why.append(f"creeps {float(odd[key]['creep_ratio']):.0f} times as usual")
    elif row["batch"] in worse:
        work = "replace rope"
        why.append("its batch is worse")
    needs.setdefault(key[0], []).append((key[1], row["batch"], work, ", ".join(why), beyond))

order = sorted(needs, key=lambda robot: -max(line[4] for line in needs[robot]))
today = order[: int(robots)]
lines = [(robot, *line[:4]) for robot in today for line in needs[robot]]
print(f"Work order: {site}, {len(today)} robots, {len(lines)} tendons")
print(f"Ropes to bring: {sum(line[3] != 'tension' for line in lines)}, none of {', '.join(sorted(worse)) or 'a batch named worse'}")
print(f"Left for another day: {len(order) - len(today)} robots\n")
heads = ("robot", "joint", "batch", "work", "why")
widths = [max(len(line[i]) for line in [heads, *lines]) for i in range(len(heads))]
for line in [heads, *lines]:
    print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())
