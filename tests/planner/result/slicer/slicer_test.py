# SPDX-License-Identifier: AGPL-3.0-or-later
"""A plan as a scene of 3D Slicer, read by plain Python: every piece, motion, landmark and segment lies where the plan
has it, in the frame that its file states, and the scene refers to every file."""
import gzip
import json
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

import numpy as np

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
PLAN = {
    "octotomy_plan": 1, "name": "An advancement", "scans": {"ct": {"path": "head.nrrd"}},
    "universe": {"voxel_mm": 4.0},
    "steps": [
        {"id": "points", "do": "landmarks", "points": [
            {"name": "incisor", "point_mm": [0, -81.5, -57.8]}, {"name": "chin", "point_mm": [10, 2, 3.25]}]},
        {"id": "skull", "do": "window", "scan": "ct", "low": 300},
        {"id": "cut", "do": "mask", "regions": [
            {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]}]},
        {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
        {"id": "rest", "do": "combine", "expression": "skull - cut"},
        {"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 2],
         "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]}},
        {"id": "further", "do": "move", "object": "advanced", "translate_mm": [1, 0, 0]},
        {"id": "size", "do": "measure", "object": "further"}]}


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300)


class Scene(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        cls.scan = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_2.nrrd"
        (cls.folder / "my.plan.json").write_text(json.dumps(PLAN))
        made = cls.scene("scene")
        assert made.returncode == 0, made.stderr
        cls.written = json.loads(made.stdout)
        cls.data = cls.folder / "scene/Data"
        cls.nodes = xml.parse(cls.folder / "scene/scene.mrml").getroot()
        result = run(PROGRAM, "run", cls.folder / "my.plan.json", "--scan", f"ct={cls.scan}", "-o", cls.folder / "r",
                     "--certify", "never", "--json")
        assert result.returncode == 0, result.stderr
        cls.result = json.loads(result.stdout)

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    @classmethod
    def scene(cls, name):
        return run(PROGRAM, "scene", cls.folder / "my.plan.json", "--scan", f"ct={cls.scan}", "-o", cls.folder / name,
                   "--json")

    def object(self, name):
        return next(row for row in self.result["objects"] if row["id"] == name)

    def motion(self, name):
        """From the place before to the place after, LPS: the file holds the inverse, as ITK's transforms do."""
        lines = (self.data / f"{name}_motion.tfm").read_text().splitlines()
        self.assertEqual(lines[0], "#Insight Transform File V1.0")
        numbers = [float(word) for word in next(x for x in lines if x.startswith("Parameters:")).split()[1:]]
        self.assertEqual([float(x) for x in lines[-1].split()[1:]], [0, 0, 0])
        matrix = np.eye(4)
        matrix[:3, :3] = np.reshape(numbers[:9], (3, 3))
        matrix[:3, 3] = numbers[9:]
        return np.linalg.inv(matrix)

    def test_each_node_refers_to_a_file_and_to_nodes_that_are_there(self):
        ids = [node.get("id") for node in self.nodes]
        self.assertEqual(len(ids), len(set(ids)))
        files = {node.get("fileName") for node in self.nodes if node.get("fileName")}
        self.assertEqual(files, {f"Data/{path.name}" for path in self.data.iterdir()})
        for node in self.nodes:
            for reference in filter(None, (node.get("references") or "").split(";")):
                self.assertIn(reference.split(":")[1], ids)
        models = [node.get("name") for node in self.nodes if node.tag == "Model"]
        self.assertEqual(models, ["skull", "maxilla", "rest", "advanced", "further"])
        self.assertEqual(models, self.written["models"])

    def test_moved_models_lie_below_their_motion_and_arrive_where_the_plan_has_them(self):
        a = np.radians(5)
        turn = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        about = np.array([0, -40, -30])
        expected = np.eye(4)
        expected[:3, :3], expected[:3, 3] = turn, about - turn @ about + [0, -6, 2]
        self.assertLess(np.abs(self.motion("advanced") - expected).max(), 1e-9)
        expected[0, 3] += 1
        self.assertLess(np.abs(self.motion("further") - expected).max(), 1e-9)
        still = self.object("maxilla")["mesh"]["centroid_mm"]
        for name in ("advanced", "further"):
            node = next(n for n in self.nodes if n.tag == "Model" and n.get("name") == name)
            self.assertIn("transform:vtkMRMLLinearTransformNode", node.get("references"))
            arrived = self.motion(name) @ [*still, 1]
            self.assertLess(np.abs(arrived[:3] - self.object(name)["mesh"]["centroid_mm"]).max(), 1e-6)
            measured = json.loads(run(PROGRAM, "measure", self.data / f"{name}.vtp", "--json").stdout)
            self.assertLess(np.abs(np.subtract(measured["centroid_mm"], still)).max(), 1e-6)

    def test_surfaces_state_the_frame(self):
        for path in self.data.glob("*.vtp"):
            info = json.loads(run(PROGRAM, "info", path, "--json").stdout)
            self.assertTrue(info["closed"], path.name)
            self.assertIn("LPS", json.dumps(info["audit"]), path.name)

    def test_landmarks_keep_their_names_and_places(self):
        markups = json.loads((self.data / "landmarks.mrk.json").read_text())["markups"][0]
        self.assertEqual((markups["coordinateSystem"], markups["coordinateUnits"]), ("LPS", "mm"))
        points = {point["label"]: point["position"] for point in markups["controlPoints"]}
        self.assertEqual(points, {point["name"]: point["point_mm"] for point in PLAN["steps"][0]["points"]})

    def test_segments_hold_the_voxels_of_the_objects_also_where_they_overlap(self):
        header, packed = (self.data / "objects.seg.nrrd").read_bytes().split(b"\n\n", 1)
        fields = dict(line.replace(":=", ": ").split(": ", 1) for line in header.decode().splitlines() if ": " in
                      line.replace(":=", ": "))
        self.assertEqual(fields["space"], "left-posterior-superior")
        sizes = [int(word) for word in fields["sizes"].split()]
        labels = np.frombuffer(gzip.decompress(packed), np.uint8).reshape(sizes[::-1])
        origin = np.array([float(x) for x in fields["space origin"].strip("()").split(",")])
        for number in range(5):
            name = fields[f"Segment{number}_Name"]
            voxels = np.argwhere(labels[..., int(fields[f"Segment{number}_Layer"])]
                                 == int(fields[f"Segment{number}_LabelValue"]))[:, ::-1]
            row = self.object(name)["voxel"]
            self.assertEqual(len(voxels), row["voxels"], name)
            self.assertLess(np.abs(voxels.mean(axis=0) * 4 + origin - row["centroid_mm"]).max(), 1e-6, name)
            extent = [int(x) for x in fields[f"Segment{number}_Extent"].split()]
            self.assertEqual(extent, [x for pair in zip(voxels.min(axis=0), voxels.max(axis=0)) for x in pair], name)

    def test_the_programs_own_reader_finds_the_same_objects(self):
        for name in ("maxilla", "rest", "further"):
            segment = run(PROGRAM, "segment", self.data / "objects.seg.nrrd", "--named", name, "-o",
                          self.folder / f"{name}.octree")
            self.assertEqual(segment.returncode, 0, segment.stderr)
            measured = json.loads(run(PROGRAM, "measure", self.folder / f"{name}.octree", "--json").stdout)
            self.assertAlmostEqual(measured["volume_mm3"], self.object(name)["voxel"]["volume_mm3"])

    def test_a_bundle_holds_the_folders_files_and_is_the_same_each_time(self):
        for name in ("a.mrb", "b.mrb"):
            self.assertEqual(self.scene(name).returncode, 0)
        with zipfile.ZipFile(self.folder / "a.mrb") as a:
            for path in [self.folder / "scene/scene.mrml", *self.data.iterdir()]:
                inside = "a/" + path.relative_to(self.folder / "scene").as_posix()
                self.assertEqual(a.read(inside), path.read_bytes(), inside)
        with zipfile.ZipFile(self.folder / "b.mrb") as b:
            self.assertEqual(len(b.namelist()), len(list(self.data.iterdir())) + 1)

    def test_a_folder_with_files_is_refused_and_kept(self):
        (self.folder / "mine").mkdir()
        (self.folder / "mine/notes.txt").write_text("mine")
        refused = self.scene("mine")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("mine", refused.stderr)
        self.assertEqual([path.name for path in (self.folder / "mine").iterdir()], ["notes.txt"])


if __name__ == "__main__":
    unittest.main()
