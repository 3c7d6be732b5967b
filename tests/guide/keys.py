#!/usr/bin/env python3
"""Writes docs/guide/keys.md, the reference of all keys, from the JSON Schemas that iiwasim prints.

tests/guide/keys.py target/release/iiwasim            compares the page with the schemas
tests/guide/keys.py target/release/iiwasim --renew    writes the page
"""

import json
import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs/guide/keys.md"

HEAD = """# All keys

Made from the JSON Schemas that `iiwasim schema` prints. A key in **bold** is required; keys that
are not listed are errors.
"""

DOCUMENTS = {
    "program": "Programs",
    "frames": "Files of frames",
    "profile": "Robot profiles",
    "scene": "Scenes",
}


def anchor(name):
    return name.lower()


def plain(number):
    return f"{number:.9f}".rstrip("0").rstrip(".") if 0 < abs(number) < 1e-3 else f"{number:g}"


def bounds(schema):
    low, high = schema.get("minimum"), schema.get("maximum")
    above, below = schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")
    low_text = (
        plain(low) if low is not None else f"above {plain(above)}" if above is not None else ""
    )
    high_text = (
        plain(high) if high is not None else f"below {plain(below)}" if below is not None else ""
    )
    if low_text and high_text:
        return f", {low_text} to {high_text}"
    if low_text:
        return f", {low_text}" if above is not None else f", {low_text} or more"
    return f", up to {high_text}" if high_text else ""


def lengths(schema):
    low, high = schema.get("minLength"), schema.get("maxLength")
    if low and high:
        return f", {low} to {high} characters"
    return f", up to {high} characters" if high else ""


def kind(schema):
    """Type of a value, in Markdown."""
    if not isinstance(schema, dict):
        return "anything"
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{anchor(name)})"
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return " or ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    for choice in ("anyOf", "oneOf"):
        if choice in schema and "properties" not in schema:
            kinds = [kind(option) for option in schema[choice] if option.get("type") != "null"]
            return " or ".join(dict.fromkeys(kinds))
    types = schema.get("type", "anything")
    types = [t for t in (types if isinstance(types, list) else [types]) if t != "null"]
    if types == ["array"]:
        low, high = schema.get("minItems"), schema.get("maxItems")
        of = kind(schema.get("items", {}))
        if low is not None and low == high:
            return (
                f"{low} {of.replace('number', 'numbers', 1)}"
                if of.startswith("number")
                else f"{low} times {of}"
            )
        count = f", {low or 0} to {high}" if high else f", at least {low}" if low else ""
        return f"list of {of}{count}"
    if types == ["object"]:
        of = schema.get("additionalProperties")
        return f"by name: {kind(of)}" if isinstance(of, dict) else "object"
    return " or ".join(types) + bounds(schema) + lengths(schema)


def cell(text):
    return re.sub(r"\s+", " ", text).replace("|", "\\|").strip()


def properties(schema):
    required = set(schema.get("required", []))
    lines = ["| key | value | meaning |", "|---|---|---|"]
    for name, value in sorted(
        schema["properties"].items(), key=lambda entry: (entry[0] not in required, entry[0])
    ):
        if value is False:
            continue
        shown = f"**`{name}`**" if name in required else f"`{name}`"
        meaning = value.get("description", "") if isinstance(value, dict) else ""
        if isinstance(value, dict) and value.get("default") not in (None, [], {}):
            meaning = f"{meaning} Default: `{json.dumps(value['default'])}`."
        lines.append(f"| {shown} | {cell(kind(value))} | {cell(meaning)} |")
    return lines


def section(schema):
    lines = [schema.get("description", ""), ""]
    options = schema.get("oneOf") or schema.get("anyOf") or []
    if "properties" in schema:
        lines += properties(schema)
    elif options and all("const" in option or "enum" in option for option in options):
        lines += ["| value | meaning |", "|---|---|"]
        lines += [
            f"| {cell(kind(option))} | {cell(option.get('description', ''))} |"
            for option in options
        ]
    elif options and all(len(option.get("properties", {})) == 1 for option in options):
        lines += ["One of", "", "| key | value | meaning |", "|---|---|---|"]
        for option in options:
            [(name, value)] = option["properties"].items()
            lines.append(
                f"| `{name}` | {cell(kind(value))} | {cell(option.get('description', ''))} |"
            )
    elif options and all("properties" in option for option in options):
        for option in options:
            lines += [option.get("description", ""), "", *properties(option), ""]
    elif options:
        lines += [
            f"- {kind(option)}{': ' + option['description'] if 'description' in option else ''}"
            for option in options
        ]
    else:
        lines.append(kind(schema))
    while lines and not lines[-1]:
        lines.pop()
    return [*lines, ""]


def page(binary):
    lines, seen = [HEAD], {}
    for name, title in DOCUMENTS.items():
        text = subprocess.run(
            [binary, "schema", name], check=True, capture_output=True, text=True
        ).stdout
        schema = json.loads(text)
        lines += [f"## {title}", "", *section(schema)]
        for part, definition in sorted(schema.get("$defs", {}).items()):
            # File formats share parts, with the same description.
            if part in seen:
                if seen[part] != definition:
                    sys.exit(f"the schemas of files differ in {part}")
                continue
            seen[part] = definition
            lines += [f"### {part}", "", *section(definition)]
    return "\n".join(lines)


def main():
    text = page(sys.argv[1])
    if "--renew" in sys.argv:
        PAGE.write_text(text, encoding="utf-8")
    elif PAGE.read_text(encoding="utf-8") != text:
        print(
            f"{PAGE.name} is not what the schemas say: tests/guide/keys.py BINARY --renew",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
