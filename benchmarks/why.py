"""Prints how often `whitted why` names the right cause: mistakes are planted in the gallery, at random.

    python benchmarks/why.py                      200 single mistakes, 200 pairs, and right pictures
    python benchmarks/why.py --count 40 --seed 7 --size 400 300

A mistake is planted by the student's tracer, in a scene and a picture of a random size; it has to change at least one
pixel in 2000, each of a pair beside the other, and to leave something in the picture. What is named is right if it is
what was planted: the same number of causes, each of them planted, or told to explain as much as the one that was. Right
pictures are drawn by the native tracer, in double and in single precision, and saved without losses or as JPEG of
several qualities. Status 1: fewer are right than 95 % of the single mistakes and 85 % of the pairs, or a cause is named
for a right picture.
"""

import argparse
import random
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from converter.renderers.native import NativeRenderer
from converter.scene.model import Polyhedron, Scene, Sphere
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.judge import judge
from converter.why.likeness import EXACT, errors
from converter.why.picture import Picture, Theirs, read_theirs
from converter.why.student import Causes, Student, deviations, make_student, to_levels
from converter.why.trials import compatible

GALLERY = sorted((Path(__file__).resolve().parent.parent / "scenes").glob("*.in"))
# A student's tracer has the statement's own shapes.
SCENES = [p for p in GALLERY if all(isinstance(o.shape, Sphere | Polyhedron) for o in load_scene(p).objects)]
SIZES = ((320, 240), (400, 300), (480, 270), (300, 400), (256, 256))
QUALITIES = (40, 60, 75, 85, 95)
VISIBLE = 2000
"""A mistake changes one pixel in so many, at least."""
LEAST = {1: 0.95, 2: 0.85}


def main() -> int:
    """Plant, judge and print; return the status."""
    parser = argparse.ArgumentParser(description="Count how often the right cause is named.")
    parser.add_argument("--count", type=int, default=200, help="single mistakes, and pairs of them (200)")
    parser.add_argument("--seed", type=int, default=13, help="of what is planted (13)")
    parser.add_argument("--size", type=int, nargs=2, metavar=("WIDTH", "HEIGHT"), help="of all pictures (several)")
    parser.add_argument("--only", choices=("1", "2", "right"), help="only single mistakes, pairs, or right pictures")
    arguments = parser.parse_args()
    good = True
    for count in (1, 2):
        if arguments.only in (None, str(count)):
            good &= planted(count, arguments.count, random.Random(arguments.seed + count), arguments.size)
    if arguments.only in (None, "right"):
        good &= right_pictures(arguments.size or (400, 300))
    return 0 if good else 1


# ---- Mistakes ------------------------------------------------------------------------------------------------------


def planted(mistakes: int, wanted: int, rng: random.Random, size: list[int] | None) -> bool:
    """Plant so many mistakes at once, `wanted` times; whether enough of them are named."""
    right, alone, seconds = 0, 0, []
    for number in range(wanted):
        file, scene, settings, causes, picture = plant(mistakes, rng, size)
        started = time.perf_counter()
        found = judge(scene, Theirs(Path("theirs"), picture, lossy=False), settings).found
        seconds.append(time.perf_counter() - started)
        if is_right(causes, found.causes, found.alternatives):
            right += 1
            alone += set(found.causes) == causes and not any(found.alternatives.values())
        else:
            left = f"{found.after.sum()} of {found.before.sum()} wrong pixels left"
            print(f"  {number}: {file.stem} {settings.width} x {settings.height}: planted {', '.join(sorted(causes))}")
            print(f"      named {', '.join(found.causes) or 'nothing'}, {left}")
    what = {1: "single mistakes", 2: "pairs of mistakes"}[mistakes]
    print(f"{what}: {right} of {wanted} right ({100 * right / wanted:.1f} %), {alone} of them and no other")
    print(f"  seconds a picture: median {statistics.median(seconds):.2f}, most {max(seconds):.2f}", flush=True)
    return right >= LEAST[mistakes] * wanted


