"""Columns with names are found by name; times with zones, files and bytes are read."""

from __future__ import annotations

import datetime
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED

ORDER = [2, 0, 3, 1]


@pytest.fixture(scope="module")
def arrays() -> dict[str, Any]:
    import os

    os.chdir(ROOT)
    return sn.Recording(SHIPPED).arrays()


def joints(found: sn.Estimate) -> list[dict[str, Any]]:
    assert found.session is not None
    return [joint.to_dict() for joint in found.session.joints]


def frames(arrays: dict[str, Any], library: str) -> tuple[Any, Any]:
    """Joint and motor positions with permuted columns, under two ways to name them."""
    names = [arrays["joints"][i] for i in ORDER]
    q, theta = arrays["q"][:, ORDER], arrays["theta"][:, ORDER]
    if library == "pandas":
        pd = pytest.importorskip("pandas")
        return pd.DataFrame(q, columns=names), pd.DataFrame(theta, columns=[f"theta.{n}_rad" for n in names])
    if library == "polars":
        pl = pytest.importorskip("polars")
        return pl.DataFrame(q, schema=names), pl.DataFrame(theta, schema=[f"theta.{n}" for n in names])
    xr = pytest.importorskip("xarray")
    return tuple(xr.DataArray(part, dims=("time", "joint"), coords={"joint": names}) for part in (q, theta))


@pytest.mark.parametrize("library", ["pandas", "polars", "xarray"])
def test_permuted_columns_are_found_by_name(arrays: dict[str, Any], library: str) -> None:
    q, theta = frames(arrays, library)
    found = sn.estimate_arrays(ROBOT, q=q, theta=theta, time_ns=arrays["time_ns"])
    plain = sn.estimate_arrays(ROBOT, q=arrays["q"], theta=arrays["theta"], time_ns=arrays["time_ns"])
    assert joints(found) == joints(plain)
    # Without names of the joints, those of the columns.
    recording = sn.Recording.from_arrays(q=q, theta=theta, time_ns=arrays["time_ns"])
    assert recording.joints == [arrays["joints"][i] for i in ORDER]


def test_a_missing_column_is_an_error(arrays: dict[str, Any]) -> None:
    pd = pytest.importorskip("pandas")
    q = pd.DataFrame(arrays["q"], columns=["a", "b", "elbow", "wrist"])
    with pytest.raises(sn.SinewError, match="q has no column of joint shoulder_yaw, shoulder_pitch; its columns are a, b"):
        sn.estimate_arrays(ROBOT, q=q, theta=arrays["theta"], time_ns=arrays["time_ns"])
    with pytest.raises(sn.SinewError, match="joints is needed"):
        sn.Recording.from_arrays(q=arrays["q"], theta=arrays["theta"], time_ns=arrays["time_ns"])
    # Numbered columns have no names.
    plain = pd.DataFrame(arrays["q"])
    assert sn.estimate_arrays(ROBOT, q=plain, theta=arrays["theta"], time_ns=arrays["time_ns"]).session is not None


def test_times_with_zones(arrays: dict[str, Any]) -> None:
    pd = pytest.importorskip("pandas")
    given = {"joints": arrays["joints"], "q": arrays["q"], "theta": arrays["theta"]}
    start = np.datetime64("2026-03-02T08:00", "ns")
    wanted = (start + (arrays["time_ns"] - arrays["time_ns"][0]).astype("timedelta64[ns]")).astype(np.int64)
    utc = pd.to_datetime(wanted, utc=True)
    berlin = utc.tz_convert("Europe/Berlin")
    of_datetime = [datetime.datetime.fromtimestamp(t // 1000 / 1e6, datetime.timezone.utc) for t in wanted.tolist()]
    for times in (utc, berlin, pd.Series(berlin), berlin.to_pydatetime()):
        read = sn.Recording.from_arrays(time_ns=times, **given).arrays()["time_ns"]
        assert np.abs(read - wanted).max() < 1000
    read = sn.Recording.from_arrays(time_ns=of_datetime, **given).arrays()["time_ns"]
    assert np.abs(read - wanted).max() < 2000
    # The index of a data frame, where no times are given.
    frame = pd.DataFrame(arrays["q"], columns=arrays["joints"], index=berlin)
    read = sn.Recording.from_arrays(q=frame, theta=arrays["theta"]).arrays()
    assert (read["time_ns"] == wanted).all()


def test_dates_of_datetime() -> None:
    text = sn.estimate(SHIPPED, ROBOT, date="2026-03-02T07:00:00Z")
    zone = datetime.timezone(datetime.timedelta(hours=1))
    for date in (datetime.datetime(2026, 3, 2, 8, tzinfo=zone), np.datetime64("2026-03-02T07:00")):
        assert sn.estimate(SHIPPED, ROBOT, date=date) == text
    sessions = "examples/10-trend/sessions.csv"
    wanted = sn.trend(sessions, ROBOT, tensioned="2026-03-02")
    assert sn.trend(sessions, ROBOT, tensioned=datetime.date(2026, 3, 2)) == wanted
    assert sn.trend(sessions, ROBOT, tensioned=[datetime.date(2026, 3, 2)]) == wanted


def test_bytes_and_open_files_are_recordings(tmp_path: Path) -> None:
    wanted = sn.estimate(SHIPPED, ROBOT)
    content = Path(SHIPPED).read_bytes()
    with open(SHIPPED, "rb") as file:
        opened = sn.estimate(file, ROBOT)
    assert joints(opened) == joints(wanted)
    for log in (content, io.BytesIO(content), bytearray(content)):
        recording = sn.Recording(log)  # type: ignore[arg-type]
        assert recording.format == "mcap"
        assert joints(sn.estimate(recording, ROBOT)) == joints(wanted)
    csv = tmp_path / "frames.csv"
    sn.Recording(SHIPPED).table().write(csv)
    assert sn.Recording(io.StringIO(csv.read_text())).format == "csv"
