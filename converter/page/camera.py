"""A camera that goes around what it looks at."""

import math
from dataclasses import replace

from converter.scene.model import Camera, Vector

LEAST_ANGLE = math.radians(2)
"""Between the view direction and the up vector, which must not be parallel."""
DIGITS = 4
"""Decimal digits of the distance to the look-at point that a turned eye keeps: a tenth of a pixel."""


def turned(camera: Camera, yaw: float, pitch: float) -> Camera:
    """The camera with its eye moved around the look-at point, at the same distance from it.

    Args:
        camera: from where to turn.
        yaw: radians about the up vector, counter-clockwise seen from its tip.
        pitch: radians toward the up vector's tip; turning ends `LEAST_ANGLE` before it and before its opposite.

    """
    offset = _minus(camera.eye, camera.look_at)
    distance = math.hypot(*offset)
    outward, up = _scaled(offset, 1 / distance), _scaled(camera.up, 1 / math.hypot(*camera.up))
    polar = math.acos(max(-1.0, min(1.0, _dot(outward, up))))
    wanted = max(LEAST_ANGLE, min(math.pi - LEAST_ANGLE, polar - pitch)) if pitch else polar
    level = _minus(outward, _scaled(up, _dot(outward, up)))
    level = _scaled(level, 1 / math.hypot(*level))
    across = _cross(up, level)
    flat = _plus(_scaled(level, math.cos(yaw)), _scaled(across, math.sin(yaw)))
    outward = _plus(_scaled(up, math.cos(wanted)), _scaled(flat, math.sin(wanted)))
    x, y, z = _plus(camera.look_at, _scaled(outward, distance))
    decimals = DIGITS - math.floor(math.log10(distance))
    return replace(camera, eye=(round(x, decimals) + 0.0, round(y, decimals) + 0.0, round(z, decimals) + 0.0))


def _plus(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _scaled(a: Vector, factor: float) -> Vector:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
