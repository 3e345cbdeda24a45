"""Shapes displaced."""

from dataclasses import replace

from converter.scene.model import Csg, Polyhedron, Quadric, Shape, Sphere, Vector


def shifted(shape: Shape, by: Vector) -> Shape:
    """The shape, displaced."""
    x, y, z = by
    match shape:
        case Sphere(center=center):
            return replace(shape, center=(center[0] + x, center[1] + y, center[2] + z))
        case Polyhedron(planes=planes):
            return Polyhedron(tuple((a, b, c, d - (a * x + b * y + c * z)) for a, b, c, d in planes))
        case Quadric(coefficients=coefficients):
            a, b, c, d, e, f, g, h, i, j = coefficients
            gradient = (2 * a * x + d * y + e * z, d * x + 2 * b * y + f * z, e * x + f * y + 2 * c * z)
            quadratic = (gradient[0] * x + gradient[1] * y + gradient[2] * z) / 2
            linear = (g - gradient[0], h - gradient[1], i - gradient[2])
            return Quadric((a, b, c, d, e, f, *linear, quadratic - (g * x + h * y + i * z) + j))
        case Csg(operands=operands):
            return Csg(tuple(replace(operand, shape=shifted(operand.shape, by)) for operand in operands))
