"""Who may speak with the page: whoever has its token, from a page of ours, under a name that is ours.

The token alone keeps other programs and pages out. That `Host` is an address, or a name we know, keeps out sites whose
name has been made to lead here (DNS rebinding); that `Origin` is ours, sites that open a WebSocket to us.

All users of a machine see the arguments of its programs, so a browser is started with an address that leads to the
page once, and then never again.
"""

import hmac
import ipaddress
import secrets

from starlette.types import ASGIApp, Message, Receive, Scope, Send

HEADERS = (
    (
        b"content-security-policy",
        b"default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
        b"img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)
"""Of every answer. CodeMirror makes style sheets while it runs."""


class Gate:
    """Lets through to `app` what may speak with it, and says 403 to the rest."""

    def __init__(self, app: ASGIApp, token: str, host: str) -> None:
        self._app, self._token, self._host = app, token, host
        self._once: str | None = None

    def once(self) -> str:
        """A path that leads to the page, for the first who asks for it."""
        self._once = secrets.token_urlsafe(24)
        return f"/{self._once}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] == "lifespan":  # that of the server, whom nobody asks for anything
            await self._app(scope, receive, send)
            return
        headers = {name.lower(): value.decode("latin-1") for name, value in scope["headers"]}
        if scope["type"] == "http" and self._is_once(scope["path"]):
            self._once = None
            place = [(b"location", f"/{self._token}/".encode()), *HEADERS]
            await send({"type": "http.response.start", "status": 303, "headers": place})
            await send({"type": "http.response.body", "body": b""})
        elif self._may_pass(scope["path"], headers):
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await send({"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]})
            await send({"type": "http.response.body", "body": b"This needs the address that whitted serve has told.\n"})

    def _is_once(self, path: str) -> bool:
        return self._once is not None and hmac.compare_digest(path.encode(), f"/{self._once}".encode())

    def _may_pass(self, path: str, headers: dict[bytes, str]) -> bool:
        host, origin = headers.get(b"host", ""), headers.get(b"origin")
        given = path.split("/")[1] if path.startswith("/") else ""
        return (
            hmac.compare_digest(given.encode(), self._token.encode())
            and is_ours(host, self._host)
            and origin in (None, f"http://{host}")
        )


def is_ours(host: str, served: str) -> bool:
    """Whether a `Host` header is an address, `localhost`, or the name under which the page is served."""
    name = host[: host.index("]") + 1] if host.startswith("[") and "]" in host else host.partition(":")[0]
    if name.lower() in ("localhost", served.lower()):
        return bool(name)
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True


def is_local(host: str) -> bool:
    """Whether only this machine reaches a server at that address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message["headers"], *HEADERS]
        await send(message)

    return sending
