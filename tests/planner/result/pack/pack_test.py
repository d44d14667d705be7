# SPDX-License-Identifier: AGPL-3.0-or-later
"""Packs: equal plans make equal archives, a replay finds no difference, and the independent checker finds every
forgery, although each forger corrects the sums in manifest.json."""
import copy
import gzip
import hashlib
import io
import json
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[4]
CHECKER = ROOT / "planner/result/pack/check_pack.py"
PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
FORGERIES = int(os.environ.get("OCTOTOMY_FORGERIES", "40"))

PLAN = {
    "octotomy_plan": 1, "name": "An advancement", "scans": {"ct": {"path": "head.nrrd"}},
    "universe": {"voxel_mm": 4.0},
    "steps": [
        {"id": "skull", "do": "window", "scan": "ct", "low": 300},
        {"id": "cut", "do": "mask", "regions": [
            {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]},
            {"view": "left", "polygons_mm": [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]]}]},
        {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
        {"id": "rest", "do": "combine", "expression": "skull - cut"},
        {"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 2],
         "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]}},
        {"id": "result", "do": "combine", "expression": "rest | advanced"},
        {"id": "fat", "do": "window", "scan": "ct", "low": -190, "high": -30},
        {"id": "size", "do": "measure", "object": "maxilla"},
        {"id": "interference", "do": "measure", "object": "rest", "to": "advanced"},
        {"id": "width", "do": "measure", "points_mm": [[-40, -60, -25], [40, -60, -25]]},
        {"id": "piece", "do": "export", "object": "advanced", "path": "maxilla.stl"}]
    + [{"id": f"file_{i}", "do": "export", "object": "advanced", "path": f"surface{ending}"}
       for i, ending in enumerate([".ply", ".obj", ".off", ".vtp", ".glb"])]
    + [{"id": f"voxels_{i}", "do": "export", "object": "result", "path": f"voxels_{i}{ending}"}
       for i, ending in enumerate([".nii.gz", ".nrrd"])]}


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300)


def array_of(data):
    return np.load(io.BytesIO(data)).copy()


def bytes_of(array):
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


class Forger:
    """An archive to change. Its sums are corrected when it is written."""

    def __init__(self, path, chance):
        with zipfile.ZipFile(path) as archive:
            self.entries = {name: archive.read(name) for name in archive.namelist()}
        self.chance = chance
        self.result = json.loads(self.entries["result/result.json"])
        self.plan = json.loads(self.entries["plan.plan.json"])

    def ending(self, end):
        return self.chance.choice([name for name in self.entries if name.endswith(end)])

    def step(self, operation):
        return self.chance.choice([step for step in self.plan["steps"] if step["do"] == operation])

    def write(self, path):
        if self.plan != json.loads(self.entries["plan.plan.json"]):
            self.result["plan"] = self.plan
            self.entries["plan.plan.json"] = json.dumps(self.plan).encode()
        if self.result != json.loads(self.entries["result/result.json"]):
            self.entries["result/result.json"] = json.dumps(self.result).encode()
        manifest = json.loads(self.entries["manifest.json"])
        for file in manifest["files"]:
            data = self.entries[file["path"]]
            file.update(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())
        self.entries["manifest.json"] = json.dumps(manifest).encode()
        with zipfile.ZipFile(path, "w") as archive:
            for name, data in self.entries.items():
                archive.writestr(name, data)


def move_a_vertex(forger):
    name = forger.ending("/points.npy")
    points = array_of(forger.entries[name])
    # In a direction by chance: within a plane of triangles a vertex can be moved without any effect.
    direction = np.array([forger.chance.gauss(0, 1) for _ in range(3)])
    points[forger.chance.randrange(len(points))] += (
        10 ** forger.chance.uniform(-1, 1) * direction / np.linalg.norm(direction))
    forger.entries[name] = bytes_of(points)


def turn_a_triangle(forger):
    name = forger.ending("/triangles.npy")
    triangles = array_of(forger.entries[name])
    at = forger.chance.randrange(len(triangles))
    triangles[at] = triangles[at][[1, 0, 2]]
    forger.entries[name] = bytes_of(triangles)


def lengthen_a_run(forger):
    name = forger.ending("/runs.npy")
    runs = array_of(forger.entries[name])
    runs[forger.chance.randrange(len(runs)), 3] += forger.chance.choice([-1, 1])
    forger.entries[name] = bytes_of(runs)


def exchange_objects(forger):
    a, b = forger.chance.sample([name for name in forger.entries if name.endswith("/runs.npy")], 2)
    forger.entries[a], forger.entries[b] = forger.entries[b], forger.entries[a]


