"""What a scene's reader is warned of: regions in which the chosen method is known to fail, and the one that holds."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from converter.analysis.regions import bodies, contacts, light, material, view
from converter.analysis.regions.region import Finding
from converter.analysis.regions.situation import Situation, situation_of
from converter.pigments.table import pigment_kind
from converter.scene.errors import place
from converter.scene.model import Scene
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from converter.renderers.methods import Method

REGIONS = (*bodies.REGIONS, *contacts.REGIONS, *view.REGIONS, *light.REGIONS, *material.REGIONS)

OFFSETS = {"offset": (1.0, 9e-5), "ulp": (0.0, 1.6e-5)}
"""How far off a surface rays start: a number, plus the largest coordinate there, times a number."""


def method_warnings(scene: Scene, settings: Settings, method: "Method") -> tuple[str, ...]:
    """`region_warnings`, and for a method whose rays start off their surfaces a line on what comes of that anywhere."""
    found = list(_offset(situation_of(scene, settings), method.arithmetic))
    return (*region_warnings(scene, settings, method), *_told(scene, method, found))


def region_warnings(scene: Scene, settings: Settings, method: "Method") -> tuple[str, ...]:
    """A line for each region that `scene` enters in which `method` is known to fail, with the worst of what is in it,
    its line in the file, and the method that holds.

    A method with POV-Ray is not known that well, and has none.
    """
    arithmetic = method.arithmetic
    if arithmetic is None:
        return ()
    situation = situation_of(scene, settings)
    with np.errstate(all="ignore"):  # numbers may be as large as they like
        found = [
            finding
            for region in REGIONS
            if arithmetic in region.limits
            for finding in region.find(situation, region.limits[arithmetic])
        ]
    return _told(scene, method, found)


def _told(scene: Scene, method: "Method", found: list[Finding]) -> tuple[str, ...]:
    held = "native" if method.family == "native" else "mitsuba"
    holds = "" if method.arithmetic == "double" else f"; --method {held} holds"
    return tuple(
        f"{place(scene.file, finding.line)}: {finding.text}, where {method.name} is known to fail{holds}"
        for finding in found
    )


def _offset(s: Situation, arithmetic: str | None) -> Iterator[Finding]:
    """What comes of rays that start off their surfaces, in every scene where rays start anywhere, or tiles meet."""
    if arithmetic not in OFFSETS:
        return
    patterned = any(pigment_kind(s.scene.pigments[k]).REPEATS for k in s.needs.pigments)
    if s.needs.lit or s.needs.reflects or s.needs.refracts or patterned:
        constant, factor = OFFSETS[arithmetic]
        corners = np.abs(np.concatenate([s.low, s.high]))
        far = max(float(corners[np.isfinite(corners)].max(initial=0.0)), s.reach)
        text = f"rays start up to {factor * (constant + far):.1g} off surfaces"
        yield Finding(0, f"{text}, and miss contacts, tiles and mirror images by as much")
