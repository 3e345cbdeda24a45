"""From a scene and a picture to what explains the picture."""

from dataclasses import dataclass, replace

import numpy as np

from converter.renderers.native import NativeRenderer
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.why.acne import has_acne
from converter.why.blank import blank_rows
from converter.why.likeness import COMPRESSED, EXACT, Mask, errors, mean_errors
from converter.why.picture import Picture, Theirs
from converter.why.search import Found, find_causes
from converter.why.student import Student, make_student, to_levels

_MEAN, _NEARLY_ALL = 2.5, 0.9
"""Levels by which the means of nearly all squares may differ for losses of compression to be all there is."""
_BIAS = 0.5
"""Levels by which the whole picture may."""
_SHARE = 0.05
"""Share of the pixels that are wrong at least where a picture has been compressed."""
_ROW_PIXELS = 1000
"""Pixels of rows without a drawing that are looked at."""
_EXPLAINED = 0.5
"""Share of the wrong pixels below which causes do not count as found."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A picture, the right one, and what leads from one to the other.

    Attributes:
        scene, settings: what the picture is of; the settings have its size.
        theirs, reference: the picture, and the right one.
        student: draws the scene with mistakes.
        found: the mistakes that lead to the picture.
        blank: (height,) rows in which nothing was drawn, which are not judged.
        acne: whether the pixels that they leave are speckles of acne, which are never the same in two programs.

    """

    scene: Scene
    settings: Settings
    theirs: Theirs
    reference: Picture
    student: Student
    found: Found
    blank: Mask
    acne: bool

    @property
    def right(self) -> bool:
        """Whether the picture is right, as far as can be told."""
        return self.found.right and not self.acne and not self.blank.any()


def judge(scene: Scene, theirs: Theirs, settings: Settings, timed: bool = True) -> Judged:
    """Look for what explains a picture of `scene`; the picture's size counts, not that of `settings`.

    Args:
        scene: it.
        theirs: the picture.
        settings: how the scene is read.
        timed: look at fewer pixels where they take long; else the same answer comes out on every machine.

    Raises:
        RendererUnavailable: the native tracer or the student's is not built.
        UnknownToStudent: the scene, or what the settings ask for, is more than the student's tracer knows.
        ValueError: a texture cannot be read.

    """
    height, width, _ = theirs.levels.shape
    settings = replace(settings, width=width, height=height)
    student = make_student(scene, settings)
    colors = np.asarray(NativeRenderer().render(scene, settings).pixels)
    reference = to_levels(colors.reshape(-1, 3)).reshape(colors.shape)
    blank = blank_rows(theirs.levels, reference)
    if theirs.lossy:
        found = find_causes(student, theirs.levels, reference, COMPRESSED, blank, timed)
        return Judged(scene, settings, theirs, reference, student, found, blank, acne=False)
    found = find_causes(student, theirs.levels, reference, EXACT, blank, timed)
    if blank.any() and found.causes and _draws_rows(student, theirs.levels, found, blank):
        blank = np.zeros_like(blank)
        found = find_causes(student, theirs.levels, reference, EXACT, blank, timed)
    acne = not blank.any() and has_acne(student, theirs.levels, frozenset(found.causes), EXACT)
    if not acne and _unexplained(found) and found.before.mean() >= _SHARE:
        roughly = find_causes(student, theirs.levels, reference, COMPRESSED, blank, timed)
        if _looks_compressed(student, theirs.levels, roughly):
            found = roughly
    return Judged(scene, settings, theirs, reference, student, found, blank, acne)


def _draws_rows(student: Student, theirs: Picture, found: Found, rows: Mask) -> bool:
    """Whether the causes explain rows that look as if nothing had been drawn."""
    ys, xs = np.nonzero(np.repeat(rows[:, np.newaxis], student.width, axis=1))
    chosen = np.random.default_rng(5).permutation(len(xs))[:_ROW_PIXELS]
    places = np.stack((xs, ys), axis=1).astype(np.int32)[chosen]
    drawn = student.drawn(places, frozenset(found.causes))
    return bool((errors(drawn, theirs[ys, xs][chosen]) <= EXACT.tolerance).mean() >= _NEARLY_ALL)


def _unexplained(found: Found) -> bool:
    before, after = int(found.before.sum()), int(found.after.sum())
    return before > 0 and before - after < _EXPLAINED * before


def _looks_compressed(student: Student, theirs: Picture, found: Found) -> bool:
    """Whether the causes leave what compression does, before a picture is saved once more: nothing on average."""
    places = found.screen.places
    if not len(places):
        return False
    xs, ys = places.T
    expected = student.drawn(places, frozenset(found.causes))
    bias = theirs[ys, xs].mean(axis=0) - expected.mean(axis=0)
    means, _ = mean_errors(expected, theirs[ys, xs], places)
    return bool(np.abs(bias).max() <= _BIAS and np.quantile(means, _NEARLY_ALL) <= _MEAN)
