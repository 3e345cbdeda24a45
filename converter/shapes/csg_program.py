"""A csg as a Boolean expression over primitives, its leaves, in the order of a stack machine.

What is one surface is one leaf, so that its crossings have one distance: equal balls, equal quadrics, polyhedra of the
same planes. Leaves that change nothing are left out, as far as that can be told: by all combinations of inside and
outside that the leaves' places allow (`csg_relations`), which are gone through at once, a bit each of a whole number.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple, TypeVar

from converter.scene.model import Csg, Operand, Plane, Polyhedron, Primitive, Quadric, Sphere
from converter.shapes.csg_relations import Relation, relations
from converter.shapes.kind import Facts
from converter.shapes.primitives import PRIMITIVE_KINDS, primitive_kind
from converter.shapes.same_surfaces import same_ball, same_planes, same_quadric, sign_of

T = TypeVar("T")

UNION, DIFFERENCE, INTERSECTION = -1, -2, -3
OPERATIONS = {"+": UNION, "-": DIFFERENCE, "&": INTERSECTION}
MOST_COMBINED = 16
"""Leaves of which all combinations are gone through."""

Code = tuple[int, ...]
"""Postfix: a number from 0 on pushes that leaf, each of the operations takes two from the stack, and pushes one."""
NOTHING: Code = ()
EVERYTHING: Code = (-4,)
"""No expression at all, and one that cannot be gone through: it stands for a set that has no surface."""
Path = tuple[int, ...]
"""The index of an operand, of one of its operands, and so on."""


class Program(NamedTuple):
    """What a csg is.

    Attributes:
        leaves: primitives, all different.
        code: the expression; empty where no point is inside.
        facts: what is known of each leaf.
        everything: no leaf matters, and every point is inside; the code is empty then, too.

    """

    leaves: tuple[Primitive, ...]
    code: Code
    facts: tuple[Facts, ...]
    everything: bool = False

    def value(self, inside: Sequence[bool]) -> bool:
        """Whether a point is inside, given of which leaves it is inside."""
        if not self.code:
            return self.everything
        return bool(fold(self.code, lambda k: int(inside[k]), combined_bits))

    @property
    def coincident(self) -> bool:
        """Whether leaves have surfaces in common."""
        surfaces: list[Sequence[float]] = []
        for leaf in self.leaves:
            surfaces += primitive_kind(leaf).planes(leaf)
            if isinstance(leaf, Quadric):
                surfaces.append(leaf.coefficients)
        return len({tuple(sign_of(each) * x for x in each) for each in surfaces}) < len(surfaces)


def fold(code: Code, leaf: Callable[[int], T], combine: Callable[[int, T, T], T]) -> T:
    """What an expression that is not empty gives where `leaf` gives the values of its leaves, and `combine` takes an
    operation and two values.
    """
    stack: list[T] = []
    for k in code:
        if k >= 0:
            stack.append(leaf(k))
        else:
            second = stack.pop()
            stack.append(combine(k, stack.pop(), second))
    (result,) = stack
    return result


def combined_bits(operation: int, a: int, b: int) -> int:
    """Of combinations of inside and outside, a bit each."""
    if operation == UNION:
        return a | b
    return a & ~b if operation == DIFFERENCE else a & b


def written_leaves(shape: Csg) -> Iterator[Primitive]:
    """Its primitives as they are written, one after the other."""
    for operand in shape.operands:
        if isinstance(operand.shape, Csg):
            yield from written_leaves(operand.shape)
        else:
            yield operand.shape


def with_leaves(shape: Csg, leaves: Iterator[Primitive]) -> Csg:
    """The same with other shapes in the places of its primitives."""
    return Csg(
        tuple(
            Operand(operation, with_leaves(s, leaves) if isinstance(s, Csg) else next(leaves))
            for operation, s in ((operand.operation, operand.shape) for operand in shape.operands)
        )
    )


@lru_cache(maxsize=4096)
def program_of(shape: Csg) -> Program:
    """What is left of a csg when all is taken out that changes nothing."""
    leaves, facts, codes = _distinct_leaves(shape)
    program = _used(*_with_polyhedra_merged(leaves, facts, _expression(shape, iter(codes))))
    table = _Table.of(program.leaves, program.facts)
    return program if table is None else _used(program.leaves, program.facts, table.reduced(program.code))


def _used(leaves: Sequence[Primitive], facts: Sequence[Facts], code: Code) -> Program:
    """With the leaves that the code has, in its order."""
    if code == EVERYTHING:
        return Program((), (), (), everything=True)
    used = sorted({k for k in code if k >= 0}, key=code.index)
    places = {k: new for new, k in enumerate(used)}
    return Program(tuple(leaves[k] for k in used), tuple(places.get(k, k) for k in code), tuple(facts[k] for k in used))


@lru_cache(maxsize=256)
def idle_operands(shape: Csg) -> frozenset[Path]:
    """Steps that can be left out, one at a time, as far as that can be told; within one that can, none is named."""
    leaves, facts, codes = _distinct_leaves(shape)
    table = _Table.of(leaves, facts)
    if table is None:
        return frozenset()
    whole = table.bits(_expression(shape, iter(codes)))
    found: set[Path] = set()
    waiting: list[tuple[Path, Csg]] = [((), shape)]
    while waiting:
        path, node = waiting.pop()
        for k, operand in enumerate(node.operands):
            step = (*path, k)
            if table.same(whole, table.bits(_expression(shape, iter(codes), skipped=step))):
                found.add(step)
            elif isinstance(operand.shape, Csg):
                waiting.append((step, operand.shape))
    return frozenset(found)


def _expression(shape: Csg, leaves: Iterator[Code], path: Path = (), skipped: Path | None = None) -> Code:
    """The code of a csg whose leaves have these codes, one step perhaps skipped."""
    code = NOTHING
    for k, operand in enumerate(shape.operands):
        step = (*path, k)
        own = _expression(operand.shape, leaves, step, skipped) if isinstance(operand.shape, Csg) else next(leaves)
        if step != skipped:
            code = _combined_codes(OPERATIONS[operand.operation], code, own)
    return code


def _combined_codes(operation: int, a: Code, b: Code) -> Code:
    """The code of an expression.

    Raises:
        ValueError: it is all but something, for which there is none.

    """
    if EVERYTHING in (a, b):
        if operation == UNION:
            return EVERYTHING
        if operation == INTERSECTION:
            return b if a == EVERYTHING else a
        if b == EVERYTHING:
            return NOTHING
        if b != NOTHING:
            raise ValueError("the complement of something")
        return a
    if a == NOTHING:
        return b if operation == UNION else NOTHING
    if b == NOTHING:
        return NOTHING if operation == INTERSECTION else a
    return (*a, *b, operation)


# ---- Leaves ----------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def _distinct_leaves(shape: Csg) -> tuple[list[Primitive], list[Facts], list[Code]]:
    """The leaves that differ, what is known of each, and for each that is written the code of the one that it is.

    One that has no volume, such as a plate, is nothing.
    """
    leaves: list[Primitive] = []
    facts: list[Facts] = []
    codes: list[Code] = []
    for leaf, fact in _looked_into(_in_shared_numbers(written_leaves(shape))):
        if not fact.drawn or fact.plate:
            codes.append(NOTHING)
            continue
        same = (k for k, other in enumerate(leaves) if _surfaces(other) == _surfaces(leaf))
        k = next(same, len(leaves))
        if k == len(leaves):
            leaves.append(leaf)
            facts.append(fact)
        codes.append((k,))
    return leaves, facts, codes


def _in_shared_numbers(written: Iterator[Primitive]) -> list[Primitive]:
    """Simplified, with the same numbers for what is the same surface."""
    leaves: list[Primitive] = [primitive_kind(leaf).simplified(leaf) for leaf in written]  # type: ignore[misc]
    places = [(i, k) for i, leaf in enumerate(leaves) for k in range(len(primitive_kind(leaf).planes(leaf)))]
    planes = [plane for leaf in leaves for plane in primitive_kind(leaf).planes(leaf)]
    if changed := same_planes(planes):
        rows: dict[int, list[Plane]] = {}
        for at, (i, _) in enumerate(places):
            rows.setdefault(i, []).append(changed.get(at, planes[at]))
        leaves = [primitive_kind(leaf).with_planes(leaf, rows.get(i, ())) for i, leaf in enumerate(leaves)]
    heads: list[Primitive] = []
    for leaf in leaves:
        same = next((found for head in heads if (found := _as_written(leaf, head)) is not None), None)
        heads.append(leaf if same is None else same)
    return heads


def _as_written(leaf: Primitive, head: Primitive) -> Primitive | None:
    match leaf, head:
        case Sphere(), Sphere():
            return head if same_ball(leaf, head) else None
        case Quadric(), Quadric():
            return same_quadric(leaf, head)
    return None


def _looked_into(leaves: list[Primitive]) -> Iterator[tuple[Primitive, Facts]]:
    """Each with its facts; polyhedra without planes that have no face."""
    found = {
        kind: iter(PRIMITIVE_KINDS[kind].facts([leaf for leaf in leaves if type(leaf) is kind]))
        for kind in set(map(type, leaves))
    }
    for leaf in leaves:
        fact = next(found[type(leaf)])
        if fact.planes:
            planes = primitive_kind(leaf).planes(leaf)
            leaf = primitive_kind(leaf).with_planes(leaf, [planes[k] for k in fact.planes])
            fact = fact._replace(planes=tuple(range(len(fact.planes))))
        yield leaf, fact


def _surfaces(leaf: Primitive) -> object:
    """What is equal for leaves that are equal."""
    return frozenset(leaf.planes) if isinstance(leaf, Polyhedron) else leaf


# ---- Polyhedra -------------------------------------------------------------------------------------------------------


class _Part(NamedTuple):
    """A part of an expression: its code, and the half-spaces that it is the intersection of, if it is one."""

    code: Code
    planes: tuple[Plane, ...] | None


def _with_polyhedra_merged(
    leaves: Sequence[Primitive], facts: Sequence[Facts], code: Code
) -> tuple[list[Primitive], list[Facts], Code]:
    """The same with one leaf for what polyhedra have in common, and for one that half-spaces are cut off."""
    merged, known = list(leaves), list(facts)

    def leaf(k: int) -> _Part:
        return _Part((k,), primitive_kind(leaves[k]).planes(leaves[k]) or None)

    def combined(operation: int, a: _Part, b: _Part) -> _Part:
        if a.planes and b.planes:
            if operation == INTERSECTION:
                return _Part(_combined_codes(operation, a.code, b.code), tuple(dict.fromkeys(a.planes + b.planes)))
            if operation == DIFFERENCE and len(b.planes) == 1:
                p, q, r, s = (0.0 - number for number in b.planes[0])
                return _Part(
                    _combined_codes(operation, a.code, b.code), tuple(dict.fromkeys((*a.planes, (p, q, r, s))))
                )
        return _Part(_combined_codes(operation, settled(a), settled(b)), None)

    def settled(part: _Part) -> Code:
        if not part.planes or len(part.code) <= 1:
            return part.code
        for found, fact in _looked_into([Polyhedron(part.planes)]):
            if not fact.drawn or fact.plate:
                return NOTHING
            same = (k for k, other in enumerate(merged) if _surfaces(other) == _surfaces(found))
            k = next(same, len(merged))
            if k == len(merged):
                merged.append(found)
                known.append(fact)
        return (k,)

    return (merged, known, settled(fold(code, leaf, combined))) if code else (merged, known, code)


# ---- All combinations of inside and outside --------------------------------------------------------------------------


class _Table:
    """Which combinations of being inside of leaves there are, a bit each: bit m is that of being inside of leaf k
    wherever m has bit k.
    """

    def __init__(self, leaves: Sequence[Primitive], facts: Sequence[Facts]) -> None:
        self._every = (1 << (1 << len(leaves))) - 1
        self._columns = [self._every // ((1 << (1 << k)) + 1) << (1 << k) for k in range(len(leaves))]
        self._possible = self._every
        for i, j, relation in relations(leaves, facts):
            a, b = self._columns[i], self._columns[j]
            excluded = {
                Relation.APART: a & b,
                Relation.INSIDE: a & ~b,
                Relation.AROUND: b & ~a,
                Relation.COVERING: self._every & ~(a | b),
            }
            self._possible &= ~excluded[relation]

    @classmethod
    def of(cls, leaves: Sequence[Primitive], facts: Sequence[Facts]) -> "_Table | None":
        """None where there would be too many."""
        return cls(leaves, facts) if len(leaves) <= MOST_COMBINED else None

    def bits(self, code: Code) -> int:
        """Where an expression is true."""
        if code in (NOTHING, EVERYTHING):
            return 0 if code == NOTHING else self._every
        return fold(code, self._columns.__getitem__, combined_bits)

    def same(self, one: int, other: int) -> bool:
        """Whether two expressions differ in no combination that there is."""
        return (one ^ other) & self._possible == 0

    def reduced(self, code: Code) -> Code:
        """The same without leaves that may as well be nothing, or everything."""
        whole = self.bits(code)
        for constant in (NOTHING, EVERYTHING):
            if self.same(whole, self.bits(constant)):
                return constant
        for k in sorted(set(code), reverse=True):
            for constant in (NOTHING, EVERYTHING) if k >= 0 else ():
                try:
                    shorter = fold(code, lambda n, k=k, c=constant: c if n == k else (n,), _combined_codes)  # type: ignore[misc]
                except ValueError:
                    continue
                if self.same(whole, self.bits(shorter)):
                    code = shorter
                    break
        return code
