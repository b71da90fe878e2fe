"""Exceptions of Sinew."""

from __future__ import annotations


class SinewError(ValueError):
    """Invalid input: the message states the problem, the location, the value and the fix."""


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
