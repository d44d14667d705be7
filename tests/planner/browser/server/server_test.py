# SPDX-License-Identifier: AGPL-3.0-or-later
"""The server of the planner, spoken with over its own wire."""
import base64
import hashlib
import json
import math
import os
import pathlib
import posixpath
import random
import re
import resource
import shutil
import socket
import struct
import subprocess
import tempfile
import time
import unittest
import zlib

from window import Server, Window

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]

BOX = {"id": "cut", "do": "mask", "regions": [
    {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]},
    {"view": "left", "polygons_mm": [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]]}]}
PIECE = {"id": "piece", "do": "combine", "expression": "bone & cut"}
REST = {"id": "rest", "do": "combine", "expression": "bone - cut"}
MOVED = {"id": "moved", "do": "move", "object": "piece", "by": {"forward_mm": 6.0}}


def octotomy(folder, *arguments):
    made = subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False)
    if made.returncode:
        raise RuntimeError(made.stderr)
    return made.stdout


class Served(unittest.TestCase):
    """One server, whose session holds the head phantom."""

    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.kept.name).resolve()
        octotomy(cls.folder, "phantom", "head", "-o", "head.nrrd", "--voxel", "2")
        cls.server = Server(PROGRAM, cls.folder, "head.nrrd")

    @classmethod
    def tearDownClass(cls):
        cls.server.kill()
        cls.kept.cleanup()

    def setUp(self):
        self.window = Window(self.server)
        self.assertEqual(self.window.status, 101)
        self.window.ask("go_to", where="1")
        self.window.ask("evaluate")

    def tearDown(self):
        self.window.close()

    def rest(self, **said):
        return self.window.ask("pane", pane=0, size=[300, 200], dragging=False, **said)


class AccessControl(Served):
    def test_a_wrong_token_origin_or_host_is_refused(self):
        where = f"{self.server.host}:{self.server.port}"
        for wrong in ({"token": ""}, {"token": "0" * 32}, {"token": self.server.token[:-1]},
                      {"origin": "http://evil.example"}, {"origin": ""}, {"origin": "null"},
                      {"origin": f"https://{where}"}, {"host": "evil.example", "origin": "http://evil.example"},
                      {"host": f"evil.example:{self.server.port}"}):
            with self.subTest(**wrong):
                window = Window(self.server, **wrong)
                self.assertEqual(window.status, 403)
                window.close()

    def test_the_page_takes_the_token_and_its_files_none(self):
        status, headers, _ = self.server.http(f"/?token={self.server.token}")
        self.assertEqual(status, 200)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertNotIn("unsafe", headers["Content-Security-Policy"])
        self.assertEqual(self.server.http("/")[0], 403)
        self.assertEqual(self.server.http("/", Origin="http://evil.example")[0], 403)
        self.assertEqual(self.server.http("/app.js", Host="evil.example")[0], 403)
        self.assertEqual(self.server.http("/../etc/passwd")[0], 404)
        self.assertEqual(self.server.http("/%zz")[0], 400)

    def test_a_header_that_is_too_long_is_told_its_bound(self):
        with socket.create_connection((self.server.host, self.server.port), timeout=60) as stream:
            stream.sendall(b"GET / HTTP/1.1\r\nX-Long: " + b"x" * 20000 + b"\r\n\r\n")
            answer = b""
            try:
                while part := stream.recv(1 << 16):
                    answer += part
            except ConnectionResetError:
                pass  # as the rest of the header is not read
        self.assertTrue(answer.startswith(b"HTTP/1.1 431 "), answer)
        self.assertIn(b"16 KB", answer)

    def test_no_path_outside_of_the_open_folders(self):
        outside = tempfile.NamedTemporaryFile(suffix=".plan.json", dir="/tmp")
        os.symlink("/etc", self.folder / "link") if not (self.folder / "link").is_symlink() else None
        for path in (outside.name, "/etc/passwd", "../../etc/passwd", "link/passwd", "a\0b", "x" * 9000):
            with self.assertRaisesRegex(RuntimeError, "input: .*no folder that is open", msg=path):
                self.window.ask("open", path=path)
        for folder in ("/", "..", "link"):
            with self.assertRaisesRegex(RuntimeError, "no folder that is open"):
                self.window.ask("list", folder=folder)
        for said in ({"scans": {"ct": {"path": "/etc/passwd"}}}, {"scans": {"ct": {"path": "link/passwd"}}},
                     {"add": {"step": {"id": "read", "do": "import", "path": "/etc/machine-id.stl"}}},
                     {"add": {"step": {"id": "read", "do": "import", "path": "../../../etc/machine-id.stl"}}},
                     {"add": {"step": {"id": "read", "do": "landmarks", "file": "/etc/passwd"}}},
                     {"add": {"step": {"id": "read", "do": "landmarks", "file": "link/passwd"}}}):
            with self.assertRaisesRegex(RuntimeError, "no folder that is open", msg=said):
                self.window.ask("edit", what="reads elsewhere", **said)
        token = self.server.token
        for name in ("../head.nrrd", "..%2f..%2f..%2f..%2fetc/passwd", "%2fetc%2fpasswd"):
            self.assertNotEqual(self.server.http(f"/file/{token}/{name}")[0], 200, name)
        outside.close()

    def test_nothing_is_written_through_a_link_that_leads_out(self):
        origin = {"Origin": f"http://{self.server.host}:{self.server.port}"}
        with tempfile.TemporaryDirectory() as outside:
            (self.folder / "uploads").mkdir(exist_ok=True)
            os.symlink(f"{outside}/new.plan.json", self.folder / "dangling.plan.json")
            os.symlink(outside, self.folder / "uploads/linked")
            os.symlink(f"{outside}/new folder", self.folder / "uploads/dangling")
            with self.assertRaisesRegex(RuntimeError, "input: .*no folder that is open"):
                self.window.ask("save", path="dangling.plan.json")
            for name in ("linked/a.txt", "dangling/a.txt"):
                status, _, body = self.server.http(f"/upload?token={self.server.token}&name={name}", "POST", b"x",
                                                   **origin)
                self.assertEqual(status, 400, name)
                self.assertIn(b"no folder that is open", body)
            self.assertEqual(os.listdir(outside), [])

    def test_an_upload_lands_in_the_working_folder_and_overwrites_nothing(self):
        origin = {"Origin": f"http://{self.server.host}:{self.server.port}"}
        target = f"/upload?token={self.server.token}&name="
        first = self.server.http(target + "a.txt", "POST", b"one", **origin)
        second = self.server.http(target + "a.txt", "POST", b"two", **origin)
        self.assertEqual((first[0], second[0]), (200, 200), first)
        paths = [pathlib.Path(json.loads(answer[2])["path"]) for answer in (first, second)]
        self.assertEqual([path.read_bytes() for path in paths], [b"one", b"two"])
        self.assertEqual(paths[0].parent, self.folder / "uploads")
        for name in ("../a.txt", "/a.txt", ".a", "a/b/c", "", "a/../../b"):
            self.assertEqual(self.server.http(target + name, "POST", b"x", **origin)[0], 400, name)
        self.assertEqual(self.server.http(target + "b.txt", "POST", b"x")[0], 403)
        self.assertEqual(self.server.http("/upload?token=0&name=b", "POST", b"x", **origin)[0], 403)


