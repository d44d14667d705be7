# SPDX-License-Identifier: AGPL-3.0-or-later
"""The three planned operations of the thesis's chapter 8 on the head phantom, each with a genioplasty after it in one plan:
landmarks come to lie where the typed values put them, and the operated CT is written as DICOM, which pydicom reads back with
the same samples.

    OCTOTOMY_CASES=kufner,mandible,two_jaw python3 -m unittest chained_cases_test"""
import gzip
import importlib.util
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
CASES = os.environ.get("OCTOTOMY_CASES", "kufner,two_jaw").split(",")
HEADER = Path(__file__).parent / "template/on_the_head.h"
NEAR_MM = 0.001
# The values typed for a case and for its chin, then landmarks on moved pieces with their displacements forward, left and up;
# None is a displacement that nobody typed.
OPERATIONS = {
    "kufner": ({"forward_mm": 15, "up_mm": -1}, {"forward_mm": 4},
               {"midface_moved": {"incisor": (15, 0, -1), "molar_left": (15, 0, -1)}}),
    "mandible": ({"forward_mm": 1, "left_mm": -2, "front_up_mm": 2, "back_up_mm": -41.1}, {"forward_mm": 4},
                 {"mandible_moved": {"lower_incisor": (1, -2, 2), "condyle_left": (None, -2, -41.1)}}),
    "two_jaw": ({"upper_left_mm": 2, "upper_front_up_mm": 7, "upper_back_up_mm": 3, "lower_forward_mm": 9, "lower_left_mm": 2,
                 "lower_front_up_mm": 6, "lower_back_up_mm": 2}, {"left_mm": -4},
                {"maxilla_moved": {"incisor": (0, 2, 7), "molar_left": (None, 2, 3)},
                 "distal_moved": {"lower_incisor": (9, 2, 6), "lower_molar_left": (None, 2, 2)}}),
}


def run(*words):
    answer = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=900)
    if answer.returncode != 0:
        raise RuntimeError(f"{words}: status {answer.returncode}: {answer.stderr.strip()}")


def values(typed):
    return [word for name, value in typed.items() for word in ("--set", f"{name}={value}")]


def samples_of(path):
    """The samples of a gzipped .nrrd of short integers, slice by slice, and its padding."""
    text, samples = path.read_bytes().split(b"\n\n", 1)
    text = text.decode()
    sizes = [int(word) for word in re.search(r"^sizes: (.*)$", text, re.M)[1].split()]
    if "encoding: gz" in text:
        samples = gzip.decompress(samples)
    length = 2 * sizes[0] * sizes[1]
    return [samples[i * length:(i + 1) * length] for i in range(sizes[2])]


class ChainedCases(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        run("phantom", "head", "--voxel", 2, "-o", cls.folder / "head.nrrd")
        marks = [{"name": name, "point_mm": [float(x) for x in place.split(",")]}
                 for name, place in re.findall(r'\{"(\w+)", \{([-\d., ]+)\}\}', HEADER.read_text())]
        assert len(marks) > 40
        (cls.folder / "marks.json").write_text(json.dumps({"landmarks": marks}))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def operated(self, name):
        """The result of one plan of two procedures and the scan after both."""
        typed, chin, _ = OPERATIONS[name]
        first, plan = self.folder / f"{name}.first.plan.json", self.folder / f"{name}.plan.json"
        run("procedure", name, "--scan", self.folder / "head.nrrd", "--voxel", 1, "--landmarks", self.folder / "marks.json",
            *values(typed), "-o", first)
        run("procedure", "genioplasty", "--after", first, "--landmarks", self.folder / "marks.json", *values(chin), "-o", plan)
        text = json.loads(plan.read_text())
        text["steps"] += [
            {"id": "everything", "do": "window", "scan": "ct", "low": -2000},
            {"id": "operated", "do": "scan_of", "scan": "ct", "expression": "genioplasty_planned | (everything - skull)"},
            {"id": "operated_file", "do": "scan_file", "scan": "operated", "path": "operated.nrrd"}]
        plan.write_text(json.dumps(text))
        run("run", plan, "--certify", "never", "-o", self.folder / name)
        return json.loads((self.folder / name / "result.json").read_text())

    def test_landmarks_go_as_typed_and_the_operated_scan_is_dicom_with_the_same_samples(self):
        for name in CASES:
            with self.subTest(case=name):
                result = self.operated(name)
                moved = {each["object"]: each for each in result["movements"]}
                for piece, marks in OPERATIONS[name][2].items():
                    found = {mark["name"]: mark for mark in moved[piece]["landmarks"]}
                    for mark, wanted in marks.items():
                        self.assertIn(mark, found, piece)
                        for key, mm in zip(("forward_mm", "left_mm", "up_mm"), wanted):
                            if mm is not None:
                                self.assertAlmostEqual(found[mark][key], mm, delta=NEAR_MM, msg=f"{mark} {key}")
                for key, mm in OPERATIONS[name][1].items():
                    self.assertAlmostEqual(moved["genioplasty_chin_moved"]["centroid"][key], mm, delta=NEAR_MM)
                made = next(scan for scan in result["scans"] if scan["name"] == "operated")["details"]
                self.assertEqual(made["second_reading"]["differing"], 0)
                self.assertGreater(made["second_reading"]["compared"], 10000)
                self.read_back(name, made)

    def read_back(self, name, made):
        if importlib.util.find_spec("pydicom") is None:
            self.skipTest("there is no pydicom (apt-get install python3-pydicom)")
        import pydicom
        run("convert", self.folder / name / "operated.nrrd", "-o", self.folder / f"{name}.dicom", "--dicom")
        images = [pydicom.dcmread(file) for file in (self.folder / f"{name}.dicom").glob("*.dcm")]
        images.sort(key=lambda image: float(image.ImagePositionPatient[2]))
        slices = samples_of(self.folder / name / "operated.nrrd")
        self.assertEqual(len(images), len(slices))
        holes = 0
        for image, samples in zip(images, slices):
            wanted = memoryview(samples).cast("h")
            stored = memoryview(bytes(image.PixelData)).cast("h")
            self.assertEqual(len(stored), len(wanted))
            padding = image.PixelPaddingValue
            for theirs, ours in zip(stored, wanted):
                if theirs == padding:
                    holes += 1
                    self.assertEqual(ours, made["hole_value"])
                elif theirs * image.RescaleSlope + image.RescaleIntercept != ours:
                    self.fail(f"{theirs} is stored for {ours}")
        self.assertEqual(holes, made["hole_samples"])


if __name__ == "__main__":
    unittest.main()
