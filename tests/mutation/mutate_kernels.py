#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Changes one operator, index or bound of the Boolean sources at a time and asks whether a test sees it.

    tests/mutation/mutate_kernels.py BUILD [--count N] [--seed S] [--questions N] [--out FILE]

BUILD is a release build of all targets. Each mutant is compiled alone, with the build's own command, and linked
before the library that holds the true one, so the build stays as it is. It is caught where it does not compile
to a working program: a test of its kernel fails or crashes, or `verify --random` disagrees or does not end.
What is left is listed: each is either the same function by another text, or a hole in the tests. Writes
one JSON object; exit status 1 where less than 95 % are caught. Takes about a minute a mutant.
"""
import argparse
import json
import os
import pathlib
import random
import re
import shlex
import signal
import subprocess
import sys
import tempfile

# The tests of each source's own; verify --random is asked after them.
SOURCES = {
    "voxel/solid/combine.cpp": [("voxel_tests", "Combine*:Moved*:Octree*"), ("expression_tests", "SetIdentities*:Resampling*:CombineGrey*")],
    "voxel/solid/combine_grey.cpp": [("voxel_tests", "*Grey*:Combine*"), ("expression_tests", "Resampling*:CombineGrey*")],
    "voxel/solid/grey_owner.cpp": [("expression_tests", "GreyOwners*:CombineGrey*")],
    "voxel/solid/combine_shares.cpp": [("expression_tests", "CombineShares*")],
    "brep/boolean/boolean.cpp": [("brep_tests", "*Boolean*")],
    "brep/boolean/corefine.cpp": [("brep_tests", "*Boolean*")],
    "brep/mesh/intersecting_triangles.cpp": [("brep_tests", "IntersectingTriangles*:*Boolean*")],
    "brep/boolean/near_boolean.cpp": [("brep_tests", "*Boolean*")],
}
# What is looked for in a line of code, and what it becomes.
CHANGES = [
    (r" \+ 1\b", " - 1"), (r" - 1\b", " + 1"), (r" \+ (?=\w)", " - "), (r" - (?=\w)", " + "), (r" \* (?=\w)", " / "),
    (r" == ", " != "), (r" != ", " == "), (r" < ", " <= "), (r" > ", " >= "), (r" <= ", " < "), (r" >= ", " > "),
    (r" && ", " || "), (r" \|\| ", " && "), (r" & ", " | "), (r" \| ", " & "), (r" \^ ", " & "), (r"~(?=\w)", ""),
    (r" << ", " >> "), (r" >> ", " << "), (r"\btrue\b", "false"), (r"\bfalse\b", "true"),
    (r"(?<=[\[ (])0(?=[\];),])", "1"), (r"(?<=[\[ (])1(?=[\];),])", "0"), (r"\bmin\b(?=\()", "max"), (r"\bmax\b(?=\()", "min"),
    (r"\.full\b", ".some"), (r"\.some\b", ".full"), (r"Form::Full\b", "Form::Empty"), (r"Form::Empty\b", "Form::Full"),
    (r"State::Full\b", "State::Empty"), (r"State::Empty\b", "State::Full"), (r"\bof_a\b", "of_b"), (r"\ba_mm3\b", "b_mm3"),
]
# Lines that only set how fast, and statements that tell and do not decide, to the line that ends them.
PASSED_OVER = re.compile(r"^\s*(//|#|\*)|constexpr int parallel_height|prefetch_|template|using ")
TELLS = re.compile(r"std::string|findings|failure =|throw |tell_touching")


def mutants_of(root, path):
    lines = (root / path).read_text().split("\n")
    found = []
    telling = False
    for number, line in enumerate(lines):
        telling = telling or bool(TELLS.search(line))
        passed_over = telling or PASSED_OVER.search(line)
        telling = telling and not line.rstrip().endswith((";", "{", "}"))
        if passed_over:
            continue
        code = line.split(" //")[0]
        for pattern, into in CHANGES:
            for match in re.finditer(pattern, code):
                changed = code[: match.start()] + into + code[match.end():]
                found.append({"file": path, "line": number + 1, "was": line.strip(), "is": changed.strip(), "text": changed})
    return found


def command_for(build, target):
    """The last of ninja's commands for a target: it links or compiles it."""
    out = subprocess.run(["ninja", "-C", build, "-t", "commands", target], capture_output=True, text=True, check=True)
    return out.stdout.strip().split("\n")[-1]


