"""Ropes: the catalogue, prediction, selection, pretension."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Sequence, Union

from . import results
from ._answer import Answer
from ._core import Catalogue
from ._core import plan_pretension as _plan_pretension
from ._core import predict_rope as _predict_rope
from ._core import select_rope as _select_rope
from ._errors import SinewError
from ._types import PathLike, Progress, seed_of

if TYPE_CHECKING:
    from ._types import RandomLike, RecordingLike, RobotLike

Block = Union["tuple[float, float]", "tuple[float, float, float]"]
"""Duration in s, tension in N and, optionally, temperature in °C."""
YEAR_S = 31_557_600.0


class Guide(NamedTuple):
    """A guiding pulley."""

    wrap_rad: float
    """Angle that the rope lies on it, rad."""
    radius_m: float
    """Radius, m."""
    friction: float | None = None
    """Coefficient of friction; ``None``: the rope's."""
    at_m: float | None = None
    """Where the rope meets it, m from the drive; ``None``: evenly among all."""


class RopeList(Answer, results.RopeListResult):
    """All ropes of a catalogue."""

    __slots__ = ()


class Rope(Answer, results.RopeResult):
    """Everything known about a rope, with origin and uncertainty."""

    __slots__ = ()


class Prediction(Answer, results.PredictionResult):
    """Predicted elongation of a rope. Table: ``series``, the curve over time."""

    __slots__ = ()


class Selection(Answer, results.SelectionResult):
    """Ropes that meet the constraints, ranked by elongation, with the reasons for the rejection of others."""

    __slots__ = ()


class Pretension(Answer, results.PretensionResult):
    """How much pretension, how to bed the rope in, and when to tension it again."""

    __slots__ = ()


def list_ropes(*, ropes: Sequence[PathLike] = ()) -> RopeList:
    """All ropes of the catalogue.

    Parameters
    ----------
    ropes
        Folders with additional ropes.

    Returns
    -------
    RopeList
        The ropes, with their published properties.

    Raises
    ------
    LocatedError
        For an invalid entry.
    """
    return RopeList(Catalogue(list(ropes))._list())


def describe_rope(name: str, *, ropes: Sequence[PathLike] = ()) -> Rope:
    """Properties of a rope, with origin and uncertainty.

    Parameters
    ----------
    name
        Name of the rope.
    ropes
        Folders with additional ropes.

    Returns
    -------
    Rope
        Its published properties and the parameters of its law.

    Raises
    ------
    UnknownNameError
        Where there is no such rope.
    """
    return Rope(Catalogue(list(ropes))._describe(name))


def _blocks(duty: PathLike | Sequence[Block] | None, temperature_c: float) -> Any:
    if duty is None or isinstance(duty, str) or hasattr(duty, "__fspath__"):
        return duty
    return [(*block, temperature_c) if len(block) == 2 else tuple(block) for block in duty]


def _guides(guides: Sequence[Guide | Sequence[float]]) -> list[Guide]:
    return [Guide(*guide) for guide in guides]


def _scaled(value: float | None, factor: float) -> float | None:
    """In the unit of the command; 15 digits, so that 1.8e-3 m are 1.8 mm."""
    return None if value is None else float(f"{factor * value:.15g}")


def _task(
    tension_n: float | None,
    temperature_c: float,
    duty: PathLike | Sequence[Block] | None,
    recording: RecordingLike | None,
    strand: str,
    robot: RobotLike | None,
    joint: str | None,
    length_m: float | None,
    guides: Sequence[Guide | Sequence[float]],
    stroke_m: float,
    strokes_per_hour: float,
    termination: str | None,
    abrasion_factor: float,
    times_s: Sequence[float],
    draws: int,
    seed: int,
    ropes: Sequence[PathLike],
) -> dict[str, Any]:
    return {
        "tension_n": tension_n,
        "temperature_c": temperature_c,
        "duty": _blocks(duty, temperature_c),
        "recording": recording,
        "strand": strand,
        "robot": robot,
        "joint": joint,
        "length_m": length_m,
        "guides": _guides(guides),
        "stroke_m": stroke_m,
        "strokes_per_hour": strokes_per_hour,
        "termination": termination,
        "abrasion_factor": abrasion_factor,
        "times_s": list(times_s),
        "draws": draws,
        "seed": seed,
        "ropes": list(ropes),
    }


