"""A convex polyhedron: an intersection of half-spaces, whose planes are its primitives."""

import math
from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.passages import Passage
from mitsuba_plugins.intersection.rays import Ray, largest
from mitsuba_plugins.intersection.rounding import decides_ties, epsilon, most_blur
from mitsuba_plugins.intersection.shapes.kind import Contact, Row, Rows, Shape, SurfacePoint
from native_tracer.incidence import surfaces_at, within

ROWS = 1
FACETED = True
CONVEX = True


def read(entry: dict[str, Any]) -> Shape:
    """`"planes": {"0": [a, b, c, d], ...}, "box": ...`, normals of any length."""
    given = [_plane(*plane) for plane in entry["planes"].values()]
    pieces = tuple(map(int, entry["planes"]))
    return Shape(given, [_normalised(*plane) for plane in given], pieces, entry["box"], meshed=True)


def contacts(point: Any, rows: Any) -> list[Contact]:
    """With the planes' normals, wherever the faces are."""
    found = []
    for row in surfaces_at(point, rows, np.zeros(len(rows), dtype=np.bool_)):
        normal = rows[row, :3]
        # The square of a length may neither overflow nor vanish.
        normal = normal / np.abs(normal).max()
        x, y, z = (normal / np.linalg.norm(normal)).tolist()
        found.append(Contact(row, (x, y, z), 0.0))
    return found


def turned(rows: tuple[Row, ...]) -> tuple[Row, ...] | None:
    """The half-space beyond."""
    return tuple((-a, -b, -c, -d) for a, b, c, d in rows)


def contains(point: Any, rows: Any) -> bool:
    """In all half-spaces, or on their borders."""
    return within(point, rows)


def slides(move: Any, row: Any) -> bool:
    """Along its plane."""
    return bool(surfaces_at(move, [[*row[:3], 0]], [False]))


@dataclass
class _Span:
    """The part of a line that lies inside the half-spaces seen so far."""

    enter: Any  # Float, as is `leave`
    leave: Any
    enter_plane: Any  # UInt32, as is `leave_plane`
    leave_plane: Any
    # Where ties are decided:
    enter_error: Any = None  # Float, as is `leave_error`
    leave_error: Any = None
    outside: Any = None  # Bool, whether it runs outside of a plane
    # Where they are told:
    above: Any = None  # Float, how far above a plane that it runs along the ray starts, the largest of all
    between: Any = None  # Float, from where it crosses one plane to where it crosses the next


def _whole_line(ray: Ray, width: int) -> _Span:
    """The span before any half-space."""
    kind = type(ray.t_min)
    return _Span(
        enter=dr.full(kind, -dr.inf, width),
        leave=dr.full(kind, dr.inf, width),
        enter_plane=dr.zeros(mi.UInt32, width),
        leave_plane=dr.zeros(mi.UInt32, width),
    )


