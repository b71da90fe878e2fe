"""Errors are ValueErrors with the sentence of the command, and know their place."""

from __future__ import annotations

from pathlib import Path

import pytest

import pysinew as sn

from conftest import ROBOT, SHIPPED


def test_a_fault_of_a_file_knows_its_place(tmp_path: Path, command) -> None:
    robot = tmp_path / "arm"
    robot.mkdir()
    text = Path(ROBOT, "robot.toml").read_text().replace("stiffness_nm_per_rad", "stifness_nm_per_rad", 1)
    (robot / "robot.toml").write_text(text)
    (robot / "biorob-like.urdf").write_text(Path(ROBOT, "biorob-like.urdf").read_text())
    with pytest.raises(sn.LocatedError) as caught:
        sn.Robot(robot)
    error = caught.value
    assert isinstance(error, sn.SinewError) and isinstance(error, ValueError)
    assert error.file == str(robot / "robot.toml")
    line = 1 + text[: text.index("stifness_nm_per_rad")].count("\n")
    assert error.line == line
    assert error.place == "joints.shoulder_yaw"
    assert "stifness_nm_per_rad" in error.problem + str(error.cure)
    assert str(error).startswith(f"{error.file}, line {line}: ")
    # The same sentence as the command's.
    import subprocess

    done = subprocess.run(["sinew", "estimate", SHIPPED, "--robot", str(robot)], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stderr == f"error: {error}\n"
    with pytest.raises(sn.LocatedError):
        sn.estimate(SHIPPED, robot)


def test_other_errors_have_messages(tmp_path: Path) -> None:
    cases = [
        (lambda: sn.estimate("missing.mcap", ROBOT), "missing.mcap: cannot open"),
        (lambda: sn.estimate(SHIPPED, "missing"), "missing"),
        (lambda: sn.estimate(SHIPPED, ROBOT, method="papers"), "it can be 'absolute', 'paper'"),
        (lambda: sn.estimate(SHIPPED, ROBOT, method="paper", from_s=3.0), "from_s applies to the absolute estimate only"),
        (lambda: sn.estimate(SHIPPED, ROBOT, payload_kg=-1.0), "invalid payload -1 kg"),
        (lambda: sn.estimate(SHIPPED, ROBOT, temperature_c=400.0), "invalid temperature 400 °C"),
        (lambda: sn.estimate(SHIPPED, ROBOT, from_s=5.0, to_s=5.0), "end after its start"),
        (lambda: sn.estimate(SHIPPED, ROBOT, inject=[("elbo", 0.01)]), "did you mean 'elbow'"),
        (lambda: sn.estimate(SHIPPED, ROBOT, empty=True, payload_kg=1.0), "mutually exclusive"),
        (lambda: sn.estimate(SHIPPED, ROBOT, external_force_n=((0, 0, 0), 0)), "invalid standard deviation of the external force, 0 N"),
        (lambda: sn.estimate(SHIPPED, ROBOT, method="paper", external_force_n=((0, 0, 5), 1)), "external_force_n applies to"),
        (lambda: sn.Baseline.read(SHIPPED), "stretched-arm.mcap"),
        (lambda: sn.predict_rope("liros-dc000-0302", tension_n=1.0), "did you mean 'liros-dc000-0301'"),
        (lambda: sn.predict_rope("liros-dc000-0301"), "no load specified"),
        (lambda: sn.predict_rope(tension_n=1.0), "which rope"),
        (lambda: sn.predict_rope("liros-dc000-0301", duty=[(0.0, 5.0)]), "duty, block 0"),
        (lambda: sn.select_rope(tension_n=60.0, bend_ratio_min=8.0), "needs pulley_diameter_m"),
        (lambda: sn.plan_pretension("liros-dc000-0301"), "specify tension_n"),
        (lambda: sn.plan_pretension("liros-dc000-0301", tension_n=60.0, lowest_n=70.0), "must be below"),
        (lambda: sn.CreepTests([]), "no creep test specified"),
        (lambda: sn.CreepTests("examples/06-creep-test/rope-A.csv", level=2.0), "level is 2"),
        (lambda: sn.CreepTests("examples/06-creep-test/rope-A.csv").fit(["rope"]), "requires the option rope"),
        (lambda: sn.CreepTests("examples/06-creep-test/rope-A.csv").fit(["burger"]), "burger"),
        (lambda: sn.trend([{"time": "2026-03-01", "joint": "elbow"}]), "offset_mrad"),
        (lambda: sn.trend("examples/10-trend/sessions.csv", tensioned="soon"), "'soon' is not a date"),
        (lambda: sn.simulate(("[motion]\nkind = 'x'", "mine.toml"), ROBOT), "mine.toml, line"),
        (lambda: sn.simulate("examples/scenarios/stretched-arm.toml", ROBOT, duration_s=-1.0), "above 0 s"),
        (lambda: sn.scenario_text("S99"), "unknown scenario 'S99'"),
        (lambda: sn.Robot.from_text("", ""), "."),
    ]
    for call, words in cases:
        with pytest.raises(ValueError, match=words):
            call()


def test_wrong_types_are_type_errors() -> None:
    for call in (
        lambda: sn.estimate(3, ROBOT),  # type: ignore[arg-type]
        lambda: sn.Robot(3),  # type: ignore[arg-type]
        lambda: sn.predict_rope("liros-dc000-0301", tension_n="60"),  # type: ignore[arg-type]
    ):
        with pytest.raises(TypeError):
            call()


def test_results_are_read_only_and_list_fields() -> None:
    found = sn.estimate(SHIPPED, ROBOT)
    elbow = found.joint("elbow")
    with pytest.raises(AttributeError, match="cannot be changed"):
        elbow.verdict = "inconclusive"  # type: ignore[assignment]
    with pytest.raises(AttributeError, match="it has .*offset_rad"):
        elbow.offset_mrad  # type: ignore[attr-defined]
    with pytest.raises(KeyError, match="there are shoulder_yaw"):
        found.joint("elbo")
    assert "offset_rad" in dir(elbow) and "verdict='offset-detected'" in repr(elbow)
    low, high = elbow.offset_rad.interval_95
    assert low < elbow.offset_rad.mean < high
    assert elbow.to_dict()["offset_rad"]["mean"] == elbow.offset_rad.mean