def change_the_threshold(forger):
    forger.step("window")["low"] += forger.chance.choice([-60, -20, 15, 40, 100])


def change_a_polygon(forger):
    polygon = forger.chance.choice(forger.step("mask")["regions"])["polygons_mm"][0]
    middle = [sum(point[axis] for point in polygon) / len(polygon) for axis in (0, 1)]
    at = forger.chance.randrange(len(polygon))
    # Inwards: the other region's edges would hide what a polygon takes in besides.
    polygon[at] = [0.6 * polygon[at][axis] + 0.4 * middle[axis] for axis in (0, 1)]


def change_the_motion(forger):
    forger.step("move")["translate_mm"][forger.chance.randrange(3)] += forger.chance.choice([-0.5, 0.1, 2])


def change_an_expression(forger):
    step = forger.step("combine")
    sign = next(sign for sign in "&|-" if sign in step["expression"])
    step["expression"] = step["expression"].replace(sign, {"&": "-", "|": "^", "-": "&"}[sign])


def change_a_verdict(forger):
    certificate = forger.chance.choice(forger.result["certificates"])
    certificate["verdict"] = forger.chance.choice([v for v in ("PASS", "WARN", "FAIL") if v != certificate["verdict"]])
    for row in forger.result["objects"]:
        if row["id"] == certificate["object"]:
            row["verdict"] = certificate["verdict"]
    for verdict in ("PASS", "WARN", "FAIL"):
        forger.result["counts"][verdict] = sum(c["verdict"] == verdict for c in forger.result["certificates"])


def change_a_volume(forger):
    row = forger.chance.choice([row for row in forger.result["objects"] if row["mesh"]])
    row[forger.chance.choice(["voxel", "mesh"])]["volume_mm3"] *= 1.07


def change_a_measurement(forger):
    row = forger.chance.choice(forger.result["measurements"])
    key = next(key for key in ("volume_mm3", "overlap_mm3", "distance_mm") if key in row)
    row[key] = row[key] * 1.01 + 0.5


def change_the_exported_file(forger):
    name = forger.ending(".stl")
    data = bytearray(forger.entries[name])
    at = 84 + 50 * forger.chance.randrange((len(data) - 84) // 50) + 12
    data[at:at + 4] = struct.pack("<f", struct.unpack("<f", data[at:at + 4])[0] + 3)
    forger.entries[name] = bytes(data)


def shift_the_exported_file(forger):
    """As a whole, so that it stays closed and keeps its volume."""
    name = forger.ending(".stl")
    head, triangles = forger.entries[name][:84], forger.entries[name][84:]
    rows = np.frombuffer(triangles, np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])).copy()
    rows["p"][..., forger.chance.randrange(3)] += forger.chance.choice([-0.5, 0.05, 1])
    forger.entries[name] = head + rows.tobytes()


def change_an_exported_surface(forger):
    """One coordinate of its first vertex, in the place where each format has it."""
    name = forger.ending(forger.chance.choice(["surface.ply", "surface.vtp", "surface.glb", "surface.obj", "surface.off"]))
    data = forger.entries[name]
    kind = name[-4:]
    if kind in (".obj", ".off"):
        lines = data.split(b"\n")
        at = next(i for i, line in enumerate(lines) if line.startswith(b"v ")) if kind == ".obj" else 4
        words = lines[at].split()
        words[-1] = b"%.17g" % (float(words[-1]) + 0.25)
        lines[at] = b" ".join(words)
        forger.entries[name] = b"\n".join(lines)
        return
    at, word = {".ply": (data.find(b"end_header\n") + 11, "<d"), ".glb": (28 + struct.unpack("<I", data[12:16])[0], "<f"),
                ".vtp": (data.find(b"_", data.find(b"<AppendedData")) + 9 + int(re.search(
                    rb'Name="Points"[^>]*offset="(\d+)"', data).group(1)) if kind == ".vtp" else 0, "<d")}[kind]
    size = struct.calcsize(word)
    changed = struct.pack(word, struct.unpack(word, data[at:at + size])[0] + 0.25)
    forger.entries[name] = data[:at] + changed + data[at + size:]


