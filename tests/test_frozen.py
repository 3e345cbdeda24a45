"""Frozen dataclasses of our own behave as those of `dataclasses`."""

import copy
import dataclasses
import pickle
from typing import Any, ClassVar

import pytest

from converter import frozen
from converter.scene.model import Scene, Sphere
from converter.scene.settings import Settings


@frozen.dataclass(frozen=True, slots=True, weakref_slot=True)
class Ours:
    shared: ClassVar[int] = 7

    first: int
    second: tuple[int, ...] = (1, 2)
    third: dict[str, int] = frozen.field(default_factory=dict)
    line: int = frozen.field(default=0, compare=False)


@dataclasses.dataclass(frozen=True, slots=True, weakref_slot=True)
class Theirs:
    shared: ClassVar[int] = 7

    first: int
    second: tuple[int, ...] = (1, 2)
    third: dict[str, int] = dataclasses.field(default_factory=dict)
    line: int = dataclasses.field(default=0, compare=False)


def outcome(call: Any) -> Any:
    """What a call gives, or the kind of its error."""
    try:
        return call()
    except Exception as error:
        return type(error).__mro__[:2]


@pytest.mark.parametrize(
    "call",
    [
        lambda c: repr(c(1)).partition("(")[2],
        lambda c: repr(c(1, (3,), {"a": 1}, line=5)).partition("(")[2],
        lambda c: c(),
        lambda c: c(1, fourth=2),
        lambda c: (c(1) == c(1, line=3), c(1) == c(2), c(1) != c(1), c(1) == 1),
        lambda c: c(1).third is c(1).third,
        lambda c: hash(c(1)),
        lambda c: setattr(c(1), "first", 2),
        lambda c: delattr(c(1), "first"),
        lambda c: c(1).__dict__,
        lambda c: (c.shared, c(1).shared, c.__match_args__, c.__slots__),
        lambda c: dataclasses.asdict(c(4)),
        lambda c: [(f.name, f.type, f.compare) for f in dataclasses.fields(c)],
        lambda c: repr(dataclasses.replace(c(1, (9,)), first=2)).partition("(")[2],
        lambda c: repr(frozen.replace(c(1, (9,), line=4), first=2)).partition("(")[2],
        lambda c: frozen.replace(c(1), none=2),
        lambda c: copy.deepcopy(c(1, (9,))) == pickle.loads(pickle.dumps(c(1, (9,)))) == c(1, (9,)),
        lambda c: c.__init__.__annotations__,
    ],
)
def test_as_dataclasses(call: Any) -> None:
    assert outcome(lambda: call(Ours)) == outcome(lambda: call(Theirs))


def test_equal_records_hash_alike_and_others_are_not_equal() -> None:
    assert hash(Sphere((0, 0, 0), 1)) == hash(Sphere((0, 0, 0), 1.0))
    assert Settings(800) == Settings() != Settings(801)
    assert {field.name for field in dataclasses.fields(Scene)} >= {"camera", "notes"}
