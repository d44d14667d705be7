#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Verbs on a disk that fills up at random places of their answer.

Each answer goes onto a small disk (tmpfs, which needs root) with less room than it takes. The verb ends with status
3 and one line, the older answer is whole, and nothing unfinished is left. Given enough room it ends with status 0.
Where the answer's least size is known before the work, the verb refuses with that size and the room that there is.

  tests/attack/full_disk_suite.py build/release --count 200
"""
import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

from kill_suite import VERBS
from subject import PLAN, Subject

DISK_BYTES = 48 << 20
NOT_THERE = 77  # ctest's word for a test that is skipped


def size_of(path):
    if path.is_file():
        return path.stat().st_size
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())


def on_disk(verb):
    return [f"disk/{word}" if word == verb.out else word for word in verb.arguments]


def end_on_full_disk(subject, verb, room):
    """Why the verb did not end as promised with `room` bytes free; and its status."""
    disk = subject.folder / "disk"
    older = disk / verb.out
    if verb.is_folder:
        shutil.copytree(subject.folder / verb.out, older)
    else:
        older.write_text("older")
    free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
    with open(disk / "filler", "wb") as filler:
        os.posix_fallocate(filler.fileno(), 0, max(1, free - room))
    ended = subject.run(*on_disk(verb))
    here, subject.folder = subject.folder, disk
    try:
        why = verb.broken(subject)
        hidden = [name for name in subject.hidden_left()]
    finally:
        subject.folder = here
    if hidden:
        why = why or f"left {hidden}"
    if ended.status not in (0, 3):
        why = why or str(ended)
    if ended.status == 3 and (ended.errors.count("octotomy: ") != 1 or ended.out):
        why = why or str(ended)
    for path in disk.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    return why, ended.status


ROOM = 1 << 16
DEFLATE = 1032  # bytes that deflate makes one of, at most

# Verbs whose answer has a least size that is known before the work: where the table has it, or else by what is written
# once there is room; and the room that the disk has, less than that.
REFUSED = (
    (("phantom", "head", "--voxel", "1", "-o", "disk/fine.nii"), 2 * 200 * 240 * 240, ROOM),
    (("convert", "head.nrrd", "-o", "disk/copy.nii"), 0, ROOM),
    (("convert", "head.nrrd", "-o", "disk/series"), 0, ROOM),
    (("mesh", "head.nrrd", "--window", "300:", "-o", "disk/head.stl"), 0, ROOM),
    (("mirror", "head.stl", "-o", "disk/mirrored.ply"), 0, ROOM),
    (("run", "map.plan.json", "-o", "disk/result"), 2 * 200 * 240 * 240 // DEFLATE, 1 << 12),
)


def end_refused(subject, arguments, least, room):
    """Why a verb did not refuse, before its work, an answer for which the disk has no room."""
    disk = subject.folder / "disk"
    free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
    with open(disk / "filler", "wb") as filler:
        os.posix_fallocate(filler.fileno(), 0, max(1, free - room))
    ended = subject.run(*arguments)
    (disk / "filler").unlink()
    told = re.search(r"writing it takes at least ([0-9.]+) (kB|MB|GB) of disk, ([0-9.]+) (bytes|kB)", ended.errors)
    if ended.status != 3 or told is None or any(disk.iterdir()):
        return f"{ended}, left {list(disk.iterdir())}"
    if float(told[3]) * {"bytes": 1, "kB": 1e3}[told[4]] > room + 50:
        return f"told {told[3]} {told[4]} of room, {room} bytes are free"
    size = float(told[1]) * {"kB": 1e3, "MB": 1e6, "GB": 1e9}[told[2]]
    # Given the room, the answer is no smaller than it was told to be.
    if least:
        return None if size >= 0.9 * least else f"told {size:.0f} bytes of {least}"
    subject.need(*arguments)
    written = size_of(disk / Path(arguments[-1]).name)
    for path in list(disk.iterdir()):
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    return None if 0.5 * written <= size <= 1.001 * written else f"told {size:.0f} bytes of {written}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="the build folder that holds octotomy")
    parser.add_argument("--count", type=int, default=200, help="full disks (default 200)")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    chance = random.Random(asked.seed)
    faults, statuses = 0, Counter()
    with Subject(asked.build) as subject:
        disk = subject.folder / "disk"
        disk.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "none", str(disk)]
        if subprocess.run(mount, stderr=subprocess.DEVNULL, check=False).returncode != 0:
            print("skipped: a small disk needs the right to mount one")
            return NOT_THERE
        try:
            for verb in VERBS:
                verb.lay_older(subject)
                verb.learn(subject)
            plan = dict(PLAN, universe={"voxel_mm": 1.0}, steps=[
                {"id": "skull", "do": "window", "scan": "ct", "low": 300},
                {"id": "map", "do": "export", "object": "skull", "path": "skull.nii.gz"}])
            subject.write("map.plan.json", json.dumps(plan))
            for arguments, least, room in REFUSED:
                why = end_refused(subject, arguments, least, room)
                if why:
                    faults += 1
                    print(f"  {' '.join(arguments)}: {why}")
            for number in range(asked.count):
                verb = VERBS[number % len(VERBS)]
                room = int(chance.uniform(0.0, 1.05) * size_of(subject.folder / verb.out))
                why, status = end_on_full_disk(subject, verb, room)
                statuses[status] += 1
                if why:
                    faults += 1
                    print(f"  number {number}, {verb.name} with {room} bytes free: {why}")
        finally:
            subprocess.run(["umount", str(disk)], check=False)
    print(f"{asked.count} full disks: {faults} faults, statuses {dict(sorted(statuses.items()))}")
    return 1 if faults or statuses[3] == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
