"""Results as JSON, into a file or to stdout."""

import errno
import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any


def check_json(file: str | None) -> None:
    """See that there is a folder for `file`, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: there is none, or it is a folder itself.

    """
    if file is None or file == "-":
        return
    path = Path(file)
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), file)
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(path.parent)!r}", file)


def write_json(file: str | None, result: Any) -> None:
    """Write `result` to `file`: `-` is stdout, None nowhere. NaN and infinities, unknown to JSON, become null."""
    if file is None:
        return
    text = json.dumps(_finite(result), indent=2, allow_nan=False)
    if file == "-":
        print(text)
    else:
        Path(file).write_text(text + "\n", encoding="utf-8")


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_finite(item) for item in value]
    return value
