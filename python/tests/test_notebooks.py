"""The notebooks are stored without outputs, run from end to end, and find the stated results."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
TIME_LIMIT_S = 120

# Expressions that are evaluated after a notebook has run.
QUESTIONS = {
    "first-plan": """{
        "slow_s": plan.cycle_time_s,
        "fast_s": fast.cycle_time_s,
        "rows": len(frame),
        "columns": list(frame.columns),
        "torques": torques.size,
    }""",
    "calibrate": """{
        "model": error_percent(model).abs().max().to_dict(),
        "found": error_percent(found.robot).abs().max().to_dict(),
        "before_percent": before.cycle_time_error_percent,
        "after_percent": after.cycle_time_error_percent,
        "predicted_s": iw.plan(work, robot=found.robot).cycle_time_s,
        "true_s": iw.plan(work, robot=virtual).cycle_time_s,
    }""",
    "faster": """{
        "taught_s": taught.cycle_time_s,
        "full_speed_s": full_speed.cycle_time_s,
        "fastest_s": fastest.cycle_time_s,
        "crate_m": fastest.clearance(scene).distance_m,
        "cage_m": fastest.clearance(iw.Scene.load("../../fixtures/cage.json")).distance_m,
        "itself_m": fastest.self_clearance(scene).distance_m,
        "again_s": iw.plan(iw.Program.from_json(fastest.program.to_json())).cycle_time_s,
        "planned": planned,
        "optimum_s": optimum.changed_cycle_time_s,
        "both_s": both.changed_cycle_time_s,
        "both_again_s": iw.plan(both.program).cycle_time_s,
        "both_m": clearance_m(iw.plan(both.program)),
    }""",
}


def run(name: str, monkeypatch: pytest.MonkeyPatch, folder: Path) -> tuple[dict[str, Any], Any]:
    """Runs a notebook; returns its answers, and the notebook with its outputs.

    The kernel is stopped in any case.
    """
    nbclient = pytest.importorskip(
        "nbclient", reason="nbclient is missing: tests/requirements.txt has it"
    )
    nbformat = pytest.importorskip("nbformat")
    monkeypatch.setenv("IPYTHONDIR", str(folder))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(folder))
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    notebook.cells.append(
        nbformat.v4.new_code_cell(f"import json; print(json.dumps({QUESTIONS[name]}))")
    )
    kernel = pytest.importorskip("jupyter_client").AsyncKernelManager(
        kernel_name="python3", transport="ipc"
    )
    kernel.ip = str(folder / "kernel")
    client = nbclient.NotebookClient(notebook, km=kernel)
    until = time.monotonic() + TIME_LIMIT_S
    with client.setup_kernel(cwd=str(FOLDER), cleanup_kc=True):
        process = kernel.provisioner.process
        for index, cell in enumerate(notebook.cells):
            client.timeout = max(int(until - time.monotonic()), 1)
            client.execute_cell(cell, index)
    assert process.poll() is not None, "the kernel still runs"
    return json.loads(notebook.cells[-1].outputs[0].text), notebook


def shown(notebook: Any, kind: str) -> list[str]:
    """The cell outputs of one kind."""
    outputs = [
        output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs
    ]
    return [output.data[kind] for output in outputs if kind in output.get("data", {})]


def test_all_notebooks_are_tested() -> None:
    assert [path.stem for path in NOTEBOOKS] == sorted(QUESTIONS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_stored_without_outputs(path: Path) -> None:
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None, (
                f"clear the outputs of {cell['id']}"
            )


def test_first_plan(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found, notebook = run("first-plan", monkeypatch, tmp_path)
    assert 0.5 * found["slow_s"] < found["fast_s"] < 0.8 * found["slow_s"]
    # 250 Hz with both ends, one column for the time, 3 x 7 for joints, 3 for the TCP and 7 for
    # torques.
    assert abs(found["rows"] - 250 * found["fast_s"]) < 2.5
    assert len(found["columns"]) == 1 + 21 + 3 + 7
    assert found["torques"] == 7
    # The figure and the page are each shown once.
    assert len(shown(notebook, "image/png")) == 1
    assert sum("<iframe srcdoc=" in page for page in shown(notebook, "text/html")) == 1


def test_calibrate(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found, _ = run("calibrate", monkeypatch, tmp_path)
    for kind in ("velocity", "acceleration", "jerk"):
        assert found["model"][kind] > 5, (
            f"the virtual robot hardly differs from the model in {kind}"
        )
        assert found["found"][kind] < 2, f"{kind} is off by {found['found'][kind]} %"
    assert found["before_percent"] < -1
    assert abs(found["after_percent"]) < 0.05
    assert found["predicted_s"] == pytest.approx(found["true_s"], rel=5e-4)


def test_faster(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found, _ = run("faster", monkeypatch, tmp_path)
    assert found["full_speed_s"] < found["taught_s"]
    assert found["fastest_s"] < 0.8 * found["taught_s"]
    # Both are found to 0.1 mm.
    assert min(found["crate_m"], found["cage_m"], found["itself_m"]) > 0.0499
    assert found["cage_m"] >= found["crate_m"] - 1e-4
    assert found["again_s"] == pytest.approx(found["fastest_s"], abs=1e-9)
    assert found["planned"] == 600
    # The built-in search cannot lower the lifts; from where the first one ends, it finds more.
    assert found["optimum_s"] < 0.75 * found["taught_s"]
    assert found["both_s"] < 0.95 * found["fastest_s"]
    assert found["both_again_s"] == pytest.approx(found["both_s"], abs=1e-9)
    assert found["both_m"] > 0.0498
