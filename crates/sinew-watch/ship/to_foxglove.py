"""Shows the monitor's tendons in Foxglove.

    pip install foxglove-sdk
    python to_foxglove.py [MONITOR] [TOKEN]

MONITOR defaults to http://127.0.0.1:8642. Then open the connection ws://127.0.0.1:8765 and plot
/sinew/ROBOT/JOINT.offset_rad.
"""

import sys

import foxglove
from tendons import every_second


def main(monitor="http://127.0.0.1:8642", token=None):
    foxglove.start_server(name="sinew", host="127.0.0.1", port=8765)
    channels = {}
    for time_utc_s, robot, joint, values in every_second(monitor, token):
        topic = f"/sinew/{robot}/{joint}"
        channel = channels.setdefault(topic, None) or foxglove.Channel(topic, message_encoding="json")
        channels[topic] = channel
        channel.log(values, log_time=int(time_utc_s * 1e9))


if __name__ == "__main__":
    main(*sys.argv[1:])
