"""What a scene's reader should be warned of: regions in which a method is known to fail, and lights that light nothing.

The limits are those that `whitted stability` measures, by the names of its families; `docs/stability.md` shows them.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from converter.scene.model import Polyhedron, Scene, Sphere, Vector
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from converter.renderers.methods import Method

Arithmetic = Literal["double", "float", "mesh", "offset", "ulp"]
"""Double throughout; single precision throughout; Embree's choice among exact surfaces; Embree's word, with rays moved
off by Mitsuba's offset, or by units in the last place."""

NONE = math.inf

POSITION: Mapping[Arithmetic, float] = {"double": 1e11, "float": 1e3, "mesh": 1e3, "offset": 1.0, "ulp": 1.0}
"""Family "position": the distance from the origin up to which the still life is drawn right."""
STILL_LIFE = 2 / 0.375
"""Largest coordinate, for a distance of 1, over the radius of its smallest ball."""
HUGE: Mapping[Arithmetic, float] = {"double": NONE, "float": 1e5, "mesh": 1e3, "offset": 1e3, "ulp": 1.0}
"""Family "huge": a ball's radius over that of one that rests on it."""
DISTANCE: Mapping[Arithmetic, float] = {"double": NONE, "float": 1e5, "mesh": NONE, "offset": 1e3, "ulp": 1e2}
"""Family "distance": from the eye to a body, over its radius."""
HIGHLIGHT: Mapping[Arithmetic, float] = {"double": NONE, "float": 1e4, "mesh": NONE, "offset": 1e4, "ulp": 1e4}
"""Family "highlight": alpha."""
LIGHT_DISTANCE: Mapping[Arithmetic, float] = {"double": 0.0, "float": 1e-4, "mesh": 0.0, "offset": 1e-4, "ulp": 1e-4}
"""Family "light-distance": from a ball's surface, in radii."""
CAMERA_HEIGHT: Mapping[Arithmetic, float] = {"double": 0.0, "float": 6e-8, "mesh": 6e-8, "offset": 6e-8, "ulp": 6e-8}
"""Family "camera-height": from a plane, over the distance of the origin."""


@dataclass(frozen=True, slots=True)
class _Body:
    """A bounded object: its index, and a ball around it, or for a sphere itself."""

    index: int
    center: Vector
    radius: float


def method_warnings(scene: Scene, settings: Settings, method: "Method") -> tuple[str, ...]:
    """A line for each region that `scene` enters in which `method` is known to fail, with the worst of the objects, its
    line in the file, and the method that holds.

    A method with POV-Ray is not known that well, and has none.
    """
    arithmetic = arithmetic_of(method)
    if arithmetic is None:
        return ()
    bodies = _bodies(scene, settings)
    found = [
        *_positions(scene, bodies, POSITION[arithmetic]),
        *_sizes(scene, bodies, HUGE[arithmetic]),
        *_distances(scene, bodies, DISTANCE[arithmetic]),
        *_highlights(scene, HIGHLIGHT[arithmetic]),
        *_near_lights(scene, bodies, LIGHT_DISTANCE[arithmetic]),
        *_heights(scene, settings, CAMERA_HEIGHT[arithmetic]),
    ]
    holds = "" if arithmetic == "double" else f"; --method {'native' if method.family == 'native' else 'mitsuba'} holds"
    return tuple(f"{what}, where {method.name} is known to fail{holds}" for what in found)


def scene_warnings(scene: Scene, settings: Settings) -> tuple[str, ...]:
    """A line for each light and camera that is cut off from all else, by whatever method, with its line in the file.

    Every surface blocks light, a transparent one too: a light inside a body lights nothing outside of it, and one
    outside of a body that the camera is in, nothing in there.
    """
    bodies = range(len(scene.objects))
    needs = scene_needs(scene, settings)
    around = [i for i in bodies if _contains(scene, i, scene.camera.eye)]
    found = []
    for k, source in enumerate(scene.lights if needs.lit else ()):
        line = scene.light_lines[k] if k < len(scene.light_lines) else 0
        inside = {i for i in bodies if _contains(scene, i, source.position)}
        if hidden := sorted(inside.difference(around)):
            what = f"is inside {_object(scene, hidden[0])}, and lights nothing outside of it"
        elif closed := [i for i in around if i not in inside]:
            what = f"is outside of {_object(scene, closed[0])}, which the camera is in, and lights nothing in there"
        else:
            continue
        found.append(f"{_place(scene, line)}light {k + 1} {what}")
    for i in around:
        finish = scene.finishes[scene.objects[i].finish]
        alone = not any(_contains(scene, i, _inner_point(scene, settings, k)) for k in bodies if k != i)
        if finish.kt == 0 and alone and len(scene.objects) > 1:
            found.append(f"{_place(scene, scene.objects[i].line)}object {i} has the camera inside, and nothing else")
    return tuple(found)


def arithmetic_of(method: "Method") -> Arithmetic | None:
    """What decides where a method fails; None for POV-Ray."""
    if method.family == "povray":
        return None
    for kind in ("mesh", "offset", "ulp"):
        if method.options.get("intersections") == kind:
            return kind
    return "float" if method.options.get("precision") == "float" else "double"


# ---- The regions -----------------------------------------------------------------------------------------------------


