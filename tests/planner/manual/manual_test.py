# SPDX-License-Identifier: AGPL-3.0-or-later
"""Every command and figure of the manual's pages, their links, their HTML, and spoiled pages that have to fail."""
import os
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[3]
MANUAL = ROOT / "planner/manual"
sys.path.insert(0, str(MANUAL))
from reference import operations, output_of, reference, verbs  # noqa: E402
from run_page import missing_programs, run_page  # noqa: E402

try:
    import build
except ImportError:  # python3-markdown is missing
    build = None

# Pages that only explain words, without a command.
WORDS = {"index.md", "glossary.md"}


def links(text):
    """What the links of a page lead to, without its blocks of code and its pictures."""
    return re.findall(r"(?<!!)\[[^]]*\]\(([^)#]+)", re.sub(r"```.*?```", "", text, flags=re.DOTALL))


class Pages(unittest.TestCase):
    def spoiled(self, text, message):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text(text)
            with self.assertRaisesRegex(AssertionError, message):
                run_page(page, folder)

    def assert_site_is_whole(self, site):
        """Each link leads to a page and each picture is there."""
        written = {page.name for page in site.glob("*.html")}
        for name in sorted(written):
            text = (site / name).read_text()
            for to in re.findall(r'href="([^"#]+)', text):
                self.assertIn(to, written, f"{name} links to it")
            for picture in re.findall(r'src="([^"]+)', text):
                self.assertTrue((site / picture).is_file(), f"{name} shows {picture}")
        return written

    def test_what_each_page_states_holds_and_its_html_is_whole(self):
        pages = sorted(MANUAL.glob("*.md"))
        self.assertGreater(len(pages), 10)
        skipped = []
        with tempfile.TemporaryDirectory() as site:
            for page in pages:
                with self.subTest(page.name):
                    if missing := missing_programs(page):
                        skipped.append(f"{page.name} needs {', '.join(missing)}")
                        continue
                    with tempfile.TemporaryDirectory() as folder:
                        count = build.build_page(page, Path(site)) if build else run_page(page, folder)
                    self.assertEqual(count > 0, page.name not in WORDS)
            if build and not skipped:
                build.build_reference(Path(site))
                written = self.assert_site_is_whole(Path(site))
                self.assertEqual(written, {f"{page.stem}.html" for page in pages} | {"reference.html"})
        if skipped:
            self.skipTest("; ".join(skipped))
        if not build:
            self.skipTest("HTML needs python3-markdown")

    @unittest.skipUnless(build, "needs python3-markdown")
    def test_build_writes_the_pages_of_the_index_the_reference_and_pictures(self):
        with tempfile.TemporaryDirectory() as folder:
            manual, site = Path(folder) / "manual", Path(folder) / "site"
            manual.mkdir()
            (manual / "index.md").write_text("# A manual\n\n- [Ball](ball.md)\n- [Reference](reference.md)\n")
            (manual / "ball.md").write_text(
                "# Ball\n\n```console\n$ octotomy phantom sphere --voxels 16 -o a.octree && octotomy render a.octree -o a.png\n"
                "```\n\n![A ball](a.png)\n\nBack to the [index](index.md).\n")
            build.main(site, manual)
            self.assertEqual(self.assert_site_is_whole(site), {"index.html", "ball.html", "reference.html"})
            self.assertTrue((site / "ball_a.png").is_file())
            (site / "ball_a.png").unlink()
            with self.assertRaisesRegex(AssertionError, "ball_a.png"):
                self.assert_site_is_whole(site)

    def test_the_index_leads_to_every_page_and_links_lead_somewhere(self):
        named = set(links((MANUAL / "index.md").read_text()))
        self.assertEqual(named, {page.name for page in MANUAL.glob("*.md")} - {"index.md"} | {"reference.md"})
        for page in [*MANUAL.glob("*.md"), ROOT / "README.md"]:
            for to in links(page.read_text()):
                if "://" not in to and to != "reference.md":
                    self.assertTrue((page.parent / to).exists(), f"{page.name} links to {to}")

    def test_the_reference_has_every_operation_field_procedure_and_verb(self):
        page = reference()
        table = operations()
        self.assertGreater(len(table), 40)
        for name, schema in table.items():
            section = page.split(f"\n### {name}\n")[1].split("\n### ")[0]
            self.assertIn(schema["description"], section)
            for field in set(schema["properties"]) - {"id", "do"}:
                self.assertIn(f"| `{field}`", section, name)
        for line in output_of("procedure").splitlines():
            self.assertIn(f"\n### {line.split()[0]}\n", page)
        self.assertGreater(len(verbs()), 40)
        for verb in verbs():
            self.assertIn(f"\n### octotomy {' '.join(verb)}\n", page)

    def test_the_readme_has_every_operation_and_no_other(self):
        section = (ROOT / "README.md").read_text().split("## Operations\n")[1].split("\n## ")[0]
        rows = [line.split("|")[2] for line in section.splitlines() if line.startswith("| ") and "`" in line]
        named = [name for row in rows for name in re.findall(r"`([a-z0-9_]+)`", row)]
        self.assertEqual(sorted(named), sorted(name for name in operations() if ", as " not in name))

    def test_the_five_minutes_and_the_plan_of_the_readme_hold(self):
        text = (ROOT / "README.md").read_text()
        five = text.split("## Five minutes\n")[1].split("\n## ")[0].replace("$ cd build/release\n", "")
        plan = text.split("```json\n")[1].split("```")[0]
        with tempfile.TemporaryDirectory() as root:
            folder = Path(root) / "build/release"
            folder.mkdir(parents=True)
            (folder / "octotomy").symlink_to(os.environ["OCTOTOMY_PROGRAM"])
            (Path(root) / "planner").mkdir()
            shutil.copy(ROOT / "planner/le_fort_i.plan.json", Path(root) / "planner")
            page = Path(root) / "page.md"
            page.write_text(f"{five}\n`plan.json`:\n\n```json\n{plan}```\n\n"
                            "```console\n$ ./octotomy preview plan.json advanced -o plan.png\nadvanced\n```\n")
            self.assertEqual(run_page(page, folder), 6)

    def test_a_page_with_a_wrong_statement_fails(self):
        self.spoiled("```console\n$ false\n```\n", "status 1")
        self.spoiled("```console\n$ echo 1 2 3\n3\n2\n```\n", "does not print '2'")
        self.spoiled("```console\n$ echo 41.9\n```\nIt is **42.9** mm.\n", "42.9")
        self.spoiled("```console\n$ touch a.png\n```\n![a](a.png)\n", "empty")
        self.spoiled("`a.csv`:\n\n```csv\n1,2\n```\n\n```console\n$ cat a.csv\n1,3\n```\n", "does not print '1,3'")


if __name__ == "__main__":
    unittest.main()
