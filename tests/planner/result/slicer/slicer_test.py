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

    def test_motions_in_hdf5_are_those_in_text(self):
        answer = run(PROGRAM, "scene", self.folder / "my.plan.json", "--scan", f"ct={self.scan}", "-o", self.folder / "hdf5",
                     "--transforms", "h5")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        data = self.folder / "hdf5/Data"
        self.assertEqual(list(data.glob("*.tfm")), [])
        self.assertIn("Data/advanced_motion.h5", (self.folder / "hdf5/scene.mrml").read_text())
        objects = []
        for file in [data / "advanced_motion.h5", self.data / "advanced_motion.tfm"]:
            moved = self.folder / f"moved{file.suffix}.stl"
            answer = run(PROGRAM, "transform", self.data / "maxilla.vtp", "--file", file, "-o", moved)
            self.assertEqual(answer.returncode, 0, answer.stderr)
            objects.append(moved.read_bytes())
        self.assertEqual(objects[0], objects[1])
        cut = self.folder / "cut.h5"
        cut.write_bytes((data / "advanced_motion.h5").read_bytes()[:4000])
        answer = run(PROGRAM, "transform", self.data / "maxilla.vtp", "--file", cut, "-o", self.folder / "cut.stl")
        self.assertEqual((answer.returncode, len(answer.stderr.strip().splitlines())), (2, 1), answer.stderr)
        self.assertIn("cut.h5: ", answer.stderr)
        try:
            import h5py
        except ImportError:
            self.skipTest("not installed: apt-get install python3-h5py")
        with h5py.File(data / "advanced_motion.h5") as file:
            group = file["TransformGroup/0"]
            self.assertEqual(group["TransformType"][0], b"AffineTransform_double_3_3")
            numbers = group["TranformParameters"][:]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = np.reshape(numbers[:9], (3, 3)), numbers[9:]
        self.assertTrue(np.array_equal(np.linalg.inv(matrix), self.motion("advanced")))

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
            self.assertIn("~SCT^85756007^Tissue~SCT^85756007^Tissue~", fields[f"Segment{number}_Tags"])
            self.assertEqual(fields[f"Segment{number}_Tags"].count("~"), 6, "as many parts as Slicer reads")
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


UNC = Path(os.environ.get("OCTOTOMY_SHARED_DATA", "/nowhere")) / "ct_unc_cthead.nrrd"


def vtp_points(path):
    """The points of a surface, as the file's text and appended bytes state them."""
    text = path.read_bytes()
    head = text[:text.index(b"<AppendedData")]
    array = next(x for x in xml.fromstring(head + b"</VTKFile>").iter("Points")).find("DataArray")
    assert (array.get("type"), array.get("format")) == ("Float64", "appended"), array.attrib
    start = text.index(b"_", text.index(b"<AppendedData")) + 1 + int(array.get("offset"))
    size = int(np.frombuffer(text[start:start + 8], "<u8")[0])
    return np.frombuffer(text[start + 8:start + 8 + size], "<f8").reshape(-1, 3)


