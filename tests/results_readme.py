#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The README's figures of the closed loops against the tables in tests/results/. Called by results_readme.sh.

usage: tests/results_readme.py [--plant]

Prints what differs, one line each, and exits 1 if anything does. Read are the three tables of "Closed loops" and the
sentences named below. --plant changes every figure of the three tables, one at a time, and prints those whose change is
not noticed.
"""
import re
import sys

NUMBER = r"\d+(?:,\d{3})*(?:\.\d+)?"
WORDS = {"no": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6}
FAULTS = 6
SUITES = ["fmvss127", "fmvss127-drawn", "ncap-ccr", "ncap-ccr-drawn", "false-activation", "false-activation-drawn",
          "fmvss127-6", "fmvss127-6-drawn", "false-activation-6-drawn", "toyota-fmvss127-drawn",
          "toyota-false-activation-drawn", "degraded", "degraded-drawn"]
COMPARISONS = ["compare-fmvss127", "compare-false-activation"]


class Result:
    """A file of tests/results/: its command, its rows, its sums."""

    def __init__(self, name):
        with open(f"tests/results/{name}.txt", encoding="utf-8") as f:
            text = f.read()
        self.lines = text.splitlines()
        self.hash = re.search(r"configuration ([0-9a-f]{16})[;\n]", text)[1]
        cars = re.search(r"--vehicles (\d+)", self.lines[0])
        self.cars = int(cars[1]) if cars else 1
        if name in COMPARISONS:
            rules = re.findall(r"^(\S+) +(\d+) +(\d+) +([\d.]+) +[\d.]+ +(\d+)   ", text, re.M)
            self.rule = {r[0]: [float(f) for f in r[1:]] for r in rules}
            self.runs = sum(r[0] for r in self.rule.values())
            return
        shares = re.findall(r"^(\d+) of (\d+) with a goal.* missed it: 95 % interval (\S+) \.\. (\S+) %$", text, re.M)
        self.failed, self.judged, _, self.hi = map(float, shares[0])
        runs = re.search(r"^(\d+) runs, (\d+) with contact, \d+ with a request(?:, (\d+) with an evaluation)?$", text, re.M)
        self.runs, self.contacts = int(runs[1]), int(runs[2])
        self.counts = [float(f) for f in runs.groups() if f] + [float(f) for share in shares for f in share[:2]]
        self.bounds = [float(f) for share in shares for f in share[2:]]
        lead = re.search(r"before them: (\d+); warning before request: median +(\S+) s, least +(\S+) s", text)
        self.unwarned, self.median, self.least = int(lead[1]), float(lead[2]), float(lead[3])

    def request(self, row):
        """Request, its 99 % and the physical limit of a row of drawn cars."""
        return [float(c) for line in self.lines if line.startswith(row + " ") for c in line.split()[4:7]]

    def missed(self):
        """The rows that missed their goals."""
        return [line.split()[0] for line in self.lines if re.search(r"  (CONTACT|REQUEST)\b", line)]


def same(said, figure):
    """A figure as the README has it, rounded to as many digits."""
    said = said.replace(",", "")
    return abs(round(figure, len(said.partition(".")[2])) - float(said)) < 1e-9


def differ(said, figures):
    return [f"{s} instead of {f:g}" for s, f in zip(said, figures) if not same(s, f)]


class Check:
    """The section, what it is held against, and what differs."""

    def __init__(self, section, result):
        self.section, self.result, self.wrong = section, result, []
        self.flat = " ".join(section.split())

    def note(self, what, wrong):
        self.wrong += [f"{what}: {w}" for w in wrong]

    def row(self, first):
        """The first cell of the table row that begins like this, and the others."""
        m = re.search(rf"^\| ({first}[^|]*)\|(.*)\|$", self.section, re.M)
        self.note(first, [] if m else ["no such row"])
        return m.groups() if m else ("", "")

    def suites(self, first, **wanted):
        """These figures of these results are there, bounds in the last cell, and no figure that is not one of theirs."""
        results = [self.result[n.replace("_", "-")] for n in wanted]
        head, rest = self.row(first)
        left, _, last = re.sub(r"\d+ km/h", "", rest).rpartition("|")
        counts, bounds = re.findall(NUMBER, left), re.findall(NUMBER, last)
        for r, fields in zip(results, wanted.values()):
            for field in fields.split():
                said = bounds if field == "hi" else counts
                found = [s for s in said if same(s, getattr(r, field))][:1]
                self.note(first, [] if found else [f"no {field} of {getattr(r, field):g}"])
                for s in found:
                    said.remove(s)
        for said, figures in ((counts, [f for r in results for f in r.counts]), (bounds, [f for r in results for f in r.bounds])):
            self.note(first, [f"{s} is none of its figures" for s in said if not any(same(s, f) for f in figures)])
        cars = [int(c) for c in re.findall(r"--vehicles (\d+)", head)]
        self.note(first, [f"{c} cars instead of {[r.cars for r in results]}" for c in cars
                          if c not in [r.cars for r in results]])

    def sentence(self, pattern, *figures):
        """A sentence with these figures, N standing for one."""
        m = re.search(pattern.replace("N", f"({NUMBER})"), self.flat)
        self.note(pattern, differ(m.groups(), figures) if m else ["no such sentence"])

    def table_of_suites(self):
        self.suites("`aebmc scenario fmvss127` ", fmvss127="runs contacts")
        self.suites("`aebmc scenario fmvss127 --vehicles", fmvss127_drawn="runs contacts hi")
        self.suites("`aebmc scenario ncap-ccr`", ncap_ccr="judged failed hi", ncap_ccr_drawn="judged failed hi")
        self.suites("`aebmc scenario false-activation` ", false_activation="judged failed hi")
        self.suites("`aebmc scenario false-activation --vehicles", false_activation_drawn="judged failed hi")
        self.suites("`aebmc scenario fmvss127 --set brake.accel=-6`",
                    fmvss127_6="runs contacts hi", fmvss127_6_drawn="runs contacts hi")
        self.suites("`aebmc scenario false-activation --set brake.accel=-6", false_activation_6_drawn="judged failed hi")
        self.suites("the same suites through toyota-tss-p.conf",
                    toyota_fmvss127_drawn="judged failed hi", toyota_false_activation_drawn="judged failed hi")

    def sentences(self):
        one, drawn = self.result["fmvss127"], self.result["fmvss127-drawn"]
        weak, all_runs = self.result["false-activation-6-drawn"], sum(r.runs for r in self.result.values())
        overtakes = [line.split()[0] for line in weak.lines if line.startswith("overtake")]

        self.sentence(r"for N runs\)", round(all_runs, -3))
        self.sentence("before every request of fmvss127: median N s, least N s; with drawn cars N and N s",
                      one.median, one.least, drawn.median, drawn.least)
        self.note("before every request", [f"{r.unwarned} without" for r in (one, drawn) if r.unwarned])
        self.sentence("N of those N runs are braked for without need", weak.failed, weak.judged)
        self.sentence("of the N that overtake .* of the N that follow", len(overtakes) * weak.cars, weak.cars)
        self.note("those that overtake or follow", [r for r in weak.missed() if r not in overtakes + ["downhill-80-15m"]])
        for what, name in (("generic-objects.conf: hash", "fmvss127"), ("no request, hash", "toyota-fmvss127-drawn")):
            self.note(what, [] if f"{what} {self.result[name].hash}" in self.flat else [self.result[name].hash])

    def table_of_requests(self):
        drawn, weak = self.result["fmvss127-drawn"], self.result["fmvss127-6-drawn"]
        pair = rf"({NUMBER}) / ({NUMBER}) \| ({NUMBER}) \|"
        rows = re.findall(rf"^\| (\d+), (\d+) m, ([\d.]+) g \| {pair} {pair}$", self.section, re.M)

        self.sentence("p50 / p99 of N drawn cars", drawn.cars)
        self.note("rows of requests", [] if len(rows) >= 5 else [f"{len(rows)}"])
        for kmh, gap_m, g, *said in rows:
            row = f"brake-{kmh}-{gap_m}m-{g}g-ramp"
            figures = drawn.request(row) + weak.request(row)
            self.note(row, differ(said, figures) if len(figures) == 6 else ["no such row"])

    def faults(self):
        one, drawn = self.result["degraded"], self.result["degraded-drawn"]
        m = re.search(rf"With ({NUMBER}) drawn cars each \(({NUMBER}) runs\): (\w+) contacts?\b", self.flat)

        self.sentence("degraded`, N rows of both suites each", one.runs / FAULTS)
        self.note("no contact and no request in any row",
                  one.missed() if "no contact and no request in any row" in self.flat else ["no such sentence"])
        self.note("degraded with drawn cars", differ([m[1], m[2], str(WORDS.get(m[3], m[3]))],
                                                     [drawn.cars, drawn.judged, drawn.contacts])
                  if m else ["no such sentence"])

    def table_of_rules(self):
        braking, calm = (self.result[n].rule for n in COMPARISONS)

        self.sentence(r"\| rule \| fmvss127, N runs: .* false-activation, N runs: early", braking["aebmc"][0],
                      calm["aebmc"][0])
        for first, rule in (("time to collision", "ttc"), ("Autoware", "autoware"), ("RSS", "ad-rss"),
                            ("the paper alone", "paper"), ("aebmc ", "aebmc")):
            said = re.findall(NUMBER, self.row(first)[1])
            _, contacts, impact, early = braking[rule]
            figures = [contacts] + [impact] * (contacts > 0) + [early, calm[rule][3]]
            self.note(first, differ(said, figures) if len(said) == len(figures) else [f"{len(said)} figures"])


def check(section, result):
    c = Check(section, result)
    c.table_of_suites()
    c.sentences()
    c.table_of_requests()
    c.faults()
    c.table_of_rules()
    return c.wrong


def plant(section, result):
    """The figures of the tables' cells, but the first, whose last digit may be another without anything to say."""
    unseen = []
    for line in re.finditer(r"^\| [^|\n]*\|(.*\d.*)\|$(?!\n\|---)", section, re.M):
        for m in re.finditer(rf"(?<![\w.-]){NUMBER}(?!\d| km/h)", line[1]):
            at = line.start(1) + m.end() - 1
            changed = section[:at] + str((int(section[at]) + 1) % 10) + section[at + 1:]
            unseen += [] if check(changed, result) else [f"{m[0]} in {line[0]}"]
    return unseen


def main():
    with open("README.md", encoding="utf-8") as f:
        section = f.read().partition("\n## Closed loops\n")[2].partition("\n## ")[0]
    result = {name: Result(name) for name in SUITES + COMPARISONS}
    lines = (plant if sys.argv[1:] == ["--plant"] else check)(section, result)
    print("\n".join(lines))
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
