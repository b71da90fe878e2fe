"""Common fixtures: examples of the repository, and recordings simulated once."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pysinew as sn

ROOT = Path(__file__).resolve().parents[3]
ROBOT = "robots/biorob-like"
SHIPPED = "examples/01-stretched-arm/stretched-arm.mcap"


@pytest.fixture(autouse=True)
def root(monkeypatch: pytest.MonkeyPatch) -> Path:
    """Every test runs where the examples' paths are right."""
    monkeypatch.chdir(ROOT)
    return ROOT


@pytest.fixture(scope="session")
def sinew() -> str:
    """The command that the wheel installs."""
    beside = Path(sys.executable).parent / "sinew"
    found = str(beside) if beside.exists() else shutil.which("sinew")
    assert found, "the wheel has installed no command"
    return found


@pytest.fixture(scope="session")
def command(sinew: str):
    """Runs the command and returns what it prints."""

    def run(*arguments: object, code: int = 0) -> str:
        done = subprocess.run(
            [sinew, *map(str, arguments)], cwd=ROOT, capture_output=True, text=True, timeout=600, check=False
        )
        assert done.returncode == code, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A work session of three minutes whose tendons stretch after the first."""
    path = tmp_path_factory.mktemp("work") / "work.mcap"
    os.chdir(ROOT)
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, out=path)
    return path


@pytest.fixture(scope="session")
def learned(work: Path) -> sn.Learned:
    """Baseline of its first minute."""
    os.chdir(ROOT)
    return sn.learn_baseline(work, ROBOT, to_s=60.0)
