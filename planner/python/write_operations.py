#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Writes the methods of octotomy.Plan, one for each operation, from the JSON schema of plans.

write_operations.py SCHEMA.json OPERATIONS.py
"""
import json
import keyword
import sys
import textwrap

HEAD = '''# Written by write_operations.py from the table of operations.
"""The steps of plans: a method for each operation of the table."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .names import Name


class Operations:
    """A method for each operation. Each adds a step called `id` and returns its name; a field that is None
    keeps the table's default. Lengths are in mm, angles in degrees, points in LPS."""

    def add(self, do: str, id: str, **fields: Any) -> Name:
        """Adds a step of any operation."""
        raise NotImplementedError
'''


def type_of(field):
    """The type of a field's value in Python."""
    for word in ("anyOf", "oneOf"):
        if word in field:
            return " | ".join(dict.fromkeys(type_of(each) for each in field[word]))
    kind = field.get("type")
    if kind == "array":
        inner = field.get("items")
        return f"Sequence[{type_of(inner)}]" if isinstance(inner, dict) else "Sequence[Any]"
    if kind == "object":
        return "Mapping[str, Any]"
    return {"string": "str", "number": "float", "integer": "int", "boolean": "bool"}.get(kind, "Any")


def bounds(field):
    """The allowed numbers, the unit and the default, for people."""
    said = []
    for key, sign in (("minimum", "at least"), ("exclusiveMinimum", "above"), ("maximum", "at most"),
                      ("exclusiveMaximum", "below")):
        if key in field:
            said.append(f"{sign} {field[key]:g}")
    if "enum" in field:
        said.append("one of " + ", ".join(map(str, field["enum"])))
    if "default" in field:
        said.append("default " + json.dumps(field["default"], ensure_ascii=False))
    if "x-unit" in field:
        said.append("in " + field["x-unit"])
    return f" ({'; '.join(said)})" if said else ""


def wrapped(text, indent):
    """Lines of at most 100 columns."""
    return "\n".join(textwrap.wrap(text.replace("\\", "\\\\"), 100, initial_indent=indent,
                                   subsequent_indent=indent + "    "))


def method(operation):
    """One operation as a method."""
    required = set(operation["required"])
    fields = {name: field for name, field in operation["properties"].items() if name not in ("id", "do")}
    said = sorted(fields, key=lambda name: name not in required)
    name_of = {name: name + "_" if keyword.iskeyword(name) else name for name in [*said, operation["title"]]}
    arguments = ["self", "id: str"] + (["*"] if said else [])
    for name in said:
        kind = type_of(fields[name])
        arguments.append(f"{name_of[name]}: {kind}" if name in required else f"{name_of[name]}: {kind} | None = None")
    lines = [f"    def {name_of[operation['title']]}(", *(f"        {each}," for each in arguments), "    ) -> Name:"]
    lines.append(f'        """{operation["description"]}')
    if said:
        lines.append("")
        for name in said:
            text = f"{name_of[name]}: {fields[name].get('description', '')}{bounds(fields[name])}"
            lines.append(wrapped(text, " " * 8))
    lines.append('        """')
    passed = "".join(f', {name}={name_of[name]}' for name in said if name == name_of[name])
    odd = ", ".join(f'"{name}": {name_of[name]}' for name in said if name != name_of[name])
    passed += f", **{{{odd}}}" if odd else ""
    lines.append(f'        return self.add("{operation["title"]}", id{passed})')
    return "\n".join(lines)


def main():
    schema_path, out_path = sys.argv[1:]
    with open(schema_path, encoding="utf-8") as file:
        operations = json.load(file)["properties"]["steps"]["items"]["anyOf"]
    # A step "export" stands for another operation, as its path ends: that operation has a method of its own.
    operations = [each for each in operations if each["properties"]["do"]["const"] == each["title"]]
    with open(out_path, "w", encoding="utf-8") as file:
        file.write(HEAD)
        for operation in operations:
            file.write("\n" + method(operation) + "\n")


main()
