"""Comparison of two records of golden.py by the rules of rules.toml."""

import csv
import datetime
import difflib
import fnmatch
import html
import io
import json
import math
import re
import struct
import tomllib
from pathlib import Path

BINARY = {".mcap", ".png", ".parquet", ".jpg"}

# ---------------------------------------------------------------- compare: what is a number

# A number that is not part of a name (wrist_1, S7, fig6). The sign counts where no word precedes it.
NUMBER = re.compile(r"(?:(?<![\w.])[-−+])?(?<![A-Za-z_0-9.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+−]?\d+)?")
BOX = re.compile(r"[─━│┃┌┐└┘├┤┬┴┼═╞╪╡]+")


def numbers_and_words(text):
    numbers = [n.replace("−", "-").rstrip(".") for n in NUMBER.findall(text)]
    words = BOX.sub(" ", NUMBER.sub(" # ", text)).split()
    return numbers, words


def as_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def ulps(a, b):
    """Representable doubles between two."""
    if math.isnan(a) or math.isnan(b):
        return 0 if math.isnan(a) and math.isnan(b) else math.inf

    def order(x):
        bits = struct.unpack("<q", struct.pack("<d", x))[0]
        return bits if bits >= 0 else -(bits & 0x7FFFFFFFFFFFFFFF)

    return abs(order(float(a)) - order(float(b)))


# ---------------------------------------------------------------- compare: trees


def leaves(value, path=""):
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value:
        for i, inner in enumerate(value):
            yield from leaves(inner, f"{path}[{i}]")
    else:
        yield path, value


WILD = re.compile(r"\*\*|\*|\[\]")


def pattern(text):
    """`[]` any index, `*` any one key, `**` anything."""
    parts, at = [], 0
    for found in WILD.finditer(text):
        parts.append(re.escape(text[at : found.start()]))
        parts.append({"**": "(.*)", "*": r"([^.\[\]]+)", "[]": r"\[(\d+)\]"}[found.group()])
        at = found.end()
    return re.compile("".join(parts) + re.escape(text[at:]))


def fill(template, groups):
    groups = iter(groups)
    return WILD.sub(lambda w: f"[{next(groups)}]" if w.group() == "[]" else next(groups), template)


def one_by_one(rules, names):
    """Expands rules of the same cases that share one table, one row each."""
    for rule in rules:
        rows = rule.pop("each", None)
        yield from [rule] if rows is None else [{**rule, **dict(zip(names, row))} for row in rows]


class Rules:
    def __init__(self, path):
        rules = tomllib.loads(path.read_text()) if path.exists() else {}
        for kind in ("move", "rename", "added", "dropped", "words", "value"):
            names = {"added": ["new"], "dropped": ["old"], "words": ["old"]}.get(kind, ["old", "new", "was", "ulps", "apart"])
            rules[kind] = list(one_by_one(rules.get(kind, []), names))
        self.move = [dict(r, match=pattern(r["old"])) for r in rules.get("move", [])]
        self.rename = [dict(r, match=pattern(r["old"])) for r in rules.get("rename", [])]
        self.added = [dict(r, match=pattern(r["new"])) for r in rules.get("added", [])]
        self.dropped = [dict(r, match=pattern(r["old"])) for r in rules.get("dropped", [])]
        self.words = [dict(r, match=pattern(r["old"])) for r in rules.get("words", [])]
        self.value = rules["value"]
        self.normalise = [dict(r, match=re.compile(r["match"])) for r in rules.get("normalise", [])]
        self.sort = rules.get("sort", [])
        self.explained = rules.get("explained", [])
        self.eased = rules.get("eased", [])
        self.used = set()
        self.known = {}

    def of(self, kind, case, file):
        """Rules of a kind that speak of a case's file, with what `used` knows them by."""
        known = self.known.get((kind, case, file))
        if known is None:
            known = self.known[kind, case, file] = [
                ((kind, i), rule)
                for i, rule in enumerate(getattr(self, kind))
                if any(fnmatch.fnmatch(case, c) for c in as_list(rule.get("cases", "*")))
                and fnmatch.fnmatch(file, rule.get("file", "*"))
            ]
        return known


