"""What a scene needs of a renderer, worked out once, so that neither renderer models more than that."""

import sys
from collections.abc import Sequence
from operator import attrgetter

from converter.frozen import dataclass
from converter.scene.depth import DepthLimit, depth_limit, follows
from converter.scene.effects import Effect, scene_effects
from converter.scene.facts import column
from converter.scene.geometry import scene_facts
from converter.scene.kept import kept_with
from converter.scene.model import Color, Finish, Scene, Vector
from converter.scene.settings import IorReading, Settings
from converter.shapes.kind import Facts


@dataclass(frozen=True, slots=True)
class SceneNeeds:
    """What of a scene can be seen at all, and with which mechanisms.

    Attributes:
        pigments, finishes: indices that some object refers to, ascending.
        etas: n1/n2 of every finish of the scene (outside over inside), however its `ior` was written.
        reflects, refracts: a ray may be followed by a reflected, a transmitted one.
        branches: a ray may be followed by both at once.
        lit: a surface has kd or ks > 0 and there is a light: shadow rays are needed.
        glossy: a lit surface has ks > 0: highlights are needed.
        effects: what of distributed ray tracing can be seen, each with what has it first, and where.
        samples: rays per pixel.
        depth: how many bounces to follow after the primary ray, and why.
        background: linear RGB of rays that hit nothing.
        facts: what is known of each object's shape; the columns below are taken from it.
        planes: for each object the indices of the planes that have a face, ascending; for a sphere none, and all for a
            polyhedron that is neither a body nor a plate.
        plates: for each object the two planes between which it is a plate without thickness; for others none.
        boxes: for each object the lower and the upper corner of the box around it, of an unbounded one around its
            vertices (where a face has none, around its point nearest the origin).
        bounded: for each object whether it is, as far as is known.

    """

    pigments: tuple[int, ...]
    finishes: tuple[int, ...]
    etas: tuple[float, ...]
    reflects: bool
    refracts: bool
    branches: bool
    lit: bool
    glossy: bool
    effects: dict[Effect, str]
    samples: int
    depth: DepthLimit
    background: Color
    facts: Sequence[Facts]
    planes: Sequence[tuple[int, ...]]
    plates: Sequence[tuple[int, ...]]
    boxes: Sequence[tuple[Vector, Vector]]
    bounded: Sequence[bool]

    @property
    def max_depth(self) -> int:
        """Bounces to follow after the primary ray."""
        return self.depth.bounces

    @property
    def sampled(self) -> bool:
        """Whether anything is random."""
        return bool(self.effects)

    @property
    def bounces(self) -> bool:
        """Whether anything is traced beyond the first hit."""
        return self.max_depth > 0


def scene_needs(scene: Scene, settings: Settings) -> SceneNeeds:
    """What `scene`, drawn with `settings`, needs; worked out once."""
    kept = kept_with(scene)
    if settings not in kept:
        kept[settings] = _worked_out(scene, settings)
    found: SceneNeeds = kept[settings]
    return found


def _worked_out(scene: Scene, settings: Settings) -> SceneNeeds:
    finishes = tuple(sorted({o.finish for o in scene.objects}))
    used = [scene.finishes[i] for i in finishes]
    largest = max((max(f.kr, f.kt) for f in used), default=0.0)
    reflects = any(follows(f.kr, largest, settings.cutoff) for f in used)
    refracts = any(follows(f.kt, largest, settings.cutoff) for f in used)
    branches = any(follows(min(f.kr, f.kt), largest, settings.cutoff) for f in used)
    facts = scene_facts(scene)
    depth = depth_limit(used, settings)
    bounces = depth.bounces > 0
    lit = bool(scene.lights) and any(f.kd > 0 or f.ks > 0 for f in used)
    spreading = [i for i, f in zip(finishes, used, strict=True) if bounces and _is_left(f, largest, settings.cutoff)]
    effects = scene_effects(scene, lit, spreading)
    return SceneNeeds(
        pigments=tuple(sorted({o.pigment for o in scene.objects})),
        finishes=finishes,
        etas=tuple(eta(f, settings.ior) for f in scene.finishes),
        reflects=reflects and bounces,
        refracts=refracts and bounces,
        branches=branches and bounces,
        lit=lit,
        glossy=bool(scene.lights) and any(f.ks > 0 for f in used),
        effects=effects,
        samples=settings.rays_a_pixel(bool(effects)),
        depth=depth,
        background=scene.ambient if settings.background is None else settings.background,
        facts=facts,
        planes=column(facts, attrgetter("planes")),
        plates=column(facts, attrgetter("plate")),
        boxes=column(facts, attrgetter("low", "high")),
        bounded=column(facts, attrgetter("bounded")),
    )


def _is_left(finish: Finish, largest: float, cutoff: float) -> bool:
    """Whether a mirrored or a transmitted ray may leave from a finish."""
    return follows(max(finish.kr, finish.kt), largest, cutoff)


def eta(finish: Finish, reading: IorReading) -> float:
    """n1/n2, outside over inside, of a finish; 1 where nothing is transmitted, since `ior` may then be anything."""
    if finish.kt == 0:
        return 1.0
    return min(1 / finish.ior, sys.float_info.max) if is_index(finish, reading) else finish.ior


def is_index(finish: Finish, reading: IorReading) -> bool:
    """Whether a finish's `ior` is read as n2/n1, the material's own index: outside a vacuum n1/n2 is at most 1."""
    return reading == "index" or (reading == "auto" and finish.ior > 1)
