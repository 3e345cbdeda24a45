"""Lets tracers on PYTHONPATH come before those of an editable installation: Python runs this as it starts."""

import sys

sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__module__.startswith("_editable_skbc")]
