"""Answers: a typed result, and every way the command shows it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Mapping

from ._record import Record

if TYPE_CHECKING:
    import os

    from ._core import Document, Table


class Answer(Record):
    """Result of a function: fields in SI units with standard deviations, and the text, tables and pages of the command.

    ``print(answer)`` shows what the command prints; a notebook shows the main plot of its report.
    """

    __slots__ = ("_document",)

    _document: Document

    def __init__(self, document: Document) -> None:
        object.__setattr__(self, "_document", document)

    def __getattr__(self, name: str) -> Any:
        if name == "_data":
            # Decoded on first use.
            data: Mapping[str, Any] = json.loads(self._document.json())
            object.__setattr__(self, "_data", data)
            return data
        return super().__getattr__(name)

    def to_json(self) -> str:
        """The JSON document that the command prints with ``--json``, with identical digits."""
        return self._document.json()

    @property
    def notices(self) -> list[str]:
        """Warnings that the command prints on stderr."""
        return self._document.warnings()

    @property
    def is_lossy(self) -> bool:
        """Whether the command would end with exit code 3: data was lost, or action is required."""
        return self._document.is_lossy()

    @property
    def table_names(self) -> list[str]:
        """Names of the tables there are."""
        return self._document.table_names()

    def table(self, name: str | None = None) -> Table:
        """Returns a table by name, or the first table. pandas, polars, pyarrow and duckdb read it directly.

        Raises ``KeyError`` where there is no such table.
        """
        return self._document.table(name)

    def html(self) -> str:
        """The report as one HTML file that opens offline.

        Raises ``ValueError`` where this answer has no report.
        """
        html = self._document.html()
        if html is None:
            raise ValueError(f"{type(self).__name__} has no report")
        return html

    def write_html(self, path: str | os.PathLike[str]) -> None:
        """Writes the report. The file is complete or absent.

        Raises ``ValueError`` if this result has no report or the file cannot be written.
        """
        if not self._document.write_html(path):
            raise ValueError(f"{type(self).__name__} has no report")

    def __str__(self) -> str:
        return self._document.words()

    def __repr__(self) -> str:
        return f"<pysinew.{type(self).__name__}>"

    def _repr_html_(self) -> str | None:
        return self._document.glance()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Answer) and self.to_json() == other.to_json()

    # Equal ones would have to have equal hashes.
    __hash__ = None

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError(f"{type(self).__name__} cannot be pickled; store to_json() instead")
