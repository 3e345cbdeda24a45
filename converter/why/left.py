"""Where the pixels lie that no cause explains: on which object, with which finish, by which mechanism.

For a pixel that is wrong by some colour, the mechanism is the term of its ray tree that is as large as that colour: a
highlight, a lamp's light that is there or blocked, what a refracted ray at depth 2 brings. A pixel at an edge may have
the colour of what is beside it.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.compare.ray_listing import object_name
from converter.renderers.records import RayRecord
from converter.scene.model import Scene
from converter.why.judge import Judged
from converter.why.likeness import errors
from converter.why.student import Levels, Places

MOST_LOOKED_AT = 200
"""Pixels whose rays are looked at."""
_FITS = 0.3
"""Share of a wrong colour that a term may leave to be what is wrong."""
_WHOLE = 0.8
"""Share of a lamp's light that is too much or missing, at least, where a shadow is wrong."""
_LEVEL = 1 / 255
_SURELY = 2
"""Levels: a smaller error has no mechanism but where it lies."""

Term = tuple[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Place:
    """Some of the pixels that are left: what they have in common.

    Attributes:
        object: its name and line in the file, or "background".
        finish: its index in the file; None for the background.
        mechanism: what is wrong there, in words.
        share: of the pixels that are left.
        pixel: the column and row of one of them.

    """

    object: str
    finish: int | None
    mechanism: str
    share: float
    pixel: tuple[int, int]


def places_left(judged: Judged) -> list[Place]:
    """Where the wrong pixels that are left lie, the largest share first."""
    found = judged.found
    wrong = found.screen.places[found.after]
    if not len(wrong):
        return []
    if len(wrong) > MOST_LOOKED_AT:
        chosen = np.random.default_rng(3).choice(len(wrong), MOST_LOOKED_AT, replace=False)
        wrong = wrong[np.sort(chosen)]
    around, expected = _neighbours(judged, wrong)
    worst = errors(expected[:, 4], _theirs(judged, wrong))
    counts: Counter[tuple[str, int | None, str]] = Counter()
    examples: dict[tuple[str, int | None, str], tuple[int, int]] = {}
    for i in np.argsort(-worst, kind="stable"):
        x, y = map(int, wrong[i])
        tree = judged.student.trace_pixel(x, y, frozenset(found.causes)).rays[0]
        key = (*_first_hit(tree, judged.scene), _mechanism(judged, tree, (x, y), around[i], expected[i]))
        counts[key] += 1
        examples.setdefault(key, (x, y))
    return [Place(*key, n / len(wrong), examples[key]) for key, n in counts.most_common()]


def _theirs(judged: Judged, places: Places) -> Levels:
    xs, ys = places.T
    result: Levels = judged.theirs.levels[ys, xs]
    return result


def _neighbours(judged: Judged, places: Places) -> tuple[Places, NDArray[np.uint8]]:
    """(n, 9, 2) pixels and those about them, row by row, and (n, 9, 3) their levels as the causes have them."""
    size = np.array((judged.settings.width, judged.settings.height))
    shifts = np.array([(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)])
    around = np.clip(places[:, np.newaxis] + shifts, 0, size - 1).astype(np.int32)
    levels = judged.student.drawn(around.reshape(-1, 2), frozenset(judged.found.causes))
    return around, levels.reshape(*around.shape[:2], 3)


def _first_hit(tree: RayRecord, scene: Scene) -> tuple[str, int | None]:
    hit = tree.hit
    return ("background", None) if hit is None else (object_name(scene, hit.object), scene.objects[hit.object].finish)


# ---- Mechanisms ------------------------------------------------------------------------------------------------------


def _mechanism(
    judged: Judged, tree: RayRecord, pixel: tuple[int, int], around: Places, expected: NDArray[np.uint8]
) -> str:
    theirs = _theirs(judged, np.array([pixel]))[0]
    if int(errors(expected[4], theirs)) > _SURELY:
        least, most = expected.min(axis=0).astype(int), expected.max(axis=0).astype(int)
        if ((least - 1 <= theirs) & (theirs <= most + 1)).all() and (most - least).max() > 4 * _SURELY:
            return _edge(judged, tree, around)
        wrong = (theirs.astype(np.float64) - expected[4]) * _LEVEL
        if (term := _fitting(wrong, judged.scene, tree)) is not None:
            return term
    if tree.hit is None:
        return "colour"
    if tree.children:
        heaviest = max(_walk(tree), key=lambda ray: (ray.depth > 0, ray.throughput))
        return _ray_name(heaviest)
    return "local colour"


def _edge(judged: Judged, tree: RayRecord, around: Places) -> str:
    """Which edge passes near a pixel."""
    causes = frozenset(judged.found.causes)
    beside = [(int(around[i, 0]), int(around[i, 1])) for i in (1, 3, 5, 7)]
    trees = [judged.student.trace_pixel(x, y, causes).rays[0] for x, y in beside]

    def some(differs: Any) -> bool:
        return any(differs(other.hit) for other in trees)

    hit = tree.hit
    if some(lambda other: _piece(other) != _piece(hit)):
        return "silhouette"
    if hit is not None:
        if some(lambda other: np.abs(np.subtract(other.pigment, hit.pigment)).max() > _LEVEL):
            return "edge of a tile or texel"
        if some(lambda other: _shadows(other) != _shadows(hit)):
            return "edge of a shadow"
    return "edge in a mirror or behind glass"


def _piece(hit: Any) -> Any:
    return None if hit is None else (hit.object, hit.plane)


def _shadows(hit: Any) -> list[bool]:
    return [light.shadowed_by is None for light in hit.lights]


def _fitting(wrong: NDArray[np.float64], scene: Scene, tree: RayRecord) -> str | None:
    """The name of the term whose whole absence, or a part of it, is what is wrong; None: there is none."""
    best: tuple[float, str] | None = None
    for name, color in _terms(scene, tree):
        size = float(color @ color)
        if size < _LEVEL**2:
            continue
        factor = min(max(float(wrong @ color) / size, -1.0), 1.0)
        if name.startswith("shadow") and abs(factor) < _WHOLE:
            continue  # a lamp is seen or not
        left = float(np.abs(wrong - factor * color).max() / np.abs(wrong).max())
        unlikely = left + 0.2 * (1 - abs(factor))  # a whole term is likelier than a part of it
        if left <= _FITS and (best is None or unlikely < best[0]):
            best = unlikely, name
    return None if best is None else best[1]


def _terms(scene: Scene, tree: RayRecord) -> Iterator[Term]:
    """What a pixel's colour is the sum of, and what shadows keep from it."""
    for ray in _walk(tree):
        weight, at = ray.throughput, "" if ray.depth == 0 else f" in {_ray_name(ray)}"
        if ray.depth > 0:
            yield _ray_name(ray), weight * _brought(ray, 1.0)
        hit = ray.hit
        if hit is None:
            yield f"background{at}", weight * np.array(ray.local)
            continue
        finish = scene.finishes[scene.objects[hit.object].finish]
        pigment = np.array(hit.pigment)
        yield f"ambient light{at}", weight * finish.ka * np.array(scene.ambient) * pigment
        for light in hit.lights:
            lamp = f"light {light.light + 1}"  # the file's first is the ambient light
            diffuse, specular = np.array(light.diffuse), np.array(light.specular)
            lit = light.light >= 0 and light.cosine > 0 and light.attenuation != 0
            if light.shadowed_by is not None and lit:
                intensity = np.array(scene.lights[light.light].color) / light.attenuation
                yield f"shadow of {lamp}{at}", weight * finish.kd * light.cosine * pigment * intensity
            elif diffuse.any():
                yield f"shadow of {lamp}{at}", weight * (diffuse + specular)
                yield f"diffuse light of {lamp}{at}", weight * diffuse
            if specular.any():
                yield f"highlight of {lamp}{at}", weight * specular


def _brought(ray: RayRecord, factor: float) -> NDArray[np.float64]:
    """The colour that a ray brings with all that follow it, times the factor."""
    total = factor * np.array(ray.local)
    for child in ray.children:
        total = total + _brought(child, factor * child.throughput / ray.throughput)
    return total


def _walk(ray: RayRecord) -> Iterator[RayRecord]:
    yield ray
    for child in ray.children:
        yield from _walk(child)


def _ray_name(ray: RayRecord) -> str:
    kind = {"primary": "direct sight", "reflected": "reflection", "transmitted": "refraction"}[ray.kind]
    return kind if ray.depth == 0 else f"{kind} at depth {ray.depth}"
