"""Names, units and uncertainties are those of the JSON schemas in every table, function, structure of C and row of Spark."""

from __future__ import annotations

import inspect
import json
import re
import warnings
from typing import Any, Callable, Iterator

import pytest

import pysinew as sn
from pysinew import fleet

from conftest import ROBOT, ROOT, SHIPPED

HEADER = (ROOT / "bindings/c/include/sinew.h").read_text("utf-8")
ROPE = "liros-dc000-0301"
# Parts of a value with uncertainty, before the unit; minimum and maximum over an interval of time.
PARTS = r"_(std|low|high|min|max)(?=_|$)"
# Units that are not SI.
NOT_SI = r"_(mrad|mm|ms|us|um|percent|mpa|kpa|deg|days?|h|n_per_mm|g_per_m|percent_per_h)$"


def properties(node: Any) -> Iterator[tuple[str, Any]]:
    """Every key of a schema, with the schema of its value."""
    if isinstance(node, dict):
        yield from node.get("properties", {}).items()
        for inner in node.values():
            yield from properties(inner)
    elif isinstance(node, list):
        for inner in node:
            yield from properties(inner)


def flattened(schema: Any) -> Iterator[str]:
    """Names of the fields of an object next to each other: ``external_force_probability``, ``external_force_n``."""
    for name, value in properties(schema):
        for reference in re.findall(r"#/\$defs/(\w+)", json.dumps(value)):
            for inner in schema["$defs"][reference].get("properties", {}):
                yield f"{name}_{inner}"
                last = name.rsplit("_", 1)[-1] + "_"
                if inner.startswith(last):
                    yield f"{name}_{inner.removeprefix(last)}"


def vocabulary() -> set[str]:
    names: set[str] = set()
    for file in (ROOT / "docs/schema").glob("*.json"):
        schema = json.loads(file.read_text("utf-8"))
        names |= {name for name, _ in properties(schema)}
        names |= set(flattened(schema))
    # State of the online estimator, which no document contains.
    names |= {name for name in (*dir(sn.OnlineEstimator), *sn.Provisional._fields) if not name.startswith("_")}
    return names


NAMES = vocabulary()


def is_known(name: str) -> bool:
    """Whether a name is a key, a part of one with uncertainty, its integer time, or an element of a list."""
    forms = {name, re.sub(PARTS, "", name), re.sub(r"_ns$", "_s", name), name.removeprefix("block_")}
    forms |= {form + "s" for form in forms}
    return bool(forms & NAMES)


def answers() -> dict[str, Callable[[], Any]]:
    tests = lambda: sn.CreepTests("examples/06-creep-test/rope-A.csv")  # noqa: E731
    load = {"tension_n": 60.0, "length_m": 0.7, "draws": 8}
    return {
        "estimate": lambda: sn.estimate(SHIPPED, ROBOT),
        "estimate_each": lambda: sn.estimate_each([SHIPPED], ROBOT),
        "trend": lambda: sn.trend("examples/10-trend/sessions.csv", ROBOT),
        "predict_rope": lambda: sn.predict_rope(ROPE, **load),
        "select_rope": lambda: sn.select_rope(**load),
        "analyze": lambda: tests().analyze(),
        "fit": lambda: tests().fit(["log-time"]),
        "hold_out": lambda: tests().hold_out(0.3, ["log-time"]),
        "compare": lambda: tests().compare(),
        "check_robot": lambda: sn.check_robot(ROBOT),
        "recording_info": lambda: sn.recording_info(SHIPPED),
    }


@pytest.mark.parametrize("name", answers())
def test_table_columns_are_names_of_the_schemas(name: str) -> None:
    warnings.simplefilter("ignore")
    answer = answers()[name]()
    for table in answer.table_names:
        columns = answer.table(table).column_names
        assert [own for own in columns if not is_known(own)] == [], table
        other_units = [own for own in columns if re.search(NOT_SI, own) and own not in NAMES]
        assert other_units == [], table
        units = answer.table(table).units
        assert all(units[own] == units[own.replace("_std", "")] for own in columns if "_std_" in own and own in units)


def test_rows_of_spark_are_names_of_the_schemas() -> None:
    for columns in (fleet._RECORD, fleet._TREND):
        assert [own for own in columns if not is_known(own)] == []
        assert [own for own in columns if re.search(NOT_SI, own)] == []
    record = json.loads((ROOT / "docs/schema/record-2.json").read_text("utf-8"))
    assert set(fleet._RECORD) - {"rejection"} == set(record["properties"])