def predict_rope(
    rope: str | None = None,
    *,
    tension_n: float | None = None,
    temperature_c: float = 23.0,
    duty: PathLike | Sequence[Block] | None = None,
    recording: RecordingLike | None = None,
    strand: Literal["positive", "negative"] = "positive",
    robot: RobotLike | None = None,
    joint: str | None = None,
    length_m: float | None = None,
    guides: Sequence[Guide | Sequence[float]] = (),
    stroke_m: float = 0.0,
    strokes_per_hour: float = 0.0,
    termination: Literal["splice", "knot"] | None = None,
    abrasion_factor: float = 1.0,
    times_s: Sequence[float] = (),
    read_at_n: float | None = None,
    draws: int = 400,
    seed: int = 1,
    rng: RandomLike | None = None,
    ropes: Sequence[PathLike] = (),
    progress: Progress | None = None,
) -> Prediction:
    """Predicts the elongation of a rope under a duty: after an hour, a day, a month, a year.

    Parameters
    ----------
    rope
        Its name; without it, the one of the joint's tendon.
    tension_n, temperature_c
        Constant tension, N, at a temperature, °C. Without a load, the tendon's pretension.
    duty
        Load instead of ``tension_n``: a file, or blocks of duration (s), tension (N) and temperature
        (°C), repeated.
    recording, strand
        Load from the torques of a recording on one strand.
    robot, joint
        The tendon that the rope belongs to.
    length_m, guides
        Its route without them.
    stroke_m
        Motion back and forth over the guides, m.
    strokes_per_hour, termination, abrasion_factor
        Inputs of the lifetime.
    times_s
        When to read, s.
    read_at_n
        Tension the readings refer to, N.
    draws, seed
        Draws of the rope's parameters for the intervals, and their seed.
    rng
        Seed or generator of NumPy, instead of ``seed``.
    ropes
        Folders with additional ropes.
    progress
        Called with the completed share and the step.

    Returns
    -------
    Prediction
        Elongation at each of ``times_s`` with 95 % intervals.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    task = _task(
        tension_n,
        temperature_c,
        duty,
        recording,
        strand,
        robot,
        joint,
        length_m,
        guides,
        stroke_m,
        strokes_per_hour,
        termination,
        abrasion_factor,
        times_s,
        draws,
        seed_of(seed, rng),
        ropes,
    )
    return Prediction(_predict_rope(rope, read_at_n, task, progress))


def select_rope(
    *,
    tension_n: float | None = None,
    temperature_c: float = 23.0,
    duty: PathLike | Sequence[Block] | None = None,
    recording: RecordingLike | None = None,
    strand: Literal["positive", "negative"] = "positive",
    robot: RobotLike | None = None,
    joint: str | None = None,
    length_m: float | None = None,
    guides: Sequence[Guide | Sequence[float]] = (),
    stroke_m: float = 0.0,
    strokes_per_hour: float = 0.0,
    termination: Literal["splice", "knot"] | None = None,
    abrasion_factor: float = 1.0,
    times_s: Sequence[float] = (),
    diameter_max_m: float | None = None,
    diameter_min_m: float | None = None,
    pulley_diameter_m: float | None = None,
    bend_ratio_min: float | None = None,
    safety_factor_min: float | None = None,
    elongation_max_m: float | None = None,
    stiffness_min_n_per_m: float | None = None,
    weight_max_kg_per_m: float | None = None,
    draws: int = 400,
    seed: int = 1,
    rng: RandomLike | None = None,
    ropes: Sequence[PathLike] = (),
    progress: Progress | None = None,
) -> Selection:
    """Selects the ropes that meet the constraints, ranked by elongation at the last of ``times_s``, with the reasons for each rejection.

    A constraint on a property that the manufacturer does not publish rejects the rope, because compliance cannot be verified.

    Parameters
    ----------
    tension_n, temperature_c, duty, recording, strand, robot, joint, length_m, guides, stroke_m, strokes_per_hour, termination
        Duty and route, as for ``predict_rope``.
    abrasion_factor, times_s, draws, seed, rng, ropes, progress
        As for ``predict_rope``.
    diameter_max_m, diameter_min_m
        Bounds of the rope's diameter, m.
    pulley_diameter_m, bend_ratio_min
        Diameter of the smallest pulley, m, and its minimum ratio to the diameter of the rope.
    safety_factor_min
        Minimum ratio of breaking load and greatest tension.
    elongation_max_m
        Maximum elongation at the last of ``times_s``, m.
    stiffness_min_n_per_m
        Minimum stiffness of the rope, N/m.
    weight_max_kg_per_m
        Maximum mass per length, kg/m.

    Returns
    -------
    Selection
        Ranked ropes, and the reasons for the rejection of others.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    task = _task(
        tension_n,
        temperature_c,
        duty,
        recording,
        strand,
        robot,
        joint,
        length_m,
        guides,
        stroke_m,
        strokes_per_hour,
        termination,
        abrasion_factor,
        times_s,
        draws,
        seed_of(seed, rng),
        ropes,
    )
    limits = {
        "diameter_max_mm": _scaled(diameter_max_m, 1e3),
        "diameter_min_mm": _scaled(diameter_min_m, 1e3),
        "bend_ratio_min": bend_ratio_min,
        "pulley_diameter_mm": _scaled(pulley_diameter_m, 1e3),
        "safety_factor_min": safety_factor_min,
        "elongation_max_mm": _scaled(elongation_max_m, 1e3),
        "stiffness_min_n_per_mm": _scaled(stiffness_min_n_per_m, 1e-3),
        "weight_max_g_per_m": _scaled(weight_max_kg_per_m, 1e3),
    }
    return Selection(_select_rope(limits, task, progress))


