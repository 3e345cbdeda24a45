"""Reads and draws the newest text, in a thread of its own, so that nobody waits for older ones.

A picture is drawn small first where the whole one takes a while. A drawing that a newer text has made useless is given
up, unless it is nearly done, so that somebody who types fast sees something, too.
"""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from converter.analysis.notices import scene_notices
from converter.page.reading import Reading, read
from converter.renderers.base import Rendering
from converter.renderers.native import NativeRenderer
from converter.scene.depth import depth_limit
from converter.scene.model import Scene
from converter.scene.settings import Settings

SMALLER = 4
"""How many times narrower and lower the small picture is."""
AT_ONCE = 0.05
"""Seconds within which a whole picture needs no small one before it."""
PATIENCE = 0.1
"""Seconds that a drawing goes on for although there is a newer text."""
LONGEST = 30.0
"""Seconds after which a drawing is given up: whoever wants it has `whitted render`."""
MOST_PIXELS = 1 << 21
"""Of the page's picture."""
DEEPEST, DEEPEST_SMALL = 64, 6
"""Bounces that rays are followed for at most in the page's picture and in the small one."""


@dataclass(frozen=True, slots=True)
class Read:
    """A text has been read."""

    version: int
    reading: Reading


@dataclass(frozen=True, slots=True)
class Drawn:
    """A text has been drawn, small or whole; `scene` is what it was read as, and `settings` what it is drawn with."""

    version: int
    whole: bool
    rendering: Rendering
    scene: Scene
    settings: Settings


@dataclass(frozen=True, slots=True)
class Undrawn:
    """A text cannot be drawn, although it is a scene; the sentence says why."""

    version: int
    message: str


@dataclass(frozen=True, slots=True)
class Noted:
    """What is worth knowing of a scene although nothing is wrong: sentences, most after the number of a line."""

    version: int
    notes: tuple[str, ...]


Event = Read | Drawn | Undrawn | Noted


class _GivenUpError(Exception):
    """A drawing has been superseded."""


class _TooLongError(Exception):
    """A drawing has taken `LONGEST`."""


class Preview(threading.Thread):
    """Draws by the native tracer, and tells by `report`, from its own thread."""

    def __init__(self, file: Path, settings: Settings, report: Callable[[Event], None]) -> None:
        super().__init__(daemon=True)
        self._file, self._settings, self._report = file, settings, report
        self._renderer = NativeRenderer()
        self._changed = threading.Condition()
        self._wanted: tuple[int, str] | None = None
        self._ended = False
        self._last_seconds = math.inf

    def want(self, version: int, text: str) -> None:
        """Draw this text next, and no older one."""
        with self._changed:
            self._wanted = version, text
            self._changed.notify()

    def end(self) -> None:
        """Draw no more, and wait for the thread's end."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self.join(timeout=2.0)

    def run(self) -> None:
        """Work, until `end`."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._wanted is not None)
                if self._ended:
                    return
                assert self._wanted is not None
                version, text = self._wanted
                self._wanted = None
            try:
                self._draw(version, text)
            except _GivenUpError:
                pass
            except _TooLongError:
                self._report(Undrawn(version, f"drawing takes over {LONGEST:g} s: leave it to `whitted render`"))
            except MemoryError:
                self._report(Undrawn(version, "not enough memory"))
            except Exception as error:  # whatever it is, the next text may be drawn
                self._report(Undrawn(version, str(error) or type(error).__name__))

    def _draw(self, version: int, text: str) -> None:
        reading = read(text, self._file)
        self._report(Read(version, reading))
        if reading.scene is None or self._superseded:
            return
        if self._last_seconds > AT_ONCE:
            width, height = (max(1, size // SMALLER) for size in (self._settings.width, self._settings.height))
            small = replace(self._settings, width=width, height=height, samples=1)
            self._stage(version, reading.scene, small, DEEPEST_SMALL, whole=False)
        self._last_seconds = math.inf  # unless it comes to its end
        self._last_seconds = self._stage(version, reading.scene, self._settings, DEEPEST, whole=True)
        if not self._superseded:
            notes = (*reading.scene.warnings, *scene_notices(reading.scene, self._settings))
            self._report(Noted(version, tuple(note.removeprefix(f"{self._file}:") for note in notes)))

    def _stage(self, version: int, scene: Scene, settings: Settings, deepest: int, whole: bool) -> float:
        """Draw one picture; returns the seconds that took."""
        settings = replace(settings, max_depth=bounces(scene, settings, deepest))
        started = time.perf_counter()

        def watch(_: float) -> None:
            elapsed = time.perf_counter() - started
            if self._ended or (self._superseded and elapsed > PATIENCE):
                raise _GivenUpError
            if elapsed > LONGEST:
                raise _TooLongError

        rendering = self._renderer.render(scene, settings, watch)
        self._report(Drawn(version, whole, rendering, scene, settings))
        return time.perf_counter() - started

    @property
    def _superseded(self) -> bool:
        return self._ended or self._wanted is not None


def bounces(scene: Scene, settings: Settings, deepest: int) -> int | None:
    """`max_depth` for a scene with no more than so many bounces; None where it has no more by itself."""
    limit = depth_limit((scene.finishes[o.finish] for o in scene.objects), settings)
    return deepest if limit.bounces > deepest else settings.max_depth
