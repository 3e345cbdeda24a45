"""Where a ray meets a csg, by the definition: whether points half-way between crossings of its surfaces are inside."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cmp_to_key
from itertools import pairwise
from typing import Literal, NamedTuple

from converter.studies.exact.arithmetic import Number
from converter.studies.exact.ties import Decisions

Along = tuple[Number, Number, Number]
"""The numbers a, b and c of a t^2 + 2 b t + c, which is a surface's value along a ray, negative inside."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """Where all of some surfaces, by their indices, have values that are not positive."""

    surfaces: range


@dataclass(frozen=True, slots=True)
class Node:
    """Steps, from nothing on."""

    steps: "tuple[tuple[Literal['+', '-', '&'], Leaf | Node], ...]"


class Met(NamedTuple):
    """Where the whole is entered or left: the distance, a surface, whether from within, and whether others cross
    there, too.
    """

    distance: Number
    surface: int
    inside: bool
    tied: bool


def first_met(node: Node, surfaces: Sequence[Along], decide: Decisions, inside: bool | None = None) -> Met | None:
    """The first change beyond the ray's start. A ray that starts on the whole, and goes on `inside` or outside of it,
    meets what else is at an edge at once, as it does at a polyhedron's.
    """

    def order(one: tuple[Number, int], other: tuple[Number, int]) -> int:
        return decide.sign(one[0] - other[0])

    crossings: list[tuple[Number, int]] = [
        (t, k) for k, along in enumerate(surfaces) for t in _roots(along, decide) if decide.sign(t) > 0
    ]
    crossings.sort(key=cmp_to_key(order))
    groups: list[list[tuple[Number, int]]] = []
    for crossing in crossings:
        if groups and decide.sign(crossing[0] - groups[-1][0][0]) == 0:
            groups[-1].append(crossing)
        else:
            groups.append([crossing])
    if inside is not None:
        ahead = groups[0][0][0] / 2 if groups else 1 + 0 * surfaces[0][2]
        if _contains(node, surfaces, ahead, decide) != inside:
            crossed = list(_crossed_at_start(node, surfaces, 1 if inside else -1, decide))
            if crossed:
                return Met(0 * ahead, crossed[0], inside, len(crossed) > 1)
    if not groups:
        return None
    distances = [group[0][0] for group in groups]
    middles = [(s + t) / 2 for s, t in pairwise([0 * distances[0], *distances])] + [2 * distances[-1]]
    values = (_contains(node, surfaces, t, decide) for t in middles)
    for group, (before, after) in zip(groups, pairwise(values), strict=True):
        if before != after:
            return Met(*group[0], before, len(group) > 1)
    return None


def _roots(along: Along, decide: Decisions) -> Iterator[Number]:
    a, b, c = along
    if decide.sign(a) == 0:
        if decide.sign(b):
            yield -c / (2 * b)
    elif decide.sign(c) == 0:  # the other root is where the ray starts
        yield -2 * b / a
    else:
        discriminant = b * b - a * c
        sign = decide.sign(discriminant)
        if sign > 0:
            root = decide.root(discriminant)
            yield (-b - root) / a
            yield (-b + root) / a
        elif sign == 0 and decide.sign(a) * decide.sign(b) < 0:
            decide.note("tangent")


def _crossed_at_start(node: Leaf | Node, surfaces: Sequence[Along], out: int, decide: Decisions) -> Iterator[int]:
    """Which surfaces of leaves rays cross where they start, out of the node (1) or into it (-1)."""
    if isinstance(node, Leaf):
        if all(decide.sign(surfaces[k][2]) <= 0 for k in node.surfaces):
            for k in node.surfaces:
                _, b, c = surfaces[k]
                if decide.sign(c) == 0 and decide.sign(b) == out:
                    yield k
        return
    for operation, operand in node.steps:
        yield from _crossed_at_start(operand, surfaces, -out if operation == "-" else out, decide)


def _contains(node: Leaf | Node, surfaces: Sequence[Along], t: Number, decide: Decisions) -> bool:
    if isinstance(node, Leaf):
        return all(_is_inside(surfaces[k], t, decide) for k in node.surfaces)
    whole = False
    for operation, operand in node.steps:
        if whole != (operation == "+"):  # else it changes nothing
            whole = _contains(operand, surfaces, t, decide) == (operation != "-")
    return whole


def _is_inside(along: Along, t: Number, decide: Decisions) -> bool:
    """Where no surface is crossed; one that is only touched there is as it is beside that."""
    a, b, c = along
    return (decide.sign((a * t + 2 * b) * t + c) or decide.sign(a)) <= 0
