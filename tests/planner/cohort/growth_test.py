# SPDX-License-Identifier: AGPL-3.0-or-later
"""The group step's time and memory by the number of subjects, on simulated results of 1 KB to 100 KB each."""
import hashlib
import json
import os
import random
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from cohort_test import PROGRAM, ball, octotomy_program, rows

import octotomy

# The long run, ninja cohort_growth, has 100 000.
SIMULATED = int(os.environ.get("OCTOTOMY_SIMULATED", "2000"))


def one_answer(folder):
    """The plan and the files of a real subject."""
    plan = octotomy.Plan({"ct": "any.nrrd"}, name="ball")
    plan.window("ball", scan="ct", low=0)
    plan.measure("size", object="ball")
    plan.write(folder / "ball.plan.json")
    ball(folder / "ball.nrrd", 8)
    (folder / "one.csv").write_text("participant_id,scan\n0,ball.nrrd\n")
    octotomy_program("cohort", folder / "one.csv", folder / "one", "participant", "--plan", folder / "ball.plan.json")
    made = folder / "one/sub-0"
    files = {path.name: path.read_text() for path in made.iterdir() if path.suffix in (".csv", ".json")}
    return {**files, "plan": (folder / "ball.plan.json").read_text()}


def simulate(folder, count, files, seed):
    """A table of scans, and results that differ from a real one in label, values and number of measurements, one to
    eight. Result files are as long as it takes for 1 KB to 100 KB a subject, evenly by their logarithm. Returns the
    number of rows and of bytes."""
    choice = random.Random(seed)
    header, *lines = files["rows.csv"].splitlines()
    cells = [line.split(",") for line in lines]
    at = {name: header.split(",").index(name) for name in ("subject", "measurement", "value", "voxel", "mesh")}
    row_count = byte_count = 0
    for i in range(count):
        place = folder / f"many/sub-{i:06d}"
        place.mkdir(parents=True)
        text = header + "\n"
        for measurement in range(choice.randint(1, 8)):
            by = choice.gauss(1.0, 0.1)
            for cell in cells:
                row = list(cell)
                row[at["subject"]] = f"{i:06d}"
                row[at["measurement"]] = f"size_{measurement}"
                for name in ("value", "voxel", "mesh"):
                    row[at[name]] = repr(float(row[at[name]]) * by)
                text += ",".join(row) + "\n"
                row_count += 1
        size = int(1000 * 100 ** choice.random()) - len(text) - len(files["subject.json"])
        written = {"rows.csv": text, "subject.json": files["subject.json"],
                   "result.json": (files["result.json"] * 10)[:max(0, size)]}
        for name, content in written.items():
            (place / name).write_text(content)
        (place / ".octotomy-result").write_text("".join(
            f"{hashlib.sha256(content.encode()).hexdigest()}  {name}\n" for name, content in written.items()))
        byte_count += len(text) + len(files["subject.json"]) + max(0, size)
    scans = "".join(f"{i:06d},ball.nrrd\n" for i in range(count))
    (folder / "scans.csv").write_text("participant_id,scan\n" + scans)
    return row_count, byte_count


class Growth(unittest.TestCase):
    def merged(self, count, files):
        """Seconds and megabytes of a group step, which must hold every row."""
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            ball(folder / "ball.nrrd", 8)
            (folder / "ball.plan.json").write_text(files["plan"])
            row_count, byte_count = simulate(folder, count, files, count)
            start = time.monotonic()
            process = subprocess.Popen([PROGRAM, "cohort", folder / "scans.csv", folder / "many", "group", "--plan",
                                        folder / "ball.plan.json"], stdout=subprocess.DEVNULL)
            _, status, used = os.wait4(process.pid, 0)
            seconds = time.monotonic() - start
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 0)
            group = folder / "many/group"
            told = rows(group / "measurements.csv")
            self.assertEqual(len(told), row_count)
            self.assertEqual(len({row["subject"] for row in told}), count)
            self.assertEqual(json.loads((group / "summary.json").read_text())["done"], count)
            megabytes, processor = used.ru_maxrss / 1024, used.ru_utime + used.ru_stime
            print(f"{count} subjects, {byte_count / 1e6:.0f} MB, {row_count} rows: {seconds:.1f} s, of these {processor:.1f} s "
                  f"of processor time, {1e6 * processor / count:.0f} us a subject; {megabytes:.0f} MB", flush=True)
            return processor, megabytes

    def test_the_group_step_grows_with_its_subjects(self):
        with tempfile.TemporaryDirectory() as place:
            files = one_answer(Path(place))
        counts = [count for count in (SIMULATED // 100, SIMULATED // 10, SIMULATED) if count >= 100]
        used = {count: self.merged(count, files) for count in counts}
        seconds, megabytes = used[SIMULATED]
        # 100 000 subjects take under 1 GB and 60 s; the program itself some 50 MB.
        self.assertLess(megabytes, 100 + 0.009 * SIMULATED)
        self.assertLess(seconds, 5 + 6e-4 * SIMULATED)
        if len(counts) > 2:
            self.assertLess(seconds / SIMULATED, 3 * used[counts[-2]][0] / counts[-2])


if __name__ == "__main__":
    unittest.main()