class RoundTrip(unittest.TestCase):
    """A whole plan on a real head, or on the phantom where there is none: written for Slicer, read by plain Python,
    and read back by the program."""
    LANDMARKS = [{"name": "ans", "point_mm": [0.5, -80.25, 60]}, {"name": "chin", "point_mm": [10, 2, 3.25]}]
    VIEWS = {"anterior": ([1, 0, 0], [0, 0, 1], [0, 1, 0]), "left": ([0, 1, 0], [0, 0, 1], [-1, 0, 0])}
    SHIFT, DEGREES, AXIS = [0, -6, 2], 7, np.array([1, 0.5, 0.25])

    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        cls.scan = UNC if UNC.exists() else Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_2.nrrd"
        cls.low = 20 if UNC.exists() else -60
        low, high = cls.low, cls.low + 45
        cls.regions = {"anterior": [[-40.5, low], [40, low], [40, high], [0.125, high + 7.5], [-40.5, high]],
                       "left": [[-130, low], [-30.25, low], [-30.25, high + 20], [-130, high + 20]]}
        cls.oblique = [[-20, low], [25.5, low + 3], [3.0625, high]]
        cls.line = [[-60, -120, low + 60.5], [60, -120, low + 63], [70, -110, low + 63]]
        cls.steps = [
            {"id": "points", "do": "landmarks", "points": cls.LANDMARKS},
            {"id": "skull", "do": "window", "scan": "ct", "low": 300},
            {"id": "cut", "do": "mask",
             "regions": [{"view": view, "polygons_mm": [points]} for view, points in cls.regions.items()]},
            {"id": "bevel", "do": "mask", "regions": [{"view": "35,15", "polygons_mm": [cls.oblique]}]},
            {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
            {"id": "wedge", "do": "combine", "expression": "skull & bevel"},
            {"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": cls.SHIFT,
             "rotate": {"degrees": cls.DEGREES, "axis": cls.AXIS.tolist(), "about_mm": [0, -40, 30]}},
            {"id": "halved", "do": "saw", "object": "skull", "line_mm": cls.line[:2], "direction": [0, 2, 0.5],
             "depth_mm": 70, "kerf_mm": 3},
            {"id": "bent", "do": "saw", "object": "skull", "line_mm": cls.line, "direction": [0, 1, 0], "depth_mm": 60,
             "kerf_mm": 3}]
        cls.made("first")
        # A screw sits in the bone's most anterior point, and moves on with the bone.
        points = vtp_points(cls.folder / "first/Data/skull.vtp")
        cls.head = points[points[:, 1].argmin()].tolist()
        cls.steps += [{"id": "screw", "do": "screw", "object": "skull", "at": cls.head, "direction": [0, 3, 0.25],
                       "length_mm": 9},
                      {"id": "screw_after", "do": "move", "object": "screw", "with": "advanced"}]
        cls.written = cls.made("scene")
        cls.data = cls.folder / "scene/Data"

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    @classmethod
    def plan(cls, name, steps):
        path = cls.folder / f"{name}.plan.json"
        path.write_text(json.dumps({"octotomy_plan": 1, "name": name, "scans": {"ct": {"path": str(cls.scan)}},
                                    "universe": {"voxel_mm": 4.0}, "steps": steps}))
        return path

    @classmethod
    def made(cls, name):
        made = run(PROGRAM, "scene", cls.plan(name, cls.steps), "-o", cls.folder / name, "--json")
        assert made.returncode == 0, made.stderr
        return json.loads(made.stdout)

    @classmethod
    def result(cls, name, steps):
        made = run(PROGRAM, "run", cls.plan(name, steps), "-o", cls.folder / f"{name}_result", "--certify", "never",
                   "--json")
        assert made.returncode == 0, made.stderr
        return {row["id"]: row for row in json.loads(made.stdout)["objects"]}

    @classmethod
    def refusal(cls, steps):
        refused = run(PROGRAM, "run", cls.plan("bad", steps), "-o", cls.folder / "bad_result", "--certify", "never")
        assert refused.returncode == 2, (refused.returncode, refused.stderr)
        return [line for line in refused.stderr.splitlines() if "WARN" not in line and "border" not in line]

    def markup(self, file):
        markups = json.loads((self.data / file).read_text())["markups"]
        self.assertEqual(len(markups), 1)
        self.assertEqual((markups[0]["coordinateSystem"], markups[0]["coordinateUnits"]), ("LPS", "mm"))
        return markups[0]

    def points(self, file):
        return np.array([point["position"] for point in self.markup(file)["controlPoints"]])

    def plane(self, file):
        """Origin, axes as columns and bounds; both statements of the axes agree."""
        plane = self.markup(file)
        base = np.reshape(plane["baseToNode"], (4, 4))
        axes = np.reshape(plane["orientation"], (3, 3))
        self.assertTrue((base[:3, :3] == axes).all())
        self.assertLess(np.abs(axes.T @ axes - np.eye(3)).max(), 1e-12)
        self.assertGreater(np.linalg.det(axes), 0)
        self.assertEqual(plane["center"], plane["controlPoints"][0]["position"])
        self.assertEqual(plane["planeType"], "pointNormal")
        return np.array(plane["center"]), axes, plane["planeBounds"]

    def test_curves_are_the_regions_in_their_views(self):
        for view, region in self.regions.items():
            right, up, _ = np.array(self.VIEWS[view], float)
            curve = self.points(f"cut_{view}.mrk.json")
            self.assertEqual(self.markup(f"cut_{view}.mrk.json")["type"], "ClosedCurve")
            self.assertLess(np.abs(np.c_[curve @ right, curve @ up] - region).max(), 1e-9)
        azimuth, elevation = np.radians([35, 15])
        look = np.array([-np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), -np.sin(elevation)])
        up = np.array([-np.sin(azimuth) * np.sin(elevation), np.cos(azimuth) * np.sin(elevation), np.cos(elevation)])
        curve = self.points("bevel_35_15.mrk.json")
        self.assertLess(np.abs(np.c_[curve @ np.cross(look, up), curve @ up] - self.oblique).max(), 1e-9)

    def test_planes_are_the_sides_of_masks_with_normals_into_them(self):
        for view, region in self.regions.items():
            right, up, look = np.array(self.VIEWS[view], float)
            inside = np.mean(region, axis=0)
            for number, corner in enumerate(region):
                origin, axes, bounds = self.plane(f"cut_{view}_side_{number + 1}.mrk.json")
                ends = np.array([corner, region[(number + 1) % len(region)]])
                for end in ends:
                    off = (end[0] * right + end[1] * up - origin) @ axes[:, 2]
                    self.assertLess(abs(off), 1e-9)
                self.assertLess(abs(axes[:, 2] @ look), 1e-12)
                self.assertGreater((inside[0] * right + inside[1] * up - origin) @ axes[:, 2], 0)
                self.assertAlmostEqual(bounds[1] - bounds[0], np.linalg.norm(ends[1] - ends[0]))

    def test_planes_are_what_saws_sweep(self):
        direction = np.array([0, 2, 0.5]) / np.hypot(2, 0.5)
        origin, axes, bounds = self.plane("halved_plane.mrk.json")
        line = np.array(self.line[:2])
        entry = min(line @ direction)
        corners = [p + (entry - p @ direction) * direction for p in line]
        self.assertLess(np.abs(origin + bounds[0] * axes[:, 0] + bounds[2] * axes[:, 1] - corners[0]).max(), 1e-9)
        self.assertLess(np.abs(origin + bounds[1] * axes[:, 0] + bounds[2] * axes[:, 1] - corners[1]).max(), 1e-9)
        self.assertLess(np.abs(axes[:, 1] - direction).max(), 1e-12)
        self.assertAlmostEqual(bounds[3] - bounds[2], 70)
        for name in ("bent_plane_1", "bent_plane_2"):
            self.assertIn(f"{name}.mrk.json", self.written["planes"])
        self.assertEqual(self.points("bent_line.mrk.json").tolist(), self.line)

    def test_lines_are_the_screws_axes_also_where_the_screw_moved(self):
        direction = np.array([0, 3, 0.25]) / np.hypot(3, 0.25)
        ends = np.array([self.head, self.head + 9 * direction])
        self.assertEqual(self.markup("screw_axis.mrk.json")["type"], "Line")
        self.assertLess(np.abs(self.points("screw_axis.mrk.json") - ends).max(), 1e-9)
        axis = self.AXIS / np.linalg.norm(self.AXIS)
        k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        a = np.radians(self.DEGREES)
        turn = np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k
        about = np.array([0, -40, 30])
        moved = (ends - about) @ turn.T + about + self.SHIFT
        self.assertLess(np.abs(self.points("screw_after_axis.mrk.json") - moved).max(), 1e-9)
        # The transform states the same motion.
        lines = (self.data / "advanced_motion.tfm").read_text().splitlines()
        numbers = np.array([float(x) for x in next(x for x in lines if x.startswith("Param")).split()[1:]])
        self.assertLess(np.abs(np.reshape(numbers[:9], (3, 3)) - turn.T).max(), 1e-12)
        self.assertLess(np.abs((ends @ turn.T + about - turn @ about + self.SHIFT - moved)).max(), 1e-9)
        self.assertLess(np.abs(moved @ turn + numbers[9:] - ends).max(), 1e-9)

    def test_curves_are_straight_and_nodes_have_their_classes(self):
        nodes = xml.parse(self.folder / "scene/scene.mrml").getroot()
        tags = {node.get("name"): node for node in nodes if node.tag.startswith("Markups") and "Storage" not in node.tag
                and "Display" not in node.tag}
        self.assertEqual(tags["cut anterior"].get("curveType"), "linear")
        self.assertEqual({name: tags[name].tag for name in ("landmarks", "cut anterior", "halved plane", "bent line",
                                                             "screw axis")},
                         {"landmarks": "MarkupsFiducial", "cut anterior": "MarkupsClosedCurve",
                          "halved plane": "MarkupsPlane", "bent line": "MarkupsCurve", "screw axis": "MarkupsLine"})
        self.assertIn("MarkupsPlaneJsonStorage", tags["halved plane"].get("references"))

    def test_the_plan_built_of_the_scenes_files_makes_the_same_objects(self):
        first = self.result("typed", self.steps)
        data = "scene/Data/"
        sides = [data + f"cut_left_side_{number}.mrk.json" for number in range(1, 5)]
        read = [
            {"id": "points", "do": "landmarks", "file": data + "landmarks.mrk.json"},
            {"id": "skull", "do": "window", "scan": "ct", "low": 300},
            {"id": "cut", "do": "mask",
             "regions": [{"view": view, "curves": [data + f"cut_{view}.mrk.json"]} for view in self.regions]},
            {"id": "bevel", "do": "mask", "regions": [{"view": "35,15", "curves": [data + "bevel_35_15.mrk.json"]}]},
            {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
            {"id": "wedge", "do": "combine", "expression": "skull & bevel"},
            {"id": "advanced", "do": "transform", "object": "maxilla", "file": data + "advanced_motion.tfm"},
            {"id": "halved", "do": "saw", "object": "skull", "plane": data + "halved_plane.mrk.json", "kerf_mm": 3},
            {"id": "sides", "do": "mask", "planes": sides},
            {"id": "left", "do": "mask", "regions": [{"view": "left", "polygons_mm": [self.regions["left"]]}]},
            {"id": "by_sides", "do": "combine", "expression": "skull & sides"},
            {"id": "by_region", "do": "combine", "expression": "skull & left"}]
        made = self.result("read", read)
        for name in ("maxilla", "wedge", "advanced", "halved"):
            self.assertGreater(made[name]["voxel"]["voxels"], 100, name)
            self.assertEqual(made[name]["voxel"]["voxels"], first[name]["voxel"]["voxels"], name)
            self.assertEqual(made[name]["voxel"]["centroid_mm"], first[name]["voxel"]["centroid_mm"], name)
            self.assertLess(abs(made[name]["mesh"]["volume_mm3"] / first[name]["mesh"]["volume_mm3"] - 1), 1e-9, name)
        self.assertGreater(made["by_sides"]["voxel"]["voxels"], 100)
        self.assertEqual(made["by_sides"]["voxel"], made["by_region"]["voxel"])
        # The typed numbers come back to the bit.
        for name in ("maxilla", "wedge"):
            self.assertEqual(made[name]["mesh"], first[name]["mesh"], name)
        self.assertIn("LPS", json.dumps(made["advanced"]["findings"]))
        self.assertIn("the motion is its inverse", json.dumps(made["advanced"]["findings"]))

    def moved(self, name, text):
        (self.folder / name).write_text(text)
        return [{"id": "skull", "do": "window", "scan": "ct", "low": 300},
                {"id": "moved", "do": "transform", "object": "skull", "file": name}]

    def test_transforms_of_other_programs_are_read(self):
        head = "#Insight Transform File V1.0\n#Transform 0\nTransform: "
        still = self.result("still", self.steps[1:2])["skull"]["mesh"]["centroid_mm"]
        euler = head + ("Euler3DTransform_double_3_3\nParameters: 0 0 1.5707963267948966 1 2 3\n"
                        "FixedParameters: 10 20 30\n")
        centre = np.array([10, 20, 30])
        x, y, z = self.result("euler", self.moved("euler.tfm", euler))["moved"]["mesh"]["centroid_mm"] - centre
        # The file's map, a quarter turn about the centre and a shift, brings the moved place back.
        self.assertLess(np.abs(np.array([-y, x, z]) + centre + [1, 2, 3] - still).max(), 1e-6)
        shift = head + "TranslationTransform_double_3_3\nParameters: 1 2 3\nFixedParameters:\n"
        moved = self.result("shift", self.moved("shift.tfm", shift))["moved"]["mesh"]["centroid_mm"]
        self.assertLess(np.abs(np.add(moved, [1, 2, 3]) - still).max(), 1e-6)
        composite = (head + "CompositeTransform_double_3_3\n#Transform 1\nTransform: TranslationTransform_double_3_3\n"
                     "Parameters: 10 0 0\nFixedParameters:\n#Transform 2\nTransform: AffineTransform_float_3_3\n"
                     "Parameters: 0 -1 0 1 0 0 0 0 1 0 0 5\nFixedParameters: 0 0 0\n")
        c = self.result("both", self.moved("both.tfm", composite))["moved"]["mesh"]["centroid_mm"]
        # The last is applied first: a quarter turn, then 10 mm.
        self.assertLess(np.abs(np.array([-c[1] + 10, c[0], c[2] + 5]) - still).max(), 1e-6)

    def test_bad_files_are_refused_in_one_line(self):
        head = "#Insight Transform File V1.0\n"
        affine = head + "Transform: AffineTransform_double_3_3\nParameters: "
        for name, text, words in [
                ("no.tfm", "1 0 0 0\n", "begin with '#Insight Transform File'"),
                ("empty.tfm", head, "holds no transform"),
                ("grid.tfm", head + "Transform: BSplineTransform_double_3_3\nParameters: 1\n", "cannot be read"),
                ("flat.tfm", head + "Transform: AffineTransform_double_2_2\n", "not a transform of three-dimensional"),
                ("few.tfm", affine + "1 0 0\n", "has 3 parameters: it takes 12"),
                ("nan.tfm", affine + "nan 0 0\n", "not a finite number"),
                ("scaled.tfm", affine + "2 0 0 0 2 0 0 0 2 0 0 0\nFixedParameters: 0 0 0\n", "scales, shears"),
                ("thin.tfm", affine + "1 0 0 0 1 0 0 0 0 0 0 0\nFixedParameters: 0 0 0\n", "no inverse"),
                ("two.tfm", head + 2 * "Transform: IdentityTransform_double_3_3\n", "states their order")]:
            lines = self.refusal(self.moved(name, text))
            self.assertEqual(len(lines), 1, lines)
            self.assertIn(words, lines[0])
            self.assertIn(name, lines[0])
        plane = {"type": "Plane", "coordinateSystem": "LPS", "coordinateUnits": "mm", "planeType": "pointNormal",
                 "controlPoints": [{"position": [0, 0, 0]}]}
        for change, words in [
                ({}, "nor three placed points"),
                ({"type": "ROI"}, "has no markup of type Plane"),
                ({"baseToNode": [0] * 16}, "perpendicular"),
                ({"baseToNode": [1, 2]}, "must be a list of 16 numbers"),
                ({"coordinateSystem": "IJK"}, "is unknown: convert the points to LPS"),
                ({"baseToNode": np.eye(4).ravel().tolist()}, "no bounds")]:
            (self.folder / "plane.mrk.json").write_text(json.dumps({"markups": [dict(plane, **change)]}))
            lines = self.refusal([{"id": "skull", "do": "window", "scan": "ct", "low": 300},
                                  {"id": "sawn", "do": "saw", "object": "skull", "plane": "plane.mrk.json"}])
            self.assertEqual(len(lines), 1, lines)
            self.assertIn(words, lines[0])
        (self.folder / "plane.mrk.json").write_text("{")
        self.assertIn("plane.mrk.json", self.refusal([
            {"id": "side", "do": "mask", "planes": ["plane.mrk.json"]}])[0])
        self.assertIn("gone.mrk.json", self.refusal([
            {"id": "side", "do": "mask", "planes": ["gone.mrk.json"]}])[0])

    def test_a_nifti_label_map_holds_every_object_and_its_name(self):
        low = self.low
        steps = [{"id": "skull", "do": "window", "scan": "ct", "low": 300},
                 {"id": "cut", "do": "mask", "regions": [
                     {"view": "anterior", "polygons_mm": [[[-40, low], [40, low], [40, low + 45], [-40, low + 45]]]}]},
                 {"id": "piece", "do": "combine", "expression": "skull & cut"},
                 {"id": "rest", "do": "combine", "expression": "skull - cut"},
                 {"id": "apart", "do": "label_map", "object": "piece", "also": ["rest"], "path": "apart.nii.gz"},
                 {"id": "over", "do": "label_map", "object": "piece", "also": ["skull"], "path": "over.nii.gz"}]
        made = self.result("labels", steps)
        counts = {name: made[name]["voxel"]["voxels"] for name in ("piece", "rest", "skull")}
        folder = self.folder / "labels_result"
        found = {}
        for path in folder.rglob("*.nii.gz"):
            data = gzip.decompress(path.read_bytes())
            self.assertEqual(int(np.frombuffer(data[70:72], "<i2")[0]), 4)  # int16
            self.assertEqual(int(np.frombuffer(data[68:70], "<i2")[0]), 1002)  # NIFTI_INTENT_LABEL
            labels = np.frombuffer(data[int(np.frombuffer(data[108:112], "<f4")[0]):], "<i2")
            table = path.with_name(path.name.replace(".nii.gz", ".tsv")).read_text().splitlines()
            found[path.name] = ({n: int((labels == n).sum()) for n in (1, 2)}, table)
        self.assertEqual(found["apart.nii.gz"][0], {1: counts["piece"], 2: counts["rest"]})
        self.assertEqual(found["apart.nii.gz"][1], ["index\tname", "1\tpiece", "2\trest"])
        # A voxel has one label: the first object's, with a warning.
        self.assertEqual(found["over.nii.gz"][0], {1: counts["piece"], 2: counts["rest"]})
        result = json.loads((folder / "result.json").read_text())
        findings = {row["id"]: json.dumps(row) for row in result["exports"]}
        self.assertIn("WARN, labels", findings["over"])
        self.assertNotIn("WARN, labels", findings["apart"])

    def test_a_guessed_frame_is_a_warning(self):
        three = {"markups": [{"type": "Plane", "controlPoints": [{"position": p} for p in (
            [0, 0, self.low], [10, 0, self.low], [0, 10, self.low])]}]}
        (self.folder / "old.mrk.json").write_text(json.dumps(three))
        made = self.result("old", [{"id": "side", "do": "mask", "planes": ["old.mrk.json"]}])["side"]
        findings = json.dumps(made["findings"])
        for words in ("WARN, frame: the file names no coordinateSystem", "WARN, unit", "first three points"):
            self.assertIn(words, findings)
        # Its normal points up: the mask is all above.
        self.assertGreater(made["voxel"]["centroid_mm"][2], self.low)


if __name__ == "__main__":
    unittest.main()
