"""Where the rays of pixels go."""

from collections.abc import Callable

from converter.scene.model import Camera
from converter.scene.settings import Settings
from converter.studies.exact.ties import Decisions
from converter.studies.exact.vectors import Vec, add, cross, dot, scale, subtract


def pixel_directions(camera: Camera, settings: Settings, decide: Decisions) -> Callable[[int, int], Vec]:
    """A function of column and row, from the top left corner on, to the direction of the pixel's ray, of any length.

    Raises:
        Undecided: the numbers cannot express it.

    """
    number, root = decide.number, decide.root
    forward = subtract(decide.vector(camera.look_at), decide.vector(camera.eye))
    right = cross(forward, decide.vector(camera.up))
    up = cross(right, forward)
    # To the length of `forward`, and to half the height of the window.
    tangent = decide.arithmetic.tangent(number(camera.fovy))
    forward2, right2 = dot(forward, forward), dot(right, right)
    across = tangent * root(forward2 / right2)
    upward = tangent / root(right2)
    width, height = settings.width, settings.height
    shift = number(0.5 if settings.pixel == "center" else 0.0)

    def direction(column: int, row: int) -> Vec:
        x = (2 * (column + shift) - width) / height
        y = (height - 2 * (row + shift)) / height
        return add(forward, add(scale(right, x * across), scale(up, y * upward)))

    return direction
