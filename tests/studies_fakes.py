"""Studies with made-up figures, so that a chart's parts can be tested without rendering."""

from pathlib import Path

import numpy as np

from converter.compare.metrics import Difference, Largest
from converter.renderers.methods import METHODS
from converter.scene.settings import Settings
from converter.studies.measure import Measured, SceneStudy
from converter.studies.processes import Process
from converter.studies.reference import LeftOut, Reference


def difference(disagreeing=0, rms=0.0):
    largest = Largest(1, 2, 0, 10 * rms, (0.5, 0.5, 0.5), (0.5, 0.5, 0.5))
    return Difference(800, 600, disagreeing, 0, rms / 2, rms, largest)


def measured(name, seconds=(0.1, 0.12, 0.11), disagreeing=0, rms=0.0, skipped=None):
    method = METHODS[name]
    if skipped is not None:
        return Measured(method, skipped)
    runs = [{"build": 0.01, "render": spent} for spent in seconds]
    told = {"read": 0.005, "build": 0.015, "render": seconds[0] + 0.2, "write": 0.004}
    cold = Process(sum(told.values()) + 0.3, told)
    bare = Process(cold.whole + 1, told) if method.family == "mitsuba" else None
    first = {"build": 0.01, "render": seconds[0] + 0.1}
    return Measured(method, None, difference(disagreeing, rms), first, runs, cold, bare, {"rays": 7})


NOTHING = LeftOut(0.0, 0.0)


def study(*methods, file="figure1.in", floor=None, left_out=NOTHING):
    reference = Reference(
        np.zeros((600, 800, 3), np.float32),
        "long double",
        Settings(cutoff=0.0, max_depth=64),
        1.0,
        left_out,
        floor or difference(0, 1.8e-9),
    )
    return SceneStudy(Path(file), Settings(), reference, list(methods))


def crowded_study():
    """Every method, many of them with the same error and nearly the same time, as on a real scene."""
    random = np.random.default_rng(7)
    methods = []
    for name, method in METHODS.items():
        base = {"native": 0.05, "mitsuba": 0.15, "povray": 0.6}[method.family]
        seconds = base * np.exp(random.normal(0, 0.25)) * np.exp(random.normal(0, 0.05, 5))
        exact = random.random() < 0.6
        rms = 7.5e-5 if exact else float(10 ** random.uniform(-5, -1))
        methods.append(measured(name, tuple(map(float, seconds)), 0 if exact else int(4e5 * rms), rms))
    return study(*methods)
