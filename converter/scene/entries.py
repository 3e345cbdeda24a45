"""One light, one pigment, one finish, one object: how each is read, and which values it may have.

A reader function takes a `Reader`, the index of the entry's first word and the entry's number in its section, and gives
the entry and the index after its last word. What is wrong with a value is noted, and reading goes on with NaN in its
place; where the words no longer say what belongs to what, `Lost` is raised, and the caller looks for the next place
that can be read. A new pigment or shape is one such function and one line in `PIGMENTS` or `SHAPES`.
"""

from collections import defaultdict
from collections.abc import Callable
from math import hypot, isfinite, sqrt
from pathlib import Path
from typing import NamedTuple

from converter.scene.errors import did_you_mean, shown
from converter.scene.model import (
    Camera,
    Checker,
    Finish,
    Light,
    Object,
    Pigment,
    Polyhedron,
    Shape,
    Solid,
    Sphere,
    Texmap,
    Vector,
)
from converter.scene.tokens import NOT_FINITE, Words, number, whole, why_no_number

NOT_YET = "an addition to the format that is not supported yet"


class Lost(Exception):  # noqa: N818 - no error of the program
    """From the word `at` on, nothing says which word belongs to which entry."""

    def __init__(self, at: int, message: str) -> None:
        super().__init__(message)
        self.at = at
        self.message = message


class Numbers(NamedTuple):
    """A run of numbers: whose, what for, and the name of each."""

    owner: str
    purpose: str
    fields: tuple[str, ...]


EYE = Numbers("the eye", "x, y and z", ("x", "y", "z"))
LOOK_AT = Numbers("the look-at point", "x, y and z", ("x", "y", "z"))
UP = Numbers("the up vector", "x, y and z", ("x", "y", "z"))
FOVY = Numbers("fovy", "the angle of view", ("angle",))
CAMERA = (EYE, LOOK_AT, UP, FOVY)
_RGB = ("red", "green", "blue")
LIGHT = Numbers(
    "a light",
    "position, colour and attenuation",
    ("x", "y", "z", *_RGB, "constant attenuation", "linear attenuation", "quadratic attenuation"),
)
FINISH = Numbers("a finish", "ka, kd, ks, alpha, kr, kt and ior", ("ka", "kd", "ks", "alpha", "kr", "kt", "ior"))
SOLID = Numbers("solid", "its colour", _RGB)
CHECKER = Numbers("checker", "two colours and a size", (*_RGB, *_RGB, "size"))
TEXMAP = Numbers("texmap", "P0 and P1", tuple(f"{p}[{i}]" for p in ("P0", "P1") for i in range(4)))
SPHERE = Numbers("sphere", "its centre and radius", ("x", "y", "z", "radius"))
PLANE = Numbers("a plane", "a, b, c and d", ("a", "b", "c", "d"))


