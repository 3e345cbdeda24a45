"""One light, one pigment, one finish, one object: how each is read, and which values it may have.

A reader function takes a `Reader`, the index of the entry's first word and the entry's number in its section, and gives
the entry and the index after its last word. What is wrong with a value is noted, and reading goes on with NaN in its
place; where the words no longer say what belongs to what, `Lost` is raised, and the caller looks for the next place
that can be read. How each kind of pigment and shape is read stands in `converter.pigments` and `converter.shapes`.
"""

from collections.abc import Mapping
from math import hypot, sqrt

from converter.frozen import replace
from converter.pigments.table import PIGMENT_KINDS, PIGMENT_WORDS
from converter.scene.errors import shown
from converter.scene.fields import MOVE, RGB, Lost, Numbers
from converter.scene.model import Camera, Finish, Light, Object, Pigment, Vector
from converter.scene.reader import FINISH_INDEX, PIGMENT_INDEX, Reader
from converter.scene.tokens import either, found
from converter.shapes.readers import SHAPE_READERS, ShapeReader
from converter.shapes.table import SHAPE_KINDS

PIGMENT_NAMES = either(kind.SPELLINGS[0] for kind in PIGMENT_KINDS.values())
SHAPE_NAMES = either(kind.NAME for kind in SHAPE_KINDS.values())
OBJECT_HEAD = (PIGMENT_INDEX, FINISH_INDEX, SHAPE_NAMES)


EYE = Numbers("the eye", "x, y and z", ("x", "y", "z"))
LOOK_AT = Numbers("the look-at point", "x, y and z", ("x", "y", "z"))
UP = Numbers("the up vector", "x, y and z", ("x", "y", "z"))
FOVY = Numbers("fovy", "the angle of view", ("angle",))
CAMERA = (EYE, LOOK_AT, UP, FOVY)
LENS = Numbers("the lens", "its radius and the distance in focus", ("aperture", "focal distance"))
LIGHT = Numbers(
    "a light",
    "position, colour and attenuation",
    ("x", "y", "z", *RGB, "constant attenuation", "linear attenuation", "quadratic attenuation"),
)
RADIUS = Numbers("a light", "its radius", ("radius",))
FINISH = Numbers("a finish", "ka, kd, ks, alpha, kr, kt and ior", ("ka", "kd", "ks", "alpha", "kr", "kt", "ior"))
CONE = Numbers("a finish", "its cone", ("cone",))
DISPLACEMENT = Numbers(MOVE, "a displacement", ("x", "y", "z"))


# ---------------------------------------------------------------------------------------------------- camera, lights


def camera(reader: Reader, at: int) -> tuple[Camera, int]:
    """The camera, and the index after it."""
    starts = (at, at + 3, at + 6, at + 9)
    eye, look_at, up, fovy = (reader.numbers(at, part, at) for at, part in zip(starts, CAMERA, strict=True))
    if not 0 < fovy[0] < 180 and fovy[0] == fovy[0]:
        message = f"fovy must lie between 0 and 180 degrees, found {shown(reader.text[starts[3]])}"
        reader.complain(starts[3], message)
    view = _direction((look_at[0] / 2 - eye[0] / 2, look_at[1] / 2 - eye[1] / 2, look_at[2] / 2 - eye[2] / 2))
    upward = _direction((up[0], up[1], up[2]))
    if view == (0, 0, 0):
        reader.complain(starts[1], "the look-at point must differ from the eye")
    elif upward == (0, 0, 0):
        reader.complain(starts[2], "the up vector must not be zero")
    else:
        (a, b, c), (x, y, z) = view, upward
        if hypot(b * z - c * y, c * x - a * z, a * y - b * x) < 1e-9:  # the sine of the angle between them
            reader.complain(starts[2], "the up vector must not be parallel to the view direction")
    (aperture, focal), end = lens(reader, at + 10)
    pose = (eye[0], eye[1], eye[2]), (look_at[0], look_at[1], look_at[2]), (up[0], up[1], up[2])
    return Camera(*pose, fovy[0], aperture, focal), end


def lens(reader: Reader, at: int) -> tuple[tuple[float, float], int]:
    """The lens's radius and the distance in focus behind fovy, none where there are none, and the index after them."""
    found = reader.optional(at - 1, at, LENS)
    if found is None:
        return (0.0, 0.0), at
    aperture, focal = found
    _not_negative(reader, at, "the aperture", aperture)
    if aperture > 0 and focal <= 0:
        reader.complain(at + 1, f"the focal distance must be positive, found {shown(reader.text[at + 1])}")
    else:
        _not_negative(reader, at + 1, "the focal distance", focal)
    return (aperture, focal), at + 2


