"""Runs of pytest within tests: in this process, for a start of Python takes longer than most of what they test."""

from importlib.metadata import entry_points

# Modules that are loaded first within a run of pytester are forgotten after it, and parts of pygame cannot be loaded
# twice: these stay the same in all tests.
import sandbox.app.share.evidence
import sandbox.session.golden
import sandbox.session.worker_pool
import sandbox.testing.evidence  # noqa: F401

PLUGIN = "sandbox.testing.plugin"
# Where the project is installed, pytest has loaded it already.
LOADED = ["-p", "no:cacheprovider", "-p", "no:hypothesispytest"]
LOADED += [] if any(each.value == PLUGIN for each in entry_points(group="pytest11")) else ["-p", PLUGIN]
