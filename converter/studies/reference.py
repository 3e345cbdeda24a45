"""The picture that errors are measured against: the native tracer in long double, with all rays that it can afford."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from converter.compare.metrics import Difference, Pixels, compare_pixels
from converter.renderers.native import NativeRenderer, Precision
from converter.scene.model import Finish, Object, Scene, Solid
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings

DEPTH = 64
"""Bounces of the reference."""
CUTOFFS = tuple(2.0**-power for power in range(8, 41, 4))
"""Cut-offs to choose from where rays split in two, for without one there would be up to 2^64 rays a pixel."""
AFFORDABLE = 10.0
"""Seconds that a picture for a reference may take, by estimate."""
NEGLIGIBLE = 1e-5
"""Weight, root mean square over the pixels, that a reference in long double may leave out."""
SMALLEST = 2.0**-24
"""What float32 pictures lose of a weight of 1."""
PREVIEW = 4800
"""Pixels of the pictures by which the estimate is made, about."""

Tell = Callable[[float], None]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Weight of the rays that were not followed, by pixel, where the pixel itself has weight 1."""

    largest: float
    rms: float


@dataclass(frozen=True, slots=True)
class Reference:
    """A reference, and how far it can be trusted.

    Attributes:
        pixels: the picture.
        precision: what it is drawn in.
        settings: what it is drawn with, its cut-off and depth among them.
        seconds: how long that took.
        left_out: of it; None where kr + kt > 1, so that weights grow without end.
        floor: double against long double: errors below it are no errors. Where the reference is in double, both are
            drawn with a larger cut-off than it.

    """

    pixels: Pixels
    precision: Precision
    settings: Settings
    seconds: float
    left_out: LeftOut | None
    floor: Difference


def draw_reference(scene: Scene, settings: Settings, tell: Tell = lambda share: None) -> Reference:
    """The reference for pictures of `scene` with `settings`; `tell` hears of the finished share (0..1).

    Where every ray has one successor at most, it has no cut-off. Where rays split, it has the smallest of `CUTOFFS`
    that is affordable; and where that leaves out more than is `NEGLIGIBLE`, it is drawn in double with the smallest
    that is affordable so: the rays left out are then a larger error than their rounding.

    Raises:
        RendererUnavailable: the native tracer is not built.
        ValueError: a texture cannot be read.
        Interrupted: Ctrl-C while it was drawing.

    """
    chosen = replace(settings, cutoff=0.0, max_depth=DEPTH, threads=0)
    deeper = None
    if scene_needs(scene, chosen).branches:
        chosen, lost = _affordable(scene, chosen, "long double")
        if lost is not None and lost.rms > NEGLIGIBLE:
            deeper, _ = _affordable(scene, chosen, "double")
    exact = NativeRenderer("long double").render(scene, chosen, lambda share: tell(0.6 * share))
    double = NativeRenderer().render(scene, chosen, lambda share: tell(0.6 + 0.1 * share))
    floor = compare_pixels(np.asarray(exact.pixels), np.asarray(double.pixels))
    precision: Precision = "long double"
    if deeper is not None:
        chosen, precision = deeper, "double"
        exact = NativeRenderer().render(scene, chosen, lambda share: tell(0.7 + 0.2 * share))
    pixels = np.asarray(exact.pixels)
    return Reference(pixels, precision, chosen, exact.seconds["render"], left_out(scene, chosen), floor)


def left_out(scene: Scene, settings: Settings) -> LeftOut | None:
    """Weight of the rays that are not followed; None: there is no such number.

    The same rays are followed in a furnace: a scene whose surroundings have radiance 1, and whose surfaces emit what
    they neither reflect nor transmit, 1 - kr - kt. By induction every ray carries 1 there, so that what a pixel lacks
    of 1 is the weight of the rays it lacks.
    """
    used = {o.finish for o in scene.objects}
    if any(scene.finishes[i].kr + scene.finishes[i].kt > 1 for i in used):
        return None
    drawn = NativeRenderer().render(_furnace(scene), replace(settings, background=(1.0, 1.0, 1.0)))
    lost = np.maximum(1.0 - np.asarray(drawn.pixels, dtype=np.float64), 0.0)
    return LeftOut(float(lost.max()), float(np.square(lost).mean()) ** 0.5)


def _furnace(scene: Scene) -> Scene:
    return replace(
        scene,
        ambient=(1.0, 1.0, 1.0),
        lights=(),
        pigments=(Solid((1.0, 1.0, 1.0)),),
        finishes=tuple(Finish(1 - f.kr - f.kt, 0.0, 0.0, 1.0, f.kr, f.kt, f.ior) for f in scene.finishes),
        objects=tuple(Object(0, o.finish, o.shape, o.line) for o in scene.objects),
    )


def _affordable(scene: Scene, settings: Settings, precision: Precision) -> tuple[Settings, LeftOut | None]:
    """`settings` with the smallest affordable cut-off, and about what that leaves out.

    Cut-offs are tried from large to small, on a small picture: each takes a bounded multiple of the last one's time.
    """
    pixels = settings.width * settings.height
    scale = min(1.0, (PREVIEW / pixels) ** 0.5)
    small = replace(
        settings, width=max(1, round(scale * settings.width)), height=max(1, round(scale * settings.height))
    )
    factor = pixels / (small.width * small.height)
    chosen, lost, seconds_a_ray = CUTOFFS[0], None, 0.0
    for cutoff in CUTOFFS:
        trial = replace(small, cutoff=cutoff)
        rays = NativeRenderer().render(scene, trial).statistics["rays"]
        if cutoff == CUTOFFS[0]:
            seconds_a_ray = NativeRenderer(precision).render(scene, trial).seconds["render"] / rays
        elif rays * factor * seconds_a_ray > AFFORDABLE:
            break
        chosen, lost = cutoff, left_out(scene, trial)
        if lost is not None and lost.largest < SMALLEST:
            break
    return replace(settings, cutoff=chosen), lost
