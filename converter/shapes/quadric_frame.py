"""A quadric along its principal axes, in floating point: distances, margins, and places."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from converter.scene.model import Plane, Quadric, Vector
from converter.shapes.kind import Intersection
from converter.shapes.quadric_form import Form, binary_form, kind_of, nearest

Floats = NDArray[np.float64]

_LEAST = 2.0**-1022
_LARGE = np.errstate(all="ignore")
"""Numbers may be as large as they like."""


@dataclass(frozen=True, eq=False)
class Frame:
    """f at `origin + axes @ y` is, but for a positive factor, sum(values y^2) + 2 slope y_3 + constant.

    Attributes:
        origin: (3,) the centre; of what has none the vertex, or of its axis the point nearest the scene's origin.
        axes: (3, 3), in its columns unit vectors.
        values: (3,) eigenvalues, those that are positive, then those that are negative, then zeros.
        slope: 0, or negative, and then the last value and the constant are 0.
        constant: 0 where the centre is on the surface.

    """

    origin: Floats
    axes: Floats
    values: Floats
    slope: float
    constant: float

    def of(self, p: ArrayLike) -> Floats:
        """Points (..., 3) in its coordinates."""
        return np.asarray((np.asarray(p) - self.origin) @ self.axes)

    def at(self, y: Floats) -> Floats:
        """The value of f at points (..., 3) in its coordinates."""
        return np.asarray((self.values * y * y).sum(axis=-1) + 2 * self.slope * y[..., 2] + self.constant)

    def half_gradient(self, y: Floats) -> Floats:
        """Half the gradient, (..., 3), likewise."""
        return np.asarray(self.values * y + self.slope * np.array((0.0, 0.0, 1.0)))

    @property
    @_LARGE
    def semi_axes(self) -> Floats:
        """(3,) where each axis meets the surface, or its conjugate one; 0 where it does not."""
        return np.where(self.values != 0, np.sqrt(np.abs(self.constant / self.values)), 0.0)

    @property
    @_LARGE
    def around_middle(self) -> tuple[Vector, Vector]:
        """The box around its origin, and to the ends of the axes."""
        reach = np.linalg.norm(self.axes * self.semi_axes, axis=1)
        return _place(self.origin - reach), _place(self.origin + reach)

    @property
    @_LARGE
    def inside(self) -> Vector:
        """A point inside, about as far from the surface as the middle is."""
        y = np.zeros(3)
        if self.slope:
            y[2] = -self.slope / (np.abs(self.values).max() or -self.slope)
        elif self.constant >= 0:
            k = int(self.values.argmin())
            y[k] = math.sqrt(2 * self.constant / -self.values[k]) or float(np.abs(self.origin).max()) or 1.0
        return _place(self.origin + self.axes @ y)


@lru_cache(maxsize=4096)
@_LARGE
def frame_of(shape: Quadric) -> Frame:
    """Of a quadric that has a surface.

    Directions and eigenvalues are those of doubles; which of them are 0, and whether there is a centre, is exact, and
    what is left of f about the origin is computed without cancellation.
    """
    _, _, (positive, negative), (more, fewer), _ = kind_of(shape)
    form = binary_form(shape)
    size = max(map(abs, (*(x for row in form.matrix for x in row), Fraction(0)))) or max(map(abs, form.half_slope))
    values, axes = np.linalg.eigh([[nearest(x / size) for x in row] for row in form.matrix])
    values = values[::-1]
    least = 2.0**-64  # where roundings have left less, it would be of any sign
    values = np.concatenate(
        [
            np.maximum(values[:positive], least),
            np.zeros(3 - positive - negative),
            np.minimum(values[3 - negative :], -least),
        ]
    )
    order = [*range(positive), *range(3 - negative, 3), *range(positive, 3 - negative)]
    values, axes = values[order], axes[:, ::-1][:, order]
    rank = positive + negative
    origin = np.zeros(3)
    for _ in range(3):  # each step adds the digits that the one before could not
        slopes = axes.T @ _half_gradient(form, origin, size)
        origin = origin - axes[:, :rank] @ (slopes[:rank] / values[:rank])
    constant = nearest(form.at([Fraction(x) for x in _finite(origin)]) / size)
    if more + fewer == rank + 2:
        axes, slope = _along_slope(axes, rank, _half_gradient(form, origin, size))
        origin = origin - axes[:, 2] * (constant / slope / 2)
        return Frame(origin, axes, values, slope, 0.0)
    sign = (more - positive) - (fewer - negative)
    return Frame(origin, axes, values, 0.0, sign * abs(constant))


def _place(p: Floats) -> Vector:
    """A point that is nowhere, or beyond all doubles, is somewhere."""
    x, y, z = np.nan_to_num(p).tolist()
    return (x, y, z)


def _half_gradient(form: Form, p: Floats, size: Fraction) -> Floats:
    return np.array([nearest(x / size) for x in form.half_gradient([Fraction(x) for x in _finite(p)])])


def _finite(p: Floats) -> list[float]:
    return list(_place(p))


def _along_slope(axes: Floats, rank: int, gradient: Floats) -> tuple[Floats, float]:
    """The axes, those that have no eigenvalue turned until the last is where f falls, and how steeply it does."""
    rest = axes[:, rank:]
    along = -rest @ (rest.T @ gradient)
    slope = float(np.linalg.norm(along))
    if not slope > 0:  # it is exactly, and too small for doubles
        along, slope = rest[:, -1] * _LEAST, _LEAST
    last = along / slope
    if rank == 2:
        return np.column_stack([axes[:, :2], last]), -slope
    first = axes[:, 0] if rank == 1 else np.eye(3)[int(np.abs(last).argmin())]
    first = first - (first @ last) * last
    first = first / np.linalg.norm(first)
    return np.column_stack([first, np.cross(last, first), last]), -slope


# ---- Rays ------------------------------------------------------------------------------------------------------------


@_LARGE
def intersections(shape: Quadric, origin: Floats, direction: Floats) -> list[Intersection]:
    """Where a line crosses it, at most twice; where it comes nearest to that, if it does not."""
    frame = frame_of(shape)
    y, d = frame.of(origin), frame.axes.T @ direction
    a, b, c = _along(frame, y, d)
    crossed = roots(a, b, c)
    if not crossed:
        return [Intersection(-b / a, 0.0)] if a else []
    found = []
    for t in crossed:
        gradient = frame.half_gradient(y + t * d)
        length = float(np.linalg.norm(gradient))
        found.append(Intersection(t, float(gradient @ d) / length if length else 0.0))
    return found


@_LARGE
def silhouette_margin(shape: Quadric, origin: Floats, direction: Floats) -> float:
    """To the next parallel that touches the surface.

    Where f is least, or largest, along the line, its gradient is at a right angle to that. If the line is moved by s
    that way, the least f, or the largest, is a polynomial of s, and 0 where the line touches.
    """
    frame = frame_of(shape)
    y, d = frame.of(origin), frame.axes.T @ direction
    a, b, _ = _along(frame, y, d)
    if a == 0:
        return math.inf
    y = y - b / a * d
    gradient = frame.half_gradient(y)
    length, value = float(np.linalg.norm(gradient)), float(frame.at(y))
    if length == 0:
        return _distance(frame, y)
    n = gradient / length
    square = float(frame.values @ (n * n)) - float(frame.values @ (n * d)) ** 2 / a
    found = roots(square, length, value)
    return min(map(abs, found)) if found else abs(value) / (2 * length)


@_LARGE
def surface_margin(shape: Quadric, p: Floats, on_it: bool) -> float:
    """Along the gradient."""
    frame = frame_of(shape)
    return math.inf if on_it else _distance(frame, frame.of(p))


@_LARGE
def radius_of_curvature(shape: Quadric, p: Floats) -> float:
    """At least this at a point of the surface: a curve along it turns by no more than |value| / |half gradient|."""
    frame = frame_of(shape)
    most = float(np.abs(frame.values).max())
    return float(np.linalg.norm(frame.half_gradient(frame.of(p)))) / most if most else math.inf


@_LARGE
def nearest_bound(shape: Quadric, p: ArrayLike) -> float:
    """No point of the surface is nearer: on the way to it f changes by |f|, and no faster than the gradient lets it."""
    frame = frame_of(shape)
    y = frame.of(p)
    gradient = float(np.linalg.norm(frame.half_gradient(y)))
    most, value = float(np.abs(frame.values).max()), abs(float(frame.at(y)))
    fall = gradient + math.sqrt(gradient * gradient + most * value)
    return value / fall if fall else 0.0


@_LARGE
def reaches(shape: Quadric, half_spaces: Sequence[Plane]) -> bool:
    """Whether an ellipsoid reaches into each half-space, with normals of length 1, with some room for roundings."""
    frame, rows = frame_of(shape), np.array(half_spaces)
    reach = np.linalg.norm((rows[:, :3] @ frame.axes) * frame.semi_axes, axis=1)
    height = rows[:, :3] @ frame.origin + rows[:, 3]
    return not np.any(height > reach + 1e-9 * (np.abs(rows[:, 3]) + reach))


def _along(frame: Frame, y: Floats, d: Floats) -> tuple[float, float, float]:
    """Of f at y + t d = a t^2 + 2 b t + c."""
    return float(frame.values @ (d * d)), float(frame.half_gradient(y) @ d), float(frame.at(y))


def roots(a: float, b: float, c: float) -> list[float]:
    """Of a t^2 + 2 b t + c = 0, ascending; none of them loses digits to another."""
    rest = b * b - a * c
    if rest < 0:
        return []
    q = -(b + math.copysign(math.sqrt(rest), b))
    found = [q / a] if a else []
    return sorted(found + ([c / q] if q else []))


def _distance(frame: Frame, y: Floats) -> float:
    """From a point to the surface along the gradient; where that does not meet it, by how steep f is."""
    gradient = frame.half_gradient(y)
    length = float(np.linalg.norm(gradient))
    value = float(frame.at(y))
    if length == 0:
        most = float(np.abs(frame.values).max())
        return math.sqrt(abs(value) / most) if most else math.inf
    found = roots(*_along(frame, y, gradient / length))
    return min(map(abs, found)) if found else abs(value) / (2 * length)
