"""Simulated recordings with a known truth, scenarios of the protocol and informative poses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Sequence, Union

from . import results
from ._answer import Answer
from ._core import Document, Recording, Robot
from ._core import propose_poses as _propose_poses
from ._core import scenario_text as scenario_text
from ._core import simulate as _simulate
from ._core import simulate_to as _simulate_to
from ._types import PathLike, Progress

if TYPE_CHECKING:
    from ._types import AnyArray, BaselineLike, RobotLike

ScenarioLike = Union[PathLike, "tuple[str, str]"]
"""The file of a scenario, or its text and a name for messages."""


class Simulated(Answer, results.SimulatedResult):
    """A simulated recording and its truth."""

    __slots__ = ("arrays", "recording")

    arrays: dict[str, AnyArray]
    """The recording: ``time_ns`` ``(rows,)``, ``q``, ``theta`` and what else there is ``(rows, joints)``; ``joints``."""
    recording: Recording
    """The same, ready for ``estimate``."""

    def __init__(self, document: Document, arrays: dict[str, Any], recording: Recording) -> None:
        super().__init__(document)
        object.__setattr__(self, "arrays", arrays)
        object.__setattr__(self, "recording", recording)


class Poses(Answer, results.PosesResult):
    """Proposed poses, and the expected intervals."""

    __slots__ = ("motion_toml",)

    motion_toml: str
    """The poses as a motion for ``simulate``."""

    def __init__(self, document: Document, motion_toml: str) -> None:
        super().__init__(document)
        object.__setattr__(self, "motion_toml", motion_toml)


def simulate(
    scenario: ScenarioLike,
    robot: RobotLike | None = None,
    *,
    out: PathLike | None = None,
    seed: int | None = None,
    duration_s: float | None = None,
    compression: Literal["zstd", "lz4", "none"] = "zstd",
    progress: Progress | None = None,
) -> Simulated:
    """Makes a recording of a joint-elastic arm whose tendons stretch, with its truth.

    Same robot, scenario and seed: the same numbers.

    * ``scenario``: a file, or ``(text, name)``.
    * ``robot``: folder of the robot or a ``Robot``; without it, the robot of the scenario.
    * ``out``: write it (``.mcap``, ``.parquet``, ``.csv``), with the ground truth next to it; without it, in memory.
    * ``seed``, ``duration_s``: instead of the scenario's.

    Raises ``ValueError`` with the sentence of the command.
    """
    if out is not None:
        document = _simulate_to(scenario, out, robot, seed, duration_s, compression, progress)
        recording = Recording(out)
        return Simulated(document, {}, recording)
    arrays, document = _simulate(scenario, robot, seed, duration_s, progress)
    columns = {name: values for name, values in arrays.items() if name != "segment"}
    recording = Recording.from_arrays(name="simulated", **columns)
    return Simulated(document, columns, recording)


def propose_poses(
    robot: RobotLike,
    *,
    baseline: BaselineLike | None = None,
    poses: int = 6,
    pause_s: float = 1.0,
    payload: bool = True,
    joint_bits: int = 13,
    candidates: int = 6,
    seed: int = 1,
    progress: Progress | None = None,
) -> Poses:
    """Proposes a short list of poses that makes the offsets identifiable. Collisions are not checked.

    * ``baseline`` as prior; without it, that of 25 random poses.
    * ``poses`` in the list, ``pause_s`` rest at each, s. ``payload``: whether the payload is unknown.
    * ``joint_bits``: of a turn of the joint encoders. ``candidates``: poses tried in the place of each.

    Raises ``ValueError`` with the sentence of the command.
    """
    return Poses(
        *_propose_poses(robot, baseline, poses, pause_s, payload, joint_bits, candidates, seed, progress)
    )