class Wire(Served):
    def test_ten_thousand_malformed_messages_leave_the_server_alive_and_its_memory_flat(self):
        seeded = random.Random(1)
        good = json.dumps({"id": -5, "do": "pane", "pane": 0, "kind": "view", "size": [64, 64], "view": "left",
                           "objects": [{"id": "bone"}]}).encode()
        words = ["edit", "list", "measure", "procedure", "landmark", "go_to", "overlap", "export", "command", "diff",
                 "shown", "close_pane", "cancel", "certify", "pane", "movement", "evaluate", "save", "open"]
        fields = ["steps", "add", "replace", "remove", "scans", "landmarks", "what", "name", "values", "kind", "points",
                  "object", "objects", "with", "move", "path", "folder", "where", "a", "b", "point", "snap", "step",
                  "pane", "view", "plane", "at_mm", "size", "pixel_mm", "centre_mm", "window", "threshold", "preview",
                  "difference", "overlap", "colour_by", "cut_planes", "cut_face", "shading", "stereo_deg", "background",
                  "dragging", "frame"]
        values = [None, 0, -1, 1e308, 2**63, True, "", "bone", "le_fort_i", "slice", "distance", "axial", "../..", [],
                  [[]], [0, 0, 0], [64, 48], ["bone", "bone"], [{"id": "bone"}], {}, {"id": "bone"}, {"a": None},
                  {"object": "bone", "move": {"translate_mm": [1, 0, 0]}}, {"translate_mm": [1, 0, 0]},
                  {"normal": [0, 0, 0]}, {"normal": [0, 0, 1]}, {"curve_mm": [[0, 0, 0], [9, 0, 0]]},
                  {"window": {"scan": "ct", "low": 300}}, [{"window": {"low": "x"}}]]
        kinds = [
            lambda: seeded.randbytes(seeded.randrange(200)).decode("latin-1").encode(),
            lambda: good[:seeded.randrange(len(good))],
            lambda: b"[" * seeded.randrange(1, 3000),
            lambda: b'{"do":' * 500,
            lambda: json.dumps({"id": seeded.choice([-4, -1, 2**70, "x", None, 1.5]), "do": seeded.choice(
                ["edit", "undo_it", "open", "list", "measure", "procedure", "landmark", "go_to", "branch", "overlap",
                 "export", "command", "diff", "shown", "close_pane", "cancel", "certify", 7, None, {}])}).encode(),
            lambda: json.dumps({"id": -2, "do": "pane", "pane": seeded.choice([0, -1, 99, "x", None]),
                                "kind": seeded.choice(["view", "slice", 5]), "size": seeded.choice(
                                    [[1e9, 1], [0, 0], "x", None, [64], [64, 64]]), "pixel_mm": seeded.choice(
                                        [-1, 0, 1e-300, "x", None]), "objects": seeded.choice(
                                            [5, [5], [{}], [{"id": 5}], [{"id": "none"}]])}).encode(),
            lambda: json.dumps({"id": -6, "do": seeded.choice(words), **{
                field: seeded.choice(values) for field in seeded.sample(fields, seeded.randrange(1, 6))}}).encode(),
            lambda: json.dumps({"id": -3, "do": "edit", "add": seeded.choice(
                [5, {}, {"step": {}}, {"step": {"id": "a b", "do": "window"}}, {"step": 5}, {"after": "x"}]),
                "steps": seeded.choice([5, [], [5], None])}).encode(),
        ]
        self.rest(kind="view", view="left", objects=[{"id": "bone"}])  # loads the library of pictures
        memory = []
        for number in range(15000):
            self.window.send_bytes(seeded.choice(kinds)())
            if number % 100 == 99:
                self.assertIn("version", self.window.ask("hello"))
            if number == 9999 or number == 14999:
                memory.append(self.server.resident_mb())
        self.assertIsNone(self.server.process.poll())
        self.assertLess(memory[1] - memory[0], 20, memory)  # the allocator's own is there by then
        self.window.ask("go_to", where="1")
        self.assertEqual(len(self.window.ask("hello")["plan_state"]["plan"]["steps"]), 1)

    def test_oversized_messages_and_broken_frames_end_their_connection_only(self):
        before = self.server.resident_mb()
        for number in range(40):
            other = Window(self.server)
            try:
                if number % 2:
                    other.send_bytes(b" " * (5 << 20))
                else:
                    other.stream.sendall(os.urandom(3000))
                while True:
                    other.receive()
            except (ConnectionError, OSError):
                pass
            other.close()
        self.assertIn("version", self.window.ask("hello"))
        self.assertLess(self.server.resident_mb() - before, 60)

    def test_a_refusal_is_one_short_line(self):
        most = "x" * 300000
        for do, said in (("command", {"step": most}), ("command", {"step": "a\nb\x1b[31m"}), ("go_to", {"where": most}),
                         ("open", {"path": "x\n" * 100}), ("list", {"folder": "\u00e9" * 3000}),
                         ("landmark", {"name": most, "point": [1, 2, 3]}),
                         ("landmark", {"name": "a\x1b[31m", "point": [1, 2, 3]}),
                         ("export", {"object": "bone", "path": "a\nb.stl"}), ("a" + "\u00e9" * 40, {}), (most, {})):
            with self.subTest(do=do[:20], said=str(said)[:60]):
                with self.assertRaises(RuntimeError) as caught:
                    self.window.ask(do, **said)
                told = str(caught.exception)
                self.assertLess(len(told.encode()), 1100)
                self.assertTrue(told.isprintable(), told)
                self.assertNotIn("\ufffd", told)  # stands for half a letter

    def test_pictures_that_no_screen_shows_are_refused(self):
        for size in ([2**32 + 1, 2**32 + 1], [2**63, 1], [2**64 - 1, 1], [4097, 1], [1, 0], [1.5, 2]):
            with self.assertRaisesRegex(RuntimeError, "input: size: must be", msg=size):
                self.window.ask("pane", pane=0, size=size, dragging=False, objects=[])
        for end in ([1e308, 0, 0], [-1e200, 1e200, 0], [9000, 0, 0]):
            with self.assertRaisesRegex(RuntimeError, "input: a picture of .* takes more than 8192 pixels", msg=end):
                self.rest(kind="slice", pixel_mm=1, plane={"curve_mm": [[0, 0, 0], end]})
        header, _ = self.rest(kind="slice", pixel_mm=1, plane={"curve_mm": [[0, 0, 0], [8192, 0, 0]], "height_mm": 2})
        self.assertEqual(header["width"], 8192)

    def endings(self, *numbers):
        """How requests ended, by their numbers: "drawn", "ok" or an error's code."""
        ended = {}
        while len(ended) < len(numbers):
            message = self.window.receive()
            if isinstance(message, tuple):
                ended[message[0]["id"]] = "drawn"
            elif message.get("id") in numbers:
                ended[message["id"]] = message["error"]["code"] if "error" in message else "ok"
        return ended

    def test_a_picture_that_nobody_wants_any_more_is_stopped(self):
        large = {"pane": 0, "size": [4096, 4096], "dragging": False, "shading": "composite",
                 "objects": [{"id": "bone"}]}
        small = {**large, "size": [64, 64]}
        for do, said in (("cancel", {}), ("close_pane", {"pane": 0}), ("pane", small)):
            with self.subTest(do=do):
                drawn = self.window.post("pane", **large)
                time.sleep(0.5)  # so that it is drawn; it takes seconds
                other = self.window.post(do, **({"target": drawn} if do == "cancel" else said))
                self.assertEqual(self.endings(drawn, other),
                                 {drawn: "cancelled", other: "drawn" if do == "pane" else "ok"})

    def test_a_server_without_free_descriptors_rests_until_there_are(self):
        process = self.server.process.pid

        def descriptors():
            return [int(name) for name in os.listdir(f"/proc/{process}/fd")]

        def processor_s():
            with open(f"/proc/{process}/stat", encoding="utf-8") as file:
                fields = file.read().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

        before = resource.prlimit(process, resource.RLIMIT_NOFILE)
        most = max(descriptors()) + 4
        resource.prlimit(process, resource.RLIMIT_NOFILE, (most, before[1]))
        callers = [socket.create_connection((self.server.host, self.server.port)) for _ in range(most + 8)]
        try:
            self.assertIn("version", self.window.ask("hello"))
            while len(descriptors()) < most:
                time.sleep(0.01)
            spent = processor_s()
            time.sleep(1.0)
            self.assertLess(processor_s() - spent, 0.2)
        finally:
            for caller in callers:
                caller.close()
            resource.prlimit(process, resource.RLIMIT_NOFILE, before)
        other = Window(self.server)
        self.assertEqual(other.status, 101)
        other.close()

    def test_every_request_is_answered_once_and_the_newest_picture_wins(self):
        said = {"pane": 3, "kind": "view", "size": [200, 150], "objects": [{"id": "bone"}], "dragging": True}
        asked = [self.window.post("pane", view={"azimuth": n, "elevation": 0}, **said) for n in range(30)]
        drawn, cancelled = [], []
        while len(drawn) + len(cancelled) < 28 or asked[-1] not in drawn:
            message = self.window.receive()
            if isinstance(message, tuple):
                drawn.append(message[0]["id"])
                self.assertLessEqual({one for one in asked if one < drawn[-1]}, {*drawn, *cancelled})
                self.window.send_bytes(json.dumps({"do": "shown", "pane": 3, "frame": drawn[-1]}).encode())
            elif message.get("id") in asked:
                self.assertEqual(message["error"]["code"], "cancelled")
                cancelled.append(message["id"])
        self.assertEqual(sorted(drawn + cancelled), asked)
        self.assertEqual(drawn, sorted(drawn))

    def test_without_acknowledgement_two_frames_are_in_flight(self):
        said = {"pane": 4, "kind": "view", "size": [64, 64], "objects": [{"id": "bone"}], "view": "left"}
        for _ in range(40):
            for _ in range(2):
                self.window.wait(self.window.post("pane", dragging=True, **said))
            third = self.window.post("pane", dragging=True, **said)
            self.window.ask("hello")
            rest = self.window.post("pane", dragging=False, **said)  # does not wait, and replaces the third
            with self.assertRaisesRegex(RuntimeError, "cancelled"):
                self.window.wait(third)  # passes frames over: the refusal must come before the picture
            self.assertEqual(self.window.wait(rest)[0]["quality"], "rest")
            self.window.send_bytes(json.dumps({"do": "shown", "pane": 4, "frame": rest}).encode())


