"""Records and trends for engines that pass Arrow agree with `estimate` and `trend`."""

from __future__ import annotations

import csv
import math
import os
import pickle
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

import pysinew as sn
from pysinew import fleet

from conftest import ROBOT, SHIPPED

pa = pytest.importorskip("pyarrow")
dataset = pytest.importorskip("pyarrow.dataset")
parquet = pytest.importorskip("pyarrow.parquet")
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
    names = re.findall(r'SchemaColumn::\w+\(\s*"(\w+)"', text.split("const ABOUT")[1])
    assert names == list(rows[0])[:-1]


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


def trends(rows: list[dict[str, Any]], follow: Any = None) -> list[dict[str, Any]]:
    follow = follow or fleet._Trend(TYPES, None)
    return list(follow(pa.Table.from_pylist(rows, schema=fleet._arrow(fleet._RECORD))).to_pylist())


def test_records_in_any_order_give_one_row_that_is_the_trend() -> None:
    rows = tendon(60)
    (found,) = trends(rows, sent(fleet._Trend(TYPES, None)))
    assert [found] == trends(rows[::-1], fleet.trend(TYPES))
    assert (found["robot"], found["joint"], found["sessions"], found["rejection"]) == ("arm-1", "elbow", 60, None)
    assert abs(found["offset_rad"] - 59e-3 / 7) < 5e-4
    assert found["limit"] == "retension" and 0 < found["after_low_s"] <= found["after_s"]
    assert found["last_utc_s"] == 1.7e9 + 59 * 86_400.0
    (found,) = trends(tendon(60, 5.0))
    assert (found["limit"], found["state"]) == ("retension", "passed")


def test_newest_version_of_a_session_counts() -> None:
    rows = tendon(60)
    anew = [row | {"sinew_version": "0.10.0", "offset_rad": 2 * row["offset_rad"]} for row in rows[:60]]
    assert trends(rows + anew) == trends(anew + rows) == trends(anew + rows[60:])
    assert trends(rows + anew) != trends(rows)
    older = [row | {"sinew_version": "0.10.0-rc.1", "offset_rad": 0.0} for row in rows[:60]]
    assert trends(older + anew) == trends(anew)
    # Of one version: the estimate from more frames.
    more = [row | {"frames": 10, "offset_rad": 3 * row["offset_rad"]} for row in rows[:60]]
    less = [row | {"frames": 9, "offset_rad": 0.0} for row in rows[:60]]
    assert trends(less + more) == trends(more)
    # A row without a time is no session, and NaN is wider than every interval.
    timeless = [rows[0] | {"time_utc_s": time, "offset_rad": 1.0} for time in (None, math.nan)]
    unknown = [row | {"offset_std_rad": math.nan, "offset_rad": 1.0} for row in rows[:60]]
    assert trends(unknown + timeless + rows) == trends(rows + unknown) == trends(rows)


def test_ropes_and_events_of_a_folder_apply(tmp_path: Path) -> None:
    (tmp_path / "tendons.csv").write_text("robot,joint,rope\narm-1,elbow,liros-dc000-0701\n")
    day = 1.7e9 + 30 * 86_400.0 - 3600.0
    (tmp_path / "events.csv").write_text(f"# maintenance\nrobot,joint,time_utc_s,event\narm-1,elbow,{day},tensioned\n")
    rows = tendon(60)
    for row in rows[30:60]:
        row |= {"baseline": "second", "offset_rad": row["offset_rad"] - 30e-3 / 7}
    (found,), (without,) = trends(rows, fleet._Trend(TYPES, tmp_path.as_uri())), trends(rows)
    assert found == trends(rows, fleet._Trend(TYPES, str(tmp_path)))[0]
    assert found["rejection"] is None and found["offset_rad"] != without["offset_rad"]
    with pytest.raises(sn.SinewError, match="neither tendons.csv nor events.csv"):
        fleet.trend(TYPES, str(tmp_path / "other"))
    (tmp_path / "tendons.csv").write_text("robot,rope\narm-1,liros-dc000-0701\n")
    with pytest.raises(sn.SinewError, match="no column 'joint'"):
        fleet.trend(TYPES, str(tmp_path))


