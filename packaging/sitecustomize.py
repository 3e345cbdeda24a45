"""Lets what lies on PYTHONPATH come before an editable installation: Python runs this as it starts.

The tracers beside this file come first of all, before those of a checkout that is the folder at work, where they have
no modules in C++.
"""

import sys
from importlib.machinery import PathFinder
from pathlib import Path

HERE = Path(__file__).parent
TRACERS = {folder.name for folder in HERE.glob("*_tracer")}


class TracersHere:
    """Finds the tracers beside this file, and their modules."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        """Where a module of theirs lies, or None for every other."""
        return PathFinder.find_spec(name, path or [str(HERE)], target) if name.partition(".")[0] in TRACERS else None


others = [finder for finder in sys.meta_path if not type(finder).__module__.startswith("_editable_skbc")]
sys.meta_path[:] = [TracersHere, *others]
