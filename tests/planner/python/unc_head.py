# SPDX-License-Identifier: AGPL-3.0-or-later
"""unc_head.py SCAN FOLDER: the objects of tests/planner/data/unc_cthead.plan.json in fifteen lines."""
import sys
import octotomy
plan = octotomy.Plan({"ct": sys.argv[1]}, voxel_mm=1.0, name="Maxillary advancement, UNC CT head")
skull = plan.window("skull", scan="ct", low=300)
front = octotomy.region("anterior", [(-58, 69), (20, 69), (20, 97), (-58, 99)])
cut = plan.mask("cut", regions=[front, octotomy.region("left", [(-110, 69), (-48, 69), (-48, 93), (-110, 99)])])
maxilla, rest = plan.combine("maxilla", expression=skull & cut), plan.combine("rest", expression=skull - cut)
turn = {"degrees": 5, "axis": [1, 0, 0], "about_mm": [-19, -60, 90]}
advanced = plan.move("advanced", object=maxilla, translate_mm=(0, -6, 0), rotate=turn)
result = plan.combine("result", expression=rest | advanced)
overlap = plan.combine("overlap", expression=rest & advanced)
for name in (maxilla, result, overlap):
    plan.measure(f"{name}_size", object=name)
plan.surface("piece", object=advanced, path="maxilla.stl")
(made := plan.run(certify=False)).write(sys.argv[2])