def as_list(value):
    return [value] if isinstance(value, str) else value


class Tree:
    """The leaves of the new document, some missing because a parent is null."""

    def __init__(self, value):
        self.at = dict(leaves(value))
        self.taken = set()

    def has(self, path):
        return path in self.at or self.null(path)

    def null(self, path):
        while path:
            cut = max(path.rfind("."), path.rfind("["))
            path = path[:cut] if cut >= 0 else ""
            if path in self.at:
                return self.at[path] is None
        return False

    def get(self, path):
        if path in self.at:
            self.taken.add(path)
            return self.at[path]
        while path and path not in self.at:
            cut = max(path.rfind("."), path.rfind("["))
            path = path[:cut] if cut >= 0 else ""
        self.taken.add(path)
        return None


class Outcome:
    """Outcome of one case."""

    ORDER = ["identical", "renamed", "within ulps", "words differ", "explained", "NUMBERS DIFFER"]

    def __init__(self, case):
        self.case, self.level, self.lines, self.renamed, self.ulps = case, 0, [], 0, 0
        self.wide = []

    def note(self, level, line=None):
        self.level = max(self.level, self.ORDER.index(level))
        if line is not None:
            self.lines.append(f"[{level}] {line}")


def day(time_utc_s):
    """Day of a time since 1970, as the program writes it."""
    return datetime.datetime.fromtimestamp(math.floor(time_utc_s), datetime.UTC).strftime("%Y-%m-%d")


ALLOWED = {"sqrt": math.sqrt, "degrees": math.degrees, "abs": abs, "len": len, "float": float, "str": str, "day": day}


def was(rule, values):
    """The old value as it follows from the new ones, in doubles, by the rule's expression."""
    if len(values) == 1 and "was" not in rule and "null" not in rule:
        return next(iter(values.values()))
    if any(v is None for v in values.values()):
        return rule.get("null")
    return eval(rule.get("was", "new"), {"__builtins__": {}}, {**ALLOWED, **values})


def near(value, expected, rule):
    """Whether two numbers differ by no more than a rule allows: doubles between them, or `apart` in the old unit."""
    if not (as_number(value) and as_number(expected)):
        return False
    return ulps(value, expected) <= rule.get("ulps", 0) or abs(value - expected) <= rule.get("apart", 0.0)


def moved(rules, case, file, path):
    for key, rule in rules.of("move", case, file):
        found = rule["match"].match(path)
        if found and path[found.end() : found.end() + 1] in ("", ".", "["):
            rules.used.add(key)
            return fill(rule["new"], found.groups()) + path[found.end() :]
    return path


def same_leaf(old, new, rules, case, file):
    """None where two leaves are the same, else the kind of difference."""
    if as_number(old) and as_number(new):
        return None if float(old) == float(new) or (old != old and new != new) else "NUMBERS DIFFER"
    if type(old) is type(new) and old == new:
        return None
    if isinstance(old, str) and isinstance(new, str):
        for key, rule in rules.of("value", case, file):
            if rule["old"] == old and rule["new"] == new:
                rules.used.add(key)
                return "renamed"
        return "words differ" if numbers_and_words(old)[0] == numbers_and_words(new)[0] else "NUMBERS DIFFER"
    return "NUMBERS DIFFER"


