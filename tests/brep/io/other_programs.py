# SPDX-License-Identifier: AGPL-3.0-or-later
"""other_programs.py write FOLDER: writes the box from (10, 30, -5) to (20, 50, 25) by VTK and meshio in every form
that they have. Names that begin with ras_ state SPACE=RAS and hold it with x and y negated.
other_programs.py read FILE...: prints the box that VTK, meshio or numpy reads from each, in millimetres, LPS."""
import json
import os
import struct
import sys

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

low, high = np.array([10.0, 30, -5]), np.array([20.0, 50, 25])


def polydata(ras):
    source = vtk.vtkCubeSource()
    sign = -1 if ras else 1
    source.SetBounds(*sorted([sign * 10, sign * 20]), *sorted([sign * 30, sign * 50]), -5, 25)
    clean = vtk.vtkCleanPolyData()  # one point for a corner
    clean.SetInputConnection(source.GetOutputPort())
    clean.Update()
    made = clean.GetOutput()
    numbers = vtk.vtkIntArray()
    numbers.SetName("some numbers")
    numbers.SetNumberOfComponents(2)
    numbers.InsertNextTuple2(1, 2)
    made.GetFieldData().AddArray(numbers)
    if ras:
        space = vtk.vtkStringArray()
        space.SetName("SPACE")
        space.InsertNextValue("RAS")
        made.GetFieldData().AddArray(space)
    return made


def write_by_vtk(folder):
    def put(writer, data, name):
        writer.SetInputData(data)
        writer.SetFileName(os.path.join(folder, name))
        assert writer.Write() == 1, name

    for ras in (False, True):
        start, box = ("ras_" if ras else "lps_"), polydata(ras)
        delaunay = vtk.vtkDelaunay3D()
        delaunay.SetInputData(box)
        delaunay.Update()
        grid = delaunay.GetOutput()
        grid.SetFieldData(box.GetFieldData())
        surface = vtk.vtkAppendFilter()
        surface.AddInputData(box)
        surface.Update()
        quads = surface.GetOutput()
        quads.SetFieldData(box.GetFieldData())
        for version in (42, 51):
            for kind, binary in (("text", vtk.VTK_ASCII), ("binary", vtk.VTK_BINARY)):
                for what, data, writer in (("polydata", box, vtk.vtkPolyDataWriter()), ("tetrahedra", grid, vtk.vtkUnstructuredGridWriter()),
                                           ("quads", quads, vtk.vtkUnstructuredGridWriter())):
                    writer.SetFileVersion(version)
                    writer.SetFileType(binary)
                    put(writer, data, f"{start}{what}_{version}_{kind}.vtk")
        for mode in (vtk.vtkXMLWriter.Ascii, vtk.vtkXMLWriter.Binary, vtk.vtkXMLWriter.Appended):
            for packing in (vtk.vtkXMLWriter.NONE, vtk.vtkXMLWriter.ZLIB, vtk.vtkXMLWriter.LZ4):
                for encode in (0, 1):
                    for order in (vtk.vtkXMLWriter.BigEndian, vtk.vtkXMLWriter.LittleEndian):
                        for what, data, writer in (("polydata", box, vtk.vtkXMLPolyDataWriter()), ("tetrahedra", grid, vtk.vtkXMLUnstructuredGridWriter()),
                                                   ("quads", quads, vtk.vtkXMLUnstructuredGridWriter())):
                            writer.SetDataMode(mode)
                            writer.SetCompressorType(packing)
                            writer.SetEncodeAppendedData(encode)
                            writer.SetByteOrder(order)
                            ending = "vtp" if what == "polydata" else "vtu"
                            put(writer, data, f"{start}{what}_{mode}_{packing}_{encode}_{order}.{ending}")
        triangles = vtk.vtkTriangleFilter()
        triangles.SetInputData(box)
        triangles.Update()
        for kind, binary in (("text", vtk.VTK_ASCII), ("binary", vtk.VTK_BINARY)):
            writer = vtk.vtkSTLWriter()
            writer.SetFileType(binary)
            writer.SetHeader("3D Slicer output. SPACE=" + ("RAS" if ras else "LPS"))
            put(writer, triangles.GetOutput(), f"{start}{kind}.stl")
            writer = vtk.vtkPLYWriter()
            writer.SetFileType(binary)
            writer.AddComment("SPACE=" + ("RAS" if ras else "LPS"))
            put(writer, triangles.GetOutput(), f"{start}{kind}.ply")
    for name in ("strips", ):
        stripper = vtk.vtkStripper()
        stripper.SetInputData(triangles.GetOutput())
        stripper.Update()
        put(vtk.vtkPolyDataWriter(), stripper.GetOutput(), f"ras_{name}.vtk")


