"""Exceptions and warnings of Sinew."""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any


class SinewError(ValueError):
    """Invalid input: the message states the problem, the location, the value and the fix."""


class UnknownNameError(SinewError, KeyError):
    """A name that is unknown, such as that of a joint; the message lists the known names."""

    def __str__(self) -> str:
        # A ``KeyError`` would print its message in quotes.
        return str(self.args[0])


class LocatedError(SinewError):
    """A fault of a text file, with its place.

    ``str(error)`` is the complete message; its parts are attributes.
    """

    file: str
    """File as it was named."""
    line: int | None
    """Line, from 1; row of a workbook."""
    place: str | None
    """Key, column or element."""
    value: str | None
    """Value found, as written."""
    unit: str | None
    """Its unit."""
    problem: str
    """What is wrong, or what it must be."""
    cure: str | None
    """What to do."""

    def __init__(
        self,
        sentence: str,
        *,
        file: str,
        line: int | None,
        place: str | None,
        value: str | None,
        unit: str | None,
        problem: str,
        cure: str | None,
    ) -> None:
        super().__init__(sentence)
        self.file = file
        self.line = line
        self.place = place
        self.value = value
        self.unit = unit
        self.problem = problem
        self.cure = cure

    def __reduce__(self) -> tuple[Any, ...]:
        parts = {part: getattr(self, part) for part in ("file", "line", "place", "value", "unit", "problem", "cure")}
        return _located, (str(self), parts)


def _located(sentence: str, parts: dict[str, Any]) -> LocatedError:
    return LocatedError(sentence, **parts)


class SinewWarning(UserWarning):
    """A warning that the command prints on stderr. ``str(warning)`` is ``[code] text``."""

    code: str
    """Code under which the manual describes the warning, the ``kind`` of the JSON document; empty without one."""
    text: str
    """Finding with value and unit, effect, and recommended action."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(f"[{code}] {text}" if code else text)
        self.code = code
        self.text = text

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.code, self.text)


class RobotWarning(SinewWarning):
    """About the description of a robot."""


class RecordingWarning(SinewWarning):
    """About a recording or the records of an analysis: units, gaps, damage, excluded data."""


class ResultWarning(SinewWarning):
    """About a result: what could not be separated, what was assumed, how the intervals were widened."""


def _warn(warning: SinewWarning) -> None:
    """Issues a warning at the line that called the package."""
    here = os.path.dirname(__file__)
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(here):
        level, frame = level + 1, frame.f_back
    warnings.warn(warning, stacklevel=level)
