"""Lets tracers on PYTHONPATH come before those of an editable installation: Python runs this as it starts."""

import sys
from pathlib import Path

sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__module__.startswith("_editable_skbc")]

# A script's own folder: PYTHONSAFEPATH, without which packages of the working folder would come first, leaves it out.
_script = next((word for word in sys.orig_argv[1:] if not word.startswith("-")), "")
if _script.endswith(".py"):
    sys.path.append(str(Path(_script).resolve().parent))
