# SPDX-License-Identifier: AGPL-3.0-or-later
"""Octotomy: operations on the skull in two geometry kernels that check each other.

Points and matrices are of DICOM's patient frame (LPS) in millimetres; arrays of samples and voxels have the
shape (z, y, x), and matrices such as `lps_from_voxel` map (x, y, z). What an array shows is not copied, and
nobody can write to it. Long work lets other threads run and stops at Ctrl-C.

>>> import octotomy
>>> scan = octotomy.read_scan("head.nrrd")
>>> plan = octotomy.Plan({"ct": "head.nrrd"}, voxel_mm=1.0)
>>> skull = plan.window("skull", scan="ct", low=300)
>>> cut = plan.mask("cut", regions=[octotomy.region("anterior", [[-40, -60], [40, -60], [40, -25], [-40, -25]])])
>>> maxilla = plan.combine("maxilla", expression=skull & cut)
>>> result = plan.run()
>>> result["maxilla"].solid.volume_mm3
"""
import os as _os
from pathlib import Path as _Path

from . import _kernel
from ._kernel import (CancelledError, Drawn, Error, Expression, GeometryError, GreyOctree, InputError,
                      InternalError, Mesh, Octree, Picture, ResourceError, Scan, Solid, Universe, __version__, box,
                      half_space, isosurface, mask, motion, move, read_mesh, read_octree, read_scan, render, sphere,
                      window)
from .names import Name
from .plan import Made, Plan, Result, region

_helpers = _Path(__file__).resolve().parent / "helpers"
if "OCTOTOMY_HELPERS" not in _os.environ and _helpers.is_dir():
    _kernel.set_helper_folder(_helpers)

__all__ = [
    "CancelledError", "Drawn", "Error", "Expression", "GeometryError", "GreyOctree", "InputError", "InternalError",
    "Made", "Mesh", "Name", "Octree", "Picture", "Plan", "ResourceError", "Result", "Scan", "Solid", "Universe",
    "__version__", "box", "half_space", "isosurface", "mask", "motion", "move", "read_mesh", "read_octree",
    "read_scan", "region", "render", "sphere", "window"
]
