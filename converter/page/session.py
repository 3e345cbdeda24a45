"""One scene, its file, and the browsers that show it.

All browsers show the same text: whoever changes it changes it for all, and of two who do so at once the later one wins.
What a browser has asked for itself (a pixel, Mitsuba's picture, a picture laid over) is its own.

A text has a version, and everything made from it has that version too: what comes late is not shown.
"""

import asyncio
import math
from collections.abc import Coroutine
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from converter.page import errands
from converter.page.camera import turned
from converter.page.document import (
    MOST_CHARACTERS,
    ChangedElsewhereError,
    Document,
    encoded,
    read_document,
    save,
)
from converter.page.edits import with_eye
from converter.page.helper import Helper, HelperError
from converter.page.numbers import number_at
from converter.page.offsets import from_browser, to_browser
from converter.page.outbox import Outbox
from converter.page.pictures import as_array, difference, frame, levels_of
from converter.page.preview import Drawn, Event, Noted, Preview, Read, Undrawn
from converter.page.trees import tree_message
from converter.scene.errors import SceneError
from converter.scene.model import Camera, Scene
from converter.scene.settings import Settings
from converter.why.picture import Theirs

WATCHING = 0.25
"""Seconds between looks at the file."""
HALF_TURN = math.pi
"""Radians that the camera turns while the mouse goes once through the picture."""


@dataclass(eq=False)
class Page:
    """A browser's window.

    Attributes:
        name: by which its uploads are told from others'.
        outbox: what it is to be sent.
        heard: the number of its last text.
        mitsuba: whether it shows Mitsuba's picture.
        picked: the pixel whose rays it shows, and how often it has picked one.
        held: the camera that it is turning, as it was before.
        theirs: the picture laid over.

    """

    name: str
    outbox: Outbox = field(default_factory=Outbox)
    heard: int = 0
    mitsuba: bool = False
    picked: tuple[int, int] | None = None
    picks: int = 0
    held: Camera | None = None
    theirs: Theirs | None = None

    def tell(self, kind: str, **told: Any) -> None:
        """Send a message."""
        self.outbox.put(kind, {"type": kind, **told})


