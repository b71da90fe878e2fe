import os
from typing import IO, Any, Callable, ClassVar, Iterable, Literal, Mapping, Sequence, Union, final

import numpy as np
import numpy.typing as npt

from ._live import Provisional
from .results import SessionEstimate

_Path = Union[str, os.PathLike[str]]
_Progress = Callable[[float, str], object]
_Stated = Union[float, tuple[float, float]]
_Floats = npt.NDArray[np.float64]

VERSION: str
Z95: float
__all__ = [
    "Baseline",
    "Catalogue",
    "CreepTests",
    "Document",
    "OnlineEstimator",
    "OffsetObserver",
    "Recording",
    "Robot",
    "RopeLaw",
    "Table",
    "VERSION",
    "Z95",
    "dataset",
    "dataset_names",
    "estimate",
    "estimate_each",
    "estimate_from_json",
    "learn_baseline",
    "merge_baselines",
    "plan_pretension",
    "predict_rope",
    "propose_poses",
    "run_command",
    "scenario_text",
    "select_rope",
    "simulate",
    "simulate_to",
    "tendon_trend",
    "trend",
]

@final
class Document:
    def json(self) -> str: ...
    def words(self) -> str: ...
    def html(self) -> str | None: ...
    def glance(self) -> str | None: ...
    def write_html(self, path: _Path) -> bool: ...
    def table_names(self) -> list[str]: ...
    def table(self, name: str | None = None) -> Table: ...
    def warnings(self) -> list[tuple[str, str, str]]: ...
    def is_lossy(self) -> bool: ...
    @staticmethod
    def _restore(state: tuple[Any, ...]) -> Document: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Table:
    @property
    def units(self) -> dict[str, str]:
        """Unit of every column that has one, by name; the ``unit`` of its field in Arrow."""

    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def _restore(columns: Sequence[tuple[Any, ...]]) -> Table: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> Any: ...
    def __arrow_c_schema__(self) -> Any: ...
    @property
    def column_names(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: str, /) -> Any: ...
    def write(self, path: _Path) -> None: ...
    def _repr_html_(self) -> str: ...

