#!/usr/bin/env python3
"""A robot on Zenoh with the keys of rmw_zenoh, a router, or a reader of the topics of a monitor. Needs the packages
eclipse-zenoh and cyclonedds (for CDR).

    zenoh_peer.py router ENDPOINT
    zenoh_peer.py robot ENDPOINT [--rate HZ] [--seconds S] [--urdf BYTES] [--namespace /arm7] [--cache advanced|old]
    zenoh_peer.py read ENDPOINT [--seconds S]
"""

import argparse
import json
import math
import struct
import time

import zenoh
from cyclone import DiagnosticArray, DynamicJointState, Header, InterfaceValue, JointState, String, Time

HASHES = {
    "sensor_msgs::msg::dds_::JointState_": "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    "control_msgs::msg::dds_::DynamicJointState_": "RIHS01_18024c98a62697680f581108eeed40b28fb4542fa0ac5a8e36f56c62b6813d26",
    "std_msgs::msg::dds_::String_": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "diagnostic_msgs::msg::dds_::DiagnosticArray_": "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
}


def open_session(mode, connect=(), listen=()):
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps(mode))
    config.insert_json5("connect/endpoints", json.dumps(list(connect)))
    config.insert_json5("listen/endpoints", json.dumps(list(listen)))
    config.insert_json5("scouting/multicast/enabled", "false")
    if mode != "router":
        config.insert_json5("connect/exit_on_failure", "false")
        config.insert_json5("connect/timeout_ms", "0")
        config.insert_json5("timestamping/enabled", "true")
    return zenoh.open(config)


class Out:
    """A publisher of ROS 2: its key, its token, its numbered messages."""

    def __init__(self, session, asked, entity, topic, kind, qos, cache=None):
        zid, hashed = str(session.zid()), HASHES[kind]
        self.key = f"{asked.domain}{topic}/{kind}/{hashed}"
        self.number, self.session, self.publisher = 0, session, None
        mangled = topic.replace("/", "%")
        space = (asked.namespace or "/").replace("/", "%")
        token = f"@ros2_lv/{asked.domain}/{zid}/0/{entity}/MP/%/{space}/robot/{mangled}/{kind}/{hashed}/{qos}"
        if cache == "advanced":
            from zenoh import ext

            self.publisher = ext.declare_advanced_publisher(session, self.key, cache=ext.CacheConfig(1))
        elif cache == "old":
            self.kept = None
            self.queryable = session.declare_queryable(self.key, lambda query: query.reply(self.key, self.kept))
            self.publisher = session.declare_publisher(self.key)
        else:
            self.publisher = session.declare_publisher(self.key)
        self.token = session.liveliness().declare_token(token)

    def send(self, cdr):
        self.number += 1
        self.kept = cdr
        attachment = struct.pack("<qqB", self.number, time.time_ns(), 16) + bytes(16)
        self.publisher.put(cdr, attachment=attachment)


def robot(asked):
    # As rmw_zenoh does: through the router they find each other, and then talk directly.
    session = open_session("peer", connect=[asked.endpoint], listen=["tcp/127.0.0.1:0"])
    space = asked.namespace
    state = Out(session, asked, 1, f"{space}/joint_states", "sensor_msgs::msg::dds_::JointState_", "::,10:,:,:,,")
    motor = Out(
        session, asked, 2, f"{space}/dynamic_joint_states", "control_msgs::msg::dds_::DynamicJointState_", "::,10:,:,:,,"
    )
    if asked.urdf:
        described = Out(
            session, asked, 3, f"{space}/robot_description", "std_msgs::msg::dds_::String_", ":1:,1:,:,:,,", asked.cache
        )
        described.send(String("<robot><!--" + "x" * asked.urdf + "--></robot>").serialize())
    names = [f"joint_{index}" for index in range(asked.joints)]
    print("robot up", flush=True)
    begun, step = time.monotonic(), 0
    while time.monotonic() - begun < asked.seconds:
        now = time.time_ns()
        header = Header(Time(now // 10**9, now % 10**9), "base")
        q = [math.sin(0.5 * (step / asked.rate) + index) for index in range(asked.joints)]
        state.send(JointState(header, names, q, [], []).serialize())
        values = [InterfaceValue(["motor_position"], [value + 0.01]) for value in q]
        motor.send(DynamicJointState(header, names, values).serialize())
        step += 1
        wait = begun + step / asked.rate - time.monotonic()
        if wait > 0:
            time.sleep(wait)
    print(f"robot sent {step}", flush=True)
    session.close()


def read(asked):
    session = open_session("peer", connect=[asked.endpoint], listen=["tcp/127.0.0.1:0"])
    seen = {"diagnostics": 0, "tendons": 0}

    def handler(name, kind):
        def on(sample):
            seen[name] += 1
            message = kind.deserialize(sample.payload.to_bytes())
            number, _sent, length = struct.unpack_from("<qqB", sample.attachment.to_bytes())
            assert length == 16 and len(sample.attachment.to_bytes()) == 33, "attachment"
            if seen[name] == 1:
                print(number, message, flush=True)

        return on

    keys = {"diagnostics": ("/diagnostics", DiagnosticArray), "tendons": ("/sinew/tendons", DynamicJointState)}
    kept = []
    for name, (topic, kind) in keys.items():
        dds = next(known for known in HASHES if known.endswith(f"{kind.__name__}_"))
        key = f"{asked.domain}{topic}/{dds}/{HASHES[dds]}"
        kept.append(session.declare_subscriber(key, handler(name, kind)))
    tokens = []
    kept.append(
        session.liveliness().declare_subscriber(
            f"@ros2_lv/{asked.domain}/**", lambda sample: tokens.append(str(sample.key_expr)), history=True
        )
    )
    time.sleep(asked.seconds)
    ours = [token for token in tokens if "/sinew/" in token or token.endswith("/sinew")]
    print(f"read {seen['diagnostics']} diagnostics {seen['tendons']} tendons {len(ours)} tokens", flush=True)
    session.close()


def router(asked):
    session = open_session("router", listen=[asked.endpoint])
    print("router up", flush=True)
    time.sleep(asked.seconds)
    session.close()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["router", "robot", "read"])
    parser.add_argument("endpoint")
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--namespace", default="")
    parser.add_argument("--rate", type=float, default=200.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--joints", type=int, default=4)
    parser.add_argument("--urdf", type=int, default=0)
    parser.add_argument("--cache", choices=["advanced", "old"], default="advanced")
    asked = parser.parse_args()
    {"router": router, "robot": robot, "read": read}[asked.what](asked)


if __name__ == "__main__":
    main()
