"""Whether it shows in a picture how a finish's `ior` is read."""

from converter.analysis.notices import ior_notices
from converter.frozen import replace
from converter.renderers.native import build_scene, native_module
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.settings import IorReading, Settings

WIDTH, HEIGHT = 64, 48
"""Of the two pictures that are compared: some milliseconds of the native tracer."""
DEEPEST = 4
"""Bounces that they follow: light that is bent shows in the first two."""


def ior_notices_that_show(scene: Scene, settings: Settings) -> list[str]:
    """`ior_notices`, if a small picture would differ by a level anywhere, were every `ior` read as n1/n2.

    Raises:
        RendererUnavailable: the native tracer, which draws it both ways, is not built.
        ValueError: a texture cannot be read.

    """
    told = ior_notices(scene, settings)
    if not told:
        return []
    pictures = (_probe(scene, settings, "auto"), _probe(scene, settings, "ratio"))
    return told if any(abs(x - y) > 1 / 255 for x, y in zip(*pictures, strict=True)) else []


def _probe(scene: Scene, settings: Settings, reading: IorReading) -> list[float]:
    """The small picture's channels, clamped to what is seen of them."""
    depth = DEEPEST if settings.max_depth is None else min(DEEPEST, settings.max_depth)
    needs = scene_needs(scene, replace(settings, max_depth=depth, ior=reading))
    tracer = native_module()
    image = tracer.Image(WIDTH, HEIGHT)
    tracer.render(build_scene(scene, needs), image, cutoff=settings.cutoff, max_depth=needs.max_depth)
    pixels = memoryview(image.pixels).cast("B").cast("f")
    return [min(max(x, 0.0), 1.0) for x in pixels]
