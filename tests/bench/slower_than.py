# SPDX-License-Identifier: AGPL-3.0-or-later
"""Fails if a build is slower than another one.

    slower_than.py NEW OLD [--filter REGEX] [--rounds 3] [--most 1.2]
    slower_than.py NEW --commit REF ...     OLD is that commit, which is built first, beside NEW

NEW and OLD are build folders on one machine. Both run the same benchmarks by turns, NEW first in one round and OLD first
in the next, so that load and clock speed touch both alike. Of each benchmark the shortest time of all rounds counts. What
is more than --most times slower runs twice as many rounds again before it fails. Peers and references are left out: they
are the same code in both. Exit status: 0, 1 where something is slower, 2 for wrong usage.
"""
import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OTHERS = re.compile(r"^(peer|reference)/")


def bench(folder, *options):
    return subprocess.run([str(folder / "octotomy-bench"), *options], check=True, capture_output=True, text=True).stdout


def names(folder):
    return {name for name in bench(folder, "--benchmark_list_tests=true").splitlines() if not OTHERS.match(name)}


def times_of(folder, name):
    """Nanoseconds of wall time; none where the benchmark was skipped."""
    found = json.loads(bench(folder, f"--benchmark_filter=^{re.escape(name)}$", "--benchmark_format=json",
                             "--benchmark_min_time=0.2"))["benchmarks"]
    scale = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
    return [run["real_time"] * scale[run["time_unit"]] for run in found if not run.get("error_occurred")]


def compared(new, old, name, rounds, best):
    """Lowers the best times of a benchmark, and returns how many times slower the new build is."""
    for round_number in range(rounds):
        for folder in (new, old) if round_number % 2 == 0 else (old, new):
            for nanoseconds in times_of(folder, name):
                best[folder] = min(best.get(folder, nanoseconds), nanoseconds)
    return best[new] / best[old] if len(best) == 2 else None


def build_of(commit, new):
    """A build of a commit with the options of the new build, kept beside it for the next run."""
    commit = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "--verify", f"{commit}^{{commit}}"], check=True,
                            capture_output=True, text=True).stdout.strip()
    source, build = (new.parent / f"{commit[:12]}-{what}" for what in ("source", "build"))
    source.mkdir(exist_ok=True)
    archive = subprocess.run(["git", "-C", str(ROOT), "archive", commit], check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x", "-C", str(source)], check=True, input=archive)
    kept = re.findall(r"^((?:OCTOTOMY_|CMAKE_BUILD_TYPE|CMAKE_CXX_COMPILER:)[^=]*=.*)$", (new / "CMakeCache.txt").read_text(),
                      re.MULTILINE)
    subprocess.run(["cmake", "-C", str(source / ".cmake" / "release.cmake"), "-S", str(source), "-B", str(build), "-G",
                    "Ninja", *(f"-D{option}" for option in kept if ":INTERNAL" not in option)], check=True)
    subprocess.run(["ninja", "-C", str(build), "octotomy", "octotomy-bench"], check=True)
    return build


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("new", type=Path)
    parser.add_argument("old", type=Path, nargs="?")
    parser.add_argument("--commit", help="build this commit and compare with it")
    parser.add_argument("--filter", default="", help="only benchmarks whose name this regular expression finds")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--most", type=float, default=1.2)
    given = parser.parse_args()
    if (given.old is None) == (given.commit is None):
        parser.error("name one other build: its folder, or --commit REF")
    new = given.new.resolve()
    old = build_of(given.commit, new) if given.commit else given.old.resolve()
    in_new, in_old = names(new), names(old)
    chosen = sorted(name for name in in_new & in_old if re.search(given.filter, name))
    if not chosen:
        parser.error(f"no benchmark of both builds has a name with '{given.filter}'")
    slower = []
    for name in chosen:
        best = {}
        ratio = compared(new, old, name, given.rounds, best)
        if ratio and ratio > given.most:
            ratio = compared(new, old, name, 2 * given.rounds, best)
        if ratio is None:
            print(f"{name}: not measured, as it was skipped", flush=True)
            continue
        print(f"{ratio:6.2f}  {best[old] / 1e6:10.3f} ms -> {best[new] / 1e6:10.3f} ms  {name}", flush=True)
        if ratio > given.most:
            slower.append(name)
    for name in sorted(in_old - in_new):
        print(f"not in the new build: {name}")
    print(f"{len(chosen)} compared, {len(slower)} over {given.most:g} times slower")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
