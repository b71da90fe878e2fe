"""Estimates of recordings, and baselines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Sequence

from . import results
from ._answer import Answer
from ._core import Baseline, Document, Recording, Robot
from ._core import estimate as _estimate
from ._core import estimate_each as _estimate_each
from ._core import estimate_from_json as _estimate_from_json
from ._core import learn_baseline as _learn_baseline
from ._core import merge_baselines as _merge_baselines
from ._errors import SinewError, UnknownNameError
from ._frames import day, is_content
from ._types import Injection, Progress, Stated, injections

if TYPE_CHECKING:
    import os

    from ._types import ArrayLike, BaselineLike, DateLike, RecordingLike, RobotLike


class Estimate(Answer, results.EstimateResult):
    """The estimate of one recording: ``session`` contains the absolute estimate with verdicts, ``reading`` the
    uncorrected estimate.

    Tables: ``joints`` (a row per joint), ``series`` (over time, of both methods).
    """

    __slots__ = ("baseline",)

    baseline: Baseline | None
    """Posterior after this recording: the ``baseline`` of the next one. ``None`` of the paper's method."""

    def __init__(self, document: Document, baseline: Baseline | None) -> None:
        super().__init__(document)
        object.__setattr__(self, "baseline", baseline)

    @classmethod
    def from_json(cls, text: str) -> Estimate:
        """The estimate of a JSON document, with its text, table and report.

        ``baseline`` is ``None`` and the table ``series`` empty: they are not in the document; ``pickle`` keeps both.

        Parameters
        ----------
        text
            Document of ``to_json()`` or of the command.

        Returns
        -------
        Estimate
            An equal result.

        Raises
        ------
        SinewError
            If the text is no such document.
        """
        return cls._restore(_estimate_from_json(text), {"baseline": None})

    def joint(self, name: str) -> results.TendonEstimate:
        """The result of a joint: offset, elongation, verdict.

        Parameters
        ----------
        name
            Name of the joint or tendon.

        Returns
        -------
        results.TendonEstimate
            The absolute estimate.

        Raises
        ------
        UnknownNameError
            Where there is no such joint.
        SinewError
            Of the paper's method, which gives no verdict.
        """
        if self.session is None:
            raise SinewError("the paper's method gives a reading and no verdict; look at .reading.joints")
        for joint in self.session.joints:
            if joint.name == name:
                return joint
        known = ", ".join(joint.name for joint in self.session.joints)
        raise UnknownNameError(f"no elastic joint '{name}'; there are {known}")


class EstimateEach(Answer, results.EstimateEachResult):
    """Many recordings, each on its own. Table: ``joints``, a row per recording and joint."""

    __slots__ = ()


class Learned(Answer, results.BaselineResult):  # type: ignore[misc]
    """Baseline from a recording directly after tensioning."""

    __slots__ = ("learned_baseline",)

    learned_baseline: Baseline
    """The baseline: give it to ``estimate``, or write it."""

    def __init__(self, document: Document, baseline: Baseline) -> None:
        super().__init__(document)
        object.__setattr__(self, "learned_baseline", baseline)

    def write(self, path: Any) -> None:
        """Writes the baseline: the ``--baseline`` of the command.

        Parameters
        ----------
        path
            File to write.

        Raises
        ------
        SinewError
            If it cannot be written.
        """
        self.learned_baseline.write(path)


class Merged(Answer, results.BaselineMergeResult):
    """Change of the uncertainties by a merge of baselines."""

    __slots__ = ("merged_baseline",)

    merged_baseline: Baseline
    """The result, a start for ``learn_baseline(..., start=...)``."""

    def __init__(self, document: Document, baseline: Baseline) -> None:
        super().__init__(document)
        object.__setattr__(self, "merged_baseline", baseline)