def test_addresses_give_the_rows_of_paths(tmp_path: Path) -> None:
    there = recording(Path(SHIPPED).resolve().as_uri())
    types = {"biorob-like": Path(ROBOT).resolve().as_uri()}
    batch = pa.RecordBatch.from_pylist([there, recording("file:///nowhere.mcap")])
    rows = [row for found in fleet.sessions(types)(iter([batch])) for row in found.to_pylist()]
    assert [row | {"source": SHIPPED} for row in rows[:-1]] == records(recording(SHIPPED))
    assert "file:///nowhere.mcap" in rows[-1]["rejection"]


def test_rows_are_those_of_sinew_fleet(tmp_path: Path) -> None:
    program = os.environ.get("SINEW_FLEET")
    if program is None:
        pytest.skip("SINEW_FLEET does not name the program sinew-fleet")
    folder = tmp_path / "fleet"
    subprocess.run(
        [program, "simulate", "--robot", ROBOT, "--robots", "2", "--days", "90", "--out", folder], check=True, stdout=subprocess.DEVNULL
    )
    columns = [name for name in fleet._TREND if name not in ("robot", "joint", "rejection")]
    other = {"limit": "d.limit", "state": "d.state"}
    other |= {f"after{part}_s": f"d.days{part} * 86400" for part in ("", "_low", "_high")}
    chosen = ", ".join(f"{other.get(name, f't.{name}')} AS {name}" for name in columns)
    inner = "SELECT robot, joint, sinew_trend(*) AS t, sinew_days_until(*) AS d FROM records GROUP BY robot, joint"
    out = tmp_path / "trends.parquet"
    sql = f"SELECT robot, joint, {chosen} FROM ({inner}) ORDER BY robot, joint"
    subprocess.run([program, "query", folder, sql, "--csv", out.with_suffix(".csv")], check=True, stdout=subprocess.DEVNULL)
    with out.with_suffix(".csv").open() as file:
        wanted = list(csv.DictReader(file))
    table = parquet.read_table(folder / "records", partitioning=None)
    follow = fleet.trend({"biorob-like": str(folder / "types/biorob-like")}, str(folder))
    for row in wanted:
        own = table.filter((dataset.field("robot") == row["robot"]) & (dataset.field("joint") == row["joint"]))
        (found,) = follow(own).to_pylist()
        for name in columns:
            value = found[name]
            assert row[name] == ("" if value is None else value if isinstance(value, str) else row[name]), name
            assert isinstance(value, str) or value is None or float(row[name]) == pytest.approx(value, rel=1e-12), name


def test_tendon_without_sessions_has_reason() -> None:
    (found,) = trends(tendon(0), fleet.trend(TYPES))
    assert found["rejection"] == "no session with a date and an offset" and found["offset_rad"] is None


def test_queries_of_the_manual_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    duckdb, polars = pytest.importorskip("duckdb"), pytest.importorskip("polars")
    page = Path("docs/src/manual/fleet.md").read_text()
    (sql,), (program,) = (re.findall(rf"```{language}\n(.*?)```", page, re.S) for language in ("sql", "python"))
    rows = [row | {"elongation_m": 0.02 * (row["offset_rad"] or 0.0)} for row in tendon(60)]
    rows += [row | {"joint": "wrist", "elongation_m": 1e-3} for row in tendon(3)]
    table = pa.Table.from_pylist(rows, schema=fleet._arrow(fleet._RECORD)).drop_columns(["rejection"])
    table = table.replace_schema_metadata({"sinew_schema": "sinew-record/2", "sinew_columns": '{"offset_rad": {"unit": "rad"}}'})
    folder = tmp_path / "out/fleet/records/robot_type=biorob-like/month=2023-11"
    folder.mkdir(parents=True)
    parquet.write_table(table, folder / "host-1.parquet")
    monkeypatch.chdir(tmp_path)
    first, second = (duckdb.sql(query).fetchall() for query in sql.split(";")[:2])
    # The session of a clock that stepped has an offset of 1 rad, and is not part of the answer.
    largest = max(row["elongation_m"] for row in rows[:60])
    assert first == sorted([("arm-1", "elbow", largest), ("arm-1", "wrist", 1e-3)], key=lambda row: -row[2])
    assert second == [('{"offset_rad": {"unit": "rad"}}',)]
    found: dict[str, Any] = {}
    exec(program, found)
    assert found["top"].sort("elongation_m", descending=True).collect().rows() == first
    assert "elongation_m" in capsys.readouterr().out and isinstance(found["top"], polars.LazyFrame)
