"""Runs checks one after the other in one browser, and reports their results."""

from __future__ import annotations

import traceback
from collections.abc import Callable

from chromium import Browser


def run_checks(name: str, checks: list[Callable], subject: object) -> int:
    """Runs checks and returns the exit code. A check takes the browser and `subject`, and may
    return a figure.
    """
    failed = 0
    figures = []
    browser = Browser()
    try:
        for check in checks:
            browser.complaints.clear()
            try:
                figure = check(browser, subject)
                assert not browser.complaints, browser.complaints
                if figure:
                    figures.append(figure)
                print(f"ok      {check.__name__}", flush=True)
            except AssertionError as error:
                failed += 1
                line = traceback.extract_tb(error.__traceback__)[-1]
                print(
                    f"FAILED  {check.__name__}, line {line.lineno}: {error or line.line}",
                    flush=True,
                )
    finally:
        browser.close()
    print("\n".join(figures))
    print(f"{name} in a browser: {len(checks) - failed} checks passed, {failed} failed")
    return 1 if failed else 0
