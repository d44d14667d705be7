# SPDX-License-Identifier: AGPL-3.0-or-later
"""Packs: equal plans make equal archives, a replay finds no difference, and the independent checker finds every
forgery, although each forger corrects the sums in manifest.json."""
import json
import os
import random
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from pack_forgery import CHECKER, PLAN, PROGRAM, Forger, forged, hostile_entries, make_series, move_a_vertex, run

FORGERIES = int(os.environ.get("OCTOTOMY_FORGERIES", "29"))


class Pack(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        cls.scan = cls.folder / "series"
        make_series(cls.scan)
        (cls.folder / "my.plan.json").write_text(json.dumps(PLAN))
        cls.archive = cls.folder / "a.zip"
        made = cls.pack("my.plan.json", "a.zip")
        assert made.returncode == 0, made.stderr

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    @classmethod
    def pack(cls, plan, name, *more):
        return run(PROGRAM, "pack", cls.folder / plan, "--scan", f"ct={cls.scan}", "-o", cls.folder / name, *more)

    def check(self, path, *more):
        return run(sys.executable, CHECKER, path, *more)

    def test_equal_plans_make_equal_archives_on_any_thread_count(self):
        self.assertEqual(self.pack("my.plan.json", "b.zip", "--threads", 1).returncode, 0)
        self.assertEqual(self.archive.read_bytes(), (self.folder / "b.zip").read_bytes())

    def test_the_checker_confirms_and_contradicts_nothing(self):
        checked = self.check(self.archive, "--json")
        self.assertEqual(checked.returncode, 0, checked.stdout)
        found = json.loads(checked.stdout)
        self.assertEqual(found["contradictions"], [])
        numbers = found["numbers"]
        self.assertGreater(numbers["confirmed"], 0.45 * sum(numbers.values()), numbers)
        states = {value["where"]: value["state"] for value in found["values"]}
        for where in ("objects / 2 / voxel / volume_mm3", "objects / 2 / mesh / area_mm2",
                      "certificates / 1 / difference_mm3", "exports / 0 / volume_mm3"):
            self.assertEqual(states[where], "confirmed", where)

    def test_every_forgery_is_contradicted(self):
        before = Forger(self.archive, random.Random(0)).entries
        for i, (way, forger) in enumerate(forged(self.archive, FORGERIES)):
            with self.subTest(forgery=i, way=way):
                forger.write(self.folder / "forged.zip")
                self.assertTrue(any(before[name] != data for name, data in forger.entries.items() if name != "manifest.json")
                                or way in ("hide_a_dicom_object", "exchange_objects"))
                checked = self.check(self.folder / "forged.zip")
                self.assertEqual(checked.returncode, 1, checked.stdout + checked.stderr)
                self.assertIn("contradicted:", checked.stdout)

    def test_a_changed_entry_is_named_where_its_sum_is_not_corrected(self):
        with zipfile.ZipFile(self.archive) as archive:
            entries = {name: archive.read(name) for name in archive.namelist()}
        entries["result/maxilla.stl"] += b" "
        with zipfile.ZipFile(self.folder / "changed.zip", "w") as archive:
            for name, data in entries.items():
                archive.writestr(name, data)
        checked = self.check(self.folder / "changed.zip")
        self.assertEqual(checked.returncode, 1)
        self.assertIn("result/maxilla.stl", checked.stdout)
        replayed = run(PROGRAM, "verify", self.folder / "changed.zip", "--scan", f"ct={self.scan}")
        self.assertEqual(replayed.returncode, 2)
        self.assertIn("result/maxilla.stl", replayed.stderr)

    def test_a_replay_differs_in_nothing(self):
        replayed = run(PROGRAM, "verify", self.archive, "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual((pack["different_values"], pack["different_entries"]), ([], []))
        self.assertGreater(pack["values"], 500)

    def test_a_replay_names_the_values_that_were_changed(self):
        forger = Forger(self.archive, random.Random(1))
        forger.result["objects"][2]["voxel"]["volume_mm3"] += 64
        forger.write(self.folder / "forged.zip")
        replayed = run(PROGRAM, "verify", self.folder / "forged.zip", "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 1)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual([value["where"] for value in pack["different_values"]],
                         ["objects / maxilla / voxel / volume_mm3"])
        self.assertEqual(pack["different_entries"], ["result/result.json"])

    def test_a_replay_names_an_entry_that_was_changed_alone(self):
        forger = Forger(self.archive, random.Random(2))
        move_a_vertex(forger)
        forger.write(self.folder / "forged.zip")
        replayed = run(PROGRAM, "verify", self.folder / "forged.zip", "--scan", f"ct={self.scan}", "--json")
        self.assertEqual(replayed.returncode, 1)
        pack = json.loads(replayed.stdout)["pack"]
        self.assertEqual(pack["different_values"], [])
        self.assertEqual(len(pack["different_entries"]), 1)
        self.assertIn("points.npy", pack["different_entries"][0])

    def test_what_a_manifest_leaves_out_is_contradicted(self):
        for key, kind in (("samples", "window"), ("points", "surface"), ("image_of", "image")):
            with self.subTest(key=key):
                forger = Forger(self.archive, random.Random(3))
                manifest = json.loads(forger.entries["manifest.json"])
                for row in manifest["objects"]:
                    row.pop(key, None)
                forger.entries["manifest.json"] = json.dumps(manifest).encode()
                forger.write(self.folder / "forged.zip")
                checked = self.check(self.folder / "forged.zip")
                self.assertEqual(checked.returncode, 1, checked.stdout)
                self.assertIn(kind, checked.stdout)

    def test_hostile_entries_are_refused_in_one_line(self):
        for name, data in hostile_entries().items():
            with self.subTest(entry=name):
                forger = Forger(self.archive, random.Random(4))
                forger.entries[name] = data
                forger.write(self.folder / "hostile.zip")
                checked = self.check(self.folder / "hostile.zip")
                self.assertEqual(checked.returncode, 2, checked.stdout + checked.stderr)
                self.assertEqual(len(checked.stderr.strip().splitlines()), 1, checked.stderr)

    def test_the_dicom_objects_are_those_of_the_archive(self):
        found = json.loads(self.check(self.archive, "--json").stdout)
        with zipfile.ZipFile(self.archive) as archive:
            dicom = json.loads(archive.read("manifest.json"))["dicom"]
            names = [name for name in archive.namelist() if name.startswith("dicom/")]
        self.assertEqual(dicom["scan"], "ct")
        kinds = [row["kind"] for row in dicom["objects"]]
        self.assertEqual([kinds.count(kind) for kind in ("segmentation", "structures", "model", "plan")], [1, 1, 2, 1])
        self.assertEqual(kinds.count("picture"), 10)
        self.assertEqual(len(names), len(kinds))
        # Each segment, region and model, the identity, the list, and the objects' frames.
        whole = run(sys.executable, CHECKER, self.archive, "--all").stdout
        claims = [line for line in whole.splitlines() if "dicom/" in line and "SHA-256" not in line]
        self.assertGreater(len(claims), 20)
        self.assertTrue(all(line.startswith("confirmed") for line in claims), claims)
        self.assertEqual(found["claims"]["contradicted"], 0)

    def test_a_pack_for_others_names_nobody_in_its_dicom_objects(self):
        for words in (["--identity", "remove"], ["--anonymous"]):
            with self.subTest(words=words):
                made = self.pack("my.plan.json", "nobody.zip", *words)
                self.assertEqual(made.returncode, 0, made.stderr)
                with zipfile.ZipFile(self.folder / "nobody.zip") as archive:
                    self.assertEqual(json.loads(archive.read("manifest.json"))["dicom"]["identity"]["choice"], "remove")
                    for name in archive.namelist():
                        if name.startswith("dicom/"):
                            self.assertNotIn(b"Phantom^", archive.read(name), name)
                whole = self.check(self.folder / "nobody.zip", "--all")
                self.assertEqual(whole.returncode, 0, whole.stdout)
                self.assertIn("confirmed     dicom/: its objects name no patient", whole.stdout)
                replayed = run(PROGRAM, "verify", self.folder / "nobody.zip", "--scan", f"ct={self.scan}", "--json")
                self.assertEqual(json.loads(replayed.stdout)["pack"]["different_entries"], [])

    def test_a_plan_that_names_the_patient_is_not_packed_for_others(self):
        # The phantom's patient is Phantom^Octotomy.
        steps = [dict(step, id="phantom_width") if step["id"] == "width" else step for step in PLAN["steps"]]
        (self.folder / "named.plan.json").write_text(json.dumps(dict(PLAN, steps=steps)))
        made = self.pack("named.plan.json", "named.zip", "--identity", "remove")
        self.assertEqual(made.returncode, 2, made.stderr)
        self.assertIn("'phantom'", made.stderr)
        self.assertFalse((self.folder / "named.zip").exists())

    def test_packs_without_a_series_or_with_no_dicom_have_no_dicom_objects(self):
        scan = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_2.nrrd"
        for words in (["--scan", f"ct={scan}"], ["--scan", f"ct={self.scan}", "--no-dicom"]):
            with self.subTest(words=words):
                made = run(PROGRAM, "pack", self.folder / "my.plan.json", "-o", self.folder / "other.zip", *words)
                self.assertEqual(made.returncode, 0, made.stderr)
                with zipfile.ZipFile(self.folder / "other.zip") as archive:
                    self.assertEqual([name for name in archive.namelist() if name.startswith("dicom/")], [])
                    self.assertNotIn("dicom", json.loads(archive.read("manifest.json")))
                self.assertEqual(self.check(self.folder / "other.zip").returncode, 0)
                replayed = run(PROGRAM, "verify", self.folder / "other.zip", *words[:2], "--json")
                self.assertEqual(json.loads(replayed.stdout)["pack"]["different_entries"], [])

    def test_a_replay_on_another_kind_of_file_says_what_it_needs(self):
        scan = Path(os.environ["OCTOTOMY_PHANTOMS"]) / "head_phantom_2.nrrd"
        replayed = run(PROGRAM, "verify", self.archive, "--scan", f"ct={scan}")
        self.assertEqual(replayed.returncode, 2)
        self.assertIn("--scan", replayed.stderr)

    def test_other_files_are_refused_in_one_line(self):
        with zipfile.ZipFile(self.folder / "other.zip", "w") as archive:
            archive.writestr("a.txt", "a")
        (self.folder / "text.zip").write_text("no archive")
        for name in ("other.zip", "text.zip"):
            for found in (self.check(self.folder / name), run(PROGRAM, "verify", self.folder / name)):
                self.assertEqual(found.returncode, 2, found.stderr)
                self.assertEqual(len(found.stderr.strip().splitlines()), 1, found.stderr)
                self.assertIn(name, found.stderr)
        refused = self.pack("my.plan.json", "a.tar")
        self.assertEqual(refused.returncode, 2)
        self.assertIn(".zip", refused.stderr)


if __name__ == "__main__":
    unittest.main()
