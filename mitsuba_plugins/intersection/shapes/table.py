"""All kinds of shapes."""

from collections.abc import Mapping

from mitsuba_plugins.intersection.shapes import polyhedron, quadric, sphere
from mitsuba_plugins.intersection.shapes.kind import ShapeKind

SHAPE_KINDS: Mapping[str, ShapeKind] = {"sphere": sphere, "planes": polyhedron, "quadric": quadric}
"""The module of each, by the key of its numbers in a description."""