def compare_trees(old, new, rules, outcome, file):
    new = Tree(new)
    for path, value in leaves(old):
        where = f"{file}: {path}"
        target = moved(rules, outcome.case, file, path)
        explained = False
        for key, rule in rules.of("rename", outcome.case, file):
            found = rule["match"].fullmatch(target)
            if not found:
                continue
            names = rule["new"] if isinstance(rule["new"], dict) else {"new": rule["new"]}
            paths = {n: fill(t, found.groups()) for n, t in names.items()}
            if not all(new.has(p) for p in paths.values()):
                continue
            rules.used.add(key)
            expected = was(rule, {n: new.get(p) for n, p in paths.items()})
            off = same_leaf(value, expected, rules, outcome.case, file)
            if off is None or off == "renamed":
                outcome.renamed += 1
                outcome.note("renamed")
            elif near(value, expected, rule):
                off_by = ulps(value, expected)
                outcome.ulps += 1
                outcome.note("within ulps")
                if off_by > 2:
                    outcome.wide.append((off_by, abs(value - expected), rule["old"]))
            elif eased := next((k for k, r in rules.of("eased", outcome.case, file) if near(value, expected, r)), None):
                rules.used.add(eased)
                outcome.ulps += 1
                outcome.wide.append((ulps(value, expected), abs(value - expected), rule["old"]))
                outcome.note("explained")
            else:
                outcome.note(off, f"{where}: {value!r} is now {expected!r} (from {paths})")
            explained = True
            break
        if explained:
            continue
        if new.has(target) and (target in new.at or value is None):
            found = new.get(target)
            word = next((k for k, r in rules.of("words", outcome.case, file) if r["match"].fullmatch(target)), None)
            if word and isinstance(value, str) and isinstance(found, str):
                rules.used.add(word)
                outcome.note("renamed")
                continue
            off = same_leaf(value, found, rules, outcome.case, file)
            if target != path:
                outcome.renamed += 1
                outcome.note("renamed")
            if off == "renamed":
                outcome.renamed += 1
                outcome.note("renamed")
            elif off:
                outcome.note(off, f"{where}: {value!r} is now {found!r}")
            continue
        for key, rule in rules.of("dropped", outcome.case, file):
            if rule["match"].fullmatch(target):
                rules.used.add(key)
                outcome.note("renamed")
                explained = True
                break
        if not explained:
            outcome.note("NUMBERS DIFFER", f"{where}: {value!r} is gone")
    for path, value in new.at.items():
        if path in new.taken:
            continue
        for key, rule in rules.of("added", outcome.case, file):
            if rule["match"].fullmatch(path):
                rules.used.add(key)
                outcome.note("renamed")
                break
        else:
            level = "words differ" if value in ([], {}, None) or isinstance(value, (str, bool)) else "NUMBERS DIFFER"
            outcome.note(level, f"{file}: {path}: new, {value!r}")


# ---------------------------------------------------------------- compare: text


def compare_text(old, new, rules, outcome, file):
    if old == new:
        return
    (old_numbers, old_words), (new_numbers, new_words) = numbers_and_words(old), numbers_and_words(new)
    if old_numbers == new_numbers:
        if old_words == new_words:
            outcome.note("words differ", f"{file}: only spaces, lines and rules differ")
            return
        outcome.note("words differ", f"{file}: words")
        outcome.lines += word_lines(old, new)
        return
    minus, plus = [], []
    for op, a, b, c, d in difflib.SequenceMatcher(None, old_numbers, new_numbers, autojunk=False).get_opcodes() if (
        len(old_numbers) + len(new_numbers) < 8000
    ) else plain_opcodes(old_numbers, new_numbers):
        if op != "equal":
            minus += old_numbers[a:b]
            plus += new_numbers[c:d]
    for key, rule in rules.of("explained", outcome.case, file):
        if "minus" in rule and rule["minus"] == minus and rule.get("plus", []) == plus:
            rules.used.add(key)
            outcome.note("explained", f"{file}: {rule['why']}")
            outcome.lines += word_lines(old, new)
            return
    order = "the same in another order" if sorted(old_numbers) == sorted(new_numbers) else ""
    outcome.note(
        "NUMBERS DIFFER",
        f"{file}: minus = {minus[:20]}, plus = {plus[:20]}, {len(minus)} and {len(plus)} of {len(old_numbers)} {order}",
    )
    outcome.lines += word_lines(old, new)


