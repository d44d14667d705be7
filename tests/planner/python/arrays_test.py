# SPDX-License-Identifier: AGPL-3.0-or-later
"""Scans, octrees, meshes and pictures as arrays."""
import os
import resource
import tempfile
import unittest
from pathlib import Path

import numpy as np
import octotomy

try:
    import nibabel
except ImportError:
    nibabel = None

LATTICE = [[0.7, 0, 0, -10], [0, 0.7, 0, 20], [0, 0, 1.25, 5], [0, 0, 0, 1]]


def noise(shape=(20, 31, 17), dtype=np.int16):
    """Samples that repeat at every run."""
    return np.random.default_rng(7).integers(-1000, 2000, shape).astype(dtype)


class Scans(unittest.TestCase):
    def test_samples_are_shown_and_not_copied(self):
        scan = octotomy.Scan(noise(), LATTICE)
        first, again = scan.samples, scan.samples
        self.assertEqual(first.__array_interface__["data"][0], again.__array_interface__["data"][0])
        self.assertFalse(first.flags.owndata)
        with self.assertRaises(ValueError):
            first[0, 0, 0] = 1

    def test_samples_outlive_their_scan(self):
        samples = octotomy.Scan(noise(), LATTICE).samples
        np.testing.assert_array_equal(samples, noise())

    def test_files_read_back_to_the_same_samples_and_places(self):
        for dtype in (np.int16, np.float32):
            samples = noise(dtype=dtype) + (0.25 if dtype == np.float32 else 0)
            scan = octotomy.Scan(samples.astype(dtype), LATTICE)
            with tempfile.TemporaryDirectory() as folder:
                for name in ("s.nrrd", "s.nii.gz", "s.mha"):
                    scan.write(Path(folder) / name)
                    read = octotomy.read_scan(Path(folder) / name)
                    np.testing.assert_array_equal(read.samples, scan.samples)
                    np.testing.assert_array_equal(read.lps_from_voxel, LATTICE)

    def test_a_mesh_says_what_its_file_says_of_frame_and_unit(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "m.obj"
            path.write_text("# SPACE=RAS\nv 1 2 3\nv 4 2 3\nv 1 5 3\nf 1 2 3\n")
            mesh = octotomy.read_mesh(path)
            np.testing.assert_allclose(mesh.vertices_mm[0], [-1, -2, 3])
            checks = {line["check"]: line for line in mesh.audit}
            self.assertEqual(checks["frame"]["verdict"], "PASS")
            self.assertEqual(checks["unit"]["verdict"], "WARN")
            known = octotomy.read_mesh(path, frame="LPS", unit="cm")
            np.testing.assert_allclose(known.vertices_mm[0], [10, 20, 30])
            self.assertIn("cm", {line["check"]: line for line in known.audit}["unit"]["detail"])
            with self.assertRaisesRegex(ValueError, "up"):
                octotomy.read_mesh(path, frame="up")
        self.assertEqual(octotomy.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).audit, ())

    def test_a_scan_without_padding_has_none(self):
        self.assertIsNone(octotomy.Scan(noise(), LATTICE).padding)

    def test_arrays_of_a_wrong_shape_or_type_are_refused(self):
        with self.assertRaisesRegex(ValueError, r"\(z, y, x\)"):
            octotomy.Scan(np.zeros((3, 3), np.int16), LATTICE)
        with self.assertRaisesRegex(ValueError, "int16 or float32"):
            octotomy.Scan(np.zeros((3, 3, 3), np.int64), LATTICE)
        with self.assertRaisesRegex(ValueError, r"lps_from_voxel must be an array of the shape \(4, 4\)"):
            octotomy.Scan(noise(), [1, 2, 3])
        with self.assertRaisesRegex(ValueError, "not finite"):
            octotomy.Scan(noise(), np.full((4, 4), np.nan))

    def test_a_modality_is_of_letters(self):
        self.assertEqual(octotomy.Scan(noise(), LATTICE, modality="MR").modality, "MR")
        for modality in ("M\nR", "CT\x1b[31m", "\0", "\x7f"):
            with self.assertRaisesRegex(ValueError, "modality"):
                octotomy.Scan(noise(), LATTICE, modality=modality)

    def test_names_of_files_may_be_any_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.fsdecode(os.fsencode(folder) + b"/x\xff.nrrd")
            with self.assertRaisesRegex(octotomy.InputError, r"x\\xff\.nrrd: no such file"):
                octotomy.read_scan(name)
            octotomy.Scan(noise(), LATTICE).write(name)
            self.assertTrue(octotomy.read_scan(name).source.endswith(r"/x\xff.nrrd"))

    def test_a_file_that_does_not_fit_is_no_fault_of_the_input(self):
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        with tempfile.TemporaryDirectory() as folder:
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))
            try:
                with self.assertRaisesRegex(octotomy.ResourceError, "s.nrrd: cannot be written: File too large") as raised:
                    octotomy.Scan(noise(), LATTICE).write(Path(folder) / "s.nrrd")
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, before)
            self.assertNotIsInstance(raised.exception, octotomy.InputError)
            self.assertEqual(os.listdir(folder), [])

    @unittest.skipIf(nibabel is None, "nibabel is not installed")
    def test_nibabel_sees_the_same_places(self):
        scan = octotomy.Scan(noise(), LATTICE)
        with tempfile.TemporaryDirectory() as folder:
            scan.write(Path(folder) / "s.nii.gz")
            image = nibabel.load(Path(folder) / "s.nii.gz")
            ras_from_voxel = np.diag([-1, -1, 1, 1]) @ scan.lps_from_voxel
            np.testing.assert_allclose(image.affine, ras_from_voxel, atol=1e-5)
            np.testing.assert_array_equal(np.asarray(image.dataobj).transpose(2, 1, 0), scan.samples)


