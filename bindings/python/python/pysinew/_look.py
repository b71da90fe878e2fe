"""What a recording holds, and what a robot's description says."""

from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

from . import results
from ._answer import Answer
from ._core import Recording, Robot
from ._types import PathLike, Progress

if TYPE_CHECKING:
    from ._types import RecordingLike, RobotLike


class RecordingInfo(Answer, results.RecordingInfoResult):
    """What a recording holds, and how well it could be read."""

    __slots__ = ()


class RobotCheck(Answer, results.RobotCheckResult):
    """A robot as Sinew has understood its description, and what looks odd."""

    __slots__ = ()


def recording_info(log: RecordingLike, *, progress: Progress | None = None) -> RecordingInfo:
    """Reads a recording to its end: joints, channels, rate, gaps, damage.

    Raises ``ValueError`` with the sentence of the command.
    """
    recording = log if isinstance(log, Recording) else Recording(log)
    return RecordingInfo(recording._info(progress=progress))


def check_robot(
    robot: RobotLike, *, mapping: PathLike | None = None, ropes: Sequence[PathLike] = ()
) -> RobotCheck:
    """Says what looks odd in a robot's description; ``ropes`` are folders with ropes of one's own.

    Raises ``ValueError`` with the sentence of the command.
    """
    loaded = robot if isinstance(robot, Robot) else Robot(robot)
    return RobotCheck(loaded._check(mapping=mapping, ropes=list(ropes)))
