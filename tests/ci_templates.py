#!/usr/bin/env python3
"""Runs the steps of the GitHub action and of the GitLab template as shell.

    tests/ci_templates.py ARCHIVE.tar.gz

The repository has a change that slows down one program. The differences have to name it, and the
gates have to fail.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]
ACTION = ROOT / ".github/actions/cycle-time/action.yml"
TEMPLATE = ROOT / "docs/ci/cycle-time.gitlab-ci.yml"
PROGRAMS = ["appendix-b.json", "ten-motions.json"]


def git(repository: Path, *arguments: str) -> str:
    """Runs git, and returns its output."""
    identity = ["-c", "user.name=ci", "-c", "user.email=ci@localhost"]
    command = ["git", "-C", str(repository), *identity, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def repository(folder: Path) -> str:
    """Makes a repository with a change of one program, and returns the commit before it."""
    programs = folder / "programs"
    programs.mkdir(parents=True)
    for name in PROGRAMS:
        (programs / name).write_bytes((ROOT / "fixtures" / name).read_bytes())
    git(folder, "init", "-q")
    git(folder, "add", ".")
    git(folder, "commit", "-q", "-m", "programs: add two programs")
    before = git(folder, "rev-parse", "HEAD")
    slow = programs / PROGRAMS[0]
    slow.write_text(json.dumps(json.loads(slow.read_text()) | {"override_percent": 80}))
    git(folder, "commit", "-q", "-a", "-m", "programs: slow one down")
    return before


def bash(script: str, folder: Path, variables: dict[str, str]) -> int:
    """Runs a script as the runners do, and returns its exit code."""
    home = {name: os.environ[name] for name in ("HOME", "PATH")}
    command = ["bash", "-e", "-o", "pipefail", "-c", script]
    return subprocess.run(
        command, check=False, cwd=folder, env=home | variables, timeout=120
    ).returncode


def action_steps(folder: Path, project: Path, inputs: dict[str, str]) -> tuple[dict[str, int], str]:
    """Runs the steps of the action, and returns their exit codes and the summary."""
    folder.mkdir()
    summary, path = folder / "summary.md", folder / "path"
    summary.touch()
    runner = {
        "RUNNER_TEMP": str(folder),
        "GITHUB_STEP_SUMMARY": str(summary),
        "GITHUB_PATH": str(path),
    }
    codes = {}
    for step in yaml.safe_load(ACTION.read_text())["runs"]["steps"]:
        given = {
            name: re.sub(r"\$\{\{ inputs\.([\w-]+) }}", lambda match: inputs[match[1]], value)
            for name, value in step["env"].items()
        }
        if path.exists():
            given["PATH"] = ":".join([*path.read_text().split(), os.environ["PATH"]])
        codes[step["name"]] = bash(step["run"], project, runner | given)
    return codes, summary.read_text()


def run_action(folder: Path, archive: str) -> None:
    """Runs the action with a base and without one, and checks summaries and exit codes."""
    folder.mkdir()
    project = folder / "project"
    inputs = {
        "programs": "programs",
        "base": repository(project),
        "archive": archive,
        "sha256": "",
        "plan-options": "--max-cycle-time 10",
        "diff-options": "--max-growth-percent 2",
    }
    codes, text = action_steps(folder / "run", project, inputs)
    wanted = {"Install iiwasim": 0, "Programs before the change": 0, "Difference": 3, "Gates": 3}
    assert codes == wanted, codes
    check_summary(text)
    # The first push of a branch, and a run without a commit before it, have nothing to compare.
    for none in ("", "0" * 40):
        codes, text = action_steps(folder / f"none{len(none)}", project, inputs | {"base": none})
        assert codes["Difference"] == 0 and not text, (codes, text)


def run_template(folder: Path, archive: str) -> None:
    """Runs the scripts of the template, and checks the artifact and the exit code."""
    before = repository(folder)
    job = yaml.safe_load(TEMPLATE.read_text())["cycle-time"]
    variables = {name: str(value) for name, value in job["variables"].items()}
    variables |= {
        "IIWASIM_ARCHIVE": archive,
        "CI_COMMIT_BEFORE_SHA": before,
        "IIWASIM_PLAN_OPTIONS": "--max-cycle-time 100",
    }
    script = "\n".join(job["before_script"][1:] + job["script"])
    assert bash(script, folder, variables) == 0
    check_summary((folder / "cycle-times.md").read_text())
    variables["IIWASIM_DIFF_OPTIONS"] = "--max-growth-percent 2"
    assert bash(script, folder, variables) == 3


def check_summary(text: str) -> None:
    """Checks that the differences name the slower program, and only this one in detail."""
    assert "Programs: 1 changed, 1 unchanged" in text, text
    assert f"<summary>{PROGRAMS[0]}</summary>" in text, text
    assert f"<summary>{PROGRAMS[1]}</summary>" not in text, text


def main() -> None:
    """Runs both."""
    archive = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        run_action(Path(folder) / "action", archive)
        run_template(Path(folder) / "template", archive)
    print("CI templates: the action's four steps and the template's scripts end as expected")


if __name__ == "__main__":
    main()