class Reader:
    """The words being read, and what has been found wrong with them.

    Attributes:
        text: the words with their places; `words` is its list of them.
        folder: where texture files are looked for.
        limit: index after the last word that may be taken.
        problems: address of a word and what is wrong with it.
        misread: how many of these are about words that are missing or left over.
        textures: the file of each texmap, by the address of its name.
        light_lines, pigment_lines, finish_lines: the line of each light, pigment and finish.
        announced: the last count that was read, and is 0 if it was none.
        pigments, finishes: how many an object can choose from.
    """

    def __init__(self, text: Words) -> None:
        self.text = text
        self.words = text.words
        self.folder = Path() if text.file is None else text.file.parent
        self.limit = len(text.words)
        self.problems: list[tuple[int, str]] = []
        self.misread = 0
        self.textures: dict[int, Path] = {}
        self.light_lines: dict[int, int] = {}
        self.pigment_lines: dict[int, int] = {}
        self.finish_lines: dict[int, int] = {}
        self.announced = 0
        self.pigments = 0
        self.finishes = 0
        self._indices: dict[str, dict[str, int]] = defaultdict(dict)  # those that were good: objects share them

    def attempt(self) -> "Reader":
        """A reader of the same words that has found nothing wrong yet."""
        reader = Reader(self.text)
        reader.pigments, reader.finishes = self.pigments, self.finishes
        return reader

    def adopt(self, attempt: "Reader") -> None:
        """Take over what an attempt has found."""
        self.problems += attempt.problems
        self.misread += attempt.misread
        self.textures.update(attempt.textures)
        self.light_lines.update(attempt.light_lines)
        self.pigment_lines.update(attempt.pigment_lines)
        self.finish_lines.update(attempt.finish_lines)
        self.announced = attempt.announced

    def complain(self, at: int, message: str) -> None:
        """Note that something is wrong with the word `at`."""
        self.problems.append((at, message))

    def misreads(self, at: int, message: str) -> None:
        """Note that words are missing or left over at the word `at`."""
        self.misread += 1
        self.complain(at, message)

    def word(self, at: int, expected: str) -> str:
        """The word `at`, which must be there."""
        if at >= self.limit:
            place = at if at == len(self.words) else at - 1  # not on the next line
            raise Lost(place, f"expected {expected}, found {self.ending(at)}")
        return self.words[at]

    def ending(self, at: int) -> str:
        """What stands at the limit, in words for a message."""
        if at >= len(self.words):
            return "the end of the file"
        return shown(self.words[at]) if is_name(self.words[at]) else "the end of the line"

    def numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        """The numbers from the word `at` on, NaN for each that is none; `head` is the word that asks for them."""
        return self.good_numbers(at, len(wanted.fields)) or self._faulty_numbers(at, wanted, head)

    def good_numbers(self, at: int, count: int) -> tuple[float, ...] | None:
        """So many numbers, if so many words follow from the word `at` on, and every one of them is a number."""
        if at + count > self.limit:
            return None
        words = self.words[at : at + count]
        try:
            values = tuple(map(float, words))
        except ValueError:
            return None
        plain = self.text.plain or not any("_" in word or not word.isascii() for word in words)  # see `number`
        return values if plain and isfinite(sum(values)) else None  # if the sum is finite, every term is

    def _faulty_numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        count = len(wanted.fields)
        words = self.words[at : min(at + count, self.limit)]
        found = next((i for i, word in enumerate(words) if word in KEYWORDS), len(words))
        values = tuple(map(number, words[:found]))
        bad = [i for i, value in enumerate(values) if value != value]
        if len(bad) * 2 > found and not _has_digits(words[bad[0]]):  # this is something else: one message will do
            raise Lost(at + bad[0], f"expected {wanted.owner}'s {wanted.fields[bad[0]]}, found {shown(words[bad[0]])}")
        if found < count:
            plural = "" if count == 1 else "s"
            told = f"{wanted.owner} needs {count} number{plural} for {wanted.purpose}"
            raise Lost(head, f"{told}, found {found} before {self.ending(at + found)}")
        for i in bad:
            self.complain(at + i, f"{wanted.owner}'s {wanted.fields[i]} must be a number, {why_no_number(words[i])}")
        return values

    def index(self, at: int, what: str, count: int) -> int:
        """The index at the word `at`, of one of `count` things; `what` is its name."""
        good = self._indices[what]
        if at < self.limit and self.words[at] in good:
            return good[self.words[at]]
        word = self.word(at, what)
        value = whole(word)
        if value is None:
            if is_name(word):
                raise Lost(at, f"expected {what}, found {shown(word)}")
            self.complain(at, f"{what} must be a whole number, {why_no_number(word)}")
            return 0
        if value >= count:
            there = f"there are {count}, counted from 0" if count > 1 else f"there is {'only 0' if count else 'none'}"
            self.complain(at, f"{what} {shown(word)[1:-1]} is out of range: {there}")
        else:
            good[word] = value
        return value


def is_name(word: str) -> bool:
    """Whether a word means to be a keyword or other name, not a number."""
    return word in KEYWORDS or (len(word) > 2 and word[0].isalpha() and word.lower() not in NOT_FINITE)


def _has_digits(word: str) -> bool:
    return any(c.isdigit() for c in word) or word.lower().lstrip("+-") in NOT_FINITE


# ---------------------------------------------------------------------------------------------------- camera, lights


def camera(reader: Reader, starts: tuple[int, int, int, int]) -> Camera:
    """The camera, given the first word of each of its four lines."""
    eye, look_at, up, fovy = (reader.numbers(at, part, at) for at, part in zip(starts, CAMERA, strict=True))
    if not 0 < fovy[0] < 180 and fovy[0] == fovy[0]:
        message = f"fovy must lie between 0 and 180 degrees, found {shown(reader.words[starts[3]])}"
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
    return Camera((eye[0], eye[1], eye[2]), (look_at[0], look_at[1], look_at[2]), (up[0], up[1], up[2]), fovy[0])


def light(reader: Reader, at: int, k: int) -> tuple[Light, int]:
    """A light; the first one is the ambient light, of which only the colour counts."""
    x, y, z, red, green, blue, a, b, c = reader.numbers(at, LIGHT, at)
    reader.light_lines[k] = reader.text.line(at)
    if k and _never_positive(a, b, c):
        reader.complain(at + 6, "the attenuation a + b d + c d^2 must be positive at some distance d")
    return Light((x, y, z), (red, green, blue), (a, b, c)), at + 9


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
    reader.pigment_lines[k] = reader.text.line(at)
    word = reader.word(at, "a pigment (solid, checker or texmap)")
    if word not in PIGMENTS:
        raise Lost(at, f"expected solid, checker or texmap, found {shown(word)}{did_you_mean(word, tuple(PIGMENTS))}")
    return PIGMENTS[word].read(reader, at)


def _solid(reader: Reader, at: int) -> tuple[Pigment, int]:
    red, green, blue = reader.numbers(at + 1, SOLID, at)
    return Solid((red, green, blue)), at + 4


def _checker(reader: Reader, at: int) -> tuple[Pigment, int]:
    r, g, b, red, green, blue, size = reader.numbers(at + 1, CHECKER, at)
    if size <= 0:
        reader.complain(at + 7, f"the checker's size must be above 0, found {shown(reader.words[at + 7])}")
    return Checker((r, g, b), (red, green, blue), size), at + 8


