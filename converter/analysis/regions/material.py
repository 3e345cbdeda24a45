"""Patterns that are fine for where they are, indices that are nearly the same, and mirrors that reflect mirrors."""

import math
from collections.abc import Iterator

import numpy as np

from converter.analysis.regions.region import Finding, Region, worst
from converter.analysis.regions.situation import Floats, Situation
from converter.pigments.table import pigment_kind
from converter.shapes.table import shape_kind

SEEN = 0.25
"""What the last of many bounces has to weigh for its errors to be plain."""


def _far_point(s: Situation, index: int) -> Floats:
    """Coordinates, without signs, as large as those of an object that are seen: of the foot of its planes' normals, and
    of its box where it is bounded.
    """
    if s.needs.bounded[index]:
        box: Floats = np.abs([s.low[index], s.high[index]])
        return np.asarray(box.max(axis=0))
    planes = s.planes_of(index)
    return np.asarray(np.abs(planes.normal * planes.offset[:, None]).max(axis=0, initial=0.0))


def _fine_patterns(s: Situation, limit: float) -> Iterator[Finding]:
    shares = np.full(len(s.scene.objects), np.inf)
    for i, o in enumerate(s.scene.objects):
        pigment = s.scene.pigments[o.pigment]
        shares[i] = pigment_kind(pigment).period(pigment, _far_point(s, i))
    for i, more in worst(shares, limit):
        what = pigment_kind(s.scene.pigments[s.scene.objects[i].pigment]).REPEATS
        text = f"object {i} is {1 / shares[i]:.2g} {what} from the origin (more than {1 / limit:.2g}{more})"
        yield Finding(s.scene.objects[i].line, text)


def _near_indices(s: Situation, limit: float) -> Iterator[Finding]:
    for k in s.needs.finishes:
        off = abs(s.needs.etas[k] - 1)
        if s.scene.finishes[k].kt > 0 and 0 < off < limit:
            line = s.scene.finish_lines[k] if k < len(s.scene.finish_lines) else 0
            yield Finding(line, f"finish {k} has an index that differs from 1 by {off:.2g} (less than {limit:.2g})")
            return


def _shiny(s: Situation, index: int, bounces: float) -> bool:
    """Whether light is seen that an object has reflected or transmitted so many times."""
    finish = s.finish(index)
    largest = max(finish.kr, finish.kt)
    return largest >= 1 or (largest > 0 and bounces * math.log(largest) >= math.log(SEEN))


def _curved_mirrors(s: Situation, limit: float) -> Iterator[Finding]:
    """Two balls or more in something that sends every ray back to them."""
    bounces = 1 / limit
    if s.needs.max_depth <= bounces:
        return
    shiny = [i for i in range(len(s.scene.objects)) if _shiny(s, i, bounces)]
    balls = sorted(set(shiny).intersection(s.bodies.object[s.bodies.is_ball].tolist()))
    if len(balls) >= 2 and any(_encloses(s, i) for i in shiny):
        text = f"object {balls[0]} is one of {len(balls)} balls that reflect each other in a closed room"
        yield Finding(
            s.scene.objects[balls[0]].line, f"{text}, for {s.needs.max_depth} bounces (more than {bounces:.0f})"
        )


def _plane_mirrors(s: Situation, limit: float) -> Iterator[Finding]:
    bounces = 1 / limit
    if s.needs.max_depth <= bounces:
        return
    shiny = [i for i in range(len(s.scene.objects)) if _shiny(s, i, bounces)]
    flat = [i for i in shiny if s.needs.planes[i]]
    # A ray that leaves the outside of a lone mirror never comes back to it, nor one that crosses a plate.
    within = flat and s.finish(flat[0]).kt > 0 and not s.needs.plates[flat[0]]
    if flat and (len(shiny) > 1 or within or _encloses(s, flat[0])):
        text = f"object {flat[0]} is a mirror that is followed for {s.needs.max_depth} bounces"
        yield Finding(s.scene.objects[flat[0]].line, f"{text} (more than {bounces:.0f})")


def _encloses(s: Situation, index: int) -> bool:
    shape = s.scene.objects[index].shape
    return s.needs.bounded[index] and shape_kind(shape).contains(shape, s.scene.camera.eye)


REGIONS = (
    Region(("checker-boundary", "texmap-seam"), {"float": 3e-7}, _fine_patterns),
    Region(("grazing-rarer",), {"double": 3e-8, "float": 3e-6}, _near_indices),
    Region(("trapped-ray",), {"double": 1 / 48, "float": 1 / 12, "mesh": 1 / 48}, _curved_mirrors),
    Region(("facing-mirrors",), {"float": 1 / 256, "mesh": 1 / 256}, _plane_mirrors),
)
