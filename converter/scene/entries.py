"""One light, one pigment, one finish, one object: how each is read, and which values it may have.

A reader function takes a `Reader`, the index of the entry's first word and the entry's number in its section, and gives
the entry and the index after its last word. What is wrong with a value is noted, and reading goes on with NaN in its
place; where the words no longer say what belongs to what, `Lost` is raised, and the caller looks for the next place
that can be read. A new pigment or shape is one such function and one line in `PIGMENTS` or `SHAPES`.
"""

from array import array
from collections import defaultdict
from collections.abc import Callable
from functools import lru_cache
from math import hypot, isfinite, sqrt
from pathlib import Path
from typing import NamedTuple

from converter.scene.errors import place, shown
from converter.scene.model import (
    Camera,
    Checker,
    Finish,
    Light,
    Object,
    Pigment,
    Plane,
    Polyhedron,
    Shape,
    Solid,
    Sphere,
    Texmap,
    Vector,
)
from converter.scene.tokens import (
    COMMENT_HINT,
    HUGE,
    NOT_FINITE,
    SEPARATOR_HINT,
    Words,
    found,
    hint,
    number,
    whole,
    why_no_number,
)

NOT_YET = "an addition to the format that is not supported yet"
MOST_NOTED = 1000
"""Problems that are kept, so that a large file of nothing else takes little room: those told are the first of them."""
MOST_PLANES = 1024
"""Planes that are read at once."""
PIGMENT_INDEX, FINISH_INDEX = "the pigment index", "the finish index"
OBJECT_HEAD = (PIGMENT_INDEX, FINISH_INDEX, "sphere or polyhedron")


