"""`whitted convert`: a scene into files that Mitsuba or POV-Ray loads."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import OK, UsageError
from converter.commands.options import Parser, add_reading_options, add_size, settings_from
from converter.files import is_special

if TYPE_CHECKING:
    from converter.scene.model import Scene
    from converter.scene.settings import Settings

MOST_LISTED = 20
"""Files that are named one by one."""


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted convert",
        "SCENE DIR [WIDTH HEIGHT] [options]\nSCENE FILE.pov [WIDTH HEIGHT] [options]",
        "Writes a scene as a folder that Mitsuba 3 loads: scene.xml, with its meshes, textures and exact surfaces.\n"
        "Or as a file for POV-Ray 3.7, with its textures beside it; what POV-Ray cannot express is told, and stands\n"
        "in the file.",
        "whitted convert figure1.in figure1-mitsuba 800 600\n  whitted convert figure1.in figure1.pov",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument(
        "out",
        type=Path,
        metavar="DIR|FILE.pov",
        help="a new or empty folder, or one of an earlier convert; or a file of that ending, new or of an earlier one",
    )
    add_size(result)
    result.add_argument("-q", "--quiet", action="store_true", help="no notes, no list of files")
    add_reading_options(result)
    return result


def run(arguments: argparse.Namespace) -> int:
    """Write the files, and tell."""
    settings = settings_from(arguments)
    if arguments.out == Path("-") or is_special(arguments.out):
        raise UsageError(f"DIR|FILE.pov: must be a folder, or a file beside its textures, found {str(arguments.out)!r}")

    from converter.commands.notes import load_with_notices

    scene = load_with_notices(arguments.scene, settings, arguments.quiet)
    export = _to_povray if arguments.out.suffix.lower() == ".pov" else _to_mitsuba
    files, then = export(scene, settings, arguments.out, arguments.quiet)
    if not arguments.quiet:
        for file in files[:MOST_LISTED]:
            print(file)
        if len(files) > MOST_LISTED:
            print(f"... and {len(files) - MOST_LISTED} more")
        print(f"\n{then}")
    return OK


def _to_mitsuba(scene: "Scene", settings: "Settings", out: Path, quiet: bool) -> tuple[list[Path], str]:
    """The files written, and what to do with them."""
    from converter.commands.notes import say
    from converter.scene.needs import scene_needs
    from converter.to_mitsuba.export import MOST_SHAPES, export_scene

    files = export_scene(scene, settings, out)
    if len(scene.objects) > MOST_SHAPES:
        say(
            f"note: of more than {MOST_SHAPES} objects no shapes are made: the `whitted` integrator alone sees them",
            quiet,
        )
    if cause := scene_needs(scene, settings).effects.get("motion"):
        say(f"note: {cause}, which the `whitted` integrator alone draws: Mitsuba's shapes stand still", quiet)
    lines = (
        "import mitsuba_plugins, mitsuba",
        "mitsuba_plugins.set_variant()",
        f"image = mitsuba.render(mitsuba.load_file({str(files[0])!r}))",
        'mitsuba_plugins.write_image("picture.png", image)',
    )
    return files, "In Python:\n\n" + "\n".join(lines)


def _to_povray(scene: "Scene", settings: "Settings", out: Path, quiet: bool) -> tuple[list[Path], str]:
    """The files written, and what to do with them; omissions are told."""
    from converter.commands.notes import say
    from converter.to_povray.export import export_povray
    from converter.to_povray.scene import draw_options

    exported, files = export_povray(scene, settings, out)
    for omission in exported.omissions:
        say(f"note: POV-Ray: {omission}", quiet)
    return files, f"In that folder:\n\npovray +I{out.name} {' '.join(draw_options(settings))}"
