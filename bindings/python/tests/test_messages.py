"""Messages of ROS 2 from `rosbags`, and episodes of LeRobot data sets."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, SHIPPED


@pytest.fixture()
def bag(tmp_path: Path) -> Path:
    """The shipped recording as a bag's folder."""
    pytest.importorskip("rosbags")
    folder = tmp_path / "bag"
    folder.mkdir()
    (folder / "bag_0.mcap").write_bytes(Path(SHIPPED).read_bytes())
    topics = sn.recording_info(SHIPPED).topics
    listed = "".join(
        f"""
    - topic_metadata:
        name: {t.name}
        type: {t.kind}
        serialization_format: cdr
        offered_qos_profiles: ""
      message_count: {t.messages}"""
        for t in topics
    )
    (folder / "metadata.yaml").write_text(
        f"""rosbag2_bagfile_information:
  version: 5
  storage_identifier: mcap
  relative_file_paths: [bag_0.mcap]
  duration: {{nanoseconds: 1}}
  starting_time: {{nanoseconds_since_epoch: 0}}
  message_count: {sum(t.messages for t in topics)}
  compression_format: ""
  compression_mode: ""
  topics_with_message_count:{listed}
"""
    )
    return folder


def test_an_iterator_of_rosbags_gives_the_frames_of_its_bag(bag: Path) -> None:
    from rosbags.rosbag2 import Reader

    urdf = sn.Recording(SHIPPED).robot_description
    assert urdf is not None
    text = urdf.encode() + b"\0"
    cdr = b"\0\1\0\0" + len(text).to_bytes(4, "little") + text
    # `rosbags` skips messages recorded before the bag began: the URDF is given as four values.
    described = [("/robot_description", "std_msgs/msg/String", 0, cdr)]
    with Reader(bag) as reader:
        recording = sn.Recording.from_messages(itertools.chain(reader.messages(), described), name="a bag")
    assert recording.format == "messages" and recording.name == "a bag"
    of_file, of_messages = sn.Recording(SHIPPED).arrays(), recording.arrays()
    assert list(of_file) == list(of_messages)
    for name in of_file:
        if name != "joints":
            np.testing.assert_array_equal(of_file[name], of_messages[name], err_msg=name)
    assert recording.robot_description == urdf
    found, wanted = (sn.estimate(r, ROBOT).session for r in (recording, SHIPPED))
    assert [j.offset_rad.to_dict() for j in found.joints] == [j.offset_rad.to_dict() for j in wanted.joints]


def test_invalid_messages_are_rejected() -> None:
    with pytest.raises(TypeError, match="of rosbags"):
        sn.Recording.from_messages([("/joint_states", 3)])
    with pytest.raises(ValueError, match="messages: not a recording"):
        sn.Recording.from_messages([("/scan", "sensor_msgs/msg/LaserScan", 0, b"\0\1\0\0")])


@pytest.fixture()
def episodes() -> dict[str, Any]:
    """Two episodes one after the other, as a LeRobot data set has them."""
    columns = sn.Recording(SHIPPED).arrays()
    rows = len(columns["time_ns"])
    time_s = (columns["time_ns"] - columns["time_ns"][0]) * 1e-9
    return {
        "timestamp": np.concatenate([time_s, time_s]),
        "episode_index": np.repeat([0, 3], rows),
        "observation.state": np.concatenate([np.degrees(columns["q"])] * 2),
        "observation.motor": np.concatenate([np.degrees(columns["theta"]), np.degrees(columns["theta"]) + 1.0]),
    }


class Dataset:
    """Used part of a LeRobotDataset."""

    def __init__(self, table: Any, joints: list[str]) -> None:
        self.hf_dataset = table
        self.features = {"observation.state": {"names": [f"{joint}.pos" for joint in joints]}}


def test_an_episode_of_lerobot_is_estimated(episodes: dict[str, Any]) -> None:
    pa = pytest.importorskip("pyarrow")
    robot = sn.Robot(ROBOT)
    asked = {"q": "observation.state", "theta": "observation.motor", "scale": np.pi / 180}
    lists = {k: (list(v) if v.ndim == 2 else v) for k, v in episodes.items()}
    tables = [episodes, Dataset(episodes, robot.joints), pa.table(lists)]
    pd = pytest.importorskip("pandas")
    tables.append(pd.DataFrame(lists))
    answers = []
    for table in tables:
        columns = sn.lerobot(table, episode=3, **asked)
        assert columns["q"].shape == (20000, 4)
        answers.append(sn.estimate_arrays(robot, **columns))
    first = [j.offset_rad.mean for j in answers[0].session.joints]
    plain = [j.offset_rad.mean for j in sn.estimate_arrays(robot, **sn.lerobot(episodes, episode=0, **asked)).session.joints]
    # A degree was added to every motor of the later episode.
    assert np.allclose(np.subtract(first, plain), np.pi / 180, atol=3e-3)
    for other in answers[1:]:
        assert other.session == answers[0].session or json.loads(other.to_json())["session"]["joints"] == json.loads(
            answers[0].to_json()
        )["session"]["joints"]


def test_missing_feature_is_reported(episodes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="2 episodes, from 0 to 3; name one"):
        sn.lerobot(episodes, q="observation.state", theta="observation.motor")
    with pytest.raises(ValueError, match="no episode 1"):
        sn.lerobot(episodes, q="observation.state", theta="observation.motor", episode=1)
    with pytest.raises(ValueError, match="no feature 'action' in the data set; it has timestamp"):
        sn.lerobot(episodes, q="observation.state", theta="action", episode=3)
