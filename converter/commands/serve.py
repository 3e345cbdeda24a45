"""`whitted serve`: a page for writing scenes, beside their picture."""

import argparse
import os
import sys
from importlib.util import find_spec
from pathlib import Path

from converter.commands.exits import OK, UNAVAILABLE, UsageError, tell
from converter.commands.options import Parser, add_reading_options, add_size, settings_from, whole

INSTALL = "pip install 'whitted[page]'"
WIDTH, HEIGHT = 480, 360


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted serve",
        "SCENE [WIDTH HEIGHT] [options]",
        "A page for writing scenes: the text left, the picture right, drawn while you type. Mistakes are underlined;\n"
        "a click on a pixel shows its rays; dragging the picture turns the camera. All windows show the same text,\n"
        "and of two changes at once the later one wins. The file is followed when it changes elsewhere, and written\n"
        "when you save. Ctrl-C ends it.",
        "whitted serve figure1.in",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    add_size(result, WIDTH, HEIGHT)
    group = result.add_argument_group("where it is served")
    group.add_argument(
        "--host", default="127.0.0.1", metavar="ADDRESS", help="the address (%(default)s: this machine only)"
    )
    group.add_argument("--port", type=_port, default=0, metavar="N", help="the port (0: one that is free)")
    group.add_argument(
        "--open",
        action=argparse.BooleanOptionalAction,
        help="open a browser (where there is a display)",
    )
    add_reading_options(result)
    return result


def run(arguments: argparse.Namespace) -> int:
    """Serve, until Ctrl-C."""
    if what := missing():
        tell(f"whitted serve: {what} is missing: {INSTALL}")
        return UNAVAILABLE
    from converter.page.gate import is_local
    from converter.page.preview import MOST_PIXELS
    from converter.page.server import serve
    from converter.page.session import Session
    from converter.renderers.native import native_module

    native_module()  # or it is told now that there is none
    if arguments.width is None and arguments.height is None:
        arguments.width, arguments.height = WIDTH, HEIGHT
    settings = settings_from(arguments)
    if settings.width * settings.height > MOST_PIXELS:
        raise UsageError(f"the page draws {MOST_PIXELS:,} pixels at most: a larger picture is `whitted render`'s")
    session = Session(arguments.scene, settings)
    opens = _has_display() if arguments.open is None else arguments.open
    if not is_local(arguments.host):
        tell(
            f"warning: {arguments.host} is reached from other machines: who has the address below, which goes over\n"
            "the net as plain text, may change the scene and read the pictures beside it"
        )

    def ready(address: str, once: str) -> None:
        print(f"{arguments.scene}: {address}\nCtrl-C ends it.", flush=True)
        if opens:
            _open(once)

    serve(session, arguments.host, arguments.port, ready)
    return OK


def _port(text: str) -> int:
    return whole(text, 0, 65535)


def missing() -> str | None:
    """What of the extra is not installed; None if all is."""
    for name in ("starlette", "uvicorn", "websockets"):
        if find_spec(name) is None:
            return name
    from converter.page.app import editor_folder

    return "nicegui, whose CodeMirror is the editor," if editor_folder() is None else None


def _has_display() -> bool:
    return sys.platform == "darwin" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(address: str) -> None:
    """Open the user's browser, without waiting for it."""
    import threading
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
