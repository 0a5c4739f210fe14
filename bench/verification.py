#!/usr/bin/env python3
"""Runs the verification suites and writes what they found.

Usage: bench/verification.py BUILD OUT [--long] [--only ID...]

Every test program of the build folder BUILD that names a case of bench/verification_cases.csv (in its first
lines or in the name of a test case: "A2.5", "B16") is run, and every assertion it makes is read: what was expected,
what was found, and the values printed beside it. OUT gets

  verification.md    a row per case: its tests, how many assertions, the verdict, the time, the closest call
  verification.csv   a row per assertion: case, test, policies, expression, values, how often, verdict, seconds

Exit status 1 if an assertion failed or a case has neither test nor note.
"""
import argparse
import concurrent.futures
import csv
import dataclasses
import os
import pathlib
import platform
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parent.parent
CASE = re.compile(r"\b[AB]\d+(?:\.\d+)?\b")
RANGE = re.compile(r"\b([AB])(\d+\.)?(\d+)-(?:[AB])?(?:\d+\.)?(\d+)\b")
NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|inf|nan)f?"
COMPARISON = re.compile(rf"^{NUMBER} (<=?|>=?) {NUMBER}$")
APPROXIMATE = re.compile(rf"^{NUMBER} == Approx\( {NUMBER} \)$")
WITHIN = re.compile(rf"^{NUMBER} is within {NUMBER} of {NUMBER}$")
WITHIN_PERCENT = re.compile(rf"^{NUMBER} and {NUMBER} are within {NUMBER}% of each other$")
LAW = re.compile(rf": {NUMBER}, allowed {NUMBER}$")


def cases_in(text):
    """Ids that a text names; "B22-B24" and "A3.1-A3.3" name all between."""
    found = set(CASE.findall(text))
    for letter, chapter, first, last in RANGE.findall(text):
        found |= {f"{letter}{chapter}{n}" for n in range(int(first), int(last) + 1)}
    return found


@dataclasses.dataclass
class Check:
    """One assertion of a test case, however often it was made."""

    cases: list
    program: str
    test: str
    place: str
    expression: str
    values: str = ""
    beside: str = ""
    margin: float = float("inf")
    distance: float = 0.0
    times: int = 0
    failed: int = 0

    def take(self, values, beside, good):
        self.times += 1
        self.failed += not good
        margin, distance = margin_of(values, beside), distance_of(values)
        closer = margin < self.margin or distance > self.distance
        if self.times == 1 or not good or (closer and not self.failed):
            self.values, self.beside, self.margin, self.distance = values, beside, margin, distance


def margin_of(values, beside):
    """How much of what was allowed is left, as a share: 1 nothing used, 0 the limit itself, infinity if that is unknown."""
    if (m := WITHIN.match(values)) is not None:
        used, allowed = abs(float(m[1]) - float(m[3])), float(m[2])
    elif (m := WITHIN_PERCENT.match(values)) is not None:
        used, allowed = abs(float(m[1]) / float(m[2]) - 1), float(m[3]) / 100
    elif values == "true" and (m := LAW.search(beside)) is not None:
        used, allowed = float(m[1]), float(m[2])
    elif (m := COMPARISON.match(values)) is not None:
        used, allowed = (float(m[1]), float(m[3])) if m[2][0] == "<" else (float(m[3]), float(m[1]))
    else:
        return float("inf")
    return 1 - used / allowed if 0 <= used and 0 < allowed < float("inf") else float("inf")


def distance_of(values):
    """How far apart two numbers are that should be approximately equal, relative."""
    if (m := APPROXIMATE.match(values)) is None or float(m[2]) == 0:
        return 0.0
    return abs(float(m[1]) / float(m[2]) - 1)


def text_of(element, name):
    found = element.find(name)
    return "" if found is None or found.text is None else " ".join(found.text.split())


def header_of(source):
    """The comment that a source begins with."""
    lines = []
    for line in source.read_text().splitlines():
        if not line.startswith("//"):
            break
        lines.append(line[2:])
    return " ".join(lines)


