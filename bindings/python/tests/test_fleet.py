"""Records and trends for engines that pass Arrow agree with `estimate` and `trend`."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pytest

import pysinew as sn
from pysinew import fleet

from conftest import ROBOT, SHIPPED

pa = pytest.importorskip("pyarrow")
TYPES = {"biorob-like": ROBOT}


def sent(function: Any) -> Any:
    """A function as another machine has it."""
    return pickle.loads(pickle.dumps(function))


def records(*recordings: dict[str, Any]) -> list[dict[str, Any]]:
    batch = pa.RecordBatch.from_pylist(list(recordings))
    return [row for found in sent(fleet.sessions(TYPES))(iter([batch])) for row in found.to_pylist()]


def recording(path: str, robot_type: str = "biorob-like") -> dict[str, Any]:
    return {"path": path, "robot": "arm-1", "robot_type": robot_type}


def test_a_recording_gives_the_rows_of_its_estimate() -> None:
    rows = records(recording(SHIPPED))
    session = sn.estimate(SHIPPED, ROBOT).session
    assert session is not None and [row["joint"] for row in rows] == [joint.name for joint in session.joints]
    for row, joint in zip(rows, session.joints):
        assert (row["offset_rad"], row["offset_std_rad"]) == (joint.offset_rad.mean, joint.offset_rad.std)
        assert joint.elongation_m is not None and row["elongation_m"] == joint.elongation_m.mean
        assert row["time_utc_s"] == session.start_time_utc_s and row["rejection"] is None
        assert row["frames"] + row["frames_lost"] == 20_000 and row["strain_ratio"] is None
    # The columns of a record are those that Sinew's own programs write.
    text = (Path("crates/sinew-watch-core/src/table.rs")).read_text()
    names = text.split("pub const COLUMNS")[1].split("= [")[1].split("]")[0]
    assert [name.strip().strip('"') for name in names.split(",") if name.strip()] == list(rows[0])[:-1]


def test_inconclusive_result_has_no_offset(tmp_path: Path) -> None:
    short = tmp_path / "short.csv"
    sn.simulate("examples/scenarios/stretched-arm.toml", out=short, duration_s=3.0)
    session = sn.estimate(short, ROBOT).session
    assert session is not None
    told = {joint.name: joint.verdict != "inconclusive" for joint in session.joints}
    assert not all(told.values())
    for row in records(recording(str(short))):
        if told[row["joint"]]:
            assert row["offset_rad"] is not None and row["reason"] is None
        else:
            assert row["offset_rad"] is None and row["elongation_m"] is None and row["reason"] == "too-wide"


def test_rejected_recording_does_not_affect_others(tmp_path: Path) -> None:
    bad = tmp_path / "bad.mcap"
    bad.write_bytes(b"no recording")
    rows = records(recording(str(bad)), recording("nowhere.mcap"), recording(SHIPPED, "hand"), recording(SHIPPED))
    rejected = [row for row in rows if row["rejection"] is not None]
    assert [row["source"] for row in rejected] == [str(bad), "nowhere.mcap", SHIPPED]
    assert all(row["joint"] is None and row["offset_rad"] is None for row in rejected)
    assert "bad.mcap" in rejected[0]["rejection"] and "'hand'" in rejected[2]["rejection"]
    assert len(rows) - len(rejected) == len(records(recording(SHIPPED)))


def tendon(days: int, mrad_a_week: float = 1.0) -> list[dict[str, Any]]:
    row = {name: None for name in fleet._RECORD}
    row |= {"robot": "arm-1", "robot_type": "biorob-like", "joint": "elbow", "clock": "utc", "offset_std_rad": 2e-4}
    row |= {"temperature_c": 20.0, "duration_s": 60.0, "sinew_version": "0.1.0"}
    # Along a line, with a scatter.
    rad = [1e-3 * mrad_a_week * day / 7 + 1e-4 * (day % 3) for day in range(days)]
    creep = [row | {"time_utc_s": 1.7e9 + 86_400.0 * day, "offset_rad": rad[day]} for day in range(days)]
    return creep + [row | {"time_utc_s": 1.7e9 + 3600.0, "clock": "stepped", "offset_rad": 1.0}]


def test_records_in_any_order_give_one_row_that_is_the_trend() -> None:
    schema, rows = fleet._arrow(fleet._RECORD), tendon(60)
    follow = sent(fleet._Trend(TYPES, 365.0))
    (found,) = follow(pa.Table.from_pylist(rows, schema=schema)).to_pylist()
    assert [found] == fleet.trend(TYPES)(pa.Table.from_pylist(rows[::-1], schema=schema)).to_pylist()
    assert (found["robot"], found["joint"], found["sessions"], found["rejection"]) == ("arm-1", "elbow", 60, None)
    assert abs(found["offset_rad"] - 59e-3 / 7) < 5e-4
    assert found["limit"] == "retension" and 0 < found["days_low"] <= found["days"]
    (found,) = follow(pa.Table.from_pylist(tendon(60, 5.0), schema=schema)).to_pylist()
    assert (found["limit"], found["state"]) == ("retension", "passed")


def test_tendon_without_sessions_has_reason() -> None:
    (found,) = fleet.trend(TYPES)(pa.Table.from_pylist(tendon(0), schema=fleet._arrow(fleet._RECORD))).to_pylist()
    assert found["rejection"] == "no session with a date and an offset" and found["offset_rad"] is None