@final
class Robot:
    def __new__(cls, place: _Path) -> Robot: ...
    @staticmethod
    def from_text(robot_toml: str, urdf: str, *, file: str = "robot.toml") -> Robot: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    @staticmethod
    def _restore(robot_toml: str, urdf: str, file: str) -> Robot: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def tendons(self) -> list[str]: ...
    @property
    def motors(self) -> list[str]: ...
    @property
    def file(self) -> os.PathLike[str]: ...
    @property
    def robot_toml(self) -> str: ...
    @property
    def urdf(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def stiffness_nm_per_rad(self) -> _Floats: ...
    def rope(self, joint: str) -> str | None: ...
    def elongation_m(self, joint: str, offset_rad: float) -> float: ...
    def strain(self, joint: str, offset_rad: float) -> float: ...
    def momentum(self, q: npt.ArrayLike, dq: npt.ArrayLike) -> tuple[_Floats, _Floats, _Floats]: ...
    def _check(self, *, mapping: _Path | None = None, ropes: Sequence[_Path] = ...) -> Document: ...

@final
class Recording:
    def __new__(
        cls,
        path: _Path | bytes | IO[bytes] | IO[str],
        *,
        mapping: _Path | None = None,
        joint_topic: str | None = None,
        motor_topic: str | None = None,
        motor_interface: str | None = None,
        joint_effort: Literal["tau-el", "tau-m", "ignore"] | None = None,
        gap_s: float | None = None,
    ) -> Recording: ...
    @staticmethod
    def from_arrays(
        *,
        q: npt.ArrayLike,
        theta: npt.ArrayLike,
        joints: Sequence[str] | None = None,
        time_ns: npt.ArrayLike | None = None,
        time_s: npt.ArrayLike | None = None,
        dq: npt.ArrayLike | None = None,
        tau_el: npt.ArrayLike | None = None,
        tau_m: npt.ArrayLike | None = None,
        tau_ext: npt.ArrayLike | None = None,
        temperature_c: npt.ArrayLike | None = None,
        segment: npt.ArrayLike | None = None,
        name: str = "arrays",
        gap_s: float | None = None,
    ) -> Recording: ...
    @staticmethod
    def from_messages(
        messages: Iterable[tuple[Any, ...]],
        *,
        name: str = "messages",
        mapping: _Path | None = None,
        joint_topic: str | None = None,
        motor_topic: str | None = None,
        motor_interface: str | None = None,
        joint_effort: Literal["tau-el", "tau-m", "ignore"] | None = None,
        gap_s: float | None = None,
    ) -> Recording: ...
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> Literal["mcap", "csv", "parquet", "db3", "numpy", "arrays", "messages"]: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def channels(self) -> dict[str, list[str]]: ...
    @property
    def robot_description(self) -> str | None: ...
    def _info(self, *, progress: _Progress | None = None) -> Document: ...
    def arrays(
        self, *, joints: Sequence[str] | None = None, progress: _Progress | None = None
    ) -> dict[str, Any]: ...
    def table(self, *, joints: Sequence[str] | None = None, progress: _Progress | None = None) -> Table: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> Any: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Baseline:
    @staticmethod
    def read(path: _Path) -> Baseline: ...
    @staticmethod
    def from_text(text: str, *, name: str = "baseline") -> Baseline: ...
    def to_text(self) -> str: ...
    def write(self, path: _Path) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    @staticmethod
    def _restore(text: str, name: str) -> Baseline: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def robot(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def recordings(self) -> list[str]: ...

@final
class OnlineEstimator:
    """Online estimator of the tendon offsets of a running robot: ``delta_e = (theta_measured − q) − tau_el / K``.

    ``step`` belongs in the control loop: it averages samples over blocks of 0.2 s and solves nothing. A worker solves the blocks of
    the last 120 s every 2 s with the estimator of ``estimate``, and compares every later block with the prediction of that solution.
    It is a separate thread with ``worker=True``; otherwise the caller calls ``work()`` outside the loop.

    Objects are thread-safe.

    Parameters
    ----------
    robot
        Folder of the robot or a ``Robot``.
    baseline
        Reference of the offsets, a file or a ``Baseline``. ``None``: the encoder zero.
    empty, payload_kg
        Mass in the gripper, kg, with a standard deviation of 2 % or as ``(mean, std)``.
    temperature_c
        Temperature of samples without one, °C, with a standard deviation of 2 K or as ``(mean, std)``.
    external_force_n
        Constant external force at the tool, as ``((x, y, z), std)`` in the base frame, N.
    motor_torque
        Whether the motor torque of the samples is used.
    creep
        Whether ropes may creep within the session; ``False`` for steel.
    worker
        Whether an internal thread solves. Threads do not survive a fork: create the object in the child process.

    Raises
    ------
    SinewError
        If the baseline belongs to another robot or a value is out of range.
    """

    def __new__(
        cls,
        robot: _Path | Robot,
        baseline: _Path | Baseline | None = None,
        *,
        empty: bool = False,
        payload_kg: _Stated | None = None,
        temperature_c: _Stated | None = None,
        external_force_n: tuple[Sequence[float], float] | None = None,
        motor_torque: bool = True,
        creep: bool = True,
        worker: bool = False,
    ) -> OnlineEstimator: ...
    @property
    def joints(self) -> list[str]:
        """Names of the joints in the order of ``q``, then of tendons beyond these, whose ``q`` is 0."""

    def step(
        self,
        dt_s: float,
        q: npt.ArrayLike,
        theta: npt.ArrayLike,
        tau_m: npt.ArrayLike | None = None,
        temperature_c: float = ...,
    ) -> str:
        """Adds a sample; only the clock advances where it is rejected.

        Parameters
        ----------
        dt_s
            Time since the previous sample, s; ignored for the first sample.
        q, theta, tau_m
            Joint positions, rad, motor positions, rad, and motor torques, N·m, ``(n,)``; missing values are NaN or omitted.
        temperature_c
            Temperature, °C; NaN where it is not measured.

        Returns
        -------
        str
            ``"accepted"``; ``"restarted"`` (the first sample, or the first after a gap); ``"block"`` (the sample completed a
            block for the worker); or ``"rejected: …"`` with the reason.

        Raises
        ------
        SinewError
            For a wrong number of values or a time step that is not positive; the state is then unchanged.
        """

    def work(self) -> None:
        """Processes all completed blocks, and solves the window when due: some hundredths of a second every 2 s.

        Not for a control loop: call it after a ``"block"``, or from another thread. Other Python threads continue meanwhile. Blocks wait
        for ten seconds; then they are dropped. No effect with ``worker=True``.
        """

    def interrupt(self) -> None:
        """Marks a gap before the next sample: the filters are re-initialised, the estimates are kept."""

    def offset(self, joint: str) -> tuple[float, float]:
        """Offset of a joint since the baseline: mean and standard deviation, rad; the 95 % interval is ± 1.96 standard deviations.

        Parameters
        ----------
        joint
            Name of the joint.

        Returns
        -------
        tuple of float
            Mean and standard deviation, rad; NaN before the first solution, and of a rigid joint.

        Raises
        ------
        UnknownNameError
            Where there is no such joint.
        """

    def offsets(self) -> tuple[_Floats, _Floats]:
        """Offsets of all joints at one time: means and standard deviations, ``(n,)`` each, rad; NaN as in ``offset``."""

    def provisional(self, joint: str) -> Provisional | None:
        """Reason for a provisional offset of a joint.

        Parameters
        ----------
        joint
            Name of the joint.

        Returns
        -------
        Provisional or None
            ``None``: the offset is settled, or the joint is rigid.

        Raises
        ------
        UnknownNameError
            Where there is no such joint.
        """

    @property
    def is_provisional(self) -> bool:
        """Whether the offset of any joint is provisional."""

    @property
    def time_s(self) -> float:
        """Middle of the last block of the estimate, s since the first sample; NaN before the first block."""

    @property
    def solved_s(self) -> float:
        """Middle of the last block of the solution, s since the first sample; NaN before the first solution."""

    @property
    def age_s(self) -> float:
        """Age of the solution, ``time_s − solved_s``, s; NaN before the first one. At most 2 while the arm moves; it grows in a
        long rest phase, whose blocks replace each other.
        """

    @property
    def blocks(self) -> int:
        """Number of blocks that the worker has processed."""

    @property
    def blocks_behind(self) -> int:
        """Number of completed blocks that are neither in the estimate nor dropped. If the number grows, the worker is too slow or
        is not called, and the estimate is outdated.
        """

    @property
    def blocks_dropped(self) -> int:
        """Number of blocks dropped because the worker was late by more than ten seconds."""

    @property
    def contact_probability(self) -> float:
        """Probability, 0 to 1, that something touches the arm in the last block; 0 before the first solution."""

    def stiffness_changed_probability(self, joint: str) -> float | None:
        """Probability, 0 to 1, that the stiffness of a joint has changed since the baseline.

        Parameters
        ----------
        joint
            Name of the joint.

        Returns
        -------
        float or None
            ``None`` if it is not estimated.

        Raises
        ------
        UnknownNameError
            Where there is no such joint.
        """

    @property
    def unknown_temperature_rad(self) -> _Floats:
        """Contribution of an unknown temperature, now or in the baseline, to the standard deviation of every joint's offset, ``(n,)``, rad;
        0 if both are known. The standard deviations include it. It covers the tolerance of robot.toml; a larger temperature
        difference biases the offset.
        """

    @property
    def external_force(self) -> tuple[float, _Floats, _Floats] | None:
        """Constant external force at the tool: its posterior probability, 0 to 1, then mean and standard deviation in the base frame,
        ``(3,)`` each, N, given that it acts. ``None``: no force detected.
        """

    @property
    def error(self) -> str | None:
        """Reason why the last window could not be solved, or ``None``. After an error the offsets are those of the previous solution, and
        provisional.
        """

    def result(self) -> SessionEstimate | None:
        """Last solution in the form of ``session`` of ``estimate``, for the blocks of the window: a ``SessionEstimate``.
        ``None`` before the first solution.
        """

    def save(self, recording: str, end_time_ns: int) -> Baseline:
        """Last solution as the baseline of the next session.

        Parameters
        ----------
        recording
            Name of this session.
        end_time_ns
            End of this session by its clock, ns.

        Returns
        -------
        Baseline
            The posterior of this session.

        Raises
        ------
        SinewError
            While an offset is provisional.
        """

@final
class OffsetObserver:
    def __new__(
        cls,
        robot: _Path | Robot,
        *,
        gain_per_s: float | None = None,
        cutoff_rad_per_s: float | None = None,
        comparison: Literal["matched", "paper"] = "matched",
    ) -> OffsetObserver: ...
    def step(
        self, dt_s: float, q: npt.ArrayLike, theta: npt.ArrayLike, tau_ext: npt.ArrayLike | None = None
    ) -> None: ...
    def reset(self) -> None: ...
    @property
    def delta_e(self) -> _Floats: ...
    @property
    def tau_el(self) -> _Floats: ...
    @property
    def dq(self) -> _Floats: ...
    @property
    def is_settled(self) -> bool: ...
    @property
    def settling_time_s(self) -> float: ...

@final
class Catalogue:
    def __new__(cls, ropes: Sequence[_Path] = ...) -> Catalogue: ...
    @property
    def names(self) -> list[str]: ...
    def _list(self) -> Document: ...
    def _describe(self, name: str) -> Document: ...
    def entry(self, name: str) -> str: ...

@final
class RopeLaw:
    def __new__(cls, rope: str, *, ropes: Sequence[_Path] = ...) -> RopeLaw: ...
    @property
    def name(self) -> str: ...
    @property
    def breaking_load_n(self) -> float: ...
    def hold(self, tension_n: float, duration_s: float, *, temperature_c: float = 23.0) -> None: ...
    def strain(self, tension_n: float, *, temperature_c: float = 23.0) -> dict[str, float]: ...
    def follow(
        self, duration_s: npt.ArrayLike, tension_n: npt.ArrayLike, *, temperature_c: float = 23.0
    ) -> _Floats: ...
    def reset(self) -> None: ...

@final
class CreepTests:
    def __new__(
        cls, files: Sequence[Any], args: Mapping[str, Any], progress: _Progress | None
    ) -> CreepTests: ...
    def analyze(self) -> Document: ...
    def fit(
        self, args: Mapping[str, Any], rope_name: str | None, progress: _Progress | None
    ) -> tuple[Document, str | None]: ...
    def hold_out(self, share: float, args: Mapping[str, Any], progress: _Progress | None) -> Document: ...
    def compare(self, scatter: float | None = None) -> Document: ...
    def shift(self, reference_c: float) -> Document: ...

def dataset(name: str) -> tuple[str, str, str]: ...
def dataset_names() -> list[str]: ...
def estimate_from_json(text: str) -> Document: ...
def estimate(
    log: _Path | Recording, args: Mapping[str, Any], progress: _Progress | None
) -> tuple[Document, Baseline | None]: ...
def estimate_each(
    logs: Sequence[_Path | Recording], args: Mapping[str, Any], progress: _Progress | None
) -> Document: ...
def learn_baseline(
    log: _Path | Recording,
    robot: _Path | Robot | None,
    start: _Path | Baseline | None,
    temperature_c: _Stated | None,
    motor_torque: bool,
    from_s: float,
    to_s: float | None,
    progress: _Progress | None,
) -> tuple[Document, Baseline]: ...
def merge_baselines(
    baselines: Sequence[_Path | Baseline],
    robot: _Path | Robot,
    common: _Path | Baseline | None,
    fleet: bool,
    scatter: float,
) -> tuple[Document, Baseline]: ...
def trend(
    records: Sequence[Any],
    robot: _Path | Robot | None,
    tensioned: Sequence[tuple[str | None, str]],
    replaced: Sequence[tuple[str | None, str]],
    duty: _Path | None,
    ropes: Sequence[_Path],
    horizon_s: float,
    seed: int,
    progress: _Progress | None,
) -> Document: ...
def tendon_trend(
    robot: _Path | Robot,
    joint: str,
    rope: str | None,
    sessions: Sequence[tuple[str | None, float, float | None, float, float, float | None, float | None, float | None]],
    events: Sequence[tuple[str, bool]],
) -> dict[str, Any]: ...
def predict_rope(
    rope: str | None, read_at_n: float | None, args: Mapping[str, Any], progress: _Progress | None
) -> Document: ...
def select_rope(limits: Mapping[str, Any], args: Mapping[str, Any], progress: _Progress | None) -> Document: ...
def plan_pretension(rope: str | None, args: Mapping[str, Any], progress: _Progress | None) -> Document: ...
def simulate(
    scenario: Any,
    robot: _Path | Robot | None,
    seed: int | None,
    duration_s: float | None,
    progress: _Progress | None,
) -> tuple[dict[str, Any], Document]: ...
def simulate_to(
    scenario: Any,
    out: _Path,
    robot: _Path | Robot | None,
    seed: int | None,
    duration_s: float | None,
    compression: str,
    progress: _Progress | None,
) -> Document: ...
def scenario_text(name: str, robot: _Path | Robot | None = None) -> str:
    """A scenario of the protocol (S5 to S8b, U1 …) as text, for a robot's joints where one is named.

    Parameters
    ----------
    name
        Name of the scenario.
    robot
        Folder of the robot or a ``Robot``.

    Returns
    -------
    str
        A scenario that ``simulate`` takes as ``(text, name)``.

    Raises
    ------
    SinewError
        Where there is no such scenario.
    """

def propose_poses(
    robot: _Path | Robot,
    baseline: _Path | Baseline | None,
    poses: int,
    pause_s: float,
    payload: bool,
    joint_bits: int,
    candidates: int,
    seed: int,
    progress: _Progress | None,
) -> tuple[Document, str]: ...
def run_command(arguments: Sequence[str]) -> int: ...
