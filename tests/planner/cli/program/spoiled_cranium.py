#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Writes the surface of a scan as VTK makes it, about 400 000 triangles, spoiled as published surfaces are.

spoiled_cranium.py SCAN.nii.gz OUT.vtp

Decimation leaves open edges and triangles without area; here 200 triangles are taken out, 60 edges get a
third triangle, and 150 points are pushed through the surface behind them. Prints one JSON object: triangles,
open_edges, fans. Status 77 where VTK's or NumPy's packages are missing.
"""
import json
import sys

try:
    import numpy
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(77)


def isosurface(scan):
    reader = vtk.vtkNIFTIImageReader()
    reader.SetFileName(scan)
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputConnection(reader.GetOutputPort())
    edges.SetValue(0, 300)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    decimate = vtk.vtkDecimatePro()
    decimate.SetInputData(edges.GetOutput())
    decimate.SetTargetReduction(1 - 400000 / edges.GetOutput().GetNumberOfPolys())
    decimate.PreserveTopologyOff()
    decimate.Update()
    mesh = decimate.GetOutput()
    return (vtk_to_numpy(mesh.GetPoints().GetData()).astype(float),
            vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3).copy())


def unit(vectors):
    return vectors / (numpy.linalg.norm(vectors, axis=1)[:, None] + 1e-12)


def normals(points, faces):
    return numpy.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])


def spoiled(points, faces):
    random = numpy.random.default_rng(1)
    stays = numpy.ones(len(faces), bool)
    stays[random.choice(len(faces), 200, replace=False)] = False
    faces = faces[stays]
    chosen = random.choice(len(faces), 60, replace=False)
    tips = points[faces[chosen][:, :2]].mean(axis=1) + 0.8 * unit(normals(points, faces[chosen]))
    fins = numpy.column_stack([faces[chosen][:, :2], len(points) + numpy.arange(60)])
    points, faces = numpy.vstack([points, tips]), numpy.vstack([faces, fins])
    at_points = numpy.zeros_like(points)
    for corner in range(3):
        numpy.add.at(at_points, faces[:, corner], normals(points, faces))
    pushed = random.choice(numpy.unique(faces), 150, replace=False)
    points[pushed] -= 4.0 * unit(at_points[pushed])
    return points, faces


def edges_of(mesh, boundary):
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.SetBoundaryEdges(boundary)
    edges.SetNonManifoldEdges(not boundary)
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def main(scan, out):
    points, faces = spoiled(*isosurface(scan))
    places = vtk.vtkPoints()
    places.SetData(numpy_to_vtk(points.astype(numpy.float32), deep=1))
    cells = vtk.vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.ravel().astype(numpy.int64), deep=1))
    mesh = vtk.vtkPolyData()
    mesh.SetPoints(places)
    mesh.SetPolys(cells)
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(out)
    writer.SetInputData(mesh)
    writer.Write()
    print(json.dumps({"triangles": len(faces), "open_edges": edges_of(mesh, True),
                      "fans": edges_of(mesh, False)}))


main(*sys.argv[1:3])