def compile_command(build, path):
    folder, room, source = path.split("/")
    object_path = f"{folder}/{room}/CMakeFiles/octotomy_{folder}_{room}.dir/{source}.o"
    return command_for(build, object_path), object_path


def run(command, build, seconds):
    """The exit status; what has not ended by then is killed with all it started."""
    with subprocess.Popen(command, shell=True, cwd=build, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          start_new_session=True) as started:
        try:
            return started.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(started.pid, signal.SIGKILL)
            return "no end"


def linked_with(build, target, object_file, program):
    """The target's link command with the mutant's object first and another program as output."""
    command = command_for(build, target).removeprefix(": && ").removesuffix(" && :")
    words = shlex.split(command)
    at = words.index("-o")
    words[at + 1] = str(program)
    words.insert(at + 2, str(object_file))
    return shlex.join(words)


def questions_about(path, questions, folder):
    """Programs and their arguments, the quickest first."""
    tests = [(target, f"--gtest_brief=1 --gtest_fail_fast --gtest_filter='{names}'") for target, names in SOURCES[path]]
    return [*tests, ("octotomy", f"verify --random {questions} --failures {folder}/failures --json")]


def refuse_failing_tests(build, paths, questions):
    """Tests that fail without a mutant would catch every one."""
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            for name, arguments in questions_about(path, questions, folder):
                if run(f"{build}/{name} {arguments}", folder, 600) != 0:
                    sys.exit(f"{name} {arguments} fails on the true sources: mend that first")


def try_mutant(root, build, mutant, questions, folder):
    lines = (root / mutant["file"]).read_text().split("\n")
    lines[mutant["line"] - 1] = mutant["text"]
    source = folder / pathlib.Path(mutant["file"]).name
    source.write_text("\n".join(lines))
    object_file = folder / "mutant.o"
    command, object_path = compile_command(build, mutant["file"])
    command = command.replace(str(root / mutant["file"]), str(source)).replace(f"-o {object_path}", f"-o {object_file}")
    command = re.sub(r"-M[DTF]\S*( \S+\.o(\.d)?)?", "", command)
    # A step beyond an array is undefined and may change nothing: the library's own checks tell it.
    command = command.replace(" -c ", " -D_GLIBCXX_ASSERTIONS -c ")
    if run(command, build, 600) != 0:
        return "does not compile"
    for name, arguments in questions_about(mutant["file"], questions, folder):
        program = folder / name
        if run(linked_with(build, name, object_file, program), build, 600) != 0:
            raise RuntimeError(f"{name} does not link with a mutant of {mutant['file']}")
        status = run(f"{program} {arguments}", folder, 300)
        if status != 0:
            return f"caught by {name} ({status})"
    return "survived"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=0, help="mutants drawn; 0: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--questions", type=int, default=20, help="of verify --random")
    parser.add_argument("--only", default="", help="sources whose path holds this")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("mutation.json"))
    options = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parents[2]
    build = options.build.resolve()
    paths = [path for path in SOURCES if options.only in path]
    mutants = [m for path in paths for m in mutants_of(root, path)]
    if options.count:
        mutants = random.Random(options.seed).sample(mutants, min(options.count, len(mutants)))
    refuse_failing_tests(build, paths, options.questions)
    tried, survivors = [], []
    for number, mutant in enumerate(mutants):
        with tempfile.TemporaryDirectory() as folder:
            mutant["outcome"] = try_mutant(root, build, mutant, options.questions, pathlib.Path(folder))
        del mutant["text"]
        print(f"{number + 1}/{len(mutants)} {mutant['file']}:{mutant['line']} {mutant['outcome']}: {mutant['is']}",
              file=sys.stderr, flush=True)
        if mutant["outcome"] == "does not compile":
            continue
        tried.append(mutant)
        if mutant["outcome"] == "survived":
            survivors.append(mutant)
        share = 1 - len(survivors) / len(tried)
        options.out.write_text(json.dumps({"tried": len(tried), "caught": len(tried) - len(survivors), "share": share,
                                           "survivors": survivors, "mutants": tried}, indent=1))
    if not tried:
        sys.exit("no mutant compiled: nothing was tested")
    print(json.dumps({"tried": len(tried), "caught": len(tried) - len(survivors), "survivors": survivors}, indent=1))
    sys.exit(0 if len(survivors) <= 0.05 * len(tried) else 1)


if __name__ == "__main__":
    main()
