"""Serves the page until Ctrl-C."""

import asyncio
import secrets
import signal
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import uvicorn

from converter.page.app import make_app
from converter.page.document import MOST_CHARACTERS
from converter.page.session import Session

CLOSING = 1
"""Seconds that open connections have to end after Ctrl-C."""


def serve(session: Session, host: str, port: int, ready: Callable[[str, str], None]) -> None:
    """Serve at `host` and `port`, 0 for any that is free; call `ready` with the page's address, and with one that leads
    there once.

    Raises:
        OSError: the address cannot be had.

    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        asyncio.run(_serve(session, listener, host, ready))


async def _serve(session: Session, listener: socket.socket, host: str, ready: Callable[[str, str], None]) -> None:
    token = secrets.token_urlsafe(24)
    app = make_app(session, token, host)
    config = uvicorn.Config(
        app,
        log_level="critical",
        access_log=False,
        lifespan="on",
        server_header=False,
        proxy_headers=False,
        ws_max_size=8 * MOST_CHARACTERS,
        ws_per_message_deflate=False,  # it would take longer than drawing
        timeout_graceful_shutdown=CLOSING,
    )
    server = _Server(config)
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, server.stop)
    try:
        shown = f"[{host}]" if ":" in host else host
        listener.listen()
        place = f"http://{shown}:{listener.getsockname()[1]}"
        ready(f"{place}/{token}/", place + app.once())
        await server.serve(sockets=[listener])
    finally:
        session.end()  # also after a second Ctrl-C, which does not wait for the application's end


class _Server(uvicorn.Server):
    """Ends when it is told to, and leaves signals to us."""

    def stop(self) -> None:
        self.force_exit = self.should_exit
        self.should_exit = True

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield
