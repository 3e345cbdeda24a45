"""."""

from converter.studies.family import Family

FAMILIES: tuple[Family, ...] = ()
