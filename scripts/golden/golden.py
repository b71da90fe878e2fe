#!/usr/bin/env python3
"""Compares the numbers of two builds of `sinew`: records the output and the files of each command
(cases.toml), then compares two records by the rules of intended changes in rules.toml.

    golden.py record --binary BIN --out DIR [--tree REPOSITORY] [--side before|after]
    golden.py compare BEFORE AFTER [--report FILE]

Only the standard library of Python 3.11 is used. See README.md.
"""

import argparse
import concurrent.futures
import fnmatch
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from compare import compare

HERE = Path(__file__).resolve().parent
INPUTS = ["examples", "robots", "crates/sinew-rope/ropes", "fuzz/seeds"]
TIMEOUT_S = 1200


# ---------------------------------------------------------------- record


def stories(side, only):
    """Stories of cases.toml: name, inputs, [(case, argument list)]."""
    for story in tomllib.loads((HERE / "cases.toml").read_text())["story"]:
        cases = []
        for name, line in story["cases"].items():
            line = line[side] if isinstance(line, dict) else line
            cases.append((name, line.split()))
        name = story["name"]
        if not only or any(fnmatch.fnmatch(f"{name}/{c}", only) for c, _ in cases):
            yield name, story.get("inputs", {}), cases


def of_side(value, side):
    return value[side] if side in value else value


def write_input(tree, name, how):
    """An input made from a shipped file (`of`) or from `text`, with damage if so wished."""
    data = how["text"].encode() if "text" in how else (tree / how["of"]).read_bytes()
    for old, new in how.get("replace", []):
        if old.encode() not in data:
            raise SystemExit(f"{name}: '{old}' isn't in {how.get('of')}")
        data = data.replace(old.encode(), new.encode())
    data = data[how.get("skip_bytes", 0) :]
    if "first_lines" in how:
        data = b"".join(data.splitlines(keepends=True)[: how["first_lines"]])
    if "keep_share" in how:
        data = data[: int(len(data) * how["keep_share"])]
    if "encoding" in how:
        data = data.decode().encode(how["encoding"])
    (tree / name).parent.mkdir(parents=True, exist_ok=True)
    (tree / name).write_bytes(data)


def snapshot(tree):
    found = {}
    for folder, _, names in os.walk(tree):
        for name in names:
            path = Path(folder) / name
            if not path.is_symlink():
                state = path.stat()
                found[str(path.relative_to(tree))] = (state.st_mtime_ns, state.st_size, state.st_ino)
    return found


def run_story(arguments, scratch, name, inputs, cases):
    story = scratch / name
    shutil.rmtree(arguments.out / name, ignore_errors=True)
    tree = story / "tree"
    tree.mkdir(parents=True)
    for folder in INPUTS:
        shutil.copytree(arguments.tree / folder, tree / folder)
    shared = arguments.tree.parent / "shared"
    if shared.is_dir():
        (story / "shared").symlink_to(shared.resolve())
    for path, how in inputs.items():
        how = of_side(how, arguments.side)
        if how.get("of", "").startswith("../shared") and not shared.is_dir():
            continue
        write_input(tree, path, how)
    (tree / "out").mkdir(exist_ok=True)
    environment = {
        "PATH": os.environ["PATH"],
        "HOME": str(story),
        "LANG": "C.UTF-8",
        "COLUMNS": "80",
        "NO_COLOR": "1",
        "TZ": "UTC",
    }
    lines = []
    for case, words in cases:
        if any("../shared" in w for w in words) and not shared.is_dir():
            lines.append(f"{name}/{case}: left out, no ../shared")
            continue
        before = snapshot(tree)
        began = time.monotonic()
        to_file = words[-1] if words[-2:-1] == [">"] else None
        result = subprocess.run(
            words if words[:1] == ["cp"] else ["sinew", *(words[:-2] if to_file else words)],
            executable=None if words[:1] == ["cp"] else arguments.binary,
            cwd=tree,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=TIMEOUT_S,
        )
        if to_file:
            (tree / to_file).write_bytes(result.stdout)
        took = time.monotonic() - began
        into = arguments.out / name / case
        into.mkdir(parents=True)
        (into / "arguments").write_text(" ".join(words) + "\n")
        (into / "exit").write_text(f"{result.returncode}\n")
        for stream, text in (("stdout", result.stdout), ("stderr", result.stderr)):
            (into / stream).write_bytes(text.replace(bytes(tree), b"TREE"))
        after = snapshot(tree)
        for path in sorted(after):
            if before.get(path) == after[path]:
                continue
            to = into / "files" / path
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes((tree / path).read_bytes().replace(bytes(tree), b"TREE"))
        for path in sorted(set(before) - set(after)):
            (into / "removed").open("a").write(path + "\n")
        lines.append(f"{name}/{case}: exit {result.returncode}, {took:.2f} s")
    shutil.rmtree(story)
    return lines


def record(arguments):
    if arguments.out.exists() and not arguments.only:
        raise SystemExit(f"{arguments.out} exists already; --only does a part of it again")
    arguments.out.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix="sinew-golden-"))
    lines = []
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        jobs = [
            pool.submit(run_story, arguments, scratch, *story)
            for story in stories(arguments.side, arguments.only)
        ]
        for job in jobs:
            lines += job.result()
    shutil.rmtree(scratch)
    sums = {}
    for folder in INPUTS:
        for path in sorted((arguments.tree / folder).rglob("*")):
            if path.is_file():
                sums[str(path.relative_to(arguments.tree))] = hashlib.sha256(path.read_bytes()).hexdigest()
    (arguments.out / "inputs.json").write_text(json.dumps(sums, indent=0))
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    lines.append(f"{used.ru_utime + used.ru_stime:.1f} CPU-seconds")
    (arguments.out / "record.log").write_text("\n".join(lines) + "\n")
    print("\n".join(lines if arguments.verbose else lines[-1:]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("record", help="run every case with one build and keep what it prints and writes")
    one.add_argument("--binary", required=True, type=lambda p: str(Path(p).resolve()))
    one.add_argument("--out", required=True, type=lambda p: Path(p).resolve())
    one.add_argument("--tree", default=HERE.parent.parent, type=lambda p: Path(p).resolve(), help="repository whose examples are used")
    one.add_argument("--side", default="after", choices=["before", "after"], help="which arguments, where a case has two")
    one.add_argument("--only", help="stories with a case of this name, such as 'trend/*'")
    one.add_argument("--jobs", type=int, default=1, help="stories at a time")
    one.add_argument("--verbose", action="store_true")
    one.set_defaults(run=record)
    two = commands.add_parser("compare", help="compare two records")
    two.add_argument("before", type=Path)
    two.add_argument("after", type=Path)
    two.add_argument("--rules", default=HERE / "rules.toml", type=Path)
    two.add_argument("--report", type=Path, help="details go here instead of the terminal")
    two.add_argument("--all", action="store_true", help="every line of every difference")
    two.set_defaults(run=compare)
    arguments = parser.parse_args()
    return arguments.run(arguments)


if __name__ == "__main__":
    sys.exit(main())