def _opened(log: RecordingLike) -> str | os.PathLike[str] | Recording:
    """A recording, or its path."""
    return Recording(log) if is_content(log) else log  # type: ignore[arg-type,return-value]


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
    date: DateLike | None = None,
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

    Parameters
    ----------
    log
        A file (MCAP, CSV, Parquet), the folder of a bag, a ``Recording``, or the content of a file as
        bytes or an open file.
    robot
        Its folder or a ``Robot``; without it, ``robot.toml`` next to the recording or in the current
        folder.
    baseline
        Reference of the offsets instead of the encoder zero: a file, or the ``baseline`` of a result.
    reference
        An earlier recording with comparable motion for the paper's difference method.
    method
        ``"absolute"`` (offsets with intervals) or ``"paper"`` (uncorrected estimate). The default is
        ``"paper"`` if one of its options and no baseline is set, otherwise ``"absolute"``.
    empty, payload_kg
        Mass in the gripper, kg, with a standard deviation of 2 % or as ``(mean, std)``.
    temperature_c
        °C if not recorded, with a standard deviation of 2 K or as ``(mean, std)``.
    external_force_n
        Constant external force at the tool, as ``((x, y, z), std)`` in the base frame, N, for example of
        a cable, a hose or a balancer. By default a force is estimated if the recording contains evidence
        of it.
    motor_torque
        Whether a recorded motor torque is used.
    from_s, to_s
        The part of the recording that is used, s.
    date
        Date of the recording for ``trend``, such as ``"2026-11-29"``, ``"2026-11-29T08:30Z"`` or a
        ``datetime``; by default that of its clock.
    inject
        Offsets to add to motor positions: joint, rad and, optionally, from which time on, s.
    source, comparison
        Source of the elastic torque, and comparison, of the paper's method.
    gain_per_s
        Gain K_I of the paper's observer, 1/s; 20 by default.
    velocity_filter
        Cut-off of its velocity filter, rad/s, or ``"recorded"``; 40 by default.
    tau_ext
        Whether it uses the recorded external torque.
    online
        Whether the online estimate is replayed over the recording, too: ``session.online``.
    progress
        Called with the completed share and the current step.

    Returns
    -------
    Estimate
        Offset, elongation and verdict of each tendon.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command; ``LocatedError`` where it is about a place in a file.
    """
    args = {
        "robot": robot,
        "baseline": baseline,
        "reference": None if reference is None else _opened(reference),
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
        "date": None if date is None else day(date),
        "online": online,
    }
    return Estimate(*_estimate(_opened(log), args, progress))


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
    tau_ext: ArrayLike | None = None,
    temperature_c: ArrayLike | Stated | None = None,
    segment: ArrayLike | None = None,
    name: str = "arrays",
    **options: Any,
) -> Estimate:
    """``estimate`` of arrays: one row per sample, one column per joint. ``float64`` is not copied.

    ``estimate_arrays(robot, **recording.arrays())`` is the estimate of the recording.

    Parameters
    ----------
    robot
        Its folder or a ``Robot``.
    q, theta
        ``(rows, joints)``, joint and motor positions, rad; NaN where not recorded. The columns of a data
        frame of pandas or polars, and of a labelled array of xarray, are found by the names of the
        joints, in any order.
    time_ns, time_s
        One of them, ``(rows,)``: whole numbers in ns, ``datetime64`` or times with or without a zone, UTC
        without one; or seconds. Without both, the index of a data frame.
    joints
        Names of the columns; without them, the robot's joints in its order.
    dq
        ``(rows, joints)``, rad/s.
    tau_el, tau_m, tau_ext
        ``(rows, joints)``, N·m.
    temperature_c
        ``(rows,)``, °C; or one number or ``(mean, std)``, as ``estimate`` takes it.
    segment
        As ``arrays()`` returns it; it follows from the gaps of the times.
    name
        Name of the recording in the result.
    options
        As ``estimate`` takes them.

    Returns
    -------
    Estimate
        Offset, elongation and verdict of each tendon.

    Raises
    ------
    SinewError
        If shapes are inconsistent or a joint has no column, and as ``estimate`` does.
    """
    is_stated = isinstance(temperature_c, (int, float)) or (isinstance(temperature_c, tuple) and len(temperature_c) == 2)
    if is_stated:
        options["temperature_c"] = temperature_c
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
        tau_ext=tau_ext,
        temperature_c=None if is_stated else temperature_c,
        segment=segment,
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

    Parameters
    ----------
    logs
        Recordings; a pattern or a folder selects all recordings in it.
    robot, baseline, method, empty, payload_kg, temperature_c, external_force_n, motor_torque, from_s, to_s, inject, progress
        As ``estimate`` takes them.

    Returns
    -------
    EstimateEach
        A result or an error for each recording.

    Raises
    ------
    SinewError
        If a pattern matches nothing or an option is invalid.
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
    return EstimateEach(_estimate_each([_opened(log) for log in logs], args, progress))


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

    Parameters
    ----------
    log, robot, motor_torque, from_s, to_s, progress
        As in ``estimate``.
    start
        Prior: posterior of this robot before re-tensioning, or of its type.
    temperature_c
        °C if not recorded, with a standard deviation of 2 K or as ``(mean, std)``.

    Returns
    -------
    Learned
        The baseline, and the change of each parameter against robot.toml.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    return Learned(*_learn_baseline(_opened(log), robot, start, temperature_c, motor_torque, from_s, to_s, progress))


def merge_baselines(
    baselines: Sequence[BaselineLike],
    robot: RobotLike,
    *,
    common: BaselineLike | None = None,
    fleet: bool = False,
    scatter: float = 0.01,
) -> Merged:
    """Merges several baselines into a prior for ``learn_baseline``.

    Parameters
    ----------
    baselines
        Files or ``Baseline`` objects.
    robot
        The folder of their robot or a ``Robot``.
    common
        The common prior of the baselines; without it, the prior is ``robot.toml``.
    fleet
        Whether the baselines are of several robots of one type.
    scatter
        Relative standard deviation of the masses of these robots.

    Returns
    -------
    Merged
        The merged baseline, and the change of the uncertainties.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    if not 0.0 < scatter <= 1.0:
        raise SinewError(f"scatter is {scatter}; it must be above 0 and at most 1")
    return Merged(*_merge_baselines(list(baselines), robot, common, fleet, scatter))
