# SPDX-License-Identifier: AGPL-3.0-or-later
"""What is written with --identity remove names nobody: 20 personal strings planted in a series, its folder, a plan and
beside it are searched for byte by byte in every kind of file that the program writes, also inside of archives."""
import base64
import gzip
import io
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml
import zipfile
import zlib
from pathlib import Path

try:
    import pydicom
except ImportError:
    pydicom = None

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
NAMES = {  # the strings by where they stand
    (0x0010, 0x0010): ("PN", "PLANTEDFAMILY^PLANTEDGIVEN"), (0x0010, 0x0020): ("LO", "PLANTEDNUMBER17"),
    (0x0010, 0x0030): ("DA", "19430719"), (0x0010, 0x1010): ("AS", "083Y"), (0x0010, 0x0021): ("LO", "PLANTEDISSUER"),
    (0x0010, 0x4000): ("LT", "PLANTEDCOMMENT"), (0x0008, 0x0090): ("PN", "PLANTEDREFERRER"),
    (0x0008, 0x0050): ("SH", "PLANTEDACCESS"), (0x0008, 0x1030): ("LO", "PLANTEDSTUDY"),
    (0x0008, 0x103e): ("LO", "PLANTEDSERIES"), (0x0008, 0x0080): ("LO", "PLANTEDHOSPITAL"),
    (0x0008, 0x1010): ("SH", "PLANTEDSTATION"), (0x0008, 0x1070): ("PN", "PLANTEDOPERATOR"),
    (0x0018, 0x0015): ("CS", "PLANTEDBODY"), (0x0018, 0x1030): ("LO", "PLANTEDPROTOCOL"),
    (0x0020, 0x0010): ("SH", "PLANTEDSTUDYID"), (0x0020, 0x1040): ("LO", "PLANTEDPOSITION"),
    (0x0020, 0x4000): ("LT", "PLANTEDIMAGE")}
IN_PATHS = ["PLANTEDFOLDER", "PLANTEDFILE", "PLANTEDPLAN", "PLANTEDREADER"]
PLANTED = [word for _, text in NAMES.values() for word in text.split("^")] + IN_PATHS
PLAN = {
    "octotomy_plan": 1, "name": "Advancement of PLANTEDPLAN", "universe": {"voxel_mm": 8.0},
    "steps": [{"id": "skull", "do": "window", "scan": "ct", "low": 300},
              {"id": "cut", "do": "mask", "regions": [
                  {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]}]},
              {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
              {"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 2]},
              {"id": "size", "do": "measure", "object": "advanced"},
              {"id": "piece", "do": "export", "object": "advanced", "path": "maxilla.stl"}]}


def run(*words, status=0):
    answer = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300)
    assert answer.returncode == status, f"{words}: {answer.returncode}\n{answer.stdout}\n{answer.stderr}"
    return answer


def inside(name, data):
    """A file's bytes, and those of everything packed inside of it."""
    yield name, data
    if data[:4] == b"PK\x03\x04":
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for entry in archive.namelist():
                yield from inside(f"{name}/{entry}", archive.read(entry))
    if data[:2] == b"\x1f\x8b":
        yield from inside(name + " unpacked", gzip.decompress(data))
    for stream in re.finditer(rb"stream\r?\n(.*?)endstream", data, re.S) if b"%PDF-" in data[:4096] else []:
        try:
            yield name + " stream", zlib.decompress(stream.group(1))
        except zlib.error:
            pass
    for body in re.finditer(rb'representation="B64"[^>]*>([^<]*)</text>', data):
        yield from inside(name + " body", base64.b64decode(body.group(1)))
    end = data.find(b"\n\n") if data[:4] == b"NRRD" else -1
    if end > 0 and b"encoding: gz" in data[:end]:
        yield name + " samples", gzip.decompress(data[end + 2:])


def planted_in(paths):
    found, files = [], 0
    for path in paths:
        for file in [path] if path.is_file() else sorted(x for x in path.rglob("*") if x.is_file()):
            for name, data in inside(str(file.relative_to(path.parent)), file.read_bytes()):
                files += 1
                for word in PLANTED:
                    coded = [word.encode(), word.lower().encode(), word.encode("utf-16-le"), word.encode("utf-16-be")]
                    if any(x in data for x in coded) or word in name:
                        found.append((name, word))
    return found, files


