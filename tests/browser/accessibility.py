"""What axe-core finds wrong with a page for people who cannot see it well or use no mouse."""

from __future__ import annotations

import json
import os
from pathlib import Path

from chromium import Browser

# Where .ci/run installs it; elsewhere by AXE.
AXE = Path(
    os.environ.get(
        "AXE", Path(__file__).resolve().parents[2] / "target/ci/node_modules/axe-core/axe.min.js"
    )
)


def check_accessibility(browser: Browser, page: str) -> None:
    """Fails with what is serious or critical."""
    assert AXE.exists(), f"axe-core is not at {AXE}: npm install --prefix target/ci axe-core@4.14.1"
    browser.run(AXE.read_text() + "; 1")
    found = browser.run("axe.run(document, { resultTypes: ['violations'] })")
    serious = [it for it in found["violations"] if it["impact"] in ("serious", "critical")]
    told = [
        (it["id"], it["impact"], [node["html"][:160] for node in it["nodes"][:4]]) for it in serious
    ]
    assert not told, f"{page}: {json.dumps(told, indent=1)}"
    # It has looked at something.
    assert (
        browser.run("axe.run(document, { resultTypes: ['passes'] }).then(it => it.passes.length)")
        > 10
    )
