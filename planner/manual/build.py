# SPDX-License-Identifier: AGPL-3.0-or-later
"""build.py FOLDER: runs every page of the manual and writes it as HTML with the pictures of that run, and the reference."""
import re
import shutil
import sys
import tempfile
from pathlib import Path

import markdown
from reference import reference
from run_page import run_page

MANUAL = Path(__file__).parent
HTML = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>
<style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}img{{max-width:100%}}
pre{{background:#f3f3f3;padding:.8em;overflow-x:auto}}table{{border-collapse:collapse}}
td,th{{border:1px solid #ccc;padding:.2em .5em;text-align:left;vertical-align:top}}</style>
<nav>{links}</nav>{body}</html>
"""


def pages(manual=MANUAL):
    """The pages in the order in which the index names them, the index first."""
    index = manual / "index.md"
    names = dict.fromkeys(re.findall(r"\]\((\w+\.md)\)", index.read_text()))
    return [index, *(manual / name for name in names if name != "reference.md")]


def title_of(text):
    return text.splitlines()[0].removeprefix("# ")


def write_html(stem, text, site, manual=MANUAL):
    """Writes a page whose pictures are in the site already, as STEM_NAME."""
    links = [(page.stem, title_of(page.read_text())) for page in pages(manual)] + [("reference", "Reference")]
    nav = " | ".join(f'<a href="{to}.html">{title}</a>' for to, title in links)
    text = re.sub(r"(!\[[^]]*\]\()", rf"\g<1>{stem}_", text)
    text = re.sub(r"(\]\(\w+)\.md([#)])", r"\1.html\2", text)
    body = markdown.markdown(text, extensions=["fenced_code", "tables", "toc"])
    (site / f"{stem}.html").write_text(HTML.format(title=title_of(text), links=nav, body=body))


def build_page(page, site):
    """Runs a page and writes it with its pictures. Returns the number of its commands."""
    text = page.read_text()
    site.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        count = run_page(page, folder)
        for picture in re.findall(r"!\[[^]]*\]\(([^)]+)\)", text):
            shutil.copy(Path(folder) / picture, site / f"{page.stem}_{picture}")
    write_html(page.stem, text, site, page.parent)
    return count


def build_reference(site, manual=MANUAL):
    site.mkdir(parents=True, exist_ok=True)
    write_html("reference", reference().replace("\n", "\n\n[TOC]\n", 1), site, manual)


def main(site, manual=MANUAL):
    for page in pages(manual):
        build_page(page, site)
    build_reference(site, manual)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
