"""Results as JSON, into a file or to stdout."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from converter.files import check_target, replacing


def check_json(file: str | None, sources: Iterable[Path] = ()) -> None:
    """See that `file` can be written, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: it cannot, or is one of the `sources`.

    """
    if file is not None and file != "-":
        check_target(Path(file), sources)


def write_json(file: str | None, result: Any) -> None:
    """Write `result` to `file`, which appears whole or not at all: `-` is stdout, None nowhere.

    NaN and infinities, unknown to JSON, become null.
    """
    if file is None:
        return
    text = json.dumps(_finite(result), indent=2, allow_nan=False)
    if file == "-":
        print(text)
    else:
        with replacing(Path(file)) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_finite(item) for item in value]
    return value