class Session:
    """The scene in `file`, drawn with `settings`.

    Raises:
        OSError: the file cannot be read.
        SceneError: it is no text, or too long.

    """

    def __init__(self, file: Path, settings: Settings) -> None:
        self.file, self.settings = file, settings
        self._document: Document = read_document(file)
        self._text, self._version, self._by = self._document.text, 1, ""
        self._elsewhere: Document | None = None  # a change of the file that is not followed, for there is one here
        self._pages: dict[str, Page] = {}
        self._reading: Read | None = None
        self._noted: Noted | None = None
        self._drawn: Drawn | None = None  # the last whole picture
        self._frames: dict[str, bytes] = {}
        self._mitsuba_version = 0  # of the picture that is there, or being drawn
        self._helper = Helper()
        self._tasks: set[asyncio.Task[Any]] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._preview = Preview(file, settings, self._from_thread)

    # ----------------------------------------------------------------------------------------------- its beginning, end

    def start(self) -> None:
        """Draw, and watch the file; called in the event loop that everything else here is called in."""
        self._loop = asyncio.get_running_loop()
        self._preview.start()
        self._preview.want(self._version, self._text)
        self._do(self._watch())

    def end(self) -> None:
        """Stop."""
        self._helper.end()
        self._preview.end()
        for task in self._tasks:
            task.cancel()

    def _do(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    # ------------------------------------------------------------------------------------------------------------ pages

    def join(self, page: Page) -> None:
        """Show a new page what there is."""
        self._pages[page.name] = page
        page.tell("scene", file=self.file.name, width=self.settings.width, height=self.settings.height, page=page.name)
        self._tell_text(page)
        self._tell_state(page)
        if self._reading is not None:
            self._tell_reading(page, self._reading)
        if self._noted is not None:
            page.tell("notes", version=self._noted.version, notes=self._noted.notes)
        if "native" in self._frames:
            page.outbox.put("native", self._frames["native"])

    def leave(self, page: Page) -> None:
        """Forget a page."""
        self._pages.pop(page.name, None)

    def page(self, name: str) -> Page | None:
        """The page of that name."""
        return self._pages.get(name)

    def hear(self, page: Page, message: Any) -> None:
        """Do what a page asks for; what is none of these is not meant for us, and nothing happens."""
        match message:
            case {"type": "text", "text": str(text), "number": int(number)}:
                page.heard = number
                self._change(text.encode("utf-8", "replace").decode(), page.name)
            case {"type": "cursor", "at": int(at)}:
                self._tell_number(page, at)
            case {"type": "turn", "x": int() | float() as x, "y": int() | float() as y, "first": bool(first)}:
                self._turn(page, float(x), float(y), first)
            case {"type": "pixel", "x": int(x), "y": int(y)}:
                self._pick(page, x, y)
            case {"type": "mitsuba", "on": bool(on)}:
                page.mitsuba = on
                self._draw_by_mitsuba()
            case {"type": "save", "over": bool(over)}:
                self._save(page, over)
            case {"type": "load"}:
                self._load()
            case {"type": "why"}:
                self._do(self._tell_why(page))

    # ------------------------------------------------------------------------------------------------------------- text

    def _change(self, text: str, by: str) -> None:
        if text == self._text:
            self._tell_states()
            return
        if len(text) > MOST_CHARACTERS:
            self._pages[by].tell("said", message=f"The page bears {MOST_CHARACTERS:,} characters: this was not taken.")
            return
        self._text, self._by = text, by
        self._version += 1
        self._preview.want(self._version, text)
        for page in self._pages.values():
            if page.name != by:
                self._tell_text(page)
        self._tell_states()

    def _tell_text(self, page: Page) -> None:
        page.tell("text", text=self._text, version=self._version, mine=self._by == page.name, heard=page.heard)

    def _tell_states(self) -> None:
        for page in self._pages.values():
            self._tell_state(page)

    def _tell_state(self, page: Page) -> None:
        page.tell(
            "state",
            saved=not self._unsaved,
            elsewhere=self._elsewhere is not None,
            heard=page.heard,
            version=self._version,
        )

    @property
    def _unsaved(self) -> bool:
        return self._text != self._document.text

    def _tell_number(self, page: Page, at: int) -> None:
        text = self._text
        slider = number_at(text, from_browser(text, at))
        if slider is None:
            page.tell("number", found=None)
            return
        places = {"start": to_browser(text, slider.start), "end": to_browser(text, slider.end)}
        page.tell("number", found=asdict(slider) | places)

    # ----------------------------------------------------------------------------------------------------------- camera

    def _turn(self, page: Page, x: float, y: float, first: bool) -> None:
        """Turn the camera by as much as the mouse has gone, in pictures, since the `first` of such messages."""
        reading = self._reading
        if not (math.isfinite(x) and math.isfinite(y)):
            return
        if first or page.held is None:
            if reading is None or reading.version != self._version or reading.reading.scene is None:
                page.held = None
                page.tell("said", message="The camera turns when the text is a scene.")
                return
            page.held = reading.reading.scene.camera
        camera = turned(page.held, -x * HALF_TURN, y * HALF_TURN)
        with suppress(IndexError):  # somebody else has just taken the words away
            self._change(with_eye(self._text, camera.eye), page.name)
            self._tell_text(page)

    # --------------------------------------------------------------------------------------------------------- pictures

    def _from_thread(self, event: Event) -> None:
        assert self._loop is not None
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._take, event)

    def _take(self, event: Event) -> None:
        match event:
            case Read():
                self._reading = event
                for page in self._pages.values():
                    self._tell_reading(page, event)
            case Noted():
                self._noted = event
                for page in self._pages.values():
                    page.tell("notes", version=event.version, notes=event.notes)
            case Undrawn():
                for page in self._pages.values():
                    page.tell("undrawn", version=event.version, message=event.message)
            case Drawn():
                self._show(event)

    def _tell_reading(self, page: Page, read: Read) -> None:
        marks = [asdict(mark) for mark in read.reading.marks]
        page.tell("reading", version=read.version, marks=marks, omitted=read.reading.omitted)

    def _show(self, drawn: Drawn) -> None:
        rendering = drawn.rendering
        about: dict[str, Any] = {"type": "native", "version": drawn.version, "whole": drawn.whole, "note": ""}
        about |= {"width": rendering.width, "height": rendering.height, "seconds": rendering.seconds["render"]}
        if (count := rendering.statistics["pixels_too_deep"]) and drawn.whole:
            about["note"] = f"{count:,} pixels lack rays beyond {drawn.settings.max_depth or 'the usual'} bounces"
        self._frames["native"] = frame(about, levels_of(rendering.pixels))
        for page in self._pages.values():
            page.outbox.put("native", self._frames["native"])
        if not drawn.whole:
            return
        self._drawn = drawn
        self._draw_by_mitsuba()
        for page in self._pages.values():
            if page.picked is not None:
                self._tell_rays(page, *page.picked)

    def _draw_by_mitsuba(self) -> None:
        """Draw the last whole picture by Mitsuba, if somebody wants to see it, and it is not drawn already."""
        wanting = [page for page in self._pages.values() if page.mitsuba]
        drawn = self._drawn
        if not wanting or drawn is None:
            return
        if drawn.version != self._mitsuba_version:
            self._mitsuba_version = drawn.version
            self._do(self._fetch_mitsuba(drawn))
            return
        for page in wanting:
            for kind in ("mitsuba", "difference"):
                if kind in self._frames:
                    page.outbox.put(kind, self._frames[kind])

    async def _fetch_mitsuba(self, drawn: Drawn) -> None:
        for page in self._pages.values():
            if page.mitsuba:
                page.tell("drawing", version=drawn.version)
        try:
            pixels = await self._helper.call(
                errands.draw_by_mitsuba, drawn.scene, drawn.settings, wanted=lambda: self._drawn is drawn
            )
        except HelperError as error:
            for page in self._pages.values():
                if page.mitsuba:
                    page.tell("undrawn_by_mitsuba", message=str(error))
            return
        if pixels is None:
            return
        size = {"width": drawn.settings.width, "height": drawn.settings.height, "version": drawn.version}
        native = as_array(drawn.rendering.pixels, size["width"], size["height"])
        levels, told = difference(native, pixels)
        self._frames["mitsuba"] = frame({"type": "mitsuba", **size}, levels_of(pixels))
        self._frames["difference"] = frame({"type": "difference", "told": told, **size}, levels.tobytes())
        for page in self._pages.values():
            if page.mitsuba:
                page.outbox.put("mitsuba", self._frames["mitsuba"])
                page.outbox.put("difference", self._frames["difference"])

    # ------------------------------------------------------------------------------------------------------------- rays

    def _pick(self, page: Page, x: int, y: int) -> None:
        """Show the rays of a pixel, or of none where there is no such pixel."""
        inside = 0 <= x < self.settings.width and 0 <= y < self.settings.height
        page.picked = (x, y) if inside else None
        page.picks += 1
        if not inside:
            page.tell("rays", found=None)
        elif self._drawn is not None:
            self._tell_rays(page, x, y)

    def _tell_rays(self, page: Page, x: int, y: int) -> None:
        """The native tracer's at once, and then both renderers'."""
        from converter.renderers.native import NativeRenderer

        drawn = self._drawn
        assert drawn is not None
        try:
            traced = {"native": NativeRenderer().trace_pixel(drawn.scene, drawn.settings, x, y)}
            page.tell("rays", found=tree_message(drawn.scene, drawn.settings, traced) | {"version": drawn.version})
        except (ValueError, MemoryError) as error:
            page.tell("said", message=str(error))
            return
        self._do(self._fetch_rays(page, drawn, x, y, traced))

    async def _fetch_rays(self, page: Page, drawn: Drawn, x: int, y: int, traced: dict[str, Any]) -> None:
        picks = page.picks

        def wanted() -> bool:
            return page.picks == picks and self._drawn is drawn and page.name in self._pages

        try:
            found = await self._helper.call(errands.trace_by_mitsuba, drawn.scene, drawn.settings, x, y, wanted=wanted)
        except HelperError as error:
            page.tell("said", message=f"Mitsuba: {error}")
            return
        if found is not None and wanted():
            both = {**traced, "mitsuba": found}
            page.tell("rays", found=tree_message(drawn.scene, drawn.settings, both) | {"version": drawn.version})

    # -------------------------------------------------------------------------------------------------------------- why

    async def _tell_why(self, page: Page) -> None:
        theirs, scene = page.theirs, self._scene()
        if theirs is None or scene is None:
            page.tell("said", message="Why needs a picture of yours, and a text that is a scene.")
            return
        page.tell("why", message="Looking for the mistakes that lead there ...", done=False)
        name, levels, lossy = str(theirs.file), theirs.levels, theirs.lossy
        try:
            found = await self._helper.call(
                errands.tell_why, scene, self.settings, name, levels, lossy, wanted=lambda: page.theirs is theirs
            )
        except HelperError as error:
            found = str(error)
        if found is not None:
            page.tell("why", message=found, done=True)

    def _scene(self) -> Scene | None:
        return None if self._reading is None else self._reading.reading.scene

    # ------------------------------------------------------------------------------------------------------------- file

    def _save(self, page: Page, over: bool) -> None:
        try:
            self._document = save(self.file, self._text, self._document, over)
        except ChangedElsewhereError:
            with suppress(OSError, SceneError):
                self._elsewhere = read_document(self.file)
            page.tell("said", message="Not saved: the file was changed elsewhere. Load it, or save over it.")
        except OSError as error:
            page.tell("said", message=f"Not saved: {(error.strerror or str(error)).lower()}.")
        else:
            self._elsewhere = None
            lossy = encoded(self._text, self._document) != self._document.data
            page.tell("said", message="Saved, as UTF-8." if lossy else "Saved.")
        self._tell_states()

    def _load(self) -> None:
        """Take the file's text instead of the page's."""
        if self._elsewhere is not None:
            self._follow(self._elsewhere)

    def _follow(self, document: Document) -> None:
        self._document, self._elsewhere = document, None
        if document.text == self._text:
            self._tell_states()
        else:
            self._change(document.text, "")

    async def _watch(self) -> None:
        """Follow the file."""
        seen = _signature(self.file)
        while True:
            await asyncio.sleep(WATCHING)
            found = _signature(self.file)
            if found in (seen, None):  # editors take a file away for a moment
                continue
            seen = found
            try:
                document = await asyncio.to_thread(read_document, self.file)
            except (OSError, SceneError) as error:
                for page in self._pages.values():
                    page.tell("said", message=f"The file was changed elsewhere, and cannot be followed: {error}")
                continue
            if document.data == self._document.data:
                self._elsewhere = None
                self._tell_states()
            elif self._unsaved and document.text != self._text:
                self._elsewhere = document
                self._tell_states()
            else:
                self._follow(document)


def _signature(file: Path) -> tuple[int, int, int] | None:
    """What changes with a file; None where it is missing."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