def plant(mistakes: int, rng: random.Random, size: list[int] | None) -> tuple[Path, Scene, Settings, Causes, Picture]:
    """A scene, and a picture of it with some mistakes, all of which can be seen."""
    while True:
        file = rng.choice(SCENES)
        width, height = size or rng.choice(SIZES)
        scene, settings = load_scene(file), Settings(width, height)
        student = make_student(scene, settings)
        names = [d.name for d in student.candidates()]
        causes = frozenset(rng.sample(names, mistakes))
        if not compatible(causes):
            continue
        picture = drawn(student, causes)
        if (picture == picture[:, :1]).all(axis=(1, 2)).all():  # nothing is drawn: there is nothing to explain
            continue
        least = width * height / VISIBLE
        if all(changed(picture, drawn(student, causes - {name}), name) >= least for name in causes):
            return file, scene, settings, causes, picture


def drawn(student: Student, causes: Causes) -> Picture:
    """The picture that a tracer with these mistakes draws."""
    ys, xs = np.divmod(np.arange(student.width * student.height), student.width)
    return student.drawn(np.stack((xs, ys), axis=1), causes).reshape(student.height, student.width, 3)


def changed(picture: Picture, without: Picture, name: str) -> int:
    """Pixels that a mistake changes visibly; one in the rounding of colours is one level."""
    return int((errors(picture, without) > (0 if deviations()[name].group == "rounding" else EXACT.tolerance)).sum())


def is_right(causes: Causes, named: tuple[str, ...], alternatives: dict[str, tuple[str, ...]]) -> bool:
    """Whether what is named is what was planted."""
    told = [{name, *alternatives.get(name, ())} for name in named]
    return len(named) == len(causes) and all(any(cause in names for names in told) for cause in causes)


# ---- Right pictures ------------------------------------------------------------------------------------------------


def right_pictures(size: tuple[int, int]) -> bool:
    """Judge right pictures; whether no cause is named for any."""
    judged, named = 0, 0
    for file in SCENES:
        scene, settings = load_scene(file), Settings(*size)
        double = np.asarray(NativeRenderer().render(scene, settings).pixels)
        single = np.asarray(NativeRenderer("float").render(scene, settings).pixels)
        with tempfile.TemporaryDirectory() as folder:
            pictures = {"double": without_losses(double), "single precision": without_losses(single)}
            for quality in QUALITIES:
                compressed = read_theirs(save_jpeg(Path(folder, f"{quality}.jpg"), double, quality))
                pictures[f"JPEG {quality}"] = compressed
                pictures[f"JPEG {quality} saved as PNG"] = Theirs(compressed.file, compressed.levels, lossy=False)
            for what, picture in pictures.items():
                found = judge(scene, picture, settings).found
                judged += 1
                allowed = {"single_precision"} if what == "single precision" else set()
                if set(found.causes) - allowed:
                    named += 1
                    print(f"  {file.stem}, {what}: named {', '.join(found.causes)}")
    print(f"right pictures: a cause is named for {named} of {judged}", flush=True)
    return named == 0


def without_losses(pixels: np.ndarray) -> Theirs:
    """A picture as a PPM file has it."""
    return Theirs(Path("right.ppm"), to_levels(pixels.reshape(-1, 3)).reshape(pixels.shape), lossy=False)


def save_jpeg(file: Path, pixels: np.ndarray, quality: int) -> Path:
    """Save a picture as JPEG."""
    import OpenImageIO as oiio  # noqa: N813

    height, width, _ = pixels.shape
    spec = oiio.ImageSpec(width, height, 3, oiio.UINT8)
    spec.attribute("Compression", f"jpeg:{quality}")
    output = oiio.ImageOutput.create(str(file))
    output.open(str(file), spec)
    output.write_image(to_levels(pixels.reshape(-1, 3)).reshape(pixels.shape))
    output.close()
    return file


if __name__ == "__main__":
    raise SystemExit(main())
