# SPDX-License-Identifier: AGPL-3.0-or-later
"""Every command and figure of the manual's pages, and spoiled pages that have to fail."""
import sys
import tempfile
import unittest
from pathlib import Path

MANUAL = Path(__file__).parents[3] / "planner/manual"
sys.path.insert(0, str(MANUAL))
from run_page import run_page  # noqa: E402


class Pages(unittest.TestCase):
    def spoiled(self, text, message):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text(text)
            with self.assertRaisesRegex(AssertionError, message):
                run_page(page, folder)

    def test_what_each_page_states_holds(self):
        pages = sorted(MANUAL.glob("*.md"))
        self.assertTrue(pages)
        for page in pages:
            with self.subTest(page.name), tempfile.TemporaryDirectory() as folder:
                self.assertGreater(run_page(page, folder), 0)

    def test_a_page_with_a_wrong_statement_fails(self):
        self.spoiled("```console\n$ false\n```\n", "status 1")
        self.spoiled("```console\n$ echo 1 2 3\n3\n2\n```\n", "does not print '2'")
        self.spoiled("```console\n$ echo 41.9\n```\nIt is **42.9** mm.\n", "42.9")
        self.spoiled("```console\n$ touch a.png\n```\n![a](a.png)\n", "empty")


if __name__ == "__main__":
    unittest.main()