def _texmap(reader: Reader, at: int) -> tuple[Pigment, int]:
    name = reader.word(at + 1, "a texture file")
    following = reader.word(at + 2, "P0 and P1")
    if is_name(following) and following not in KEYWORDS:
        raise Lost(at + 2, f"a texture's name is one word: unexpected {shown(following)} after {shown(name)}")
    file = reader.folder / name
    reader.textures[at + 1] = file
    a, b, c, d, e, f, g, h = reader.numbers(at + 2, TEXMAP, at + 1)
    return Texmap(file, (a, b, c, d), (e, f, g, h)), at + 10


def finish(reader: Reader, at: int, k: int) -> tuple[Finish, int]:
    """A finish."""
    values = reader.numbers(at, FINISH, at)
    reader.finish_lines[k] = reader.text.line(at)
    for i in range(6):
        if values[i] < 0:
            message = f"{FINISH.fields[i]} must not be negative, found {shown(reader.words[at + i])}"
            reader.complain(at + i, message)
    ka, kd, ks, alpha, kr, kt, ior = values
    if kt > 0 and ior <= 0:
        reader.complain(at + 6, f"a finish with kt above 0 needs an ior above 0, found {shown(reader.words[at + 6])}")
    return Finish(ka, kd, ks, alpha, kr, kt, ior), at + 7


# ------------------------------------------------------------------------------------------------------------- objects


def object_(reader: Reader, at: int, k: int) -> tuple[Object | None, int]:
    """An object: its two indices, its shape; None for one that a later format has."""
    pigment = reader.index(at, "the pigment index", reader.pigments)
    finish = reader.index(at + 1, "the finish index", reader.finishes)
    word = reader.word(at + 2, "sphere or polyhedron")
    shape: Shape | None
    if word in SHAPES:
        shape, end = SHAPES[word](reader, at + 2)
    elif word == "quadric":
        reader.complain(at + 2, f"quadric is {NOT_YET}")
        shape, end = None, min(at + 13, reader.limit)
    elif word == "csg":
        raise Lost(at + 2, f"csg is {NOT_YET}")
    else:
        raise Lost(at + 2, f"expected sphere or polyhedron, found {shown(word)}{did_you_mean(word, tuple(SHAPES))}")
    if end < reader.limit and reader.words[end] == "move":
        reader.complain(end, f"move is {NOT_YET}")
        end = min(end + 4, reader.limit)
    return (None if shape is None else Object(pigment, finish, shape, reader.text.line(at))), end


def _sphere(reader: Reader, at: int) -> tuple[Shape, int]:
    x, y, z, radius = reader.numbers(at + 1, SPHERE, at)
    if radius <= 0:
        reader.complain(at + 4, f"the radius must be above 0, found {shown(reader.words[at + 4])}")
    return Sphere((x, y, z), radius), at + 5


def _polyhedron(reader: Reader, at: int) -> tuple[Shape, int]:
    word = reader.word(at + 1, "the polyhedron's number of planes")
    count = whole(word)
    if not count:
        raise Lost(at + 1, f"the polyhedron's number of planes must be a whole number from 1 on, found {shown(word)}")
    at += 2
    if values := reader.good_numbers(at, 4 * count):
        planes = list(zip(values[::4], values[1::4], values[2::4], values[3::4], strict=True))
        if not any(a == b == c == 0 for a, b, c, _ in planes):
            return Polyhedron(tuple(planes)), at + 4 * count
    planes = []
    for k in range(count):
        following = reader.words[at : min(at + 3, reader.limit)]
        if not following or following[0] in KEYWORDS or following[2:] == ["sphere"] or following[2:] == ["polyhedron"]:
            raise Lost(
                at - 4 * k - 1, f"{shown(word)[1:-1]} planes are announced, found {k} before {reader.ending(at)}"
            )
        a, b, c, d = reader.numbers(at, PLANE, at)
        if a == b == c == 0:
            reader.complain(at, "a plane's normal (its first three numbers) must not be zero")
        planes.append((a, b, c, d))
        at += 4
    return Polyhedron(tuple(planes)), at


class PigmentKind(NamedTuple):
    """How one kind of pigment is read: how many words stand before its numbers, these, and its reader function."""

    before: int
    numbers: Numbers
    read: Callable[[Reader, int], tuple[Pigment, int]]


PIGMENTS = {
    "solid": PigmentKind(1, SOLID, _solid),
    "checker": PigmentKind(1, CHECKER, _checker),
    "texmap": PigmentKind(2, TEXMAP, _texmap),
    "textmap": PigmentKind(2, TEXMAP, _texmap),  # found in real files
}
SHAPES: dict[str, Callable[[Reader, int], tuple[Shape, int]]] = {"sphere": _sphere, "polyhedron": _polyhedron}
KEYWORDS = frozenset([*PIGMENTS, *SHAPES, "quadric", "csg", "move"])
"""Words that never stand where a number belongs: a number that is missing before one is noticed there."""
