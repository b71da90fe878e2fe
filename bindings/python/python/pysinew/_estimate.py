"""Estimates of recordings, and baselines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Sequence

from . import results
from ._answer import Answer
from ._core import Baseline, Document, Recording, Robot
from ._core import estimate as _estimate
from ._core import estimate_each as _estimate_each
from ._core import learn_baseline as _learn_baseline
from ._core import merge_baselines as _merge_baselines
from ._types import Injection, Progress, Stated, injections

if TYPE_CHECKING:
    from ._types import ArrayLike, BaselineLike, RecordingLike, RobotLike


class Estimate(Answer, results.EstimateResult):
    """The estimate of one recording: ``session`` contains the absolute estimate with verdicts, ``reading`` the
    uncorrected estimate.

    Tables: ``joints`` (a row per joint), ``series`` (over time, of both methods).
    """

    __slots__ = ("baseline",)

    baseline: Baseline | None
    """What is known after this recording: the ``baseline`` of the next one. ``None`` of the paper's method."""

    def __init__(self, document: Document, baseline: Baseline | None) -> None:
        super().__init__(document)
        object.__setattr__(self, "baseline", baseline)

    def joint(self, name: str) -> results.TendonEstimate:
        """The answer for a joint: offset, elongation, verdict.

        Raises ``KeyError`` where there is none, and ``ValueError`` of the paper's method, which gives no verdict.
        """
        if self.session is None:
            raise ValueError("the paper's method gives a reading and no verdict; look at .reading.joints")
        for joint in self.session.joints:
            if joint.name == name:
                return joint
        known = ", ".join(joint.name for joint in self.session.joints)
        raise KeyError(f"no elastic joint '{name}'; there are {known}")


class EstimateEach(Answer, results.EstimateEachResult):
    """Many recordings, each on its own. Table: ``joints``, a row per recording and joint."""

    __slots__ = ()


class Learned(Answer, results.BaselineResult):
    """Baseline from a recording directly after tensioning."""

    __slots__ = ("learned_baseline",)

    learned_baseline: Baseline
    """The baseline: give it to ``estimate``, or write it."""

    def __init__(self, document: Document, baseline: Baseline) -> None:
        super().__init__(document)
        object.__setattr__(self, "learned_baseline", baseline)

    def write(self, path: Any) -> None:
        """Writes the baseline: the ``--baseline`` of the command."""
        self.learned_baseline.write(path)


class Merged(Answer, results.BaselineMergeResult):
    """Change of the uncertainties by a merge of baselines."""

    __slots__ = ("merged_baseline",)

    merged_baseline: Baseline
    """The result, a start for ``learn_baseline(..., start=...)``."""

    def __init__(self, document: Document, baseline: Baseline) -> None:
        super().__init__(document)
        object.__setattr__(self, "merged_baseline", baseline)


def estimate(
    log: RecordingLike,
    robot: RobotLike | None = None,
    *,
    baseline: BaselineLike | None = None,
    reference: RecordingLike | None = None,
    method: Literal["absolute", "paper"] | None = None,
    empty: bool = False,
    payload_kg: Stated | None = None,
    temperature_c: Stated | None = None,
    external_force_n: tuple[Sequence[float], float] | None = None,
    motor_torque: bool = True,
    from_s: float = 0.0,
    to_s: float | None = None,
    date: str | None = None,
    inject: Sequence[Injection] = (),
    source: Literal["observer", "torque-sensor", "motor"] | None = None,
    comparison: Literal["matched", "paper"] | None = None,
    gain_per_s: float | None = None,
    velocity_filter: float | Literal["recorded"] | None = None,
    tau_ext: bool = False,
    online: bool = False,
    progress: Progress | None = None,
) -> Estimate:
    """Estimates the offset of each tendon from a recording.

    ``delta_e = (theta_measured − q) − tau_el / K``: a longer tendon shifts the measured motor position.

    * ``log``: a file (MCAP, CSV, Parquet), the folder of a bag, or a ``Recording``.
    * ``robot``: its folder or a ``Robot``; without it, ``robot.toml`` next to the recording or in the current folder.
    * ``baseline``: reference of the offsets instead of the encoder zero: a file, or the ``baseline`` of a result.
    * ``reference``: an earlier recording with comparable motion for the paper's difference method.
    * ``method``: ``"absolute"`` (offsets with intervals) or ``"paper"`` (uncorrected estimate).
      The default is ``"paper"`` if one of its options and no baseline is set, otherwise ``"absolute"``.
    * ``empty``, ``payload_kg``: mass in the gripper, kg, with a standard deviation of 2 % or as ``(mean, std)``.
    * ``temperature_c``: °C if not recorded, with a standard deviation of 2 K or as ``(mean, std)``.
    * ``external_force_n``: constant external force at the tool, as ``((x, y, z), std)`` in the base frame,
      N, for example of a cable, a hose or a balancer. By default a force is estimated if the recording contains
      evidence of it.
    * ``motor_torque``: whether a recorded motor torque is used.
    * ``from_s``, ``to_s``: the part of the recording that is used, s.
    * ``date``: date of the recording for ``trend``, such as ``"2026-11-29"`` or ``"2026-11-29T08:30Z"``; by default
      that of its clock.
    * ``inject``: offsets to add to motor positions: joint, rad and, optionally, from which time on, s.
    * The paper's settings: ``source`` of the elastic torque, ``comparison``, ``gain_per_s`` (K_I, 1/s, 20),
      ``velocity_filter`` (rad/s, 40, or ``"recorded"``), ``tau_ext`` (use the recorded external torque).
    * ``online``: whether the online estimate is replayed over the recording, too: ``session.online``.
    * ``progress``: called with the completed share and the current step.

    Raises ``ValueError`` with the sentence of the command; ``LocatedError`` where it is about a place in a file.
    """
    args = {
        "robot": robot,
        "baseline": baseline,
        "reference": reference,
        "method": method,
        "inject": injections(inject),
        "source": source,
        "comparison": comparison,
        "gain_per_s": gain_per_s,
        "velocity_filter": velocity_filter,
        "tau_ext": tau_ext,
        "empty": empty,
        "payload_kg": payload_kg,
        "temperature_c": temperature_c,
        "external_force_n": external_force_n,
        "motor_torque": motor_torque,
        "from_s": from_s,
        "to_s": to_s,
        "date": date,
        "online": online,
    }
    return Estimate(*_estimate(log, args, progress))


