"""Warnings of the command are warnings of Python, with categories."""

from __future__ import annotations

import pickle
import warnings

import numpy as np
import pytest

import pysinew as sn

from conftest import ROBOT, SHIPPED


def test_an_implausible_motor_position_warns() -> None:
    arrays = sn.Recording(SHIPPED).arrays()
    # A zero of the encoder that is wrong by 2 rad: no rope stretches that far.
    arrays["theta"][:, arrays["joints"].index("elbow")] += 2.0
    with pytest.warns(sn.SinewWarning) as caught:
        found = sn.estimate_arrays(ROBOT, **arrays)
    own = [w for w in caught if isinstance(w.message, sn.SinewWarning)]
    assert len(own) == len(found.warnings) > 0
    assert all(w.filename == __file__ for w in own), "a warning names the line of the caller"
    assert {str(w.message) for w in own} == {str(w) for w in found.warnings}
    offsets = [w for w in found.warnings if w.code == "implausible-offset"]
    assert offsets and all(isinstance(w, sn.RecordingWarning) and "degrees?" in w.text for w in offsets)
    assert "implausible-offset" in repr(found) and "implausible-offset" in str(found._repr_html_())


def test_warnings_are_those_of_stderr(sinew: str) -> None:
    import subprocess

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sn.SinewWarning)
        found = sn.estimate(SHIPPED, ROBOT, to_s=8.0)
    arguments = [sinew, "estimate", SHIPPED, "--robot", ROBOT, "--to", "8"]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert found.warnings
    for warning in found.warnings:
        assert warning.code in done.stderr


def test_categories_select_and_raise() -> None:
    assert issubclass(sn.ResultWarning, sn.SinewWarning) and issubclass(sn.SinewWarning, UserWarning)
    with warnings.catch_warnings():
        warnings.simplefilter("error", sn.ResultWarning)
        with pytest.raises(sn.ResultWarning) as caught:
            sn.estimate(SHIPPED, ROBOT, to_s=8.0)
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is sn.ResultWarning and again.code == caught.value.code and str(again) == str(caught.value)


def test_one_type_of_error_a_kind() -> None:
    found = sn.estimate(SHIPPED, ROBOT)
    with pytest.raises(sn.UnknownNameError, match="^no elastic joint 'elbo'; there are") as caught:
        found.joint("elbo")
    assert isinstance(caught.value, KeyError) and isinstance(caught.value, sn.SinewError)
    with pytest.raises(sn.SinewError):
        sn.merge_baselines([], ROBOT, scatter=2.0)
