#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Checks an archive of `octotomy pack` without Octotomy: needs only Python 3 and NumPy.

    check_pack.py ARCHIVE.zip [--json] [--all]

Computes numbers of result.json again from the surfaces, voxels and samples that the archive carries, and
states for each number of its objects, certificates, measurements, movements and exports whether it is
confirmed, contradicted or not checked. Exits with 0; with 1 if anything is contradicted; with 2 if the file
is no such archive. All lengths are in mm, coordinates in DICOM's patient frame, LPS.
"""
import base64
import csv
import functools
import hashlib
import io
import json
import math
import re
import struct
import sys
import zipfile
import zlib

import numpy as np

FORMAT = 1
# Relative tolerance for sums of up to 10^7 numbers in double precision, added in another order.
SUM = 1e-9
MOST_BYTES = 1 << 33
# What every certificate of the bounded tier compares.
COMPARED = ("volume", "symmetric difference", "centroid", "parts")


class NoPack(Exception):
    """The file is no archive that can be checked; the text says why."""


class Findings:
    """The verdict on each number, by its path in result.json, and on each other claim."""

    def __init__(self, result):
        self.values = {}  # path -> [number, state, reason]
        self.claims = []  # (state, text)
        for part in ("objects", "certificates", "measurements", "movements", "exports"):
            self._collect(result.get(part, []), (part,))

    def _collect(self, value, path):
        if isinstance(value, dict):
            for key, member in value.items():
                self._collect(member, path + (key,))
        elif isinstance(value, list):
            for i, member in enumerate(value):
                self._collect(member, path + (i,))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            self.values[path] = [value, "not checked", ""]

    def number(self, path, computed, tolerance=0.0, how=""):
        """Compares a number, or a nested list of numbers, with what was computed for it."""
        computed = np.asarray(computed, dtype=float)
        for index in np.ndindex(computed.shape):
            entry = self.values.get(path + tuple(int(i) for i in index))
            if entry is None:
                self.claim(False, f"{text_of(path)}: a number is missing, {computed[index]!r} was computed")
                continue
            allowed = float(np.asarray(tolerance)) + SUM * abs(float(computed[index]))
            right = abs(entry[0] - float(computed[index])) <= allowed
            if entry[1] == "contradicted":
                continue
            entry[1] = "confirmed" if right else "contradicted"
            entry[2] = how if right else f"{float(computed[index])!r} was computed: {how}"

    def claim(self, holds, text):
        self.claims.append(("confirmed" if holds else "contradicted", text))

    def counts(self):
        counts = {"confirmed": 0, "contradicted": 0, "not checked": 0}
        for entry in self.values.values():
            counts[entry[1]] += 1
        return counts

    def contradictions(self):
        found = [f"{text_of(p)} is {e[0]!r}, but {e[2]}" for p, e in self.values.items() if e[1] == "contradicted"]
        return found + [text for state, text in self.claims if state == "contradicted"]


def text_of(path):
    return " / ".join(str(part) for part in path)


class Archive:
    """The entries of the archive, with their sums checked on reading."""

    def __init__(self, path):
        try:
            self.zip = zipfile.ZipFile(path)
            names = [info.filename for info in self.zip.infolist()]
        except (OSError, zipfile.BadZipFile) as error:
            raise NoPack(f"{path}: cannot be read as a zip archive: {error}") from error
        self.repeated = sorted({name for name in names if names.count(name) > 1})
        self.sizes = {info.filename: info.file_size for info in self.zip.infolist()}
        if sum(self.sizes.values()) > MOST_BYTES:
            raise NoPack(f"{path}: would unpack to more than 8 GB")
        if "manifest.json" not in self.sizes:
            raise NoPack(f"{path}: has no manifest.json, so it is no archive of octotomy pack")
        self.manifest = self.json("manifest.json")
        if self.manifest.get("octotomy_pack") != FORMAT:
            raise NoPack(f"{path}: its format is {self.manifest.get('octotomy_pack')!r}; this program checks {FORMAT}")

    def bytes(self, name):
        if name not in self.sizes:
            raise NoPack(f"the entry {name} is missing")
        try:
            return self.zip.read(name)
        except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError) as error:
            raise NoPack(f"the entry {name} is damaged: {error}") from error

    def json(self, name):
        try:
            return json.loads(self.bytes(name).decode("utf-8"))
        except (ValueError, RecursionError) as error:
            raise NoPack(f"the entry {name} is no JSON: {error}") from error

    def array(self, name, columns):
        try:
            array = np.load(io.BytesIO(self.bytes(name)), allow_pickle=False)
        except (ValueError, EOFError, MemoryError) as error:
            raise NoPack(f"the entry {name} is no array: {error}") from error
        if array.ndim != 2 or array.shape[1] != columns:
            raise NoPack(f"the entry {name} has the shape {array.shape}, not rows of {columns}")
        return array

    def check(self, findings):
        listed = set()
        for file in self.manifest.get("files", []):
            name = file["path"]
            listed.add(name)
            if name not in self.sizes:
                findings.claim(False, f"{name}: listed in manifest.json and missing")
                continue
            whole = hashlib.sha256(self.bytes(name)).hexdigest() == file["sha256"]
            findings.claim(whole and self.sizes[name] == file["bytes"],
                           f"{name}: its bytes have the SHA-256 and the length in manifest.json")
        for name in sorted(set(self.sizes) - listed - {"manifest.json"}):
            findings.claim(False, f"{name}: is not listed in manifest.json")
        for name in self.repeated:
            findings.claim(False, f"{name}: is in the archive more than once")


class Universe:
    """The cube of voxels: from indices of voxels to LPS mm."""

    def __init__(self, manifest):
        self.side = int(manifest["side"])
        self.matrix = np.array(manifest["lps_from_voxel"], dtype=float)
        if not 4 <= self.side <= 4096 or self.matrix.shape != (4, 4) or not np.isfinite(self.matrix).all():
            raise NoPack("manifest.json: the universe is none")
        self.voxel_mm3 = abs(np.linalg.det(self.matrix[:3, :3]))

    def lps_mm(self, voxels):
        return np.asarray(voxels, dtype=float) @ self.matrix[:3, :3].T + self.matrix[:3, 3]


class Voxels:
    """A set of voxels as runs along x: rows z, y, first x, x after the last."""

    def __init__(self, runs, universe):
        self.runs = runs.astype(np.int64)
        self.universe = universe
        z, y, first, end = self.runs.T if len(self.runs) else np.zeros((4, 0), dtype=np.int64)
        side = universe.side
        inside = (z >= 0) & (y >= 0) & (first >= 0) & (first < end) & (end <= side) & (y < side) & (z < side)
        row = z * side + y
        ordered = (row[1:] > row[:-1]) | ((row[1:] == row[:-1]) & (first[1:] > end[:-1]))
        self.sound = bool(inside.all() and ordered.all())
        # One number for each voxel border: runs alternate between inside and outside along these.
        self.borders = np.stack([row * (side + 1) + first, row * (side + 1) + end], axis=1).ravel()

    @functools.cached_property
    def measures(self):
        """Count, volume, centroid, box and inertia about the centroid (density 1) of the voxels' cubes."""
        z, y, first, end = self.runs.T.astype(float)
        n = end - first
        count = float(n.sum())
        if count == 0:
            return {"voxels": 0, "volume_mm3": 0.0}
        middle = np.stack([(first + end - 1) / 2, y, z], axis=1)
        mean = (middle * n[:, None]).sum(axis=0) / count
        off = middle - mean
        second = (off * n[:, None]).T @ off
        second[0, 0] += (n * (n * n - 1) / 12).sum()
        # Each voxel is a cube, not a point.
        second += np.eye(3) * count / 12
        matrix = self.universe.matrix[:3, :3]
        in_mm = matrix @ second @ matrix.T * self.universe.voxel_mm3
        low = np.array([first.min(), y.min(), z.min()]) - 0.5
        high = np.array([end.max() - 1, y.max(), z.max()]) + 0.5
        corners = self.universe.lps_mm([[x, v, w] for x in (low[0], high[0]) for v in (low[1], high[1])
                                        for w in (low[2], high[2])])
        return {"voxels": int(count), "volume_mm3": count * self.universe.voxel_mm3,
                "centroid_mm": self.universe.lps_mm(mean), "extents_mm": [corners.min(axis=0), corners.max(axis=0)],
                "inertia_mm5": np.trace(in_mm) * np.eye(3) - in_mm}

    def distance_mm(self, p_mm):
        """From a point to the nearest face between a voxel inside and one outside; none for oblique universes."""
        matrix, side = self.universe.matrix, self.universe.side
        size = np.diag(matrix[:3, :3])
        if np.abs(matrix[:3, :3] - np.diag(size)).max() > 0 or (size <= 0).any() or not len(self.borders):
            return None
        at = (np.asarray(p_mm) - matrix[:3, 3]) / size
        stride, best = side + 1, math.inf
        # Faces along x are the runs' ends; those along y and z are where a row and its neighbour differ.
        rows, x = self.borders // stride, self.borders % stride
        for axis, step in ((1, 1), (2, side)):
            shifted = self.borders + step * stride
            faces = combined([self.borders, shifted], lambda s: s[0] ^ s[1])
            first, end = faces[0::2], faces[1::2]
            row = first // stride
            y, z = row % side, row // side
            d = np.stack([np.maximum(np.maximum(first % stride - 0.5 - at[0], at[0] - (end - row * stride) + 0.5), 0),
                          np.maximum(np.abs(y - at[1]) - 0.5, 0), np.maximum(np.abs(z - at[2]) - 0.5, 0)])
            d[axis] = np.abs((y, z)[axis - 1] - 0.5 - at[axis])
            best = min(best, float(((d * size[:, None]) ** 2).sum(axis=0).min()))
        d = np.stack([np.abs(x - 0.5 - at[0]), np.maximum(np.abs(rows % side - at[1]) - 0.5, 0),
                      np.maximum(np.abs(rows // side - at[2]) - 0.5, 0)])
        return math.sqrt(min(best, float(((d * size[:, None]) ** 2).sum(axis=0).min())))

    def slice(self, z, low=0, high=None):
        """The voxels of rows low .. high - 1 of a slice as truth values, y then x."""
        side = self.universe.side
        high = side if high is None else high
        begin, stop = ((z * side + row) * (side + 1) for row in (low, high))
        first, end = np.searchsorted(self.borders, [begin, stop])
        borders = self.borders[first:end] - begin
        edges = np.zeros(stop - begin, dtype=np.int8)
        edges[borders[0::2]] = 1
        edges[borders[1::2]] -= 1
        return np.cumsum(edges, dtype=np.int8).reshape(high - low, side + 1)[:, :side].astype(bool)

    def in_slice(self, z):
        """The number of a slice's voxels."""
        size = self.universe.side * (self.universe.side + 1)
        borders = self.borders[slice(*np.searchsorted(self.borders, [z * size, (z + 1) * size]))]
        return int((borders[1::2] - borders[0::2]).sum())

    def has(self, voxels):
        side = self.universe.side
        x, y, z = np.asarray(voxels, dtype=np.int64).T
        place = (z * side + y) * (side + 1) + x
        return np.searchsorted(self.borders, place, side="right") % 2 == 1


def combined(parts, rule):
    """The borders of a Boolean of sets that are given by their borders."""
    borders = np.unique(np.concatenate(parts)) if parts else np.zeros(0, dtype=np.int64)
    states = [np.searchsorted(part, borders, side="right") % 2 == 1 for part in parts]
    inside = rule(states)
    before = np.concatenate([[False], inside[:-1]]) if len(inside) else inside
    return borders[inside != before]


class Expression:
    """A combination's expression: | ^ & - from weak to strong, ~ and parentheses, names of objects."""

    def __init__(self, text):
        self.tokens = re.findall(r"[A-Za-z_][\w.]*|[|^&\-~()]|\S", text)
        self.at = 0
        self.names = []
        self.tree = self._level(0)
        if self.at != len(self.tokens):
            raise ValueError("the expression goes on")

    def _peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def _level(self, level):
        signs = "|^&-"
        if level == len(signs):
            return self._term()
        left = self._level(level + 1)
        while self._peek() == signs[level]:
            self.at += 1
            left = (signs[level], left, self._level(level + 1))
        return left

    def _term(self):
        token = self._peek()
        self.at += 1
        if token == "(":
            inner = self._level(0)
            if self._peek() != ")":
                raise ValueError("a parenthesis is not closed")
            self.at += 1
            return inner
        if token == "~":
            return ("~", self._term(), None)
        if not re.fullmatch(r"[A-Za-z_][\w.]*", token) or self._peek() == "(":
            raise ValueError(f"'{token}' is no name of an object")
        if token not in self.names:
            self.names.append(token)
        return token

    def rule(self, states):
        by_name = dict(zip(self.names, states))

        def of(tree):
            if isinstance(tree, str):
                return by_name[tree]
            sign, a, b = tree
            a = of(a)
            if sign == "~":
                return ~a
            b = of(b)
            return {"|": a | b, "^": a ^ b, "&": a & b, "-": a & ~b}[sign]
        return of(self.tree)


class Surface:
    """A closed surface of triangles."""

    def __init__(self, points, triangles):
        self.points = points.astype(float)
        self.triangles = triangles.astype(np.int64)
        self.sound = bool(np.isfinite(self.points).all() and (self.triangles >= 0).all()
                          and (self.triangles < len(self.points)).all())

    def is_closed(self):
        """Whether every side of a triangle is that of another one, in the other direction."""
        a, b = self.triangles.ravel(), self.triangles[:, [1, 2, 0]].ravel()
        n = len(self.points)
        return bool(np.array_equal(np.sort(a * n + b), np.sort(b * n + a)))

    @functools.cached_property
    def measures(self):
        if len(self.triangles) == 0:
            return {"volume_mm3": 0.0, "area_mm2": 0.0}
        middle = self.points[np.unique(self.triangles)].mean(axis=0)
        p = (self.points - middle)[self.triangles]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        six = np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2]))
        volume = math.fsum(six) / 6
        if volume == 0:
            return {"volume_mm3": 0.0, "area_mm2": float(np.sqrt((normal ** 2).sum(axis=1)).sum() / 2)}
        total = p.sum(axis=1)
        centroid = (six[:, None] * total).sum(axis=0) / 24 / volume
        second = (np.einsum("i,ij,ik->jk", six, total, total)
                  + np.einsum("i,ikj,ikl->jl", six, p, p)) / 120 - volume * np.outer(centroid, centroid)
        used = self.points[np.unique(self.triangles)]
        return {"volume_mm3": volume, "area_mm2": math.fsum(np.sqrt((normal ** 2).sum(axis=1))) / 2,
                "centroid_mm": centroid + middle, "extents_mm": [used.min(axis=0), used.max(axis=0)],
                "inertia_mm5": np.trace(second) * np.eye(3) - second}

    def borders(self, universe):
        """The surface's interior at the voxels' centres, as borders of runs along x. The rays run 1e-7 of a voxel
        beside the centres' rows, so that none meets an edge of round coordinates."""
        inverse = np.linalg.inv(universe.matrix[:3, :3])
        p = (self.points - universe.matrix[:3, 3]) @ inverse.T + np.array([0.0, 1.3e-7, 2.9e-7])
        p = p[self.triangles]
        side = universe.side
        low = np.ceil(p[:, :, 1:].min(axis=1)).astype(np.int64)
        high = np.floor(p[:, :, 1:].max(axis=1)).astype(np.int64)
        low, high = np.maximum(low, 0), np.minimum(high, side - 1)
        size = np.maximum(high - low + 1, 0)
        per = size[:, 0] * size[:, 1]
        which = np.repeat(np.arange(len(p)), per)
        within = np.arange(len(which)) - np.repeat(np.cumsum(per) - per, per)
        y = low[which, 0] + within % np.maximum(size[which, 0], 1)
        z = low[which, 1] + within // np.maximum(size[which, 0], 1)
        a, b, c = (p[which, i] for i in range(3))

        def edge(u, v):
            return (v[:, 1] - u[:, 1]) * (z - u[:, 2]) - (v[:, 2] - u[:, 2]) * (y - u[:, 1])
        wc, wa, wb = edge(a, b), edge(b, c), edge(c, a)
        hit = ((wa > 0) & (wb > 0) & (wc > 0)) | ((wa < 0) & (wb < 0) & (wc < 0))
        wa, wb, wc = wa[hit], wb[hit], wc[hit]
        x = (wa * a[hit, 0] + wb * b[hit, 0] + wc * c[hit, 0]) / (wa + wb + wc)
        first = np.clip(np.ceil(x).astype(np.int64), 0, side)
        borders = np.sort((z[hit] * side + y[hit]) * (side + 1) + first)
        # Two crossings between the same two centres enclose none of them.
        values, counts = np.unique(borders, return_counts=True)
        return values[counts % 2 == 1]


def distance_to_triangles(p, corners):
    """From a point to the nearest of some triangles (n, 3, 3): its foot on the plane, or on the sides."""
    a, b, c = corners[:, 0] - p, corners[:, 1] - p, corners[:, 2] - p
    best = math.inf
    for u, v in ((a, b), (b, c), (c, a)):
        d = v - u
        long2 = np.maximum((d * d).sum(axis=1), 1e-300)
        t = np.clip(-(u * d).sum(axis=1) / long2, 0, 1)
        foot = u + t[:, None] * d
        best = min(best, float((foot * foot).sum(axis=1).min()))
    normal = np.cross(b - a, c - a)
    long2 = (normal * normal).sum(axis=1)
    over = ((np.cross(a, b) * normal).sum(axis=1) >= 0) & ((np.cross(b, c) * normal).sum(axis=1) >= 0) \
        & ((np.cross(c, a) * normal).sum(axis=1) >= 0) & (long2 > 0)
    if over.any():
        best = min(best, float(((a[over] * normal[over]).sum(axis=1) ** 2 / long2[over]).min()))
    return math.sqrt(best)


def dihedral_angles(tets):
    """The six angles between faces of each tetrahedron (n, 4, 3), in degrees."""
    def outward(i, j, k, opposite):
        normal = np.cross(tets[:, j] - tets[:, i], tets[:, k] - tets[:, i])
        turned = ((tets[:, opposite] - tets[:, i]) * normal).sum(axis=1) > 0
        normal[turned] *= -1
        return normal / np.linalg.norm(normal, axis=1)[:, None]
    normals = [outward(1, 2, 3, 0), outward(0, 2, 3, 1), outward(0, 1, 3, 2), outward(0, 1, 2, 3)]
    angles = [180 - np.degrees(np.arccos(np.clip((normals[i] * normals[j]).sum(axis=1), -1, 1)))
              for i in range(4) for j in range(i)]
    return np.array(angles)


def length(borders):
    return int((borders[1::2] - borders[0::2]).sum()) if len(borders) % 2 == 0 else -1


# View -> (right, up), unit vectors in LPS.
VIEWS = {"anterior": ((1, 0, 0), (0, 0, 1)), "posterior": ((-1, 0, 0), (0, 0, 1)), "left": ((0, 1, 0), (0, 0, 1)),
         "right": ((0, -1, 0), (0, 0, 1)), "superior": ((-1, 0, 0), (0, -1, 0)), "inferior": ((1, 0, 0), (0, -1, 0))}


def in_polygons(polygons, u, v):
    """Even-odd rule over all polygons."""
    inside = np.zeros(len(u), dtype=bool)
    for polygon in polygons:
        points = np.asarray(polygon, dtype=float)
        for a, b in zip(np.roll(points, 1, axis=0), points):
            if a[1] == b[1]:
                continue
            crosses = (a[1] > v) != (b[1] > v)
            inside ^= crosses & (u < (b[0] - a[0]) * (v - a[1]) / (b[1] - a[1]) + a[0])
    return inside


def near_edges(polygons, u, v, within):
    """Whether a point is so near to an edge that rounding decides."""
    near = np.zeros(len(u), dtype=bool)
    for polygon in polygons:
        points = np.asarray(polygon, dtype=float)
        for a, b in zip(np.roll(points, 1, axis=0), points):
            d = b - a
            long2 = float(d @ d)
            t = np.clip(((u - a[0]) * d[0] + (v - a[1]) * d[1]) / long2, 0, 1) if long2 > 0 else np.zeros(len(u))
            near |= (u - a[0] - t * d[0]) ** 2 + (v - a[1] - t * d[1]) ** 2 <= within ** 2
    return near


def rotation(degrees, axis):
    """Rodrigues' formula."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def motion_of(step):
    """The 4x4 matrix of a step that states its motion by numbers alone; None where it does not."""
    known = {"id", "do", "object", "translate_mm", "rotate", "matrix", "note"}
    if step.get("do") != "move" or set(step) - known:
        return None
    if "matrix" in step:
        return np.array(step["matrix"], dtype=float)
    matrix = np.eye(4)
    turn = step.get("rotate")
    if turn:
        about = np.array(turn.get("about_mm", [0, 0, 0]), dtype=object)
        if set(turn) - {"degrees", "axis", "about_mm"} or "axis" not in turn or about.shape != (3,):
            return None
        about = about.astype(float)
        matrix[:3, :3] = rotation(turn["degrees"], turn["axis"])
        matrix[:3, 3] = about - matrix[:3, :3] @ about
    matrix[:3, 3] += np.array(step.get("translate_mm", [0, 0, 0]), dtype=float)
    return matrix


class VoxelFile:
    """Labels over z, y, x of a volume file, and its place: from indices of voxels, x first, to LPS mm."""

    def __init__(self, labels, lps_from_voxel):
        self.labels, self.lps_from_voxel = labels, lps_from_voxel


def inflated(data):
    """Unpacks gzip; refuses more than MOST_BYTES."""
    unpacker = zlib.decompressobj(zlib.MAX_WBITS | 16)
    made = unpacker.decompress(data, MOST_BYTES)
    if unpacker.unconsumed_tail or not unpacker.eof:
        raise ValueError("its packed samples are cut short or too large")
    return made


def read_stl(data):
    count = struct.unpack("<I", data[80:84])[0]
    if len(data) != 84 + 50 * count:
        raise ValueError("it is cut short")
    corners = np.frombuffer(data, dtype=np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]), offset=84)["p"]
    return corners.reshape(-1, 3).astype(float), np.arange(3 * count).reshape(-1, 3)


def read_ply(data):
    header, body = data.split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        raise ValueError("it is not binary PLY")
    counts = {line[1]: int(line[2]) for line in lines if line[0] == "element"}
    numbers = {"double": "<f8", "float": "<f4", "uchar": "u1", "int": "<i4"}
    of_vertex = np.dtype([(line[2], numbers[line[1]]) for line in lines if line[0] == "property" and len(line) == 3])
    of_face = np.dtype([("n", "u1"), ("p", "<i4", 3)])
    vertices = np.frombuffer(body, of_vertex, counts["vertex"])
    faces = np.frombuffer(body, of_face, counts["face"], of_vertex.itemsize * counts["vertex"])
    return np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float), faces["p"]


def read_obj(data):
    lines = [line.split() for line in data.decode().splitlines()]
    points = [[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]]
    return np.array(points), np.array([[int(x.split("/")[0]) - 1 for x in line[1:]] for line in lines if line[:1] == ["f"]])


def read_off(data):
    words = [line.split() for line in data.decode().splitlines()[1:] if line and not line.startswith("#")]
    vertices, faces = int(words[0][0]), int(words[0][1])
    points = np.array([row[:3] for row in words[1:1 + vertices]], dtype=float)
    return points, np.array([row[1:4] for row in words[1 + vertices:1 + vertices + faces]], dtype=np.int64)


def read_vtp(data):
    head, body = data.split(b'<AppendedData encoding="raw">', 1)
    body = body[body.index(b"_") + 1:]

    def array(name, kind):
        offset = int(re.search(rb'Name="' + name + rb'"[^>]*offset="(\d+)"', head).group(1))
        size = struct.unpack("<Q", body[offset:offset + 8])[0]
        return np.frombuffer(body[offset + 8:offset + 8 + size], kind)
    return array(b"Points", "<f8").reshape(-1, 3), array(b"connectivity", "<i8").reshape(-1, 3)


def read_glb(data):
    size = struct.unpack("<I", data[12:16])[0]
    scene, buffer = json.loads(data[20:20 + size]), data[28 + size:]

    def array(number, kind):
        accessor = scene["accessors"][number]
        view = scene["bufferViews"][accessor["bufferView"]]
        return np.frombuffer(buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]], kind)
    # Metres and y upward, of millimetres in LPS; column by column.
    if scene["nodes"][0]["matrix"] != [0.001, 0, 0, 0, 0, 0, -0.001, 0, 0, 0.001, 0, 0, 0, 0, 0, 1]:
        raise ValueError("its place in the scene is another one")
    part = scene["meshes"][0]["primitives"][0]
    return (array(part["attributes"]["POSITION"], "<f4").reshape(-1, 3).astype(float),
            array(part["indices"], "<u4").reshape(-1, 3).astype(np.int64))


NUMBERS = {"uint8": "u1", "uchar": "u1", "unsigned char": "u1", "int16": "<i2", "short": "<i2", "uint16": "<u2",
           "ushort": "<u2", "unsigned short": "<u2"}


def read_nrrd(data):
    header, body = data.split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
    sizes = [int(x) for x in fields["sizes"].split()]
    if fields["space"] != "left-posterior-superior" or len(sizes) != 3:
        raise ValueError("it is no volume in LPS")
    vectors = [[float(x) for x in v.split(",")] for v in re.findall(r"\(([^)]*)\)", fields["space directions"])]
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(vectors).T
    matrix[:3, 3] = [float(x) for x in fields["space origin"].strip("()").split(",")]
    samples = inflated(body) if fields["encoding"] in ("gzip", "gz") else body
    return VoxelFile(np.frombuffer(samples, NUMBERS[fields["type"]]).reshape(sizes[::-1]), matrix)


def read_nifti(data):
    data = inflated(data) if data[:2] == b"\x1f\x8b" else data
    dims = struct.unpack("<8h", data[40:56])
    kind = {2: "u1", 4: "<i2", 512: "<u2"}[struct.unpack("<h", data[70:72])[0]]
    first = int(struct.unpack("<f", data[108:112])[0])
    # The rows of the matrix are in RAS.
    matrix = np.eye(4)
    matrix[:3] = np.array(struct.unpack("<12f", data[280:328])).reshape(3, 4) * np.array([[-1.0], [-1.0], [1.0]])
    count = dims[1] * dims[2] * dims[3]
    return VoxelFile(np.frombuffer(data, kind, count, first).reshape(dims[3], dims[2], dims[1]), matrix)


READERS = {".stl": read_stl, ".ply": read_ply, ".obj": read_obj, ".off": read_off, ".vtp": read_vtp, ".glb": read_glb,
           ".nrrd": read_nrrd, ".nii": read_nifti, ".nii.gz": read_nifti}


class Dicom:
    """The elements of an uncompressed little-endian DICOM file, by tag: bytes, or a list of items for a sequence."""

    # Sequences that are read; implicit value representations do not say which elements are sequences.
    SEQUENCES = {0x004008ea, 0x00620002, 0x0062000a, 0x00209113, 0x00209116, 0x00289110, 0x52009229, 0x52009230,
                 0x30060020, 0x30060039, 0x30060040}
    LONG = {b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV"}
    UNDEFINED = 0xffffffff

    def __init__(self, data):
        if data[128:132] != b"DICM":
            raise ValueError("it is no DICOM file")
        self.data = data
        self.is_implicit = False
        head, at = self._elements(132, len(data), True)
        syntax = self.text(head, 0x00020010)
        if syntax not in ("1.2.840.10008.1.2", "1.2.840.10008.1.2.1"):
            raise ValueError(f"its transfer syntax {syntax} is not read")
        self.is_implicit = syntax == "1.2.840.10008.1.2"
        self.all, _ = self._elements(at, len(data), False)

    def _elements(self, at, end, is_head):
        """The elements between two places; those of a file's head end where another group begins."""
        elements = {}
        while at + 8 <= end:
            group, number = struct.unpack_from("<HH", self.data, at)
            tag = group << 16 | number
            if is_head and group != 2:
                break
            if tag in (0xfffee00d, 0xfffee0dd):  # the end of an item or of a sequence of no stated length
                return elements, at + 8
            kind = self.data[at + 4:at + 6]
            if self.is_implicit:
                size, at = struct.unpack_from("<I", self.data, at + 4)[0], at + 8
            elif kind in self.LONG:
                size, at = struct.unpack_from("<I", self.data, at + 8)[0], at + 12
            else:
                size, at = struct.unpack_from("<H", self.data, at + 6)[0], at + 8
            if size != self.UNDEFINED and at + size > end:
                raise ValueError("it is cut short")
            if size == self.UNDEFINED or (kind == b"SQ" and not self.is_implicit) or tag in self.SEQUENCES:
                elements[tag], at = self._items(at, end if size == self.UNDEFINED else at + size)
            else:
                elements[tag], at = self.data[at:at + size], at + size
        return elements, at

    def _items(self, at, end):
        items = []
        while at + 8 <= end:
            group, number, size = struct.unpack_from("<HHI", self.data, at)
            at += 8
            if (group, number) == (0xfffe, 0xe0dd):
                break
            if (group, number) != (0xfffe, 0xe000) or (size != self.UNDEFINED and at + size > end):
                raise ValueError("a sequence is damaged")
            item, at = self._elements(at, end if size == self.UNDEFINED else at + size, False)
            items.append(item)
        return items, at

    @staticmethod
    def text(item, tag):
        return item.get(tag, b"").decode("utf-8", "replace").strip(" \0")

    @staticmethod
    def short(item, tag):
        return struct.unpack("<H", item[tag])[0]

    @classmethod
    def decimals(cls, item, tag):
        return np.array(cls.text(item, tag).split("\\"), dtype=float)


class Checker:
    def __init__(self, archive):
        self.archive = archive
        self.result = archive.json("result/result.json")
        self.findings = Findings(self.result)
        self.plan = archive.json("plan.plan.json")
        self.steps = {step["id"]: step for step in self.plan.get("steps", []) if "id" in step}
        self.universe = Universe(archive.manifest["universe"])
        self.entries = {row["id"]: row for row in archive.manifest["objects"]}
        self.voxels, self.surfaces = {}, {}
        self.objects = {row["id"]: (i, row) for i, row in enumerate(self.result.get("objects", []))}

    def run(self):
        self.archive.check(self.findings)
        self.plan_is_the_one()
        for name, row in self.entries.items():
            self.load(name, row)
        for name in self.objects:
            self.check_object(name)
        for name in self.entries:
            self.check_origin(name)
        self.check_certificates()
        self.check_measurements()
        self.check_movements()
        self.check_exports()
        self.check_completeness()
        self.check_dicom()
        self.check_tables()
        self.check_report()
        return self.findings

    def plan_is_the_one(self):
        self.findings.claim(self.result.get("plan") == self.plan, "result.json is of the plan in plan.plan.json")
        universe = self.result.get("universe", {})
        self.findings.claim(
            universe.get("side") == self.universe.side
            and np.array_equal(np.array(universe.get("lps_from_voxel")), self.universe.matrix),
            "result.json and manifest.json state the same universe")
        sums = {scan["name"]: scan["sha256"] for scan in self.archive.manifest.get("scans", [])}
        self.findings.claim(
            sums == {scan["name"]: scan["sha256"] for scan in self.result.get("scans", [])},
            "result.json and manifest.json state the same SHA-256 of the scans")
        for name, scan in self.plan.get("scans", {}).items():
            if scan.get("sha256"):
                self.findings.claim(scan["sha256"] == sums.get(name),
                                    f"the scan {name} is the one whose SHA-256 the plan states")
        self.findings.claim(set(self.entries) == set(self.objects),
                            "result.json and manifest.json list the same objects")

    def load(self, name, row):
        self.voxels[name] = Voxels(self.archive.array(row["runs"], 4), self.universe)
        self.findings.claim(self.voxels[name].sound, f"{name}: its runs of voxels are in order and in the universe")
        if "points" in row:
            surface = Surface(self.archive.array(row["points"], 3), self.archive.array(row["triangles"], 3))
            self.findings.claim(surface.sound, f"{name}: its triangles refer to points, which are finite")
            if surface.sound:
                self.surfaces[name] = surface
                self.findings.claim(surface.is_closed(), f"{name}: its surface is closed")

    def compare(self, path, stated, computed, how):
        """Compares those members of `stated` that were computed."""
        for key, value in computed.items():
            if stated.get(key) is None:
                continue
            tolerance = 0.0
            if key in ("centroid_mm", "extents_mm"):
                tolerance = 1e-6
            if key == "inertia_mm5":
                tolerance = SUM * float(np.abs(value).max())
            self.findings.number(path + (key,), value, tolerance, how)

    def check_object(self, name):
        i, row = self.objects[name]
        if name in self.voxels and row.get("voxel"):
            self.compare(("objects", i, "voxel"), row["voxel"], self.voxels[name].measures, "its runs of voxels")
        if name in self.surfaces:
            surface = self.surfaces[name]
            if row.get("mesh"):
                self.compare(("objects", i, "mesh"), row["mesh"], surface.measures, "its triangles")
            if row.get("mesh_faces") is not None:
                self.findings.number(("objects", i, "mesh_faces"), len(surface.triangles), 0, "its triangles")

    def check_origin(self, name):
        """Whether an object is what its step of the plan says."""
        step = self.steps.get(name, {})
        kind = step.get("do")
        row = self.objects.get(name, (0, {}))[1]
        # A forger could leave these entries out, so their absence is a contradiction.
        if kind == "window":
            self.findings.claim("samples" in self.entries[name], f"{name}: the archive carries samples of its window")
        if kind == "move" and motion_of(step) is not None:
            self.findings.claim("image_of" in self.entries[name], f"{name}: the archive says whose image it is")
        if row.get("mesh"):
            self.findings.claim("points" in self.entries[name], f"{name}: the archive carries its surface")
        if "samples" in self.entries[name]:
            self.check_window(name, step)
        if kind == "mask" and set(step) <= {"id", "do", "regions", "note"}:
            self.check_mask(name, step)
        if kind == "combine":
            self.check_combination(name, step)
        if "image_of" in self.entries[name]:
            self.check_image(name, step)

    def check_window(self, name, step):
        rows = self.archive.array(self.entries[name]["samples"], 14)
        scan = next((s for s in self.archive.manifest["scans"] if s["name"] == step.get("scan")), None)
        if scan is None or not len(rows):
            return
        at = self.universe.lps_mm(rows[:, :3])
        matrix = np.array(scan["lps_from_voxel"], dtype=float)
        place = (at - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
        f = place - rows[:, 3:6]
        self.findings.claim(bool((np.abs(f - 0.5) <= 0.5 + 1e-6).all()), f"{name}: the cells hold the voxels' centres")
        value = np.zeros(len(rows))
        for corner in range(8):
            weight = np.ones(len(rows))
            for axis in range(3):
                weight = weight * (f[:, axis] if corner >> axis & 1 else 1 - f[:, axis])
            value += weight * rows[:, 6 + corner]
        low = step.get("low", 300)
        high = step.get("high")
        high = math.inf if high is None else high
        # Kernels may round interpolated samples to whole numbers.
        decided = (np.abs(value - low) > 0.51) & (np.abs(value - high) > 0.51)
        has = self.voxels[name].has(rows[:, :3])
        wrong = decided & (has != ((value >= low) & (value <= high)))
        self.findings.claim(not wrong.any(),
                            f"{name}: {int(decided.sum())} voxels are in the window {low}:{step.get('high', '')} as the "
                            f"scan's samples there say, but for {int(wrong.sum())}")

    def check_mask(self, name, step):
        side = self.universe.side
        regions = step.get("regions", [])
        if any(set(r) - {"view", "polygons_mm"} or r.get("view") not in VIEWS for r in regions):
            return
        voxels = self.voxels[name]
        if not voxels.sound:
            return
        x, y, z = (self.universe.lps_mm(np.eye(3)[axis] * np.arange(side)[:, None])[:, axis] for axis in range(3))
        if np.abs(self.universe.matrix[:3, :3] - np.diag(np.diag(self.universe.matrix[:3, :3]))).max() > 0:
            return
        hits = []
        for region in regions:
            right, up = VIEWS[region["view"]]
            axes = [int(np.argmax(np.abs(right))), int(np.argmax(np.abs(up)))]
            lines = [(x, y, z)[axis] for axis in axes]
            u, v = np.meshgrid(lines[0] * right[axes[0]], lines[1] * up[axes[1]], indexing="ij")
            hit = in_polygons(region["polygons_mm"], u.ravel(), v.ravel()).reshape(u.shape)
            doubt = near_edges(region["polygons_mm"], u.ravel(), v.ravel(), 1e-9).reshape(u.shape)
            # From (axes[0], axes[1]) to an array over z, y, x.
            shape = [1, 1, 1]
            order = [2 - axes[0], 2 - axes[1]]
            if order[0] > order[1]:
                hit, doubt = hit.T, doubt.T
            for place in order:
                shape[place] = side
            hits.append((hit.reshape(shape), doubt.reshape(shape)))
        wrong = 0
        for k in range(side):
            inside, near = np.ones((side, side), dtype=bool), np.zeros((side, side), dtype=bool)
            for hit, doubt in hits:
                inside &= hit[k if hit.shape[0] > 1 else 0]
                near |= doubt[k if doubt.shape[0] > 1 else 0]
            wrong += int(((voxels.slice(k) != inside) & ~near).sum())
        self.findings.claim(wrong == 0, f"{name}: all voxels are those of the plan's polygons, but for {wrong}")

    def check_combination(self, name, step):
        try:
            expression = Expression(step.get("expression", ""))
        except ValueError:
            return
        if not all(part in self.voxels for part in expression.names) or not expression.names:
            return
        made = combined([self.voxels[part].borders for part in expression.names], expression.rule)
        off = length(combined([made, self.voxels[name].borders], lambda s: s[0] ^ s[1]))
        self.findings.claim(off == 0, f"{name}: its voxels are {step['expression']} of its operands' voxels, but for {off}")

    def check_image(self, name, step):
        image = self.entries[name]["image_of"]
        matrix = np.array(image["lps_from_lps"], dtype=float)
        stated = motion_of(step)
        if stated is not None and step.get("object") == image["object"]:
            self.findings.claim(bool(np.abs(stated - matrix).max() <= 1e-9 * max(1.0, np.abs(matrix).max())),
                                f"{name}: it was moved as the plan says")
        still, moved = self.surfaces.get(image["object"]), self.surfaces.get(name)
        if still is None or moved is None or len(still.points) != len(moved.points):
            return
        apart = np.abs(still.points @ matrix[:3, :3].T + matrix[:3, 3] - moved.points).max() if len(still.points) else 0.0
        self.findings.claim(bool(apart <= 1e-8), f"{name}: its points are those of {image['object']}, moved")

    def check_certificates(self):
        worst = {"PASS": 0, "WARN": 1, "FAIL": 2}
        counts = {"PASS": 0, "WARN": 0, "FAIL": 0}
        for i, certificate in enumerate(self.result.get("certificates", [])):
            path = ("certificates", i)
            name = certificate.get("object")
            verdict = certificate.get("verdict")
            if verdict not in worst:
                self.findings.claim(False, f"certificate of {name}: its verdict is {verdict!r}")
                continue
            counts[verdict] += 1
            self.check_answers(path, certificate, name)
            self.findings.number(path + ("tolerance_mm3",), sum(t["value_mm3"] for t in certificate["terms"]), 0,
                                 "the sum of its terms") if certificate.get("terms") else None
            lowest = 0
            for j, row in enumerate(certificate.get("comparisons", [])):
                lowest = max(lowest, self.check_comparison(path + ("comparisons", j), row, name, certificate))
            self.findings.claim(worst[verdict] >= lowest,
                                f"certificate of {name}: its verdict {verdict} is no better than that of its comparisons")
            left_out = set(COMPARED) - {row.get("quantity") for row in certificate.get("comparisons", [])}
            self.findings.claim(verdict != "PASS" or certificate.get("tier") != "bounded" or not left_out,
                                f"certificate of {name}: it passes by all of its comparisons"
                                + (f", but for {sorted(left_out)[0]}" if left_out else ""))
            self.findings.claim((verdict == "PASS") == (not certificate.get("reasons")),
                                f"certificate of {name}: it has reasons where it does not pass, and only there")
            if name in self.objects:
                row = self.objects[name][1]
                self.findings.claim(row.get("verdict") == verdict and row.get("resolved") == certificate.get("resolved"),
                                    f"certificate of {name}: objects and certificates state the same verdict")
            shared = set(certificate["voxel"].get("makers", [])) & set(certificate["mesh"].get("makers", []))
            self.findings.claim(certificate.get("independent") == (not shared)
                                and not (verdict == "PASS" and shared),
                                f"certificate of {name}: it is independent as the makers of both answers say")
            self.check_digitised(name, certificate)
            self.check_worst(path, certificate, name)
        stated = self.result.get("counts", {})
        self.findings.claim(all(stated.get(key) == value for key, value in counts.items()),
                            f"result.json counts {counts['PASS']} PASS, {counts['WARN']} WARN and {counts['FAIL']} FAIL")

    def check_answers(self, path, certificate, name):
        for side, measured in (("voxel", self.voxels.get(name)), ("mesh", self.surfaces.get(name))):
            if measured is not None and certificate.get(side):
                computed = measured.measures
                keys = ("volume_mm3", "centroid_mm") if side == "voxel" else ("volume_mm3", "centroid_mm", "area_mm2")
                self.compare(path + (side,), certificate[side], {k: computed[k] for k in keys if k in computed},
                             f"the object's {'runs of voxels' if side == 'voxel' else 'triangles'}")
        a, b = certificate["voxel"], certificate["mesh"]
        if name in self.voxels and name in self.surfaces:
            volumes = [self.voxels[name].measures["volume_mm3"], self.surfaces[name].measures["volume_mm3"]]
            self.findings.number(path + ("difference_mm3",), volumes[0] - volumes[1], SUM * max(volumes),
                                 "voxels minus mesh")
            if a.get("centroid_mm") and b.get("centroid_mm") and certificate.get("centroid_distance_mm") is not None:
                apart = np.linalg.norm(np.array(a["centroid_mm"]) - np.array(b["centroid_mm"]))
                self.findings.number(path + ("centroid_distance_mm",), apart, 1e-6, "both centroids")

    def check_comparison(self, path, row, name, certificate):
        """Checks a comparison's difference and verdict; returns how bad it is."""
        where = f"certificate of {name}, {row.get('quantity')}"
        difference, tolerance, verdict = row.get("difference"), row.get("tolerance"), row.get("verdict")
        two = (row.get("voxel"), row.get("mesh"))
        plain = ("volume", "volume by lines", "area")
        if row.get("quantity") in plain and None not in two:
            self.findings.number(path + ("difference",), abs(two[0] - two[1]), SUM * max(map(abs, two)), "both answers")
            reading = certificate.get("third_reading") or {}
            if row["quantity"] == "volume by lines" and reading:
                self.findings.number(path + ("voxel",), reading.get("volume_mm3", math.nan), 0, "the third reading")
            if row["quantity"] == "volume" and name in self.voxels and name in self.surfaces:
                self.findings.number(path + ("voxel",), self.voxels[name].measures["volume_mm3"], 0, "the runs of voxels")
                self.findings.number(path + ("mesh",), self.surfaces[name].measures["volume_mm3"], 0, "the triangles")
        for quantity, key in (("volume", "tolerance_mm3"), ("symmetric difference", "symmetric_difference_tolerance_mm3"),
                              ("centroid", "centroid_tolerance_mm")):
            if row.get("quantity") == quantity and certificate.get(key) is not None and tolerance is not None:
                self.findings.number(path + ("tolerance",), certificate[key], 0, f"the certificate's {key}")
        for quantity, key in (("symmetric difference", "symmetric_difference_mm3"), ("centroid", "centroid_distance_mm")):
            if row.get("quantity") == quantity and certificate.get(key) is not None:
                self.findings.number(path + ("difference",), certificate[key], 0, f"the certificate's {key}")
        if tolerance is None or difference is None:
            self.findings.claim(verdict in (None, "WARN", "FAIL"), f"{where}: without a tolerance nothing passes")
            return 0
        right = (verdict == "PASS" if difference <= tolerance
                 else verdict == "WARN" if difference <= 2 * tolerance else verdict in ("WARN", "FAIL"))
        self.findings.claim(right, f"{where}: {verdict} follows from {difference!r} and {tolerance!r}")
        return {"PASS": 0, "WARN": 1, "FAIL": 2}.get(verdict, 0)

    def check_digitised(self, name, certificate):
        """The mesh at the voxels' centres, counted by this program, against the voxels."""
        if name not in self.surfaces or not self.voxels[name].sound:
            return
        digitised = self.surfaces[name].borders(self.universe)
        if len(digitised) % 2:
            return
        counted = length(digitised) * self.universe.voxel_mm3
        tolerance = certificate["tolerance_mm3"] + 10 * self.universe.voxel_mm3
        apart = length(combined([digitised, self.voxels[name].borders], lambda s: s[0] ^ s[1])) * self.universe.voxel_mm3
        if certificate["verdict"] == "PASS" and certificate.get("resolved"):
            voxels = self.voxels[name].measures["volume_mm3"]
            self.findings.claim(abs(counted - voxels) <= tolerance,
                                f"{name}: the mesh holds {counted:.1f} mm3 at the voxels' centres, the voxels {voxels:.1f}, "
                                f"{apart:.1f} mm3 are in one of them alone, {tolerance:.1f} are allowed in total")

    def check_worst(self, path, certificate, name):
        """The surfaces are as far apart at the worst place as the certificate says: one passes through it."""
        worst = certificate.get("worst")
        if not worst or name not in self.surfaces or not self.voxels[name].sound:
            return
        surface = self.surfaces[name]
        to_voxels = self.voxels[name].distance_mm(worst["at_mm"])
        if to_voxels is None or not len(surface.triangles):
            return
        to_mesh = distance_to_triangles(np.array(worst["at_mm"]), surface.points[surface.triangles])
        if min(to_mesh, to_voxels) > 1e-6 or abs(max(to_mesh, to_voxels) - worst["size_mm"]) > 1e-3:
            return
        self.findings.number(path + ("worst", "size_mm"), max(to_mesh, to_voxels), 1e-3, "triangles and voxels there")
        self.findings.number(path + ("worst", "at_mm"), worst["at_mm"], 0, "a surface passes through it")
        if certificate.get("hausdorff_mm") == worst["size_mm"]:
            self.findings.number(path + ("hausdorff_mm",), max(to_mesh, to_voxels), 1e-3, "no less, at the worst place")

    def check_completeness(self):
        """Every step that measures or exports has a row, and every object that a step refers to is there."""
        makers = [name for name, step in self.steps.items() if step.get("do") in ("window", "mask", "combine", "move", "saw")]
        referred = [step[key] for step in self.steps.values() for key in ("object", "to") if isinstance(step.get(key), str)]
        missing = [name for name in makers + referred if name in self.steps and name not in self.objects]
        self.findings.claim(not missing, "result.json has every object that the plan's steps make and refer to"
                            + (f", but for {missing[0]}" if missing else ""))
        for part, kind in (("measurements", "measure"), ("exports", "export")):
            rows = {row.get("id") for row in self.result.get(part, [])}
            missing = [name for name, step in self.steps.items() if step.get("do") == kind and name not in rows]
            self.findings.claim(not missing, f"result.json has a row for every step '{kind}'"
                                + (f", but for {missing[0]}" if missing else ""))

    def check_measurements(self):
        for i, row in enumerate(self.result.get("measurements", [])):
            path = ("measurements", i)
            name, other = row.get("object"), row.get("to")
            for side, measured in (("voxel", self.voxels.get(name)), ("mesh", self.surfaces.get(name))):
                if measured is not None and row.get(side) and other is None:
                    self.compare(path + (side,), row[side], measured.measures, "the object")
            if other is None and name in self.voxels and row.get("volume_estimator") == "voxels counted":
                self.compare(path, row, {k: v for k, v in self.voxels[name].measures.items()
                                         if k in ("volume_mm3", "centroid_mm")}, "the object's runs of voxels")
                if name in self.surfaces and "difference_mm3" in row:
                    volumes = [self.voxels[name].measures["volume_mm3"], self.surfaces[name].measures["volume_mm3"]]
                    self.findings.number(path + ("difference_mm3",), volumes[0] - volumes[1], SUM * max(volumes),
                                         "voxels minus mesh")
                    if volumes[1]:
                        self.findings.number(path + ("difference_percent",), 100 * abs(volumes[0] - volumes[1]) / abs(volumes[1])
                                             if row["difference_percent"] >= 0 else 100 * (volumes[0] - volumes[1]) / volumes[1],
                                             1e-6, "voxels against mesh")
            if name in self.surfaces and "triangles" in row.get("area_estimator", "") and other is None:
                self.findings.number(path + ("area_mm2",), self.surfaces[name].measures.get("area_mm2", 0.0), 0,
                                     "the object's triangles")
            if other in self.voxels and name in self.voxels and row.get("overlap_mm3") is not None:
                both = combined([self.voxels[name].borders, self.voxels[other].borders], lambda s: s[0] & s[1])
                self.findings.number(path + ("overlap_mm3",), length(both) * self.universe.voxel_mm3, 0,
                                     "the voxels of both objects")
            points = row.get("points_mm")
            if points and all(isinstance(p, list) for p in points):
                if row.get("distance_mm") is not None and len(points) == 2:
                    self.findings.number(path + ("distance_mm",), np.linalg.norm(np.subtract(*points)), 1e-9, "its points")
                if row.get("angle_deg") is not None and len(points) == 3:
                    a, b = np.subtract(points[0], points[1]), np.subtract(points[2], points[1])
                    angle = math.degrees(math.atan2(np.linalg.norm(np.cross(a, b)), float(a @ b)))
                    self.findings.number(path + ("angle_deg",), angle, 1e-7, "its points")
                step = self.steps.get(row.get("id"), {})
                if step.get("points_mm") and all(isinstance(p, list) for p in step["points_mm"]):
                    self.findings.number(path + ("points_mm",), step["points_mm"], 1e-9, "the plan")
            for key in ("volume", "area"):
                self.check_spread(path, row, key)

    def check_spread(self, path, row, key):
        """A half-width is at least the root of its terms' squares and at most their sum."""
        if not isinstance(row.get(key), dict) or not row[key].get("sources"):
            return
        terms = [source["half_width"] for source in row[key]["sources"]]
        low, high = math.sqrt(sum(t * t for t in terms)), sum(terms)
        stated = row[key]["half_width"]
        self.findings.claim(low * (1 - 1e-9) <= stated <= high * (1 + 1e-9) or stated == max(terms),
                            f"measurement {row.get('id')}: the half-width of its {key}, {stated!r}, is between the root of "
                            f"its sources' squares {low!r} and their sum {high!r}")

    def check_movements(self):
        head = np.array(self.result.get("lps_from_head", np.eye(3)), dtype=float)
        if head.shape != (3, 3):
            return
        for i, row in enumerate(self.result.get("movements", [])):
            entry = self.entries.get(row.get("object"), {})
            still = self.voxels.get(row.get("from"))
            if "image_of" not in entry or row.get("from") != entry["image_of"]["object"] or still is None:
                continue
            matrix = np.array(entry["image_of"]["lps_from_lps"], dtype=float)
            centroid = still.measures.get("centroid_mm")
            if centroid is None or not row.get("centroid"):
                continue
            by = head.T @ (matrix[:3, :3] @ centroid + matrix[:3, 3] - centroid)
            for key, value in (("left_mm", by[0]), ("forward_mm", -by[1]), ("up_mm", by[2])):
                if row["centroid"].get(key) is not None:
                    self.findings.number(("movements", i, "centroid", key), value, 1e-6, "the motion of the centroid")

    def check_exports(self):
        for i, row in enumerate(self.result.get("exports", [])):
            name = "result/" + row.get("path", "")
            if not row.get("written") or name not in self.archive.sizes:
                continue
            data = self.archive.bytes(name)
            path = ("exports", i)
            if row.get("bytes") is not None:
                self.findings.number(path + ("bytes",), len(data), 0, "the entry")
            # A step with further fields may have changed the surface on purpose.
            is_plain = set(self.steps.get(row.get("id"), {})) <= {"id", "do", "object", "path", "note"}
            if name.endswith(".inp"):
                self.check_inp(path, row, data)
            elif is_plain:
                self.check_exported(path, row, data)

    def check_exported(self, path, row, data):
        """A file of a surface or of voxels holds the object that the plan names, at its place."""
        name, kind = row.get("object"), next((e for e in READERS if row["path"].endswith(e)), None)
        if kind is None:
            return
        try:
            read = READERS[kind](data)
        except (ValueError, KeyError, IndexError, TypeError, OverflowError, struct.error, EOFError, OSError, zlib.error) as error:
            self.findings.claim(False, f"{row['path']}: cannot be read: {error}")
            return
        if isinstance(read, VoxelFile):
            self.check_voxel_file(path, row, read)
            return
        points, triangles = read
        surface = Surface(points, triangles)
        if not surface.sound:
            self.findings.claim(False, f"{row['path']}: its triangles refer to no points")
            return
        self.findings.number(path + ("faces",), len(triangles), 0, "the file's triangles")
        # Coordinates are rounded to 24 bits.
        rounding = float(np.abs(points).max()) * 2.0 ** -23 if len(points) else 0.0
        if row.get("volume_mm3") is not None and len(triangles):
            self.findings.number(path + ("volume_mm3",), surface.measures["volume_mm3"],
                                 surface.measures["area_mm2"] * rounding, "the file's triangles")
        whole = self.surfaces.get(name)
        if whole is not None:
            same = len(triangles) == len(whole.triangles)
            apart = float(np.abs(points[triangles] - whole.points[whole.triangles]).max()) if same and len(triangles) else 0.0
            self.findings.claim(same and apart <= rounding,
                                f"{row['path']}: its {len(triangles)} triangles are the {len(whole.triangles)} of {name}"
                                + (f", but up to {apart:.3g} mm beside them" if apart > rounding else ""))

    def check_voxel_file(self, path, row, read):
        voxels = self.voxels.get(row.get("object"))
        if voxels is None or not voxels.sound:
            return
        universe = self.universe
        # From the file's voxels to the universe's: the same voxels, with indices that begin at another one.
        step = np.linalg.inv(universe.matrix) @ read.lps_from_voxel
        first = np.rint(step[:3, 3])
        if np.abs(step[:3, :3] - np.eye(3)).max() > 1e-4 or np.abs(step[:3, 3] - first).max() > 1e-3:
            self.findings.claim(False, f"{row['path']}: its voxels are not those of the universe")
            return
        z, y, x = (axis + int(offset) for axis, offset in zip(np.nonzero(read.labels), first[::-1]))
        inside = (np.minimum(np.minimum(x, y), z) >= 0) & (np.maximum(np.maximum(x, y), z) < universe.side)
        runs = int((voxels.runs[:, 3] - voxels.runs[:, 2]).sum())
        wrong = int((~inside).sum()) + int((~voxels.has(np.stack([x, y, z], axis=1)[inside])).sum())
        self.findings.claim(wrong == 0 and len(x) == runs,
                            f"{row['path']}: its {len(x)} voxels are the {runs} of {row['object']}, but for {wrong}")
        if row.get("voxels") is not None:
            self.findings.number(path + ("voxels",), len(x), 0, "the file's voxels")
        if row.get("volume_mm3") is not None:
            self.findings.number(path + ("volume_mm3",), len(x) * universe.voxel_mm3, 0, "the file's voxels")

    def check_inp(self, path, row, data):
        nodes, tets, mode = {}, [], ""
        for line in data.decode("utf-8", "replace").splitlines():
            if line.startswith("*"):
                word = line.upper().replace(" ", "")
                mode = ("node" if word.startswith("*NODE") and not re.match(r"\*NODE(FILE|PRINT|OUTPUT)", word)
                        else "tet" if word.startswith("*ELEMENT,") and "TYPE=C3D" in word else "")
            elif mode == "node":
                parts = line.split(",")
                nodes[int(parts[0])] = [float(p) for p in parts[1:4]]
            elif mode == "tet":
                tets.append([int(p) for p in line.split(",")[1:5] if p.strip()])
        if not tets or any(len(t) != 4 for t in tets):
            return
        points = np.array([[nodes[n] for n in tet] for tet in tets])
        volume = np.einsum("ij,ij->i", points[:, 1] - points[:, 0],
                           np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 0])) / 6
        self.findings.claim(bool((volume > 0).all()), f"{row['path']}: every tetrahedron has a positive volume")
        self.findings.number(path + ("tets",), len(tets), 0, "the file's elements")
        if row.get("nodes") is not None:
            self.findings.number(path + ("nodes",), len(nodes), 0, "the file's nodes")
        if row.get("volume_mm3") is not None:
            self.findings.number(path + ("volume_mm3",), volume.sum(), 1e-6 * volume.sum(), "the file's elements")
        quality = row.get("quality") or {}
        if "min_dihedral_deg" in quality:
            angles = dihedral_angles(points)
            # The file's coordinates are rounded.
            for key, value in (("min_dihedral_deg", angles.min()), ("max_dihedral_deg", angles.max())):
                self.findings.number(path + ("quality", key), value, 0.01, "the file's elements")

    def check_dicom(self):
        """The DICOM objects: voxels, contours, surfaces and plan are those of the archive; all are of one patient."""
        stated = self.archive.manifest.get("dicom")
        entries = sorted(name for name in self.archive.sizes if name.startswith("dicom/"))
        rows = stated["objects"] if stated else []
        listed = sorted("dicom/" + row["path"] for row in rows)
        self.findings.claim(listed == entries, f"manifest.json describes the {len(entries)} DICOM objects of the archive")
        # Voxels out of order are contradicted already.
        if not all(voxels.sound for voxels in self.voxels.values()):
            return
        checks = {"segmentation": self.check_segmentation, "structures": self.check_structures,
                  "model": self.check_model, "plan": self.check_plan_document}
        read = []
        for row in rows:
            name = "dicom/" + row["path"]
            if name not in self.archive.sizes:
                continue
            try:
                dicom = Dicom(self.archive.bytes(name))
                read.append(dicom.all)
                if row["kind"] in checks:
                    checks[row["kind"]](row, dicom)
            except (ValueError, KeyError, IndexError, TypeError, OverflowError, struct.error, RecursionError) as error:
                self.findings.claim(False, f"{name}: cannot be read: {error!r}")
        if read:
            self.check_identity(stated, read)

    def check_identity(self, stated, read):
        def of(tag):
            return {Dicom.text(item, tag) for item in read}
        self.findings.claim(all(len(of(tag)) == 1 for tag in (0x00100010, 0x00100020, 0x0020000d))
                            and len(of(0x00080018)) == len(read),
                            f"dicom/: its {len(read)} objects are of one patient and one study, each with an identifier")
        if self.archive.manifest.get("identity") is not None or stated["identity"]["choice"] == "remove":
            self.findings.claim(of(0x00120062) == {"YES"} and of(0x00100010) == {""} and of(0x00100020) == {""},
                                "dicom/: its objects name no patient")

    def check_segmentation(self, row, dicom):
        """Each frame shows a slice of an object in the universe."""
        file, universe = dicom.all, self.universe
        rows, columns = Dicom.short(file, 0x00280010), Dicom.short(file, 0x00280011)
        shared, frames = file[0x52009229][0], file[0x52009230]
        turned = Dicom.decimals(shared[0x00209116][0], 0x00200037)
        apart = Dicom.decimals(shared[0x00289110][0], 0x00280030)
        inverse = np.linalg.inv(universe.matrix[:3, :3])
        steps = np.stack([inverse @ turned[:3] * apart[1], inverse @ turned[3:] * apart[0]])
        self.findings.claim(bool(np.abs(steps - np.eye(3)[:2]).max() <= 1e-4),
                            f"dicom/{row['path']}: its pixels lie along the universe's voxels")
        names = row["of"]
        labels = {Dicom.short(item, 0x00620004): Dicom.text(item, 0x00620005) for item in file[0x00620002]}
        self.findings.claim(labels == {i + 1: name[:64] for i, name in enumerate(names)},
                            f"dicom/{row['path']}: its segments are {', '.join(names)}")
        seen, wrong, far = {}, [0] * len(names), 0.0
        counts = [0] * len(names)
        for i, frame in enumerate(frames):
            place = inverse @ (Dicom.decimals(frame[0x00209113][0], 0x00200032) - universe.matrix[:3, 3])
            x, y, z = (int(v) for v in np.rint(place))
            far = max(far, float(np.abs(place - np.rint(place)).max()))
            number = Dicom.short(frame[0x0062000a][0], 0x0062000b) - 1
            if seen.setdefault((number, z), i) != i or min(x, y, z) < 0 or max(x + columns, y + rows, z + 1) > universe.side:
                raise ValueError(f"frame {i + 1} is there twice, or lies outside the universe")
            bits = np.frombuffer(file[0x7fe00010], np.uint8, -(-(i + 1) * rows * columns // 8) - i * rows * columns // 8,
                                 i * rows * columns // 8)
            bits = np.unpackbits(bits, bitorder="little")[i * rows * columns % 8:][:rows * columns].reshape(rows, columns) > 0
            voxels = self.voxels[names[number]].slice(z)
            counts[number] += int(bits.sum())
            wrong[number] += int((bits != voxels[y:y + rows, x:x + columns]).sum())
        for name, count, off in zip(names, counts, wrong):
            runs = self.voxels[name].runs
            whole = int((runs[:, 3] - runs[:, 2]).sum())
            self.findings.claim(off == 0 and count == whole and far <= 1e-3,
                                f"dicom/{row['path']}: its {count} pixels of {name} are its {whole} voxels, but for {off}")

    def check_structures(self, row, dicom):
        """Each plane of contours encloses, by exclusive or, the voxels of the nearest slice of the universe."""
        file, universe = dicom.all, self.universe
        inverse, side = np.linalg.inv(universe.matrix[:3, :3]), universe.side
        numbers = {Dicom.text(item, 0x30060022): Dicom.text(item, 0x30060026) for item in file[0x30060020]}
        names = row["of"]
        self.findings.claim(numbers == {str(i + 1): name[:64] for i, name in enumerate(names)},
                            f"dicom/{row['path']}: its regions are {', '.join(names)}")
        drawn = [{} for _ in names]  # plane -> contours, of each object
        for region in file[0x30060039]:
            planes = drawn[int(Dicom.text(region, 0x30060084)) - 1]
            for contour in region[0x30060040]:
                points = (Dicom.decimals(contour, 0x30060050).reshape(-1, 3) - universe.matrix[:3, 3]) @ inverse.T
                planes.setdefault(round(float(points[0, 2]), 3), []).append(points)
        shown = {plane for planes in drawn for plane in planes}
        for name, planes in zip(names, drawn):
            wrong, uneven = 0, 0.0
            for plane in shown:
                loops = []
                for points in planes.get(plane, []):
                    a = np.rint(points[:, :2] + 0.5).astype(np.int64)
                    uneven = max(uneven, float(np.abs(points[:, :2] + 0.5 - a).max()), float(np.ptp(points[:, 2])))
                    if a.min() < 0 or a.max() > side or ((a != np.roll(a, -1, axis=0)).sum(axis=1) > 1).any():
                        raise ValueError("a contour does not follow the voxels' edges")
                    loops.append(a)
                low = np.min([a.min(axis=0) for a in loops], axis=0) if loops else np.zeros(2, np.int64)
                high = np.max([a.max(axis=0) for a in loops], axis=0) if loops else low
                # Where edges along y begin and end; summed along y, the edges; summed along x, what they enclose. Odd
                # sums alone count, so bytes suffice.
                edges = np.zeros((high - low + 1)[::-1], dtype=np.uint8)
                for a in loops:
                    b = np.roll(a, -1, axis=0)
                    upright = a[:, 0] == b[:, 0]
                    for end in (a[upright] - low, b[upright] - low):
                        np.add.at(edges, (end[:, 1], end[:, 0]), 1)
                inside = np.bitwise_xor.accumulate(np.bitwise_xor.accumulate(edges & 1, axis=0), axis=1)[:-1, :-1] > 0
                # An image half way between two slices shows either.
                slices = {min(max(math.floor(plane + 0.5 + d), 0), side - 1) for d in (-0.01, 0.01)}
                held = {z: self.voxels[name].slice(z, low[1], high[1])[:, low[0]:high[0]] for z in slices}
                wrong += min(int((inside != voxels).sum()) + self.voxels[name].in_slice(z) - int(voxels.sum())
                             for z, voxels in held.items())
            self.findings.claim(wrong == 0 and uneven <= 0.01 and len(planes) > 0,
                                f"dicom/{row['path']}: its contours of {name} enclose its voxels on {len(planes)} planes, "
                                f"but for {wrong}")

    def check_model(self, row, dicom):
        name, file = row["of"], dicom.all
        unit = Dicom.text(file[0x004008ea][0], 0x00080100)
        self.findings.claim(unit == "mm", f"dicom/{row['path']}: its unit is {unit}, which is to be mm")
        data = file[0x00420011]
        points, triangles = read_stl(data[:84 + 50 * struct.unpack("<I", data[80:84])[0]])
        whole = self.surfaces[name]
        same = len(triangles) == len(whole.triangles)
        apart = float(np.abs(points[triangles] - whole.points[whole.triangles]).max()) if same and len(triangles) else 0.0
        # Coordinates are rounded to 24 bits.
        self.findings.claim(same and apart <= float(np.abs(points).max()) * 2.0 ** -23,
                            f"dicom/{row['path']}: its {len(triangles)} triangles are the {len(whole.triangles)} of {name}")

    def check_plan_document(self, row, dicom):
        found = re.search(rb'<text mediaType="application/json" representation="B64"[^>]*>([^<]*)</text>',
                          dicom.all[0x00420011])
        plan = base64.b64decode(found.group(1)) if found else b""
        self.findings.claim(plan == self.archive.bytes("plan.plan.json"),
                            f"dicom/{row['path']}: it carries the text of plan.plan.json")

    def check_tables(self):
        for part in ("certificates", "measurements", "movements"):
            name = f"result/tables/{part}.csv"
            if name not in self.archive.sizes:
                continue
            rows = list(csv.DictReader(io.StringIO(self.archive.bytes(name).decode("utf-8"))))
            stated = self.result.get(part, [])
            if part == "movements":
                stated = [row for each in stated for row in points_of(each)]
            wrong, compared = [], 0
            for row, value in zip(rows, stated):
                for column, cell in row.items():
                    found = member(value, column)
                    if cell and found is not None and (column != "words" or part == "movements"):
                        compared += 1
                        if not same_cell(cell, found):
                            wrong.append(column)
            self.findings.claim(len(rows) == len(stated) and not wrong,
                                f"tables/{part}.csv: its {compared} cells are the values of result.json"
                                + (f", but for {wrong[0]}" if wrong else ""))


    def check_report(self):
        """The page draws the data that it holds; these are result.json and the plan's text."""
        page = self.archive.bytes("result/report.html").decode("utf-8")
        found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
        try:
            data = json.loads(found.group(1)) if found else {}
        except ValueError:
            data = {}
        self.findings.claim(without_times(data.get("result")) == without_times(self.result)
                            and data.get("plan_text", "").encode() == self.archive.bytes("plan.plan.json"),
                            "report.html draws the values of result.json and the text of plan.plan.json")


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(member) for key, member in value.items() if key != "timings_ms"}
    return [without_times(member) for member in value] if isinstance(value, list) else value


def points_of(movement):
    """The rows of a movement in its table: its centroid with the angles of the whole, and its landmarks."""
    whole = {key: movement[key] for key in ("pitch_deg", "yaw_deg", "roll_deg") if key in movement}
    return [{"object": movement["object"], "point": point.get("name", "centroid"), **point, **angles}
            for point, angles in [(movement.get("centroid") or {}, whole), *((each, {}) for each in movement.get("landmarks", []))]]


def member(value, column):
    """The member of a row of result.json that a column shows; None where there is no single one."""
    parts = column.split(".")
    for k, part in enumerate(parts):
        if isinstance(value, dict) and part in value:
            value = value[part]
        elif isinstance(value, list) and len(value) == 3 and part in ("x", "y", "z") and k == len(parts) - 1:
            value = value["xyz".index(part)]
        else:
            return None
    return None if isinstance(value, (dict, list)) else value


def same_cell(cell, value):
    if isinstance(value, bool):
        return cell == str(value).lower()
    if isinstance(value, (int, float)):
        try:
            return math.isclose(float(cell), value, rel_tol=1e-9, abs_tol=1e-12)
        except ValueError:
            return False
    return cell == str(value)


def main(arguments):
    paths = [a for a in arguments if not a.startswith("-")]
    if len(paths) != 1 or set(arguments) - set(paths) - {"--json", "--all"}:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        findings = Checker(Archive(paths[0])).run()
    except NoPack as error:
        print(f"check_pack.py: {error}", file=sys.stderr)
        return 2
    except (KeyError, TypeError, AttributeError, IndexError, ValueError, OverflowError, RecursionError, MemoryError) as error:
        print(f"check_pack.py: {paths[0]}: its manifest or result is not as octotomy pack writes it: {error!r}",
              file=sys.stderr)
        return 2
    counts, contradictions = findings.counts(), findings.contradictions()
    claims = sum(1 for state, _ in findings.claims if state == "confirmed")
    if "--json" in arguments:
        print(json.dumps({
            "numbers": counts, "claims": {"confirmed": claims, "contradicted": len(findings.claims) - claims},
            "contradictions": contradictions,
            "values": [{"where": text_of(path), "value": entry[0], "state": entry[1], "how": entry[2]}
                       for path, entry in findings.values.items()]}, indent=1))
    else:
        if "--all" in arguments:
            for path, entry in findings.values.items():
                print(f"{entry[1]:13} {text_of(path)} = {entry[0]!r}" + (f"  ({entry[2]})" if entry[2] else ""))
            for state, text in findings.claims:
                print(f"{state:13} {text}")
        for text in contradictions:
            print(f"contradicted: {text}")
        total = max(1, sum(counts.values()))
        print(f"numbers  {counts['confirmed']} confirmed ({100 * counts['confirmed'] / total:.0f} %), "
              f"{counts['contradicted']} contradicted, {counts['not checked']} not checked")
        print(f"claims   {claims} confirmed, {len(findings.claims) - claims} contradicted")
    return 1 if contradictions else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
