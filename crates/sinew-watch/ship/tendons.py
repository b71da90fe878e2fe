"""State of every tendon in the monitor, once a second; used by to_foxglove.py and to_rerun.py."""

import json
import time
import urllib.request

NUMBERS = ("offset_rad", "elongation_m", "strain_ratio")


def get(monitor, path, token=None):
    """Returns a response of the monitor's HTTP API."""
    request = urllib.request.Request(monitor + path)
    if token:
        request.add_header("authorization", f"Bearer {token}")
    with urllib.request.urlopen(request, timeout=10) as answer:
        return json.load(answer)


def of_robot(robot):
    """Yields the present values per joint; unavailable values are missing. SI units, with standard deviations."""
    for tendon in robot["tendons"]:
        values = {"level": tendon["level"]}
        for name in NUMBERS:
            value = tendon[name]
            if value is not None:
                quantity, unit = name.split("_")
                values |= {name: value["mean"], f"{quantity}_std_{unit}": value["std"]}
        yield tendon["joint"], values


def every_second(monitor, token=None):
    """Yields (time, robot, joint, values) indefinitely; reconnects to a restarted monitor."""
    while True:
        try:
            for row in get(monitor, "/api/v1/fleet", token)["robots"]:
                robot = get(monitor, f"/api/v1/robots/{row['robot']}", token)["robot"]
                for joint, values in of_robot(robot):
                    yield robot["time_utc_s"], row["robot"], joint, values
        except OSError as error:
            print(f"{monitor}: {error}; reconnecting")
        time.sleep(1.0)
