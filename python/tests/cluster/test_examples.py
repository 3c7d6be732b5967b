"""Examples in docstrings and in `examples`."""

from __future__ import annotations

import doctest
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from conftest import Cluster

import iiwasim.dask
import iiwasim.ray
from iiwasim import batches

ROOT = Path(__file__).resolve().parents[3]
NAMES = [
    *((batches, name) for name in batches.__all__ if name != "Options"),
    *((iiwasim.ray, name) for name in iiwasim.ray.__all__),
    *((iiwasim.dask, name) for name in iiwasim.dask.__all__),
]


def run(*command: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs Python with the given arguments."""
    # By default, Ray reports usage and listens on all interfaces.
    env = {**os.environ, "RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}
    return subprocess.run(
        [sys.executable, *command],
        check=False,
        capture_output=True,
        text=True,
        timeout=600,
        cwd=cwd,
        env=env,
    )


@pytest.mark.parametrize(
    ("module", "name"), [*NAMES, (batches, "")], ids=lambda part: getattr(part, "__name__", part)
)
def test_docstring(
    module: ModuleType,
    name: str,
    source: Path,
    of_ray: Cluster,
    of_dask: Cluster,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (tmp_path / "fixtures").symlink_to(ROOT / "fixtures")
    (tmp_path / "programs.jsonl").symlink_to(source)
    monkeypatch.chdir(tmp_path)
    text = (getattr(module, name) if name else module).__doc__
    assert text and ">>>" in text
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    runner.run(test, out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)


def test_search_is_the_same_everywhere() -> None:
    """A few generations find a program that keeps the distance and takes less time."""
    script = ROOT / "python" / "examples" / "search.py"

    def found(on: str) -> list[str]:
        done = run(str(script), "--on", on, "--generations", "6")
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()[:-1]

    lines = found("one-core")
    for on in ("cores", "ray", "dask"):
        assert found(on) == lines
    figures = {line[:30].strip(): line[30:].split() for line in lines[1:]}
    before_s, after_s, _ = figures["cycle time"]
    assert float(after_s) < float(before_s)
    before_mm, after_mm, _ = figures["clearance to the press"]
    assert float(before_mm) < 40.0 <= float(after_mm)


def test_without_a_cluster_of_dask(tmp_path: Path) -> None:
    (tmp_path / "programs.jsonl").write_text("{}")
    script = "import iiwasim.dask; iiwasim.dask.plan('programs.jsonl', 'figures')"
    done = run("-c", script, cwd=tmp_path)
    assert done.stderr.splitlines()[-1].endswith(
        "make a `distributed.Client`, or give one as `client`"
    )


@pytest.mark.parametrize(
    ("missing", "module", "said"),
    [
        ("pyarrow", "batches", "pip install 'iiwasim[batches]'"),
        ("ray", "ray", "pip install 'iiwasim[ray]'"),
        ("distributed", "dask", "pip install 'iiwasim[dask]'"),
    ],
)
def test_missing_packages_are_named(missing: str, module: str, said: str) -> None:
    script = f"import sys; sys.modules['{missing}'] = None; import iiwasim.{module}"
    done = run("-c", script)
    last = done.stderr.splitlines()[-1]
    assert last.startswith("ImportError: ") and said in last


def test_nothing_else_is_imported() -> None:
    """The package itself does not import Ray or Dask."""
    script = (
        "import iiwasim, sys; print(sorted({'ray', 'dask', 'pyarrow', 'pandas'} & "
        "set(sys.modules)))"
    )
    done = run("-c", script)
    assert done.stdout == "[]\n"
