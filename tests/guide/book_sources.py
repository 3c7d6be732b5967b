#!/usr/bin/env python3
"""The mdBook preprocessor `sources`: files outside of docs/ that pages link to become part of the
book.

A page may link to `../crates/core/iiwa-kin/src/inverse.rs`, which a forge shows. The book does not
contain such files: each linked file is copied to `sources`, next to the folder of the book, with
the suffix `.txt`, so that browsers show it, and the link is changed. Links to folders are replaced
by their text.
"""

import json
import os
import re
import shutil
import sys
from pathlib import Path

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s#:]+)(#[^)\s]*)?\)")


def chapters(items):
    for item in items:
        if isinstance(item, dict) and (chapter := item.get("Chapter")):
            yield chapter
            yield from chapters(chapter["sub_items"])


def main():
    if len(sys.argv) > 1 and sys.argv[1] == "supports":
        return 0
    context, book = json.load(sys.stdin)
    docs = Path(context["root"]).resolve()
    copies = docs / context["config"]["build"]["build-dir"] / "../sources"
    for chapter in chapters(book.get("items") or book.get("sections")):
        if not chapter.get("path"):
            continue
        folder = (docs / chapter["path"]).parent

        def inside(match, folder=folder):
            text, target = match[1], match[2]
            file = Path(os.path.normpath(folder / target))
            if file.is_relative_to(docs):
                return match[0]
            if not file.is_file():
                return text
            # mdBook treats `.md.txt` as a chapter.
            name = file.relative_to(docs.parent).with_name(file.name.removesuffix(".md") + ".txt")
            copy = copies / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
            up = os.path.relpath(docs.parent / "sources", folder)
            return f"[{text}]({up}/{name.as_posix()})"

        # Fences do not contain links.
        parts = re.split(r"(^```.*?^```$)", chapter["content"], flags=re.MULTILINE | re.DOTALL)
        chapter["content"] = "".join(
            part if part.startswith("```") else LINK.sub(inside, part) for part in parts
        )
    json.dump(book, sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
