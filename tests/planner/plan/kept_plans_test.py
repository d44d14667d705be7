# SPDX-License-Identifier: AGPL-3.0-or-later
"""Plans of earlier releases, below tests/golden/plans/RELEASE/, replayed by this program. Each number is within the
interval that the release stated, or tests/golden/plans/differences.json names the difference and its cause.

    python3 kept_plans_test.py keep RELEASE NAME PLAN

adds a plan with the numbers of this program; PLAN may name head.nrrd and leg.nrrd, phantoms of 2 mm."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
PLANS = Path(__file__).parents[3] / "tests/golden/plans"
EXACT = 1e-9  # of a number that depends on the plan alone


def run(*words):
    answer = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=600)
    if answer.returncode not in (0, 1):
        raise RuntimeError(f"{words}: status {answer.returncode}: {answer.stderr.strip()}")


def numbers_of(result):
    """{place: [value, half width of its interval]} and {place: [verdict]}."""
    numbers = {}
    for certificate in result["certificates"]:
        where = f"certificates / {certificate['object']}"
        numbers[f"{where} / verdict"] = [certificate["verdict"]]
        for kernel in ("voxel", "mesh"):
            answer = certificate[kernel]
            numbers[f"{where} / {kernel} / volume_mm3"] = [answer["volume_mm3"], certificate["tolerance_mm3"]]
            for axis, at in zip("xyz", answer["centroid_mm"] or []):
                numbers[f"{where} / {kernel} / centroid {axis}"] = [at, certificate["centroid_tolerance_mm"]]
    for measurement in result["measurements"]:
        for key, value in measurement.items():
            half_width = measurement.get(key.replace("_mm", "_half_width_mm"))
            if key.endswith("_mm") and isinstance(value, float) and isinstance(half_width, float):
                numbers[f"measurements / {measurement['id']} / {key}"] = [value, half_width]
    for movement in result["movements"]:
        for key, value in movement["centroid"].items():
            if isinstance(value, float):
                numbers[f"movements / {movement['object']} / {key}"] = [value, EXACT]
    for measure in (result["cephalometry"] or {}).get("measures", []):
        for when in ("before", "after"):
            if measure.get(when):
                numbers[f"cephalometry / {measure['name']} / {when}"] = [measure[when]["value"],
                                                                        measure[when]["half_width"]]
    return numbers


def differences(kept, now):
    """A line for each number that the interval of its release does not hold."""
    lines = []
    for where, old in kept.items():
        new = now.get(where)
        if new is None:
            lines.append(f"{where}: was {old[0]}, is missing")
        elif len(old) == 1 or old[0] is None or new[0] is None:
            if old[0] != new[0]:
                lines.append(f"{where}: was {old[0]}, is {new[0]}")
        elif not abs(new[0] - old[0]) <= (old[1] or 0) + EXACT * abs(old[0]):
            lines.append(f"{where}: was {old[0]} +- {old[1]}, is {new[0]}")
    return lines


def replay(plan, folder):
    run("run", plan, "--scan", f"ct={folder}/head.nrrd", "-o", folder / "report",
        *(["--scan", f"donor={folder}/leg.nrrd"] if "donor" in json.loads(plan.read_text())["scans"] else []))
    return json.loads((folder / "report/result.json").read_text())


def phantoms(folder):
    for kind in ("head", "leg"):
        run("phantom", kind, "--voxel", 2, "-o", folder / f"{kind}.nrrd")


class KeptPlans(unittest.TestCase):
    def test_every_number_is_within_the_interval_of_its_release_or_its_difference_has_a_cause(self):
        causes = json.loads((PLANS / "differences.json").read_text())
        kept = sorted(PLANS.glob("*/*.plan.json"))
        self.assertGreaterEqual(len(kept), 7)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            phantoms(folder)
            for plan in kept:
                known = causes.get(str(plan.relative_to(PLANS)), {})
                numbers = json.loads(plan.with_name(plan.name.replace(".plan.", ".numbers.")).read_text())
                found = differences(numbers, numbers_of(replay(plan, folder)))
                with self.subTest(plan=plan.name):
                    self.assertGreater(len(numbers), 10)
                    self.assertEqual([line for line in found if line.split(":")[0] not in known], [])
                    self.assertEqual(sorted(known), sorted(line.split(":")[0] for line in found),
                                     "a cause stands for a difference that there is")

    def test_a_changed_number_is_found(self):
        kept = {"a": [10.0, 1.0], "b": ["PASS"], "c": [1.0, 0.0], "d": [2.0, None]}
        self.assertEqual(differences(kept, {"a": [10.9, 1.0], "b": ["PASS"], "c": [1.0, 0.0], "d": [2.0, None]}), [])
        self.assertEqual(differences(kept, {"a": [11.1, 1.0], "b": ["WARN"], "c": [1.1, 5.0]}),
                         ["a: was 10.0 +- 1.0, is 11.1", "b: was PASS, is WARN", "c: was 1.0 +- 0.0, is 1.1",
                          "d: was 2.0, is missing"])


def keep(release, name, plan):
    folder = PLANS / release
    text = json.loads(Path(plan).read_text())
    for scan in text["scans"].values():
        scan["path"] = Path(scan["path"]).name
    text["steps"] = [step for step in text["steps"] if step["do"] != "export"]
    kept = folder / f"{name}.plan.json"
    kept.write_text(json.dumps(text) + "\n")
    with tempfile.TemporaryDirectory() as scratch:
        phantoms(Path(scratch))
        numbers = numbers_of(replay(kept, Path(scratch)))
    lines = ",\n".join(f"{json.dumps(where)}: {json.dumps(number)}" for where, number in numbers.items())
    (folder / f"{name}.numbers.json").write_text("{\n" + lines + "\n}\n")


if __name__ == "__main__":
    if sys.argv[1:2] == ["keep"]:
        keep(*sys.argv[2:])
    else:
        unittest.main()
