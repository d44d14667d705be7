# SPDX-License-Identifier: AGPL-3.0-or-later
"""The program under attack: how it is started, what it leaves behind, and sound files to work on."""
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

PLAN = {
    "octotomy_plan": 1, "name": "attacked", "scans": {"ct": {"path": "head.nrrd"}},
    "universe": {"voxel_mm": 4.0},
    "steps": [
        {"id": "skull", "do": "window", "scan": "ct", "low": 300},
        {"id": "cut", "do": "mask", "regions": [
            {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]},
            {"view": "left", "polygons_mm": [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]]}]},
        {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
        {"id": "piece", "do": "export", "object": "maxilla", "path": "maxilla.stl"},
        {"id": "map", "do": "export", "object": "skull", "path": "skull.nrrd"},
        {"id": "deck", "do": "export", "object": "maxilla", "path": "maxilla.inp"}]}


class Ended:
    """How a process ended: exit status or minus the signal, both streams, seconds, and seconds after the signal."""

    def __init__(self, process, out, errors, seconds, after_signal):
        self.status, self.out, self.errors = process.returncode, out, errors
        self.seconds, self.after_signal = seconds, after_signal

    def __str__(self):
        return f"status {self.status}, said {self.errors[-300:]!r}"


class Subject:
    """The program, with a folder of its own that is removed at the end."""

    sound = {}  # the files to work on, made by the first subject
    patience = 1  # of the seconds that a process may take

    def __init__(self, build):
        self.program = str(Path(build).resolve() / "octotomy")
        self.folder = Path(tempfile.mkdtemp(prefix="octotomy-attack-"))
        self.temporary = self.folder / "tmp"
        self.temporary.mkdir()
        if not Subject.sound:
            self.need("phantom", "head", "--voxel", "4", "-o", "head.nrrd")
            self.need("mesh", "head.nrrd", "--window", "300:", "-o", "head.stl")
            self.need("phantom", "sphere", "--voxels", "32", "--radius", "12", "-o", "ball.octree")
            self.need("mesh", "ball.octree", "-o", "ball.stl")
            for name in ("head.nrrd", "head.stl", "ball.octree", "ball.stl"):
                Subject.sound[name] = (self.folder / name).read_bytes()
        for name, content in Subject.sound.items():
            self.write(name, content)
        self.write("plan.json", json.dumps(PLAN))

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, name, content):
        data = content if isinstance(content, bytes) else content.encode()
        (self.folder / name).write_bytes(data)
        return name

    def run(self, *arguments, after=None, stop=signal.SIGKILL, out=subprocess.PIPE, most_s=120.0, cwd=None,
            environment=None, before=None):
        """Runs the program, after the function `before` in its process; sends `stop` `after` seconds. A process that
        ignores it is killed after most_s."""
        variables = dict(os.environ, TMPDIR=str(self.temporary), **(environment or {}))
        most_s *= Subject.patience
        start = time.monotonic()
        with subprocess.Popen([self.program, *arguments], stdin=subprocess.DEVNULL, stdout=out,
                              stderr=subprocess.PIPE, cwd=cwd or self.folder, env=variables,
                              start_new_session=True, preexec_fn=before) as process:
            signalled = None
            try:
                said, errors = process.communicate(timeout=after if after is not None else most_s)
            except subprocess.TimeoutExpired:
                signalled = time.monotonic()
                process.send_signal(stop if after is not None else signal.SIGKILL)
                try:
                    said, errors = process.communicate(timeout=most_s)
                except subprocess.TimeoutExpired:
                    process.kill()
                    said, errors = process.communicate()
            ended = time.monotonic()
            self.session = process.pid
            return Ended(process, (said or b"").decode(errors="replace"), errors.decode(errors="replace"),
                         ended - start, None if signalled is None else ended - signalled)

    def need(self, *arguments):
        ended = self.run(*arguments)
        if ended.status != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {ended}")
        return ended

    def children_left(self, wait_s=2.0):
        """Processes that the last run started and that outlive it; one that was just killed takes a moment."""
        end = time.monotonic() + wait_s
        while True:
            left = []
            for entry in Path("/proc").iterdir():
                if not entry.name.isdigit():
                    continue
                try:
                    words = (entry / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if int(words[3]) == self.session and words[0] not in "ZX":
                    left.append(int(entry.name))
            if not left or time.monotonic() > end:
                return left
            time.sleep(0.02)

    def hidden_left(self):
        """Unfinished folders and files, and temporary files."""
        left = [path.name for path in self.folder.iterdir()
                if path.name.startswith(".") or path.name.endswith((".part", "~"))]
        return left + [path.name for path in self.temporary.iterdir()]


def sha256(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def broken_list(folder):
    """Why a result folder is not whole by its own list; empty where it is."""
    listed = folder / ".octotomy-result"
    if not listed.exists():
        return f"{folder.name} has no list"
    count = 0
    for line in listed.read_text().splitlines():
        if line.startswith("#"):
            continue
        count += 1
        path = folder / line[66:]
        if not path.is_file() or sha256(path) != line[:64]:
            return f"{line[66:]} is missing or changed"
    return "" if count >= 2 else "the list is empty"