class Octrees(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(3)
        self.universe = octotomy.Universe(5, np.eye(4))
        self.a, self.b = (random.random((32, 32, 32)) < share for share in (0.3, 0.6))
        self.tree_a, self.tree_b = (octotomy.Octree.of_voxels(each, self.universe) for each in (self.a, self.b))

    def test_operators_are_those_of_truths(self):
        a, b, A, B = self.a, self.b, self.tree_a, self.tree_b
        for expression, truth in ((A & B, a & b), (A | B, a | b), (A - B, a & ~b), (A ^ B, a ^ b),
                                  ((A - B) | (B & ~A), a ^ b), (~A & B, ~a & b)):
            np.testing.assert_array_equal(expression.octree(self.universe).voxels(), truth)

    def test_voxels_go_there_and_back(self):
        self.assertEqual(len(self.tree_a), self.a.sum())
        np.testing.assert_array_equal(self.tree_a.voxels(), self.a)
        self.assertEqual(octotomy.Octree.of_voxels(self.tree_a.voxels(), self.universe), self.tree_a)
        small = octotomy.Octree.of_voxels(self.a[:3, :5, :7], self.universe)
        np.testing.assert_array_equal(small.voxels()[:3, :5, :7], self.a[:3, :5, :7])
        self.assertEqual(len(small), self.a[:3, :5, :7].sum())

    def test_a_motion_by_whole_voxels_shifts_them(self):
        motion = octotomy.motion(translate_mm=[3, 0, -2])
        moved = octotomy.move(self.tree_a, motion).octree(self.universe).voxels()
        truth = np.zeros_like(self.a)
        truth[:-2, :, 3:] = self.a[2:, :, :-3]
        np.testing.assert_array_equal(moved, truth)

    def test_a_window_is_a_comparison(self):
        samples = noise((32, 32, 32))
        grey = octotomy.Scan(samples, np.eye(4)).grey(self.universe)
        skull = octotomy.window(grey, 300, 900).octree(self.universe)
        np.testing.assert_array_equal(skull.voxels(), (samples >= 300) & (samples <= 900))
        for low, high in ((np.nan, 900), (300, np.nan)):
            with self.assertRaisesRegex(ValueError, "not a number"):
                octotomy.window(grey, low, high)
        self.assertEqual(octotomy.window(grey, -np.inf, np.inf).octree(self.universe).voxels().sum(), samples.size)

    def test_a_sphere_has_its_volume(self):
        ball = octotomy.sphere([16.3, 16.2, 15.9], 12).octree(self.universe)
        self.assertAlmostEqual(ball.measures()["volume_mm3"] / (4 / 3 * np.pi * 12**3), 1, delta=0.01)

    def test_files_read_back(self):
        with tempfile.TemporaryDirectory() as folder:
            self.tree_a.write(Path(folder) / "a.octree", "a")
            self.assertEqual(octotomy.read_octree(Path(folder) / "a.octree"), self.tree_a)


class Meshes(unittest.TestCase):
    def test_a_tetrahedron_goes_there_and_back(self):
        vertices = np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]], float)
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        mesh = octotomy.Mesh(vertices, faces)
        np.testing.assert_array_equal(mesh.vertices_mm, vertices)
        np.testing.assert_array_equal(mesh.triangles, faces)
        solid = mesh.solid()
        self.assertAlmostEqual(solid.volume_mm3, 36)
        half = solid & solid.moved(octotomy.motion(translate_mm=[3, 0, 0]))
        self.assertAlmostEqual(half.volume_mm3, 36 / 8)
        self.assertAlmostEqual((solid - half).volume_mm3, 36 - 36 / 8)
        points = solid.vertices_mm
        self.assertEqual(points.__array_interface__["data"][0], solid.vertices_mm.__array_interface__["data"][0])

    def test_triangles_refer_to_vertices_by_whole_numbers(self):
        vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        np.testing.assert_array_equal(octotomy.Mesh(vertices, [[0.0, 1.0, 2.0]]).triangles, [[0, 1, 2]])
        for wrong in (0.5, -0.5, np.nan):
            with self.assertRaisesRegex(ValueError, "give whole numbers"):
                octotomy.Mesh(vertices, [[0, 1, 2], [0, 1, wrong]])
        for wrong in (-1, 3, 1e300, np.inf, 2**32):
            with self.assertRaisesRegex(ValueError, "triangle 1 refers to vertex .*, and there are 3"):
                octotomy.Mesh(vertices, [[0, 1, 2], [0, 1, wrong]])

    def test_a_solid_is_moved_no_farther_than_its_points_stay_apart(self):
        solid = octotomy.Mesh([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]],
                              [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).solid()
        self.assertAlmostEqual(solid.moved(octotomy.motion(translate_mm=[1e9, 0, -1e9])).volume_mm3, 36, places=3)
        for far in ([1e18, 0, 0], [0, 0, -2e9]):
            with self.assertRaisesRegex(ValueError, "the translation of moved_from_still, in mm, is"):
                solid.moved(octotomy.motion(translate_mm=far))

    def test_arrays_outlive_their_solid(self):
        ball = np.where(sum(x**2 for x in np.mgrid[-9:10, -9:10, -9:10]) <= 64, 1000, -1000).astype(np.int16)
        solid = octotomy.isosurface(octotomy.Scan(ball, np.eye(4)), 0).solid()
        points, faces, volume = solid.vertices_mm, solid.triangles, solid.volume_mm3
        del solid
        a, b, c = (points[faces[:, i]] for i in range(3))
        self.assertAlmostEqual(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, volume, places=6)

    def test_an_open_surface_is_no_solid(self):
        with self.assertRaisesRegex(octotomy.GeometryError, "open|edge"):
            octotomy.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).solid()
        with self.assertRaisesRegex(ValueError, "refers to vertex 7"):
            octotomy.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]])


