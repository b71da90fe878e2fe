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
from ._types import PathLike, Progress, seed_of

if TYPE_CHECKING:
    from ._types import AnyArray, BaselineLike, RandomLike, RobotLike

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

    def __reduce__(self) -> tuple[Any, ...]:
        # The recording is made from its arrays, or opened again.
        return _restored, (self._document, self.arrays, self.recording.name)


def _restored(document: Document, arrays: dict[str, Any], name: str) -> Simulated:
    recording = Recording.from_arrays(name=name, **arrays) if arrays else Recording(name)
    return Simulated._restore(document, {"arrays": arrays, "recording": recording})


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
    rng: RandomLike | None = None,
    duration_s: float | None = None,
    compression: Literal["zstd", "lz4", "none"] = "zstd",
    progress: Progress | None = None,
) -> Simulated:
    """Makes a recording of a joint-elastic arm whose tendons stretch, with its truth.

    Same robot, scenario and seed: the same numbers.

    Parameters
    ----------
    scenario
        A file, or ``(text, name)``.
    robot
        Folder of the robot or a ``Robot``; without it, the robot of the scenario.
    out
        Write it (``.mcap``, ``.parquet``, ``.csv``), with the ground truth next to it; without it, in
        memory.
    seed, duration_s
        Seed and duration, s, instead of those of the scenario.
    rng
        Seed or generator of NumPy, instead of ``seed``.
    compression
        Compression of an MCAP file.
    progress
        Called with the completed share and the step.

    Returns
    -------
    Simulated
        The recording and its truth.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    if rng is not None:
        seed = seed_of(0, rng)
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
    rng: RandomLike | None = None,
    progress: Progress | None = None,
) -> Poses:
    """Proposes a short list of poses that makes the offsets identifiable. Collisions are not checked.

    Parameters
    ----------
    robot
        Folder of the robot or a ``Robot``.
    baseline
        Prior; without it, that of 25 random poses.
    poses
        Number of poses in the list.
    pause_s
        Rest at each, s.
    payload
        Whether the payload is unknown.
    joint_bits
        Resolution of the joint encoders, bits per turn.
    candidates
        Poses tried in the place of each.
    seed
        Seed of the random poses.
    rng
        Seed or generator of NumPy, instead of ``seed``.
    progress
        Called with the completed share and the step.

    Returns
    -------
    Poses
        The poses, the expected standard deviations, and the motion for ``simulate``.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    return Poses(
        *_propose_poses(robot, baseline, poses, pause_s, payload, joint_bits, candidates, seed_of(seed, rng), progress)
    )
