"""Evaluation of creep tests for design."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any, Literal, Mapping, Sequence, Union

from . import results
from ._answer import Answer
from ._core import CreepTests as _CreepTests
from ._core import Document
from ._errors import SinewError
from ._types import PathLike, Progress, seed_of

if TYPE_CHECKING:
    from ._types import RandomLike

LawName = Literal["log-time", "findley", "burgers", "kelvin-voigt", "stretched", "line", "rope"]


class CreepAnalysis(Answer, results.CreepAnalysisResult):
    """Readings, moduli, slope, saturation, recovery and artefacts. Tables: ``specimens``, ``series``."""

    __slots__ = ()


class CreepFit(Answer, results.CreepFitResult):
    """Laws fitted to creep tests, by rising AICc. Tables: ``parameters``, ``series`` (readings and forecasts)."""

    __slots__ = ("rope_entry",)

    rope_entry: str | None
    """The fitted rope as a catalogue entry, where ``rope_name`` was given: write it to ``NAME.toml``."""

    def __init__(self, document: Document, rope_entry: str | None) -> None:
        super().__init__(document)
        object.__setattr__(self, "rope_entry", rope_entry)


class CreepHoldOut(Answer, results.CreepHoldOutResult):
    """Forecasts compared with the hidden end of each test. Table: ``coverage``."""

    __slots__ = ()


class CreepComparison(Answer, results.CreepComparisonResult):
    """Ropes in the order of their strain, with intervals. Table: ``ranks``."""

    __slots__ = ()


class CreepShift(Answer, results.CreepShiftResult):
    """Isotherms shifted along the logarithm of time. Table: ``shifts``."""

    __slots__ = ()


Columns = Mapping[str, Any]
"""Columns by name; names end in their units: ``time_s``, ``force_n``, ``strain_percent``, ``elongation_mm``."""


def _source(item: Any, name: str) -> Any:
    """A file as it is; a table as a named CSV text."""
    if isinstance(item, str) or hasattr(item, "__fspath__"):
        return item
    if hasattr(item, "to_csv"):
        return name, item.to_csv(index=False)
    if hasattr(item, "write_csv"):
        return name, item.write_csv()
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(item)
    columns = [list(column) for column in item.values()]
    if len({len(column) for column in columns}) > 1:
        sizes = ", ".join(f"{key}: {len(column)}" for key, column in zip(item, columns))
        raise SinewError(f"{name}: columns have different lengths ({sizes})")
    # The shortest text that reads back as the same number.
    writer.writerows([[repr(float(cell)) if isinstance(cell, float) else cell for cell in row] for row in zip(*columns)])
    return name, out.getvalue()


class CreepTests:
    """Creep tests, read and analysed once; then fitted, held out, compared or shifted.

    Parameters
    ----------
    files
        A file (CSV, XLSX, Parquet) or several; or tables (data frames, columns by name) by the name of
        each test, such as ``{"rope A": {"time_s": t, "force_n": f, "strain_percent": e}}``.
    columns
        Column mapping where headers are ambiguous, such as ``"force=Kraft:N"``.
    specimen_columns
        Columns that distinguish specimens.
    sheet
        Sheet of a workbook.
    group_by
        Columns that name a group of repeats.
    gauge_length_m, area_m2, temperature_c
        Values missing from the files, m, m² and °C.
    keep_artefacts
        Keep grip slips and outliers.
    slope_from_s
        Start of the straight line of m_E, s.
    level
        Level of the intervals.
    seed
        Seed of their posterior draws.
    rng
        Seed or generator of NumPy, instead of ``seed``.
    standard, preconditioning, conditions
        Texts of the report.
    progress
        Called with the completed share and the step.

    Raises
    ------
    SinewError
        For invalid input, with the message of the command.
    """

    def __init__(
        self,
        files: Union[PathLike, Sequence[PathLike], Mapping[str, Any]],
        *,
        columns: Sequence[str] = (),
        specimen_columns: Sequence[str] = (),
        sheet: str | None = None,
        group_by: Sequence[str] = (),
        gauge_length_m: float | None = None,
        area_m2: float | None = None,
        temperature_c: float | None = None,
        keep_artefacts: bool = False,
        slope_from_s: float = 1200.0,
        level: float = 0.95,
        seed: int = 1,
        rng: RandomLike | None = None,
        standard: str = "ISO 899-1 (tensile creep), evaluation",
        preconditioning: str | None = None,
        conditions: str | None = None,
        progress: Progress | None = None,
    ) -> None:
        if isinstance(files, Mapping):
            sources = [_source(table, name) for name, table in files.items()]
        elif isinstance(files, (list, tuple)):
            sources = [_source(item, f"table {i + 1}") for i, item in enumerate(files)]
        else:
            sources = [_source(files, "table")]
        args = {
            "columns": list(columns),
            "specimen_columns": list(specimen_columns),
            "sheet": sheet,
            "gauge_length_m": gauge_length_m,
            "area_m2": area_m2,
            "temperature_c": temperature_c,
            "keep_artefacts": keep_artefacts,
            "group_by": list(group_by),
            "slope_from_s": slope_from_s,
            "level": level,
            "seed": seed_of(seed, rng),
            "standard": standard,
            "preconditioning": preconditioning,
            "conditions": conditions,
        }
        self._tests = _CreepTests(sources, args, progress)

    def analyze(self) -> CreepAnalysis:
        """Readings, moduli, slope, saturation, recovery and artefacts.

        Returns
        -------
        CreepAnalysis
            The analysis of each specimen.
        """
        return CreepAnalysis(self._tests.analyze())

    def fit(
        self,
        laws: Sequence[LawName] = (),
        *,
        joint: Literal["none", "shape", "group"] = "none",
        noise: Literal["correlated", "white"] = "correlated",
        intervals: Literal["draws", "profile", "bootstrap"] = "draws",
        rope: str | None = None,
        rope_name: str | None = None,
        ropes: Sequence[PathLike] = (),
        forecast_s: float | None = None,
        forecast_load_n: float | None = None,
        forecast_temperature_c: float | None = None,
        progress: Progress | None = None,
    ) -> CreepFit:
        """Fits creep laws, selects the supported one and reports parameters that are not identifiable.

        Parameters
        ----------
        laws
            The default is all laws that need only the record, and the rope law if ``rope`` is given.
        joint
            Parameters that the specimens of a group share.
        noise
            Model of the measurement noise.
        intervals
            Method of the intervals.
        rope
            Catalogue rope that the rope law starts from.
        rope_name
            Name of the fitted entry.
        ropes
            Folders with additional ropes.
        forecast_s
            Forecast to this time after the load, s.
        forecast_load_n, forecast_temperature_c
            Load, N, and temperature, °C, of a new specimen; the default is those of the test.
        progress
            Called with the completed share and the step.

        Returns
        -------
        CreepFit
            The fits by rising AICc, and the entry of the rope.

        Raises
        ------
        SinewError
            For invalid input, with the message of the command.
        """
        args = self._args(laws, joint, noise, intervals, rope, ropes)
        args["forecast_s"] = forecast_s
        args["forecast_load_n"] = forecast_load_n
        args["forecast_temperature_c"] = forecast_temperature_c
        return CreepFit(*self._tests.fit(args, rope_name, progress))

    def hold_out(
        self,
        share: float,
        laws: Sequence[LawName] = (),
        *,
        joint: Literal["none", "shape", "group"] = "none",
        noise: Literal["correlated", "white"] = "correlated",
        intervals: Literal["draws", "profile", "bootstrap"] = "draws",
        rope: str | None = None,
        ropes: Sequence[PathLike] = (),
        progress: Progress | None = None,
    ) -> CreepHoldOut:
        """Hides the last share of every test and returns the coverage of the forecast intervals.

        Parameters
        ----------
        share
            Share of the record that is hidden, 0.01 to 0.9.
        laws, joint, noise, intervals, rope, ropes, progress
            As for ``fit``.

        Returns
        -------
        CreepHoldOut
            Coverage by law.

        Raises
        ------
        SinewError
            Where the share is not between 0.01 and 0.9, and as for ``fit``.
        """
        args = self._args(laws, joint, noise, intervals, rope, ropes)
        return CreepHoldOut(self._tests.hold_out(share, args, progress))

    def compare(self, *, scatter: float | None = None) -> CreepComparison:
        """All ropes ranked by strain at the longest time that all reach, with intervals.

        Parameters
        ----------
        scatter
            Standard deviation between specimens as a share, for ropes with one specimen.

        Returns
        -------
        CreepComparison
            The ropes by rank.

        Raises
        ------
        SinewError
            For fewer than two ropes.
        """
        return CreepComparison(self._tests.compare(scatter))

    def shift(self, reference_c: float) -> CreepShift:
        """Shift factors of isotherms to a temperature.

        Parameters
        ----------
        reference_c
            Reference temperature, °C.

        Returns
        -------
        CreepShift
            The shift factors.

        Raises
        ------
        SinewError
            With fewer than two temperatures.
        """
        return CreepShift(self._tests.shift(reference_c))

    @staticmethod
    def _args(
        laws: Sequence[str],
        joint: str,
        noise: str,
        intervals: str,
        rope: str | None,
        ropes: Sequence[PathLike],
    ) -> dict[str, Any]:
        return {
            "laws": list(laws),
            "joint": joint,
            "noise": noise,
            "intervals": intervals,
            "rope": rope,
            "ropes": list(ropes),
            "forecast_s": None,
            "forecast_load_n": None,
            "forecast_temperature_c": None,
        }
