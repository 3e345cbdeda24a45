"""`whitted inspect`: what a scene file holds, and what it needs of a renderer."""

import argparse
import math
from pathlib import Path
from typing import Any

from converter.commands.csg_trees import csg_lines
from converter.commands.exits import OK
from converter.commands.options import Parser, add_reading_options, settings_from
from converter.commands.results import TextResult
from converter.commands.tables import print_table
from converter.descriptors import STANDARD_OUTPUT
from converter.pigments.table import PIGMENT_WORDS
from converter.shapes.table import SHAPE_KINDS

MOST_ROWS = 20
"""Rows of a table; a scene may have thousands of polyhedra."""
DEFAULT = "native"
"""The method that stands for all that compute in double precision, as those do that draw where nobody chooses."""
MOST_LEVELS = 8
"""Levels of 255 up to which a bound is told: beyond, it says less of the picture than of how often rays may split."""
RULES = {
    "set": " (--max-depth)",
    "cutoff": " (all that the cut-off asks for)",
    "bounces": " (the most that are ever followed)",
    "rays": " (one more, and a pixel might have 65536 rays)",
}
"""What made the limit of depth."""
COEFFICIENTS = ("ka", "kd", "ks", "alpha", "kr", "kt", "ior")


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted inspect",
        "SCENE [options]",
        "Says what a scene file holds and what it needs, without drawing it.",
        "whitted inspect figure1.in",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write it as JSON; - is the standard output, without the tables",
    )
    add_reading_options(result, picture=False)
    return result


def run(arguments: argparse.Namespace) -> int:
    """Look, and tell."""
    settings = settings_from(arguments)

    from converter.commands.inspection import inspect_scene
    from converter.commands.json_out import check_json, write_json
    from converter.commands.notes import load

    check_json(arguments.json, [arguments.scene])
    found = inspect_scene(load(arguments.scene), settings)
    if arguments.json != STANDARD_OUTPUT:
        _print(found)
    write_json(arguments.json, found)
    return OK


def _print(found: dict[str, Any]) -> None:
    print_table(_overview(found), title=found["file"])
    radius = ("radius",) if any(light["radius"] for light in found["lights"]) else ()
    _print_rows(
        "lights",
        ("", "position", "colour", "attenuation", *radius),
        "rlll" + "r" * len(radius),
        [
            (
                str(light["light"]),
                *(_numbers(light[key]) for key in ("position", "color", "attenuation")),
                *(f"{light[key]:g}" for key in radius),
            )
            for light in found["lights"]
        ],
    )
    _print_rows(
        "pigments",
        ("", "kind", "", "objects"),
        "rllr",
        [(str(p["pigment"]), p["kind"], PIGMENT_WORDS[p["kind"]].summary(p), _uses(p)) for p in found["pigments"]],
    )
    coefficients = COEFFICIENTS + (("cone",) if any(f["cone"] for f in found["finishes"]) else ())
    _print_rows(
        "finishes",
        ("", "line", *coefficients, "ior is", "n1/n2", "objects"),
        "rr" + "r" * len(coefficients) + "lrr",
        [
            (
                str(f["finish"]),
                str(f["line"] or ""),
                *(f"{f[key]:g}" for key in coefficients),
                f["ior_read_as"] or "not used",
                f"{f['n1/n2']:.4g}" if f["ior_read_as"] else "",
                _uses(f),
            )
            for f in found["finishes"]
        ],
    )
    _print_rows(
        "polyhedra with redundant planes, or without bounds",
        ("object", "line", "planes needed", "redundant", "bounded"),
        "rr",
        [
            (
                str(p["object"]),
                str(p["line"] or ""),
                _indices(p["planes"]),
                _indices(p["redundant_planes"]),
                "yes" if p["bounded"] else "no",
            )
            for p in found["polyhedra"]
            if p["redundant_planes"] or not p["bounded"]
        ],
    )
    _print_rows(
        "quadrics",
        ("object", "line", "kind", "drawn as", "bounded"),
        "rrl",
        [
            (
                str(q["object"]),
                str(q["line"] or ""),
                q["kind"],
                q["drawn_as"],
                "yes" if q["bounded"] else "no",
            )
            for q in found["quadrics"]
        ],
    )
    _print_rows(
        "moving objects",
        ("object", "line", "displacement"),
        "rr",
        [(str(o["object"]), str(o["line"] or ""), _numbers(o["move"])) for o in found["moving"]],
    )
    for csg in found["csgs"][:MOST_ROWS]:
        print()
        print("\n".join(csg_lines(csg)))
    for warning in found["reading_warnings"]:
        print(f"\nwarning: {warning}")
    for notice in found["notices"]:
        print(f"\nnote: {notice}")
    for warning in found["warnings"].get(DEFAULT, ()):
        print(f"\nwarning: {warning}")
    if others := [name for name in found["warnings"] if name != DEFAULT]:
        print(f"\nnote: other methods are known to fail here: {', '.join(others)} (--json tells at what)")


