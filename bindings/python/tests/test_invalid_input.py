"""Invalid times and numbers are rejected, and masked values are missing."""

from __future__ import annotations

import numpy as np
import pytest
import pysinew as sn

from conftest import ROOT

ROBOT = ROOT / "robots/biorob-like"
SHIPPED = ROOT / "examples/01-stretched-arm/stretched-arm.mcap"


@pytest.fixture(scope="module")
def columns() -> dict:
    return sn.Recording(SHIPPED).arrays()


def made(columns: dict, name: str = "arrays", **other: object) -> sn.Recording:
    given = {k: columns[k] for k in ("q", "theta", "tau_m") if k in columns} | other
    if "time_s" not in given:
        given.setdefault("time_ns", columns["time_ns"])
    return sn.Recording.from_arrays(joints=columns["joints"], name=name, **given)


def test_reference_of_same_name_is_rejected(columns: dict) -> None:
    longer = columns["theta"].copy()
    longer[:, columns["joints"].index("elbow")] += 0.02
    with pytest.raises(ValueError, match="both called 'arrays'"):
        sn.estimate(made(columns, theta=longer), ROBOT, reference=made(columns))
    told = sn.estimate(made(columns, "now", theta=longer), ROBOT, reference=made(columns))
    elbow = next(j for j in told.reading.joints if j.name == "elbow")
    assert elbow.difference.difference_rad == pytest.approx(0.02, abs=1e-3)


@pytest.mark.parametrize("row", [0, 1000])
def test_invalid_time_is_rejected(columns: dict, row: int) -> None:
    time_s = (columns["time_ns"] - columns["time_ns"][0]) * 1e-9
    time_s[row] = np.nan
    with pytest.raises(ValueError, match=f"invalid time in row {row}"):
        made(columns, time_s=time_s)
    dates = columns["time_ns"].astype("datetime64[ns]")
    dates[row] = "NaT"
    with pytest.raises(ValueError, match=f"row {row} is NaT"):
        made(columns, time_ns=dates)


def test_what_is_masked_is_not_recorded(columns: dict) -> None:
    beneath = columns["theta"].copy()
    hidden = np.zeros(beneath.shape, bool)
    hidden[5000:7000] = True
    beneath[hidden] = -0.999
    absent = np.where(hidden, np.nan, columns["theta"])
    told = [
        sn.estimate(made(columns, theta=theta), ROBOT).to_json()
        for theta in (np.ma.masked_array(beneath, hidden), absent)
    ]
    assert told[0] == told[1]


def test_words_are_no_numbers(columns: dict) -> None:
    with pytest.raises(TypeError, match="contains no numbers"):
        made(columns, q=columns["q"].astype(str))
