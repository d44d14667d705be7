# SPDX-License-Identifier: AGPL-3.0-or-later
"""The package as people get it: a wheel, and the tour of its README."""
import base64
import hashlib
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import octotomy

SOURCE = Path(__file__).parents[3] / "planner/python"
BUILD = Path(octotomy.__file__).parents[2]

# A ball as a scan, as a plan, as a deck: its tetrahedra are a helper's.
BALL = """
import sys, numpy as np, octotomy
ball = np.where(sum(x**2 for x in np.mgrid[-12:13, -12:13, -12:13]) <= 81, 1000, -1000).astype(np.int16)
octotomy.Scan(ball, np.eye(4)).write("ball.nrrd")
plan = octotomy.Plan({"ct": "ball.nrrd"})
ball = plan.window("ball", scan="ct", low=0)
plan.deck("filled", object=ball, path="ball.inp")
said = plan.run().write("result")
assert said["exports"][0]["written"], said["exports"]
print(octotomy.__file__)
"""


class Package(unittest.TestCase):
    def test_a_wheel_is_whole_repeats_and_runs(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            wheels = [subprocess.run([sys.executable, SOURCE / "wheel", BUILD, folder / each], check=True,
                                     capture_output=True, text=True).stdout.strip() for each in "ab"]
            self.assertEqual(*(hashlib.sha256(Path(wheel).read_bytes()).digest() for wheel in wheels))
            with zipfile.ZipFile(wheels[0]) as wheel:
                record = next(entry for entry in wheel.namelist() if entry.endswith("RECORD"))
                for line in wheel.read(record).decode().splitlines():
                    path, digest, size = line.rsplit(",", 2)
                    if digest:
                        data = wheel.read(path)
                        self.assertEqual(len(data), int(size))
                        self.assertEqual(digest.removeprefix("sha256="),
                                         base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode())
                for entry in wheel.infolist():
                    wheel.extract(entry, folder / "site")
                    (folder / "site" / entry.filename).chmod(entry.external_attr >> 16)
            environment = {**os.environ, "PYTHONPATH": str(folder / "site")}
            run = subprocess.run([sys.executable, "-c", BALL], env=environment, cwd=folder, capture_output=True,
                                 text=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(str(folder / "site"), run.stdout)

    def test_the_tour_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            head = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_1.nrrd"
            run = subprocess.run([sys.executable, SOURCE / "tour.py", head, Path(folder) / "result"],
                                 capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("result PASS", run.stdout)
            self.assertTrue((Path(folder) / "result/report.html").exists())


if __name__ == "__main__":
    unittest.main()
