"""Finishes.

POV-Ray takes from a surface's own colour what the pigment transmits, filters nothing of a totally reflected ray, and
does not reflect such a ray besides. Our model takes nothing, weighs a totally reflected ray with kr + kt, and a
transmitted one with kt. Both agree where the pigment transmits t = kt / (kr + kt), the finish's `refraction`, which
multiplies both kinds of rays, is kr + kt, and `ambient` and `diffuse` are divided by 1 - t.
"""

from converter.scene.model import Finish
from converter.scene.settings import Settings
from converter.to_povray.text import number

LEAST_OPACITY = 2.0**-16
"""With kr = 0 the surface would have no colour left to be multiplied: the totally reflected ray weighs more by this."""


def transmission(finish: Finish) -> tuple[float, float]:
    """What the pigment transmits, and the finish's `refraction`; (0, 1) where kt is 0."""
    if finish.kt == 0:
        return 0.0, 1.0
    refraction = max(finish.kr + finish.kt, finish.kt / (1 - LEAST_OPACITY))
    return min(finish.kt / refraction, 1 - LEAST_OPACITY), refraction


def finish(source: Finish, settings: Settings) -> str:
    """A `finish` block, for a pigment that transmits what `transmission` says."""
    transmitted, refraction = transmission(source)
    opacity = 1 - transmitted
    words = [f"ambient {number(source.ka / opacity)}", f"diffuse {number(source.kd / opacity)}"]
    if source.ks > 0 and settings.specular == "phong":
        words.append(f"phong {number(source.ks)} phong_size {number(source.alpha)}")
    elif source.ks > 0 and source.alpha > 0:
        words.append(f"specular {number(source.ks)} roughness {number(1 / source.alpha)}")
    if source.kr > 0:
        words.append(f"reflection {number(source.kr)}")
    if source.kt > 0:
        words.append(f"refraction {number(refraction)}")
    return f"finish {{ {' '.join(words)} }}"
