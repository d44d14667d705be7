# SPDX-License-Identifier: AGPL-3.0-or-later
"""A plan whose archive has an entry of every kind, and forgers who change one thing in it and correct the sums.

    pack_forgery.py FOLDER COUNT    writes into FOLDER an archive, COUNT forged ones and four that are none, and beside
                                    each what check_pack.py finds: NAME.zip.json
"""
import copy
import gzip
import hashlib
import importlib.util
import io
import json
import os
import random
import re
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[4]
CHECKER = ROOT / "planner/result/pack/check_pack.py"
PROGRAM = os.environ.get("OCTOTOMY_PROGRAM", "octotomy")

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
        self.before = copy.deepcopy((self.result, self.plan))

    def leave_out_dicom(self):
        """A pack need not have DICOM objects, so forgers of other entries leave out these copies of them."""
        manifest = json.loads(self.entries["manifest.json"])
        del manifest["dicom"]
        manifest["files"] = [file for file in manifest["files"] if not file["path"].startswith("dicom/")]
        self.entries = {name: data for name, data in self.entries.items() if not name.startswith("dicom/")}
        self.entries["manifest.json"] = json.dumps(manifest).encode()

    def ending(self, end):
        return self.chance.choice([name for name in self.entries if name.endswith(end)])

    def step(self, operation):
        return self.chance.choice([step for step in self.plan["steps"] if step["do"] == operation])

    def write(self, path):
        if self.plan != self.before[1]:
            self.result["plan"] = self.plan
            self.entries["plan.plan.json"] = json.dumps(self.plan).encode()
        if self.result != self.before[0]:
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


def value_of(data, tag, kind=b"", size="<I", skip=0):
    """First and last place of the value of a DICOM element, which is given as its bytes."""
    at = data.index(tag + kind) + len(tag + kind) + skip
    first = at + struct.calcsize(size)
    return first, first + struct.unpack(size, data[at:at + struct.calcsize(size)])[0]


def change_a_segment(forger):
    """One pixel of the segmentation."""
    name = "dicom/segmentation.dcm"
    data = bytearray(forger.entries[name])
    kind = b"OB" if b"\xe0\x7f\x10\x00OB" in data else b"OW"
    first, last = value_of(data, b"\xe0\x7f\x10\x00", kind, skip=2)
    # The last byte may be padding.
    data[forger.chance.randrange(first, last - 2)] ^= 1 << forger.chance.randrange(8)
    forger.entries[name] = bytes(data)


def shift_a_frame(forger):
    name = "dicom/segmentation.dcm"
    data = bytearray(forger.entries[name])
    places = [found.end() for found in re.finditer(re.escape(b"\x20\x00\x32\x00DS"), data)]
    at = forger.chance.choice(places)
    size = struct.unpack("<H", data[at:at + 2])[0]
    words = data[at + 2:at + 2 + size].decode().strip().split("\\")
    # By chance along an axis and to one side, as far as the new text has room.
    for axis, by in forger.chance.sample([(axis, by) for axis in range(3) for by in (-4, -1, 1, 4)], 12):
        moved = "\\".join(f"{float(x) + (by if k == axis else 0):.10g}" for k, x in enumerate(words)).encode()
        if len(moved) <= size:
            break
    data[at + 2:at + 2 + size] = moved.ljust(size)[:size]
    forger.entries[name] = bytes(data)


def change_a_contour(forger):
    """One digit before the point of one coordinate."""
    name = "dicom/structures.dcm"
    data = bytearray(forger.entries[name])
    at = forger.chance.choice([found.end() for found in re.finditer(re.escape(b"\x06\x30\x50\x00"), data)])
    size = struct.unpack("<I", data[at:at + 4])[0]
    words = data[at + 4:at + 4 + size].split(b"\\")
    word = forger.chance.randrange(len(words))
    digit = at + 4 + sum(len(each) + 1 for each in words[:word]) + words[word].startswith(b"-")
    data[digit] = ord("0") + (data[digit] - ord("0") + 1) % 10
    forger.entries[name] = bytes(data)


