"""Objects: spheres, and polyhedra as intersections of half-spaces."""

import math
from collections.abc import Sequence

from converter.scene.model import Plane, Shape, Sphere
from converter.scene.needs import SceneNeeds
from converter.to_povray.interiors import Interior
from converter.to_povray.text import number, vector


def surface(shape: Shape, needs: SceneNeeds, index: int) -> str:
    """The shape of the object `index`."""
    if isinstance(shape, Sphere):
        return f"sphere {{ {vector(shape.center)}, {number(shape.radius)} }}"
    if plate := needs.plates[index]:
        sides = "".join(f"\n    {_plane(shape.planes[k])}" for k in needs.planes[index] if k not in plate)
        clipped = f"\n  clipped_by {{{sides}\n  }}" if sides else ""
        return f"plane {{ {_numbers(shape.planes[plate[0]])}{clipped}\n}}"
    planes = [shape.planes[k] for k in needs.planes[index]]
    if len(planes) == 1:
        return _plane(planes[0])
    # POV-Ray sees by itself how far a body reaches only where its planes are at right angles to the axes.
    bounds = f"\n  bounded_by {{ box {{ {_box(needs.boxes[index])} }} }}" if needs.bounded[index] else ""
    inner = "".join(f"\n  {_plane(plane)}" for plane in planes)
    return f"intersection {{{inner}{bounds}\n}}"


def object_(name: str, shape: str, texture: str, interior: Interior | None, shadows: bool) -> str:
    """A whole object.

    In our format a transparent body throws a shadow as every other does. In POV-Ray light passes through it: it gets no
    shadow, and a twin that nothing but shadow rays can see.

    Args:
        name: what to call its shape.
        shape: as `surface` gives it.
        texture: name of its texture.
        interior: of a transparent body.
        shadows: whether it matters what shadow it throws.

    """
    if interior is None:
        return f"{_open(shape)}\n  texture {{ {texture} }}\n}}\n"
    inverse = " inverse" if interior.inverse else ""
    body = f"object {{ {name} texture {{ {texture} }} interior {{ ior {number(interior.ior)} }} no_shadow{inverse} }}\n"
    twin = f"object {{ {name} no_image no_reflection }}\n" if shadows else ""
    return f"#declare {name} = {shape}\n{body}{twin}"


def _open(shape: str) -> str:
    """A block without its end."""
    return shape[: shape.rindex("}")].rstrip()


def _plane(plane: Plane) -> str:
    return f"plane {{ {_numbers(plane)} }}"


def _numbers(plane: Plane) -> str:
    """A plane's unit normal, and its distance from the origin along it."""
    a, b, c, d = plane
    length = math.hypot(a, b, c)
    return f"{vector((a / length, b / length, c / length))}, {number(-d / length)}"


def _box(corners: tuple[Sequence[float], Sequence[float]]) -> str:
    """A box a little larger than the body, so that no rounding cuts that."""
    low, high = corners
    room = 1e-6 * max(map(abs, (*low, *high)))
    return f"{vector(v - room for v in low)}, {vector(v + room for v in high)}"
