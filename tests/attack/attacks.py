#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""What strangers and accidents do to the program, case by case; prints the cases that get through.

  tests/attack/attacks.py build/release [--only WORD]
"""
import argparse
import gzip
import json
import os
import resource
import shutil
import signal
import stat
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

from subject import PLAN, Subject

CASES = []
TEXT_LIMIT = 1100  # bytes of a message


def case(work):
    CASES.append(work)
    return work


def limits_memory(work):
    work.limits_memory = True
    return work


def refused(ended, *words, status=2):
    """Why this is no refusal: the status, nothing on standard output, one bounded line that has the words."""
    if ended.status != status:
        return f"wanted status {status}: {ended}"
    if ended.out:
        return f"said {ended.out[:100]!r} on standard output"
    lines = [line for line in ended.errors.splitlines() if line]
    if len(lines) != 1 or not lines[0].startswith("octotomy: ") or len(lines[0].encode()) > TEXT_LIMIT:
        return f"not one bounded line: {len(lines)} lines, {len(ended.errors)} bytes: {ended.errors[:200]!r}"
    for word in words:
        if word not in lines[0]:
            return f"no word of {word!r}: {lines[0]!r}"
    return control_in(ended)


def control_in(ended):
    for text in (ended.out, ended.errors):
        if found := [symbol for symbol in text if (ord(symbol) < 32 and symbol not in "\n") or ord(symbol) == 127]:
            return f"sends {found[0]!r} to the terminal"
    return ""


def done(ended):
    return "" if ended.status == 0 else str(ended)


WRITERS = (
    ("mesh", "IN.nrrd", "--window", "300:", "-o", "OUT.stl"), ("convert", "IN.nrrd", "-o", "OUT.nrrd"),
    ("convert", "IN.nrrd", "-o", "OUT.nii.gz"), ("octree", "IN.nrrd", "--window", "300:", "-o", "OUT.octree"),
    ("tet", "IN.stl", "-o", "OUT.inp"), ("smooth", "IN.stl", "-o", "OUT.ply"),
    ("offset", "IN.stl", "--by", "1", "-o", "OUT.stl"), ("shell", "IN.stl", "--thickness", "2", "-o", "OUT.stl"),
    ("shadow", "IN.stl", "--direction", "0.2,1,0.1", "-o", "OUT.stl"),
    ("decimate", "IN.stl", "--faces", "100", "-o", "OUT.stl"), ("repair", "IN.stl", "--orient", "-o", "OUT.stl"),
    ("mirror", "IN.stl", "-o", "OUT.stl"), ("compare", "IN.stl", "IN.stl", "-o", "OUT.glb"),
    ("boolean", "IN.stl", "union", "IN.stl", "-o", "OUT.stl"),
    ("voxelise", "IN.stl", "--voxel", "2", "-o", "OUT.octree"),
    ("eval", "a", "--let", "a=IN.octree", "-o", "OUT.octree"),
    ("render", "IN.nrrd", "--window", "300:", "-o", "OUT.png"), ("slice", "IN.nrrd", "-o", "OUT.png"),
    ("prepare", "IN.nrrd", "--step", "gaussian=1", "-o", "OUT.nrrd"),
    ("segment", "IN.nrrd", "--window", "300:", "-o", "OUT.octree"),
    ("measure", "IN.stl", "--thickness", "-o", "OUT.ply"))


def words_of(writer, source, out):
    """A writer's command line: its input and the name of its output without extension, of which OUT stands for."""
    return [word.replace("IN.", source + ".") if not word.startswith("OUT") else out + word[3:] for word in writer]


