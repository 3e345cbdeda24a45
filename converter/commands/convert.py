"""`whitted convert`: a scene into files that Mitsuba 3 loads."""

import argparse
from pathlib import Path

from converter.commands.exits import OK
from converter.commands.options import Parser, add_reading_options, add_size, settings_from

MOST_LISTED = 12
"""Files that are listed one by one."""


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted convert",
        "SCENE DIR [WIDTH HEIGHT] [options]",
        "Writes a scene as a folder that Mitsuba 3 loads: scene.xml, with its meshes, textures and exact surfaces.",
        "whitted convert figure1.in figure1-mitsuba 800 600",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder, or one of an earlier convert")
    add_size(result)
    result.add_argument("-q", "--quiet", action="store_true", help="no notes, no list of files")
    add_reading_options(result)
    return result


def run(arguments: argparse.Namespace) -> int:
    """Write the files, and tell."""
    settings = settings_from(arguments)

    from converter.commands.notes import load_with_notices

    scene = load_with_notices(arguments.scene, settings, arguments.quiet)

    from converter.to_mitsuba.export import export_scene

    files = export_scene(scene, settings, arguments.folder)
    if not arguments.quiet:
        for file in files[:MOST_LISTED]:
            print(file)
        if len(files) > MOST_LISTED:
            print(f"... and {len(files) - MOST_LISTED} more")
        print("\nIn Python:\n\nimport mitsuba_plugins, mitsuba; mitsuba_plugins.set_variant()")
        print(f"image = mitsuba.render(mitsuba.load_file({str(files[0])!r}))")
    return OK