def write_by_meshio(folder):
    corners = np.array([[high[0] if i & 1 else low[0], high[1] if i & 2 else low[1], high[2] if i & 4 else low[2]] for i in range(8)])
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    hexahedron = np.array([[0, 1, 3, 2, 4, 5, 7, 6]])
    for name, cells in (("lps_meshio.stl", [("triangle", triangles)]), ("lps_meshio_triangles.ply", [("triangle", triangles)]),
                        ("lps_meshio_quads.ply", [("quad", quads)]), ("lps_meshio_quads.obj", [("quad", quads)]),
                        ("lps_meshio.off", [("triangle", triangles)]), ("lps_meshio_quads.vtk", [("quad", quads)]),
                        ("lps_meshio_hexahedron.vtk", [("hexahedron", hexahedron)]), ("lps_meshio_hexahedron.vtu", [("hexahedron", hexahedron)]),
                        ("lps_meshio_mixed.vtu", [("hexahedron", hexahedron), ("quad", quads)])):
        meshio.write(os.path.join(folder, name), meshio.Mesh(corners, cells))


def points_of_glb(path):
    """By the specification: the accessor's numbers under the node's matrix, metres, y up, z to the front."""
    data = open(path, "rb").read()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert magic == b"glTF" and version == 2 and length == len(data)
    size, = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20:20 + size])
    binary = data[28 + size:]
    node = document["nodes"][document["scenes"][document["scene"]]["nodes"][0]]
    accessor = document["accessors"][document["meshes"][node["mesh"]]["primitives"][0]["attributes"]["POSITION"]]
    view = document["bufferViews"][accessor["bufferView"]]
    points = np.frombuffer(binary, "<f4", 3 * accessor["count"], view["byteOffset"]).reshape(-1, 3)
    matrix = np.array(node["matrix"]).reshape(4, 4).T
    x, y, z = 1000 * (np.c_[points, np.ones(len(points))] @ matrix.T)[:, :3].T
    return np.c_[x, -z, y]


def points_by_vtk(path):
    reader = {".stl": vtk.vtkSTLReader, ".ply": vtk.vtkPLYReader, ".obj": vtk.vtkOBJReader, ".vtp": vtk.vtkXMLPolyDataReader}[os.path.splitext(path)[1]]()
    reader.SetFileName(path)
    reader.Update()
    if path.endswith(".vtp"):
        assert reader.GetOutput().GetFieldData().GetAbstractArray("SPACE").GetValue(0) == "LPS"
    return vtk_to_numpy(reader.GetOutput().GetPoints().GetData())


if sys.argv[1] == "write":
    write_by_vtk(sys.argv[2])
    write_by_meshio(sys.argv[2])
else:
    for path in sys.argv[2:]:
        answers = []
        if path.endswith(".glb"):
            answers.append(points_of_glb(path))
        elif not path.endswith(".off"):
            answers.append(points_by_vtk(path))
        if path.endswith((".stl", ".ply", ".obj", ".off")):
            answers.append(meshio.read(path).points)
        assert answers
        for points in answers:
            assert np.allclose(points.min(0), low) and np.allclose(points.max(0), high), (path, points.min(0), points.max(0))
    print("all", len(sys.argv) - 2)