def light(reader: Reader, at: int, k: int) -> tuple[Light, int]:
    """A light; the first one is the ambient light, of which only the colour counts."""
    x, y, z, red, green, blue, a, b, c = reader.numbers(at, LIGHT, at)
    reader.light_lines.append(reader.text.line(at))
    if k and _never_positive(a, b, c):
        reader.complain(at + 6, "the attenuation a + b d + c d^2 must be positive at some distance d")
    found = reader.optional(at, at + 9, RADIUS)
    if found is None:
        return Light((x, y, z), (red, green, blue), (a, b, c)), at + 9
    _not_negative(reader, at + 9, "a light's radius", found[0])
    return Light((x, y, z), (red, green, blue), (a, b, c), found[0]), at + 10


def _not_negative(reader: Reader, at: int, name: str, value: float) -> None:
    if value < 0:
        reader.complain(at, f"{name} must not be negative, found {shown(reader.text[at])}")


def _direction(v: Vector) -> Vector:
    """`v` scaled to length 1, or zero; neither overflows nor underflows on the way."""
    if any(component != component for component in v):
        return v
    largest = max(map(abs, v))
    if largest == 0:
        return (0, 0, 0)
    x, y, z = (component / largest for component in v)
    length = hypot(x, y, z)
    return (x / length, y / length, z / length)


def _never_positive(a: float, b: float, c: float) -> bool:
    """Whether a + b d + c d^2 <= 0 for every d >= 0."""
    if max(a, c) > 0 or a != a or b != b or c != c:
        return False
    # a, c <= 0: only a parabola with its top at d > 0, or a rising line, can still be positive.
    return b <= 0 or (c < 0 and b <= 2 * sqrt(-a) * sqrt(-c))


# -------------------------------------------------------------------------------------------------- pigments, finishes


def pigment(reader: Reader, at: int, k: int) -> tuple[Pigment, int]:
    """A pigment, by its keyword."""
    reader.pigment_lines.append(reader.text.line(at))
    word = reader.word(at, f"a pigment ({PIGMENT_NAMES})")
    if word not in PIGMENT_WORDS:
        raise Lost(at, f"expected {PIGMENT_NAMES}, {found(word, PIGMENT_WORDS)}")
    return PIGMENT_WORDS[word].read(reader, at, k)


def finish(reader: Reader, at: int, k: int) -> tuple[Finish, int]:
    """A finish."""
    values = reader.numbers(at, FINISH, at)
    reader.finish_lines.append(reader.text.line(at))
    for i in range(6):
        _not_negative(reader, at + i, FINISH.fields[i], values[i])
    ka, kd, ks, alpha, kr, kt, ior = values
    if kt > 0 and ior <= 0:
        reader.complain(at + 6, f"a finish with kt above 0 needs an ior above 0, found {shown(reader.text[at + 6])}")
    found = reader.optional(at, at + 7, CONE)
    if found is None:
        return Finish(ka, kd, ks, alpha, kr, kt, ior), at + 7
    cone = found[0]
    if cone < 0 or cone > 90:
        written = shown(reader.text[at + 7])
        reader.complain(at + 7, f"a finish's cone must have a half-angle from 0 to 90 degrees, found {written}")
    return Finish(ka, kd, ks, alpha, kr, kt, ior, cone), at + 8


# ------------------------------------------------------------------------------------------------------------- objects


def object_(reader: Reader, at: int, k: int) -> tuple[Object, int]:
    """An object: its two indices, its shape, and perhaps its displacement."""
    found, end = body(reader, at, SHAPE_READERS)
    reader.aligned = True
    if reader.text.peek(end) != MOVE or end >= reader.limit:
        return found, end
    x, y, z = reader.numbers(end + 1, DISPLACEMENT, end)
    return replace(found, move=(x, y, z)), end + 4


def body(reader: Reader, at: int, readers: Mapping[str, ShapeReader]) -> tuple[Object, int]:
    """An object that stands still, its shape one of those that have readers."""
    first, second, word = reader.several(at, OBJECT_HEAD)
    pigment = reader.index(at, first, PIGMENT_INDEX, reader.pigments)
    finish = reader.index(at + 1, second, FINISH_INDEX, reader.finishes)
    if word not in readers:
        raise Lost(at + 2, f"expected {SHAPE_NAMES}, {found(word, readers)}")
    shape, end = readers[word](reader, at + 2)
    return Object(pigment, finish, shape, reader.text.line(at)), end
