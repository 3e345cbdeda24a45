"""What is surely not meant, though every renderer draws it: turned normals, colours that are no shares, lights and
cameras to no effect.

Every bound here errs on the quiet side: a scene in which something is odd for a reason is told nothing.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from converter.analysis.attenuation import least_divisor
from converter.pigments.table import pigment_kind
from converter.scene.errors import place, so_are
from converter.scene.model import Color, Plane, Scene, Vector
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind

BRIGHTEST, BRIGHTEST_LIGHT = 2.0, 10.0
"""Largest channel of a pigment or the ambient light, and of a light that distance does not dim: 1 is white, somewhat
more is used for glow, and what counts up to 255 is far beyond."""
MOST_GAIN = 2.0
"""How many times as bright as what is around it a body may look through its finish alone."""
LEAST_SEEN = 0.5 / 255
"""Half a level of a picture."""


class _Oddity(NamedTuple):
    line: int  # of the file; 0 where it is not known
    text: str


def oddity_notices(scene: Scene, settings: Settings) -> tuple[str, ...]:
    """A line for each kind of oddity, with the place of the first, and how many more there are."""
    needs = scene_needs(scene, settings)
    kinds = (
        _odd_shapes(scene, needs),
        _pigment_colors(scene, needs),
        _light_colors(scene),
        _gains(scene, needs),
        _dim_lights(scene, needs),
        _darkness(scene, needs),
        _empty_view(scene, settings),
    )
    return tuple(
        f"{place(scene.file, found[0].line)}: {found[0].text}{so_are(len(found) - 1)}"
        for kind in kinds
        if (found := list(kind))
    )


def _line(lines: tuple[int, ...], index: int) -> int:
    return lines[index] if index < len(lines) else 0


# ---- Shapes ----------------------------------------------------------------------------------------------------------


def _odd_shapes(scene: Scene, needs: SceneNeeds) -> Iterator[_Oddity]:
    for i, o in enumerate(scene.objects):
        if text := shape_kind(o.shape).oddity(o.shape, needs.facts[i]):
            yield _Oddity(o.line, f"object {i} {text}")


# ---- Colours ---------------------------------------------------------------------------------------------------------


def _pigment_colors(scene: Scene, needs: SceneNeeds) -> Iterator[_Oddity]:
    for k in needs.pigments:
        pigment = scene.pigments[k]
        for color in pigment_kind(pigment).colors(pigment):
            if odd := _odd(color):
                yield _Oddity(_line(scene.pigment_lines, k), f"pigment {k} {odd}")
                break


def _light_colors(scene: Scene) -> Iterator[_Oddity]:
    if odd := _odd(scene.ambient):
        yield _Oddity(0, f"the ambient light {odd}")
    for k, source in enumerate(scene.lights):
        a, b, c = source.attenuation
        # Bright lights that distance dims are usual.
        brightest = math.inf if b or c else BRIGHTEST_LIGHT * max(1.0, abs(a))
        if odd := _odd(source.color, brightest):
            yield _Oddity(_line(scene.light_lines, k), f"light {k + 1} {odd}")


def _odd(color: Color, brightest: float = BRIGHTEST) -> str:
    """What is wrong with a colour; empty if nothing is."""
    listed = " ".join(f"{x:g}" for x in color)
    if max(color) > brightest:
        return f"has the colour {listed}, where 1 is white: colours are shares, not levels up to 255"
    return f"has the colour {listed}, which is below black" if min(color) < 0 else ""


def _gains(scene: Scene, needs: SceneNeeds) -> Iterator[_Oddity]:
    """Finishes that add up to more than they should.

    Surroundings of brightness 1 are seen in a closed body with kr + kt I, and I, the brightness inside, is kr I + kt.
    """
    for k in needs.finishes:
        finish = scene.finishes[k]
        followed = needs.reflects or needs.refracts
        inside = finish.kt / (1 - finish.kr) if finish.kr < 1 else math.inf
        gain = finish.kr + (finish.kt * inside if finish.kt > 0 else 0.0)
        if followed and (gain > MOST_GAIN or max(finish.kr, finish.kt) > 1):
            text = f"finish {k}, with kr {finish.kr:g} and kt {finish.kt:g}, makes what it shows"
            times = f"{gain:.3g} times as bright" if gain < 1e3 else "brighter with every bounce"
            yield _Oddity(_line(scene.finish_lines, k), f"{text} {times}: kr + kt should not exceed 1 by much")


# ---- Lights and camera -----------------------------------------------------------------------------------------------


def _dim_lights(scene: Scene, needs: SceneNeeds) -> Iterator[_Oddity]:
    """Lights that change no colour by half a level, as near as an object comes to them, and nothing hides them."""
    for k, source in enumerate(scene.lights if needs.lit else ()):
        brightest = max(map(abs, source.color))
        if brightest > 0 and all(
            brightest < LEAST_SEEN * least_divisor(source, o, needs, i) for i, o in enumerate(scene.objects)
        ):
            text = (
                f"light {k + 1} is too weak to be seen: its attenuation dims it to less than half of one of 255 levels"
            )
            yield _Oddity(_line(scene.light_lines, k), f"{text} everywhere")


def _darkness(scene: Scene, needs: SceneNeeds) -> Iterator[_Oddity]:
    """Objects that no light makes visible, and that show no other thing."""
    ambient = any(scene.ambient) and any(scene.finishes[k].ka > 0 for k in needs.finishes)
    if scene.objects and not (needs.lit or ambient or needs.bounces):
        yield _Oddity(scene.objects[0].line, "object 0 is black, as all others are: no finish answers to a light")


def _empty_view(scene: Scene, settings: Settings) -> Iterator[_Oddity]:
    """A camera whose pyramid of view, made a pixel wider, no object reaches into."""
    every = range(len(scene.objects))
    if not every:
        return
    camera = scene.camera
    forward = _unit(_difference(camera.look_at, camera.eye))
    right = _unit(_cross(forward, _unit(camera.up)))
    up = _cross(right, forward)
    high = math.tan(math.radians(camera.fovy) / 2) * (1 + 4 / settings.height)
    wide = high * settings.width / settings.height * (1 + 4 / settings.width)
    normals = [_beside(axis, extent, forward) for axis, extent in ((right, wide), (up, high))]
    pyramid = [_through(camera.eye, n) for pair in normals for n in pair]
    if not all(math.isfinite(x) for plane in pyramid for x in plane):
        return
    if any(_reaches(scene, i, pyramid) for i in every):
        return
    ahead = _through(camera.eye, _difference((0.0, 0.0, 0.0), forward))
    where = "beside its picture" if any(_reaches(scene, i, [ahead]) for i in every) else "behind it"
    yield _Oddity(0, f"the camera sees no object: {'all are' if len(every) > 1 else 'it is'} {where}")


def _beside(axis: Vector, extent: float, forward: Vector) -> tuple[Vector, Vector]:
    """The outward normals of two opposite sides of the pyramid of view."""
    (a, b, c), (x, y, z) = axis, (extent * f for f in forward)
    return _unit((a - x, b - y, c - z)), _unit((-a - x, -b - y, -c - z))


def _through(point: Vector, normal: Vector) -> Plane:
    """The half-space that the normal points out of, and that ends at the point."""
    (a, b, c), (x, y, z) = normal, point
    return (a, b, c, -(a * x + b * y + c * z))


def _reaches(scene: Scene, i: int, half_spaces: list[Plane]) -> bool:
    """Whether an object may reach into the intersection of some half-spaces, whose normals have length 1."""
    o = scene.objects[i]
    if any(o.move):  # half-spaces come as near as the object comes to them
        x, y, z = o.move
        half_spaces = [(a, b, c, d + min(0.0, a * x + b * y + c * z)) for a, b, c, d in half_spaces]
    return shape_kind(o.shape).reaches(o.shape, half_spaces)


def _difference(p: Vector, q: Vector) -> Vector:
    return (p[0] - q[0], p[1] - q[1], p[2] - q[2])


def _cross(p: Vector, q: Vector) -> Vector:
    return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])


def _unit(v: Vector) -> Vector:
    """NaN where there is none: numbers may be as large as they like."""
    largest = max(map(abs, v)) or math.nan
    length = math.hypot(*(x / largest for x in v))
    x, y, z = (component / largest / length for component in v)
    return (x, y, z)
