"""While Rust works, Python continues, gets progress, and can interrupt."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

import pysinew as sn

from conftest import ROBOT, ROOT, SHIPPED

# Long enough to be interrupted: minutes of simulation.
LONG = 'sn.simulate("examples/scenarios/work-session.toml", robot, duration_s=7200.0, progress=progress)'
LONG_FILE = """sn.simulate(
            "examples/scenarios/work-session.toml", robot, out=sys.argv[1], duration_s=7200.0, progress=progress)"""


def test_other_threads_continue() -> None:
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, duration_s=60.0)
    went_on = counted - before
    stop.set()
    thread.join()
    # Holding the lock would leave it at a handful.
    assert went_on > 10_000, went_on


def test_progress_is_reported() -> None:
    heard: list[tuple[float, str]] = []
    progress = lambda share, word: heard.append((share, word))  # noqa: E731
    sn.simulate("examples/scenarios/work-session.toml", ROBOT, duration_s=60.0, progress=progress)
    shares = [share for share, _ in heard]
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert {word for _, word in heard} == {"simulating"}


def test_an_exception_of_the_callback_stops_the_work(tmp_path: Path) -> None:
    def enough(share: float, word: str) -> None:
        raise RuntimeError("enough")

    out = tmp_path / "long.mcap"
    with pytest.raises(RuntimeError, match="enough"):
        sn.simulate("examples/scenarios/work-session.toml", ROBOT, out=out, progress=enough)
    time.sleep(0.5)
    # Nothing half-written is left.
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("work", [LONG, LONG_FILE])
def test_ctrl_c_is_a_keyboard_interrupt(work: str, tmp_path: Path) -> None:
    code = f"""
    import sys, time, pysinew as sn
    robot = "{ROBOT}"
    told = []
    def progress(share, word):
        if not told:
            told.append(word)
            print("begun", flush=True)
    try:
        {work}
    except KeyboardInterrupt:
        # Python is itself again, and can work on.
        sn.estimate("{SHIPPED}", robot)
        print("interrupted", flush=True)
    """
    out = tmp_path / "out.mcap"
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), str(out)], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert process.stdout is not None
    # It is in the midst of its work, with hours of it left.
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=120)
    assert rest == "interrupted\n" and process.returncode == 0
    assert not out.exists()


def test_several_threads_work_at_once() -> None:
    answers: list[str] = []

    def one() -> None:
        answers.append(sn.estimate(SHIPPED, ROBOT).to_json())

    threads = [threading.Thread(target=one) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 3 and len(set(answers)) == 1


def test_import_costs_next_to_nothing() -> None:
    code = """
import sys
before = set(sys.modules)
import pysinew
loaded = {m.partition(".")[0] for m in set(sys.modules) - before}
assert "numpy" not in loaded, loaded
assert "json" not in loaded, loaded
pysinew.Robot("robots/biorob-like")
print(sorted(loaded))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
