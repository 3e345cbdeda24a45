"""Where a line crosses a primitive, at most twice, and which of the two crossings counts for a ray."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.rays import Ray
from mitsuba_plugins.intersection.rounding import bounds_all, most_blur
from mitsuba_plugins.syntax import syntax


@dataclass
class Passage:
    """A line's crossings with one shape. Where one is missing its distance is infinite or NaN: compare with `<`."""

    near: Any  # Float, as is `far`
    far: Any
    near_primitive: Any  # UInt32, what is crossed there, as is `far_primitive`
    far_primitive: Any
    meets: Any = True  # Bool, whether there are any
    inside_before: Any = False  # Bool, whether the line is inside before the near one, and so beyond the far one
    close: Any = False  # Bool, whether that was close to a tie
    between: Any = None
    """If there are several planes from where it crosses one to where it crosses the next (Float); where all is bounded,
    of whether it is the near crossing (Bool), how much that is more than the errors."""
    error: Callable[[Any, Any], Any] | None = None
    """Where ties are decided how far a distance may be off, of whether it is the near one (Bool) and itself (Float)."""


@dataclass
class Crossing:
    """Where a ray first crosses a shape."""

    t: Any  # Float, infinite or NaN if it does not: compare with <
    enters: Any  # Bool, whether the ray comes from outside
    primitive: Any  # UInt32
    error: Any  # Float, how far t may be off where ties are decided
    close: Any  # Bool, whether that was close to a tie


def first_crossing(passage: Passage, ray: Ray, own: Any, reach: Any, which_piece: bool = True) -> Crossing:
    """The crossing of a passage that counts: the first that is farther than `t_min`.

    `own` where the ray starts on the shape. There the crossing that it starts at is known, and not looked for: the ray
    travels between the two, to the far one, or else away from both. `reach` is the origin's largest coordinate. Planes
    may tie where it does not matter `which_piece` of the surface is met.
    """
    to_near = ~own & (passage.near > ray.t_min)
    t = dr.select(to_near, passage.near, passage.far)
    t = dr.select(passage.meets & (t > ray.t_min), t, dr.inf)
    # Of most kinds that is False: an operation less in every kernel.
    between = ray.inside if passage.inside_before is False else ray.inside != passage.inside_before
    t = dr.select(own, dr.select(between, dr.maximum(passage.far, 0), dr.inf), t)
    close = passage.close
    if bounds_all(t):
        assert passage.error is not None
        starts = mi.Bool(False)  # whether the ray may start at a crossing
        for side, at in ((True, passage.near), (False, passage.far)):
            starts |= ~(dr.abs(at) > passage.error(mi.Bool(side), at) + ray.shift)
        close |= ~own & passage.meets & starts & ~dr.isnan(passage.near)
        if which_piece and passage.between is not None:
            close |= (t < dr.inf) & ~(passage.between(to_near) > 0)
    elif which_piece and passage.between is not None:
        close |= (t < dr.inf) & (passage.between < most_blur(t) * (reach + t))
    return Crossing(
        t=t,
        enters=to_near if passage.inside_before is False else to_near != passage.inside_before,
        primitive=dr.select(to_near, passage.near_primitive, passage.far_primitive),
        error=type(t)(passage.error(to_near, t) if passage.error is not None else 0),
        close=mi.Bool(close),
    )


@syntax
def crossing_if(active: Any, ray: Ray, width: int, intersect: Callable[[], Crossing]) -> Crossing:
    """What `intersect()` gives, in a branch: where packets of rays may all be spared it."""
    t = dr.full(type(ray.t_min), dr.inf, width)
    enters = dr.full(mi.Bool, False, width)
    primitive = dr.zeros(mi.UInt32, width)
    error = dr.zeros(type(ray.t_min), width)
    close = dr.full(mi.Bool, False, width)
    if dr.hint(active, exclude=[intersect]):
        crossing = intersect()
        t, enters, primitive, close = crossing.t, crossing.enters, crossing.primitive, crossing.close
        error += crossing.error
    return Crossing(t, enters, primitive, error, close)
