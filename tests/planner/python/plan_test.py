# SPDX-License-Identifier: AGPL-3.0-or-later
"""Plans in Python are plans of the program."""
import json
import os
import runpy
import signal
import subprocess
import tempfile
import threading
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import octotomy

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
HEADS = [Path(os.environ["OCTOTOMY_SHARED_DATA"]) / "ct_unc_cthead.nrrd"]


def le_fort_i(scan, voxel_mm, up_mm=0):
    """The example operation, so far higher."""
    z = np.array([-60, -60, -25, -25]) + up_mm
    plan = octotomy.Plan({"ct": scan}, voxel_mm=voxel_mm)
    skull = plan.window("skull", scan="ct", low=300)
    cut = plan.mask("cut", regions=[
        octotomy.region("anterior", np.transpose([[-40, 40, 40, -40], z])),
        octotomy.region("left", np.transpose([[-90, -20, -20, -90], z]))
    ])
    maxilla = plan.combine("maxilla", expression=skull & cut)
    rest = plan.combine("rest", expression=skull - cut)
    advanced = plan.move("advanced", object=maxilla, translate_mm=np.array([0, -6, 2]),
                         rotate={"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30 + up_mm]})
    plan.combine("result", expression=rest | advanced)
    plan.combine("overlap", expression=rest & advanced)
    plan.measure("overlap_size", object="overlap")
    plan.surface("piece", object=advanced, path="piece.ply")
    return plan


class Plans(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.place.name)
        cls.head = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_1.nrrd"

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def test_objects_are_the_programs_bit_for_bit(self):
        plan = le_fort_i(self.head, 3.0)
        plan.write(self.folder / "a.plan.json")
        subprocess.run([PROGRAM, "run", self.folder / "a.plan.json", "-o", self.folder / "by_program"], check=True,
                       capture_output=True)
        result = plan.run()
        said = result.write(self.folder / "by_python")
        told = json.loads((self.folder / "by_program/result.json").read_text())
        self.assertEqual(said["objects"], told["objects"])
        self.assertEqual(said["measurements"], told["measurements"])
        self.assertEqual((self.folder / "by_program/piece.ply").read_bytes(),
                         (self.folder / "by_python/piece.ply").read_bytes())
        self.assertEqual([each["verdict"] for each in told["certificates"]],
                         [made.certificate["verdict"] for made in result.values() if made.certificate])
        volumes = {made.id: made.octree.measures()["volume_mm3"] for made in result.values()}
        self.assertEqual(volumes["maxilla"] + volumes["rest"], volumes["skull"])

    def test_operators_make_the_kernels_own_expressions(self):
        plan = le_fort_i(self.head, 3.0)
        made = plan.run(certify=False)
        scan = octotomy.read_scan(self.head)
        grey = scan.grey(made.universe)
        skull, cut = octotomy.window(grey, 300), octotomy.mask([
            ("anterior", [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]),
            ("left", [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]])])
        motion = octotomy.motion(translate_mm=[0, -6, 2], degrees=5, axis=[1, 0, 0], about_mm=[0, -40, -30])
        whole = ((skull - cut) | octotomy.move(skull & cut, motion)).octree(made.universe)
        self.assertEqual(whole, made["result"].octree)
        self.assertIsNone(made["result"].certificate)

    def test_a_real_head_agrees_with_the_program(self):
        for head in HEADS:
            if not head.exists():
                self.skipTest(f"{head.name} is not there")
            plan = le_fort_i(head, 3.0, up_mm=100)
            plan.write(self.folder / "real.plan.json")
            out = subprocess.run([PROGRAM, "run", "real.plan.json", "-o", "real", "--json"], cwd=self.folder,
                                 capture_output=True, check=False)
            self.assertIn(out.returncode, (0, 1), out.stderr)
            result = plan.run(certify=False)
            told = {each["id"]: each["voxel"]["volume_mm3"] for each in json.loads(out.stdout)["objects"]}
            self.assertGreater(told["maxilla"], 1000)
            self.assertEqual({made.id: made.octree.measures()["volume_mm3"] for made in result.values()}, told)

    def test_fifteen_lines_make_the_objects_of_the_real_heads_plan_bit_for_bit(self):
        if not HEADS[0].exists():
            self.skipTest(f"{HEADS[0].name} is not there")
        script = Path(__file__).with_name("unc_head.py")
        self.assertLessEqual(len(script.read_text().splitlines()) - 2, 15)  # without licence and docstring
        with unittest.mock.patch("sys.argv", [str(script), str(HEADS[0]), str(self.folder / "lines")]):
            own = runpy.run_path(str(script))["made"]
        document = octotomy.Plan.read(script.parents[1] / "data/unc_cthead.plan.json")
        document.document["steps"] = [step for step in document.document["steps"] if step["id"] not in ("deck", "grid")]
        document.document["scans"]["ct"]["path"] = str(HEADS[0])
        told = document.run(certify=False)
        self.assertEqual(list(own), list(told))
        for made in told.values():
            self.assertEqual(own[made.id].octree, made.octree, made.id)
            np.testing.assert_array_equal(own[made.id].solid.vertices_mm, made.solid.vertices_mm)
            np.testing.assert_array_equal(own[made.id].solid.triangles, made.solid.triangles)
        told.write(self.folder / "told")
        self.assertEqual(*((self.folder / name / "maxilla.stl").read_bytes() for name in ("lines", "told")))

    def test_text_goes_there_and_back(self):
        plan = le_fort_i("head.nrrd", None)
        plan.write(self.folder / "b.plan.json")
        again = octotomy.Plan.read(self.folder / "b.plan.json")
        self.assertEqual(str(plan), str(again))
        self.assertEqual(again.folder, self.folder)

    def test_names_make_expressions(self):
        a, b, c = map(octotomy.Name, "abc")
        self.assertEqual((a | b) - c, "(a | b) - c")
        self.assertEqual(~a & (b ^ c), "(~a) & (b ^ c)")
        self.assertEqual(a & "other", "a & other")

    def test_refusals_name_step_and_remedy(self):
        plan = octotomy.Plan({"ct": self.head})
        plan.window("skull", scan="ct", low=300)
        plan.combine("x", expression="skul")
        with self.assertRaisesRegex(octotomy.InputError, r"'x'.*skul"):
            plan.run()
        with self.assertRaisesRegex(octotomy.InputError, "nowhere.nrrd"):
            le_fort_i("nowhere.nrrd", 1.0).run()
        with self.assertRaises(TypeError):
            plan.window("other", scan="ct", low=300, colour="red")

    def test_a_number_that_is_not_finite_is_refused_by_its_step_and_key(self):
        for value in (np.nan, float("inf"), -np.inf):
            plan = octotomy.Plan({"ct": self.head})
            plan.window("skull", scan="ct", low=300)
            plan.move("moved", object="skull", translate_mm=[0, 0, 1], rotate={"degrees": value, "axis": [1, 0, 0]})
            with self.assertRaisesRegex(octotomy.InputError, "^step 'moved', rotate, degrees: must be a finite"):
                plan.run()
            with self.assertRaisesRegex(octotomy.InputError, "step 'moved'"):
                plan.write(self.folder / "infinite.plan.json")
            self.assertFalse((self.folder / "infinite.plan.json").exists())
        plan = octotomy.Plan({"ct": self.head})
        plan.move("moved", object="skull", translate_mm=np.array([0, np.nan, 1]))
        with self.assertRaisesRegex(octotomy.InputError, "^step 'moved', translate_mm: must be"):
            str(plan)
        with self.assertRaisesRegex(octotomy.InputError, "^universe, voxel_mm: must be"):
            str(octotomy.Plan({"ct": self.head}, voxel_mm=np.inf))

    def test_progress_is_told_and_its_error_comes_through(self):
        told = []
        le_fort_i(self.head, 4.0).run(certify=False, progress=lambda doing, fraction: told.append((doing, fraction)))
        self.assertTrue(told)
        self.assertEqual(sorted(fraction for _, fraction in told), [fraction for _, fraction in told])

        def refuse(doing, fraction):
            raise RuntimeError("not now")

        with self.assertRaisesRegex(RuntimeError, "not now"):
            le_fort_i(self.head, 4.0).run(progress=refuse)

    def test_other_threads_run_meanwhile(self):
        counted = [0]
        done = threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1

        counter = threading.Thread(target=count)
        before_end = []
        counter.start()
        le_fort_i(self.head, 4.0).run(certify=False, progress=lambda *_: before_end.append(counted[0]))
        done.set()
        counter.join()
        self.assertGreater(before_end[-1], before_end[0])

    def test_an_interrupt_stops_the_work(self):
        def interrupt(doing, fraction):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            le_fort_i(self.head, 1.0).run(progress=interrupt)


if __name__ == "__main__":
    unittest.main()
