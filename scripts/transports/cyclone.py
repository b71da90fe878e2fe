#!/usr/bin/env python3
"""A robot on Cyclone DDS, with the names of ROS 2: publishes joint states, motor states and a description; or reads
the topics of a monitor. Needs the package cyclonedds.

    cyclone.py robot [--rate HZ] [--seconds S] [--joints N] [--urdf BYTES] [--volatile-urdf] [--exclusive N] [--big]
    cyclone.py read SECONDS          /diagnostics and /sinew/tendons
"""

import argparse
import math
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
@final
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
@final
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
@final
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
@final
class InterfaceValue(IdlStruct, typename="control_msgs::msg::dds_::InterfaceValue_"):
    interface_names: sequence[str]
    values: sequence[float64]


@dataclass
@final
class DynamicJointState(IdlStruct, typename="control_msgs::msg::dds_::DynamicJointState_"):
    header: Header
    joint_names: sequence[str]
    interface_values: sequence[InterfaceValue]


@dataclass
@final
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@dataclass
@final
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
@final
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
@final
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


RELIABLE = Policy.Reliability.Reliable(duration(milliseconds=100))
LATE = Policy.Durability.TransientLocal


def robot(asked):
    participant = DomainParticipant(asked.domain)
    usual = [RELIABLE, Policy.History.KeepLast(10)]
    if asked.exclusive is not None:
        usual += [Policy.Ownership.Exclusive, Policy.OwnershipStrength(asked.exclusive)]
    if asked.best_effort:
        usual[0] = Policy.Reliability.BestEffort
    space = asked.namespace
    

    def writer(name, kind, qos):
        policies = [policy for policy in qos if not isinstance(policy, Policy.OwnershipStrength)]
        topic = Topic(participant, f"rt{space}/{name}", kind, qos=Qos(*policies))
        return DataWriter(participant, topic, qos=Qos(*qos))

    if asked.urdf:
        text = "<robot name='made'><!--" + "x" * asked.urdf + "--></robot>"
        qos = [RELIABLE, Policy.History.KeepLast(1), Policy.Durability.Volatile if asked.volatile_urdf else LATE]
        description = writer("robot_description", String, qos)
        description.write(String(text))
    joints = writer("joint_states", JointState, usual)
    motors = writer("dynamic_joint_states", DynamicJointState, usual)
    names = [f"joint_{index}" for index in range(asked.joints)]
    begun, step = time.monotonic(), 0
    print("robot up", flush=True)
    while time.monotonic() - begun < asked.seconds:
        now = time.time_ns() + asked.stamp_offset_s * 10**9
        header = Header(Time(now // 10**9, now % 10**9), "base")
        q = [math.sin(0.5 * (step / asked.rate) + index) for index in range(asked.joints)]
        theta = [value + 0.01 for value in q]
        joints.write(JointState(header, names, q, [0.0] * asked.joints, []))
        values = [InterfaceValue(["motor_position"], [value]) for value in theta]
        motors.write(DynamicJointState(header, names, values))
        step += 1
        wait = begun + step / asked.rate - time.monotonic()
        if wait > 0:
            time.sleep(wait)
    print(f"robot sent {step}", flush=True)
    if asked.linger:
        time.sleep(asked.linger)


def read(asked):
    participant = DomainParticipant(asked.domain)
    qos = Qos(RELIABLE, Policy.History.KeepLast(10))
    readers = [
        DataReader(participant, Topic(participant, f"rt{name}", kind, qos=qos), qos=qos)
        for name, kind in (("/diagnostics", DiagnosticArray), ("/sinew/tendons", DynamicJointState))
    ]
    until = time.monotonic() + asked.seconds
    seen = [0, 0]
    while time.monotonic() < until:
        for index, reader in enumerate(readers):
            for sample in reader.take(20):
                seen[index] += 1
                if seen[index] == 1:
                    print(sample, flush=True)
        time.sleep(0.05)
    print(f"read {seen[0]} diagnostics {seen[1]} tendons", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["robot", "read"])
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--namespace", default="")
    parser.add_argument("--rate", type=float, default=200.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--joints", type=int, default=4)
    parser.add_argument("--urdf", type=int, default=0)
    parser.add_argument("--volatile-urdf", action="store_true")
    parser.add_argument("--exclusive", type=int, help="with this strength; 0 isn't announced")
    parser.add_argument("--best-effort", action="store_true")
    parser.add_argument("--stamp-offset-s", type=int, default=0)
    parser.add_argument("--linger", type=float, default=0.0)
    asked = parser.parse_args()
    {"robot": robot, "read": read}[asked.what](asked)


if __name__ == "__main__":
    main()
