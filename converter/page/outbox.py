"""What is still to be sent to a browser: of each kind the newest only, so that a slow one falls behind by nothing."""

import asyncio
from typing import Any

Payload = dict[str, Any] | bytes


class Outbox:
    """Messages by kind, in the order in which their kinds came."""

    def __init__(self) -> None:
        self._waiting: dict[str, Payload] = {}
        self._filled = asyncio.Event()

    def put(self, kind: str, payload: Payload) -> None:
        """Send this; not what waits of the same kind."""
        self._waiting[kind] = payload
        self._filled.set()

    async def take(self) -> Payload:
        """The next to be sent, when there is one."""
        while not self._waiting:
            self._filled.clear()
            await self._filled.wait()
        return self._waiting.pop(next(iter(self._waiting)))