def _overview(found: dict[str, Any]) -> list[tuple[str, str]]:
    camera, objects, needs, unused = found["camera"], found["objects"], found["needs"], found["unused"]
    kinds = ", ".join(_counted(kind, count) for kind, count in objects["kinds"].items())
    bounces = [
        name for name, needed in (("reflection", needs["reflects"]), ("refraction", needs["refracts"])) if needed
    ]
    shading = [name for name, needed in (("shadows", needs["lit"]), ("highlights", needs["glossy"])) if needed]
    rows = [
        ("camera", f"eye {_numbers(camera['eye'])}, looks at {_numbers(camera['look_at'])}"),
        ("", f"up {_numbers(camera['up'])}, fovy {camera['fovy']:g} degrees"),
        *([("", f"aperture {camera['aperture']:g}, in focus at {camera['focal']:g}")] if camera["aperture"] else []),
        ("ambient light", _numbers(found["ambient"])),
        ("background", _numbers(found["background"])),
        ("objects", kinds or "none"),
    ]
    if objects["planes"]:
        rows.append(("planes", f"{objects['planes']}, redundant: {objects['redundant_planes']}"))
    if box := found["closing_box"]:
        count = objects["unbounded"]
        rows.append(("unbounded", f"{count} object{'' if count == 1 else 's'}"))
        rows.append(("", f"whose meshes end at {_numbers(box['low'])} and {_numbers(box['high'])}"))
    rows.append(("needs", ", ".join(shading + bounces + needs["effects"]) or "nothing but ambient light"))
    if bounces:
        split = "rays split in two" if needs["branches"] else "every ray has one successor"
        rows.append(("depth", f"{needs['max_depth']} bounces{RULES[needs['max_depth_rule']]}, {split}"))
    rows.append(("cut-off", _cutoff(found["cutoff"], needs)))
    for kind, indices in unused.items():
        if indices:
            rows.append((f"unused {kind}", _indices(indices)))
    return rows


def _cutoff(found: dict[str, Any], needs: dict[str, Any]) -> str:
    """E.g. "1/512: no channel is off by more than 0.0041 (1.04 of 255 levels)"; no number where it would be useless."""
    cutoff, bound = found["cutoff"], found["bound"]
    share = f"1/{1 / cutoff:.0f}" if cutoff and (1 / cutoff).is_integer() else f"{cutoff:g}"
    if found["unbounded_by"]:
        return f"{share}: no telling how far channels are off, for {found['unbounded_by']}"
    if bound == 0:
        within = "" if needs["max_depth_rule"] in ("none", "cutoff") else f" within {needs['max_depth']} bounces"
        return f"{share}: drops no ray{within}"
    if 255 * bound > MOST_LEVELS:
        return f"{share}: the bound is loose here; whitted compare --reference native:cutoff=1/4096 measures"
    return f"{share}: no channel is off by more than {_rounded_up(bound)} ({_rounded_up(255 * bound)} of 255 levels)"


def _rounded_up(value: float) -> str:
    """Three digits of a positive number, none of which promises too much."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.ceil(value / unit) * unit:.3g}"


def _print_rows(title: str, header: tuple[str, ...], align: str, rows: list[tuple[str, ...]]) -> None:
    if not rows:
        return
    print()
    print_table(rows[:MOST_ROWS], header, align, title)
    if len(rows) > MOST_ROWS:
        print(f"... and {len(rows) - MOST_ROWS} more; --json lists them all")


def _uses(entry: dict[str, Any]) -> str:
    return str(entry["objects"]) if entry["objects"] else "unused"


def _counted(kind: str, count: int) -> str:
    plurals = {each.NAME: each.PLURAL for each in SHAPE_KINDS.values()}
    return f"{count} {kind if count == 1 else plurals[kind]}"


def _indices(indices: list[int]) -> str:
    """`0-3, 7`; the first ones of very many."""
    runs: list[list[int]] = []
    for i in indices:
        if runs and runs[-1][1] == i - 1:
            runs[-1][1] = i
        else:
            runs.append([i, i])
    told = [str(a) if a == b else f"{a}-{b}" for a, b in runs]
    return ", ".join(told[:8]) + (f", ... ({len(indices)})" if len(told) > 8 else "")


def _numbers(values: list[float]) -> str:
    return " ".join(f"{value:g}" for value in values)
