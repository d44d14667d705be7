#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Ends verbs at random instants and looks at what is left.

Each verb runs again and again over an older answer, or where there is none, and is ended somewhere between its first
and last moment: by SIGKILL, by SIGTERM, SIGINT, SIGHUP or SIGXCPU, or by --time-limit. Afterwards the older answer
or the newer one is there, whole, with every file of somebody else; no process that it started lives on; except after
SIGKILL nothing unfinished is left, and after SIGKILL the next run removes it.

  tests/attack/kill_suite.py build/release --count 1000
"""
import argparse
import json
import random
import shutil
import signal
import sys
from collections import Counter

from subject import Subject, broken_list

SIGNALS = {"kill": signal.SIGKILL, "term": signal.SIGTERM, "int": signal.SIGINT, "hup": signal.SIGHUP,
           "xcpu": signal.SIGXCPU}
ENDINGS = (*SIGNALS, "limit")


class Verb:
    """A command line, and the older answer that stands where it writes."""

    def __init__(self, name, arguments, out, over_older=True):
        self.name, self.arguments, self.out, self.over_older = name, arguments, out, over_older
        self.seconds, self.newer = 0.0, None

    def lay_older(self, subject):
        path = subject.folder / self.out
        if not self.over_older:
            shutil.rmtree(path, ignore_errors=True)
        elif self.is_folder:
            if not path.exists():
                subject.need(*self.arguments)
                (path / "mine.frd").write_text("mine")
                (path / "views").mkdir(exist_ok=True)
                (path / "views/mine.png").write_text("mine")
        else:
            path.write_text("older")

    @property
    def is_folder(self):
        return "." not in self.out

    def broken(self, subject, killed=False):
        """Why neither the older nor the newer answer is there. A killed look may leave its first pictures, whole."""
        path = subject.folder / self.out
        if not self.over_older:
            if not path.exists():
                return ""
            if not killed and not json.loads((path / "result.json").read_text())["certificates"]:
                return "a result without certificates was left"
            return broken_list(path)
        if self.is_folder:
            for mine in ("mine.frd", "views/mine.png"):
                if not (path / mine).is_file() or (path / mine).read_text() != "mine":
                    return f"{mine} of the user is gone"
            return broken_list(path)
        content = path.read_bytes() if path.exists() else b""
        return "" if content in (b"older", self.newer) else f"{self.out} has {len(content)} other bytes"

    def learn(self, subject):
        ended = subject.need(*self.arguments)
        self.seconds = ended.seconds
        if not self.is_folder:
            self.newer = (subject.folder / self.out).read_bytes()


VERBS = (
    Verb("run", ("run", "plan.json", "-o", "result"), "result"),
    Verb("look", ("look", "head.nrrd", "-o", "looked"), "looked"),
    Verb("look_new", ("look", "head.nrrd", "-o", "seen"), "seen", over_older=False),
    Verb("tet", ("tet", "ball.stl", "-o", "ball.inp"), "ball.inp"),
    Verb("convert", ("convert", "head.nrrd", "-o", "head.nii.gz"), "head.nii.gz"),
    Verb("mesh", ("mesh", "head.nrrd", "--window", "300:", "-o", "made.stl"), "made.stl"),
)


def end_once(subject, verb, ending, delay_s):
    arguments = list(verb.arguments)
    if ending == "limit":
        return subject.run(*arguments, "--time-limit", f"{max(delay_s, 0.001):.4f}", most_s=60.0)
    return subject.run(*arguments, after=delay_s, stop=SIGNALS[ending], most_s=60.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="the build folder that holds octotomy")
    parser.add_argument("--count", type=int, default=1000, help="endings a verb and kind (default 1000)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--verbs", default=",".join(verb.name for verb in VERBS))
    parser.add_argument("--endings", default="kill,term,hup,limit", help=f"of {', '.join(ENDINGS)}")
    parser.add_argument("--within", type=float, default=2.0,
                        help="seconds from a signal to the end; the promise is 0.3 on a quiet machine")
    asked = parser.parse_args()
    faults = 0
    with Subject(asked.build) as subject:
        for verb in VERBS:
            if verb.name not in asked.verbs.split(","):
                continue
            verb.lay_older(subject)
            verb.learn(subject)
            for ending in asked.endings.split(","):
                faults += judge(subject, verb, ending, asked)
    print(f"{faults} faults")
    return 1 if faults else 0


def judge(subject, verb, ending, asked):
    chance = random.Random(f"{asked.seed} {verb.name} {ending}")
    statuses, slowest, found, unfinished = Counter(), 0.0, [], 0
    for number in range(asked.count):
        verb.lay_older(subject)
        delay_s = chance.uniform(0.0, 1.05 * verb.seconds)
        ended = end_once(subject, verb, ending, delay_s)
        statuses[ended.status] += 1
        late = ended.after_signal if ending != "limit" else max(0.0, ended.seconds - delay_s)
        slowest = max(slowest, late or 0.0)
        why = verb.broken(subject, ending == "kill")
        if left := subject.children_left():
            why = why or f"processes {left} live on"
        hidden = subject.hidden_left()
        unfinished += bool(hidden)
        if ending != "kill":
            if hidden:
                why = why or f"left {hidden}"
            # A signal within the first milliseconds, before main(), ends any process.
            if ended.status not in (0, 3, -SIGNALS.get(ending, signal.SIGTERM)):
                why = why or str(ended)
            if (late or 0.0) > asked.within:
                why = why or f"ended {late:.2f} s late"
        if why:
            found.append(f"  number {number}, after {delay_s:.4f} s: {why}")
    if ending == "kill":
        # The next run finds what the killed ones left.
        subject.need(*verb.arguments)
        if hidden := subject.hidden_left():
            found.append(f"  the next run leaves {hidden}")
    print(f"{verb.name:8} {ending:5} {asked.count:5} times in {verb.seconds:5.2f} s: {len(found)} faults, statuses "
          f"{dict(sorted(statuses.items()))}, slowest end {1000 * slowest:.0f} ms, unfinished left {unfinished}",
          flush=True)
    print("\n".join(found[:10]), end="\n" if found else "", flush=True)
    return len(found)


if __name__ == "__main__":
    sys.exit(main())
