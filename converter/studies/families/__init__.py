"""The families of the stability study."""

from collections.abc import Mapping

from converter.studies.families import (
    coincidence,
    contact,
    csgs,
    distance,
    incidence,
    lights_and_camera,
    polyhedra,
    quadrics,
    ray_trees,
    reflection,
    refraction,
    sampled,
    size,
    ties,
)
from converter.studies.family import Family

FAMILIES: Mapping[str, Family] = {
    family.name: family
    for module in (
        size,
        ties,
        distance,
        contact,
        coincidence,
        polyhedra,
        quadrics,
        csgs,
        reflection,
        refraction,
        lights_and_camera,
        incidence,
        ray_trees,
        sampled,
        ties,
    )
    for family in module.FAMILIES
}
"""Every family by its name."""