def plain_opcodes(a, b):
    """Common start and end, the rest as one change: for long lists."""
    start = 0
    while start < min(len(a), len(b)) and a[start] == b[start]:
        start += 1
    end = 0
    while end < min(len(a), len(b)) - start and a[-1 - end] == b[-1 - end]:
        end += 1
    if len(a) == len(b):
        return [("replace", i, i + 1, i, i + 1) for i in range(start, len(a) - end) if a[i] != b[i]]
    return [("replace", start, len(a) - end, start, len(b) - end)]


def word_lines(old, new):
    lines = [
        f"    {line[:300]}"
        for line in difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
        if not line.startswith(("---", "+++", "@@"))
    ]
    return lines[:40] + ([f"    … {len(lines) - 40} lines more"] if len(lines) > 40 else [])


def table(text):
    """A CSV as rows by column name, cells as numbers if numeric; None if the text is not CSV."""
    rows = list(csv.reader(io.StringIO(text)))
    if len(rows) < 2 or len(set(rows[0])) < len(rows[0]) or any(len(r) != len(rows[0]) for r in rows):
        return None

    def cell(word):
        try:
            return float(word)
        except ValueError:
            return word

    return [dict(zip(rows[0], map(cell, row))) for row in rows[1:]]


def documents(text):
    """One JSON document, or one per line; None if the text is not JSON."""
    try:
        return json.loads(text)
    except ValueError:
        pass
    try:
        lines = [json.loads(line) for line in text.splitlines()]
        return lines if lines and all(isinstance(line, dict) for line in lines) else None
    except ValueError:
        return None


# ---------------------------------------------------------------- compare: cases


def markup(text):
    """A page with an element a line, and the numbers of its paths apart from their letters."""
    text = re.sub(r' d="[^"]*"', lambda d: re.sub(r"(?<=[A-Za-z])(?=[-.\d])", " ", d.group()), text)
    return html.unescape(re.sub(r">\s*<", ">\n<", text))


def compare_file(old, new, rules, outcome, file):
    if old == new:
        return
    if Path(file).suffix in BINARY:
        for key, rule in rules.of("explained", outcome.case, file):
            if rule.get("bytes"):
                rules.used.add(key)
                outcome.note("explained", f"{file}: {rule['why']}")
                return
        outcome.note("NUMBERS DIFFER", f"{file}: bytes differ ({len(old)} and {len(new)})")
        return
    old, new = old.decode("utf-8", "replace"), new.decode("utf-8", "replace")
    for key, rule in rules.of("normalise", outcome.case, file):
        if rule["match"].search(old):
            rules.used.add(key)
        old, new = (rule["match"].sub(rule["to"], text) for text in (old, new))
    if old == new:
        return
    old_tree, new_tree = documents(old), documents(new)
    if old_tree is None and Path(file).suffix == ".csv" and rules.of("rename", outcome.case, file):
        old_tree, new_tree = table(old), table(new)
    if isinstance(old_tree, (dict, list)) and isinstance(new_tree, (dict, list)):
        for _, rule in rules.of("sort", outcome.case, file):
            for tree in (old_tree, new_tree):
                tree.sort(key=lambda d: [d.get(k, "") for k in rule["by"]] if rule["by"][0] in d else [])
        compare_trees(old_tree, new_tree, rules, outcome, file)
    else:
        if file.endswith((".html", ".svg")):
            old, new = map(markup, (old, new))
        compare_text(old, new, rules, outcome, file)


def files_of(folder):
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and p != folder / "arguments"
    }


