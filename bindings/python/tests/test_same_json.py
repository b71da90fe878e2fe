"""The JSON of the package equals that of the command on all examples."""

from __future__ import annotations

from pathlib import Path

import pytest

import pysinew as sn

from conftest import ROBOT, SHIPPED

CREEP = [f"examples/06-creep-test/rope-{name}.csv" for name in "ABC"]
OWN = "examples/05-your-own-robot"
DAYS = {"tensioned": "2026-03-02"}

# Arguments of the command, and the call that answers the same.
CASES = {
    "estimate": (["estimate", SHIPPED, "--robot", ROBOT], lambda: sn.estimate(SHIPPED, ROBOT)),
    "estimate, robot loaded": (
        ["estimate", SHIPPED, "--robot", ROBOT],
        lambda: sn.estimate(sn.Recording(SHIPPED), sn.Robot(ROBOT)),
    ),
    "estimate of the motor torque": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--source", "motor"],
        lambda: sn.estimate(SHIPPED, ROBOT, source="motor"),
    ),
    "estimate as the paper does": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--comparison", "paper", "--gain", 25],
        lambda: sn.estimate(SHIPPED, ROBOT, comparison="paper", gain_per_s=25.0),
    ),
    "estimate with an offset added": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--inject", "elbow=0.01@20"],
        lambda: sn.estimate(SHIPPED, ROBOT, inject=[("elbow", 0.01, 20.0)]),
    ),
    "estimate against another recording": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--reference", SHIPPED],
        lambda: sn.estimate(SHIPPED, ROBOT, reference=SHIPPED),
    ),
    "estimate of a part, payload and temperature stated": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--payload", "0.1±0.05", "--temperature", "22degC", "--from", 2, "--to", 30],
        lambda: sn.estimate(SHIPPED, ROBOT, payload_kg=(0.1, 0.05), temperature_c=22.0, from_s=2.0, to_s=30.0),
    ),
    "estimate with a date stated": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--date", "2018-07-05"],
        lambda: sn.estimate(SHIPPED, ROBOT, date="2018-07-05"),
    ),
    "estimate with a force stated": (
        ["estimate", SHIPPED, "--robot", ROBOT, "--external-force", "0,0,5±0.5"],
        lambda: sn.estimate(SHIPPED, ROBOT, external_force_n=((0, 0, 5), 0.5)),
    ),
    "estimate of each": (
        ["estimate", "--each", SHIPPED, "--robot", ROBOT],
        lambda: sn.estimate_each([SHIPPED], ROBOT),
    ),
    "estimate of a robot of one's own": (
        ["estimate", f"{OWN}/nod.csv", "--robot", OWN],
        lambda: sn.estimate(f"{OWN}/nod.csv", OWN),
    ),
    "log info": (["log", "info", SHIPPED], lambda: sn.recording_info(SHIPPED)),
    "robot check": (["robot", "check", ROBOT], lambda: sn.check_robot(ROBOT)),
    "robot check of one's own": (["robot", "check", OWN], lambda: sn.check_robot(OWN)),
    "creep analyze": (["creep", "analyze", CREEP[2]], lambda: sn.CreepTests(CREEP[2]).analyze()),
    "creep compare": (["creep", "compare", *CREEP], lambda: sn.CreepTests(CREEP).compare()),
    "creep fit": (
        ["creep", "fit", CREEP[0], "--law", "log-time", "--law", "findley", "--forecast", "24h"],
        lambda: sn.CreepTests(CREEP[0]).fit(["log-time", "findley"], forecast_s=86_400.0),
    ),
    "creep fit, hold-out": (
        ["creep", "fit", CREEP[0], "--law", "log-time", "--hold-out", 0.33],
        lambda: sn.CreepTests(CREEP[0]).hold_out(0.33, ["log-time"]),
    ),
    "trend": (
        ["trend", "examples/10-trend/sessions.csv", "--robot", ROBOT, "--tensioned", "2026-03-02"],
        lambda: sn.trend("examples/10-trend/sessions.csv", ROBOT, **DAYS),
    ),
    "rope list": (["rope", "list"], lambda: sn.list_ropes()),
    "rope show": (["rope", "show", "liros-dc000-0301"], lambda: sn.describe_rope("liros-dc000-0301")),
    "rope predict": (
        ["rope", "predict", "liros-dc000-0301", "--tension", 60, "--length", 700],
        lambda: sn.predict_rope("liros-dc000-0301", tension_n=60.0, length_m=0.7),
    ),
    "rope predict of a joint": (
        ["rope", "predict", "--robot", ROBOT, "--joint", "elbow", "--stroke", 80, "--draws", 40],
        lambda: sn.predict_rope(robot=ROBOT, joint="elbow", stroke_m=0.08, draws=40),
    ),
    "rope predict of a recording": (
        ["rope", "predict", "--recording", SHIPPED, "--robot", ROBOT, "--joint", "elbow", "--draws", 40, "--at", "1h"],
        lambda: sn.predict_rope(recording=SHIPPED, robot=ROBOT, joint="elbow", draws=40, times_s=[3600.0]),
    ),
    "rope select": (
        ["rope", "select", "--tension", 60, "--length", 700, "--at", "30d", "--max-diameter", 1.8, "--draws", 40],
        lambda: sn.select_rope(
            tension_n=60.0, length_m=0.7, times_s=[30 * 86_400.0], diameter_max_m=1.8e-3, draws=40
        ),
    ),
    "rope pretension": (
        ["rope", "pretension", "--robot", ROBOT, "--joint", "elbow", "--torque", 2, "--joint-radius", 25, "--draws", 20],
        lambda: sn.plan_pretension(robot=ROBOT, joint="elbow", torque_nm=2.0, joint_radius_m=0.025, draws=20),
    ),
    "excitation": (
        ["excitation", "--robot", ROBOT, "--poses", 2, "--candidates", 1],
        lambda: sn.propose_poses(ROBOT, poses=2, candidates=1),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_json_is_that_of_the_command(name: str, command, sinew: str) -> None:
    import subprocess

    arguments, call = CASES[name]
    # Exit code 3 means that action is required; the result agrees.
    done = subprocess.run([sinew, *map(str, arguments), "--json"], capture_output=True, text=True, check=False)
    assert done.returncode in (0, 3), done.stderr
    answer = call()
    assert answer.to_json() == done.stdout
    assert answer.is_lossy == (done.returncode == 3)


def test_a_session_since_a_baseline_is_that_of_the_command(
    tmp_path: Path, work: Path, learned: sn.Learned, command
) -> None:
    file = tmp_path / "arm.baseline"
    told = command("baseline", work, "--robot", ROBOT, "--to", 60, "--out", file, "--json")
    assert learned.to_json() == told
    own = tmp_path / "own.baseline"
    learned.write(own)
    assert own.read_bytes() == file.read_bytes()
    saved = tmp_path / "next.baseline"
    told = command("estimate", work, "--robot", ROBOT, "--baseline", file, "--from", 60, "--save", saved, "--json")
    for baseline in (learned.learned_baseline, str(file)):
        found = sn.estimate(work, ROBOT, baseline=baseline, from_s=60.0)
        assert found.to_json() == told
    next_one = tmp_path / "own-next.baseline"
    found.baseline.write(next_one)
    assert next_one.read_bytes() == saved.read_bytes()
    # Several baselines of one robot together.
    other, day = tmp_path / "other.baseline", tmp_path / "other.mcap"
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, seed=5, duration_s=60.0, out=day)
    sn.learn_baseline(day, ROBOT).write(other)
    merged = sn.merge_baselines([file, other], ROBOT)
    told = command("baseline", "merge", file, other, "--robot", ROBOT, "--out", tmp_path / "arm.known", "--json")
    assert merged.to_json() == told


