# SPDX-License-Identifier: AGPL-3.0-or-later
"""Cohorts: complete tables, whatever happens to the workers."""
import csv
import json
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
import octotomy

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
SUBJECTS = int(os.environ.get("OCTOTOMY_SUBJECTS", "8"))  # the long run, ninja cohort_engines, has 200


def ball(path, radius, side=24):
    """A ball's scan, its surface at 0 HU and as sharp as samples of 1 mm show it."""
    at = np.mgrid[0:side, 0:side, 0:side] - (side - 1) / 2
    distance = np.sqrt((at**2).sum(axis=0))
    samples = np.clip((radius - distance) * 2000, -1000, 1000).astype(np.int16)
    octotomy.Scan(samples, np.diag([1, 1, 1, 1])).write(path)


def octotomy_program(*arguments, check=True):
    """Its status and, with --json, its answer."""
    run = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if check and run.returncode != 0:
        raise AssertionError(f"{arguments}: status {run.returncode}: {run.stderr}")
    return run


def page_data(path):
    """The data that a page of the program draws."""
    return json.loads(re.search(r'id="data">(.*?)</script>', path.read_text()).group(1))


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def workers(out):
    """The processes that are at a subject of `out`."""
    command = re.compile(re.escape(str(out)).encode() + rb".*participant-label.? '?[0-9]", re.DOTALL)
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if command.search(path.read_bytes().replace(b"\0", b" ")):
                found.append(int(path.parent.name))
        except OSError:  # it has ended
            pass
    return found


def end_at_work(process):
    """Ends a process with SIGKILL; whether it was still at work. A stopped process cannot end by itself in between."""
    try:
        os.kill(process, signal.SIGSTOP)
        while (state := Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]) not in "TZX":
            time.sleep(0.001)
        os.kill(process, signal.SIGKILL)
        return state == "T"
    except (ProcessLookupError, FileNotFoundError):
        return False


def kill_at_random(out, begin, seed):
    """Ends workers at subjects of `out` now and then, until what `begin` started no longer runs; how many. The first is
    ended as soon as it is seen. Where all were too quick to be seen, `out` is emptied and begun again."""
    choice = random.Random(seed)
    kills = 0
    for _ in range(20):
        is_running = begin()
        while is_running():
            longest = 0.01 if kills == 0 else 0.5 if SUBJECTS < 50 else 3.0
            time.sleep(choice.uniform(longest / 10, longest))
            found = workers(out)
            kills += bool(found) and end_at_work(choice.choice(found))
        if kills > 0:
            return kills
        shutil.rmtree(out, ignore_errors=True)
    raise AssertionError("no worker was seen at work")


def assert_complete(test, out, serial, count=SUBJECTS):
    """The tables of `out` hold every subject and measurement once, as those of the serial run do."""
    told = [row["subject"] for row in rows(out / "group/subjects.csv") if row["state"] == "done"]
    test.assertEqual(sorted(told), [f"{i:04d}" for i in range(count)])
    merged = rows(out / "group/measurements.csv")
    keys = [(row["subject"], row["measurement"], row["object"], row["quantity"]) for row in merged]
    test.assertEqual(len(keys), len(set(keys)))
    test.assertEqual((out / "group/measurements.csv").read_bytes(), (serial / "group/measurements.csv").read_bytes())


