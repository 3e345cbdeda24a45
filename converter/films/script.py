"""Files of keyframes: TOML, with a table for each number, or row of numbers, that changes.

shutter = 0.5                       # share of a frame's time for which it is open: 0, if nothing is said

[tracks."objects[3].sphere.center"]
easing = "catmull-rom"              # linear, smooth or catmull-rom
loop = true                         # goes on from the start behind the last key
keys = [
  [0.0, [0, 0, 0]],                 # seconds, value
  [1.5, [4, 0, 0], "smooth"],       # and an easing of its own, up to the next key
  [2.0, [0, 0, 0]],
]
"""

import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import filterfalse, pairwise, takewhile
from math import isfinite
from pathlib import Path
from typing import Any, cast

from converter.films.addresses import Address, AddressError, changed, displacement, find_address, moved_object, names_of
from converter.films.curve import EASINGS, Easing, Key, Value, value_at
from converter.films.errors import film_error
from converter.scene.errors import Problem, SceneError, did_you_mean
from converter.scene.model import Scene

_TOP, _TRACK = ("shutter", "tracks"), ("keys", "easing", "loop")
_PLACE = re.compile(r"(.*) \(at line (\d+), column (\d+)\)$")


@dataclass(frozen=True, slots=True)
class Track:
    """What changes, and how."""

    address: Address
    keys: tuple[Key, ...]
    loop: bool = False

    def at(self, time: float) -> Value:
        """Its value at a time in seconds."""
        return value_at(self.keys, time, self.loop)


Changes = tuple[tuple[Address, Value], ...]


@dataclass(frozen=True, slots=True)
class Script:
    """What changes in a scene, and for what share of a frame's time the shutter is open."""

    tracks: tuple[Track, ...]
    shutter: float = 0.0

    @property
    def seconds(self) -> float:
        """When the last key is."""
        return max((track.keys[-1].time for track in self.tracks), default=0.0)

    @property
    def blurs(self) -> bool:
        """Whether what moves is blurred by it."""
        return self.shutter > 0 and any(moved_object(track.address) is not None for track in self.tracks)

    def changes(self, time: float, frame_seconds: float) -> Changes:
        """What is different from the scene's file at a time, with the ways that objects go while the shutter is open.

        An object goes from where it is at that time straight to where it is when the shutter closes.
        """
        found = [(track.address, track.at(time)) for track in self.tracks]
        if not self.blurs:
            return tuple(found)
        ways: dict[int, list[float]] = {}
        told = {track.address.steps[1] for track in self.tracks if track.address.steps[2:3] == ("move",)}
        for track, (address, before) in zip(self.tracks, list(found), strict=True):
            index = moved_object(address)
            if index is None or index in told:
                continue
            after = track.at(time + self.shutter * frame_seconds)
            way = ways.setdefault(index, [0.0, 0.0, 0.0])
            for k, number in enumerate(displacement(address, before, after)):
                way[k] += number
        found += [(Address(("objects", index, "move"), 3), tuple(way)) for index, way in ways.items()]
        return tuple(found)


def read_script(file: Path, scene: Scene, scene_text: str) -> Script:
    """The keyframes in a file, for a scene whose text that is.

    Raises:
        OSError: the file cannot be read.
        FilmError: it is no such file, or addresses what the scene does not have.

    """
    return _Reading(file, scene, scene_text).script()


def frame_scene(scene: Scene, changes: Changes) -> Scene:
    """The scene of a frame, which has been read as if it were a file.

    Raises:
        SceneError: the format does not have it.

    """
    from converter.scene.parser import parse_scene
    from converter.scene.writer import write_scene

    for _, value in changes:
        if not all(map(isfinite, value)):
            found = next(filterfalse(isfinite, value))
            raise SceneError([Problem(scene.file, 0, 0, f"a number between two keys must be finite, found {found}")])
    result = changed(scene, changes)
    parse_scene(write_scene(result), scene.file)
    return result


