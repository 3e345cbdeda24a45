"""Results as text, JSON above all, into a file or to the standard output."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from converter.descriptors import STANDARD_OUTPUT
from converter.files import check_target, replacing


def check_json(file: Path | None, sources: Iterable[Path] = ()) -> None:
    """See that `file` can be written, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: it cannot, or is one of the `sources`.

    """
    if file is not None:
        check_target(file, sources)


def write_json(file: Path | None, result: Any) -> None:
    """Write `result` to `file`, which appears whole or not at all; None is nowhere.

    NaN and infinities, unknown to JSON, become null; data classes are objects of it.
    """
    if file is None:
        return
    write_text(file, json.dumps(_finite(result), indent=2, allow_nan=False) + "\n")


def write_text(file: Path, text: str) -> None:
    """Write a text to `file`, which appears whole or not at all."""
    if file == STANDARD_OUTPUT:
        print(text, end="")
        return
    with replacing(file) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if is_dataclass(value):
        return {each.name: _finite(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_finite(item) for item in value]
    return value
