"""Sample data by name: simulated recordings of a robot with known truth."""

from __future__ import annotations

from typing import NamedTuple

from ._core import Recording, Robot
from ._core import dataset as _dataset
from ._core import dataset_names as _dataset_names
from ._simulate import Simulated, simulate

__all__ = ["Dataset", "load", "names"]


class Dataset(NamedTuple):
    """A recording, its robot, and its truth."""

    robot: Robot
    recording: Recording
    truth: Simulated
    """What was simulated: the offsets, and the recording as ``arrays``."""


def names() -> list[str]:
    """Names of the sample data.

    Returns
    -------
    list of str
        As ``load`` takes them.
    """
    return _dataset_names()


def load(name: str = "stretched-arm") -> Dataset:
    """Loads sample data; its recording is simulated on every call, always with the same numbers.

    Parameters
    ----------
    name
        ``"stretched-arm"``: an arm of four joints for 20 s; the tendons of two joints stretch by a known length.
        ``"work-session"``: three minutes of work; the tendons stretch after the first minute.

    Returns
    -------
    Dataset
        Robot, recording and truth.

    Raises
    ------
    SinewError
        For an unknown name.

    Examples
    --------

    >>> import pysinew as sn
    >>> robot, recording, truth = sn.datasets.load("stretched-arm")
    >>> est = sn.estimate(recording, robot)
    """
    scenario, robot_toml, urdf = _dataset(name)
    robot = Robot.from_text(robot_toml, urdf)
    truth = simulate((scenario, f"{name}.toml"), robot)
    return Dataset(robot, truth.recording, truth)
