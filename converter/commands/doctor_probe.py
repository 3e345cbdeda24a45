"""Draws a scene by either renderer, to see whether it works.

    python -m converter.commands.doctor_probe llvm_ad_rgb

Mitsuba does so in a process of its own, see `mitsuba_plugins.trial`.
"""

import sys
import tempfile
from pathlib import Path

from converter.commands.exits import DISAGREE, OK, UNAVAILABLE
from converter.renderers.base import RendererUnavailable, Rendering
from mitsuba_plugins.trial import Trial

SCENE = """
0 2 7   0 .8 0   0 1 0   40
3
.1 .1 .1   .3 .3 .4    1 0 0
5 9 6      1 1 1       1 0 0
-6 5 2     .6 .5 .5    .5 .05 0
3
solid 1 .5 .25
checker .2 .3 .6  .9 .9 .8  .7
texmap texture.ppm   .7 0 0 0   0 .7 0 0
3
.3 .4 .3 20 .2 0 0
.1 .2 .4 90 .3 .6 1.5
.3 .6 0 1 0 0 0
5
1 0 polyhedron 1   0 1 0 0
0 1 sphere -1 1 0 1
2 2 sphere 1.2 .8 -.5 .8
0 1 sphere .6 .4 1.5 .4
2 0 polyhedron 4   1 0 0 -3   -1 0 0 2.2   0 1 0 -1.5   0 0 1 0
"""
"""Several pigments, whose choice is a call in the kernel, an image among them, and rays that branch."""
TEXTURE = b"P6 3 2 255\n" + bytes(range(0, 252, 14))
SIZE = 640, 480
MOST_WRONG = 30
"""Pixels, 1 in 10,000, that may differ from the native tracer's by more than 1/255."""


def try_native() -> Trial:
    """Draw with the native tracer."""
    try:
        rendering = _draw("native")
    except RendererUnavailable as error:
        return Trial(False, str(error))
    return Trial(True, f"works, {_seconds(rendering):.3f} s for a small picture")


def main(variant: str) -> int:
    """Draw in `variant`, and print how that went."""
    try:
        rendering = _draw(variant)
    except RendererUnavailable as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    told = f"{_seconds(rendering):.1f} s for a small picture with an empty kernel cache"
    try:
        reference = _draw("native")
    except RendererUnavailable:
        print(told)
        return OK
    wrong = _disagreeing(reference, rendering)
    if wrong > MOST_WRONG:
        print(f"its picture is wrong: {wrong} of {SIZE[0] * SIZE[1]} pixels", file=sys.stderr)
        return DISAGREE
    print(f"{told}, the same as the native tracer's" + (f" but for {wrong} pixels" if wrong else ""))
    return OK


def _disagreeing(reference: Rendering, rendering: Rendering) -> int:
    import numpy as np

    from converter.compare.metrics import compare_pixels

    return compare_pixels(np.asarray(reference.pixels), np.asarray(rendering.pixels)).disagreeing


def _seconds(rendering: Rendering) -> float:
    return sum(rendering.seconds.values())


def _draw(what: str) -> Rendering:
    """The picture by the native tracer or in a Mitsuba variant."""
    from converter.renderers.mitsuba import MitsubaRenderer
    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import parse_scene
    from converter.scene.settings import Settings

    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "texture.ppm").write_bytes(TEXTURE)
        scene = parse_scene(SCENE, Path(folder, "scene.in"))
        renderer = NativeRenderer() if what == "native" else MitsubaRenderer(what)
        return renderer.render(scene, Settings(*SIZE))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
