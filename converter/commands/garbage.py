"""How seldom the process of a program looks for garbage."""

import gc

SELDOM = 50_000
"""By how many objects there are to be more for the young ones to be looked through. By Python's own 700 that happens a
hundred times while modules are imported, whose objects all stay."""


def collect_seldom() -> None:
    """Look for garbage seldom while the program runs; at its end all is collected, as nanobind's classes need it."""
    gc.set_threshold(SELDOM)