def test_fields_of_c_are_names_of_the_schemas() -> None:
    structures = re.findall(r"typedef struct \{(.*?)\n\} (\w+);", HEADER, re.DOTALL)
    assert {name for _, name in structures} == {"sinew_offsets_options", "sinew_answer", "sinew_offset"}
    for body, structure in structures:
        fields = re.findall(r"^    \w+ (\w+)(?:\[\d+\])?;$", body, re.MULTILINE)
        assert len(fields) > 5
        assert [own for own in fields if not is_known(own)] == [], structure
        assert [own for own in fields if re.search(NOT_SI, own)] == [], structure


def test_functions_of_c_state_realtime_class_and_threads() -> None:
    functions = re.findall(r"((?://.*\n)+)[\w *]+?\*?(sinew_\w+)\(", HEADER)
    assert len(functions) > 30
    for comment, function in functions:
        assert "// Realtime: " in comment and "// Threads: " in comment, function


def functions() -> dict[str, Any]:
    """Public functions, classes that are called, and public methods."""
    out: dict[str, Any] = {"fleet.sessions": fleet.sessions, "fleet.trend": fleet.trend}
    out |= {f"datasets.{name}": getattr(sn.datasets, name) for name in ("load", "names")}
    for name in sn.__all__:
        item = getattr(sn, name)
        if inspect.isclass(item):
            is_result = issubclass(item, (BaseException, tuple)) or hasattr(item, "_fields")
            if not is_result and parameters(item):
                out[name] = item
            for method, own in inspect.getmembers(item, callable):
                if not method.startswith("_") and not issubclass(item, (BaseException, tuple)):
                    out[f"{name}.{method}"] = own
        elif callable(item):
            out[name] = item
    return out


def parameters(item: Any) -> list[str]:
    try:
        return [name for name in inspect.signature(item).parameters if name not in ("self", "cls", "key")]
    except ValueError:
        return []


def documented(doc: str) -> set[str]:
    """Parameters that a docstring of numpydoc describes."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", doc, re.DOTALL | re.MULTILINE)
    heads = re.findall(r"^(\w[\w, ]*)$", section[1], re.MULTILINE) if section else []
    return {name.strip() for head in heads for name in head.split(",")}


def test_docstrings_describe_parameters_results_and_errors() -> None:
    for name, item in functions().items():
        doc = inspect.cleandoc(item.__doc__ or "")
        own = parameters(item)
        assert doc, name
        assert set(own) <= documented(doc), (name, set(own) - documented(doc))
        assert documented(doc) <= {*own, "options"}, (name, documented(doc) - set(own))
        if own:
            sections = re.findall(r"^(\w[\w ]*)\n-+$", doc, re.MULTILINE)
            assert "Raises" in sections or "fleet." in name or not own, name
            assert sections == [known for known in ("Parameters", "Returns", "Raises", "Examples") if known in sections], name
        if own and inspect.isfunction(item) and inspect.signature(item).return_annotation != "None":
            assert "Returns\n-------\n" in doc, name


def test_parameters_are_in_si_units() -> None:
    for name, item in functions().items():
        assert [own for own in parameters(item) if re.search(NOT_SI, own)] == [], name


def test_fields_of_results_are_in_si_units() -> None:
    records = [item for _, item in inspect.getmembers(sn.results, inspect.isclass) if hasattr(item, "_fields")]
    assert len(records) > 100
    fields = {field for record in records for field in record._fields if re.search(NOT_SI, field)}
    # Relative, as hygrometers show it.
    assert fields == {"humidity_percent"}


def test_uncertainties_are_standard_deviations_or_intervals() -> None:
    for file in (ROOT / "docs/schema").glob("*.json"):
        definitions = json.loads(file.read_text("utf-8")).get("$defs", {})
        for name, parts in {"Gaussian": {"mean", "std"}, "Bounded": {"value", "low", "high"}, "Interval95": {"low", "high"}}.items():
            if name in definitions:
                assert set(definitions[name]["properties"]) == parts, file.name
    assert {own for own in NAMES if re.search("deviation|sigma|stddev|confidence|_ci_", own)} == set()
