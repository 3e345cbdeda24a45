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
from mitsuba_plugins.intersection.rounding import bounds_all, decides_ties, epsilon, most_blur
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
        found.append(Contact(row, (x, y, z), 0.0, ((0.0,) * 3,) * 3))
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
    if bounds_all(ray.t_min):
        return _doubtful_passage(rows, ray, own, reach)

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


@dataclass
class _Doubtful:
    """A span whose ends are known within bounds."""

    enter: Any  # Float, the last crossing of a plane that enters
    enter_error: Any  # Float
    enter_plane: Any  # UInt32
    enter_least: Any  # Float, the least that the last one may be
    enter_other: Any  # Float, the most that any of the others may be
    leave: Any
    leave_error: Any
    leave_plane: Any
    leave_most: Any
    leave_other: Any
    sideways: Any  # Float, before which planes that the ray may run along are not crossed
    outside: Any  # Bool, whether it runs outside of one


def _doubtful_passage(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """The same with bounds: a tie is what is within these."""
    kind = type(ray.t_min)

    def narrow(span: _Doubtful, plane: Any, row: Any) -> _Doubtful:
        n = type(ray.d)(row.xyz)
        error = ray.t_min + surface_error(row, reach)
        slope, height = dr.dot(n, ray.d), dr.dot(n, ray.o) + row.w
        t = -quotient(height, slope)
        t_error = 1.5 * quotient(error + dr.abs(t) * ray.spread, dr.abs(slope))
        other = plane != ray.primitive
        enters, leaves = other & (slope < -4 * ray.spread), other & (slope > 4 * ray.spread)
        runs = other & ~enters & ~leaves
        last, first = enters & (t > span.enter), leaves & (t < span.leave)
        not_last = dr.select(last, span.enter + span.enter_error, dr.select(enters, t + t_error, -dr.inf))
        not_first = dr.select(first, span.leave - span.leave_error, dr.select(leaves, t - t_error, dr.inf))
        free = quotient(dr.abs(height) - error, 5 * ray.spread)
        return _Doubtful(
            enter=dr.select(last, t, span.enter),
            enter_error=dr.select(last, t_error, span.enter_error),
            enter_plane=dr.select(last, plane, span.enter_plane),
            enter_least=dr.select(enters & (t - t_error > span.enter_least), t - t_error, span.enter_least),
            enter_other=dr.maximum(span.enter_other, not_last),
            leave=dr.select(first, t, span.leave),
            leave_error=dr.select(first, t_error, span.leave_error),
            leave_plane=dr.select(first, plane, span.leave_plane),
            leave_most=dr.select(leaves & (t + t_error < span.leave_most), t + t_error, span.leave_most),
            leave_other=dr.minimum(span.leave_other, not_first),
            sideways=dr.select(runs & ~(free > span.sideways), free, span.sideways),
            outside=span.outside | (runs & (height > 0)),
        )

    infinity = dr.full(kind, dr.inf, rows.width)
    zero, nobody = dr.zeros(kind, rows.width), dr.zeros(mi.UInt32, rows.width)
    start = _Doubtful(
        -infinity,
        zero,
        nobody,
        -infinity,
        -infinity,
        infinity,
        zero,
        nobody,
        infinity,
        infinity,
        infinity,
        mi.Bool(zero > 0),
    )
    span = rows.fold(narrow, start)
    enter_most = dr.maximum(span.enter + span.enter_error, span.enter_other)
    leave_least = dr.minimum(span.leave - span.leave_error, span.leave_other)
    may_meet = ~(span.enter_least > span.leave_most) & ~(span.leave_most < -ray.shift) & (~own | ray.inside)
    surely = (enter_most < leave_least) & ((span.leave_most < span.sideways) | (span.sideways == dr.inf))

    def error(to_near: Any, _: Any) -> Any:
        most = dr.select(to_near, enter_most - span.enter, span.leave - leave_least)
        least = dr.select(to_near, span.enter - span.enter_least, span.leave_most - span.leave)
        return dr.select(dr.isfinite(dr.select(to_near, span.enter, span.leave)), dr.maximum(most, least), 0)

    def between(to_near: Any) -> Any:
        """Where negative there are planes of which either may be the one that is crossed."""
        return dr.select(
            to_near,
            span.enter - span.enter_error - span.enter_other,
            span.leave_other - span.leave - span.leave_error,
        )

    return Passage(
        near=span.enter,
        far=span.leave,
        near_primitive=span.enter_plane,
        far_primitive=span.leave_plane,
        meets=(span.enter <= span.leave) & ~span.outside,
        close=may_meet & ~surely,
        between=between,
        error=error,
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
    if bounds_all(offset):
        along_axis = number * dr.abs(offset)
        return dr.select(dr.abs(row.x) + dr.abs(row.y) + dr.abs(row.z) == 1, along_axis, slanting)
    return dr.select(largest(row) == 1, along_axis, slanting)


def _plane(a: float, b: float, c: float, d: float) -> Row:
    return a, b, c, d


def _normalised(a: float, b: float, c: float, d: float) -> Row:
    length = math.hypot(a, b, c)
    return a / length, b / length, c / length, d / length