class _Reading:
    def __init__(self, file: Path, scene: Scene, scene_text: str) -> None:
        self._file, self._scene = file, scene
        self._names = names_of(scene, scene_text)
        try:
            self._text = file.read_text(encoding="utf-8-sig")
            self._data = tomllib.loads(self._text)
        except UnicodeDecodeError:
            raise film_error(file, 0, "this is no UTF-8 text") from None
        except FileNotFoundError:
            raise film_error(
                file,
                0,
                "there is no such file of keyframes; --keys names another, docs/films.md tells what is in it",
            ) from None
        except (ValueError, RecursionError) as error:  # a number of too many digits, or too many brackets, too
            place = _PLACE.match(str(error))
            message, line = (f"column {place[3]}: {place[1]}", int(place[2])) if place else (str(error), 0)
            raise film_error(file, line, message) from None

    def script(self) -> Script:
        self._check_names(self._data, _TOP, "a file of keyframes", "")
        shutter = self._data.get("shutter", 0.0)
        if not _is_number(shutter) or not 0 <= shutter <= 1:
            raise film_error(
                self._file, self._line("shutter"), f"shutter must be a share from 0 to 1, found {shutter!r}"
            )
        tables = self._data.get("tracks", {})
        if not isinstance(tables, Mapping) or not tables:
            raise film_error(self._file, 0, 'there are no tracks, as in [tracks."camera.eye"]')
        tracks = tuple(self._track(path, table) for path, table in _flat(tables))
        return Script(tracks, float(shutter))

    def _track(self, path: str, table: Mapping[str, Any]) -> Track:
        self._check_names(table, _TRACK, path, path)
        try:
            address = find_address(self._scene, path, self._names)
        except AddressError as error:
            raise film_error(self._file, self._line(path), str(error)) from None
        usual = self._easing(table.get("easing", "linear"), path, None)
        rows = table.get("keys")
        if not isinstance(rows, list) or not rows:
            raise film_error(self._file, self._line(path), f"{path} has no keys, as in keys = [[0.0, 1], [2.0, 5]]")
        keys = tuple(self._key(path, address, k, row, usual) for k, row in enumerate(rows))
        for k, (before, after) in enumerate(pairwise(keys), 1):
            if after.time <= before.time:
                raise self._error(path, k, f"its time, {after.time:g}, is not after that before it, {before.time:g}")
        loop = table.get("loop", False)
        if not isinstance(loop, bool):
            raise film_error(self._file, self._line(path), f"loop must be true or false, found {loop!r}")
        if loop and (len(keys) < 2 or keys[0].value != keys[-1].value):
            raise self._error(path, len(keys) - 1, "a loop ends with the value that it begins with")
        return Track(address, keys, loop)

    def _key(self, path: str, address: Address, k: int, row: Any, usual: Easing) -> Key:
        if not isinstance(row, list) or len(row) not in (2, 3):
            raise self._error(path, k, f"must be [seconds, value], or have an easing behind them, found {_shown(row)}")
        time, value = row[:2]
        if not _is_number(time) or time < 0:
            raise self._error(path, k, f"its time must be a number of seconds from 0 on, found {_shown(time)}")
        easing = self._easing(row[2], path, k) if len(row) == 3 else usual
        if address.size:
            good = isinstance(value, list) and len(value) == address.size and all(map(_is_number, value))
            wanted = f"{address.size} numbers"
        else:
            good, wanted = _is_number(value), "a number"
        if not good:
            raise self._error(path, k, f"its value must be {wanted}, found {_shown(value)}")
        return Key(float(time), tuple(map(float, value if address.size else [value])), easing)

    def _easing(self, word: Any, path: str, k: int | None) -> Easing:
        if word in EASINGS:
            return cast(Easing, word)
        hint = did_you_mean(word, EASINGS) if isinstance(word, str) else ""
        message = f"there is no easing {word!r}{hint}: {', '.join(EASINGS)} are"
        raise film_error(self._file, self._line(path, k), f"{path}: {message}")

    def _error(self, path: str, k: int, message: str) -> Exception:
        return film_error(self._file, self._line(path, k), f"{path}, key {k + 1}: {message}")

    def _check_names(self, table: Any, known: Sequence[str], what: str, within: str) -> None:
        if not isinstance(table, Mapping):
            raise film_error(self._file, self._line(what), f"{what} must be a table, as in [tracks.{what!r}]")
        for name in table:
            if name not in known:
                hint = did_you_mean(name, known) or f": there is {', '.join(known)}"
                line = self._line(name, after=self._line(within) if within else 0)
                raise film_error(self._file, line, f"{what} has no {name!r}{hint}")

    def _line(self, path: str, key: int | None = None, after: int = 0) -> int:
        """The line that names a path, or, behind it, has a key; 0 where that cannot be told from the text."""
        lines = self._text.splitlines()
        found = next((k for k, text in enumerate(lines, 1) if k > after and path in text.partition("#")[0]), 0)
        if not found or key is None:
            return found
        behind = enumerate(lines[found:], found + 1)
        section = list(takewhile(lambda line: not re.match(r"\s*\[+\s*[A-Za-z\"']", line[1]), behind))
        rows = [k for k, text in section if re.match(r"\s*\[\s*[-+.\d]", text)]
        whole = [k for k, text in section if re.match(r"\s*keys\b", text)]
        return rows[key] if key < len(rows) else next(iter(whole), found)


def _flat(tables: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Tables by their paths, also of those that are written without quotation marks: [tracks.camera.eye]."""
    found: list[tuple[str, Any]] = []
    for name, table in tables.items():
        if (
            isinstance(table, Mapping)
            and not set(table) & set(_TRACK)
            and any(isinstance(inner, Mapping) for inner in table.values())
        ):
            found += _flat(table, f"{prefix}{name}.")
        else:
            found.append((prefix + name, table))
    return found


def _is_number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, float | int):
        return False
    return abs(value) <= sys.float_info.max  # of a whole number, too, which may be larger than any double


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
