"""The code blocks of the manual run unchanged."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT

PAGE = ROOT / "docs/src/manual/python.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_a_block_of_the_page_runs(number: int, tmp_path: Path) -> None:
    # Paths as for a reader, but output goes to another folder.
    for name in ("examples", "robots"):
        (tmp_path / name).symlink_to(ROOT / name)
    done = subprocess.run(
        [sys.executable, "-c", BLOCKS[number]],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "agg"},
        check=False,
    )
    assert done.returncode == 0, BLOCKS[number] + done.stderr


def test_the_page_names_what_there_is() -> None:
    import pysinew as sn

    text = PAGE.read_text("utf-8")
    functions = text[text.index("## Functions") : text.index("The wheel contains the other commands")]
    for row in functions.splitlines()[4:-1]:
        for name in re.findall(r"`([A-Za-z_]+)`", row.split("|")[2]):
            assert hasattr(sn, name) or hasattr(sn.CreepTests, name), name
    first = text.split("```python\n")[1].split("```")[0].strip().splitlines()
    assert len(first) <= 10


def test_every_command_of_the_manual_has_a_function_or_a_reason() -> None:
    table = (ROOT / "docs/src/manual/commands.md").read_text("utf-8").split("## Terminal output")[0]
    commands = {match.split()[0] for match in re.findall(r"`sinew ([a-z]+)", table)} - {"completions", "man"}
    commands |= {f"{group} {name}" for group, name in re.findall(r"`sinew (robot|log|creep|trend) ([a-z]+)", table)}
    commands -= {"robot", "log", "trend simulate"}
    text = PAGE.read_text("utf-8")
    functions = text[text.index("## Functions") : text.index("`help(")]
    named = set(re.findall(r"`([a-z][a-z -]*)`", functions))
    # A group stands for its commands, unless one is named.
    assert len(commands) > 15
    assert {own for own in commands if own not in named and own.split()[0] not in named} == set()