def estimate_arrays(
    robot: RobotLike,
    *,
    q: ArrayLike,
    theta: ArrayLike,
    time_ns: ArrayLike | None = None,
    time_s: ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    dq: ArrayLike | None = None,
    tau_el: ArrayLike | None = None,
    tau_m: ArrayLike | None = None,
    celsius: ArrayLike | None = None,
    name: str = "arrays",
    **options: Any,
) -> Estimate:
    """``estimate`` of NumPy arrays: one row per sample, one column per joint. ``float64`` is not copied.

    * ``robot``: its folder or a ``Robot``.
    * ``q``, ``theta``: ``(rows, joints)``, joint and motor positions, rad; NaN where not recorded.
    * ``time_ns`` (whole numbers or ``datetime64``) or ``time_s``: ``(rows,)``.
    * ``joints``: names of the columns; without them, the robot's joints in its order.
    * ``dq``: ``(rows, joints)``, rad/s. ``tau_el``, ``tau_m``: ``(rows, joints)``, N·m. ``celsius``: ``(rows,)``, °C.
    * ``name``: name of the recording in the result.
    * ``options``: as ``estimate`` takes them.

    Raises ``ValueError`` if shapes are inconsistent, and as ``estimate`` does.
    """
    loaded = robot if isinstance(robot, Robot) else Robot(robot)
    recording = Recording.from_arrays(
        joints=list(loaded.joints if joints is None else joints),
        q=q,
        theta=theta,
        time_ns=time_ns,
        time_s=time_s,
        dq=dq,
        tau_el=tau_el,
        tau_m=tau_m,
        temperature_c=celsius,
        name=name,
    )
    return estimate(recording, loaded, **options)


def estimate_each(
    logs: Sequence[RecordingLike],
    robot: RobotLike | None = None,
    *,
    baseline: BaselineLike | None = None,
    method: Literal["absolute", "paper"] | None = None,
    empty: bool = False,
    payload_kg: Stated | None = None,
    temperature_c: Stated | None = None,
    external_force_n: tuple[Sequence[float], float] | None = None,
    motor_torque: bool = True,
    from_s: float = 0.0,
    to_s: float | None = None,
    inject: Sequence[Injection] = (),
    progress: Progress | None = None,
) -> EstimateEach:
    """Estimates many recordings independently on all processors; a failed recording does not stop the others.

    A pattern or a folder selects all recordings in it. The options are those of ``estimate``.

    Raises ``ValueError`` if a pattern matches nothing or an option is invalid; errors of single recordings are in the
    answer.
    """
    args = {
        "robot": robot,
        "baseline": baseline,
        "reference": None,
        "method": method,
        "inject": injections(inject),
        "source": None,
        "comparison": None,
        "gain_per_s": None,
        "velocity_filter": None,
        "tau_ext": False,
        "empty": empty,
        "payload_kg": payload_kg,
        "temperature_c": temperature_c,
        "external_force_n": external_force_n,
        "motor_torque": motor_torque,
        "from_s": from_s,
        "to_s": to_s,
        "date": None,
        "online": False,
    }
    return EstimateEach(_estimate_each(list(logs), args, progress))


def learn_baseline(
    log: RecordingLike,
    robot: RobotLike | None = None,
    *,
    start: BaselineLike | None = None,
    temperature_c: Stated | None = None,
    motor_torque: bool = True,
    from_s: float = 0.0,
    to_s: float | None = None,
    progress: Progress | None = None,
) -> Learned:
    """Estimates a baseline from a recording taken directly after tensioning, with an empty gripper.

    Offsets are zero by definition then, so that stiffness, masses, friction and encoder errors are identifiable.

    * ``start``: prior: posterior of this robot before re-tensioning, or of its type.
    * ``temperature_c``: °C if not recorded, with a standard deviation of 2 K or as ``(mean, std)``.

    Raises ``ValueError`` with the sentence of the command.
    """
    return Learned(*_learn_baseline(log, robot, start, temperature_c, motor_torque, from_s, to_s, progress))


def merge_baselines(
    baselines: Sequence[BaselineLike],
    robot: RobotLike,
    *,
    common: BaselineLike | None = None,
    fleet: bool = False,
    scatter: float = 0.01,
) -> Merged:
    """Merges several baselines into a prior for ``learn_baseline``.

    * ``common``: the common prior of the baselines; without it, the prior is ``robot.toml``.
    * ``fleet``: the baselines are of several robots of one type, whose masses differ by ``scatter`` (relative standard
      deviation).

    Raises ``ValueError`` with the sentence of the command.
    """
    if not 0.0 < scatter <= 1.0:
        raise ValueError(f"scatter is {scatter}; it must be above 0 and at most 1")
    return Merged(*_merge_baselines(list(baselines), robot, common, fleet, scatter))