def _positions(scene: Scene, bodies: list[_Body], limit: float) -> Iterator[str]:
    def radii(body: _Body) -> float:
        return max(map(abs, body.center)) / body.radius

    for body, more in _worst(bodies, radii, limit * STILL_LIFE):
        yield f"{_told(scene, body)} is {radii(body):.2g} of its radii from the origin{more}"


def _sizes(scene: Scene, bodies: list[_Body], limit: float) -> Iterator[str]:
    balls = [body for body in bodies if isinstance(scene.objects[body.index].shape, Sphere)]
    # A ball that holds everything, a sky, touches nothing.
    smallest = min(balls, key=lambda body: body.radius, default=None)
    if smallest is None:
        return

    def ratio(body: _Body) -> float:
        touches = math.dist(body.center, smallest.center) >= body.radius
        return body.radius / smallest.radius if touches else 0.0

    for body, more in _worst(balls, ratio, limit):
        yield f"{_told(scene, body)} has {ratio(body):.2g} times the radius of object {smallest.index}{more}"


def _distances(scene: Scene, bodies: list[_Body], limit: float) -> Iterator[str]:
    def radii(body: _Body) -> float:
        return math.dist(body.center, scene.camera.eye) / body.radius

    for body, more in _worst(bodies, radii, limit):
        yield f"{_told(scene, body)} is {radii(body):.2g} of its radii from the camera{more}"


def _highlights(scene: Scene, limit: float) -> Iterator[str]:
    for k in sorted({o.finish for o in scene.objects}):
        finish = scene.finishes[k]
        if scene.lights and finish.ks > 0 and finish.alpha > limit:
            line = scene.finish_lines[k] if k < len(scene.finish_lines) else 0
            yield f"{_place(scene, line)}finish {k} has an alpha of {finish.alpha:g}, more than {limit:g}"


def _near_lights(scene: Scene, bodies: list[_Body], limit: float) -> Iterator[str]:
    balls = [body for body in bodies if isinstance(scene.objects[body.index].shape, Sphere)]
    for k, source in enumerate(scene.lights):
        line = scene.light_lines[k] if k < len(scene.light_lines) else 0
        for body in balls:
            height = abs(math.dist(source.position, body.center) - body.radius) / body.radius
            if height < limit:
                where = f"{height:.2g} radii from the surface of object {body.index}"
                yield f"{_place(scene, line)}light {k + 1} is {where}"
                break


def _heights(scene: Scene, settings: Settings, limit: float) -> Iterator[str]:
    eye = scene.camera.eye
    reach = max(map(abs, eye))
    for i, o in enumerate(scene.objects):
        if isinstance(o.shape, Polyhedron):
            for k, (a, b, c, d) in enumerate(o.shape.planes):
                length = math.hypot(a, b, c)
                height = (a * eye[0] + b * eye[1] + c * eye[2] + d) / length
                if abs(height) < limit * max(reach, abs(d) / length):
                    yield f"{_place(scene, o.line)}the camera is {abs(height):.2g} from plane {k} of object {i}"
                    return


def _worst(bodies: Iterable[_Body], measure: Callable[[_Body], float], limit: float) -> Iterator[tuple[_Body, str]]:
    """The body with the largest measure, if that is above the limit, and a word on how many others are."""
    beyond = [body for body in bodies if measure(body) > limit]
    if beyond:
        others = len(beyond) - 1
        count = f"; so {'is one other' if others == 1 else f'are {others} others'}" if others else ""
        yield max(beyond, key=measure), f" (more than {limit:.2g}{count})"


# ---- Bodies ----------------------------------------------------------------------------------------------------------


def _bodies(scene: Scene, settings: Settings) -> list[_Body]:
    needs = scene_needs(scene, settings)
    result = []
    for i, (o, (low, high), bounded) in enumerate(zip(scene.objects, needs.boxes, needs.bounded, strict=True)):
        if isinstance(o.shape, Sphere):
            result.append(_Body(i, o.shape.center, o.shape.radius))
        elif bounded and (radius := math.dist(low, high) / 2) > 0:
            x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
            result.append(_Body(i, (x, y, z), radius))
    return result


def _contains(scene: Scene, i: int, p: Vector) -> bool:
    shape = scene.objects[i].shape
    if isinstance(shape, Sphere):
        return math.dist(p, shape.center) < shape.radius
    return all(a * p[0] + b * p[1] + c * p[2] + d < 0 for a, b, c, d in shape.planes)


def _inner_point(scene: Scene, settings: Settings, i: int) -> Vector:
    """A point of an object: of a ball its centre, of a polyhedron one well inside."""
    from converter.scene.geometry import scene_facts

    shape, fact = scene.objects[i].shape, scene_facts(scene)[i]
    if isinstance(shape, Sphere):
        return shape.center
    assert fact is not None
    return fact.inside


def _object(scene: Scene, i: int) -> str:
    line = scene.objects[i].line
    return f"object {i}" + (f" (line {line})" if line else "")


def _told(scene: Scene, body: _Body) -> str:
    return f"{_place(scene, scene.objects[body.index].line)}object {body.index}"


def _place(scene: Scene, line: int) -> str:
    return f"{scene.file or 'scene'}{f':{line}' if line else ''}: "
