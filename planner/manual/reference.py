# SPDX-License-Identifier: AGPL-3.0-or-later
"""The manual's reference as Markdown, from what the program prints about itself: its schema of plans, its help and its
procedures. Nothing here names an operation, a field, a verb or an option."""
import json
import re
import subprocess

from run_page import environment

MAKES = {
    "object": "Operations that make objects",
    "tool": "Operations that make volumes which cut objects",
    "scan": "Operations that make scans of scans",
    "measurement": "Operations that measure",
    "file": "Operations that write files",
    "names": "Operations that name points and directions",
}


def output_of(*arguments):
    return subprocess.run(["octotomy", *arguments], env=environment(), text=True, stdout=subprocess.PIPE,
                          check=True).stdout


def listed(text, heading):
    """The names and sentences of the indented list below a heading."""
    block = re.search(rf"^{heading}:\n((?:  .*\n)+)", text, re.MULTILINE)
    return re.findall(r"^  ([a-z_]+) +(\S.*)$", block[1], re.MULTILINE) if block else []


def type_of(field):
    """'number', 'list of 3 numbers', 'one of a, b', ..."""
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if "enum" in field:
        return "one of " + ", ".join(f"`{word}`" for word in field["enum"])
    for key in ("oneOf", "anyOf"):
        if key in field:
            return " or ".join(dict.fromkeys(type_of(choice) for choice in field[key]))
    kind = field["type"]
    if not isinstance(kind, str):
        return " or ".join(kind)
    if kind != "array":
        return kind
    least, most = field.get("minItems"), field.get("maxItems")
    count = f" of {least}" if least == most and least else f" of {least} or more" if least else ""
    return f"list{count} ({type_of(field['items'])})"


def limits_of(field):
    """The range, unit and default of a field, or an empty text."""
    parts = []
    if "minimum" in field:
        parts.append(f"at least {field['minimum']:g}")
    if "exclusiveMinimum" in field:
        parts.append(f"more than {field['exclusiveMinimum']:g}")
    if "maximum" in field:
        parts.append(f"at most {field['maximum']:g}")
    if "default" in field:
        parts.append(f"default `{json.dumps(field['default'])}`")
    unit = f"in {field['x-unit']}" if "x-unit" in field else ""
    return "; ".join(part for part in [unit, *parts] if part)


def rows_of(schema, before=""):
    """A table row for each field, and for each field of those that are objects themselves."""
    rows = []
    for name, field in schema["properties"].items():
        if not before and name in ("id", "do"):
            continue
        need = " (needed)" if name in schema.get("required", []) else ""
        text = field.get("description", "").replace("|", "\\|")
        rows.append(f"| `{before}{name}`{need} | {type_of(field)} | {limits_of(field)} | {text} |")
        inner = field.get("items", field)
        if "properties" in inner:
            rows += rows_of(inner, f"{before}{name}.")
    return rows


def operations():
    """The schema of each operation by its name."""
    schema = json.loads(output_of("schema"))
    return {operation["title"]: operation for operation in schema["properties"]["steps"]["items"]["anyOf"]}


def operation_text(name, schema):
    moves = " It moves its object, so the report lists its movement." if schema.get("x-moves") else ""
    rows = "\n".join(rows_of(schema))
    examples = "\n".join(json.dumps(example, ensure_ascii=False) for example in schema.get("examples", []))
    return (f"### {name}\n\n{schema['description']}{moves}\n\n"
            f"| field | type | range | meaning |\n|---|---|---|---|\n{rows}\n\n```json\n{examples}\n```\n")


def verbs():
    """The words behind octotomy of each verb, those below another verb included."""
    names = []
    text = output_of("--help")
    for heading in re.findall(r"^([A-Z][^:\n]*):$", text, re.MULTILINE):
        for name, _ in listed(text, heading):
            below = [inner for inner, _ in listed(output_of(name, "--help"), "Subcommands")]
            names += [[name, inner] for inner in below] or [[name]]
    return names


def reference():
    """The page."""
    table = operations()
    kinds = dict.fromkeys(schema["x-makes"] for schema in table.values())
    text = ["# Reference\n",
            "Made from what the program prints about itself: `octotomy schema`, `octotomy procedure` and `--help`.\n",
            "A step of a plan is a JSON object. Each has an `id`, by which later steps name it, and `do`, the name of its "
            "operation. The tables list the further fields.\n"]
    for kind in sorted(kinds, key=list(MAKES).index):
        text.append(f"## {MAKES[kind]}\n")
        text += [operation_text(name, schema) for name, schema in sorted(table.items()) if schema["x-makes"] == kind]
    text.append("## Procedures\n")
    for line in output_of("procedure").splitlines():
        name, sentence = line.split(maxsplit=1)
        text.append(f"### {name}\n\n{sentence}\n\n```\n" + "\n".join(output_of("procedure", name).splitlines()[1:]) + "\n```\n")
    text.append("## Verbs\n\n```\n" + output_of("--help") + "```\n")
    text += [f"### octotomy {' '.join(verb)}\n\n```\n{output_of(*verb, '--help')}```\n" for verb in verbs()]
    return "\n".join(text)
