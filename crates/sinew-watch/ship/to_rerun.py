"""Shows the monitor's tendons in Rerun.

    pip install rerun-sdk
    python to_rerun.py [MONITOR] [TOKEN]

MONITOR defaults to http://127.0.0.1:8642. The viewer starts automatically; RERUN_SAVE=FILE.rrd writes a file instead.
"""

import os
import sys

import rerun
from tendons import every_second


def main(monitor="http://127.0.0.1:8642", token=None):
    file = os.environ.get("RERUN_SAVE")
    rerun.init("sinew", spawn=not file)
    if file:
        rerun.save(file)
    for time_utc_s, robot, joint, values in every_second(monitor, token):
        rerun.set_time("utc", timestamp=time_utc_s)
        for name, value in values.items():
            path = f"{robot}/{joint}/{name}"
            rerun.log(path, rerun.TextLog(value) if name == "level" else rerun.Scalars(value))


if __name__ == "__main__":
    main(*sys.argv[1:])
