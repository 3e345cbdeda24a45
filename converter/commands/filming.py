"""A film, picture after picture: what is there already stays."""

import argparse
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory

from converter.batch.manifest import Manifest, digest_of
from converter.batch.pictures import Job, Picture
from converter.batch.run import Wanted, draw_pictures
from converter.commands.exits import UsageError
from converter.commands.method_options import Chosen
from converter.commands.patterns import fields_of, has_fields, named
from converter.commands.progress import ProgressBar
from converter.files import check_apart, check_target, is_special, make_folder, only_one, replacing
from converter.films.errors import FilmError
from converter.films.script import Changes, Script
from converter.films.writers import ENDINGS, check_writer, write_film
from converter.images.write import check_ending, check_writable
from converter.pigments.table import pigment_kind
from converter.renderers.partial import identity
from converter.scene.errors import SceneError
from converter.scene.model import Scene

_ENCODING = 0.05
"""What share of a film's time it takes to encode it, about."""


@dataclass(frozen=True)
class Filming:
    """What is to be filmed, and how."""

    arguments: argparse.Namespace
    method: Chosen
    scene: Scene
    script: Script
    keys: Path
    count: int

    def run(self) -> tuple[int, float]:
        """Draw the pictures that are not there, and make the film of all; how many were drawn, and seconds.

        Raises:
            UsageError: FILM is no film.
            FilmError: the film cannot be made.
            OSError, SceneError, RendererUnavailable: as they are.

        """
        started = time.perf_counter()
        film: Path = self.arguments.film
        drawn = self._draw_pattern(film) if has_fields(str(film)) else self._draw_film(film)
        return drawn, time.perf_counter() - started

    def _sources(self) -> list[Path]:
        textures = (file for pigment in self.scene.pigments for file in pigment_kind(pigment).files(pigment))
        return [self.arguments.scene, self.keys, *textures]

    def _draw_pattern(self, pattern: Path) -> int:
        fields_of("FILM", str(pattern), ("frame",))
        pictures = [named("FILM", str(pattern), frame=k) for k in range(self.count)]
        if len(set(pictures)) < len(pictures):
            raise UsageError(f"FILM: {pattern} gives two frames one name")
        check_ending(pictures[0], self.arguments.format)
        for folder in {picture.parent for picture in pictures}:
            make_folder(folder)
        check_writable(pictures[0], self.arguments.format)
        for picture in pictures:
            check_apart(picture, self._sources())
        with ProgressBar(pattern.name, self.arguments.quiet) as bar:
            return self._draw(pictures, self.arguments.format or pictures[0].suffix, bar)

    def _draw_film(self, film: Path) -> int:
        ending = self.arguments.format or film.suffix.lower()
        if ending not in ENDINGS:
            found = f"found {str(film)!r}" if ending else "and --format says which one of a pipe"
            known = f"{', '.join(ENDINGS)}, or be a pattern such as {{frame:04}}.png"
            raise UsageError(f"FILM must end in {known}, {found}")
        check_writer(ending)
        check_target(film, self._sources())
        with ProgressBar(film.name, self.arguments.quiet) as bar, self._frames_folder(film) as folder:
            pictures = [folder / f"{k:06}.png" for k in range(self.count)]
            drawn = self._draw(pictures, ".png", bar.part(film.name, 0, 1 - _ENCODING))
            with replacing(film, ending) as temporary:
                write_film(temporary, ending, pictures, self.arguments.fps, bar.part(film.name, 1 - _ENCODING, 1))
        return drawn

    @contextmanager
    def _frames_folder(self, film: Path) -> Iterator[Path]:
        """A folder for the film's pictures, which goes when the film is whole, and stays when it is not."""
        if is_special(film):
            with TemporaryDirectory() as temporary:
                yield Path(temporary)
            return
        folder = film.with_name(f"{film.name}.frames")
        make_folder(folder)
        with only_one(folder) as alone:
            if not alone:
                raise FilmError(f"{film}: another command draws this film at this moment, into {folder}")
            yield folder
            if not self.arguments.keep_frames:
                shutil.rmtree(folder)

    def _draw(self, pictures: list[Path], ending: str, bar: ProgressBar) -> int:
        """Draw those that are not there; how many."""
        settings = self.method.settings
        job = Job(self.scene, settings, self.method.name, self.arguments.variant, ending)
        same = identity(self.scene, settings, self.method.name)
        seconds = Fraction(1) / self.arguments.fps
        manifests = {folder: Manifest(folder) for folder in {picture.parent for picture in pictures}}

        def changes(k: int) -> Changes:
            return self.script.changes(float(k * seconds), float(seconds))

        # What changes is worked out once more for each that is drawn: of all frames it is too much to keep.
        wanted: list[tuple[int, str]] = []
        for k, file in enumerate(pictures):
            source = digest_of(same, ending, changes(k))
            if self.arguments.anew or not manifests[file.parent].has(file, source):
                wanted.append((k, source))
        there = len(pictures) - len(wanted)

        def told(share: float) -> None:
            bar((there + share * len(wanted)) / len(pictures))

        if not wanted:
            return 0
        asked = (Wanted(i, job, Picture(changes(k))) for i, (k, _) in enumerate(wanted))
        with draw_pictures(self.arguments, asked, len(wanted), told) as results:
            for i, found in results:
                k, source = wanted[i]
                if isinstance(found, SceneError):
                    raise FilmError(f"{self.keys}: frame {k} would be no scene: {found.problems[0].message}")
                if isinstance(found, Exception):
                    raise found
                manifests[pictures[k].parent].write(pictures[k], source, found.data)
        return len(wanted)
