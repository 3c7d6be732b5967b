#!/usr/bin/env python3
"""Checks all links within the documents, and within the book generated from them.

    tests/guide/links.py [target/guide/html]

Links to other sites are not checked.
"""

import re
import subprocess
import sys
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
OTHER_SITE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def documents():
    """Documents that git tracks. A walk would meet the folders of builds that run beside it."""
    command = ["git", "ls-files", "-z", "--", "*.md"]
    names = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    return [ROOT / name for name in names.stdout.split("\0") if name]


def prose(text):
    """The text without fences and code, in which brackets have other meanings."""
    text = re.sub(r"^ *```.*?^ *```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(
        r"`[^`\n]*`", lambda code: "`" + re.sub(r"[\[\]()]", "", code[0][1:-1]) + "`", text
    )


def anchors(text):
    """Anchors that forges and mdBook generate from headings."""
    seen, found = Counter(), set()
    for heading in re.findall(r"^#+ +(.*?) *$", prose(text), flags=re.MULTILINE):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        found.add(f"{anchor}-{seen[anchor]}" if seen[anchor] else anchor)
        seen[anchor] += 1
    return found


def links_of_documents():
    """Broken links, and the number of links."""
    wrong, count = [], 0
    for document in documents():
        text = document.read_text(encoding="utf-8")
        for link in re.findall(r"\]\(<?([^)\s>]+)>?(?: \"[^\"]*\")?\)", prose(text)):
            if OTHER_SITE.match(link):
                continue
            count += 1
            name, _, anchor = link.partition("#")
            file = (document.parent / name).resolve() if name else document
            shown = f"{document.relative_to(ROOT)}: {link}"
            if not file.exists():
                wrong.append(f"{shown}: no such file")
            elif (
                anchor
                and file.suffix == ".md"
                and anchor not in anchors(file.read_text(encoding="utf-8"))
            ):
                wrong.append(f"{shown}: there is no such heading")
    return wrong, count


class Page(HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.ids.add(value)
            elif name in ("href", "src") and value and tag != "base":
                self.links.append(value)


def links_of_book(folder):
    # The 404 page is shown at any address, and the print page repeats the others.
    pages = {
        file: Page(file)
        for file in folder.rglob("*.html")
        if file.name not in ("404.html", "print.html", "toc.html")
    }
    wrong, count = [], 0
    for file, page in pages.items():
        for link in page.links:
            if OTHER_SITE.match(link):
                continue
            count += 1
            name, _, anchor = unquote(link).partition("#")
            target = (file.parent / name).resolve() if name else file
            shown = f"{file.relative_to(folder)}: {link}"
            if not target.is_file():
                wrong.append(f"{shown}: no such file in the book")
            elif anchor and target in pages and anchor not in pages[target].ids:
                wrong.append(f"{shown}: there is no such place in the book")
    return wrong, count


def main():
    wrong, count = links_of_documents()
    print(f"links: {count} in documents", end="")
    if len(sys.argv) > 1:
        more, in_book = links_of_book(Path(sys.argv[1]).resolve())
        wrong += more
        print(f", {in_book} in the book", end="")
    print(f", {len(wrong)} wrong")
    for message in wrong:
        print(message, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
