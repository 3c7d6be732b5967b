"""Accessibility check of a page with axe-core."""

from __future__ import annotations

import json
import os
from pathlib import Path

from chromium import Browser

# Path of axe-core as installed by .ci/run; the variable AXE overrides it.
AXE = Path(
    os.environ.get(
        "AXE", Path(__file__).resolve().parents[2] / "target/ci/node_modules/axe-core/axe.min.js"
    )
)


def check_accessibility(browser: Browser, page: str) -> None:
    """Fails for serious or critical violations."""
    assert AXE.exists(), f"axe-core is not at {AXE}: npm install --prefix target/ci axe-core@4.14.1"
    browser.run(AXE.read_text() + "; 1")
    # Pages in frames are checked by themselves.
    found = browser.run("axe.run(document, { iframes: false, resultTypes: ['violations'] })")
    serious = [it for it in found["violations"] if it["impact"] in ("serious", "critical")]
    told = [
        (it["id"], it["impact"], [node["html"][:160] for node in it["nodes"][:4]]) for it in serious
    ]
    assert not told, f"{page}: {json.dumps(told, indent=1)}"
    # Makes sure that axe-core has checked elements.
    assert (
        browser.run(
            "axe.run(document, { iframes: false, resultTypes: ['passes'] })"
            ".then(it => it.passes.length)"
        )
        > 10
    )
