#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""certificate_census.py PROGRAM DATA COUNT [FIRST]: verdicts of right answers, on real scans.

Random plans run on every scan of DATA at voxels of 1, 2 and 3 mm, plan number FIRST first, until COUNT certificates were
read. A plan windows bone, skin or a range between, keeps the largest part or all of it, cuts it by a mask or a saw, moves
the piece, unites it again and mirrors it. Both kernels are right, so each verdict has to be PASS, and a moved piece has to
keep its recommended volume and interval. Prints a line for each other verdict, for each resolved object whose two volumes
lie over a tenth apart, and for each moved piece of another size. Ends with status 1 where there is one of the last two, or
more than one certificate in two hundred is not PASS.
"""
import collections
import json
import pathlib
import random
import subprocess
import sys
import tarfile
import tempfile

SECONDS = 900  # for one plan


def scans_of(data, folder):
    """Paths of the scans of a folder; archives are unpacked into another."""
    for path in sorted(pathlib.Path(data).resolve().iterdir()):
        if path.name.startswith(("ct_", "mr_")) and path.name != "ct_unc_cthead_raw_slices.tar.xz":
            if path.name.endswith(".tar.xz"):
                unpacked = folder / path.name.removesuffix(".tar.xz")
                with tarfile.open(path) as archive:
                    archive.extractall(unpacked, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
                yield unpacked
            else:
                volumes = [*path.glob("*.nii.gz"), *path.glob("*.mhd")] if path.is_dir() else []
                yield volumes[0] if volumes else path


def json_of(program, *arguments):
    done = subprocess.run([program, *map(str, arguments), "--json"], capture_output=True, text=True, timeout=SECONDS, check=False)
    if done.returncode not in (0, 1) or not done.stdout:
        raise RuntimeError((done.stderr.strip() or f"no answer, status {done.returncode}").splitlines()[-1])
    return json.loads(done.stdout)


class Scan:
    def __init__(self, program, path):
        said = json_of(program, "info", path)
        self.path, self.is_ct = path, "ct_" in str(path)
        rows, dims = said["lps_from_voxel"], said["dims"]
        corners = [[sum(rows[row][i] * (dims[i] - 1) * ((corner >> i) & 1) for i in range(3)) + rows[row][3] for row in range(3)]
                   for corner in range(8)]
        self.low = [min(c[i] for c in corners) for i in range(3)]
        self.high = [max(c[i] for c in corners) for i in range(3)]
        self.range = said["range"]

    def window(self, draw):
        """The fields of a random window: mostly bone, sometimes skin, sometimes a range between two thresholds."""
        kind = draw.random()
        if self.is_ct:
            low = draw.uniform(150, 700) if kind < 0.75 else draw.uniform(-500, -200)
            return {"low": round(low), "high": round(low + draw.uniform(300, 900))} if kind > 0.9 else {"low": round(low)}
        low = self.range[0] + draw.uniform(0.08, 0.35) * (self.range[1] - self.range[0])
        return {"low": round(low), "high": round(low * draw.uniform(1.5, 3))} if kind > 0.9 else {"low": round(low)}

    def place(self, draw, share=0.6):
        """A point of the middle part of the scan."""
        return [draw.uniform(a + (1 - share) / 2 * (b - a), b - (1 - share) / 2 * (b - a)) for a, b in zip(self.low, self.high)]


def rectangle(draw, a, b):
    width, height = draw.uniform(20, 90), draw.uniform(20, 90)
    return [[[a - width / 2, b - height / 2], [a + width / 2, b - height / 2], [a + width / 2, b + height / 2], [a - width / 2, b + height / 2]]]


def plan_of(scan, voxel_mm, draw):
    steps = [{"id": "tissue", "do": "window", "scan": "scan", **scan.window(draw)}]
    whole = "tissue"
    if draw.random() < 0.5:
        steps.append({"id": "largest", "do": "parts", "object": whole, "largest": 1})
        whole = "largest"
    x, y, z = scan.place(draw)
    views = draw.sample([("anterior", x, z), ("left", y, z), ("superior", -x, -y)], draw.choice((1, 2)))
    steps += [
        {"id": "cut", "do": "mask", "regions": [{"view": view, "polygons_mm": rectangle(draw, a, b)} for view, a, b in views]},
        {"id": "piece", "do": "combine", "expression": f"{whole} & cut"},
        {"id": "rest", "do": "combine", "expression": f"{whole} - cut"},
        {"id": "moved", "do": "move", "object": "piece", "translate_mm": [draw.uniform(-8, 8) for _ in range(3)],
         "rotate": {"degrees": draw.uniform(-12, 12), "axis": [draw.gauss(0, 1) for _ in range(3)], "about_mm": [x, y, z]}},
        {"id": "result", "do": "combine", "expression": "rest | moved"},
        {"id": "overlap", "do": "combine", "expression": "rest & moved"},
        {"id": "piece_size", "do": "measure", "object": "piece"},
        {"id": "moved_size", "do": "measure", "object": "moved"},
        {"id": "twin", "do": "mirror", "object": "piece", "point_mm": [x, y, z], "normal": [draw.gauss(1, 0.2), draw.gauss(0, 0.2), draw.gauss(0, 0.2)]},
    ]
    return {"octotomy_plan": 1, "name": "census", "scans": {"scan": {"path": str(scan.path)}}, "universe": {"voxel_mm": voxel_mm}, "steps": steps}


def main():
    program, data, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    number = int(sys.argv[4]) if len(sys.argv) > 4 else 0
    verdicts, apart, empty, motions, other_sizes = collections.Counter(), 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scans = [Scan(program, path) for path in scans_of(data, folder)]
        path = folder / "census.plan.json"
        while sum(verdicts.values()) < count:
            scan, voxel_mm = scans[number % len(scans)], (3, 2, 1)[number // len(scans) % 3]
            draw = random.Random(number)
            path.write_text(json.dumps(plan_of(scan, voxel_mm, draw)))
            try:
                result = json_of(program, "run", path, "-o", folder / "report")
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                print(f"plan {number}, {scan.path.name}, {voxel_mm} mm: {error}", flush=True)
                verdicts["no result"] += 1
                number += 1
                continue
            where = f"plan {number}, {scan.path.name}, {voxel_mm} mm"
            piece, moved = (one.get("volume") for one in result["measurements"][:2])
            if piece and moved:
                motions += 1
                if any(abs(piece[key] - moved[key]) > 1e-9 * abs(piece[key]) for key in ("value", "half_width")):
                    other_sizes += 1
                    print(f"{where}: the piece has {piece['value']} +- {piece['half_width']} mm3, moved {moved['value']} +- "
                          f"{moved['half_width']}", flush=True)
            for certificate in result["certificates"]:
                verdict = certificate["verdict"]
                volumes = [certificate[kernel]["volume_mm3"] for kernel in ("voxel", "mesh")]
                if max(volumes) == 0:
                    empty += 1
                    continue
                verdicts[verdict] += 1
                is_apart = verdict == "PASS" and certificate["resolved"] and abs(volumes[0] - volumes[1]) > 0.1 * max(volumes)
                apart += is_apart
                if verdict != "PASS" or is_apart:
                    print(f"{where}, {certificate['object']}: {verdict}, "
                          f"{volumes[0]:.1f} and {volumes[1]:.1f} mm3: {certificate['reasons']}", flush=True)
            number += 1
            if number % 10 == 0:
                print(f"... {dict(verdicts)}", flush=True)
    total = sum(verdicts.values())
    others = total - verdicts["PASS"]
    print(f"{total} certificates of plans before {number}: {dict(verdicts)}; {100 * others / total:.2f} % not PASS; "
          f"{apart} resolved over a tenth apart; {empty} more are empty in both kernels, which is never a PASS; "
          f"{other_sizes} of {motions} moved pieces have another size or interval")
    return int(200 * others > total or apart > 0 or other_sizes > 0)


if __name__ == "__main__":
    sys.exit(main())