@case
def bad_outputs_are_refused_before_the_work(subject):
    """The input is broken as well: whoever speaks of it has begun to work."""
    for kind in ("nrrd", "stl", "octree"):
        subject.write(f"broken.{kind}", b"\0broken")
    os.mkfifo(subject.folder / "pipe")
    found = []
    for writer in WRITERS:
        extension = writer[-1][3:]
        pipe = subject.folder / f"pipe{extension}"
        if not pipe.exists():
            os.mkfifo(pipe)
        for out in ("nowhere/x", "a" * 250 + "b", "/proc/x", "pipe"):
            ended = subject.run(*words_of(writer, "broken", out), most_s=20)
            if why := refused(ended, out[:20]):
                found.append(f"{writer[0]} to {out[:20]}{extension}: {why}")
    for verb in (("run", "PLAN", "-o"), ("look", "broken.nrrd", "-o"), ("verify", "PLAN", "--report")):
        subject.write("broken.json", json.dumps(dict(PLAN, scans={"ct": {"path": "broken.nrrd"}})))
        for out in ("/proc/x", "a" * 250 + "b", "pipe", "pipe/x"):
            ended = subject.run(*[word.replace("PLAN", "broken.json") for word in verb], out, most_s=20)
            if why := refused(ended, out[:20]):
                found.append(f"{verb[0]} to {out[:20]}: {why}")
    return found


@case
def links_are_followed_and_modes_kept(subject):
    found = []
    for writer in WRITERS:
        extension = writer[-1][3:]
        away = subject.folder / "away"
        away.mkdir(exist_ok=True)
        target, link = away / f"target{extension}", subject.folder / f"link{extension}"
        target.write_text("older")
        target.chmod(0o640)
        link.unlink(missing_ok=True)
        link.symlink_to(f"away/target{extension}")
        source = "head" if writer[1] == "IN.nrrd" else "ball"
        ended = subject.run(*words_of(writer, source, "link"))
        if ended.status != 0:
            found.append(f"{writer[0]}: {ended}")
        elif not link.is_symlink() or target.read_bytes() == b"older":
            found.append(f"{writer[0]}: the link was replaced, not what it leads to")
        elif stat.S_IMODE(target.stat().st_mode) != 0o640:
            found.append(f"{writer[0]}: the mode became {stat.S_IMODE(target.stat().st_mode):o}")
    return found


@case
def scans_and_plans_are_regular_files(subject):
    found = []
    for kind in (".nrrd", ".nii", ".nii.gz", ".mha", ".dcm", ".tif", ".png", ".stl", ".ply", ".vtp", ".octree", ".raw"):
        pipe = subject.folder / f"waits{kind}"
        os.mkfifo(pipe)
        more = ("--raw", "4x4x4", "int16", "--spacing", "1,1,1") if kind == ".raw" else ()
        if why := refused(subject.run("info", pipe.name, *more, most_s=10), "waits"):
            found.append(f"info of a pipe {kind}: {why}")
    os.mkfifo(subject.folder / "waits.json")
    subject.write("waiting.json", json.dumps(dict(PLAN, scans={"ct": {"path": "waits.nrrd"}})))
    for arguments in (("run", "waits.json", "-o", "x"), ("run", "/dev/zero", "-o", "x"), ("info", "/dev/zero"),
                      ("run", "waiting.json", "-o", "x"), ("info", "/dev/null"), ("run", ".", "-o", "x"),
                      ("run", "plan.json", "--scan", "ct=/dev/zero", "-o", "x"),
                      ("mask", "--region", "anterior:waits.json", "-o", "m.octree"),
                      ("render", "head.nrrd", "--shading", "composite", "--transfer", "waits.json", "-o", "p.png"),
                      ("register", "ball.stl", "ball.stl", "--landmarks", "waits.json", "waits.json"),
                      ("warp", "ball.stl", "--result", "waits.json", "-o", "w.stl")):
        if why := refused(subject.run(*arguments, most_s=10)):
            found.append(f"{' '.join(arguments)}: {why}")
    (subject.folder / "slices").mkdir()
    os.mkfifo(subject.folder / "slices/one.dcm")
    if why := refused(subject.run("info", "slices", most_s=10)):
        found.append(f"a folder with a pipe: {why}")
    return found


