"""Result records with named fields, over the JSON that the command prints."""

from __future__ import annotations

from typing import Any, ClassVar, Mapping

from ._core import Z95

_PLAIN = (str, int, float, bool, type(None))


class Record:
    """Record with named, read-only fields. ``to_dict()`` returns plain data."""

    __slots__ = ("_data",)

    _data: Mapping[str, Any]
    _fields: ClassVar[Mapping[str, str]] = {}
    """Every field, and what it holds: the name of a class, or an empty text for plain data."""
    _classes: ClassVar[Mapping[str, Any]] = {}
    """Classes and choices by name."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_data", data)

    def __getattr__(self, name: str) -> Any:
        kind = self._fields.get(name)
        if kind is None:
            raise AttributeError(f"{type(self).__name__} has no field '{name}'; it has {', '.join(self._fields)}")
        # Unknown values are missing in some documents; a few keys are not valid Python names.
        key = name if name in self._data else name.rstrip("_").replace("_", "-")
        return self._wrap(kind, self._data.get(key))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} cannot be changed")

    @classmethod
    def _wrap(cls, kind: str, value: Any) -> Any:
        if not kind or isinstance(value, _PLAIN):
            return value
        if isinstance(value, list):
            return [cls._wrap(kind, item) for item in value]
        if kind.startswith("map:"):
            return {key: cls._wrap(kind[4:], item) for key, item in value.items()}
        target = cls._classes[kind]
        if isinstance(target, dict):
            # One of several classes: by its kind, or by its only key.
            tag = value["kind"] if "kind" in value else next(iter(value))
            target = target[tag]
        return target(value)

    def to_dict(self) -> dict[str, Any]:
        """The plain data, as ``json.loads`` gives it."""
        return dict(self._data)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and type(self) is type(other) and self._data == other._data

    # Equal ones would have to have equal hashes.
    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._data,)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._fields]

    def __repr__(self) -> str:
        def short(value: Any) -> str:
            if isinstance(value, list) and len(value) > 4:
                return f"[… {len(value)}]"
            return repr(value)

        # In the order of the document; missing fields last.
        names = [*(name for name in self._data if name in self._fields)]
        names += [name for name in self._fields if name not in names]
        fields = ", ".join(f"{name}={short(getattr(self, name))}" for name in names)
        return f"{type(self).__name__}({fields})"


class GaussianRecord(Record):
    """A mean and a standard deviation."""

    __slots__ = ()

    mean: float
    std: float

    @property
    def half_width_95(self) -> float:
        """Half the 95 % interval: 1.96 standard deviations."""
        return Z95 * self.std

    @property
    def interval_95(self) -> tuple[float, float]:
        """The 95 % interval."""
        return self.mean - self.half_width_95, self.mean + self.half_width_95