def change_an_exported_label_map(forger):
    name = forger.ending(forger.chance.choice([".nii.gz", ".nrrd"]))
    data = forger.entries[name]
    at = data.index(b"\n\n") + 2 if name.endswith(".nrrd") else 0
    samples = bytearray(gzip.decompress(data[at:]))
    samples[(len(samples) - 352) // 2 // 2 * 2 + 352] ^= 1
    forger.entries[name] = data[:at] + gzip.compress(bytes(samples))
    row = next(row for row in forger.result["exports"] if name.endswith(row["path"]))
    row["bytes"] = len(forger.entries[name])
    show_on_page(forger)


def show_on_page(forger):
    """The report draws the result as it is now."""
    page = forger.entries["result/report.html"].decode()
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    data = dict(json.loads(found.group(1)), result=forger.result)
    text = json.dumps(data).replace("</", "<\\/")
    forger.entries["result/report.html"] = (page[:found.start(1)] + text + page[found.end(1):]).encode()


def leave_out_a_row(forger):
    forger.result["exports"].pop(forger.chance.randrange(len(forger.result["exports"])))
    show_on_page(forger)


def leave_out_comparisons(forger):
    forger.chance.choice(forger.result["certificates"])["comparisons"] = []
    show_on_page(forger)


def leave_out_an_object(forger):
    """Everywhere: in the lists of objects, of certificates and of its witnesses."""
    lost = "advanced"
    for part, key in (("objects", "id"), ("certificates", "object")):
        forger.result[part] = [row for row in forger.result[part] if row[key] != lost]
    manifest = json.loads(forger.entries["manifest.json"])
    manifest["objects"] = [row for row in manifest["objects"] if row["id"] != lost]
    forger.entries["manifest.json"] = json.dumps(manifest).encode()
    for verdict in ("PASS", "WARN", "FAIL"):
        forger.result["counts"][verdict] = sum(c["verdict"] == verdict for c in forger.result["certificates"])
    name = "result/tables/certificates.csv"
    forger.entries[name] = b"".join(line for line in forger.entries[name].splitlines(True)
                                    if not line.startswith(lost.encode()))
    show_on_page(forger)


def change_a_table(forger):
    name = "result/tables/certificates.csv"
    forger.entries[name] = forger.entries[name].replace(b"PASS", b"FAIL", 1)


def change_the_report(forger):
    name = "result/report.html"
    forger.entries[name] = forger.entries[name].replace(b'"verdict":"PASS"', b'"verdict":"FAIL"', 1)


WAYS = [move_a_vertex, turn_a_triangle, lengthen_a_run, exchange_objects, change_the_threshold, change_a_polygon,
        change_the_motion, change_an_expression, change_a_verdict, change_a_volume, change_a_measurement,
        change_the_exported_file, shift_the_exported_file, change_an_exported_surface, change_an_exported_label_map,
        leave_out_a_row, leave_out_comparisons, leave_out_an_object, change_a_table, change_the_report]


class Pack(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        cls.scan = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_2.nrrd"
        (cls.folder / "my.plan.json").write_text(json.dumps(PLAN))
        cls.archive = cls.folder / "a.zip"
        made = cls.pack("my.plan.json", "a.zip")
        assert made.returncode == 0, made.stderr

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    @classmethod
    def pack(cls, plan, name, *more):
        return run(PROGRAM, "pack", cls.folder / plan, "--scan", f"ct={cls.scan}", "-o", cls.folder / name, *more)

    def check(self, path, *more):
        return run(sys.executable, CHECKER, path, *more)

    def test_equal_plans_make_equal_archives_on_any_thread_count(self):
        self.assertEqual(self.pack("my.plan.json", "b.zip", "--threads", 1).returncode, 0)
        self.assertEqual(self.archive.read_bytes(), (self.folder / "b.zip").read_bytes())

    def test_the_checker_confirms_and_contradicts_nothing(self):
        checked = self.check(self.archive, "--json")
        self.assertEqual(checked.returncode, 0, checked.stdout)
        found = json.loads(checked.stdout)
        self.assertEqual(found["contradictions"], [])
        numbers = found["numbers"]
        self.assertGreater(numbers["confirmed"], 0.45 * sum(numbers.values()), numbers)
        states = {value["where"]: value["state"] for value in found["values"]}
        for where in ("objects / 2 / voxel / volume_mm3", "objects / 2 / mesh / area_mm2",
                      "certificates / 1 / difference_mm3", "exports / 0 / volume_mm3"):
            self.assertEqual(states[where], "confirmed", where)

    def test_every_forgery_is_contradicted(self):
        chance = random.Random(11)
        for i in range(FORGERIES):
            way = WAYS[i % len(WAYS)]
            with self.subTest(forgery=i, way=way.__name__):
                forger = Forger(self.archive, chance)
                before = copy.deepcopy(forger.entries)
                way(forger)
                forger.write(self.folder / "forged.zip")
                self.assertNotEqual(before, forger.entries)
                checked = self.check(self.folder / "forged.zip")
                self.assertEqual(checked.returncode, 1, checked.stdout + checked.stderr)
                self.assertIn("contradicted:", checked.stdout)

    def test_a_changed_entry_is_named_where_its_sum_is_not_corrected(self):
        with zipfile.ZipFile(self.archive) as archive:
            entries = {name: archive.read(name) for name in archive.namelist()}
        entries["result/maxilla.stl"] += b" "
        with zipfile.ZipFile(self.folder / "changed.zip", "w") as archive:
            for name, data in entries.items():
                archive.writestr(name, data)
        checked = self.check(self.folder / "changed.zip")
        self.assertEqual(checked.returncode, 1)
        self.assertIn("result/maxilla.stl", checked.stdout)
        replayed = run(PROGRAM, "verify", self.folder / "changed.zip", "--scan", f"ct={self.scan}")
        self.assertEqual(replayed.returncode, 2)
        self.assertIn("result/maxilla.stl", replayed.stderr)

    def test_a_replay_differs_in_nothing(self):
        replayed = run(PROGRAM, "verify", self.archive, "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual((pack["different_values"], pack["different_entries"]), ([], []))
        self.assertGreater(pack["values"], 500)

    def test_a_replay_names_the_values_that_were_changed(self):
        forger = Forger(self.archive, random.Random(1))
        forger.result["objects"][2]["voxel"]["volume_mm3"] += 64
        forger.write(self.folder / "forged.zip")
        replayed = run(PROGRAM, "verify", self.folder / "forged.zip", "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 1)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual([value["where"] for value in pack["different_values"]],
                         ["objects / maxilla / voxel / volume_mm3"])
        self.assertEqual(pack["different_entries"], ["result/result.json"])

    def test_a_replay_names_an_entry_that_was_changed_alone(self):
        forger = Forger(self.archive, random.Random(2))
        move_a_vertex(forger)
        forger.write(self.folder / "forged.zip")
        replayed = run(PROGRAM, "verify", self.folder / "forged.zip", "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 1)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual(pack["different_values"], [])
        self.assertEqual(len(pack["different_entries"]), 1)
        self.assertIn("points.npy", pack["different_entries"][0])

    def test_what_a_manifest_leaves_out_is_contradicted(self):
        for key, kind in (("samples", "window"), ("points", "surface"), ("image_of", "image")):
            with self.subTest(key=key):
                forger = Forger(self.archive, random.Random(3))
                manifest = json.loads(forger.entries["manifest.json"])
                for row in manifest["objects"]:
                    row.pop(key, None)
                forger.entries["manifest.json"] = json.dumps(manifest).encode()
                forger.write(self.folder / "forged.zip")
                checked = self.check(self.folder / "forged.zip")
                self.assertEqual(checked.returncode, 1, checked.stdout)
                self.assertIn(kind, checked.stdout)

    def test_hostile_entries_are_refused_in_one_line(self):
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 3), }"
        header += b" " * (117 - len(header)) + b"\n"
        hostile = {"witness/0/points.npy": b"\x93NUMPY\x01\x00" + bytes([118, 0]) + header,
                   "result/result.json": b"[" * 200000 + b"]" * 200000,
                   "witness/0/runs.npy": b""}
        for name, data in hostile.items():
            with self.subTest(entry=name):
                forger = Forger(self.archive, random.Random(4))
                forger.entries[name] = data
                manifest = json.loads(forger.entries["manifest.json"])
                for file in manifest["files"]:
                    entry = forger.entries[file["path"]]
                    file.update(bytes=len(entry), sha256=hashlib.sha256(entry).hexdigest())
                forger.entries["manifest.json"] = json.dumps(manifest).encode()
                with zipfile.ZipFile(self.folder / "hostile.zip", "w") as archive:
                    for entry, content in forger.entries.items():
                        archive.writestr(entry, content)
                checked = self.check(self.folder / "hostile.zip")
                self.assertEqual(checked.returncode, 2, checked.stdout + checked.stderr)
                self.assertEqual(len(checked.stderr.strip().splitlines()), 1, checked.stderr)

    def test_other_files_are_refused_in_one_line(self):
        with zipfile.ZipFile(self.folder / "other.zip", "w") as archive:
            archive.writestr("a.txt", "a")
        (self.folder / "text.zip").write_text("no archive")
        for name in ("other.zip", "text.zip"):
            for found in (self.check(self.folder / name), run(PROGRAM, "verify", self.folder / name)):
                self.assertEqual(found.returncode, 2, found.stderr)
                self.assertEqual(len(found.stderr.strip().splitlines()), 1, found.stderr)
                self.assertIn(name, found.stderr)
        refused = self.pack("my.plan.json", "a.tar")
        self.assertEqual(refused.returncode, 2)
        self.assertIn(".zip", refused.stderr)


if __name__ == "__main__":
    unittest.main()
