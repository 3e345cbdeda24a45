"""What a scene description tells a `whitted` integrator: its parameters, read and checked."""

import math
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.rays import real
from mitsuba_plugins.intersection.ways import WAYS, way_for

MOST_BRIGHT = 2.0**100
"""Of single precision: its products with weights are numbers."""


@dataclass(frozen=True)
class Parameters:
    """The parameters that are no plugins, as :class:`.whitted.Whitted` documents them."""

    ambient: Any  # Color3d
    background: Any  # Color3d
    max_depth: Any  # UInt32
    cutoff: Any  # Float of the rays' precision, as mitsuba.traverse shows it
    brightest: Any  # Float
    reflection: bool
    refraction: bool
    branching: bool
    shadows: bool
    highlights: bool
    depth_limited: bool
    waiting: int  # at least 1
    seed: int
    points: str
    intersections: str  # one of `WAYS`
    precision: str


def read_parameters(props: Any, surfaces: list[Surface]) -> Parameters:
    """The parameters of an integrator of these surfaces.

    Raises:
        ValueError: one has no such value, or two do not go together.

    """
    intersections, precision = _intersections(props, surfaces)
    reflection, refraction = props.get("reflection", True), props.get("refraction", True)
    max_depth = props.get("max_depth", 16)
    points = props.get("points", "stratified")
    if points not in ("stratified", "independent"):
        raise ValueError(f"whitted: points is stratified or independent, not '{points}'")
    result = Parameters(
        ambient=mi.Color3d(props.get("ambient", mi.ScalarColor3d(0.0))),
        background=mi.Color3d(props.get("background", mi.ScalarColor3d(0.0))),
        max_depth=mi.UInt32(max_depth),
        cutoff=real("float" if precision == "float" else "double").Float(props.get("cutoff", 1 / 512)),
        brightest=mi.Float(min(props.get("brightest", math.inf), MOST_BRIGHT)),
        reflection=reflection,
        refraction=refraction,
        branching=props.get("branching", True) and reflection and refraction,
        shadows=props.get("shadows", True),
        highlights=props.get("highlights", True),
        depth_limited=props.get("depth_limited", False),
        waiting=max(1, props.get("waiting", max_depth)),
        seed=props.get("seed", 0),
        points=points,
        intersections=intersections,
        precision=precision,
    )
    dr.make_opaque(result.ambient, result.background, result.max_depth, result.cutoff, result.brightest)
    return result


def _intersections(props: Any, surfaces: list[Surface]) -> tuple[str, str]:
    """How the integrator finds what a ray hits, and in which precision."""
    way = props.get("intersections", "auto")
    if way not in (*WAYS, "auto"):
        raise ValueError(f"whitted: intersections is one of {WAYS} or auto, not '{way}'")
    way = way_for(surfaces, way)
    in_kernel = way in ("analytic", "bvh")
    if not in_kernel and any(surface.moves for surface in surfaces):
        raise ValueError(f"whitted: 'geometry' moves objects, and the shapes of '{way}' stand still")
    precision = props.get("precision", "double")
    if precision not in ("double", "float", "mixed"):
        raise ValueError(f"whitted: precision is double, float or mixed, not '{precision}'")
    if precision == "mixed" and not in_kernel:
        raise ValueError(f"whitted: precision mixed is for analytic and bvh, not for '{way}'")
    return way, "float" if way in ("offset", "ulp") else precision