def test_a_simulated_recording_is_that_of_the_command(tmp_path: Path, command) -> None:
    scenario = "examples/scenarios/stretched-arm.toml"
    theirs, ours = tmp_path / "theirs.mcap", tmp_path / "ours.mcap"
    told = command("simulate", scenario, "--robot", ROBOT, "--duration", 3, "--out", theirs, "--json")
    made = sn.simulate(scenario, ROBOT, duration_s=3.0, out=ours)
    assert made.to_json() == told
    assert ours.read_bytes() == theirs.read_bytes()
    # In memory: the same truth, and the same numbers as in the file.
    held = sn.simulate(scenario, ROBOT, duration_s=3.0)
    assert held.to_json() == told
    arrays = sn.Recording(ours).arrays()
    for name in ("time_ns", "q", "theta"):
        assert (held.arrays[name] == arrays[name]).all()


def test_scenario_text_is_a_scenario_that_simulates() -> None:
    text = sn.scenario_text("S7")
    assert sn.simulate((text, "S7.toml"), ROBOT, duration_s=1.0).to_json()


def test_the_words_are_those_of_the_command(command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    found = sn.estimate(SHIPPED, ROBOT)
    assert str(found) == command("estimate", SHIPPED, "--robot", ROBOT, "--quiet")
    assert found.html().startswith("<!DOCTYPE html>")
