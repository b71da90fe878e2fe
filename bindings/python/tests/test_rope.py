"""Ropes: law, prediction, selection; creep tests from arrays; months of sessions."""

from __future__ import annotations

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT

ROPE = "liros-dc000-0301"


def test_the_law_does_not_depend_on_how_time_is_cut() -> None:
    whole, cut = sn.RopeLaw(ROPE), sn.RopeLaw(ROPE)
    whole.hold(60.0, 3600.0)
    strains = cut.follow(np.full(60, 60.0), np.full(60, 60.0))
    assert strains[-1] == pytest.approx(whole.strain(60.0)["strain_ratio"], rel=1e-12)
    assert (np.diff(strains) > 0.0).all()
    parts = whole.strain(60.0)
    total = sum(parts[f"{name}_strain_ratio"] for name in ("elastic", "bedding", "delayed", "flow", "thermal"))
    assert parts["strain_ratio"] == pytest.approx(total - parts["retraction_strain_ratio"], rel=1e-14)
    with pytest.raises(ValueError):
        whole.hold(2.0 * whole.breaking_load_n, 1.0)
    # What was refused left the rope as it was.
    assert whole.strain(60.0) == parts
    whole.reset()
    assert whole.strain(0.0)["strain_ratio"] == 0.0


def test_a_prediction_is_the_law_under_the_duty() -> None:
    found = sn.predict_rope(ROPE, tension_n=60.0, length_m=0.7, times_s=[3600.0], draws=20)
    law = sn.RopeLaw(ROPE)
    law.hold(60.0, 3600.0)
    reading = found.readings[0]
    assert reading.elongation_m.value == pytest.approx(0.7 * law.strain(60.0)["strain_ratio"], rel=1e-9)
    blocks = sn.predict_rope(ROPE, duty=[(10.0, 60.0)], length_m=0.7, times_s=[3600.0], draws=20)
    assert blocks.readings[0].elongation_m.value == pytest.approx(reading.elongation_m.value, rel=1e-9)
    assert len(found.table("series")) > 20
    # A plot needs more than one reading.
    several = sn.predict_rope(ROPE, tension_n=60.0, times_s=[3600.0, 86_400.0], draws=20)
    assert "<svg" in (several._repr_html_() or "")


def test_guides_make_a_rope_longer() -> None:
    straight = sn.predict_rope(ROPE, tension_n=60.0, length_m=0.7, times_s=[3600.0], draws=20)
    guided = sn.predict_rope(
        ROPE,
        tension_n=60.0,
        length_m=0.7,
        guides=[sn.Guide(np.pi / 2, 0.008), (np.pi / 2, 0.008, 0.05, 0.4)],
        stroke_m=0.08,
        times_s=[3600.0],
        draws=20,
    )
    assert guided.readings[0].elongation_m.value > straight.readings[0].elongation_m.value


def test_a_creep_test_from_arrays_is_that_of_its_file() -> None:
    import csv

    with open("examples/06-creep-test/rope-A.csv", encoding="utf-8") as file:
        # Three lines of the head: rope, gauge length, temperature.
        rows = list(csv.DictReader(file.readlines()[3:]))
    columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    of_arrays = sn.CreepTests({"rope A": columns}, gauge_length_m=0.35, temperature_c=23.0).analyze()
    of_file = sn.CreepTests("examples/06-creep-test/rope-A.csv").analyze()
    ours, theirs = of_arrays.specimens[0], of_file.specimens[0]
    # But for the last digit of 350 mm as metres.
    assert ours.end_strain_ratio == pytest.approx(theirs.end_strain_ratio, rel=1e-14)
    assert ours.force_n == theirs.force_n and len(ours.readings) == len(theirs.readings)
    with pytest.raises(ValueError, match="different lengths"):
        sn.CreepTests({"a": {"time_s": [1, 2], "strain_percent": [1]}})


def test_a_fitted_rope_becomes_an_entry(tmp_path) -> None:
    tests = sn.CreepTests("examples/06-creep-test/rope-A.csv")
    fit = tests.fit(["rope"], rope=ROPE, rope_name="my-rope")
    assert fit.rope_entry is not None and 'name = "my-rope"' in fit.rope_entry
    (tmp_path / "my-rope.toml").write_text(fit.rope_entry)
    found = sn.predict_rope("my-rope", tension_n=60.0, times_s=[5100.0], ropes=[tmp_path], draws=20)
    assert found.rope == "my-rope"
    assert len(fit.table("parameters")) > 3 and "<svg" in fit._repr_html_()


def test_a_trend_takes_answers_tables_and_files() -> None:
    import csv

    file = "examples/10-trend/sessions.csv"
    wanted = sn.trend(file, ROBOT, tensioned="2026-03-02").to_json()
    with open(file, encoding="utf-8") as text:
        rows = list(csv.DictReader(line for line in text if not line.startswith("#")))
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    for records in (rows, columns):
        assert sn.trend(records, ROBOT, tensioned={"elbow": "2026-03-02", "shoulder_pitch": ["2026-03-02"]}).joint(
            "elbow"
        ).to_dict() == sn.trend(file, ROBOT, tensioned="2026-03-02").joint("elbow").to_dict()
        assert sn.trend(records, ROBOT, tensioned="2026-03-02").to_json() == wanted
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame(columns)
    found = sn.trend(frame, ROBOT, tensioned=["2026-03-02"])
    assert found.to_json() == wanted
    assert found.table_names == ["sessions", "series"] and "<svg" in found._repr_html_()


def test_answers_of_estimates_are_records(work, learned: sn.Learned) -> None:
    answers = [
        sn.estimate(work, ROBOT, baseline=learned.learned_baseline, from_s=60.0, to_s=90.0),
        sn.estimate(work, ROBOT, baseline=learned.learned_baseline, from_s=90.0, to_s=120.0),
    ]
    found = sn.trend(answers, ROBOT)
    assert found.joint("elbow").sessions == 2
