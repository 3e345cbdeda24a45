"""The page's addresses: its files, the editor's, the WebSocket, and where a picture of yours is sent."""

import asyncio
import json
import secrets
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from importlib.util import find_spec
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from converter.page.gate import Gate
from converter.page.pictures import frame
from converter.page.session import Page, Session
from converter.page.uploads import MOST_BYTES, read_upload

OURS = Path(__file__).parent / "static"


def editor_folder() -> Path | None:
    """Where CodeMirror lies, as one module; None if it is not installed.

    NiceGUI brings it ready for browsers. Of NiceGUI itself nothing is used: its own editor sends texts without saying
    which of two is the newer one.
    """
    found = find_spec("nicegui")
    if found is None or not found.submodule_search_locations:
        return None
    folder = Path(found.submodule_search_locations[0], "elements", "codemirror", "dist")
    return folder if (folder / "index.js").is_file() else None


def make_app(session: Session, token: str, host: str) -> Gate:
    """The application, served as `host` at the path `/token/`; the session begins and ends with it."""
    editor = editor_folder()
    assert editor is not None, "the command has looked"

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        session.start()
        try:
            yield
        finally:
            session.end()

    routes = [
        Route("/", _index),
        WebSocketRoute("/live", _live(session)),
        Route("/picture", _picture(session), methods=["POST"]),
        Mount("/static", StaticFiles(directory=OURS)),
        Mount("/editor", StaticFiles(directory=editor)),
    ]
    return Gate(Starlette(routes=[Mount(f"/{token}", routes=routes)], lifespan=lifespan), token, host)


async def _index(request: Request) -> Response:
    return FileResponse(OURS / "index.html")


def _live(session: Session) -> Callable[[WebSocket], Awaitable[None]]:
    async def live(socket: WebSocket) -> None:
        """Messages of one browser, both ways, for as long as it is there."""
        await socket.accept()
        page = Page(secrets.token_hex(8))
        session.join(page)
        sending = asyncio.ensure_future(_send(socket, page))
        try:
            while True:
                text = await socket.receive_text()
                with suppress(
                    ValueError, OverflowError, RecursionError
                ):  # it is none of our pages who says such things
                    session.hear(page, json.loads(text))
        except (WebSocketDisconnect, KeyError):  # gone, or a message of bytes
            pass
        finally:
            sending.cancel()
            session.leave(page)

    return live


async def _send(socket: WebSocket, page: Page) -> None:
    while True:
        payload = await page.outbox.take()
        if isinstance(payload, bytes):
            await socket.send_bytes(payload)
        else:
            await socket.send_text(json.dumps(payload))


def _picture(session: Session) -> Callable[[Request], Awaitable[Response]]:
    async def picture(request: Request) -> Response:
        """Take a picture's file, and answer with its pixels."""
        page = session.page(request.query_params.get("page", ""))
        if page is None:
            return PlainTextResponse("there is no such page", 404)
        data = bytearray()
        async for part in request.stream():
            data += part
            if len(data) > MOST_BYTES:
                return PlainTextResponse(f"the picture is larger than {MOST_BYTES >> 20} MiB", 413)
        try:
            theirs = await asyncio.to_thread(read_upload, request.query_params.get("name", ""), bytes(data))
        except (ValueError, MemoryError) as error:
            return PlainTextResponse(str(error) or "not enough memory", 422)
        page.theirs = theirs
        height, width, _ = theirs.levels.shape
        about = {"type": "theirs", "width": width, "height": height, "name": str(theirs.file)}
        return Response(frame(about, theirs.levels.tobytes()), media_type="application/octet-stream")

    return picture
