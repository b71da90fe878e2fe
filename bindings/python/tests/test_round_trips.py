"""Round trips: arrays, tables, JSON, pickle, copies."""

from __future__ import annotations

import copy
import json
import pickle
from typing import Any

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED


@pytest.fixture(scope="module")
def found() -> sn.Estimate:
    import os

    os.chdir(ROOT)
    return sn.estimate(SHIPPED, ROBOT, date="2026-03-02")


def copies(item: Any) -> list[Any]:
    return [pickle.loads(pickle.dumps(item)), copy.deepcopy(item), copy.copy(item)]


def test_an_estimate_survives_pickle_and_copies(found: sn.Estimate) -> None:
    for again in copies(found):
        assert type(again) is sn.Estimate
        assert again == found and again.to_json() == found.to_json()
        assert str(again) == str(found) and again.html() == found.html()
        assert again.table_names == found.table_names
        assert all(again.table(name) == found.table(name) for name in found.table_names)
        assert [str(w) for w in again.warnings] == [str(w) for w in found.warnings]
        assert again.baseline == found.baseline
        assert again.joint("elbow") == found.joint("elbow")


def test_an_estimate_is_read_from_its_json(found: sn.Estimate) -> None:
    again = sn.Estimate.from_json(found.to_json())
    assert again == found and str(again) == str(found)
    assert again.table("joints") == found.table("joints")
    # The document has no samples over time.
    assert len(again.table("series")) == 0
    assert [str(w) for w in again.warnings] == [str(w) for w in found.warnings]
    for text in ("{", "[]", json.dumps({"schema": "sinew/trend/2"})):
        with pytest.raises(sn.SinewError):
            sn.Estimate.from_json(text)


def test_other_results_are_read_from_their_json() -> None:
    trend = sn.trend("examples/10-trend/sessions.csv", ROBOT)
    again = sn.Trend.from_json(trend.to_json())
    assert again == trend and again.joint("elbow") == trend.joint("elbow")
    assert all(one == trend for one in copies(trend))


def test_robots_and_baselines_survive(learned: sn.Learned) -> None:
    robot = sn.Robot(ROBOT)
    for again in copies(robot):
        assert again == robot and hash(again) == hash(robot) and again.joints == robot.joints
    assert robot != sn.Robot("examples/05-your-own-robot") and robot != "robot"
    baseline = learned.learned_baseline
    for again in copies(baseline):
        assert again == baseline and hash(again) == hash(baseline) and again.to_text() == baseline.to_text()
    assert copies(learned)[0].learned_baseline == baseline


def test_recordings_survive() -> None:
    shipped = sn.Recording(SHIPPED)
    columns = shipped.arrays()
    with open(SHIPPED, "rb") as file:
        of_content = sn.Recording(file.read())
    of_arrays = sn.Recording.from_arrays(name="lab", **columns)
    for recording in (shipped, of_content, of_arrays, sn.Recording(SHIPPED, gap_s=0.004)):
        for again in copies(recording):
            assert again == recording and hash(again) == hash(recording)
            assert (again.name, again.format, again.joints) == (recording.name, recording.format, recording.joints)
    # The format does not matter, every frame does.
    assert shipped == of_content == of_arrays and shipped != "recording"
    assert shipped != sn.Recording(SHIPPED, gap_s=0.0009)
    columns["q"] = columns["q"].copy()
    columns["q"][-1, -1] += 1e-12
    assert sn.Recording.from_arrays(**columns) != shipped
    less = {name: values[:-1] if name != "joints" else values for name, values in columns.items()}
    assert sn.Recording.from_arrays(**less) != shipped
    # A copy has arrays of its own.
    shared = sn.Recording.from_arrays(**less)
    own = copy.deepcopy(shared)
    less["q"][:] = 0.0
    assert own != shared and own.arrays()["q"].any()


def test_tables_survive_with_units(found: sn.Estimate) -> None:
    for name in found.table_names:
        table = found.table(name)
        for again in copies(table):
            assert again == table and again.units == table.units
    assert found.table("joints") != found.table("series")
    units = found.table().units
    assert units["offset_rad"] == "rad" and units["elongation_m"] == "m" and "joint" not in units
    pa = pytest.importorskip("pyarrow")
    assert pa.table(found.table()).schema.field("offset_rad").metadata == {b"unit": b"rad"}


def test_a_simulated_recording_survives() -> None:
    day = sn.simulate("examples/scenarios/stretched-arm.toml", ROBOT, duration_s=2.0)
    again = pickle.loads(pickle.dumps(day))
    assert again == day and (again.recording.arrays()["q"] == day.arrays["q"]).all()


def test_a_trend_of_tables_is_that_of_the_estimates(found: sn.Estimate) -> None:
    of_answers = sn.trend([found], ROBOT)
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({name: found.table()[name] for name in found.table().column_names})
    for table in (found.table(), [found.table()], frame):
        of_table = sn.trend(table, ROBOT)
        assert len(of_table.joints) == len(of_answers.joints)
        for own, other in zip(of_table.joints, of_answers.joints):
            assert own.name == other.name
            assert own.sessions == other.sessions


def test_a_generator_gives_the_seed() -> None:
    scenario = "examples/scenarios/stretched-arm.toml"
    drawn = int(np.random.default_rng(3).integers(2**63))
    by_seed = sn.simulate(scenario, ROBOT, seed=drawn, duration_s=1.0)
    assert sn.simulate(scenario, ROBOT, rng=np.random.default_rng(3), duration_s=1.0) == by_seed
    assert sn.simulate(scenario, ROBOT, rng=drawn, duration_s=1.0) == by_seed
    assert sn.simulate(scenario, ROBOT, rng=drawn - 1, duration_s=1.0) != by_seed


def test_sample_data_have_names() -> None:
    assert "stretched-arm" in sn.datasets.names()
    data = sn.datasets.load("stretched-arm")
    assert data.robot == sn.Robot(ROBOT)
    found = sn.estimate(data.recording, data.robot)
    assert found.joint("elbow").verdict == "offset-detected"
    with pytest.raises(sn.SinewError, match="stretched-arm"):
        sn.datasets.load("stretched")