@case
def a_full_standard_output_is_status_three(subject):
    found = []
    for arguments in (("--help",), ("--version",), ("schema",), ("info", "head.nrrd"), ("info", "head.nrrd", "--json"),
                      ("mesh", "--help"), ("--manual", "man"), ("measure", "head.nrrd", "--window", "300:")):
        with open("/dev/full", "wb") as full:
            ended = subject.run(*arguments, out=full)
        if why := refused(ended, "standard output", status=3):
            found.append(f"{' '.join(arguments)}: {why}")
    return found


@case
def a_limit_on_the_size_of_files_is_a_full_disk(subject):
    """Less is allowed than the answer takes: status 3, the older answer whole, nothing left over."""
    found, limited = [], 0
    verbs = [(list(words_of(writer, "head" if writer[1] == "IN.nrrd" else "ball", "limited")), None)
             for writer in WRITERS]
    verbs += [(["run", "plan.json", "-o", "result"], "result"), (["look", "head.nrrd", "-o", "looked"], "looked"),
              (["convert", "head.nrrd", "-o", "series"], "series"), (["convert", "head.nrrd", "-o", "limited.nii"], None),
              (["convert", "head.nrrd", "-o", "limited.mha"], None),
              (["octree", "ball.octree", "--as", "linear", "-o", "limited.txt"], None)]
    for arguments, folder in verbs:
        for most in (0, 1000, 20000):
            older = subject.folder / arguments[-1]
            if not folder:
                older.write_text("older")
            ended = subject.run(*arguments, most_s=60,
                                before=lambda most=most: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
            limited += ended.status == 3
            why = refused(ended, "ulimit -f", status=3) if ended.status else ""
            if not why and ended.status and (older.exists() if folder else older.read_text() != "older"):
                why = "the older answer is not whole"
            if hidden := subject.hidden_left():
                why = why or f"left {hidden}"
            if folder:
                shutil.rmtree(older, ignore_errors=True)
            if why:
                found.append(f"{' '.join(arguments)} in {most} bytes: {why}")
    return found or (["no limit was met"] if limited < len(verbs) else [])


@case
def a_closed_terminal_ends_it_unless_that_is_ignored(subject):
    """SIGHUP ends a run as SIGTERM does; under nohup the run goes on to its end, and so does its mesher."""
    found = []
    verb = ("run", "plan.json", "-o", "result")
    seconds = subject.need(*verb).seconds
    shutil.rmtree(subject.folder / "result")
    statuses = []
    for share in (0.3, 0.5, 0.7):
        ended = subject.run(*verb, after=share * seconds, stop=signal.SIGHUP, most_s=60)
        statuses.append(ended.status)
        if ended.status and (why := refused(ended, status=3)):
            found.append(why)
        if subject.hidden_left() or subject.children_left():
            found.append(f"left {subject.hidden_left()}, {subject.children_left()}")
        shutil.rmtree(subject.folder / "result", ignore_errors=True)
    if 3 not in statuses:
        found.append(f"never ended by it: {statuses}")
    for signal_number in (signal.SIGHUP, signal.SIGXCPU):
        for share in (0.3, 0.7):
            ended = subject.run(*verb, after=share * seconds, stop=signal_number, most_s=60,
                                before=lambda number=signal_number: signal.signal(number, signal.SIG_IGN))
            if why := done(ended):
                found.append(f"{signal_number.name} ignored: {why}")
    return found


@case
def names_that_are_not_utf8_work(subject):
    found = []
    name, made = b"caf\xe9 \x1b[31m\n", b"caf\xe9 "
    scan, mesh = name + b".nrrd", made + b".stl"
    (Path(os.fsencode(subject.folder).decode(errors="surrogateescape")) / os.fsdecode(scan)).write_bytes(
        (subject.folder / "head.nrrd").read_bytes())
    for arguments in (("info", scan), ("info", scan, "--json"), ("mesh", scan, "--window", "300:", "-o", mesh),
                      ("mesh", scan, "--window", "300:", "-o", mesh, "--json"), ("info", mesh), ("info", mesh, "--json"),
                      ("octree", scan, "--window", "300:", "-o", made + b".octree", "--json"),
                      ("look", scan, "-o", made + b"looked", "--json"),
                      ("run", "plan.json", "--scan", b"ct=" + scan, "-o", made + b"out", "--json")):
        ended = subject.run(*arguments)
        why = done(ended) or control_in(ended)
        if not why and "--json" in arguments:
            json.loads(ended.out)
        if why:
            found.append(f"{arguments}: {why}")
    return found


@case
def outputs_are_named_without_controls(subject):
    found = []
    for arguments in (("mesh", "head.nrrd", "--window", "300:", "-o", "a\nb.stl"), ("look", "head.nrrd", "-o", "\x1b[2Jlooked"),
                      ("convert", "head.nrrd", "-o", "a\tb.nii.gz"), ("run", "plan.json", "-o", "a\rb")):
        ended = subject.run(*arguments)
        if ended.status != 2 or control_in(ended):
            found.append(f"{arguments}: status {ended.status}")
    return found


@case
def messages_are_one_bounded_line_without_controls(subject):
    found = []
    long = "x" * 200000
    evil = "\x1b]0;owned\x07\x1b[2J\r\n\0"
    plans = {
        "a key": dict(PLAN, **{long: 1}), "an evil key": dict(PLAN, **{evil: 1}), "a name": dict(PLAN, name=7),
        "an id": dict(PLAN, steps=[{"id": evil, "do": "window", "scan": "ct", "low": 300}]),
        "a verb": dict(PLAN, steps=[{"id": "a", "do": long, "scan": "ct"}]),
        "an expression": dict(PLAN, steps=PLAN["steps"][:1] + [{"id": "b", "do": "combine", "expression": evil}]),
        "a long expression": dict(PLAN, steps=PLAN["steps"][:1] + [{"id": "b", "do": "combine", "expression": long}]),
        "a path": dict(PLAN, scans={"ct": {"path": "head.nrrd\0.txt"}}),
        "an export": dict(PLAN, steps=PLAN["steps"][:1] + [
            {"id": "e", "do": "export", "object": "skull", "path": evil + ".stl"}]),
        "an export with NUL": dict(PLAN, steps=PLAN["steps"][:1] + [
            {"id": "e", "do": "export", "object": "skull", "path": "a\0b.stl"}]),
        "a long export": dict(PLAN, steps=PLAN["steps"][:1] + [
            {"id": "e", "do": "export", "object": "skull", "path": "a" * 300 + ".stl"}]),
        "an export on the report": dict(PLAN, steps=PLAN["steps"][:1] + [
            {"id": "e", "do": "export", "object": "skull", "path": ".octotomy-result"}])}
    for what, plan in plans.items():
        subject.write("evil.json", json.dumps(plan))
        if why := refused(subject.run("run", "evil.json", "-o", "evil")):
            found.append(f"{what}: {why}")
    for arguments in (("info", long), ("info", evil.replace("\0", "")), ("mesh", "head.nrrd", "--window", long),
                      ("eval", long, "--let", "a=ball.octree", "-o", "e.octree"), (evil.replace("\0", ""),),
                      ("render", "head.nrrd", "--view", evil.replace("\0", ""), "-o", "p.png")):
        if why := refused(subject.run(*(argument[:100000] for argument in arguments))):
            found.append(f"{arguments[0][:20]}: {why}")
    return found


def faults_at_the_ends_of_numbers(subject, *commands):
    """What goes wrong where the N of commands is a number at the end of what numbers can be."""
    found = []
    for arguments in commands:
        for number in ("1e308", "-1e308", "1e-308", "nan", "inf", "9223372036854775808", "-0", "1e400", "2147483648"):
            ended = subject.run(*(word.replace("N", number) for word in arguments), "--json", "--time-limit",
                                "3", most_s=30)
            if ended.status not in (0, 2, 3):
                found.append(f"{' '.join(arguments)} with {number}: {ended}")
            if ended.status == 0 and any(word in ended.out for word in ("nan", "inf,", "NaN", "Infinity")):
                found.append(f"{' '.join(arguments)} with {number}: says a number that is not finite")
    return found


@case
def numbers_at_their_ends_do_not_crash(subject):
    found = []
    points = [{"sample": -500, "colour": "#cc7a29", "per_mm": 0.0}, {"sample": 100, "colour": "#cc7a29", "per_mm": 0.1}]
    for key in ("sample", "per_mm"):
        for value in (1e308, -1e308, 1e-308):
            transfer = {"octotomy_transfer": 1, "points": [dict(points[0]), dict(points[1], **{key: value})]}
            subject.write("transfer.json", json.dumps(transfer))
            ended = subject.run("render", "head.nrrd", "--shading", "composite", "--transfer", "transfer.json",
                                "--size", "32x32", "-o", "p.png")
            if ended.status not in (0, 2):
                found.append(f"transfer {key} {value}: {ended}")
    return found + faults_at_the_ends_of_numbers(
        subject, ("mesh", "head.nrrd", "--window", "N:", "-o", "m.stl"), ("offset", "ball.stl", "--by", "N", "-o", "m.stl"),
        ("shell", "ball.stl", "--thickness", "N", "-o", "m.stl"),
        ("voxelise", "ball.stl", "--voxel", "N", "-o", "m.octree"),
        ("decimate", "ball.stl", "--faces", "N", "-o", "m.stl"),
        ("phantom", "sphere", "--radius", "N", "-o", "m.octree"),
        ("phantom", "sphere", "--voxels", "N", "-o", "m.octree"),
        ("phantom", "head", "--voxel", "N", "-o", "m.nrrd"),
        ("render", "head.nrrd", "--window", "300:", "--view", "N,N", "--size", "32x32", "-o", "p.png"),
        ("measure", "ball.stl", "--section", "N,0,0", "0,0,N"),
        ("saw", "ball.stl", "--line", "N,0,0", "1,N,0", "--direction", "0,0,1", "--depth", "N", "-o", "m.stl"),
        ("brush", "ball.stl", "--points", "N,0,0", "1,N,0", "--radius", "N", "-o", "m.stl"),
        ("tet", "ball.stl", "--max-edge", "N", "-o", "m.inp"))


@case
@limits_memory
def limits_at_their_ends_do_not_crash(subject):
    return faults_at_the_ends_of_numbers(subject, ("info", "head.nrrd", "--memory", "N"))


@case
def long_and_deep_expressions_neither_crash_nor_hang(subject):
    found = []
    expressions = {"long": " | ".join(["a"] * 50000), "mixed": " - ".join(["a", "b"] * 25000),
                   "deep": "(" * 100000 + "a" + ")" * 100000, "waves": "~" * 100000 + "a",
                   "operands": "|".join(f"move(a, m{i % 7})" for i in range(5000))}
    # Every operand is read at every face that the certificate looks at: of teeth, which have few.
    teeth = {"id": "skull", "do": "window", "scan": "ct", "low": 1200}
    for name, expression in expressions.items():
        steps = [teeth, {"id": "a", "do": "combine", "expression": "skull"},
                 {"id": "b", "do": "combine", "expression": "skull"},
                 {"id": "c", "do": "combine", "expression": expression}]
        subject.write("long.json", json.dumps(dict(PLAN, steps=steps)))
        ended = subject.run("run", "long.json", "-o", "long", most_s=400)
        # Voxels of 4 mm do not resolve teeth, which the certificate says: status 1.
        if ended.status not in (0, 1, 2):
            found.append(f"{name} in a plan: {ended}")
        subject.write("deep.json", "[" * 100000)
        if expression.count("(") <= 1 and name != "operands":
            argument = expression[:120000].rstrip(" |-ab") or "a"
            ended = subject.run("eval", argument, "--let", "a=ball.octree", "--let", "b=ball.octree", "-o", "e.octree")
            if ended.status not in (0, 2):
                found.append(f"{name} of eval: {ended}")
    for arguments in (("run", "deep.json", "-o", "d"), ("mask", "--region", "anterior:deep.json", "-o", "m.octree"),
                      ("render", "head.nrrd", "--shading", "composite", "--transfer", "deep.json", "-o", "p.png"),
                      ("register", "ball.stl", "ball.stl", "--landmarks", "deep.json", "deep.json")):
        if why := refused(subject.run(*arguments)):
            found.append(f"{arguments[0]}: {why}")
    return found


@case
@limits_memory
def a_limit_on_memory_is_respected(subject):
    # What fits neither into memory nor onto the disk is refused before it is read.
    subject.write("big.raw", b"")
    os.truncate(subject.folder / "big.raw", 1 << 43)
    ended = subject.run("measure", "big.raw", "--raw", "16384x16384x16384", "int16", "--spacing", "1,1,1", "--window", "1:",
                        "--memory", "1", most_s=60)
    found = [refused(ended, "GB of memory", "of disk", "--memory", "TMPDIR", status=3)]
    # What fits onto the disk needs no more memory than the limit.
    os.truncate(subject.folder / "big.raw", 1 << 30)
    ended = subject.run("octree", "big.raw", "--raw", "1024x1024x512", "int16", "--spacing", "1,1,1", "--window", "1:",
                        "--memory", "1", "-o", "big.octree", most_s=60)
    if ended.status != 0:
        found.append(f"octree of 1 GB in 1 GB: {ended}")
    for verb in (("look", "head.nrrd", "-o", "limited"), ("run", "plan.json", "-o", "limited"),
                 ("mesh", "head.nrrd", "--window", "300:", "-o", "limited.stl"),
                 ("tet", "ball.stl", "-o", "limited.inp")):
        sufficed = 0
        for tenths in range(10):
            limit = 0.02 * 1.3 ** tenths
            ended = subject.run(*verb, "--memory", f"{limit:.4f}", most_s=60)
            if ended.status != 0 and (why := refused(ended, "--memory", status=3)):
                found.append(f"{verb[0]} in {limit:.4f} GB: {why}")
            if subject.hidden_left():
                found.append(f"{verb[0]} in {limit:.4f} GB left {subject.hidden_left()}")
            sufficed += ended.status == 0
            if sufficed == 2:  # more than enough is no attack
                break
    return [why for why in found if why]


@case
def a_second_signal_ends_at_once(subject):
    """A reader that never reads holds the answer up; so does a device plan."""
    found = []
    read, write = os.pipe()
    process = subprocess.Popen([subject.program, "schema"], cwd=subject.folder, stdout=write, stderr=subprocess.PIPE)
    time.sleep(1.0)
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
    try:
        process.wait(timeout=60.0)
    except subprocess.TimeoutExpired:
        process.kill()
        found.append("a full pipe holds it for ever")
    os.close(read)
    os.close(write)
    return found


@case
def a_time_limit_holds_in_a_plan_of_a_million_steps(subject):
    steps = PLAN["steps"][:1] + [{"id": f"m{i}", "do": "measure", "object": "skull"} for i in range(1000000)]
    subject.write("million.json", json.dumps(dict(PLAN, steps=steps)))
    ended = subject.run("run", "million.json", "-o", "million", "--time-limit", "1.5", most_s=60)
    found = [refused(ended, "nothing was written", status=3)]
    if subject.hidden_left() or (subject.folder / "million").exists():
        found.append(f"left {subject.hidden_left()}")
    return [why for why in found if why]


@case
def helpers_that_others_may_change_are_not_started(subject):
    folder = subject.folder / "helpers"
    folder.mkdir(mode=0o755)
    shutil.copy(Path(subject.program).parent / "octotomy-tetgen", folder)
    helpers = {"OCTOTOMY_HELPERS": str(folder)}
    found = [done(subject.run("tet", "ball.stl", "--mesher", "tetgen", "-o", "t.inp", environment=helpers))]
    folder.chmod(0o777)
    found.append(refused(subject.run("tet", "ball.stl", "--mesher", "tetgen", "-o", "u.inp", environment=helpers),
                         "others may write", status=3))
    return [why for why in found if why]


@case
def what_users_run_is_hardened(subject):
    build = Path(subject.program).parent
    if not shutil.which("readelf") or "OCTOTOMY_HARDEN:BOOL=ON" not in (build / "CMakeCache.txt").read_text():
        return []
    found = []
    for name in ("octotomy", "octotomy-tetgen", "octotomy-mesh3", "octotomy-mesh3-labels", "octotomy_dicom_codec",
                 "octotomy_image_io.so"):
        text = subprocess.run(["readelf", "-dW", "--dyn-syms", build / name], capture_output=True, text=True,
                              check=True).stdout
        found += [f"{name}: no {sign}" for sign in ("NOW", "__stack_chk_fail") if sign not in text]
    return found


@case
@limits_memory
def little_packed_data_that_grows_does_not_fill_the_memory(subject):
    """A header of few samples before gigabytes of zeros, packed, and headers of many samples before nothing."""
    found = []
    zeros = zlib.compressobj(9, zlib.DEFLATED, 16 + zlib.MAX_WBITS)
    subject.need("convert", "head.nrrd", "-o", "head.nii")
    nifti = bytearray((subject.folder / "head.nii").read_bytes())
    bomb = zeros.compress(bytes(nifti))
    block = bytes(1 << 24)
    for _ in range(128):
        bomb += zeros.compress(block)
    subject.write("bomb.nii.gz", bomb + zeros.flush())
    head = b"NRRD0004\ntype: short\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\nencoding: gzip\nendian: little\n\n"
    subject.write("bomb.nrrd", head % (8, 8, 8) + bomb)
    subject.write("wide.nrrd", head % (4096, 4096, 4096) + gzip.compress(bytes(1 << 20)))
    nifti[40:56] = struct.pack("<8h", 3, 32767, 32767, 32767, 1, 1, 1, 1)
    subject.write("wide.nii", bytes(nifti))
    for name in ("bomb.nii.gz", "bomb.nrrd", "wide.nrrd", "wide.nii"):
        ended = subject.run("info", name, "--json", "--memory", "0.5", most_s=60)
        if ended.status not in (0, 2, 3) or (ended.status != 0 and refused(ended, name, status=ended.status)):
            found.append(f"{name}: {ended}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="the build folder that holds octotomy")
    parser.add_argument("--only", default="", help="cases whose name has this word")
    parser.add_argument("--sanitized", action="store_true",
                        help="the build is slow, and its shadow memory takes terabytes: no limits on memory")
    asked = parser.parse_args()
    Subject.patience = 10 if asked.sanitized else 1
    faults = 0
    for work in CASES:
        if asked.only not in work.__name__ or asked.sanitized and hasattr(work, "limits_memory"):
            continue
        with Subject(asked.build) as subject:
            found = work(subject) or []
        faults += len(found)
        print(f"{work.__name__.replace('_', ' ')}: {'held' if not found else str(len(found)) + ' got through'}")
        for why in found:
            print("  " + why[:600].encode(errors="replace").decode())
        sys.stdout.flush()
    print(f"{faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
