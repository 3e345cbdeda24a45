"""Where the numbers of a scene are, by paths such as `objects[3].sphere.radius`.

Indices count from 0, as in the file: `lights[0]` is the ambient light. An entry with a comment at the end of its first
line, or alone on the line above it, also has that as its name: `sun.color`.
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from converter.films.curve import Value
from converter.films.shift import shifted
from converter.scene.errors import did_you_mean
from converter.scene.model import Csg, Object, Operand, Quadric, Scene, Vector

SHIFT = "shift"
"""An object's displacement from where the file has it: a number of it that no file has."""
_ROOTS = ("camera", "lights", "pigments", "finishes", "objects")
_COLORS = ("color", "first", "second", "ambient")
_STEP = re.compile(r"\.([A-Za-z_]\w*)|\[([0-9]{1,9})\]")
_NAME = re.compile(r"[^.\[\]#]+")
_COMMENT = re.compile(r"#\s*(\w[\w -]*?)\s*$")
_LETTERS = {"quadric": "ABCDEFGHIJ", "plane": "abcd", "color": "rgb", "vector": "xyz"}

Steps = tuple[str | int, ...]


class AddressError(Exception):
    """There is nothing at a path; the message says what there could be."""


@dataclass(frozen=True, slots=True)
class Address:
    """Steps from the scene to a number or a row of numbers; with `shift`, to an object that is displaced by it, or by
    its component at the last step.

    Attributes:
        size: how many numbers; 0 is one that is no row.
    """

    steps: Steps
    size: int
    shift: bool = False


# ---------------------------------------------------------------------------------------------------------- to a place


def find_address(scene: Scene, path: str, names: Mapping[str, Sequence[str]]) -> Address:
    """The address that a path means; `names` are those of `names_of`.

    Raises:
        AddressError: there is none.

    """
    head = _NAME.match(path)
    if head is None:
        raise AddressError(f"{path!r} is no path: one begins with {_likely(_ROOTS)}")
    name, at = head[0], head.end()
    if name not in _ROOTS:
        places = names.get(name, ())
        if len(places) != 1:
            if places:
                raise AddressError(f"{name!r} is the name of {' and '.join(places)}")
            hint = did_you_mean(name, (*_ROOTS, *names)) or f": a path begins with {_likely((*_ROOTS, *names))}"
            raise AddressError(f"there is no {name!r}{hint}")
        path = places[0] + path[at:]
        name = places[0].partition("[")[0]
        at = len(name)
    walk = _Walk(scene)
    walk.enter(name)
    while at < len(path):
        step = _STEP.match(path, at)
        if step is None:
            raise AddressError(f"{path!r} is no path from {path[at:]!r} on")
        walk.enter(step[1] if step[2] is None else int(step[2]))
        at = step.end()
    return walk.address()


def names_of(scene: Scene, text: str) -> dict[str, list[str]]:
    """The paths of the entries that have a comment for a name."""
    lines = text.splitlines()
    result: dict[str, list[str]] = defaultdict(list)
    for root, numbers, first in (
        ("lights", scene.light_lines, 1),
        ("pigments", scene.pigment_lines, 0),
        ("finishes", scene.finish_lines, 0),
        ("objects", tuple(o.line for o in scene.objects), 0),
    ):
        for k, line in enumerate(numbers, first):
            name = _name_at(lines, line)
            if name and name not in _ROOTS:
                result[name].append(f"{root}[{k}]")
    return dict(result)


def _name_at(lines: list[str], line: int) -> str | None:
    if not 0 < line <= len(lines):
        return None
    above = lines[line - 2].strip() if line > 1 else ""
    found = _COMMENT.search(lines[line - 1]) or (_COMMENT.match(above) if above.startswith("#") else None)
    return found[1] if found else None


@dataclass(frozen=True, slots=True)
class _AmbientLight:
    """The file's first light, as it can be addressed."""

    color: Any


