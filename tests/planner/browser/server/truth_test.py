# SPDX-License-Identifier: AGPL-3.0-or-later
"""What the server of the planner shows of a plan: whole objects, their findings, what is tried, and in which order it answers."""
import json
import pathlib
import struct
import unittest
import zlib

import server_test
from server_test import BOX, MOVED, PIECE, REST


def rgb_of(png):
    """The bytes of a PNG of 8-bit red, green and blue that is not interlaced."""
    at, packed, width = 8, b"", 0
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + length]
        width = struct.unpack(">I", body[:4])[0] if kind == b"IHDR" else width
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    lines, row, made, before = zlib.decompress(packed), 3 * width, bytearray(), bytes(3 * width)
    for start in range(0, len(lines), row + 1):
        line = bytearray(lines[start + 1:start + 1 + row])
        for i in range(row):
            left, above, corner = (line[i - 3], before[i], before[i - 3]) if i >= 3 else (0, before[i], 0)
            near = min((left, above, corner), key=lambda each: abs(left + above - corner - each))
            line[i] = line[i] + (0, left, above, (left + above) // 2, near)[lines[start]] & 255
        made += line
        before = line
    return made


class Truth(server_test.Served):
    def plan_of(self, *steps):
        self.window.ask("edit", what="steps", steps=[{"id": "bone", "do": "window", "scan": "ct", "low": 300}, BOX, PIECE,
                                                     REST, *steps])
        answer = self.window.ask("evaluate")
        return {each["id"]: each for each in answer["objects"]}

    def test_what_leaves_the_universe_is_whole_or_its_finding_says_what_is_lost(self):
        far = {"id": "far", "do": "move", "object": "piece", "by": {"forward_mm": 60}}
        image = {"id": "image", "do": "mirror", "object": "piece", "point_mm": [60, 0, 0], "normal": [1, 0, 0]}
        made = self.plan_of(far, image, {"id": "all", "do": "combine", "expression": "rest | far"})
        whole = made["piece"]["volume"]["value"]
        for name, wanted in (("far", whole), ("image", whole), ("all", made["rest"]["volume"]["value"] + whole)):
            self.assertAlmostEqual(made[name]["volume"]["value"], wanted, delta=0.15 * whole, msg=name)
        for name in ("far", "image", "all"):
            self.assertEqual(made[name]["findings"], [], name)
        lost = self.plan_of({**far, "by": {"forward_mm": 10000}})["far"]
        self.assertIn("out of the universe", lost["error"])
        painted = self.plan_of({"id": "far", "do": "brush", "object": "bone", "mode": "paint", "strokes": [
            {"points_mm": [[0, -120, 0], [0, -140, 0]], "radius_mm": 20}]})["far"]
        self.assertTrue(any("reaches the border of the universe" in each for each in painted["findings"]),
                        painted["findings"])
        # A preview is made at every picture, in the universe as it is: its header says what it loses.
        header, _ = self.rest(kind="view", view="anterior", objects=[{"id": "rest", "colour": "#ffffff", "opacity": 1}],
                              preview={"object": "piece", "of": "piece", "move": {"by": {"forward_mm": 60}}, "against": []})
        self.assertIn("lie outside of the universe", " ".join(header["preview"]["findings"]))

    def test_a_certified_measurement_stays_one_until_its_object_changes(self):
        for step in (BOX, PIECE, {"id": "size", "do": "measure", "object": "piece"}):
            self.window.ask("edit", add={"step": step}, what=step["id"])

        def size(**how):
            return next(each for each in self.window.ask("evaluate", **how)["measurements"] if each["id"] == "size")

        steps = ["bone", "piece", "size"]
        quick, certified = size(objects=steps), size(certify=True)
        self.assertNotEqual(quick["value"], certified["value"], "voxels alone, and both kernels")
        self.window.ask("edit", add={"step": {"id": "other", "do": "smooth", "object": "bone"}})
        self.assertEqual(size(objects=steps), certified)
        plan = self.window.ask("hello")["plan_state"]["plan"]
        bone = {**next(step for step in plan["steps"] if step["id"] == "bone"), "low": 350}
        self.window.ask("edit", replace={"id": "bone", "step": bone})
        changed = size(objects=steps)
        self.assertNotEqual(changed["value"], quick["value"])
        self.assertNotEqual(changed, certified)

    def test_a_motion_widens_no_interval(self):
        self.plan_of({**MOVED, "by": {"forward_mm": 30}})
        made = {each["id"]: each for each in self.window.ask("evaluate", certify=True)["objects"]}
        made = {each["id"]: each for each in self.window.ask("hello")["plan_state"]["objects"]}
        still, moved = made["piece"]["volume"], made["moved"]["volume"]
        self.assertLess(still["half_width"], still["value"])
        self.assertLess(moved["half_width"], 1.5 * still["half_width"])

    def test_every_step_that_makes_an_object_is_listed_drawn_and_exported(self):
        made = self.plan_of({"id": "near", "do": "advance", "object": "piece", "against": "rest", "towards": "up"},
                            {"id": "apart", "do": "separate", "object": "rest", "piece": 1},
                            {"id": "margin", "do": "shell", "object": "piece", "thickness_mm": 4})
        for name in ("near", "apart", "margin"):
            self.assertIsNone(made[name].get("error"), made[name])
            self.assertGreater(made[name]["volume"]["value"], 0)
            header, _ = self.rest(kind="view", view="anterior", objects=[{"id": name, "colour": "#ffffff", "opacity": 1}])
            self.assertEqual(header["objects"], [name])
        told = self.window.ask("export", object="near", kind="stl", path="near.stl")
        self.assertGreater(pathlib.Path(told["path"]).stat().st_size, 84)

    def test_what_is_tried_is_drawn_in_views_and_slices_and_is_not_in_the_plan(self):
        self.plan_of()
        grown = {"id": "region", "do": "segment", "scan": "ct", "seeds_mm": [[0, -75, -10]], "tolerance": 60}
        view, _ = self.rest(kind="view", view="anterior", objects=[], preview={"object": "", "steps": [grown]})
        at_mm = {"at_mm": [0, -75, -10], "centre_mm": [0, 0, -10], "pixel_mm": 1}
        bare, bare_parts = self.rest(kind="slice", plane="axial", objects=[], **at_mm)
        cut, parts = self.rest(kind="slice", plane="axial", objects=[], preview={"object": "", "steps": [grown]}, **at_mm)
        self.assertGreater(view["preview"]["voxels"], 1)
        self.assertEqual(view["preview"], cut["preview"])
        self.assertNotIn("preview", bare)
        self.assertNotEqual(bare_parts["png"], parts["png"])
        with self.assertRaisesRegex(RuntimeError, "lies outside the scan"):
            self.rest(kind="view", view="anterior", objects=[],
                      preview={"object": "", "steps": [{**grown, "seeds_mm": [[999, 0, 0]]}]})
        self.assertNotIn("region", [each["id"] for each in self.window.ask("hello")["plan_state"]["plan"]["steps"]])

    def test_what_follows_a_hand_is_made_in_coarse_voxels_where_the_plans_are_many(self):
        (self.folder / "fine.plan.json").write_text(json.dumps({
            "octotomy_plan": 1, "name": "fine", "scans": {"ct": {"path": "head.nrrd"}}, "universe": {"voxel_mm": 0.5},
            "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 300}]}), encoding="utf-8")
        self.window.ask("open", path="fine.plan.json")
        try:
            self.assertEqual(self.window.ask("hello")["plan_state"]["universe"]["voxels"], 512)
            grown = {"id": "region", "do": "segment", "scan": "ct", "seeds_mm": [[0, 20, 40]], "tolerance": 60}
            said = {"kind": "view", "view": "anterior", "size": [200, 150], "pane": 0, "objects": []}
            coarse, _ = self.window.ask("pane", dragging=True, preview={"object": "", "steps": [grown], "coarse": True}, **said)
            fine, _ = self.window.ask("pane", dragging=False, preview={"object": "", "steps": [grown]}, **said)
            self.assertLess(4 * coarse["preview"]["voxels"], fine["preview"]["voxels"])
            self.assertAlmostEqual(coarse["preview"]["mm3"], fine["preview"]["mm3"], delta=0.15 * fine["preview"]["mm3"])
            self.assertIn("", coarse["objects"])
        finally:
            self.window.ask("open", path="head.nrrd")

    def test_an_undo_waits_for_no_work_before_it(self):
        self.plan_of(MOVED)
        long = [self.window.post("evaluate", certify=True) for _ in range(20)]
        undone = self.window.post("undo")
        answered = []
        while undone not in answered:
            message = self.window.receive()
            if not isinstance(message, tuple) and "id" in message:
                answered.append(message["id"])
        self.assertNotIn(long[-1], answered)
        self.window.ask("cancel", target=long[-1])

    def test_a_stereo_picture_has_the_left_eye_in_red_and_the_right_one_in_cyan(self):
        self.plan_of()
        bone = [{"id": "bone", "colour": "#e0a060", "opacity": 1}]
        where = {"kind": "view", "objects": bone, "centre_mm": [0, -60, -20], "pixel_mm": 0.8}
        header, parts = self.rest(view="anterior", stereo_deg=6, **where)
        middle, of_middle = self.rest(view="anterior", **where)
        stereo = rgb_of(parts["png"])

        def grey(azimuth):
            rgb = rgb_of(self.rest(view={"azimuth": azimuth, "elevation": 0}, **where)[1]["png"])
            return [(77 * rgb[i] + 150 * rgb[i + 1] + 29 * rgb[i + 2] + 128) >> 8 for i in range(0, len(rgb), 3)]

        left, right = grey(-3), grey(3)
        self.assertNotEqual(left, right)
        self.assertEqual(stereo[1::3], stereo[2::3])
        for eye, channel in ((left, stereo[::3]), (right, stereo[1::3])):
            off = sum(abs(a - b) > 2 for a, b in zip(eye, channel))
            self.assertLess(off, 0.002 * len(eye))
        # The pointer picks in the view between the eyes.
        self.assertEqual(parts["depth"], of_middle["depth"])
        self.assertEqual(header["view_frame"], middle["view_frame"])
        moving, _ = self.window.ask("pane", pane=0, size=[300, 200], dragging=True, stereo_deg=6, view="left", **where)
        self.assertEqual(moving["quality"], "moving")
        for wrong in ({"stereo_deg": 90}, {"stereo_deg": "x"}, {"stereo_deg": 6, "shading": "mip"}):
            with self.assertRaisesRegex(RuntimeError, "stereo_deg"):
                self.rest(view="left", **where, **wrong)

    def test_a_radiograph_holds_up_no_other_pane(self):
        self.plan_of()
        bone = [{"id": "bone", "colour": "#ffffff", "opacity": 1}]
        slow = self.window.post("pane", pane=1, kind="view", view="left", shading="radiograph", size=[2000, 1600],
                                dragging=False, objects=bone)
        quick = [self.window.post("pane", pane=pane, kind="slice", plane=plane, size=[200, 150], dragging=False, objects=[])
                 for pane, plane in ((2, "axial"), (3, "coronal"))]
        came = []
        while slow not in came:
            message = self.window.receive()
            if isinstance(message, tuple):
                came.append(message[0]["id"])
        self.assertEqual(sorted(came[:2]), quick)
        moving, _ = self.window.ask("pane", pane=1, kind="view", view="left", shading="radiograph", size=[800, 600],
                                    dragging=True, objects=bone)
        self.assertEqual(moving["quality"], "moving")
        self.assertLessEqual(moving["width"], 800)


if __name__ == "__main__":
    unittest.main()
