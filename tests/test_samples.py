"""Many samples a pixel: how often Mitsuba's kernel is launched for them, and what is told meanwhile."""

import numpy as np
import pytest
from variant import VARIANT

from converter.renderers.base import Interrupted
from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.settings import Settings

FIXED = 0.03
"""Seconds of a launch in which nothing is traced."""


class Clock:
    """Stands in for the module `time`."""

    def __init__(self):
        self.now = 0.0

    def perf_counter(self):
        return self.now


@pytest.fixture
def clock(mi, monkeypatch):
    from mitsuba_plugins.integrators import pace

    result = Clock()
    monkeypatch.setattr(pace, "time", result)
    return result


@pytest.mark.parametrize("branching", [False, True])
@pytest.mark.parametrize("nanoseconds", [1, 100, 10_000])
@pytest.mark.parametrize("size", [(64, 48), (640, 360), (3840, 2160)])
def test_most_of_the_time_goes_into_rays(clock, size, nanoseconds, branching):
    """By a simulated clock: whatever a ray costs, launches take neither long nor so little that they cost more."""
    from mitsuba_plugins.integrators.pace import MOST_PIXELS, Pace

    width, height = size
    for samples in (1, 4, 16, 64, 256, 1024):
        pace, first, launches, longest = Pace(branching, 16), 0, 0, 0.0
        clock.now = 0.0
        while first < height:
            rows, done = min(height - first, pace.rows(width)), 0
            while done < samples:
                count = min(samples - done, pace.samples(rows * width))
                with pace.launch(rows * width * count):
                    started = clock.now
                    clock.now += FIXED
                    pace.recorded()
                    clock.now += rows * width * count * nanoseconds * 1e-9
                longest = max(longest, clock.now - started)
                launches += 1
                done += count
            first += rows
        tracing = width * height * samples * nanoseconds * 1e-9
        beginning = 10 + width * height // MOST_PIXELS[False]
        assert launches * FIXED < 0.1 * tracing + beginning * FIXED, (samples, launches)
        assert longest < (6 if nanoseconds == 10_000 and not branching else 1.5), samples


def test_launches_run_as_long_as_they_are_recorded(clock):
    """Recording the kernel of a large csg takes longer than a launch should: that does not make launches smaller."""
    from mitsuba_plugins.integrators.pace import Pace

    pace, width, height, first, launches = Pace(True, 16), 160, 120, 0, 0
    while first < height:
        rows = min(height - first, pace.rows(width))
        with pace.launch(rows * width):
            clock.now += 0.6
            pace.recorded()
            clock.now += rows * width * 1e-5
        first, launches = first + rows, launches + 1
    assert launches < 5


def launches(dr, render):
    """How often the kernel that traces rays was launched: the one of the most operations."""
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        render()
        history = dr.kernel_history()
    most = max(entry["operation_count"] for entry in history if entry["type"] == dr.KernelType.JIT)
    return sum(entry["type"] == dr.KernelType.JIT and entry["operation_count"] == most for entry in history)


@pytest.mark.parametrize("intersections", ["analytic", "bvh", "mesh"])
def test_launches_do_not_grow_with_the_samples(mi, clock, small_scene, intersections):
    import drjit as dr

    renderer = MitsubaRenderer(VARIANT, intersections)
    counts = [
        launches(dr, lambda n=n: renderer.render(small_scene, Settings(width=32, height=24, samples=n)))
        for n in (1, 16, 256)
    ]
    assert counts == [1, 3, 4]  # 1 sample, 8 more, the other 247 in two: where rays branch the first launch is small


def test_samples_of_several_launches_add_up_to_the_same(mi, small_scene, monkeypatch):
    from mitsuba_plugins.integrators import pace

    settings = Settings(width=48, height=36, samples=9)
    renderer = MitsubaRenderer(VARIANT)
    whole = np.asarray(renderer.render(small_scene, settings).pixels)
    monkeypatch.setattr(pace.Pace, "rows", lambda self, width: 7)
    monkeypatch.setattr(pace.Pace, "samples", lambda self, pixels: 2)
    parts = np.asarray(renderer.render(small_scene, settings).pixels)
    assert np.array_equal(whole, parts)


def test_every_launch_is_told(mi, small_scene, monkeypatch):
    from mitsuba_plugins.integrators import pace

    monkeypatch.setattr(pace.Pace, "rows", lambda self, width: 18)
    monkeypatch.setattr(pace.Pace, "samples", lambda self, pixels: 3)
    told = []
    settings = Settings(width=48, height=36, samples=4)
    MitsubaRenderer(VARIANT).render(small_scene, settings, told.append)
    assert told == pytest.approx([0.375, 0.5, 0.875, 1])


def test_ctrl_c_between_launches_leaves_the_finished_bands(mi, small_scene, monkeypatch):
    from mitsuba_plugins.integrators import pace

    monkeypatch.setattr(pace.Pace, "rows", lambda self, width: 18)
    monkeypatch.setattr(pace.Pace, "samples", lambda self, pixels: 1)

    def stop(share):
        if share > 0.6:
            raise KeyboardInterrupt

    settings = Settings(width=48, height=36, samples=4)
    with pytest.raises(Interrupted) as caught:
        MitsubaRenderer(VARIANT).render(small_scene, settings, stop)
    pixels = np.asarray(caught.value.partial.pixels)
    assert pixels[:18].all()
    assert not pixels[18:].any()


@pytest.mark.parametrize("branching", [False, True])
def test_gpus_get_as_many_rays_as_they_trace_at_once(clock, monkeypatch, branching):
    """A launch of fewer takes a GPU as long; one for all of a large picture leaves nothing to copy together."""
    from mitsuba_plugins.integrators import pace

    monkeypatch.setattr(pace, "on_gpu", lambda: True)
    assert pace.Pace(branching, 16).rows(3840) == (2**18 // 3840 if branching else 2184)