_DIGITS = {sign + str(k): float(sign + str(k)) for sign in ("", "-") for k in range(10)}
"""Numbers that scenes are full of: each is one object, wherever it stands."""


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
        text: the words with their places.
        folder: where texture files are looked for.
        limit: index after the last word that may be taken.
        problems: address of a word and what is wrong with it, `MOST_NOTED` of them at most.
        unnoted: how many more there are.
        misread: how many of all these are about words that are missing or left over.
        notes, warnings: what the scene's reader should be told although nothing is wrong.
        textures: address of the name of each texmap's file, by the pigment's number.
        plane_lines: the line of each `plane`, which is another spelling of a polyhedron.
        light_lines, pigment_lines, finish_lines: the line of each light, pigment and finish.
        announced: the last count that was read, and is 0 if it was none.
        pigments, finishes: how many an object can choose from.
    """

    def __init__(self, text: Words) -> None:
        self.text = text
        self.folder = Path() if text.file is None else text.file.parent
        self.limit = HUGE
        self.problems: list[tuple[int, str]] = []
        self.unnoted = 0
        self.misread = 0
        self.notes: list[str] = []
        self.warnings: list[str] = []
        self.textures: dict[int, int] = {}
        self.plane_lines = array("q")
        self.light_lines = array("q")
        self.pigment_lines = array("q")
        self.finish_lines = array("q")
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
        kept = MOST_NOTED - len(self.problems)
        self.unnoted += attempt.unnoted + max(0, len(attempt.problems) - kept)
        self.problems += attempt.problems[:kept]
        self.misread += attempt.misread
        self.notes += attempt.notes
        self.warnings += attempt.warnings
        self.textures.update(attempt.textures)
        self.plane_lines += attempt.plane_lines
        self.light_lines += attempt.light_lines
        self.pigment_lines += attempt.pigment_lines
        self.finish_lines += attempt.finish_lines
        self.announced = attempt.announced
        self._indices.update(attempt._indices)

    def complain(self, at: int, message: str) -> None:
        """Note that something is wrong with the word `at`."""
        if len(self.problems) < MOST_NOTED:
            self.problems.append((at, message))
        else:
            self.unnoted += 1

    def misreads(self, at: int, message: str) -> None:
        """Note that words are missing or left over at the word `at`."""
        self.misread += 1
        self.complain(at, message)

    @property
    def used_pigments(self) -> set[int]:
        """Numbers of the pigments that the objects read so far have."""
        return set(self._indices[PIGMENT_INDEX].values())

    def has(self, at: int) -> bool:
        """Whether there is a word `at` that may be taken."""
        return at < self.limit and self.text.has(at)

    def after(self, at: int, count: int) -> int:
        """Index after so many words, or of the last that may be taken."""
        return min(at + len(self.text.cut(at, count)), self.limit)

    def word(self, at: int, expected: str) -> str:
        """The word `at`, which must be there."""
        if at < self.limit and (word := self.text.peek(at)):
            return word
        last = at - 1 if self.text.has(at) else at  # not on the next line
        raise Lost(last, f"expected {expected}, found {self.ending(at)}")

    def ending(self, at: int) -> str:
        """What stands at the limit, in words for a message."""
        if not self.text.has(at):
            return "the end of the file"
        return shown(self.text[at]) if is_name(self.text[at]) else "the end of the line"

    def numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        """The numbers from the word `at` on, NaN for each that is none; `head` is the word that asks for them."""
        return self.good_numbers(at, len(wanted.fields)) or self._faulty_numbers(at, wanted, head)

    def good_numbers(self, at: int, count: int) -> tuple[float, ...] | None:
        """So many numbers, if so many words follow from the word `at` on, and every one of them is a number."""
        words = self.text.cut(at, count)
        if len(words) < count or at + count > self.limit:
            return None
        try:
            values = tuple([_DIGITS[word] if word in _DIGITS else float(word) for word in words])
        except ValueError:
            return None
        plain = self.text.plain or not any("_" in word or not word.isascii() for word in words)  # see `number`
        return values if plain and isfinite(sum(values)) else None  # if the sum is finite, every term is

    def _faulty_numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        count = len(wanted.fields)
        words = self.text.cut(at, max(0, min(count, self.limit - at)))
        taken = next((i for i, word in enumerate(words) if word in KEYWORDS), len(words))
        values = tuple(map(number, words[:taken]))
        bad = [i for i, value in enumerate(values) if value != value]
        for i in bad:
            if hint(words[i]) in (COMMENT_HINT, SEPARATOR_HINT):  # so the numbers behind it stand in the wrong places
                raise Lost(at + i, f"expected {wanted.owner}'s {wanted.fields[i]}, {found(words[i])}")
        if len(bad) * 2 > taken and not has_digits(words[bad[0]]):  # this is something else: one message will do
            raise Lost(at + bad[0], f"expected {wanted.owner}'s {wanted.fields[bad[0]]}, {found(words[bad[0]])}")
        if taken < count:
            plural = "" if count == 1 else "s"
            told = f"{wanted.owner} needs {count} number{plural} for {wanted.purpose}"
            raise Lost(head, f"{told}, found {taken} before {self.ending(at + taken)}")
        for i in bad:
            self.complain(at + i, f"{wanted.owner}'s {wanted.fields[i]} must be a number, {why_no_number(words[i])}")
        return values

    def several(self, at: int, expected: tuple[str, ...]) -> list[str]:
        """A word for each of those expected, the first at `at`; all must be there."""
        words = self.text.cut(at, len(expected))
        there = min(len(words), self.limit - at)
        return words if there == len(expected) else [self.word(at + k, what) for k, what in enumerate(expected)]

    def index(self, at: int, word: str, what: str, count: int) -> int:
        """The index that the word `at` is, of one of `count` things; `what` is its name."""
        good = self._indices[what]
        if word in good:
            return good[word]
        value = whole(word)
        if value is None:
            if is_name(word) or hint(word) == COMMENT_HINT:
                raise Lost(at, f"expected {what}, {found(word)}")
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


def has_digits(word: str) -> bool:
    """Whether a word may mean to be a number, however badly written."""
    return any(c.isdigit() for c in word) or word.lower().lstrip("+-") in NOT_FINITE


# ---------------------------------------------------------------------------------------------------- camera, lights


def camera(reader: Reader, starts: tuple[int, int, int, int]) -> Camera:
    """The camera, given the first word of each of its four lines."""
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
    return Camera((eye[0], eye[1], eye[2]), (look_at[0], look_at[1], look_at[2]), (up[0], up[1], up[2]), fovy[0])


def light(reader: Reader, at: int, k: int) -> tuple[Light, int]:
    """A light; the first one is the ambient light, of which only the colour counts."""
    x, y, z, red, green, blue, a, b, c = reader.numbers(at, LIGHT, at)
    reader.light_lines.append(reader.text.line(at))
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
    reader.pigment_lines.append(reader.text.line(at))
    word = reader.word(at, "a pigment (solid, checker or texmap)")
    if word not in PIGMENTS:
        raise Lost(at, f"expected solid, checker or texmap, {found(word, PIGMENTS)}")
    return PIGMENTS[word].read(reader, at, k)


def _solid(reader: Reader, at: int, k: int) -> tuple[Pigment, int]:
    red, green, blue = reader.numbers(at + 1, SOLID, at)
    return Solid((red, green, blue)), at + 4


def _checker(reader: Reader, at: int, k: int) -> tuple[Pigment, int]:
    r, g, b, red, green, blue, size = reader.numbers(at + 1, CHECKER, at)
    if size <= 0:
        reader.complain(at + 7, f"the checker's size must be above 0, found {shown(reader.text[at + 7])}")
    return Checker((r, g, b), (red, green, blue), size), at + 8


def _texmap(reader: Reader, at: int, k: int) -> tuple[Pigment, int]:
    name = reader.word(at + 1, "a texture file")
    following = reader.word(at + 2, "P0 and P1")
    if is_name(following) and following not in KEYWORDS:
        raise Lost(at + 2, f"a texture's name is one word: unexpected {shown(following)} after {shown(name)}")
    reader.textures[k] = at + 1
    a, b, c, d, e, f, g, h = reader.numbers(at + 2, TEXMAP, at + 1)
    where = place(reader.text.file, reader.text.line(at + 1))
    return Texmap(_file_beside(reader.folder, name), (a, b, c, d), (e, f, g, h), where), at + 10


@lru_cache(maxsize=1024)  # a texture may have many pigments, which share its name then
def _file_beside(folder: Path, name: str) -> Path:
    return folder / name


def finish(reader: Reader, at: int, k: int) -> tuple[Finish, int]:
    """A finish."""
    values = reader.numbers(at, FINISH, at)
    reader.finish_lines.append(reader.text.line(at))
    for i in range(6):
        if values[i] < 0:
            message = f"{FINISH.fields[i]} must not be negative, found {shown(reader.text[at + i])}"
            reader.complain(at + i, message)
    ka, kd, ks, alpha, kr, kt, ior = values
    if kt > 0 and ior <= 0:
        reader.complain(at + 6, f"a finish with kt above 0 needs an ior above 0, found {shown(reader.text[at + 6])}")
    return Finish(ka, kd, ks, alpha, kr, kt, ior), at + 7


# ------------------------------------------------------------------------------------------------------------- objects


def object_(reader: Reader, at: int, k: int) -> tuple[Object | None, int]:
    """An object: its two indices, its shape; None for one that a later format has."""
    first, second, word = reader.several(at, OBJECT_HEAD)
    pigment = reader.index(at, first, PIGMENT_INDEX, reader.pigments)
    finish = reader.index(at + 1, second, FINISH_INDEX, reader.finishes)
    shape: Shape | None
    if word in SHAPES:
        shape, end = SHAPES[word](reader, at + 2)
    elif word == "quadric":
        reader.complain(at + 2, f"quadric is {NOT_YET}")
        shape, end = None, reader.after(at, 13)
    elif word == "csg":
        raise Lost(at + 2, f"csg is {NOT_YET}")
    else:
        raise Lost(at + 2, f"expected sphere or polyhedron, {found(word, SHAPES)}")
    if reader.text.peek(end) == "move" and end < reader.limit:
        reader.complain(end, f"move is {NOT_YET}")
        end = reader.after(end, 4)
    return (None if shape is None else Object(pigment, finish, shape, reader.text.line(at))), end


def _sphere(reader: Reader, at: int) -> tuple[Shape, int]:
    x, y, z, radius = reader.numbers(at + 1, SPHERE, at)
    if radius <= 0:
        reader.complain(at + 4, f"the radius must be above 0, found {shown(reader.text[at + 4])}")
    return Sphere((x, y, z), radius), at + 5


def _polyhedron(reader: Reader, at: int) -> tuple[Shape, int]:
    word = reader.word(at + 1, "the polyhedron's number of planes")
    count = whole(word)
    if not count:
        raise Lost(at + 1, f"the polyhedron's number of planes must be a whole number from 1 on, found {shown(word)}")
    head = at + 1
    at += 2
    planes: list[Plane] = []
    while len(planes) < count:
        size = min(count - len(planes), MOST_PLANES)
        if values := reader.good_numbers(at, 4 * size):
            several = list(zip(values[::4], values[1::4], values[2::4], values[3::4], strict=True))
            if not any(a == b == c == 0 for a, b, c, _ in several):
                planes += several
                at += 4 * size
                continue
        for _ in range(size):
            following = reader.text.cut(at, max(0, min(3, reader.limit - at)))
            if not following or following[0] in KEYWORDS or (following[2:] and following[2] in SHAPES):
                raise Lost(head, f"{announced(word)}, found {len(planes)} before {reader.ending(at)}")
            planes.append(_plane_of(reader, at))
            at += 4
    return Polyhedron(tuple(planes)), at


def _plane(reader: Reader, at: int) -> tuple[Shape, int]:
    """A half-space as some other programs of the course have it."""
    plane = _plane_of(reader, at + 1)
    reader.plane_lines.append(reader.text.line(at))
    return Polyhedron((plane,)), at + 5


def _plane_of(reader: Reader, at: int) -> Plane:
    a, b, c, d = reader.numbers(at, PLANE, at)
    if a == b == c == 0:
        reader.complain(at, "a plane's normal (its first three numbers) must not be zero")
    return a, b, c, d


def announced(word: str) -> str:
    """`5 planes are announced`, for the word that says so."""
    return f"{shown(word)[1:-1]} {'plane is' if whole(word) == 1 else 'planes are'} announced"


class PigmentKind(NamedTuple):
    """How one kind of pigment is read: how many words stand before its numbers, these, and its reader function."""

    before: int
    numbers: Numbers
    read: Callable[[Reader, int, int], tuple[Pigment, int]]


PIGMENTS = {
    "solid": PigmentKind(1, SOLID, _solid),
    "checker": PigmentKind(1, CHECKER, _checker),
    "texmap": PigmentKind(2, TEXMAP, _texmap),
    "textmap": PigmentKind(2, TEXMAP, _texmap),  # found in real files
}
SHAPES: dict[str, Callable[[Reader, int], tuple[Shape, int]]] = {
    "sphere": _sphere,
    "polyhedron": _polyhedron,
    "plane": _plane,  # found in real files: a polyhedron of one plane
}
KEYWORDS = frozenset([*PIGMENTS, *SHAPES, "quadric", "csg", "move"])
"""Words that never stand where a number belongs: a number that is missing before one is noticed there."""