@unittest.skipIf(pydicom is None, "not installed: apt-get install python3-pydicom")
class Identity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        cls.series = cls.folder / "PLANTEDFOLDER"
        run(PROGRAM, "phantom", "head", "--voxel", "6", "-o", cls.folder / "head.nrrd")
        run(PROGRAM, "convert", cls.folder / "head.nrrd", "--dicom", "-o", cls.series)
        uids = {}
        for file in sorted(cls.series.iterdir()):
            read = pydicom.dcmread(file)
            for tag, (kind, text) in NAMES.items():
                read.add_new(tag, kind, text)
            # Identifiers of the hospital's own, which are personal too.
            for name in ["StudyInstanceUID", "SeriesInstanceUID", "FrameOfReferenceUID"]:
                uids[name] = "1.2.826.0.1.3680043.2.1143.77." + str(len(name))
                setattr(read, name, uids[name])
            read.SOPInstanceUID = read.file_meta.MediaStorageSOPInstanceUID = \
                "1.2.826.0.1.3680043.2.1143.77.9." + str(read.InstanceNumber)
            read.save_as(file)
            file.rename(file.with_name("PLANTEDFILE_" + file.name))
        cls.uids = uids
        PLANTED.append("1.2.826.0.1.3680043.2.1143.77.")
        at = cls.folder / "at"
        at.mkdir()
        plan = dict(PLAN, scans={"ct": {"path": str(cls.series)}})
        cls.plan = at / "PLANTEDPLAN.plan.json"
        cls.plan.write_text(json.dumps(plan))
        run(PROGRAM, "octree", cls.series, "--window", "300:", "-o", at / "PLANTEDFILE.octree")
        run(PROGRAM, "mesh", cls.series, "--window", "300:", "-o", at / "PLANTEDFILE.stl")
        run(PROGRAM, "segment", cls.series, "--window", "bone", "-o", at / "PLANTEDFILE.nrrd")
        # The views of a plan, which hold no text.
        run(PROGRAM, "run", cls.plan, "--certify", "never", "-o", at / "views")
        cls.at = at

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    def write_all(self, choice):
        """Every kind of object, with an identity; returns their paths."""
        out = self.folder / choice
        out.mkdir()
        source = ["--source", self.series, "--identity", choice]
        at = self.at / "PLANTEDFILE"
        run(PROGRAM, "convert", self.series, "--identity", choice, "--dicom", "-o", out / "series")
        run(PROGRAM, "convert", self.series, "--identity", choice, "-o", out / "scan.nrrd")
        run(PROGRAM, "convert", self.series, "--identity", choice, "-o", out / "scan.nii.gz")
        run(PROGRAM, "convert", f"{at}.octree", *source, "-o", out / "segmentation.dcm")
        run(PROGRAM, "convert", f"{at}.nrrd", *source, "-o", out / "labels.dcm")
        run(PROGRAM, "convert", f"{at}.octree", *source, "--as", "labelmap", "-o", out / "numbers.dcm")
        run(PROGRAM, "convert", f"{at}.octree", *source, "--as", "structures", "-o", out / "structures.dcm")
        run(PROGRAM, "convert", f"{at}.octree", *source, "--as", "fractions", "-o", out / "fractions.dcm")
        run(PROGRAM, "convert", f"{at}.stl", *source, "-o", out / "model.dcm")
        run(PROGRAM, "convert", f"{at}.stl", *source, "--as", "obj", "-o", out / "model_obj.dcm")
        run(PROGRAM, "segment", self.series, "--window", "bone", "--identity", choice, "-o", out / "bone.dcm")
        run(PROGRAM, "convert", self.plan, "--pictures", self.at / "views", *source, "-o", out / "objects")
        return out

    def test_removed_identities_are_nowhere(self):
        out = self.write_all("remove")
        run(PROGRAM, "pack", self.plan, "--identity", "remove", "-o", out / "plan.zip")
        run(PROGRAM, "run", self.plan, "--identity", "remove", "--certify", "never", "-o", out / "result")
        run(PROGRAM, "scene", self.plan, "--identity", "remove", "-o", out / "scene")
        run(PROGRAM, "scene", self.plan, "--identity", "remove", "-o", out / "scene.mrb")
        found, files = planted_in([out])
        self.assertEqual(found, [])
        self.assertGreater(files, 60)
        for name in ["segmentation", "labels", "structures", "model", "fractions", "bone", "objects/plan",
                     "objects/picture_001"]:
            read = pydicom.dcmread(out / f"{name}.dcm")
            self.assertEqual((read.PatientName, read.PatientID, read.StudyDate), ("", "", ""), name)
            self.assertEqual(read.PatientIdentityRemoved, "YES")
            self.assertEqual(read.DeidentificationMethodCodeSequence[0].CodeValue, "113100")
        # What belongs together stays together, under other identifiers.
        reads = [pydicom.dcmread(x) for x in [out / "bone.dcm", next((out / "series").iterdir()), out / "structures.dcm",
                                              out / "objects/plan.dcm", out / "objects/picture_001.dcm"]]
        self.assertEqual(len({read.StudyInstanceUID for read in reads}), 1)
        self.assertEqual(len({read.FrameOfReferenceUID for read in reads[:3]}), 1)
        self.assertNotEqual(reads[0].StudyInstanceUID, self.uids["StudyInstanceUID"])
        # The pack can be replayed and checked.
        run(PROGRAM, "verify", out / "plan.zip", "--scan", f"ct={self.series}")

    def test_kept_identities_are_there(self):
        out = self.write_all("keep")
        found, _ = planted_in([out])
        self.assertIn("PLANTEDNUMBER17", {word for _, word in found})
        self.assertEqual(pydicom.dcmread(out / "bone.dcm").StudyInstanceUID, self.uids["StudyInstanceUID"])

    def test_new_identities_are_of_a_patient_without_a_name(self):
        out = self.write_all("new")
        self.assertEqual(planted_in([out])[0], [])
        read = pydicom.dcmread(out / "model.dcm")
        self.assertEqual((read.PatientName, read.PatientID), ("Anonymous", "OCTOTOMY"))
        self.assertNotIn("PatientIdentityRemoved", read)

    def test_what_was_removed_is_listed(self):
        said = json.loads(run(PROGRAM, "convert", self.at / "PLANTEDFILE.stl", "--source", self.series, "--identity",
                              "remove", "-o", self.folder / "listed.dcm", "--json").stdout)["identity"]
        self.assertEqual(said["choice"], "remove")
        for line in ["Patient's Name (0010,0010): emptied", "Patient's Age (0010,1010): removed",
                     "Study Instance UID (0020,000d): replaced",
                     "Body Part Examined (0018,0015): removed, because the standard does not define it"]:
            self.assertIn(line, said["changes"])
        self.assertNotIn("PLANTED", "".join(said["changes"]))

    def test_a_pdf_has_to_be_without_names_by_itself(self):
        pdf = self.folder / "report.pdf"
        pdf.write_bytes(b"%PDF-1.4\nPLANTEDFAMILY\n%%EOF\n")
        words = ["convert", pdf, "--source", self.series, "--identity", "remove", "-o", self.folder / "pdf.dcm"]
        self.assertIn("pages name nobody", run(PROGRAM, *words, status=2).stderr)
        if shutil.which("chromium") is None:
            self.skipTest("not installed: apt-get install chromium")
        run(PROGRAM, "run", self.plan, "--identity", "remove", "--certify", "never", "--pdf", "-o", self.folder / "printed")
        words[1] = self.folder / "printed/report.pdf"
        run(PROGRAM, *words)
        self.assertEqual(planted_in([self.folder / "printed", self.folder / "pdf.dcm"])[0], [])

    def test_a_plan_comes_back_from_its_object_and_names_of_steps_are_refused(self):
        out = self.folder / "plan_objects"
        source = ["--source", self.series]
        said = json.loads(run(PROGRAM, "convert", self.plan, *source, "--pictures", self.at / "views", "-o", out, "--json").stdout)
        views = sorted((self.at / "views/views").glob("*.png"))
        self.assertEqual((said["pictures"], len(said["files"])), (len(views), len(views) + 1))
        run(PROGRAM, "convert", out / "plan.dcm", "-o", out / "again.plan.json")
        self.assertEqual((out / "again.plan.json").read_bytes(), self.plan.read_bytes())
        info = json.loads(run(PROGRAM, "info", out / "plan.dcm", "--json").stdout)
        self.assertEqual((info["kind"], info["plan"]["steps"]), ("DICOM encapsulated CDA", len(PLAN["steps"])))
        # The same bytes by plain Python.
        read = pydicom.dcmread(out / "plan.dcm")
        text = xml.fromstring(read.EncapsulatedDocument[:read.EncapsulatedDocumentLength]).find(".//{urn:hl7-org:v3}text")
        self.assertEqual(base64.b64decode(text.text), self.plan.read_bytes())
        for number, view in enumerate(views, 1):
            picture = pydicom.dcmread(out / f"picture_{number:03d}.dcm")
            self.assertEqual(picture.ImageComments, view.stem)
            run(PROGRAM, "convert", out / f"picture_{number:03d}.dcm", "-o", out / "again.png")
            run(PROGRAM, "info", out / f"picture_{number:03d}.dcm")
            self.assertEqual((picture.Rows, picture.Columns), (480, 480))
        named = dict(PLAN, scans={"ct": {"path": "x"}}, steps=[dict(PLAN["steps"][0], id="PlantedFamily_skull")])
        (self.folder / "named.plan.json").write_text(json.dumps(named))
        for words, cause in [
                (["named.plan.json", *source, "--identity", "remove", "-o", "o"],
                 "'plantedfamily', which the source states about"),
                (["named.plan.json", *source, "--pictures", self.at / "views", "-o", "o"], "the result of another plan"),
                (["named.plan.json", *source, "--pictures", self.at, "-o", "o"], "contains no result.json"),
                (["named.plan.json", *source, "-o", "o.dcm"], "give a folder"),
                (["named.plan.json", *source, "--as", "stl", "-o", "o"], "leave --dicom and --as out"),
                ([self.at / "views/result.json", *source, "-o", "o"], "is no plan"),
                ([out / "plan.dcm", "-o", "o.pdf"], "name a file that ends in .json"),
                ([out / "plan.dcm", "-o", "o.json", "--label", "x"], "leave --source, --label"),
                ([out / "picture_001.dcm", "-o", "o.json"], "name a file that ends in .png")]:
            words = [self.folder / words[0], *words[1:]]
            answer = subprocess.run([PROGRAM, "convert", *map(str, words)], capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(answer.returncode, 2, answer.stderr)
            lines = [x for x in answer.stderr.splitlines() if "identity: whether" not in x]
            self.assertEqual(len(lines), 1, answer.stderr)
            self.assertIn(cause, lines[0])
            self.assertFalse(list(self.folder.glob("o*.*")) or (self.folder / "o").exists(), words)

    @unittest.skipIf(shutil.which("dciodvfy") is None, "not installed: apt-get install dicom3tools")
    def test_objects_are_held_to_the_standard(self):
        out, files = self.folder / "valid", []
        out.mkdir()
        for choice in ["remove", "new"]:
            for name, words in {"seg": [".octree"], "rt": [".octree", "--as", "structures"], "stl": [".stl"]}.items():
                file = out / f"{choice}_{name}.dcm"
                run(PROGRAM, "convert", f"{self.at / 'PLANTEDFILE'}{words[0]}", *words[1:], "--source", self.series,
                    "--identity", choice, "-o", file)
                files.append(file)
            run(PROGRAM, "convert", self.plan, "--source", self.series, "--pictures", self.at / "views", "--identity", choice,
                "-o", out / choice)
            files += sorted((out / choice).iterdir())
        for file in files:
            # Of 2019 and later, which this checker does not know yet.
            said = subprocess.run(["dciodvfy", file], capture_output=True, text=True)
            self.assertEqual([x for x in (said.stdout + said.stderr).splitlines() if "Error" in x and "CLOSEDPLANAR_XOR" not in x], [], file)


if __name__ == "__main__":
    unittest.main()
