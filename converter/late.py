"""Modules that most runs of a program need nothing of."""

from importlib import import_module
from types import ModuleType
from typing import Any


class LateModule:
    """A module that is imported once something of it is asked for."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._module: ModuleType | None = None

    def __getattr__(self, name: str) -> Any:
        if self._module is None:
            self._module = import_module(self._name)
        return getattr(self._module, name)