def plan_pretension(
    rope: str | None = None,
    *,
    tension_n: float | None = None,
    lowest_n: float | None = None,
    temperature_c: float = 23.0,
    robot: RobotLike | None = None,
    joint: str | None = None,
    length_m: float | None = None,
    guides: Sequence[Guide | Sequence[float]] = (),
    series_compliance_m_per_n: float | None = None,
    joint_radius_m: float | None = None,
    torque_nm: float = 0.0,
    horizon_s: float = YEAR_S,
    remove: float = 0.8,
    draws: int = 200,
    seed: int = 1,
    rng: RandomLike | None = None,
    ropes: Sequence[PathLike] = (),
    progress: Progress | None = None,
) -> Pretension:
    """How much pretension, how to bed a rope in, and when to tension it again.

    Parameters
    ----------
    rope, temperature_c, robot, joint, length_m, guides, draws, seed, rng, ropes, progress
        As for ``predict_rope``.
    tension_n
        Working tension, N (of two strands their mean); without it, the tendon's pretension.
    lowest_n
        Tension at which it is re-tensioned, N; without it, 80 % of the working tension.
    series_compliance_m_per_n
        Compliance in series with each strand, m/N; the default follows from the joint stiffness without
        the rope, otherwise 0.
    joint_radius_m
        Pulley radius of an equal antagonistic rope, m.
    torque_nm
        Torque that the joint holds, N·m.
    horizon_s
        Required lifetime, s.
    remove
        Share of the later elongation to remove, 0 to 1.

    Returns
    -------
    Pretension
        Pretension, procedures, and the times of re-tensioning.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """
    if not 0.0 < remove < 1.0:
        raise SinewError(f"remove is {remove}; it must lie between 0 and 1")
    args = {
        "tension_n": tension_n,
        "lowest_n": lowest_n,
        "temperature_c": temperature_c,
        "robot": robot,
        "joint": joint,
        "length_m": length_m,
        "guides": _guides(guides),
        "series_compliance_m_per_n": series_compliance_m_per_n,
        "joint_radius_m": joint_radius_m,
        "torque_nm": torque_nm,
        "horizon_s": horizon_s,
        "remove": remove,
        "draws": draws,
        "seed": seed_of(seed, rng),
        "ropes": list(ropes),
    }
    return Pretension(_plan_pretension(rope, args, progress))
