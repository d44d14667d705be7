# SPDX-License-Identifier: AGPL-3.0-or-later
"""Runs the commands of one page of the manual in a fresh folder and checks what the page states.

    run_page.py PAGE.md FOLDER      octotomy is $OCTOTOMY_PROGRAM, else the one on PATH

- "`NAME`:" before a block of json, csv or python: the block is written as the file NAME.
- A console block: each line behind "$ " runs in bash and has to end with status 0. The lines below it are output that
  has to appear in this order; "..." stands for any text.
- A number in bold has to stand in the output of a command above it.
- A picture that the page shows is a file that the commands have written.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PARTS = re.compile(r"`([\w.]+)`:\n\n```(?:json|csv|python)\n(.*?)```|```console\n(.*?)```|\*\*([^*\n]*\d[^*\n]*)\*\*"
                   r"|!\[[^]]*\]\(([^)]+)\)", re.DOTALL)
# Programs of others that some pages run.
OTHERS = ["ccx"]


def plain(text):
    """With one blank between words: the program groups digits by narrow blanks."""
    return " ".join(text.split())


def missing_programs(page):
    """The programs of others that the page's commands need and that are not installed."""
    commands = "".join(part[2] for part in PARTS.findall(Path(page).read_text()))
    return [name for name in OTHERS if re.search(rf"\b{name}\b", commands) and not shutil.which(name)]


def environment():
    """With octotomy on PATH."""
    program = os.environ.get("OCTOTOMY_PROGRAM")
    path = (f"{Path(program).parent}:" if program else "") + os.environ["PATH"]
    return {**os.environ, "PATH": path}


def run(command, folder):
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment(), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise AssertionError(f"$ {command}\nended with status {done.returncode}:\n{done.stdout}")
    return plain(done.stdout)


def check_output(command, stated, output):
    at = 0
    for words in (plain(part) for line in stated for part in line.split("...")):
        found = output.find(words, at)
        if found < 0:
            raise AssertionError(f"$ {command}\ndoes not print '{words}' where the page states it, but:\n{output}")
        at = found + len(words)


def run_page(page, folder):
    """Returns the number of commands run; throws AssertionError for the first statement that does not hold."""
    count, outputs = 0, ""
    for name, text, console, figure, picture in PARTS.findall(Path(page).read_text()):
        if name:
            (Path(folder) / name).write_text(text)
        for block in re.split(r"^\$ ", console, flags=re.MULTILINE)[1:]:
            command, *stated = block.splitlines()
            output = run(command, folder)
            check_output(command, stated, output)
            outputs += " " + output
            count += 1
        if figure and plain(figure) not in outputs:
            raise AssertionError(f"{page}: '{figure}' stands in no output of the commands above it")
        if picture and (Path(folder) / picture).stat().st_size < 1000:
            raise AssertionError(f"{page}: the picture {picture} is empty")
    return count


if __name__ == "__main__":
    os.makedirs(sys.argv[2])
    print(run_page(sys.argv[1], sys.argv[2]), "commands")
