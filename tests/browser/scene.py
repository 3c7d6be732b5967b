"""A scene for pages, with a tool of all kinds of shapes."""

from __future__ import annotations

import json
from pathlib import Path

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"

# Side by side, so that each shape is distinguishable; small, so that programs in the cage do not
# collide.
TOOL = [
    {"type": "cylinder", "center_mm": [0, 0, 12], "radius_mm": 20, "length_mm": 24},
    {"type": "box", "center_mm": [0, 14, 30], "size_mm": [12, 10, 20], "rpy_deg": [0, 0, 20]},
    {"type": "sphere", "center_mm": [14, 0, 30], "radius_mm": 9},
    {"type": "mesh", "file": "wedge.obj", "origin_mm": [-14, -22, 24]},
]
WEDGE = "v 0 0 0\nv 16 0 0\nv 0 16 0\nv 2 2 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def write_scene(folder: Path) -> str:
    """Writes the cage with this tool, and the mesh next to it; returns the file name."""
    cage = json.loads((FIXTURES / "cage.json").read_text())
    (folder / "cage.json").write_text(json.dumps(cage | {"tool": TOOL}))
    (folder / "wedge.obj").write_text(WEDGE)
    return "cage.json"
