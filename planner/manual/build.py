# SPDX-License-Identifier: AGPL-3.0-or-later
"""build.py FOLDER: runs every page of the manual and writes it as HTML with the pictures of that run."""
import re
import shutil
import sys
import tempfile
from pathlib import Path

import markdown
from run_page import run_page

HTML = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>
<style>body{{font:16px/1.5 sans-serif;max-width:50em;margin:2em auto;padding:0 1em}}img{{max-width:100%}}
pre{{background:#f3f3f3;padding:.8em;overflow-x:auto}}</style>
<nav>{links}</nav>{body}</html>
"""


def main(site):
    pages = sorted(Path(__file__).parent.glob("*.md"))
    titles = {page.stem: page.read_text().splitlines()[0].removeprefix("# ") for page in pages}
    links = " | ".join(f'<a href="{stem}.html">{title}</a>' for stem, title in titles.items())
    site.mkdir(parents=True, exist_ok=True)
    for page in pages:
        text = page.read_text()
        with tempfile.TemporaryDirectory() as folder:
            run_page(page, folder)
            for picture in re.findall(r"!\[[^]]*\]\(([^)]+)\)", text):
                shutil.copy(Path(folder) / picture, site / f"{page.stem}_{picture}")
        text = re.sub(r"(!\[[^]]*\]\()", rf"\g<1>{page.stem}_", text)
        body = markdown.markdown(text, extensions=["fenced_code", "tables"])
        (site / f"{page.stem}.html").write_text(HTML.format(title=titles[page.stem], links=links, body=body))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