@dataclasses.dataclass
class Program:
    name: str  # folder/stem
    path: pathlib.Path
    source: pathlib.Path
    cases: set
    checks: list = dataclasses.field(default_factory=list)
    seconds: dict = dataclasses.field(default_factory=dict)  # by test case
    status: int = 0

    def runs_on_device(self):
        """Whether the same source is run on a GPU, too (tests/device/CMakeLists.txt)."""
        return re.search("^// on a device$", self.source.read_text(), re.MULTILINE) is not None

    def run(self):
        """Reads the report as it comes: a suite may make a million assertions."""
        kept, infos, test, tags = {}, [], "", ""
        with subprocess.Popen([self.path, "-r", "xml", "-s", "-d", "yes"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, cwd=ROOT) as process:
            for event, e in xml.iterparse(process.stdout, events=("start", "end")):
                if event == "start":
                    if e.tag == "TestCase":
                        test, tags = e.get("name"), e.get("tags", "")
                    continue
                if e.tag == "Info":
                    infos.append(" ".join((e.text or "").split()))
                elif e.tag == "Expression":
                    self.take(kept, test, tags, e, infos)
                    infos = []
                elif e.tag == "OverallResult":
                    self.seconds[test] = float(e.get("durationInSeconds", 0))
                elif e.tag != "TestCase":
                    continue
                e.clear()
            self.status = process.wait()
        self.checks = list(kept.values())
        return self

    def take(self, kept, test, tags, e, infos):
        key = test, e.get("line"), text_of(e, "Original")
        if key not in kept:
            cases = cases_in(f"{test} {tags}") or self.cases
            kept[key] = Check(sorted(cases), self.name, test,
                              f"{pathlib.Path(e.get('filename')).name}:{e.get('line')}", key[2])
        good = e.get("success") == "true"
        kept[key].take(text_of(e, "Expanded"), "; ".join(infos), good)


def programs(build, known, with_long):
    """Test programs of a build folder whose source names a case."""
    for source in sorted((ROOT / "tests").glob("*/*.cpp")):
        folder, stem = source.parent.name, source.stem
        path = build / "tests" / f"test_{folder}_{stem}"
        if not path.exists() or (stem.endswith("_long") and not with_long):
            continue
        header = cases_in(header_of(source)) & known
        titles = " ".join(re.findall(r'"([^"]*)"', source.read_text()))
        if header or cases_in(titles) & known:
            yield Program(f"{folder}/{stem}", path, source, header)


def expected_seconds(source):
    """What the file says about its time ("// seconds: 40"), as ctest is told too."""
    hint = re.search(r"^// seconds: (\d+)", source.read_text(), re.MULTILINE)
    return int(hint.group(1)) if hint else 0


def read_cases():
    with (ROOT / "bench" / "verification_cases.csv").open(newline="") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def shown(check):
    """An assertion as a reader wants it: values against the limit; a law by its text."""
    values = check.beside if check.values == "true" and LAW.search(check.beside) else check.values
    text = values if len(values) < 90 else values[:87] + "..."
    return f"`{check.expression}`: {text}".replace("|", "\\|")


def write_csv(path, all_programs):
    with path.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["case", "program", "test", "place", "expected", "found", "beside it", "margin", "times",
                      "failed", "seconds of the test"])
        for program in all_programs:
            for c in program.checks:
                margin = "" if c.margin == float("inf") else f"{c.margin:.3g}"
                out.writerow([" ".join(c.cases), c.program, c.test, c.place, c.expression, c.values, c.beside, margin,
                              c.times, c.failed, f"{program.seconds.get(c.test, 0):.2f}"])


def row_of(case, all_programs):
    """The line of a case in the table, and whether it holds."""
    checks = [c for p in all_programs for c in p.checks if case["id"] in c.cases]
    if not checks:
        verdict = case["note"] or "**no test**"
        return f"| {case['id']} | {case['case']} | | | | {verdict} | | |", bool(case["note"])
    tests = sorted({c.program for c in checks})
    seconds = sum(p.seconds.get(t, 0) for p in all_programs
                  for t in {c.test for c in checks if c.program == p.name})
    failed = [c for c in checks if c.failed]
    closest = min(failed or checks, key=lambda c: (c.margin, -c.distance))
    told = shown(closest) if failed or closest.margin < float("inf") or closest.distance > 0 else ""
    verdict = "holds" if not failed else f"**{len(failed)} fail**"
    if case["note"]:
        verdict += f"; {case['note']}"
    made = sum(c.times for c in checks)
    device = "yes" if any(p.runs_on_device() for p in all_programs if p.name in tests) else ""
    return (f"| {case['id']} | {case['case']} | {', '.join(f'`{t}`' for t in tests)} | {device} | {made} | {verdict} | "
            f"{seconds:.1f} | {told} |"), not failed


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def write_page(path, cases, all_programs, command):
    rows = [row_of(case, all_programs) for case in cases.values()]
    held = sum(good for _, good in rows)
    machine = f"{platform.machine()}, {os.cpu_count()} cores"
    lines = [
        "# Verification",
        "",
        "Every case of the specification and what the suites found: A are exact answers, B hard cases. Written by",
        f"`{command}` at {git('rev-parse', '--short', 'HEAD')}, {time.strftime('%Y-%m-%d')}, {machine}, release, serial and",
        "threads on the CPU. Seconds are those of the tests, other work may have run beside them.",
        "",
        "The closest call is the comparison that used most of what it is allowed. All of them, with the values printed",
        "beside each, are in [verification.csv](verification.csv). Device: whether a source of these tests is run on a GPU too, with the",
        "same scenes ([what it found](device.md)).",
        "",
        f"{held} of {len(rows)} rows hold or say why they are not built;"
        f" {sum(c.times for p in all_programs for c in p.checks)} assertions.",
        "",
        "| | case | tests | device | assertions | verdict | s | closest call |",
        "|---|---|---|---|---|---|---|---|",
        *[line for line, _ in rows],
        "",
    ]
    path.write_text("\n".join(lines))
    return all(good for _, good in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="folder of a build with tests")
    parser.add_argument("out", type=pathlib.Path, help="folder for page and table")
    parser.add_argument("--long", action="store_true", help="the tier `long` too (hours)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="programs at a time")
    parser.add_argument("--only", nargs="+", metavar="ID", help="cases to run")
    options = parser.parse_args()
    cases = read_cases()
    if options.only:
        cases = {i: cases[i] for i in options.only}
    found = list(programs(options.build.resolve(), set(cases), options.long))
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        longest_first = sorted(found, key=lambda p: -expected_seconds(p.source))
        for program in pool.map(Program.run, longest_first):
            verdict = "passed" if program.status == 0 else "FAILED"
            print(f"{program.name}: {sum(program.seconds.values()):.1f} s, {verdict}", flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    write_csv(options.out / "verification.csv", found)
    good = write_page(options.out / "verification.md", cases, found, "scripts/verification.sh")
    return 0 if good and all(p.status == 0 for p in found) else 1


if __name__ == "__main__":
    sys.exit(main())
