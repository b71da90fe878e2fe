#!/usr/bin/env python3
"""Recordings by writers that are not Sinew's, for tests/independent.rs.

    python3 -m venv env && env/bin/pip install rosbags mcap mcap-ros2-support
    env/bin/python make_rosbags.py

Creates, next to this script:

* rosbags.mcap       by rosbags (its own CDR, zstd chunks), with /joint_states,
                     /dynamic_joint_states and /robot_description; the motor side has
                     another joint order and a joint more, the joint side a joint less
                     in every tenth message;
* rosbags_bare.mcap  the same first 50 steps by the mcap package's writer, without
                     chunks, index and summary, joint side big-endian;
* rosbags.csv        what was written, as text that reads back to the same doubles.

The bytes depend only on the versions of the packages.
"""

import math
import shutil
import struct
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, IndexType, Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HERE = Path(__file__).resolve().parent
START_NS = 1_750_000_000_000_000_000
STEP_NS = 2_000_000
STEPS = 200
JOINTS = ["shoulder", "elbow", "wrist"]
MOTOR_ORDER = ["wrist", "gripper", "shoulder", "elbow"]
URDF = '<robot name="fixture"><link name="base"/></robot>'

INTERFACE_VALUE = "string[] interface_names\nfloat64[] values\n"
DYNAMIC = (
    "std_msgs/Header header\nstring[] joint_names\n"
    "control_msgs/InterfaceValue[] interface_values\n"
)


def values(step):
    """Values of one step: joint -> (q, dq, tau_el, theta, tau_m), temperature."""
    time = step * STEP_NS * 1e-9
    out = {}
    for index, joint in enumerate(JOINTS):
        q = 0.8 * math.sin(2.0 * time + index)
        tau = 3.0 * math.cos(3.0 * time - index)
        out[joint] = (q, 1.6 * math.cos(2.0 * time + index), tau, q + tau / 40.0, 1.1 * tau)
    return out, 20.0 + 0.25 * (step % 8)


def joints_of(step):
    """Every tenth message of the joint side lacks the wrist."""
    return [j for j in JOINTS if not (step % 10 == 3 and j == "wrist")]


def main():
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(INTERFACE_VALUE, "control_msgs/msg/InterfaceValue"))
    store.register(get_types_from_msg(DYNAMIC, "control_msgs/msg/DynamicJointState"))
    types = store.types
    header_t = types["std_msgs/msg/Header"]
    time_t = types["builtin_interfaces/msg/Time"]
    joint_t = types["sensor_msgs/msg/JointState"]
    string_t = types["std_msgs/msg/String"]
    interface_t = types["control_msgs/msg/InterfaceValue"]
    dynamic_t = types["control_msgs/msg/DynamicJointState"]

    def header(stamp):
        return header_t(
            stamp=time_t(sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id="base_link"
        )

    def joint_message(step):
        got, _ = values(step)
        names = joints_of(step)
        column = lambda i: np.array([got[n][i] for n in names], dtype=np.float64)
        return joint_t(
            header=header(START_NS + step * STEP_NS),
            name=names, position=column(0), velocity=column(1), effort=column(2),
        )

    def motor_message(step):
        got, temperature = values(step)
        interfaces = []
        for name in MOTOR_ORDER:
            if name == "gripper":
                interfaces.append(interface_t(
                    interface_names=["position"], values=np.array([0.04], dtype=np.float64)))
            else:
                interfaces.append(interface_t(
                    interface_names=["motor_effort", "motor_position", "temperature"],
                    values=np.array([got[name][4], got[name][3], temperature], dtype=np.float64)))
        return dynamic_t(
            header=header(START_NS + step * STEP_NS),
            joint_names=MOTOR_ORDER, interface_values=interfaces,
        )

    folder = HERE / "rosbags_folder"
    shutil.rmtree(folder, ignore_errors=True)
    bag = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with bag as writer:
        description = writer.add_connection("/robot_description", "std_msgs/msg/String", typestore=store)
        joint = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        motor = writer.add_connection(
            "/dynamic_joint_states", "control_msgs/msg/DynamicJointState", typestore=store)
        writer.write(description, START_NS, store.serialize_cdr(string_t(data=URDF), "std_msgs/msg/String"))
        for step in range(STEPS):
            log_time = START_NS + step * STEP_NS + 150_000
            # The motor side is logged first in every second step.
            pair = [
                (joint, store.serialize_cdr(joint_message(step), "sensor_msgs/msg/JointState")),
                (motor, store.serialize_cdr(motor_message(step), "control_msgs/msg/DynamicJointState")),
            ]
            for connection, data in pair[:: -1 if step % 2 else 1]:
                writer.write(connection, log_time, data)
    made = next(folder.glob("*.mcap"))
    shutil.move(made, HERE / "rosbags.mcap")
    shutil.rmtree(folder)

    with (HERE / "rosbags_bare.mcap").open("wb") as out:
        writer = McapWriter(
            out, compression=CompressionType.NONE, use_chunking=False, index_types=IndexType.NONE,
            repeat_channels=False, repeat_schemas=False, use_statistics=False,
            use_summary_offsets=False, enable_crcs=False,
        )
        writer.start(profile="ros2", library="fixture")
        channels = {}
        for topic, name in [
            ("/joint_states", "sensor_msgs/msg/JointState"),
            ("/dynamic_joint_states", "control_msgs/msg/DynamicJointState"),
        ]:
            text, _ = store.generate_msgdef(name)
            schema = writer.register_schema(name=name, encoding="ros2msg", data=text.encode())
            channels[topic] = writer.register_channel(
                schema_id=schema, topic=topic, message_encoding="cdr")
        for step in range(50):
            stamp = START_NS + step * STEP_NS
            for topic, message, name, little in [
                ("/joint_states", joint_message(step), "sensor_msgs/msg/JointState", False),
                ("/dynamic_joint_states", motor_message(step),
                 "control_msgs/msg/DynamicJointState", True),
            ]:
                data = bytes(store.serialize_cdr(message, name, little_endian=little))
                writer.add_message(
                    channel_id=channels[topic], log_time=stamp, publish_time=stamp,
                    sequence=step, data=data)
        writer.finish()

    with (HERE / "rosbags.csv").open("w") as out:
        names = ["time_ns"] + [f"{joint}.{kind}" for joint in JOINTS
                               for kind in ("q", "dq", "tau_el", "theta", "tau_m")] + ["temperature"]
        out.write(",".join(names) + "\n")
        for step in range(STEPS):
            got, temperature = values(step)
            present = joints_of(step)
            row = [str(START_NS + step * STEP_NS)]
            for joint in JOINTS:
                side = [repr(v) for v in got[joint]]
                if joint not in present:
                    side[:3] = ["", "", ""]
                row += side
            out.write(",".join(row + [repr(temperature)]) + "\n")


if __name__ == "__main__":
    main()
