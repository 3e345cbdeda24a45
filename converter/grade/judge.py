"""What is told of one picture, as plain data."""

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from converter.grade.undecided import draw, undecided
from converter.scene.model import Scene
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.acne import ACNE
from converter.why.judge import judge
from converter.why.left import places_left
from converter.why.likeness import COMPRESSED, EXACT, Mask
from converter.why.picture import Picture, Theirs
from converter.why.report import left_sentence, verdict
from converter.why.student import Deviation, Places, UnknownToStudent, deviations

FEW = 0.001
"""Share of the pixels that may be wrong in a picture that is right, as for `compare`."""
OWN = {
    name: Deviation(name, "program", name, sentence, hint, -1)
    for name, sentence, hint in (
        ("size", "a picture of another size than asked", "the program's third and fourth arguments: width and height"),
        ("name", "a picture under another name than asked", "the program's second argument: the picture's name"),
        (
            "status",
            "a program that fails though its picture is there",
            "how main() ends: return 0, and no crash before",
        ),
        ("blank", "rows in which nothing is drawn", "the loops over rows and columns, and where the program ends"),
    )
}
"""Mistakes that lie outside of what a tracer computes."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is told of a picture.

    Attributes:
        width, height: its size.
        right: whether it is right, as far as can be told.
        wrong: share of its pixels that are wrong; those that single precision cannot decide do not count.
        left: share that is wrong with the causes, too.
        causes: the mistakes that lead to it, by name.
        spoiled: for each of them the share of the picture that is wrong by it alone.
        alternatives: for some of them others that look the same here.
        sentence: all of that, in words.
        places: where the pixels lie that are left: object, mechanism, share.

    """

    width: int
    height: int
    right: bool
    wrong: float
    left: float
    causes: tuple[str, ...]
    spoiled: dict[str, float]
    alternatives: dict[str, tuple[str, ...]]
    sentence: str
    places: tuple[tuple[str, str, float], ...] = ()

    @staticmethod
    def of(data: "dict[str, object]") -> "Verdict":
        """The verdict that was stored as JSON."""
        known: dict[str, object] = dict(data)
        known["causes"] = tuple(data["causes"])  # type: ignore[arg-type]
        known["alternatives"] = {k: tuple(v) for k, v in data["alternatives"].items()}  # type: ignore[attr-defined]
        known["places"] = tuple(tuple(place) for place in data["places"])  # type: ignore[attr-defined]
        return Verdict(**known)  # type: ignore[arg-type]


def mistakes() -> dict[str, Deviation]:
    """Every mistake that may be named, by its name."""
    return {**deviations(), **OWN}


def judge_picture(scene_file: Path, levels: Picture, lossy: bool, settings: Settings) -> Verdict:
    """What is told of a picture of the scene in a file; it may have another size than the settings ask for.

    Raises:
        RendererUnavailable: a tracer is not built.

    """
    height, width, _ = levels.shape
    asked = (settings.width, settings.height)
    settings = replace(settings, width=width, height=height)
    scene, spared = _prepared(scene_file, settings)
    try:
        result = _explained(scene, Theirs(Path("picture"), levels, lossy), settings, spared)
    except UnknownToStudent as error:
        result = _compared(scene, levels, lossy, settings, spared, str(error))
    if (width, height) == asked:
        return result
    told = f"The picture has {width} x {height} pixels, not {asked[0]} x {asked[1]}. {result.sentence}"
    return replace(result, right=False, causes=(*result.causes, "size"), sentence=told)


@lru_cache(maxsize=4)
def _prepared(scene_file: Path, settings: Settings) -> tuple[Scene, Mask]:
    scene = load_scene(scene_file)
    return scene, undecided(scene, settings)


def _explained(scene: Scene, theirs: Theirs, settings: Settings, spared: Mask) -> Verdict:
    judged = judge(scene, theirs, settings, timed=False)
    found = judged.found
    decided = _decided(found.screen.places, spared)
    wrong, left = _share(found.before & decided, decided), _share(found.after & decided, decided)
    causes = (*found.causes, *([ACNE] if judged.acne else []), *(["blank"] if judged.blank.any() else []))
    right = judged.right or (not causes and wrong <= FEW)
    spoiled = {cause: count / max(len(decided), 1) - left for cause, count in found.without.items()}
    if judged.acne:
        spoiled[ACNE], left = left, 0.0
    if judged.blank.any():
        spoiled["blank"] = float(judged.blank.mean())
        wrong = spoiled["blank"] + (1 - spoiled["blank"]) * wrong
    places = () if right else tuple(places_left(judged))
    if right and not judged.right:
        sentence = "The picture is right, but for pixels that single precision cannot decide."
    else:
        sentence = " ".join(filter(None, (verdict(judged), left_sentence(places, judged))))
    told = tuple((place.object, place.mechanism, place.share) for place in places[:5])
    alternatives = {cause: found.alternatives.get(cause, ()) for cause in found.causes}
    return Verdict(*_size(settings), right, wrong, left, causes, spoiled, alternatives, sentence, told)


def _compared(scene: Scene, levels: Picture, lossy: bool, settings: Settings, spared: Mask, why: str) -> Verdict:
    """For scenes in which no mistakes are looked for."""
    likeness = COMPRESSED if lossy else EXACT
    judged = likeness.judged(*_size(settings))
    ys, xs = np.nonzero(judged)
    places = np.stack((xs, ys), axis=1).astype(np.int32)
    decided = _decided(places, spared)
    wrong = _share(likeness.wrong(draw(scene, settings)[ys, xs], levels[ys, xs], places) & decided, decided)
    right = wrong <= FEW
    sentence = "The picture is right." if right else f"{100 * wrong:.1f} % of the picture is wrong ({why})."
    return Verdict(*_size(settings), right, wrong, wrong, (), {}, {}, sentence)


def _size(settings: Settings) -> tuple[int, int]:
    return settings.width, settings.height


def _decided(places: Places, spared: Mask) -> Mask:
    xs, ys = places.T
    result: Mask = ~spared[ys, xs]
    return result


def _share(wrong: Mask, decided: Mask) -> float:
    return float(wrong.sum() / max(int(decided.sum()), 1))