def leave_out_a_contour(forger):
    """Its last corner becomes its first one, which leaves a line that is not along the voxels' edges, or no area."""
    name = "dicom/structures.dcm"
    data = bytearray(forger.entries[name])
    at = forger.chance.choice([found.end() for found in re.finditer(re.escape(b"\x06\x30\x50\x00"), data)])
    size = struct.unpack("<I", data[at:at + 4])[0]
    corner = b"\\".join(bytes(data[at + 4:at + 4 + size]).split(b"\\")[:3])
    whole = b"\\".join([corner] * ((size + 1) // (len(corner) + 1)))
    data[at + 4:at + 4 + size] = whole.ljust(size)
    forger.entries[name] = bytes(data)


def change_the_unit(forger):
    name = forger.ending("model_001.dcm")
    data = forger.entries[name]
    forger.entries[name] = data.replace(b"\x08\x00\x00\x01SH\x02\x00mm", b"\x08\x00\x00\x01SH\x02\x00um", 1)


def change_the_model(forger):
    name = forger.ending("model_001.dcm")
    data = bytearray(forger.entries[name])
    first, _ = value_of(data, b"\x42\x00\x11\x00", b"OB", skip=2)
    count = struct.unpack("<I", data[first + 80:first + 84])[0]
    at = first + 84 + 50 * forger.chance.randrange(count) + 12 + 4 * forger.chance.randrange(9)
    data[at:at + 4] = struct.pack("<f", struct.unpack("<f", data[at:at + 4])[0] + forger.chance.choice([-2, 0.01, 0.3]))
    forger.entries[name] = bytes(data)


def change_the_plan_document(forger):
    name = "dicom/plan.dcm"
    data = bytearray(forger.entries[name])
    first = data.index(b'integrityCheckAlgorithm="SHA-256">') + 34
    at = first + forger.chance.randrange(data.index(b"</text>", first) - first - 4)
    data[at] = ord("A") if data[at] != ord("A") else ord("B")
    forger.entries[name] = bytes(data)


def change_the_patient(forger):
    name = forger.ending(forger.chance.choice([".dcm"]))
    data = bytearray(forger.entries[name])
    kind = b"LO" if b"\x10\x00\x20\x00LO" in data else b""
    first, _ = value_of(data, b"\x10\x00\x20\x00", kind, "<H" if kind else "<I")
    data[first] = ord("X") if data[first] != ord("X") else ord("Y")
    forger.entries[name] = bytes(data)


def hide_a_dicom_object(forger):
    """From the list of what is checked."""
    manifest = json.loads(forger.entries["manifest.json"])
    manifest["dicom"]["objects"].pop(forger.chance.randrange(len(manifest["dicom"]["objects"])))
    forger.entries["manifest.json"] = json.dumps(manifest).encode()


WAYS = [move_a_vertex, turn_a_triangle, lengthen_a_run, exchange_objects, change_the_threshold, change_a_polygon,
        change_the_motion, change_an_expression, change_a_verdict, change_a_volume, change_a_measurement,
        change_the_exported_file, shift_the_exported_file, change_an_exported_surface, change_an_exported_label_map,
        leave_out_a_row, leave_out_comparisons, leave_out_an_object, change_a_table, change_the_report]
DICOM_WAYS = [change_a_segment, shift_a_frame, change_a_contour, leave_out_a_contour, change_the_unit, change_the_model,
              change_the_plan_document, change_the_patient, hide_a_dicom_object]


def forged(path, count, seed=11):
    """Forged archives, one after another: the way of each, and the forger."""
    chance, ways = random.Random(seed), WAYS + DICOM_WAYS
    for i in range(count):
        way = ways[i % len(ways)]
        forger = Forger(path, chance)
        if way not in DICOM_WAYS:
            forger.leave_out_dicom()
        way(forger)
        yield way.__name__, forger


def hostile_entries():
    """Entries that ask for too much memory, for too deep a recursion, or are empty."""
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 3), }"
    header += b" " * (117 - len(header)) + b"\n"
    return {"witness/0/points.npy": b"\x93NUMPY\x01\x00" + bytes([118, 0]) + header,
            "result/result.json": b"[" * 200000 + b"]" * 200000,
            "witness/0/runs.npy": b""}


def make_series(folder):
    """The phantom of a head as a DICOM series."""
    made = run(PROGRAM, "phantom", "head", "--voxel", 2, "--dicom", "-o", folder)
    assert made.returncode == 0, made.stderr


def found_by_checker(path):
    """The lines that check_pack.py prints with --all; the reason where it refuses the archive."""
    spec = importlib.util.spec_from_file_location("check_pack", CHECKER)
    checker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(checker)
    try:
        findings = checker.Checker(checker.Archive(path)).run()
    except (checker.NoPack, KeyError, TypeError, AttributeError, IndexError, ValueError, OverflowError, RecursionError,
            MemoryError) as error:
        return {"refused": str(error)}
    return {"values": [[entry[1], checker.text_of(place), entry[0]] for place, entry in findings.values.items()],
            "claims": [list(claim) for claim in findings.claims]}


def main(folder, count):
    make_series(folder / "series")
    (folder / "my.plan.json").write_text(json.dumps(PLAN))
    good = folder / "good.zip"
    made = run(PROGRAM, "pack", folder / "my.plan.json", "--scan", f"ct={folder / 'series'}", "-o", good)
    assert made.returncode == 0, made.stderr
    paths = [good]
    for i, (way, forger) in enumerate(forged(good, count)):
        paths.append(folder / f"{i:03d}_{way}.zip")
        forger.write(paths[-1])
    for i, (entry, data) in enumerate(hostile_entries().items()):
        forger = Forger(good, random.Random(4))
        forger.entries[entry] = data
        paths.append(folder / f"hostile_{i}.zip")
        forger.write(paths[-1])
    paths.append(folder / "text.zip")
    paths[-1].write_text("no archive")
    for path in paths:
        path.with_name(path.name + ".json").write_text(json.dumps(found_by_checker(path)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
