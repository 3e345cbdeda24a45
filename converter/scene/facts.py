"""What is known of the shapes of a scene: worked out once where that takes long, and of balls whenever it is asked for.

Files of a million balls are read: what follows from a ball's own numbers would take more memory than they do.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar, overload

from converter.scene.model import Shape, Sphere
from converter.shapes.kind import Facts
from converter.shapes.table import SHAPE_KINDS

T = TypeVar("T")


class Column(Sequence[T]):
    """A sequence that is worked out item by item: equal to any other with the same items."""

    __slots__ = ("_at", "_length")

    def __init__(self, length: int, at: Callable[[int], T]) -> None:
        self._length, self._at = length, at

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[T]: ...
    def __getitem__(self, index: int | slice) -> T | Sequence[T]:
        places = range(self._length)[index]
        return self._at(places) if isinstance(places, int) else tuple(map(self._at, places))

    def __iter__(self) -> Iterator[T]:
        return map(self._at, range(self._length))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))


def facts_of(shapes: Sequence[Shape]) -> Sequence[Facts]:
    """What is known of each shape. What takes long is worked out at once, kind by kind."""
    ball = SHAPE_KINDS[Sphere]
    kinds = set(map(type, shapes)) - {Sphere}
    found: dict[int, Facts] = {}
    for kind in kinds:
        places = [i for i, shape in enumerate(shapes) if type(shape) is kind]
        found.update(zip(places, SHAPE_KINDS[kind].facts([shapes[i] for i in places]), strict=True))

    def at(index: int) -> Facts:
        return found[index] if index in found else ball.facts([shapes[index]])[0]

    return Column(len(shapes), at)


def with_facts(facts: Sequence[Facts], changed: dict[int, Shape]) -> Sequence[Facts]:
    """The facts where some shapes are others."""
    others = dict(zip(changed, facts_of(list(changed.values())), strict=True))
    return Column(len(facts), lambda index: others[index] if index in others else facts[index])


def column(facts: Sequence[Facts], take: Callable[[Facts], Any]) -> Sequence[Any]:
    """Something of each of the facts."""
    return Column(len(facts), lambda index: take(facts[index]))
