# SPDX-License-Identifier: AGPL-3.0-or-later
"""Bad input for the options of the operated scan, procedures, soft tissue, registration of scans, pictures, codes, filters,
segmentation and measures: each is refused with status 2 in one line that names its place, and writes nothing."""
import json
import os
import shlex
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
# A step after the window "ball" of the scan "ct", and what the line names.
STEPS = [
    ({"do": "scan_of", "expression": "ball"}, "'scan'"),
    ({"do": "scan_of", "scan": "cta", "expression": "ball"}, "'cta', did you mean 'ct'"),
    ({"do": "scan_of", "scan": "ct", "expression": "bal"}, "'bal', did you mean 'ball'"),
    ({"do": "scan_of", "scan": "ct", "expression": "ball & (ball"}, "character 13"),
    ({"do": "scan_of", "scan": "ct", "expression": ""}, "expression"),
    ({"do": "scan_of", "scan": "ct", "expression": "ball", "hole_value": 40000}, "-32768 to 32767"),
    ({"do": "scan_of", "scan": "ct", "expression": "ball", "hole_value": "air"}, "hole_value"),
    ({"do": "scan_of", "scan": "ct", "expression": "ball", "filled_value": -40000}, "-32768 to 32767"),
    ({"do": "scan_of", "scan": "ct", "expression": "ball", "holes": 1}, "'holes'"),
    ({"do": "scan_file", "scan": "op", "path": "o.nrrd"}, "'op'"),
    ({"do": "scan_file", "scan": "ct", "path": "o.dcm"}, ".nrrd"),
    ({"do": "scan_file", "scan": "ct", "path": "../o.nrrd"}, "'../o.nrrd'"),
    ({"do": "n4_bias_field", "scan": "ct", "levels": 9}, "levels"),
    ({"do": "n4_bias_field", "scan": "ct"}, "MR scan"),
    ({"do": "scale_space", "scan": "ct", "window": "0:"}, "sigma_mm"),
    ({"do": "scale_space", "scan": "ct", "window": "0:", "sigma_mm": 500}, "32 mm"),
    ({"do": "scale_space", "scan": "ct", "window": "5000:", "sigma_mm": 2}, "window"),
    ({"do": "segment", "scan": "ct", "clusters": 1}, "clusters"),
    ({"do": "segment", "scan": "ct", "clusters": 3, "otsu": 3}, "exactly one of"),
    ({"do": "segment", "scan": "ct", "clusters": 3, "class": 5}, "to 3"),
    ({"do": "segment", "scan": "ct", "running_mean": True, "seeds_mm": [[0, 0, 0]]}, "tolerance"),
    ({"do": "measure", "points_mm": [[0, 0, 0]]}, "points_mm"),
    ({"do": "measure", "points_mm": ["menton", [0, 0, 0]]}, "landmarks"),
    ({"do": "measure", "points_mm": [[0, 0, 0], [0, 0, 0], [3, 0, 0]]}, "points_mm"),
    ({"do": "register", "object": "ball", "onto": "ball", "by": "correlation"}, "'ct'"),
    ({"do": "tile", "contours": [{"position_mm": z, "polygons_mm": [[[0, 0], [5, 0], [0, 5]]]} for z in (0, 1e-9)]}, "slice 2"),
    ({"do": "contours", "scan": "ct", "slice_windows": ["0.5=250"], "path": "c.json"}, "'250'"),
]
# A verb's words, and what the line names.
VERBS = [
    ("procedure genioplast --scan ct.nrrd --landmarks marks.json -o o.plan.json", "'genioplasty'"),
    ("procedure genioplasty --scan ct.nrrd --landmarks marks.json -o o.plan.json", "foramen_left"),
    ("procedure genioplasty --landmarks marks.json -o o.plan.json", "--scan"),
    ("procedure genioplasty --scan ct.nrrd --landmarks marks.json --set forward_mm=a -o o.plan.json", "--set"),
    ("procedure genioplasty --after p.plan.json --scan ct.nrrd --landmarks marks.json -o o.plan.json", "--after"),
    ("warp ball.stl --result marks.json -o w.stl", "marks.json: holds no elements"),
    ("register ball.stl ct.nrrd -o r.nrrd", "ct.nrrd"),
    ("register ball.stl ball.stl --by correlation -o r.stl", "--by"),
    ("register ct.nrrd ct.nrrd --least-overlap 2 -o r.nrrd", "--least-overlap"),
    ("register ct.nrrd ct.nrrd --overlap 0.5 -o r.nrrd", "--overlap"),
    ("register ball.stl ball.stl --watch steps -o r.stl", "--watch"),
    ("register ct.nrrd ct.nrrd --by correlated -o r.nrrd", "'correlation'"),
    ("draw -o d.png", "--contours"),
    ("draw ball.octree -o d.png", "ball.octree"),
    ("draw ball.stl --shading fong -o d.png", "'phong'"),
    ("draw ball.stl --axial 0 -o d.png", "--scan"),
    ("draw --scan ct.nrrd --axial 900 -o d.png", "900 mm"),
    ("draw ball.stl --hide -o d.png", "--hide"),
    ("draw ball.stl --light 0,0,0 -o d.png", "--light"),
    ("draw ball.stl --shading wire --gloss 0.5 -o d.png", "--gloss"),
    ("montage ct.nrrd --count 500 -o m.png", "--count"),
    ("montage ct.nrrd --plane oblique -o m.png", "--plane"),
    ("montage ct.nrrd --first 500 -o m.png", "--first"),
    ("octree ball.octree --as tree -o c.txt", "'bitree'"),
    ("octree ball.octree --voxel 2 -o c.octree", "--voxel"),
    ("octree ball.octree --with ball.octree --as linear -o c.txt", "multivalued"),
    ("octree ball.octree --as linear --seed-face 0,0,0 -o c.txt", "--seed-face"),
    ("octree ball.octree --as faces --neighbours 18 -o c.txt", "--seed-face"),
    ("render ct.nrrd --relief 0 -o r.png", "--relief"),
    ("render ct.nrrd --relief 20 --stereo 5 -o r.png", "--stereo"),
    ("render ct.nrrd --shading radiograph --window 300: -o r.png", "--window"),
    ("render --expression 'a - b' --let a=ball.octree -o r.png", "--let b="),
    ("render --expression 'a - ' --let a=ball.octree -o r.png", "character 5"),
    ("render ball.octree --let a=ball.octree -o r.png", "--expression"),
    ("render --expression 'move(a, m)' --let a=ball.octree -o r.png", "move"),
    ("render ct.nrrd --cut-face grey -o r.png", "--cut-plane"),
    ("render ct.nrrd --peel -1 -o r.png", "--peel"),
    ("render ct.nrrd --decide derivative -o r.png", "--steeper"),
    ("render ct.nrrd --dissolve 0:100 -o r.png", "radiograph"),
    ("measure --distance 0,0,0", "--distance"),
    ("measure --distance menton 1,1,1", "'menton'"),
    ("measure --angle 0,0,0 0,0,0 1,1,1", "--angle"),
    ("prepare ct.nrrd -o n.nrrd --step scale_space=2", "window"),
    ("prepare ct.nrrd -o n.nrrd --step scan_of=1", "'scan_of'"),
    ("prepare ct.nrrd -o n.nrrd --step n4_bias_field=1,2,3,4,5", "4 values"),
    ("segment ct.nrrd --clusters 9 -o s.octree", "--clusters"),
    ("segment ct.nrrd --window 0: --class 2 -o s.octree", "--class"),
    ("convert ct.nrrd -o dd --dicom --source nofolder", "nofolder"),
    ("contours ct.nrrd --window 250 -o c.json", "'250'"),
    ("contours ct.nrrd --slice-window 0.5=250 -o c.json", "'250'"),
]


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        side = range(24)
        samples = [1000 if sum((at - 11.5) ** 2 for at in (x, y, z)) < 64 else -1000 for z in side for y in side for x in side]
        (cls.folder / "ct.nrrd").write_text(
            "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 24 24 24\n"
            "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-11.5,-11.5,-11.5)\nencoding: text\n\n"
            + " ".join(map(str, samples)) + "\n")
        (cls.folder / "marks.json").write_text('{"landmarks": [{"name": "menton", "point_mm": [0, 0, 0]}]}')
        for words in ("phantom sphere -o ball.octree --voxels 32", "mesh ball.octree -o ball.stl"):
            assert cls.run_words(words.split()).returncode == 0, words
        cls.write_plan([])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def run_words(cls, words):
        return subprocess.run([PROGRAM, *words], cwd=cls.folder, capture_output=True, text=True, timeout=120)

    @classmethod
    def write_plan(cls, steps):
        (cls.folder / "p.plan.json").write_text(json.dumps({
            "octotomy_plan": 1, "name": "p", "scans": {"ct": {"path": "ct.nrrd"}}, "universe": {"voxel_mm": 1},
            "steps": [{"id": "ball", "do": "window", "scan": "ct", "low": 0}, *steps]}))

    def refused(self, words, names):
        before = sorted(self.folder.iterdir())
        answer = self.run_words(words)
        lines = [line for line in answer.stderr.splitlines() if ": WARN, " not in line]
        self.assertEqual(answer.returncode, 2, answer.stderr)
        self.assertEqual(len(lines), 1, answer.stderr)
        self.assertTrue(lines[0].startswith("octotomy: "), lines[0])
        self.assertIn(names, lines[0])
        self.assertNotRegex(lines[0], r"\.\d{6}\b")  # numbers have three digits
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_steps_are_refused_in_one_line_each(self):
        for step, names in STEPS:
            with self.subTest(step=step):
                self.write_plan([{"id": "op", **step}])
                self.refused(["run", "p.plan.json", "--certify", "never", "-o", "report"], names)

    def test_verbs_are_refused_in_one_line_each(self):
        self.write_plan([])
        for words, names in VERBS:
            with self.subTest(words=words):
                self.refused(shlex.split(words), names)


if __name__ == "__main__":
    unittest.main()
