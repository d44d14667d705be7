# SPDX-License-Identifier: AGPL-3.0-or-later
"""The field's other packages see the same samples, places and triangles, by their own conventions of arrays. Each
test skips where its package is not installed; Debian has all but SimpleITK, trimesh and PyVista."""
import importlib
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from arrays_test import LATTICE, noise

import octotomy

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]


def needs(name):
    """The package, or None, and what skips a test without it."""
    try:
        return importlib.import_module(name), lambda test: test
    except ImportError:
        return None, unittest.skip(f"{name} is not installed")


pydicom, with_pydicom = needs("pydicom")
sitk, with_sitk = needs("SimpleITK")
trimesh, with_trimesh = needs("trimesh")
pyvista, with_pyvista = needs("pyvista")
meshio, with_meshio = needs("meshio")
vtk, with_vtk = needs("vtkmodules.all")


def ball():
    """A ball's solid."""
    samples = np.where(sum(x**2 for x in np.mgrid[-9:10, -9:10, -9:10]) <= 64, 1000, -1000).astype(np.int16)
    return octotomy.isosurface(octotomy.Scan(samples, LATTICE), 0).solid()


class Images(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = Path(place.name)
        self.scan = octotomy.Scan(noise(), LATTICE)

    @with_pydicom
    def test_pydicom_reads_a_written_series_and_its_arrays_make_the_scan_again(self):
        self.scan.write(self.folder / "s.nrrd")
        subprocess.run([PROGRAM, "convert", self.folder / "s.nrrd", "-o", self.folder / "series"], check=True,
                       capture_output=True)
        slices = [pydicom.dcmread(path) for path in (self.folder / "series").iterdir()]
        slices.sort(key=lambda each: each.ImagePositionPatient[2])
        samples = np.stack([each.pixel_array * float(each.RescaleSlope) + float(each.RescaleIntercept) for each in slices])
        lps_from_voxel = np.eye(4)
        along, down = np.reshape(np.array(slices[0].ImageOrientationPatient, float), (2, 3))
        lps_from_voxel[:3, 0] = along * float(slices[0].PixelSpacing[1])
        lps_from_voxel[:3, 1] = down * float(slices[0].PixelSpacing[0])
        first, last = (np.array(each.ImagePositionPatient, float) for each in (slices[0], slices[-1]))
        lps_from_voxel[:3, 2] = (last - first) / (len(slices) - 1)
        lps_from_voxel[:3, 3] = first
        again = octotomy.Scan(samples.astype(np.int16), lps_from_voxel)
        np.testing.assert_array_equal(again.samples, self.scan.samples)
        np.testing.assert_allclose(again.lps_from_voxel, self.scan.lps_from_voxel, atol=1e-9)

    @with_sitk
    def test_simpleitk_takes_the_array_as_it_is(self):
        image = sitk.GetImageFromArray(self.scan.samples)  # (z, y, x), as ours
        image.SetSpacing(np.diag(self.scan.lps_from_voxel)[:3].tolist())
        image.SetOrigin(self.scan.lps_from_voxel[:3, 3].tolist())
        place = image.TransformIndexToPhysicalPoint((2, 3, 4))
        np.testing.assert_allclose(place, (self.scan.lps_from_voxel @ [2, 3, 4, 1])[:3])
        np.testing.assert_array_equal(sitk.GetArrayViewFromImage(image), self.scan.samples)

    @with_vtk
    def test_vtk_shows_the_samples_where_they_lie_in_memory(self):
        support = importlib.import_module("vtkmodules.util.numpy_support")
        flat = self.scan.samples.reshape(-1)
        self.assertTrue(np.shares_memory(flat, self.scan.samples))
        image = vtk.vtkImageData()
        image.SetDimensions(*self.scan.samples.shape[::-1])
        array = support.numpy_to_vtk(flat)
        image.GetPointData().SetScalars(array)
        shown = support.vtk_to_numpy(image.GetPointData().GetScalars())
        self.assertEqual(shown.__array_interface__["data"][0], flat.__array_interface__["data"][0])
        x, y, z = 3, 5, 7
        self.assertEqual(image.GetScalarComponentAsDouble(x, y, z, 0), self.scan.samples[z, y, x])


class Surfaces(unittest.TestCase):
    @with_vtk
    def test_vtk_measures_the_same_volume_of_shared_points(self):
        support = importlib.import_module("vtkmodules.util.numpy_support")
        solid = ball()
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        points.SetData(support.numpy_to_vtk(solid.vertices_mm))
        shown = support.vtk_to_numpy(points.GetData())
        self.assertEqual(shown.__array_interface__["data"][0], solid.vertices_mm.__array_interface__["data"][0])
        count = len(solid.triangles)
        cells = vtk.vtkCellArray()
        cells.SetData(support.numpy_to_vtkIdTypeArray(np.arange(0, 3 * count + 1, 3, dtype=np.int64), deep=1),
                      support.numpy_to_vtkIdTypeArray(solid.triangles.astype(np.int64).ravel(), deep=1))
        surface = vtk.vtkPolyData()
        surface.SetPoints(points)
        surface.SetPolys(cells)
        measured = vtk.vtkMassProperties()
        measured.SetInputData(surface)
        self.assertAlmostEqual(measured.GetVolume() / solid.volume_mm3, 1, places=6)

    @with_meshio
    def test_meshio_writes_and_reads_the_same_triangles(self):
        solid = ball()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "ball.vtu"
            meshio.Mesh(solid.vertices_mm, [("triangle", solid.triangles)]).write(path)
            read = meshio.read(path)
        again = octotomy.Mesh(read.points, read.cells_dict["triangle"]).solid()
        np.testing.assert_array_equal(again.vertices_mm, solid.vertices_mm)
        self.assertEqual(again.volume_mm3, solid.volume_mm3)

    @with_trimesh
    def test_trimesh_measures_the_same_volume(self):
        solid = ball()
        mesh = trimesh.Trimesh(solid.vertices_mm, solid.triangles, process=False)
        self.assertTrue(mesh.is_watertight)
        self.assertAlmostEqual(mesh.volume / solid.volume_mm3, 1, places=9)

    @with_pyvista
    def test_pyvista_measures_the_same_volume(self):
        solid = ball()
        faces = np.column_stack([np.full(len(solid.triangles), 3), solid.triangles])
        self.assertAlmostEqual(pyvista.PolyData(solid.vertices_mm, faces).volume / solid.volume_mm3, 1, places=6)


if __name__ == "__main__":
    unittest.main()