def passage(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """From the last half-space that is entered to the first that is left.

    Haines, Fast Ray-Convex Polyhedron Intersection, Graphics Gems II, 1991.
    """

    def narrow(span: _Span, plane: Any, row: Any) -> _Span:
        """The span in one more half-space, n . p + offset <= 0."""
        n = type(ray.d)(row.xyz)
        cosine = dr.dot(n, ray.d)
        height = dr.dot(n, ray.o) + row.w
        t = -quotient(height, cosine)
        other = ray.primitive != plane
        entering, leaving = cosine < -ray.spread, cosine > ray.spread
        enters = entering & (t > span.enter) & other
        leaves = leaving & (t < span.leave) & other
        if not decides_ties(t):
            # Outside of a plane that it runs along, a ray has left at once.
            outside = other & (cosine == 0) & (height > 0)
            t, leaves = dr.select(outside, -dr.inf, t), leaves | outside
        between = dr.abs(t - dr.select(entering, span.enter, span.leave))
        return replace(
            span,
            enter=dr.select(enters, t, span.enter),
            leave=dr.select(leaves, t, span.leave),
            enter_plane=dr.select(enters, plane, span.enter_plane),
            leave_plane=dr.select(leaves, plane, span.leave_plane),
            above=dr.select((entering | leaving) | (height < span.above), span.above, height),
            between=dr.select(between < span.between, between, span.between),
        )

    infinity = dr.full(type(ray.t_min), dr.inf, rows.width)
    span = rows.fold(narrow, replace(_whole_line(ray, rows.width), above=-infinity, between=infinity))
    gap = span.enter - span.leave
    at_edge = (gap > 0) & (gap <= most_blur(gap) * (reach + span.enter))
    # More than `surface_error` says, for planes that pass as near as that.
    in_plane = ray.t_min + most_blur(gap) * 4 * reach
    return Passage(
        near=span.enter,
        far=span.leave,
        near_primitive=span.enter_plane,
        far_primitive=span.leave_plane,
        meets=(span.enter <= span.leave) & ~(span.above > in_plane),
        close=((dr.abs(span.above) <= in_plane) | at_edge) & (~own | ray.inside),
        between=span.between,
    )


def passage_by_rules(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """A ray along a plane neither enters nor leaves there, and is inside or outside by its height; one that meets an
    edge hits; where planes tie, the first counts.
    """

    def narrow(span: _Span, plane: Any, row: Any) -> _Span:
        n = type(ray.d)(row.xyz)
        error = ray.t_min + surface_error(row, reach)
        slope = dr.dot(n, ray.d)
        height = dr.dot(n, ray.o) + row.w
        t = dr.select(dr.abs(height) <= error, 0, -quotient(height, slope))
        t_error = quotient(error + dr.abs(t) * ray.spread, dr.abs(slope))
        left = own & (ray.primitive == plane)
        enters = (slope < -ray.spread) & (t - span.enter > t_error + span.enter_error) & ~left
        leaves = (slope > ray.spread) & (span.leave - t > t_error + span.leave_error) & ~left
        return replace(
            span,
            enter=dr.select(enters, t, span.enter),
            leave=dr.select(leaves, t, span.leave),
            enter_plane=dr.select(enters, plane, span.enter_plane),
            leave_plane=dr.select(leaves, plane, span.leave_plane),
            enter_error=dr.select(enters, t_error, span.enter_error),
            leave_error=dr.select(leaves, t_error, span.leave_error),
            outside=span.outside | ((dr.abs(slope) <= ray.spread) & (height > error)),
        )

    exact = dr.zeros(type(ray.t_min), rows.width)
    inside = dr.full(mi.Bool, False, rows.width)
    start = replace(_whole_line(ray, rows.width), enter_error=exact, leave_error=exact, outside=inside)
    span = rows.fold(narrow, start)
    return Passage(
        near=span.enter,
        far=span.leave,
        near_primitive=span.enter_plane,
        far_primitive=span.leave_plane,
        meets=~span.outside & ~(span.enter - span.leave > span.enter_error + span.leave_error),
        error=lambda enters, _: dr.select(enters, span.enter_error, span.leave_error),
    )


def surface_at(rows: Rows, p: Any, ray: Ray, own: Any, reach: Any) -> SurfacePoint:
    """Along the normal."""
    row = rows.row()
    n = type(ray.d)(row.xyz)
    return SurfacePoint(type(p)(p - n * (dr.dot(n, p) + row.w)), n, surface_error(row, reach), type(row.w)(dr.inf))


def surface_error(row: Any, reach: Any) -> Any:
    """How far a plane may be off where rays whose coordinates are no larger than `reach` are compared with it."""
    offset = row.w
    number = epsilon(offset)
    along_axis = dr.select(offset == dr.floor(offset), 0, number * dr.abs(offset))
    slanting = 4 * number * (dr.abs(offset) + reach)
    return dr.select(largest(row) == 1, along_axis, slanting)


def _plane(a: float, b: float, c: float, d: float) -> Row:
    return a, b, c, d


def _normalised(a: float, b: float, c: float, d: float) -> Row:
    length = math.hypot(a, b, c)
    return a / length, b / length, c / length, d / length
