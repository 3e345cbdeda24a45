"""The families of the stability study."""

from collections.abc import Mapping

from converter.studies.families import coincidence, contact, distance, lights_and_camera, size
from converter.studies.family import Family

FAMILIES: Mapping[str, Family] = {
    family.name: family
    for families in (size.FAMILIES, distance.FAMILIES, contact.FAMILIES, coincidence.FAMILIES, lights_and_camera.FAMILIES)
    for family in families
}
"""Every family by its name."""
