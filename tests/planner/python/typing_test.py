# SPDX-License-Identifier: AGPL-3.0-or-later
"""The package is typed, and its types refuse what its functions refuse."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import octotomy

try:
    import mypy  # noqa: F401
except ImportError:
    mypy = None


def checked(*arguments):
    run = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir=/dev/null", *map(str, arguments)],
                         capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr


@unittest.skipIf(mypy is None, "mypy is not installed")
class Types(unittest.TestCase):
    def test_the_package_is_strict(self):
        status, said = checked(*sorted(Path(octotomy.__file__).parent.glob("*.py*")))
        self.assertEqual(status, 0, said)

    def test_a_wrong_field_is_found_without_running(self):
        with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
            file.write("import octotomy\n"
                       "plan = octotomy.Plan({'ct': 'a.nrrd'})\n"
                       "skull = plan.window('skull', scan='ct', low='bone')\n"
                       "plan.combine('x', expression=skull & skull)\n"
                       "plan.combine('y')\n")
            file.flush()
            status, said = checked(file.name)
        self.assertEqual(status, 1, said)
        self.assertIn(":3: error", said)
        self.assertIn(":5: error", said)
        self.assertIn("Found 2 errors", said)


class Table(unittest.TestCase):
    def test_every_operation_has_a_method_with_its_fields_told(self):
        operations = octotomy._kernel.plan_schema()["properties"]["steps"]["items"]["anyOf"]
        names = [each["title"] for each in operations if each["properties"]["do"]["const"] == each["title"]]
        self.assertGreater(len(names), 30)
        for each in operations:
            if each["title"] not in names:
                continue
            method = getattr(octotomy.Plan, each["title"], None) or getattr(octotomy.Plan, each["title"] + "_")
            for field in set(each["properties"]) - {"id", "do"}:
                self.assertIn(field, method.__doc__)
                self.assertIn(field, [name.rstrip("_") for name in method.__annotations__])

    def test_every_example_of_the_table_is_a_step_that_its_method_makes(self):
        operations = octotomy._kernel.plan_schema()["properties"]["steps"]["items"]["anyOf"]
        for each in operations:
            for example in each.get("examples", []):
                if each["properties"]["do"]["const"] != each["title"]:
                    continue
                plan = octotomy.Plan()
                method = getattr(plan, each["title"], None) or getattr(plan, each["title"] + "_")
                fields = {key: value for key, value in example.items() if key not in ("id", "do")}
                method(example["id"], **fields)
                self.assertEqual(plan.document["steps"], [example])


if __name__ == "__main__":
    unittest.main()