def compare_case(case, before, after, rules):
    outcome = Outcome(case)
    old, new = files_of(before / case), files_of(after / case)
    for key, rule in rules.of("explained", case, "case"):
        if rule.get("whole") == [int(old["exit"]), int(new["exit"])] and not any(b"panicked at" in t for t in new.values()):
            rules.used.add(key)
            outcome.note("explained", rule["why"])
            return outcome
    for key, rule in rules.of("explained", case, "path"):
        if "old_path" in rule and rule["old_path"] in old and rule["new_path"] in new:
            rules.used.add(key)
            old[rule["new_path"]] = old.pop(rule["old_path"])
            outcome.note("explained", f"{rule['old_path']} is {rule['new_path']}: {rule['why']}")
    for file in sorted(set(old) | set(new)):
        if file not in new or file not in old:
            key, why = next(((k, r["why"]) for k, r in rules.of("explained", case, file) if r.get("present")), (None, None))
            rules.used.add(key)
            outcome.note("explained" if why else "NUMBERS DIFFER", f"{file}: only {'before' if file in old else 'after'} {why or ''}")
        elif file == "exit" and old[file] != new[file]:
            codes = [int(old[file]), int(new[file])]
            key, why = next(((k, r["why"]) for k, r in rules.of("explained", case, file) if r.get("exit") == codes), (None, None))
            rules.used.add(key)
            outcome.note("explained" if why else "NUMBERS DIFFER", f"exit code {codes[0]} is now {codes[1]} {why or ''}")
        else:
            compare_file(old[file], new[file], rules, outcome, file)
        if b"panicked at" in new.get(file, b""):
            outcome.note("NUMBERS DIFFER", f"{file}: a panic")
    return outcome


def case_names(folder):
    return {f"{e.parent.parent.name}/{e.parent.name}" for e in folder.glob("*/*/exit")}


def compare(arguments):
    rules = Rules(arguments.rules)
    before, after = case_names(arguments.before), case_names(arguments.after)
    outcomes = [compare_case(c, arguments.before, arguments.after, rules) for c in sorted(before & after)]
    by_level = {level: [o for o in outcomes if Outcome.ORDER[o.level] == level] for level in Outcome.ORDER}
    lines = []
    for outcome in outcomes:
        if outcome.level:
            lines.append(f"{outcome.case}: {Outcome.ORDER[outcome.level]}")
            shown = outcome.lines if arguments.all else outcome.lines[:60]
            lines += [f"  {line}" for line in shown]
            if len(shown) < len(outcome.lines):
                lines.append(f"  … {len(outcome.lines) - len(shown)} more")
    inputs = [json.loads((f / "inputs.json").read_text()) for f in (arguments.before, arguments.after)]
    changed = sorted(p for p in set(inputs[0]) & set(inputs[1]) if inputs[0][p] != inputs[1][p])
    only = sorted(set(inputs[0]) ^ set(inputs[1]))
    summary = [f"{len(outcomes)} cases in both"]
    summary += [f"  {level}: {len(found)}" for level, found in by_level.items()]
    summary.append(f"  values renamed: {sum(o.renamed for o in outcomes)}, within ulps: {sum(o.ulps for o in outcomes)}")
    wide = {}
    for off_by, difference, rule in (w for o in outcomes for w in o.wide):
        n, worst, most = wide.get(rule, (0, 0, 0.0))
        wide[rule] = (n + 1, max(worst, off_by), max(most, difference))
    summary += [
        f"  beyond 2 ulps: {rule}: {n} values, at most {worst} ulps, {most:.1e}" for rule, (n, worst, most) in sorted(wide.items())
    ]
    for title, names in (
        ("only before", sorted(before - after)),
        ("only after", sorted(after - before)),
        ("inputs that differ", changed),
        ("inputs on one side", only),
        ("NUMBERS DIFFER in", [o.case for o in by_level["NUMBERS DIFFER"]]),
    ):
        if names:
            summary.append(f"  {title}: {' '.join(names)}")
    everything = [(kind, i) for kind in ("move", "rename", "added", "dropped", "value", "words", "explained", "eased") for i in range(len(getattr(rules, kind)))]
    unused = [f"{kind} {i + 1}" for kind, i in everything if (kind, i) not in rules.used]
    if unused:
        summary.append(f"  rules that met nothing: {', '.join(unused)}")
    text = "\n".join(lines + [""] + summary)
    if arguments.report:
        arguments.report.write_text(text + "\n")
        print("\n".join(summary))
    else:
        print(text)
    return 1 if by_level["NUMBERS DIFFER"] or before - after else 0