class Session(Served):
    def test_edits_undo_redo_and_branches_reach_every_window(self):
        other = Window(self.server)
        state = self.window.ask("edit", add={"step": BOX}, what="draw the cut")
        self.assertEqual([step["id"] for step in state["plan"]["steps"]], ["bone", "cut"])
        self.assertEqual(state["history"][-1]["what"], "draw the cut")
        other.ask("hello")
        told = [event for event in other.events if event["event"] == "plan"]
        self.assertEqual(told[-1]["plan_state"]["edit"], state["edit"])
        other.close()
        undone = self.window.ask("undo")
        self.assertEqual((len(undone["plan"]["steps"]), undone["can_redo"]), (1, True))
        self.assertEqual(len(self.window.ask("redo")["plan"]["steps"]), 2)
        name = f"branch_{state['edit']}"
        self.assertEqual(self.window.ask("branch", name=name)["branch"], name)
        rows = self.window.ask("diff", a=1, b=state["edit"])
        self.assertEqual(rows["added"], ["cut"])
        with self.assertRaisesRegex(RuntimeError, "input: .*'nothing'"):
            self.window.ask("edit", add={"step": {"id": "x", "do": "combine", "expression": "nothing"}})

    def test_objects_are_measured_moved_and_certified(self):
        for step in (BOX, PIECE, REST, MOVED):
            self.window.ask("edit", add={"step": step}, what=step["id"])
        made = {entry["id"]: entry for entry in self.window.ask("evaluate")["objects"]}
        self.assertTrue(made["moved"]["evaluated"])
        # As a window asks that an undo overtakes.
        made = {entry["id"]: entry for entry in self.window.ask("evaluate", objects=["gone", "moved"])["objects"]}
        self.assertTrue(made["moved"]["evaluated"])
        with self.assertRaisesRegex(RuntimeError, "no step called 'gone'"):
            self.window.ask("certify", object="gone")
        overlap = self.window.ask("overlap", object="piece", move={"by": {"up_mm": 6.0}},
                                  **{"with": ["rest"]})
        self.assertGreater(overlap["mm3"], 100.0)
        rows = self.window.ask("movement", object="moved")["rows"]
        self.assertIn("forward 6.0 mm", rows[0]["words"])
        certificate = self.window.ask("certify", object="moved")
        self.assertEqual(certificate["verdict"], "PASS", certificate["sentence"])
        state = self.window.ask("hello")["plan_state"]
        known = {entry["id"]: entry for entry in state["objects"]}
        self.assertEqual(known["moved"]["certificate"]["verdict"], "PASS")
        self.assertGreater(known["moved"]["volume"]["half_width"], 0)
        exported = self.window.ask("export", object="moved", path="moved.stl")
        status, _, body = self.server.http(f"/file/{self.server.token}/{exported['file']}")
        self.assertEqual((status, body), (200, pathlib.Path(exported["path"]).read_bytes()))
        told = self.window.ask("command", step="moved")
        self.assertIn('plan.move("moved", object="piece", by={"forward_mm": 6.0})', told["python"])

    def test_the_difference_to_another_object_follows_a_dragged_piece(self):
        for step in (BOX, PIECE, REST):
            self.window.ask("edit", add={"step": step}, what=step["id"])
        whole = {entry["id"]: entry["volume"]["value"] for entry in self.window.ask("evaluate")["objects"]
                 if entry.get("volume")}
        drawn = []
        for up_mm in (2.0, 4.0):
            preview = {"object": "piece", "of": "piece", "move": {"by": {"up_mm": up_mm}}, "against": ["rest"],
                       "difference": "rest"}
            said = {"objects": [{"id": "rest"}, {"id": "piece"}], "preview": preview}
            header, _ = self.rest(kind="view", view="left", **said)
            self.assertEqual(header["objects"], ["piece", "rest", "piece"])
            self.assertNotIn("overlap_mm3", header)
            parts = header["difference"]
            self.assertEqual(parts["to"], "rest")
            self.assertGreater(parts["common_mm3"], 100.0)
            self.assertAlmostEqual(parts["only_other_mm3"] + parts["common_mm3"], whole["rest"], delta=1e-6)
            # A motion by whole voxels keeps their count. Once the piece is certified, its value is not the voxels' alone.
            self.assertEqual(parts["only_moved_mm3"] + parts["common_mm3"], 55152.0)
            self.assertAlmostEqual(55152.0, whole["piece"], delta=0.04 * whole["piece"])
            drawn.append(parts["only_moved_mm3"])
            sliced, _ = self.rest(kind="slice", plane="sagittal", at_mm=[0, -50, -40], **said)
            self.assertEqual(sliced["difference"], parts)
        self.assertNotEqual(*drawn)
        with self.assertRaisesRegex(RuntimeError, "nothing"):
            self.rest(kind="view", view="left", objects=[],
                      preview={"object": "piece", "move": {"by": {}}, "difference": "nothing"})

    def test_a_meshs_own_statements_are_told_before_it_is_used(self):
        (self.folder / "block.obj").write_text("# SPACE=RAS\nv 0 0 0\nv 0.03 0 0\nv 0 0.03 0\nv 0 0 0.03\n"
                                               "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        rows = {row["check"]: row for row in self.window.ask("mesh_audit", path="block.obj")["audit"]}
        self.assertEqual(rows["frame"]["verdict"], "PASS")
        self.assertIn("RAS", rows["frame"]["sentence"])
        self.assertEqual(rows["unit"]["verdict"], "WARN")
        self.assertEqual(rows["scale"]["verdict"], "WARN")
        self.assertIn("--unit m", rows["scale"]["sentence"])
        rows = {row["check"]: row for row in
                self.window.ask("mesh_audit", path="block.obj", frame="LPS", unit="m")["audit"]}
        self.assertNotIn("scale", rows)
        for said, why in (({"path": "block.obj", "unit": "ell"}, "unit"), ({"path": "/etc/hostname.stl"}, "folder"),
                          ({"path": "none.stl"}, "none.stl")):
            with self.assertRaisesRegex(RuntimeError, why):
                self.window.ask("mesh_audit", **said)

    def test_a_procedure_is_placed_by_its_landmarks_and_keeps_others(self):
        marks = {"piriform_left": [12, -84, -25], "piriform_right": [-12, -84, -25], "buttress_left": [30, -68, -28],
                 "buttress_right": [-30, -68, -28], "pterygoid_left": [20, -39, -30],
                 "pterygoid_right": [-20, -39, -30], "incisor": [0, -85, -57.5], "molar_left": [27, -52, -57.5],
                 "molar_right": [-27, -52, -57.5]}
        self.window.ask("landmark", name="mine", point=[0, 0, 0])
        state = self.window.ask("procedure", name="le_fort_i", landmarks=marks, values={"forward_mm": 5})
        self.assertEqual({mark["name"] for mark in state["landmarks"]}, {"mine", *marks})
        self.assertIn("bone", [step["id"] for step in state["plan"]["steps"]])
        objects = {entry["id"] for entry in state["objects"]}
        self.assertEqual(set(state["made"]), objects - {"bone"}, "what the procedure made, and nothing older")
        made = self.window.ask("evaluate")["objects"]
        self.assertTrue(all(entry["evaluated"] for entry in made), made)
        words = " ".join(row["words"] for row in self.window.ask("movement")["rows"])
        self.assertIn("forward 5.0 mm", words)
        with self.assertRaisesRegex(RuntimeError, "input: .*buttress_left"):
            self.window.ask("procedure", name="le_fort_i", landmarks={"incisor": [0, 0, 0]})
        chin = {"foramen_left": [22, -74, -82], "foramen_right": [-22, -74, -82], "border_left": [33, -55, -91],
                "border_right": [-33, -55, -91], "pogonion": [0, -87, -93], "menton": [0, -82, -101]}
        self.assertEqual(self.window.ask("acts_on", name="genioplasty")["outcome"], "planned")
        again = self.window.ask("acts_on", name="le_fort_i")
        self.assertIsNone(again["outcome"], "it replaces its own steps")
        self.assertEqual((again["is_planned"], again["with"]), (True, []))
        self.assertEqual(again["values"]["forward_mm"], {"value": 5, "is_agreed": True})
        self.assertEqual(again["values"]["kerf_mm"], {"value": 1, "is_agreed": True})
        moved = next(step for step in state["plan"]["steps"] if step["id"] == "maxilla_moved")
        moved["by"]["forward_mm"] = 7.5
        self.window.ask("edit", replace={"id": "maxilla_moved", "step": moved})
        self.assertEqual(self.window.ask("acts_on", name="le_fort_i")["values"]["forward_mm"]["value"], 7.5)
        self.assertFalse(self.window.ask("acts_on", name="genioplasty")["is_planned"])
        for forward_mm in (4, 6):  # the second time in place of the first
            state = self.window.ask("procedure", name="genioplasty", landmarks=chin,
                                    values={"forward_mm": forward_mm, "below_foramen_mm": 6, "bone_low": 300})
            steps = {step["id"]: step for step in state["plan"]["steps"]}
            self.assertEqual(len(steps), len(state["plan"]["steps"]))
            self.assertEqual(steps["genioplasty_chin"]["expression"], "planned & genioplasty_below_cut")
            self.assertEqual(steps["genioplasty_chin_moved"]["by"]["forward_mm"], forward_mm)
            self.assertIn("maxilla_moved", steps)
        self.assertTrue(all(entry["evaluated"] for entry in self.window.ask("evaluate")["objects"]))
        again = self.window.ask("acts_on", name="genioplasty")
        self.assertEqual((again["is_planned"], again["with"]), (True, []))
        values = {name: said["value"] for name, said in again["values"].items()}
        self.assertEqual((values["forward_mm"], values["below_foramen_mm"], values["kerf_mm"]), (6, 6, 1))
        self.assertNotIn("bone_low", values, "its bone is the planned skull")
        self.assertTrue(all(said["is_agreed"] for said in again["values"].values()), again["values"])
        state = self.window.ask("procedure", name="genioplasty", landmarks=chin, values={"bone_low": 300}, **{"with": ["guides"]})
        self.assertIn("genioplasty_chin_guide", [step["id"] for step in state["plan"]["steps"]])
        self.assertEqual(self.window.ask("acts_on", name="genioplasty")["with"], ["guides"])
        file = self.folder / "mine.procedure.json"
        file.write_text('{"secret": 1}')
        with self.assertRaisesRegex(RuntimeError, "there is no procedure"):
            self.window.ask("procedure", name=str(file), landmarks=marks)

    def test_the_other_cheek_does_not_replace_the_first(self):
        for side, x in (("left", 1), ("right", -1)):
            marks = {f"lateral_rim_{side}": [51 * x, -66, 13], f"orbital_rim_{side}": [25 * x, -75, -7],
                     f"buttress_{side}": [30 * x, -68, -28], f"zygoma_{side}": [60 * x, -42, -13],
                     f"cheek_{side}": [47 * x, -64, -12], "incisor": [0, -85, -57.5], f"molar_{side}": [27 * x, -52, -57.5]}
            said = next(one for one in self.window.ask("hello")["procedures"] if one["name"] == f"zygoma_{side}")
            marks = {mark["name"]: marks[mark["name"]] for mark in said["landmarks"]}
            state = self.window.ask("procedure", name=f"zygoma_{side}", landmarks=marks, values={"forward_mm": 3})
        steps = [step["id"] for step in state["plan"]["steps"]]
        self.assertIn("zygoma_moved", steps)
        self.assertIn("zygoma_right_zygoma_moved", steps)
        self.assertIsNone(self.window.ask("acts_on", name="zygoma_left")["outcome"])
        self.assertEqual(self.window.ask("acts_on", name="zygoma_right")["outcome"], "planned")

    def test_a_broken_step_is_told_and_the_others_are_there(self):
        lost = {"id": "lost", "do": "window", "scan": "ct", "low": 30000}
        self.window.ask("edit", add={"step": lost})
        self.window.ask("edit", add={"step": {"id": "shell", "do": "shell", "object": "lost", "thickness_mm": 2}})
        self.window.ask("edit", add={"step": BOX})
        made = {entry["id"]: entry for entry in self.window.ask("evaluate")["objects"]}
        self.assertTrue(made["bone"]["evaluated"] and made["cut"]["evaluated"])

    def test_a_distance_is_the_command_lines(self):
        self.window.ask("landmark", name="a", point=[10.5, -20.25, 3.0], snap=False)
        self.window.ask("landmark", name="b", point=[-14.0, 30.0, -9.0], snap=False)
        told = self.window.ask("measure", kind="distance", points=["a", "b"])
        state = self.window.ask("edit", add={"step": {"id": "d", "do": "measure", "points_mm": ["a", "b"]}})
        octotomy(self.folder, "run", pathlib.Path(state["path"]).name, "-o", "measured")
        result = json.loads((self.folder / "measured/result.json").read_text())
        self.assertAlmostEqual(told["value"], result["measurements"][0]["distance_mm"], places=9)

    def test_the_depth_plane_is_where_landmarks_snap(self):
        header, parts = self.rest(kind="view", view="anterior", objects=[{"id": "bone"}])
        frame, (width, height) = header["view_frame"], (header["width"], header["height"])
        depths = struct.unpack(f"<{width * height}f", zlib.decompress(parts["depth"]))
        objects = struct.unpack(f"<{width * height}H", zlib.decompress(parts["object"]))
        column, row = width // 2 + 20, height // 4
        self.assertEqual(objects[row * width + column], 1)
        self.assertEqual((objects[0], math.isnan(depths[0])), (0, True))
        right, up = ((column + 0.5 - width / 2) * frame["pixel_mm"], -(row + 0.5 - height / 2) * frame["pixel_mm"])
        seen = [frame["centre_mm"][0] + right, depths[row * width + column], frame["centre_mm"][2] + up]
        before = [seen[0], seen[1] - 4.0, seen[2]]  # in front of the bone
        snapped = self.window.ask("landmark", name="glabella", point=before, snap=True)["point"]
        self.assertGreater(math.dist(snapped, before), 0.5)
        self.assertLess(math.dist(snapped, before), 4.0 + 2.0)  # a voxel's edge further than what is seen

    def test_the_picture_at_rest_is_that_of_render_and_slice(self):
        for view in ("anterior", "left", {"azimuth": 35.5, "elevation": 15}):
            header, parts = self.rest(kind="view", view=view, objects=[{"id": "bone", "colour": "#cc7a29"}],
                                      pixel_mm=0.9, centre_mm=[5, 0, -10])
            subprocess.run(header["command"].replace("octotomy", PROGRAM, 1), shell=True, cwd=self.folder, check=True,
                           capture_output=True)
            self.assertEqual(parts["png"], (self.folder / "view.png").read_bytes(), view)
        for step in (BOX, PIECE, REST):
            self.window.ask("edit", add={"step": step})
        self.window.ask("evaluate")
        steps, pngs = [], []
        for number, view in enumerate(("anterior", {"azimuth": -20, "elevation": 40})):
            header, parts = self.rest(kind="view", view=view, objects=[
                {"id": "rest"}, {"id": "piece", "colour": "#0072b2", "opacity": 0.5}])
            steps.append({**header["step"], "id": f"view{number}", "path": f"view{number}.png"})
            pngs.append(parts["png"])
        for number, plane in enumerate(("axial", "coronal", "sagittal", {"normal": [1, 2, 0.5]})):
            header, parts = self.rest(kind="slice", plane=plane, at_mm=[3, -40, -42], pixel_mm=0.8,
                                      window=[300, 1500], objects=[{"id": "piece", "colour": "#d55e00"}])
            steps.append({**header["step"], "id": f"slice{number}", "path": f"slice{number}.png"})
            pngs.append(parts["png"])
        state = self.window.ask("hello")["plan_state"]
        plan = state["plan"] | {"steps": state["plan"]["steps"] + steps}
        (self.folder / "drawn.plan.json").write_text(json.dumps(plan))
        octotomy(self.folder, "run", "drawn.plan.json", "-o", "drawn")
        for step, png in zip(steps, pngs):
            self.assertEqual((self.folder / "drawn" / step["path"]).read_bytes(), png, step["id"])


class Begun(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name).resolve()
        octotomy(self.folder, "phantom", "head", "-o", "head.nrrd", "--voxel", "8")

    def test_what_is_refused_has_written_nothing(self):
        shutil.copy(self.folder / "head.nrrd", self.folder / "other.nrrd")
        (self.folder / "token").write_text("0" * 32)
        (self.folder / "token").chmod(0o644)
        before = sorted(os.listdir(self.folder))
        with socket.create_server(("127.0.0.1", 0)) as taken:
            for said, why in ((["--port", taken.getsockname()[1]], "cannot listen there"),
                              (["--listen", "nonsense"], "is not an IP address"),
                              (["--token-file", "token"], "others may read"),
                              (["other.nrrd"], "name at most one plan or scan")):
                with self.subTest(said=said):
                    with self.assertRaisesRegex(RuntimeError, why):
                        octotomy(self.folder, "serve", "head.nrrd", *said)
                    self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_the_end_of_its_time_is_told_and_an_interrupt_is_none(self):
        server = Server(PROGRAM, self.folder, "--time-limit", 3)
        self.assertEqual(server.process.wait(), 3)
        self.assertIn("out of time", server.process.stderr.read())
        server.kill()
        server = Server(PROGRAM, self.folder, "--time-limit", 600)
        server.process.terminate()
        self.assertEqual(server.process.wait(), 0)
        server.kill()

    def begun(self):
        """A server of the phantom, and a window of it."""
        server = Server(PROGRAM, self.folder, "head.nrrd")
        self.addCleanup(server.kill)
        window = Window(server)
        self.addCleanup(window.close)
        return server, window

    def names(self):
        """All files and folders, hidden ones too."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))

    def wait_for_more_than(self, names):
        """Waits until something else is there."""
        end = time.monotonic() + 60
        while self.names() == names:
            self.assertLess(time.monotonic(), end, "nothing is written")
            time.sleep(0.001)

    def test_the_history_is_whole_in_one_file_at_any_time(self):
        server, window = self.begun()
        for number in range(3):
            window.ask("edit", add={"step": {**BOX, "id": f"cut{number}"}}, what=f"cut {number}")
        for name in ("served", "ended"):
            copy = self.folder / name
            copy.mkdir()
            for path in (self.folder / "head.plan.json", self.folder / "head.plan.json.history"):
                shutil.copy(path, copy)
            told = json.loads(octotomy(copy, "plan", "history", "head.plan.json", "--json"))
            self.assertEqual((told["count"], told["edits"][0]["what"]), (4, "cut 2"), name)
            self.assertEqual([path.name for path in self.folder.glob("head.plan.json?*")],
                             ["head.plan.json.history"], name)
            server.process.terminate()
            self.assertEqual(server.process.wait(), 0)

    def test_an_upload_that_the_end_interrupts_leaves_nothing(self):
        server, _ = self.begun()
        before = self.names()
        with socket.create_connection((server.host, server.port), timeout=60) as stream:
            stream.sendall((f"POST /upload?token={server.token}&name=u.nrrd HTTP/1.1\r\n"
                            f"Host: {server.host}:{server.port}\r\nOrigin: http://{server.host}:{server.port}\r\n"
                            "Content-Length: 100000000\r\n\r\n").encode() + b"x" * 5000000)
            self.wait_for_more_than(before)
            server.process.terminate()
            self.assertEqual(server.process.wait(), 0)
        self.assertEqual(self.names(), before)

    def test_an_export_that_the_end_interrupts_leaves_no_empty_folder(self):
        server, window = self.begun()
        before = self.names()
        window.post("export", object="bone")
        self.wait_for_more_than(before)
        server.process.terminate()
        self.assertEqual(server.process.wait(), 0)
        for path in self.folder.rglob("*"):
            self.assertFalse(path.name.startswith(".octotomy-"), path)
            self.assertFalse(path.is_dir() and not os.listdir(path), path)

    def test_a_report_is_written_and_the_next_one_beside_it(self):
        _, window = self.begun()
        for name in ("report", "report-2"):
            folder = pathlib.Path(window.ask("report")["folder"])
            self.assertEqual(folder.name, name)
            self.assertTrue((folder / "report.html").exists())

    def test_the_links_of_a_report_reach_the_files_beside_it(self):
        server, window = self.begun()
        file = window.ask("report")["file"]
        status, headers, body = server.http(f"/file/{server.token}/{file}")
        self.assertEqual(status, 200)
        # The script of the page runs and no other, in a page that reaches nothing of the session.
        script = re.search(r"<script>(.*?)</script>", body.decode(), re.DOTALL).group(1)
        policy = next(value for name, value in dict(headers).items() if name.lower() == "content-security-policy")
        allowed = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        self.assertIn(f"script-src 'sha256-{allowed}'", policy)
        self.assertIn("default-src 'none'", policy)
        self.assertIn("sandbox allow-scripts;", policy)
        data = re.search(r'id="data">(.*?)</script>', body.decode()).group(1)
        linked = ["credibility.html", *(each["path"] for each in json.loads(data)["result"]["exports"] if each["written"])]
        for link in linked:
            self.assertEqual(server.http(f"/file/{server.token}/{posixpath.dirname(file)}/{link}")[0], 200, link)
        for refused in (f"/file/{file}", f"/file/{'0' * 32}/{file}", f"/file/{file}?token={server.token}"):
            self.assertEqual(server.http(refused)[0], 403, refused)

    def test_a_plans_scan_opens_its_folder_neither_for_listing_nor_for_writing(self):
        with tempfile.TemporaryDirectory() as name:
            elsewhere = pathlib.Path(name).resolve()
            shutil.copy(self.folder / "head.nrrd", elsewhere / "far.nrrd")
            (self.folder / "far.plan.json").write_text(json.dumps({
                "octotomy_plan": 1, "name": "far", "scans": {"ct": {"path": str(elsewhere / "far.nrrd")}},
                "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 300}]}))
            server = Server(PROGRAM, self.folder, "far.plan.json")
            self.addCleanup(server.kill)
            window = Window(server)
            self.addCleanup(window.close)
            self.assertEqual(window.ask("hello")["folders"], [str(self.folder)])
            for said in ({"folder": str(elsewhere)}, {"folder": "/etc"}):
                with self.assertRaisesRegex(RuntimeError, "no folder that is open"):
                    window.ask("list", **said)
            with self.assertRaisesRegex(RuntimeError, "no folder that is open"):
                window.ask("save", path=str(elsewhere / "copy.plan.json"))
            self.assertEqual(os.listdir(elsewhere), ["far.nrrd"])

    def test_a_headers_data_file_is_no_permission(self):
        (self.folder / "secret.mhd").write_text(
            "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\n"
            "ElementDataFile = /etc/passwd\n")
        _, window = self.begun()
        with self.assertRaisesRegex(RuntimeError, "/etc/passwd: lies in no folder that is open"):
            window.ask("open", path="secret.mhd")

    def test_the_token_is_on_no_command_line(self):
        tools = self.folder / "tools"
        tools.mkdir()
        seen = self.folder / "seen"
        (tools / "xdg-open").write_text(
            f"#!/bin/sh\n{{ echo \"$*\"; stat -c %a \"$1\"; cat \"$1\"; }} >'{seen}.part'\nmv '{seen}.part' '{seen}'\n")
        (tools / "xdg-open").chmod(0o755)
        path = os.environ["PATH"]
        os.environ["PATH"] = f"{tools}:{path}"
        try:
            server = Server(PROGRAM, self.folder, "--open")
        finally:
            os.environ["PATH"] = path
        self.addCleanup(server.kill)
        end = time.monotonic() + 60
        while not seen.exists():
            self.assertLess(time.monotonic(), end, "no browser was started")
            time.sleep(0.01)
        arguments, mode, page = seen.read_text().split("\n", 2)
        self.assertNotIn(server.token, arguments)
        self.assertEqual(mode, "600")
        self.assertIn(server.url, page)

    def test_an_export_leaves_the_files_of_others_alone(self):
        folder = self.folder / "head files"
        folder.mkdir()
        (folder / "mesh.ele").write_text("of somebody else")
        server = Server(PROGRAM, self.folder, "head.nrrd")
        self.addCleanup(server.kill)
        window = Window(server)
        self.addCleanup(window.close)
        self.assertEqual(window.ask("export", object="bone", path="mesh.node")["file"], "mesh-2.node")
        self.assertTrue((folder / "mesh-2.ele").exists())
        self.assertEqual((folder / "mesh.ele").read_text(), "of somebody else")


class Shared(unittest.TestCase):
    """A server with a second address, which only shows the plan."""

    KINDS = {
        "open": {"path": "head.nrrd"}, "list": {}, "series": {"path": "."}, "recent": {}, "save": {"path": "copy.plan.json"},
        "edit": {"what": "a cut", "add": {"step": BOX}}, "undo": {}, "redo": {}, "go_to": {"where": "1"},
        "branch": {"name": "b"}, "name_version": {"name": "v"}, "procedure": {"name": "le_fort_i", "landmarks": {}},
        "acts_on": {"name": "le_fort_i"}, "landmark": {"name": "a", "point": [0, 0, 0], "snap": False},
        "find_landmarks": {"object": "skull"}, "command": {"step": "skull"}, "overlap": {"object": "skull", "with": []},
        "part": {"object": "skull"}, "try": {"steps": [BOX]}, "trace": {}, "measure": {"kind": "volume", "object": "skull"},
        "mesh_audit": {"path": "other.stl"}, "certify": {"object": "skull"},
        "export": {"object": "skull", "path": "a.stl"}, "report": {}, "outcome": {"path": "head.nrrd"},
        "merge": {"path": "other.plan.json"}, "try_merge": {"path": "other.plan.json"}, "signatures": {}, "doubtful_places": {"scan": "ct"}, "sign": {"role": "surgeon", "name": "A"}}

    def setUp(self):
        kept = tempfile.TemporaryDirectory()
        self.addCleanup(kept.cleanup)
        self.folder = pathlib.Path(kept.name).resolve()
        octotomy(self.folder, "phantom", "head", "-o", "head.nrrd", "--voxel", "4")
        (self.folder / "other.plan.json").write_text(json.dumps({"octotomy_plan": 1, "scans": {"ct": {"path": "head.nrrd"}}, "steps": []}))
        self.server = Server(PROGRAM, self.folder, "head.nrrd", "--share")
        self.addCleanup(self.server.kill)
        self.editor = Window(self.server)
        self.viewer = Window(self.server, token=self.server.view_token)
        self.addCleanup(self.editor.close)
        self.addCleanup(self.viewer.close)
        self.assertEqual(self.viewer.status, 101)
        self.editor.ask("edit", what="a window", add={"step": {"id": "skull", "do": "window", "scan": "ct", "low": 300}})
        self.editor.ask("evaluate")

    def files(self):
        return {path: (path.stat().st_mtime_ns, path.read_bytes() if path.is_file() else None)
                for path in self.folder.rglob("*")}

    def test_every_request_that_changes_or_names_something_is_refused(self):
        before, state = self.files(), self.editor.ask("hello")["plan_state"]
        for what, said in self.KINDS.items():
            with self.assertRaisesRegex(RuntimeError, "input: this window only shows the plan", msg=what):
                self.viewer.ask(what, **said)
        with self.assertRaisesRegex(RuntimeError, "input: this window only shows the plan"):
            self.viewer.ask("evaluate", certify=True)
        # A preview may have steps that read files; a moved piece is one, too.
        for preview in ({"object": "a", "steps": [{"do": "import", "path": "other.stl"}]},
                        {"object": "skull", "move": {"by": {"left_mm": 5}}}, None):
            with self.assertRaisesRegex(RuntimeError, "input: this window only shows the plan"):
                self.viewer.ask("pane", pane=0, size=[40, 30], objects=[{"id": "skull"}], preview=preview)
        self.assertEqual(self.editor.ask("hello")["plan_state"], state)
        self.assertEqual(self.files(), before)
        # The same requests, from a window that may edit, are refused for other reasons or answered.
        for what in ("list", "recent", "save"):
            self.editor.ask(what)

    def test_its_token_opens_the_page_and_neither_files_nor_uploads(self):
        report = self.editor.ask("report")["file"]
        own, view = self.server.token, self.server.view_token
        self.assertNotEqual(own, view)
        self.assertEqual(self.server.http(f"/?token={view}")[0], 200)
        self.assertEqual(self.server.http(f"/file/{own}/{report}")[0], 200)
        before = self.files()
        self.assertEqual(self.server.http(f"/file/{view}/{report}")[0], 403)
        status, _, body = self.server.http(f"/upload?token={view}&name=a.txt", "POST", b"x",
                                           Origin=f"http://{self.server.host}:{self.server.port}")
        self.assertEqual((status, self.files()), (403, before))
        self.assertIn(b"only shows the plan", body)
        for wrong in ({"token": ""}, {"token": view[:-1]}, {"token": own[:16] + view[16:]},
                      {"token": view, "origin": "http://evil.example"}, {"token": view, "origin": ""}):
            window = Window(self.server, **wrong)
            self.assertEqual(window.status, 403, wrong)
            window.close()

    def test_it_follows_the_plan_and_learns_no_folder_and_no_other_token(self):
        hello = self.viewer.ask("hello")
        self.assertEqual((hello["may_edit"], hello["folders"]), (False, []))
        self.editor.ask("edit", what="a cut", add={"step": BOX})
        self.editor.ask("evaluate")
        self.assertEqual(self.viewer.ask("evaluate", objects=["skull"])["scans"][0]["path"], "head.nrrd")
        steps = [event["plan_state"]["plan"]["steps"] for event in self.viewer.events if event["event"] == "plan"]
        self.assertEqual([step["id"] for step in steps[-1]], ["bone", "skull", "cut"])
        header, parts = self.viewer.ask("pane", pane=0, size=[60, 40], objects=[{"id": "skull"}], dragging=False)
        self.assertEqual(header["objects"], ["skull"])
        self.assertTrue(parts["png"])
        _, own = self.editor.ask("pane", pane=0, size=[60, 40], objects=[{"id": "skull"}], dragging=False)
        self.assertEqual(parts["png"], own["png"])
        told = json.dumps([hello, self.viewer.events, header])
        for secret in (str(self.folder), self.server.token, self.server.view_token):
            self.assertNotIn(secret, told)
        edits = self.editor.ask("hello")
        self.assertEqual((edits["may_edit"], edits["view_token"]), (True, self.server.view_token))

    def test_no_message_to_it_names_a_folder(self):
        patient = self.folder / "Doe Jane"
        patient.mkdir()
        (patient / "jaw.stl").write_text("solid, but cut off")
        for path in ("Doe Jane/jaw.stl", str(patient / "jaw.stl"), f"{self.folder}/uploads/../Doe Jane/jaw.stl"):
            self.editor.ask("edit", what="a file", add={"step": {"id": "jaw", "do": "import", "path": path}})
            made = self.viewer.ask("evaluate", objects=["skull", "jaw"])
            errors = [one["error"] for one in made["objects"] if "error" in one]
            self.assertEqual(len(errors), 1, made["objects"])
            self.assertIn("jaw.stl", errors[0])
            own = [one["error"] for one in self.editor.ask("evaluate", objects=["skull", "jaw"])["objects"] if "error" in one]
            self.assertIn("Doe Jane", own[0])
            told = json.dumps([made, self.viewer.ask("hello"), self.viewer.events])
            for secret in ("Doe Jane", str(self.folder)):
                self.assertNotIn(secret, told)
            self.editor.ask("undo")

    def test_more_windows_than_may_look_are_turned_away_with_a_reason(self):
        most = 16
        others = [Window(self.server, token=self.server.view_token) for _ in range(most - 1)]
        for window in others:
            self.addCleanup(window.close)
            self.assertEqual(window.ask("hello")["may_edit"], False)
        refused = Window(self.server, token=self.server.view_token)
        self.addCleanup(refused.close)
        with self.assertRaisesRegex(ConnectionError, f"{most} windows look at this plan already"):
            refused.ask("hello")
        # Windows that edit are not counted, and one that leaves makes room.
        editor = Window(self.server)
        self.addCleanup(editor.close)
        self.assertEqual(editor.ask("hello")["may_edit"], True)
        others.pop().close()
        for _ in range(100):
            next_one = Window(self.server, token=self.server.view_token)
            self.addCleanup(next_one.close)
            try:
                self.assertEqual(next_one.ask("hello")["may_edit"], False)
                break
            except ConnectionError:
                time.sleep(0.05)
        else:
            self.fail("no window may look, although one was closed")

    def test_a_viewer_that_floods_leaves_the_editor_its_answers(self):
        waiting = {self.viewer.post("movement", object="skull") for _ in range(200)}
        self.assertGreater(self.editor.ask("part", object="skull")["parts"], 0)
        answers = []
        while waiting:
            answer = self.viewer.receive()
            if answer.get("id") in waiting:
                waiting.remove(answer["id"])
                answers.append(answer)
        self.assertTrue(any("too many requests" in answer.get("error", {}).get("message", "") for answer in answers))

    def test_without_share_there_is_no_second_address(self):
        with tempfile.TemporaryDirectory() as folder:
            alone = Server(PROGRAM, folder)
            self.addCleanup(alone.kill)
            self.assertIsNone(alone.view_token)
            window = Window(alone)
            self.assertNotIn("view_token", window.ask("hello"))
            window.close()

    def test_both_tokens_outlive_a_restart_in_files_of_their_owner(self):
        tokens = []
        for _ in range(2):
            again = Server(PROGRAM, self.folder, "--share", "--token-file", self.folder / "token")
            tokens.append((again.token, again.view_token))
            again.kill()
        self.assertEqual(tokens[0], tokens[1])
        for name in ("token", "token.view"):
            self.assertEqual((self.folder / name).stat().st_mode & 0o777, 0o600)


class Killed(unittest.TestCase):
    def test_a_killed_server_loses_no_edit_that_it_told(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name).resolve()
            octotomy(folder, "phantom", "head", "-o", "head.nrrd", "--voxel", "4")
            port, told = [], {"bone"}
            for life in range(4):
                server = Server(PROGRAM, folder, "head.nrrd", "--token-file", "token", *port)
                port = ["--port", server.port]
                window = Window(server)
                steps = {step["id"] for step in window.ask("hello")["plan_state"]["plan"]["steps"]}
                self.assertLessEqual(told, steps)
                self.assertLessEqual(len(steps), len(told) + life)  # and what was not told
                for number in range(5):
                    window.ask("edit", add={"step": {**BOX, "id": f"cut_{life}_{number}"}}, what=f"{number}")
                    told.add(f"cut_{life}_{number}")
                window.post("edit", add={"step": {**BOX, "id": f"late_{life}"}})
                server.kill()
                window.close()
            octotomy(folder, "plan", "history", "head.plan.json")
            text = json.loads((folder / "head.plan.json").read_text())
            self.assertLessEqual(told, {step["id"] for step in text["steps"]})


if __name__ == "__main__":
    unittest.main()
