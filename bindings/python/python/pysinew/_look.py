"""Contents of recordings and robot descriptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

from . import results
from ._answer import Answer
from ._core import Recording, Robot
from ._errors import RobotWarning, SinewWarning
from ._types import PathLike, Progress

if TYPE_CHECKING:
    from ._types import RecordingLike, RobotLike


class RecordingInfo(Answer, results.RecordingInfoResult):
    """Contents of a recording, and losses while reading."""

    __slots__ = ()


class RobotCheck(Answer, results.RobotCheckResult):
    """Interpreted robot description, with implausible values."""

    __slots__ = ()

    @property
    def warnings(self) -> list[SinewWarning]:  # type: ignore[override]
        """Warnings about implausible values of the description."""
        return [RobotWarning("", text) for text in self.to_dict()["warnings"]]


def recording_info(log: RecordingLike, *, progress: Progress | None = None) -> RecordingInfo:
    """Reads a recording to its end: joints, channels, rate, gaps, damage.

    Parameters
    ----------
    log
        A file, the folder of a bag, a ``Recording``, or the content of a file.
    progress
        Called with the completed share and the step.

    Returns
    -------
    RecordingInfo
        Contents of the recording, and losses while reading.

    Raises
    ------
    SinewError
        For an invalid or missing recording.
    """
    recording = log if isinstance(log, Recording) else Recording(log)
    return RecordingInfo(recording._info(progress=progress))


def check_robot(
    robot: RobotLike, *, mapping: PathLike | None = None, ropes: Sequence[PathLike] = ()
) -> RobotCheck:
    """Checks a robot description for implausible values.

    Parameters
    ----------
    robot
        Folder of the robot or a ``Robot``.
    mapping
        Mapping of a recording to check against the robot.
    ropes
        Folders with additional ropes.

    Returns
    -------
    RobotCheck
        The interpreted description, with its warnings.

    Raises
    ------
    SinewError
        For an invalid description.
    """
    loaded = robot if isinstance(robot, Robot) else Robot(robot)
    return RobotCheck(loaded._check(mapping=mapping, ropes=list(ropes)))
