"""Writes a simulated events.csv: failures and preventive replacements of ropes of two arm types over three years.

The rope lifetimes have a Weibull distribution with a shape of 2 and a scale of 420 days (elbows) or 700 (wrists). One in five
is replaced at a yearly service before it fails.
"""

import datetime
import random

random.seed(12)
begin, end = datetime.date(2023, 3, 1), datetime.date(2026, 3, 1)
rows = []
for arm in range(1, 11):
    kind = "lift" if arm <= 5 else "reach"
    for joint, scale in (("elbow", 420.0), ("wrist", 700.0)):
        unit = f"arm-{arm} {joint}"
        day = begin + datetime.timedelta(days=random.randrange(60))
        rows.append((day, unit, kind, "installed"))
        while True:
            life = max(1, round(scale * random.weibullvariate(1.0, 2.0)))
            breaks = day + datetime.timedelta(days=life)
            service = day + datetime.timedelta(days=365)
            if random.random() < 0.2 and service < breaks:
                day, event = service, "replaced at the yearly service"
            else:
                day, event = breaks, "broken"
            if day > end:
                break
            rows.append((day, unit, kind, event))
            if event == "broken":
                # After a failure the rope is not observed until an installation is recorded.
                rows.append((day, unit, kind, "installed"))
            if random.random() < 0.15 and day + datetime.timedelta(days=40) < end:
                rows.append((day + datetime.timedelta(days=40), unit, kind, "loose; tensioned again"))
rows.sort()
with open("events.csv", "w") as out:
    out.write("# Made up by make.py.\n")
    out.write("date,unit,robot_type,event\n")
    for row in rows:
        out.write(",".join(map(str, row)) + "\n")