class Pictures(unittest.TestCase):
    def test_depth_leads_back_to_the_surface(self):
        universe = octotomy.Universe(6, np.eye(4))
        ball = octotomy.sphere([32, 32, 32], 20).octree(universe)
        picture = octotomy.render([octotomy.Drawn(ball)], view="left", size_px=(120, 80))
        self.assertEqual(picture.rgb.shape, (80, 120, 3))
        self.assertEqual(picture.depth_mm.shape, (80, 120))
        point = picture.point_mm(60, 40)
        self.assertAlmostEqual(np.linalg.norm(point - 32), 20, delta=1.0)
        self.assertGreater(point[0], 32)  # seen from the patient's left
        self.assertEqual(picture.object[40, 60], 0)
        self.assertEqual(picture.object[0, 0], -1)
        self.assertIsNone(picture.point_mm(0, 0))

    def test_colours_and_opacity_are_from_0_to_1(self):
        universe = octotomy.Universe(3, np.eye(4))
        ball = octotomy.sphere([4, 4, 4], 3).octree(universe)
        for part in (-1, -1e-6, 1.001, 9, 1e30, np.inf, -np.inf, np.nan):
            for colour in ((part, 0, 0), (0, part, 0), (0, 0, part)):
                with self.assertRaisesRegex(ValueError, "a part of colour is"):
                    octotomy.Drawn(ball, colour=colour)
            with self.assertRaisesRegex(ValueError, "opacity is"):
                octotomy.Drawn(ball, opacity=part)
        with self.assertRaisesRegex(ValueError, "threshold is not a number"):
            octotomy.Drawn(ball, threshold=np.nan)
        black, white = (octotomy.render([octotomy.Drawn(ball, colour=[part] * 3)]).rgb.min() for part in (0, 1))
        self.assertLess(black, white)

    def test_a_picture_is_no_larger_than_the_programs(self):
        ball = octotomy.sphere([4, 4, 4], 3).octree(octotomy.Universe(3, np.eye(4)))
        for size_px in ((0, 5), (5, -1), (8193, 5), (2**31 - 1, 2**31 - 1)):
            with self.assertRaisesRegex(ValueError, "a side of size_px is .*: give 1 to 8192"):
                octotomy.render([octotomy.Drawn(ball)], size_px=size_px)


if __name__ == "__main__":
    unittest.main()
