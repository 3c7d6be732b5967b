#!/usr/bin/env python3
"""Values of the Java snippets, computed by a JVM.

Each file of snippets/ has snippets separated by empty lines. A snippet is an expression, or the
statements of a method, optionally preceded by members of its class and a line `--`. The last line
is its value: `=> int 5`.

    expected.py            writes the values
    expected.py --check    compares the values with the files

Needs `java` and `javac` of version 17 or newer. The test `snippets` of the crate iiwa-java compares
the values with its own.
"""

import difflib
import pathlib
import re
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).parent / "snippets"

MAIN = r"""
import java.util.*;
import java.util.concurrent.Callable;
import java.util.concurrent.atomic.*;
import java.util.function.*;
import java.util.stream.*;

public class Snippets {
    interface Snippet {
        Object run() throws Exception;
    }

    static String quoted(String text) {
        StringBuilder quoted = new StringBuilder();
        for (char c : text.toCharArray()) {
            if (c == '\\') {
                quoted.append("\\\\");
            } else if (c == '\n') {
                quoted.append("\\n");
            } else if (c < ' ' || c > '~') {
                quoted.append(String.format("\\u%04x", (int) c));
            } else {
                quoted.append(c);
            }
        }
        return quoted.toString();
    }

    static String shown(Object value) {
        if (value == null) {
            return "null";
        }
        if (value instanceof Character) {
            return "char " + (int) (Character) value;
        }
        String kind = value.getClass().getSimpleName();
        switch (kind) {
            case "Integer": kind = "int"; break;
            case "Long": case "Short": case "Byte": case "Float": case "Double": case "Boolean":
                kind = kind.toLowerCase(Locale.ROOT);
                break;
            case "String": break;
            default: kind = "object"; break;
        }
        return kind + " " + quoted(value.toString());
    }

    static void show(Snippet snippet) {
        String shown;
        try {
            shown = shown(snippet.run());
        } catch (Throwable thrown) {
            shown = "throws " + thrown.getClass().getSimpleName();
        }
        System.out.println(shown);
    }

    public static void main(String[] arguments) {
        Locale.setDefault(Locale.ROOT);
@CALLS@
    }
}
"""


def snippets(text):
    """The blocks of a file: its head comment, then the lines and the value of each snippet."""
    blocks = []
    for block in text.strip().split("\n\n"):
        lines = block.split("\n")
        value = lines.pop() if lines[-1].startswith("=> ") else None
        blocks.append((lines, value))
    return blocks


def source(number, lines):
    """The class of a snippet."""
    members = []
    if "--" in lines:
        at = lines.index("--")
        members, lines = lines[:at], lines[at + 1 :]
    if len(lines) == 1 and not lines[0].endswith((";", "}")):
        lines = [f"return {lines[0]};"]
    body = "\n".join(lines)
    return (
        f"class T{number} {{ static class S {{\n"
        + "\n".join(members)
        + f"\nstatic Object run() throws Exception {{\n{body}\n}} }} }}\n"
    )


def values(blocks):
    """The value of each snippet, from the JVM."""
    calls = "\n".join(f"        show(T{number}.S::run);" for number in range(len(blocks)))
    # All classes are in one file, for a single compilation.
    text = MAIN.replace("@CALLS@", calls)
    text += "".join(source(number, lines) for number, (lines, _) in enumerate(blocks))
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "Snippets.java"
        file.write_text(text, encoding="utf-8")
        compile_ = [
            "javac",
            "-encoding",
            "UTF-8",
            "-nowarn",
            "-Xlint:none",
            "-d",
            folder,
            str(file),
        ]
        compiled = subprocess.run(compile_, check=False, capture_output=True, text=True)
        if compiled.returncode != 0:
            sys.exit(compiled.stderr)
        run = ["java", "-Xshare:auto", "-cp", folder, "Snippets"]
        output = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    lines = output.splitlines()
    if len(lines) != len(blocks):
        sys.exit(f"{len(blocks)} snippets have {len(lines)} values")
    return lines


def version():
    """The JVM's version, from its first line: `openjdk version "17.0.15" 2025-04-15`."""
    text = subprocess.run(["java", "-version"], check=True, capture_output=True, text=True).stderr
    return int(re.search(r'version "(\d+)', text).group(1))


def main():
    """Writes or compares the values."""
    is_check = sys.argv[1:] == ["--check"]
    files = {
        file: snippets(file.read_text(encoding="utf-8")) for file in sorted(FOLDER.glob("*.txt"))
    }
    if version() > 18:
        del files[FOLDER / "old_texts.txt"]
    blocks = [block for own in files.values() for block in own[1:]]
    results = iter(values(blocks))
    differs = False
    for file, (head, *own) in files.items():
        parts = ["\n".join(head[0])]
        parts += ["\n".join([*lines, f"=> {next(results)}"]) for lines, _ in own]
        written = "\n\n".join(parts) + "\n"
        old = file.read_text(encoding="utf-8")
        if written == old:
            continue
        differs = True
        if is_check:
            sys.stdout.writelines(
                difflib.unified_diff(
                    old.splitlines(True), written.splitlines(True), file.name, "as the JVM has it"
                )
            )
        else:
            file.write_text(written, encoding="utf-8")
    print(f"{len(blocks)} snippets of Java")
    if is_check and differs:
        sys.exit("their stored values are not those of this JVM")


if __name__ == "__main__":
    main()
