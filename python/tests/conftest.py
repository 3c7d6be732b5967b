"""Fixtures of all tests."""

pytest_plugins = ["simulated_robot"]
