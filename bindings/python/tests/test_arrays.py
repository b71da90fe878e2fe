"""Input of NumPy arrays: equal to files, without copies, and with error messages."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED


@pytest.fixture(scope="module")
def arrays() -> dict[str, Any]:
    import os

    os.chdir(ROOT)
    columns = sn.Recording(SHIPPED).arrays()
    columns.pop("segment")
    return columns


def joints_of(answer: sn.Estimate) -> Any:
    document = json.loads(answer.to_json())
    return document["session"]["joints"], document["reading"]["joints"]


def test_arrays_estimate_equals_file(arrays: dict[str, Any]) -> None:
    found = sn.estimate_arrays(ROBOT, **sn.Recording(SHIPPED).arrays())
    assert joints_of(found) == joints_of(sn.estimate(SHIPPED, ROBOT))
    assert found.reading.recording.format == "arrays"
    assert found.reading.recording.path == "arrays"


def test_strides_and_types_do_not_matter(arrays: dict[str, Any]) -> None:
    joints, q, theta = arrays["joints"], arrays["q"], arrays["theta"]
    plain = sn.Recording.from_arrays(joints=joints, q=q, theta=theta, time_ns=arrays["time_ns"])
    wanted = plain.arrays()
    # Columns of a wider array, and Fortran's order.
    wide = np.full((len(q), 2 * q.shape[1]), np.nan)
    wide[:, ::2] = q
    others = [
        {"q": wide[:, ::2], "theta": np.asfortranarray(theta), "time_ns": arrays["time_ns"]},
        {"q": q.tolist(), "theta": theta, "time_ns": arrays["time_ns"].astype("datetime64[ns]")},
        {"q": q, "theta": theta, "time_ns": arrays["time_ns"].astype("uint64")},
    ]
    for other in others:
        read = sn.Recording.from_arrays(joints=joints, **other).arrays()
        for name in ("time_ns", "q", "theta"):
            assert (read[name] == wanted[name]).all(), name
    # float32 is what it is.
    single = sn.Recording.from_arrays(joints=joints, q=q.astype("f4"), theta=theta, time_ns=arrays["time_ns"])
    assert np.abs(single.arrays()["q"] - wanted["q"]).max() < 1e-6
    # Seconds from zero.
    time_s = (arrays["time_ns"] - arrays["time_ns"][0]) * 1e-9
    read = sn.Recording.from_arrays(joints=joints, q=q, theta=theta, time_s=time_s).arrays()
    assert (read["time_ns"] == arrays["time_ns"] - arrays["time_ns"][0]).all()


def test_columns_may_come_in_any_order(arrays: dict[str, Any]) -> None:
    order = [2, 0, 3, 1]
    joints = [arrays["joints"][i] for i in order]
    turned = sn.estimate_arrays(
        ROBOT, joints=joints, q=arrays["q"][:, order], theta=arrays["theta"][:, order], time_ns=arrays["time_ns"]
    )
    plain = sn.estimate_arrays(ROBOT, q=arrays["q"], theta=arrays["theta"], time_ns=arrays["time_ns"])
    assert joints_of(turned) == joints_of(plain)


def test_arrays_are_not_copied() -> None:
    """Peak memory while 256 MB of arrays are read grows by far less than one of them."""
    code = """
import resource, numpy as np, pysinew as sn
rows, n = 2_000_000, 4
t = np.arange(rows, dtype=np.int64) * 1_000_000
q = np.zeros((rows, n)); theta = np.zeros((rows, n)); tau = np.zeros((rows, n)); ext = np.zeros((rows, n))
for a in (q, theta, tau, ext):
    a += 0.1
robot = sn.Robot("robots/biorob-like")
recording = sn.Recording.from_arrays(joints=robot.joints, q=q, theta=theta, tau_m=tau, tau_ext=ext, time_ns=t)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
sn.recording_info(recording)
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print((after - before) / 1024)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    grown_mb = float(done.stdout)
    assert grown_mb < 32, f"{grown_mb} MB"


def test_arrays_inconsistent_shape_error(arrays: dict[str, Any]) -> None:
    joints, q, theta, t = (arrays[k] for k in ("joints", "q", "theta", "time_ns"))
    make = sn.Recording.from_arrays

    def refused(kind: type[Exception], words: str, **columns: Any) -> None:
        given = {"joints": joints, "q": q, "theta": theta, "time_ns": t, **columns}
        with pytest.raises(kind, match=words):
            sn.recording_info(make(**given))

    refused(ValueError, r"theta has the shape \[19999, 4\]; \[20000, 4\] is needed", theta=theta[1:])
    refused(ValueError, r"q has the shape \[20000, 3\]", q=q[:, :3])
    refused(ValueError, "q must have rows and columns", q=q[:, 0])
    refused(ValueError, "one-dimensional array of numbers", time_ns=t[:, None])
    refused(TypeError, "seconds as time_s", time_ns=t * 1e-9)
    refused(TypeError, "specify either", time_s=t)
    refused(ValueError, "temperature_c has 3 values", temperature_c=[1.0, 2.0, 3.0])
    refused(ValueError, "runs backwards", time_ns=t[::-1])
    refused(ValueError, "duplicate column", joints=["a", "a", "b", "c"])
    with pytest.raises(ValueError, match="position of joint 'elbow' is missing"):
        names = ["shoulder_yaw", "shoulder_pitch", "ellbow", "wrist"]
        sn.estimate_arrays(ROBOT, joints=names, q=q, theta=theta, time_ns=t)


def test_frames_come_back_as_they_went_in(arrays: dict[str, Any]) -> None:
    recording = sn.Recording(SHIPPED)
    chosen = recording.arrays(joints=["elbow"])
    column = arrays["joints"].index("elbow")
    assert (chosen["q"][:, 0] == arrays["q"][:, column]).all()
    assert recording.channels["elbow"][:2] == ["q", "theta"]
    with pytest.raises(ValueError, match="did you mean 'elbow'"):
        recording.arrays(joints=["elbo"])