class Cohort(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = Path(place.name)
        plan = octotomy.Plan({"ct": "any.nrrd"}, name="ball")
        plan.window("ball", scan="ct", low=0)
        plan.measure("size", object="ball")
        self.plan = self.folder / "ball.plan.json"
        plan.write(self.plan)

    def cohort(self, count=SUBJECTS):
        """A table of balls; the radius tells them apart."""
        lines = ["participant_id,scan"]
        for i in range(count):
            ball(self.folder / f"ball_{i}.nrrd", 4 + 5 * i / max(1, count - 1))
            lines.append(f"sub-{i:04d},ball_{i}.nrrd")
        table = self.folder / "scans.csv"
        table.write_text("\n".join(lines) + "\n")
        return table

    def participants(self, table, out, *more, check=True):
        return octotomy_program("cohort", table, self.folder / out, "participant", "--plan", self.plan, *more, check=check)

    def group(self, table, out, *more):
        octotomy_program("cohort", table, self.folder / out, "group", *more)
        return self.folder / out / "group"

    def assert_no_leftovers(self, out):
        hidden = [path for path in (self.folder / out).rglob(".*") if path.name != ".octotomy-result"]
        self.assertEqual(hidden, [])

    def test_a_plan_that_is_kept_reads_the_files_of_its_own_folder(self):
        for folder, far in ((self.folder, 10), (self.folder / "out/code", 77)):
            folder.mkdir(parents=True, exist_ok=True)
            marks = [{"name": name, "point_mm": [x, 0, 0]} for name, x in (("a", 0), ("b", far))]
            (folder / "marks.json").write_text(json.dumps({"landmarks": marks}))
        plan = json.loads(self.plan.read_text())
        plan["steps"] += [{"id": "marks", "do": "landmarks", "file": "marks.json"},
                          {"id": "far", "do": "measure", "points_mm": ["a", "b"]}]
        self.plan.write_text(json.dumps(plan))
        table = self.cohort(1)
        self.participants(table, "out")
        again = json.loads(octotomy_program("cohort", table, self.folder / "out", "participant", "--json").stdout)
        self.assertTrue(again["subjects"][0]["kept"])
        merged = rows(self.group(table, "out") / "measurements.csv")
        self.assertEqual([float(row["value"]) for row in merged if row["measurement"] == "far"], [10.0])

    def test_the_table_is_that_of_the_plans_themselves(self):
        table = self.cohort(5)
        self.participants(table, "out")
        merged = rows(self.group(table, "out") / "measurements.csv")
        self.assertEqual(len({row["subject"] for row in merged}), 5)
        for i in range(5):
            octotomy_program("run", self.plan, "--scan", f"ct={self.folder}/ball_{i}.nrrd", "-o", self.folder / f"sub-{i:04d}")
            octotomy_program("table", self.folder / f"sub-{i:04d}", "-o", self.folder / "one.csv")
            own = [{**row, "subject": f"{i:04d}"} for row in rows(self.folder / "one.csv")]
            self.assertEqual(own, [row for row in merged if row["subject"] == f"{i:04d}"])
            volume = next(row for row in own if row["quantity"] == "volume")
            radius = 4 + 5 * i / 4
            self.assertAlmostEqual(float(volume["value"]) / (4 / 3 * np.pi * radius**3), 1, delta=0.06)
            self.assertEqual(volume["unit"], "mm3")
            self.assertGreater(float(volume["half_width"]), 0)
            self.assertIn(volume["verdict"], ("PASS", "WARN", "FAIL"))
            self.assertEqual(len(volume["plan_sha256"]), 64)

    def test_the_summary_is_that_of_its_numbers(self):
        table = self.cohort(7)
        self.participants(table, "out")
        group = self.group(table, "out")
        told = json.loads((group / "summary.json").read_text())
        volume = next(each for each in told["measurements"] if each["quantity"] == "volume")
        values = [float(row["value"]) for row in rows(group / "measurements.csv") if row["quantity"] == "volume"]
        kernels = [(float(row["voxel"]), float(row["mesh"])) for row in rows(group / "measurements.csv")
                   if row["quantity"] == "volume"]
        self.assertAlmostEqual(volume["mean"], np.mean(values))
        self.assertAlmostEqual(volume["sd"], np.std(values, ddof=1))
        self.assertAlmostEqual(volume["median"], np.median(values))
        differences = [mesh - voxel for voxel, mesh in kernels]
        self.assertAlmostEqual(volume["kernels"]["bias"], np.mean(differences))
        self.assertAlmostEqual(volume["kernels"]["limits_of_agreement"][1],
                               np.mean(differences) + 1.96 * np.std(differences, ddof=1))
        wide = rows(group / "wide.csv")
        self.assertEqual([float(row["size.volume_mm3"]) for row in wide], values)
        shown = page_data(group / "index.html")["subjects"]
        for i in range(7):
            self.assertEqual((shown[i]["label"], shown[i]["has_picture"]), (f"{i:04d}", True))
            self.assertTrue((group.parent / f"sub-{i:04d}/picture.png").exists())
        self.assertGreater(len(list((group / "plots").glob("*.svg"))), 1)

    def test_an_outlier_is_named(self):
        table = self.cohort(12)
        ball(self.folder / "ball_3.nrrd", 11.4)
        for i in range(12):
            if i != 3:
                ball(self.folder / f"ball_{i}.nrrd", 5 + 0.01 * i)
        self.participants(table, "out")
        told = json.loads((self.group(table, "out") / "summary.json").read_text())
        volume = next(each for each in told["measurements"] if each["quantity"] == "volume")
        self.assertEqual([each["subject"] for each in volume["outliers"]], ["0003"])
        columns = page_data(self.folder / "out/group/index.html")["columns"]
        shown = next(each for each in columns if each["name"] == "size.volume")
        self.assertEqual(shown["summary"], volume)
        self.assertEqual(shown["unit"], "mm³")

    def test_failures_are_listed_with_their_reason(self):
        table = self.cohort(4)
        (self.folder / "ball_1.nrrd").unlink()
        (self.folder / "ball_2.nrrd").write_bytes(b"no scan")
        run = self.participants(table, "out", check=False)
        self.assertEqual(run.returncode, 2)
        self.assertIn("0001: ", run.stderr)
        group = self.group(table, "out")
        told = {row["subject"]: row for row in rows(group / "subjects.csv")}
        self.assertEqual([told[f"{i:04d}"]["state"] for i in range(4)], ["done", "failed", "failed", "done"])
        self.assertIn("ball_1.nrrd", told["0001"]["reason"])
        self.assertIn("ball_2.nrrd", told["0002"]["reason"])
        self.assertEqual({row["subject"] for row in rows(group / "measurements.csv")}, {"0000", "0003"})
        self.assertIn("ball_1.nrrd", (group / "index.html").read_text())

    def test_a_report_lies_in_the_subjects_folder(self):
        table = self.cohort(2)
        plan = json.loads(self.plan.read_text())
        plan["steps"].append({"id": "surface", "do": "export", "object": "ball", "path": "pieces/ball.stl"})
        self.plan.write_text(json.dumps(plan))
        for more in ((), ("--again",)):
            run = subprocess.run([PROGRAM, "cohort", table, self.folder / "out", "participant", "--plan", self.plan,
                                  "--reports", *more], capture_output=True, text=True, check=False, timeout=120)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assert_no_leftovers("out")
            for i in range(2):
                subject = self.folder / f"out/sub-{i:04d}"
                volume = next(row["value"] for row in rows(subject / "rows.csv") if row["quantity"] == "volume")
                told = json.loads((subject / "report/result.json").read_text())
                self.assertEqual(told, json.loads((subject / "result.json").read_text()))
                self.assertEqual(float(volume), told["measurements"][0]["volume"]["value"])
                self.assertIn("<h1", (subject / "report/report.html").read_text())
                self.assertEqual(next(each["path"] for each in told["exports"]), "pieces/ball.stl")
                listed = {line[66:] for line in (subject / ".octotomy-result").read_text().splitlines()}
                for name in ("report.html", "pieces/ball.stl", "views/after_anterior.png", "tables/measurements.csv"):
                    self.assertTrue((subject / "report" / name).stat().st_size > 0, name)
                    self.assertIn(f"report/{name}", listed)
        self.participants(table, "out", "--again")
        self.assertFalse((self.folder / "out/sub-0000/report").exists())

    def assert_refused(self, run, *words):
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        for word in words:
            self.assertIn(word, run.stderr)

    def contents(self, folder):
        return {path: path.read_bytes() for path in (self.folder / folder).rglob("*") if path.is_file()}

    def test_a_folder_with_files_of_somebody_else_is_refused_before_anything_is_written(self):
        table = self.cohort(2)
        ours = json.dumps({"Name": "x", "GeneratedBy": [{"Name": "octotomy"}]})
        for name, text, word in (("dataset_description.json", '{"Name": "my scans"}', "describes a dataset"),
                                 ("dataset_description.json", "no JSON", "describes a dataset"),
                                 ("dataset_description.json", '{"GeneratedBy": [7, {"Name": 7}, {}]}', "describes a"),
                                 ("code/plan.plan.json", "mine", "is not Octotomy's"),
                                 ("code/octotomy.sha256", "mine", "is not Octotomy's"),
                                 ("sub-0001/anat/scan.txt", "mine", "is not a result"),
                                 ("sub-0001", "mine", "is not a result")):
            with self.subTest(name=name, text=text):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                path = self.folder / "out" / name
                path.parent.mkdir(parents=True)
                path.write_text(text)
                before = self.contents("out")
                self.assert_refused(self.participants(table, "out", check=False), word, "choose another OUT")
                self.assertEqual(self.contents("out"), before)
        for engine, name in (("parallel", "subjects.txt"), ("parallel", "parallel.log"), ("slurm", "subjects.txt"),
                             ("slurm", "participant.sbatch"), ("slurm", "group.sbatch"), ("slurm", "../group/mine")):
            with self.subTest(engine=engine, name=name):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                path = self.folder / "out/code" / name
                path.parent.mkdir(parents=True)
                (self.folder / "out/group").mkdir(exist_ok=True)
                path.write_text("mine")
                before = self.contents("out")
                self.assert_refused(self.participants(table, "out", "--engine", engine, check=False),
                                    "group" if name == "../group/mine" else name,
                                    "choose another OUT")
                self.assertEqual(self.contents("out"), before)
        # One who describes the dataset further is left alone.
        shutil.rmtree(self.folder / "out")
        (self.folder / "out").mkdir()
        (self.folder / "out/dataset_description.json").write_text(ours)
        self.participants(table, "out")
        self.assertEqual((self.folder / "out/dataset_description.json").read_text(), ours)

    def test_a_plan_that_was_changed_in_the_folder_is_kept(self):
        table = self.cohort(1)
        self.participants(table, "out")
        kept = self.folder / "out/code/plan.plan.json"
        other = self.plan.read_text().replace('"low": 0', '"low": 100')
        mine = self.plan.read_text().replace('"low": 0', '"low": 50')
        kept.write_text(mine)
        octotomy_program("cohort", table, self.folder / "out", "participant")
        octotomy_program("cohort", table, self.folder / "out", "participant", "--plan", kept)
        self.plan.write_text(other)
        self.assert_refused(self.participants(table, "out", check=False), "plan.plan.json", "changed after")
        self.assertEqual(kept.read_text(), mine)
        kept.unlink()
        self.participants(table, "out")
        self.assertEqual(kept.read_text(), other)

    def test_a_folder_that_was_made_without_a_list_goes_on(self):
        table = self.cohort(2)
        self.participants(table, "out")
        description = self.folder / "out/dataset_description.json"
        version = json.loads(description.read_text())["GeneratedBy"][0]["Version"]
        for more in ((), ("--again",)):
            (self.folder / "out/code/octotomy.sha256").unlink()
            description.write_text(description.read_text().replace(version, "0.1"))
            before = (self.folder / "out/sub-0000/rows.csv").read_bytes()
            self.plan.write_text(self.plan.read_text().replace('"low": ', '"low": 1'))
            self.participants(table, "out", *more)
            self.assertNotEqual((self.folder / "out/sub-0000/rows.csv").read_bytes(), before)
            self.assertEqual((self.folder / "out/code/plan.plan.json").read_text(), self.plan.read_text())
            self.assertIn(version, description.read_text())
        self.group(table, "out")

    def test_one_that_never_ran_is_listed(self):
        table = self.cohort(3)
        self.participants(table, "out", "--participant-label", "0000", "sub-0002")
        octotomy_program("cohort", table, self.folder / "out", "group", "--plan", self.plan)
        told = [row["state"] for row in rows(self.folder / "out/group/subjects.csv")]
        self.assertEqual(told, ["done", "missing", "done"])

    def test_what_is_done_is_kept_until_scan_or_plan_changes(self):
        table = self.cohort(3)
        self.participants(table, "out")
        before = (self.folder / "out/sub-0001/subject.json").read_bytes()
        self.participants(table, "out")
        self.assertEqual((self.folder / "out/sub-0001/subject.json").read_bytes(), before)
        ball(self.folder / "ball_1.nrrd", 8.0)
        self.participants(table, "out")
        kept = {i: (self.folder / f"out/sub-000{i}/rows.csv").read_bytes() for i in range(3)}
        self.assertNotEqual((self.folder / "out/sub-0001/subject.json").read_bytes(), before)
        self.plan.write_text(self.plan.read_text().replace('"low": 0', '"low": 100'))
        self.participants(table, "out")
        for i in range(3):
            self.assertNotEqual((self.folder / f"out/sub-000{i}/rows.csv").read_bytes(), kept[i])

    def test_killed_workers_leave_a_table_that_can_be_completed(self):
        table = self.cohort()
        begun = time.monotonic()
        self.participants(table, "whole")
        longest = (time.monotonic() - begun) / 2
        whole = (self.group(table, "whole") / "measurements.csv").read_bytes()
        random.seed(5)
        kills = 0
        command = [PROGRAM, "cohort", str(table), str(self.folder / "out"), "participant", "--plan", str(self.plan)]
        for _ in range(SUBJECTS):
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                       start_new_session=True)
            time.sleep(random.uniform(0, longest))
            if process.poll() is None:
                kills += 1
                os.killpg(process.pid, 9)
            elif kills == 0:  # it was too quick
                shutil.rmtree(self.folder / "out")
                longest /= 4
            process.wait()
        self.assertGreater(kills, 0)
        self.participants(table, "out")
        self.assertEqual((self.group(table, "out") / "measurements.csv").read_bytes(), whole)
        self.assert_no_leftovers("out")

    @unittest.skipUnless(os.geteuid() == 0, "a small disk (tmpfs) needs root")
    def test_a_full_disk_leaves_a_table_that_can_be_completed(self):
        table, out = self.cohort(5), self.folder / "out"
        self.participants(table, "whole")
        self.group(table, "whole")
        one = sum(path.stat().st_blocks * 512 for path in (self.folder / "whole/sub-0000").rglob("*"))
        out.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={3 * one}", "none", out], capture_output=True,
                                 check=False)
        if mounted.returncode != 0:
            self.skipTest("no small disk can be mounted here")
        try:
            run = self.participants(table, "out", check=False)
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertRegex(run.stderr, "No space left|of disk")
            self.assertTrue(0 < len(list(out.glob("sub-*/result.json"))) < 5)
            # A subject that failed frees its room, so that a later and smaller one may have succeeded.
            disk = os.statvfs(out)
            used = (disk.f_blocks - disk.f_bfree) * disk.f_frsize
            subprocess.run(["mount", "-o", f"remount,size={used + one // 8}", out], check=True)
            missing = next(label for label in (f"{i:04}" for i in range(5)) if not (out / f"sub-{label}/result.json").exists())
            alone = self.participants(table, "out", "--participant-label", missing, check=False)
            self.assertEqual(alone.returncode, 3, alone.stderr)
            subprocess.run(["mount", "-o", f"remount,size={100 * one}", out], check=True)
            self.participants(table, "out")
            self.group(table, "out")
            assert_complete(self, out, self.folder / "whole", 5)
            self.assert_no_leftovers("out")
        finally:
            subprocess.run(["umount", out], check=True)

    def test_twice_at_once_is_once(self):
        table = self.cohort()
        self.participants(table, "whole")
        whole = (self.group(table, "whole") / "measurements.csv").read_bytes()
        command = [PROGRAM, "cohort", str(table), str(self.folder / "out"), "participant", "--plan", str(self.plan)]
        twins = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for _ in range(3)]
        for twin in twins:
            _, errors = twin.communicate()
            self.assertIn(twin.returncode, (0, 2), errors)
        self.participants(table, "out")
        self.assertEqual((self.group(table, "out") / "measurements.csv").read_bytes(), whole)
        self.assert_no_leftovers("out")

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed (apt-get install parallel)")
    def test_gnu_parallel_makes_the_same_table_though_workers_are_killed(self):
        table, out = self.cohort(), self.folder / "out"
        self.participants(table, "whole")
        self.group(table, "whole")
        command = [PROGRAM, "cohort", table, out, "participant", "--plan", self.plan, "--engine", "parallel", "--jobs", "2"]

        def begin():
            engine = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            return lambda: engine.poll() is None

        kills = kill_at_random(out, begin, 11)
        self.participants(table, "out", "--engine", "parallel", "--jobs", "2")
        self.group(table, "out")
        assert_complete(self, out, self.folder / "whole")
        print(f"GNU parallel: {SUBJECTS} subjects, {kills} workers killed")

    @unittest.skipUnless(shutil.which("snakemake"), "Snakemake is not installed (apt-get install snakemake)")
    def test_the_snakefile_of_the_page_makes_the_same_table_though_workers_are_killed(self):
        table, out = self.cohort(), self.folder / "out"
        self.participants(table, "whole")
        self.group(table, "whole")
        page = (Path(__file__).parents[3] / "planner/cohort/README.md").read_text()
        text = page.split("Snakemake:\n\n```\n")[1].split("```")[0]
        text = text.replace("octotomy cohort", f"{PROGRAM} cohort").replace("le_fort_i.plan.json", "ball.plan.json")
        text = text.replace("scans.csv out", f"scans.csv {out}")  # a name that no other test's workers have
        (self.folder / "Snakefile").write_text(text)
        table.write_text(table.read_text().replace("sub-", ""))
        command = ["snakemake", "--cores", "2", "--keep-going", "group"]
        engines = []

        def begin():
            engines.append(subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
            return lambda: engines[-1].poll() is None

        kills = kill_at_random(out, begin, 12)
        self.assertNotEqual(engines[-1].returncode, 0)
        subprocess.run(command, cwd=self.folder, check=True, capture_output=True)
        assert_complete(self, out, self.folder / "whole")
        print(f"Snakemake: {SUBJECTS} subjects, {kills} workers killed")

    def test_a_bids_folder_with_sessions_is_read(self):
        for subject, session in (("01", "1"), ("01", "2"), ("02", None)):
            folder = self.folder / f"bids/sub-{subject}" / (f"ses-{session}" if session else "") / "ct"
            folder.mkdir(parents=True)
            name = f"sub-{subject}" + (f"_ses-{session}" if session else "")
            ball(folder / f"{name}_ct.nii.gz", 6)
            ball(folder / f"{name}_T1w.nii.gz", 8)
        self.participants(self.folder / "bids", "out")
        told = rows(self.group(self.folder / "bids", "out") / "subjects.csv")
        self.assertEqual([(row["subject"], row["state"]) for row in told],
                         [("01_ses-1", "done"), ("01_ses-2", "done"), ("02", "done")])

    def test_two_observers_are_compared(self):
        table = self.cohort(4)
        self.participants(table, "one")
        self.plan.write_text(self.plan.read_text().replace('"low": 0', '"low": 200'))
        self.participants(table, "two")
        told = json.loads((self.group(table, "one", "--plan", self.plan, "--against", self.folder / "two") /
                           "summary.json").read_text())
        volume = next(each for each in told["measurements"] if each["quantity"] == "volume")
        first, second = ([float(row["value"]) for i in range(4)
                          for row in rows(self.folder / f"{name}/sub-000{i}/rows.csv") if row["quantity"] == "volume"]
                         for name in ("one", "two"))
        self.assertEqual(volume["observers"]["pairs"], 4)
        self.assertAlmostEqual(volume["observers"]["bias"], np.mean(np.subtract(second, first)))

    def test_a_dry_run_learns_from_what_is_done(self):
        table = self.cohort(6)
        told = json.loads(self.participants(table, "out", "--dry-run", "--json").stdout)
        self.assertIsNone(told["hours"])
        self.assertFalse((self.folder / "out").exists())
        self.participants(table, "out", "--participant-label", "0000", "0001", "0002")
        told = json.loads(self.participants(table, "out", "--dry-run", "--json", "--jobs", "2").stdout)
        self.assertEqual((told["to_do"], told["learnt_from"]), (3, 3))
        records = [json.loads((self.folder / f"out/sub-000{i}/subject.json").read_text()) for i in range(3)]
        self.assertGreater(told["hours"], 0)
        self.assertLess(told["hours"], 10 * sum(record["seconds"] for record in records) / 3600)
        self.assertGreater(told["peak_gb_a_job"], 0)

    def test_a_pipe_is_refused_at_once(self):
        table = self.cohort(1)
        self.participants(table, "out")
        pipe = self.folder / "pipe.csv"
        os.mkfifo(pipe)
        written = self.folder / "out/sub-0000/result.json"
        written.unlink()
        os.mkfifo(written)
        for arguments in (("cohort", pipe, self.folder / "out", "participant"), ("table", pipe, "-o", self.folder / "t.csv"),
                          ("table", written.parent, "-o", self.folder / "t.csv")):
            run = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False, timeout=60)
            self.assert_refused(run, "is a pipe or device")

    def test_an_answer_that_was_changed_is_named_and_not_merged(self):
        table = self.cohort(2)
        self.participants(table, "out")
        (self.folder / "out/sub-0001/result.json").write_text("mine")
        for more in ((), ("--again",)):
            run = self.participants(table, "out", *more, check=False)
            self.assertEqual(run.returncode, 2)
            self.assertIn("1 of 2 subjects done", run.stdout)
            self.assertIn("sub-0001/result.json: is not as Octotomy wrote it", run.stderr)
        run = octotomy_program("cohort", table, self.folder / "out", "group")
        self.assertIn("1 of 2 subjects merged", run.stdout)
        self.assertIn("sub-0001/result.json: is not as Octotomy wrote it", run.stderr)
        self.assertEqual({row["subject"] for row in rows(self.folder / "out/group/measurements.csv")}, {"0000"})

    def test_inputs_that_are_no_cohort_are_refused(self):
        table = self.cohort(2)
        for text, word in (("scan\na.nrrd\n", "participant_id"), ("participant_id\n1\n", "column 'ct'"),
                           ("participant_id,scan\n../x,a.nrrd\n", "no label"), ("participant_id,scan\n", "no row"),
                           ("participant_id,scan\n1,a\n1,b\n", "twice"), ('participant_id,scan\n"1,a\n', "quote")):
            table.write_text(text)
            run = self.participants(table, "out", check=False)
            self.assertEqual(run.returncode, 2, text)
            self.assertIn(word, run.stderr)
            self.assertEqual(run.stderr.count("\n"), 1)
        table.write_text("participant_id,scan\n0001,ball_1.nrrd\n")
        run = self.participants(table, "out", "--participant-label", "0002", check=False)
        self.assertEqual(run.returncode, 2)
        self.assertIn("did you mean '0001'", run.stderr)


if __name__ == "__main__":
    unittest.main()
