"""Answers: a typed result, and every way the command shows it."""

from __future__ import annotations

import html
import json
from typing import TYPE_CHECKING, Any, Mapping

from . import _errors
from ._core import Document
from ._errors import SinewError, SinewWarning
from ._record import Record

if TYPE_CHECKING:
    import os

    from typing_extensions import Self

    from ._core import Table


class Answer(Record):
    """Result of a function: fields in SI units with standard deviations, and the text, tables and pages of the command.

    ``print(answer)`` shows what the command prints; a notebook shows the main plot of its report.
    """

    __slots__ = ("_document",)

    _document: Document

    def __init__(self, document: Document) -> None:
        object.__setattr__(self, "_document", document)
        for warning in self.warnings:
            _errors._warn(warning)

    @classmethod
    def _restore(cls, document: Document, parts: Mapping[str, Any]) -> Self:
        """A result without its warnings, which were issued when it was made."""
        answer = cls.__new__(cls)
        object.__setattr__(answer, "_document", document)
        for name, value in parts.items():
            object.__setattr__(answer, name, value)
        return answer

    @classmethod
    def _parts(cls) -> list[str]:
        """Names of the attributes besides the document."""
        slots = [name for kind in cls.__mro__ for name in getattr(kind, "__slots__", ())]
        return [name for name in slots if name not in ("_document", "_data")]

    @classmethod
    def from_json(cls, text: str) -> Self:
        """The result of a JSON document, such as ``to_json()`` returns.

        It has the fields of the document. Its text is the document itself; tables and report are those of ``Estimate`` only.

        Parameters
        ----------
        text
            Document of ``to_json()`` or of the command.

        Returns
        -------
        Answer
            An equal result.

        Raises
        ------
        SinewError
            If the text is no JSON object.
        """
        try:
            data = json.loads(text)
        except ValueError as error:
            raise SinewError(f"the text is no JSON document: {error}") from None
        if not isinstance(data, dict):
            raise SinewError("the JSON document is no object")
        document = Document._restore((text, text, None, None, [], [], False))
        return cls._restore(document, dict.fromkeys(cls._parts()))

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
    def warnings(self) -> list[SinewWarning]:
        """Warnings that the command prints on stderr. They are also issued with ``warnings.warn`` when the result is made."""
        return [getattr(_errors, category)(code, text) for category, code, text in self._document.warnings()]

    @property
    def is_lossy(self) -> bool:
        """Whether the command would end with exit code 3: data was lost, or action is required."""
        return self._document.is_lossy()

    @property
    def table_names(self) -> list[str]:
        """Names of the tables there are."""
        return self._document.table_names()

    def table(self, name: str | None = None) -> Table:
        """A table by name, or the first table. pandas, polars, pyarrow and duckdb read it directly.

        Parameters
        ----------
        name
            One of ``table_names``.

        Returns
        -------
        Table
            In SI units, which ``units`` lists by column.

        Raises
        ------
        KeyError
            Where there is no such table.
        """
        return self._document.table(name)

    def html(self) -> str:
        """The report as one HTML file that opens offline.

        Returns
        -------
        str
            The page.

        Raises
        ------
        SinewError
            Where this result has no report.
        """
        page = self._document.html()
        if page is None:
            raise SinewError(f"{type(self).__name__} has no report")
        return page

    def write_html(self, path: str | os.PathLike[str]) -> None:
        """Writes the report. The file is complete or absent.

        Parameters
        ----------
        path
            File to write.

        Raises
        ------
        SinewError
            If this result has no report or the file cannot be written.
        """
        if not self._document.write_html(path):
            raise SinewError(f"{type(self).__name__} has no report")

    def __str__(self) -> str:
        return self._document.words()

    def __repr__(self) -> str:
        warnings = "".join(f"\n  {type(warning).__name__}: {warning}" for warning in self.warnings)
        return f"<pysinew.{type(self).__name__}{warnings}>"

    def _repr_html_(self) -> str | None:
        glance = self._document.glance()
        if glance is None or not self.warnings:
            return glance
        items = "".join(f"<li>{html.escape(str(warning))}</li>" for warning in self.warnings)
        return f"{glance}<ul>{items}</ul>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Answer) and self.to_json() == other.to_json()

    # Equal ones would have to have equal hashes.
    __hash__ = None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self)._restore, (self._document, {name: getattr(self, name) for name in self._parts()})