class _Walk:
    """A way into a scene, step by step, with what it is called so far."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._node: Any = scene
        self._steps: list[str | int] = []
        self._told = ""
        self._kind = "vector"  # what a row of numbers is, for its letters
        self._shift = False

    def enter(self, step: str | int) -> None:
        if self._shift:
            self._enter_row(step)
            return
        if _is_number(self._node):
            raise AddressError(f"{self._told} is one number")
        if isinstance(self._node, Object) and step == SHIFT:
            self._shift, self._node = True, (0.0, 0.0, 0.0)
        elif isinstance(self._node, Object | Operand) and step in _shape_names():
            self._enter_shape(str(step))
        elif isinstance(self._node, Csg) and isinstance(step, int):
            self._take("operands")
            self._enter_list(step)
        elif isinstance(self._node, Quadric) and (isinstance(step, int) or len(step) == 1):
            self._take("coefficients")
            self._kind = "quadric"
            self._enter_row(step)
        elif is_dataclass(self._node):
            self._enter_field(step)
        elif _is_row(self._node):
            self._enter_row(step)
        else:
            self._enter_list(step)
        self._told += f"[{step}]" if isinstance(step, int) else f".{step}" if self._told else step

    def address(self) -> Address:
        node = self._node
        if _is_number(node):
            return Address(tuple(self._steps), 0, self._shift)
        if _is_row(node):
            return Address(tuple(self._steps), len(node), self._shift)
        raise AddressError(f"{self._told} is no number: there {self._there()}")

    def _take(self, step: str | int) -> None:
        self._node = self._node[step] if isinstance(step, int) else getattr(self._node, step)
        self._steps.append(step)

    def _enter_shape(self, name: str) -> None:
        found = type(self._node.shape).__name__.lower()
        if name != found:
            raise AddressError(f"{self._told} is a {found}, not a {name}")
        self._take("shape")

    def _enter_field(self, step: str | int) -> None:
        names = _field_names(self._node)
        if step not in names:
            what = self._told or "the scene"
            raise AddressError(f"{what} has no {step!r}{did_you_mean(str(step), names)}: there {self._there()}")
        if isinstance(self._node, _AmbientLight):
            self._node = self._scene
            self._take("ambient")
        else:
            self._take(str(step))
        self._kind = "color" if step in _COLORS else "planes" if step == "planes" else "vector"

    def _enter_list(self, step: str | int) -> None:
        count = len(self._node)
        if self._told == "lights":
            count += 1
            if step == 0:
                self._node, self._steps = _AmbientLight(self._scene.ambient), []
                return
            if isinstance(step, int) and step < count:
                self._take(step - 1)
                return
        if not isinstance(step, int) or step >= count:
            numbers = f"numbers from 0 to {count - 1}" if count else "none"
            raise AddressError(f"{self._told} has no {step!r}: there are {numbers}, as in {self._told}[0]")
        self._take(step)
        if self._kind == "planes":
            self._kind = "plane"

    def _enter_row(self, step: str | int) -> None:
        letters = _LETTERS[self._kind] if len(self._node) == len(_LETTERS.get(self._kind, "")) else ""
        index = letters.find(step) if isinstance(step, str) and len(step) == 1 else step
        if not isinstance(index, int) or not 0 <= index < len(self._node):
            also = f" or a letter of {letters!r}" if letters else ""
            raise AddressError(f"{self._told} has no {step!r}: there are 0 to {len(self._node) - 1}{also}")
        self._take(index)

    def _there(self) -> str:
        node = self._node
        if is_dataclass(node):
            names = list(_field_names(node))
            if isinstance(node, Object | Operand):
                names.insert(0, type(node.shape).__name__.lower())
                names += [SHIFT] if isinstance(node, Object) else []
            if isinstance(node, Csg):
                return f"are {self._told}[0] to {self._told}[{len(node.operands) - 1}]"
            if isinstance(node, Quadric):
                return f"are {self._told}.A to {self._told}.J"
            return f"is {_likely([f'{self._told}.{name}'.removeprefix('.') for name in names])}"
        return f"is {self._told}[0] and so on"


def _is_number(node: Any) -> bool:
    return isinstance(node, float | int)


def _is_row(node: Any) -> bool:
    return isinstance(node, tuple) and bool(node) and all(map(_is_number, node))


def _shape_names() -> tuple[str, ...]:
    return ("sphere", "polyhedron", "quadric", "csg")


def _field_names(node: Any) -> tuple[str, ...]:
    """The fields of an entry that are numbers, or lead to some."""
    if isinstance(node, Scene):
        return _ROOTS
    hidden = {"file", "place", "line", "shape", "pigment", "finish", "operation"}
    return tuple(field.name for field in fields(node) if field.name not in hidden)


def _likely(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


# ------------------------------------------------------------------------------------------------------ from a place


def read(scene: Scene, address: Address) -> Value:
    """The numbers at an address."""
    if address.shift:
        return (0.0,) * (address.size or 1)
    node: Any = scene
    for step in address.steps:
        node = node[step] if isinstance(step, int) else getattr(node, step)
    return tuple(map(float, node)) if address.size else (float(node),)


def changed(scene: Scene, changes: Sequence[tuple[Address, Value]]) -> Scene:
    """The scene with other numbers at some addresses; what is displaced is so after all else."""
    shifts: dict[int, list[float]] = {}
    for address, value in changes:
        if not address.shift:
            scene = _put(scene, address.steps, value if address.size else value[0])
            continue
        by = shifts.setdefault(int(address.steps[1]), [0.0, 0.0, 0.0])
        for k, number in zip(address.steps[2:] or range(3), value, strict=True):
            by[int(k)] = number
    for index, (x, y, z) in shifts.items():
        shape = shifted(scene.objects[index].shape, (x, y, z))
        scene = _put(scene, ("objects", index, "shape"), shape)
    return scene


def _put(node: Any, steps: Steps, value: Any) -> Any:
    if not steps:
        return value
    step, rest = steps[0], steps[1:]
    if isinstance(step, int):
        return (*node[:step], _put(node[step], rest, value), *node[step + 1 :])
    return replace(node, **{step: _put(getattr(node, step), rest, value)})


def moved_object(address: Address) -> int | None:
    """The object that a change at this address displaces as a whole, if it does one."""
    steps = address.steps
    if address.shift or steps[2:4] == ("shape", "center"):
        return int(steps[1])
    return None


def displacement(address: Address, before: Value, after: Value) -> Vector:
    """By how much, where its value changes."""
    result = [0.0, 0.0, 0.0]
    last = address.steps[-1]
    components: Iterator[int] = iter([last] if not address.size and isinstance(last, int) else range(3))
    for k, a, b in zip(components, before, after, strict=True):
        result[k] = b - a
    return (result[0], result[1], result[2])
