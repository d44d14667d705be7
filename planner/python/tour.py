#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""A tour of the Python package: tour.py SCAN FOLDER, for example with the scan of `octotomy phantom head`."""
import sys

import numpy as np
import octotomy

# %% A scan is an array in the patient's frame.
scan = octotomy.read_scan(sys.argv[1])
print(f"{scan.samples.shape} samples of {scan.samples.dtype} in {scan.unit}, {scan.spacing_mm} mm apart")
for finding in scan.audit:
    if finding["verdict"] != "PASS":
        print(finding["verdict"], finding["check"], finding["detail"])

# %% The voxel kernel: windows, masks and motions under Boolean operators, evaluated in one walk.
universe = scan.universe(voxel_mm=2.0)
skull = octotomy.window(scan.grey(universe), 300)
cut = octotomy.mask([("anterior", [[(-40, -60), (40, -60), (40, -25), (-40, -25)]]),
                     ("left", [[(-90, -60), (-20, -60), (-20, -25), (-90, -25)]])])
forward = octotomy.motion(translate_mm=(0, -6, 2), degrees=5, axis=(1, 0, 0), about_mm=(0, -40, -30))
after = ((skull - cut) | octotomy.move(skull & cut, forward)).octree(universe)
print(f"after the operation: {after.measures()['volume_mm3']:.0f} mm3 of bone")

# %% Its picture, with the depth of every pixel.
picture = octotomy.render([octotomy.Drawn(after)], view="left", size_px=(400, 400))
print(f"{np.isfinite(picture.depth_mm).mean():.0%} of the pixels show bone")

# %% The mesh kernel: arrays of vertices and triangles, and solids that are proven to be such.
surface = octotomy.isosurface(scan, 300)
print(f"{len(surface.triangles)} triangles, " + "; ".join(surface.health()["findings"] or ["a solid"]))

# %% A plan does both and certifies that they agree. Every step is a method, as the table of operations has it.
plan = octotomy.Plan({"ct": sys.argv[1]}, voxel_mm=2.0, name="Le Fort I advancement")
bone = plan.window("skull", scan="ct", low=300)
box = plan.mask("cut", regions=[octotomy.region("anterior", [(-40, -60), (40, -60), (40, -25), (-40, -25)]),
                                octotomy.region("left", [(-90, -60), (-20, -60), (-20, -25), (-90, -25)])])
maxilla, rest = plan.combine("maxilla", expression=bone & box), plan.combine("rest", expression=bone - box)
advanced = plan.move("advanced", object=maxilla, translate_mm=(0, -6, 2),
                     rotate={"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]})
plan.combine("result", expression=rest | advanced)
plan.combine("overlap", expression=rest & advanced)
plan.measure("overlap_size", object="overlap")
result = plan.run()
for made in result.values():
    if made.certificate:
        print(made.id, made.certificate["verdict"], f"{made.solid.volume_mm3:.0f} mm3")
assert result["result"].octree == after

# %% The result's folder is that of `octotomy run`.
result.write(sys.argv[2])
