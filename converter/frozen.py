"""Frozen dataclasses that are quick to make: `raytrace` draws most scenes faster than `dataclasses` is imported.

To type checkers, and to whoever uses the classes, they are what `dataclasses.dataclass(frozen=True, slots=True)` makes.
Here a class costs one compilation, of `__init__`; what `dataclasses` knows of its fields is made when that asks.
"""

from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any, ClassVar

__all__ = ["dataclass", "field", "replace"]

_CLASS_VAR: Any = ClassVar


class _Field:
    """What a field has besides its type: a default, or what makes one, and whether equality looks at it."""

    def __init__(
        self, *, default: Any = None, default_factory: Callable[[], Any] | None = None, compare: bool = True
    ) -> None:
        self.default, self.factory, self.compare = default, default_factory, compare


def _dataclass(*, frozen: bool, slots: bool, weakref_slot: bool = False, eq: bool = True) -> Callable[[type], type]:
    """Make a class one of frozen records with slots."""
    assert frozen and slots
    return lambda cls: _made(cls, weakref_slot, eq)


def _replace(record: Any, **changes: Any) -> Any:
    """A copy with other values in some fields."""
    kept = {name: getattr(record, name) for name in record.__slots__ if name not in ("__weakref__", *changes)}
    return type(record)(**kept, **changes)


if TYPE_CHECKING:
    from dataclasses import dataclass, field, replace
else:
    dataclass, field, replace = _dataclass, _Field, _replace


class _Described:
    """What `dataclasses` knows of a class, found out when it asks."""

    def __init__(self, annotations: dict[str, Any], fields: dict[str, _Field]) -> None:
        self._annotations, self._fields = annotations, fields
        self._known: dict[str, Any] | None = None

    def __get__(self, record: object, owner: type) -> dict[str, Any]:
        if self._known is None:
            import dataclasses

            members: dict[str, Any] = {"__annotations__": self._annotations}
            for name, each in self._fields.items():
                default = {"default_factory": each.factory} if each.factory else {"default": each.default}
                members[name] = dataclasses.field(**default, compare=each.compare)
            twin: Any = dataclasses.dataclass(type(owner.__name__, (), members))
            self._known = twin.__dataclass_fields__
        return self._known or {}


def _made(cls: type, weakref_slot: bool, eq: bool) -> type:
    annotations = {
        name: each for name, each in cls.__annotations__.items() if getattr(each, "__origin__", None) is not ClassVar
    }
    names = tuple(annotations)
    given = {name: cls.__dict__[name] for name in names if name in cls.__dict__}
    fields = {name: each if isinstance(each, _Field) else _Field(default=each) for name, each in given.items()}
    compared = tuple(name for name in names if name not in fields or fields[name].compare)
    values = attrgetter(*compared)

    def described(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join([f'{name}={getattr(self, name)!r}' for name in names])})"

    def equal(self: Any, other: Any) -> Any:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def refuse(self: Any, name: str, value: Any = None) -> None:
        from dataclasses import FrozenInstanceError

        raise FrozenInstanceError(f"cannot change field {name!r}")

    def state(self: Any) -> list[Any]:
        return [getattr(self, name) for name in names]

    def restore(self: Any, state: list[Any]) -> None:
        for name, value in zip(names, state, strict=True):
            object.__setattr__(self, name, value)

    members = {name: member for name, member in cls.__dict__.items() if name not in (*given, "__dict__", "__weakref__")}
    methods: dict[str, Any] = {"__repr__": described}
    if eq:
        methods |= {"__eq__": equal, "__hash__": lambda self: hash(values(self))}
    members = {
        **methods,
        **members,
        "__slots__": (*names, "__weakref__") if weakref_slot else names,
        "__match_args__": names,
        "__init__": _init(cls, annotations, fields),
        "__setattr__": refuse,
        "__delattr__": refuse,
        "__getstate__": state,
        "__setstate__": restore,
        "__dataclass_fields__": _Described(annotations, fields),
    }
    return type(cls.__name__, cls.__bases__, members)


def _init(cls: type, annotations: dict[str, Any], fields: dict[str, _Field]) -> Callable[..., None]:
    def parameter(name: str) -> str:
        if name not in fields:
            return name
        return f"{name}=None" if fields[name].factory else f"{name}=_fields[{name!r}].default"

    def value(name: str) -> str:
        if name not in fields or not fields[name].factory:
            return name
        return f"_fields[{name!r}].factory() if {name} is None else {name}"

    body = "".join(f"\n _set(self, {name!r}, {value(name)})" for name in annotations)
    scope: dict[str, Any] = {"_fields": fields, "_set": object.__setattr__}
    exec(f"def __init__(self, {', '.join(map(parameter, annotations))}):{body}", scope)
    init: Callable[..., None] = scope["__init__"]
    init.__annotations__ = {**annotations, "return": None}
    init.__qualname__, init.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
    return init
