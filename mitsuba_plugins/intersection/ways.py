"""The ways to find what a ray hits, and which of them a scene is fit for."""

from typing import Any

from mitsuba_plugins.backend import on_gpu
from mitsuba_plugins.intersection.analytic import AnalyticSurfaces
from mitsuba_plugins.intersection.bvh import BvhSurfaces
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.interactions import MitsubaSurfaces
from mitsuba_plugins.intersection.mesh import MeshSurfaces
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import Real

WAYS = ("analytic", "bvh", "mesh", "offset", "ulp")
ANALYTIC_LIMIT = 32
"""Rows of numbers (a sphere and a plane have one, a quadric four) up to which "auto" is "analytic", ..."""
ANALYTIC_MOST = 96
"""... or this, as its kernels grow with them, if there are few bounded objects: only these does a tree pass by."""
ANALYTIC_OBJECTS = 12
"""That are few."""


def way_for(surfaces: list[Surface], way: str) -> str:
    """The way that is meant for these surfaces: "auto" is what is fastest, and of nothing there is no tree.

    On a GPU the tree is: it is as fast for a few surfaces, and its kernel is compiled in a part of the time.
    """
    if not surfaces and way in ("auto", "bvh"):
        return "analytic"
    if way == "auto":
        return "analytic" if _are_few(surfaces) and not on_gpu() else "bvh"
    return way


def _are_few(surfaces: list[Surface]) -> bool:
    """Whether code for each surface is faster than a tree."""
    size = sum(len(surface.rows) for surface in surfaces)
    bounded = sum(surface.box is not None for surface in surfaces)
    return size <= ANALYTIC_LIMIT or (size <= ANALYTIC_MOST and bounded <= ANALYTIC_OBJECTS)


def tracer_of(
    way: str, types: Real, scene: Any, surfaces: list[Surface], primitives: Primitives, at_lights: LightContacts
) -> Any:
    """What finds hits in one of `WAYS`, in the precision of `types`; `scene` is Mitsuba's."""
    if way == "analytic":
        return AnalyticSurfaces(types, surfaces, primitives, at_lights)
    if way == "bvh":
        return BvhSurfaces(types, surfaces, primitives, at_lights)
    if way == "mesh":
        return MeshSurfaces(types, scene, surfaces, primitives, at_lights)
    return MitsubaSurfaces(scene, surfaces, primitives, way)
