# SPDX-License-Identifier: AGPL-3.0-or-later
"""A mistake in the program is reported as one, with the step's name, whichever way the program is used."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "browser/server"))
from window import Server, Window  # noqa: E402

try:
    import octotomy
except ImportError:  # built without pybind11
    octotomy = None

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
INTERNAL = 70
WINDOW = {"id": "ball", "do": "window", "scan": "ct", "low": 0}


def run(*arguments, cwd=None):
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False)


class Faulty(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = Path(place.name)
        made = run("phantom", "sphere", "--voxels", 16, "--radius", 5, "-o", "ball.octree", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        # One mesh and one scan of a ball.
        samples = bytearray()
        for z in range(16):
            for y in range(16):
                for x in range(16):
                    d = ((x - 7.5) ** 2 + (y - 7.5) ** 2 + (z - 7.5) ** 2) ** 0.5
                    samples += int(max(-1000, min(1000, (5 - d) * 1000))).to_bytes(2, "little", signed=True)
        head = ("NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 16 16 16\n"
                "space directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\nendian: little\n"
                "encoding: raw\nspace origin: (0,0,0)\n\n")
        (self.folder / "ball.nrrd").write_bytes(head.encode() + samples)

    def plan(self, **broken):
        steps = [WINDOW, {"id": "broken", "do": "fail", "object": "ball", **broken}]
        path = self.folder / "broken.plan.json"
        path.write_text(json.dumps({"octotomy_plan": 1, "name": "broken", "scans": {"ct": {"path": "ball.nrrd"}},
                                    "universe": {"voxel_mm": 1.0}, "steps": steps}), encoding="utf-8")
        return path

    def assert_reported(self, text, *names):
        for name in ("a mistake in the program", "please report it", *names):
            self.assertIn(name, text)

    def test_the_program_ends_with_status_70_and_the_steps_name(self):
        for part in ("check", "voxel", "mesh", "bound"):
            with self.subTest(part=part):
                ended = run("run", self.plan(**{"in": part}), "-o", self.folder / "out")
                self.assertEqual(ended.returncode, INTERNAL, ended.stderr)
                self.assert_reported(ended.stderr, "run", "step 'broken'", f"the test broke '{part}'")
                self.assertFalse((self.folder / "out").exists())
        for by, said in (("map", "map::at"), ("length", "vector::reserve"), ("precondition", "the test broke 'mesh'")):
            with self.subTest(by=by):
                ended = run("run", self.plan(**{"in": "mesh", "by": by}), "-o", self.folder / "out")
                self.assertEqual(ended.returncode, INTERNAL, ended.stderr)
                self.assert_reported(ended.stderr, "step 'broken'", said)

    def test_what_a_kernel_refuses_is_bad_input_and_no_mistake(self):
        for part in ("check", "voxel", "mesh", "bound"):
            for by in ("input", "too_large"):
                with self.subTest(part=part, by=by):
                    ended = run("run", self.plan(**{"in": part, "by": by}), "-o", self.folder / "out")
                    self.assertEqual(ended.returncode, 2, ended.stderr)
                    self.assertIn(f"the test refused '{part}'", ended.stderr)
                    if part != "check":  # an operation's check() names the place itself
                        self.assertIn("step 'broken': ", ended.stderr)
                    self.assertNotIn("please report it", ended.stderr)

    def test_a_verb_names_itself(self):
        made = run("mesh", "ball.octree", "-o", "ball.stl", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        for by in ("logic_error", "precondition"):
            ended = run("fail", "ball.stl", "--in", "mesh", "--by", by, "-o", "broken.stl", cwd=self.folder)
            self.assertEqual(ended.returncode, INTERNAL, ended.stderr)
            self.assert_reported(ended.stderr, "fail, ", "the test broke 'mesh'")
            self.assertFalse((self.folder / "broken.stl").exists())

    def test_a_full_disk_in_a_step_is_no_mistake_and_no_bad_input(self):
        ended = run("run", self.plan(**{"in": "voxel", "by": "full_disk"}), "-o", self.folder / "out")
        self.assertEqual(ended.returncode, 3, ended.stderr)
        self.assertIn("step 'broken': ", ended.stderr)
        self.assertIn("make room on the disk", ended.stderr)

    def test_a_cohort_keeps_the_reason_and_ends_with_status_70(self):
        subject = self.folder / "in" / "sub-1"
        subject.mkdir(parents=True)
        (self.folder / "ball.nrrd").rename(subject / "ct.nrrd")
        for by in ("precondition", "logic_error"):
            ended = run("cohort", self.folder / "in", self.folder / "out", "participant", "--plan",
                        self.plan(**{"in": "voxel", "by": by}), "--again", "--json", "--participant-label", "1")
            self.assertEqual(ended.returncode, INTERNAL, ended.stderr)
            said = json.loads(ended.stdout)["subjects"][0]
            self.assertEqual((said["state"], said["fault"]), ("failed", "internal"))
            self.assert_reported(said["reason"], "step 'broken'")
        kept = json.loads((self.folder / "out/sub-1/subject.json").read_text(encoding="utf-8"))
        self.assertEqual(kept["fault"], "internal")
        self.assert_reported(kept["reason"], "step 'broken'")

    def test_the_servers_page_is_told_of_the_step(self):
        for by in ("logic_error", "precondition"):
            server = Server(PROGRAM, self.folder, self.plan(**{"in": "voxel", "by": by}))
            self.addCleanup(server.kill)
            window = Window(server)
            self.addCleanup(window.close)
            said = json.dumps(window.ask("evaluate"))
            self.assert_reported(said, "the test broke 'voxel'")

    @unittest.skipIf(octotomy is None, "the Python package is not built")
    def test_python_has_an_exception_of_its_own(self):
        for part in ("check", "voxel", "mesh"):
            plan = octotomy.Plan.read(self.plan(**{"in": part}))
            with self.assertRaisesRegex(octotomy.InternalError, f"step 'broken': the test broke '{part}'; please report"):
                plan.run()
        with self.assertRaisesRegex(octotomy.InternalError, "step 'broken': the test broke 'voxel'; please report"):
            octotomy.Plan.read(self.plan(**{"in": "voxel", "by": "precondition"})).run()
        with self.assertRaisesRegex(octotomy.InputError, "step 'broken': the test refused 'voxel'"):
            octotomy.Plan.read(self.plan(**{"in": "voxel", "by": "input"})).run()
        with self.assertRaisesRegex(octotomy.ResourceError, "step 'broken': .*make room on the disk"):
            octotomy.Plan.read(self.plan(**{"in": "voxel", "by": "full_disk"})).run()
        self.assertFalse(issubclass(octotomy.InternalError, ValueError))


if __name__ == "__main__":
    unittest.main()
