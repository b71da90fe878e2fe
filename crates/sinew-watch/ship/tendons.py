"""What the monitor knows of every tendon, once a second: read by to_foxglove.py and to_rerun.py beside it."""

import json
import time
import urllib.request

NUMBERS = ("offset_rad", "elongation_m", "strain_ratio")


def get(monitor, path, token=None):
    """An answer of the monitor's HTTP API."""
    request = urllib.request.Request(monitor + path)
    if token:
        request.add_header("authorization", f"Bearer {token}")
    with urllib.request.urlopen(request, timeout=10) as answer:
        return json.load(answer)


def of_robot(robot):
    """Per joint what is known now: numbers that aren't known are missing. SI, with standard deviations."""
    for tendon in robot["tendons"]:
        known = {"level": tendon["level"]}
        for name in NUMBERS:
            value = tendon[name]
            if value is not None:
                quantity, unit = name.split("_")
                known |= {name: value["mean"], f"{quantity}_deviation_{unit}": value["deviation"]}
        yield tendon["joint"], known


def every_second(monitor, token=None):
    """(time, robot, joint, what is known), as long as it is asked for; a monitor that restarts is waited for."""
    while True:
        try:
            for row in get(monitor, "/api/v1/fleet", token)["robots"]:
                robot = get(monitor, f"/api/v1/robots/{row['robot']}", token)["robot"]
                for joint, known in of_robot(robot):
                    yield robot["time_utc_s"], row["robot"], joint, known
        except OSError as error:
            print(f"{monitor}: {error}; tried again")
        time.sleep(1.0)
