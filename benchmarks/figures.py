"""Prints the figures of docs/figures.md: agreement of the renderers on every scene, why pixels disagree, speed, memory.

    python benchmarks/figures.py [memory] [agreement] [bytes] [classes] [speed] [samples] [sampled]
                                 [adaptive] [mixed]

Times are medians of runs that take turns, so that a machine whose speed drifts is fair to all; they depend on the
machine, their ratios much less. POV-Ray joins where it is installed.
"""

import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from tables import print_table

import native_tracer
from converter.compare.classes import CLASSES, Class, explain, less_exact
from converter.compare.metrics import compare_pixels
from converter.renderers.adaptive import Adapting
from converter.renderers.base import Renderer, Rendering
from converter.renderers.methods import METHODS
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer, build_scene
from converter.renderers.povray import PovrayRenderer
from converter.scene.geometry import simplified
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import ADAPTIVE_SAMPLES, Settings
from native_tracer import quantize

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scenes"))

from random_scenes import random_scene
from round_numbers import SQUARES, TEXTURE

ROOT = Path(__file__).resolve().parent.parent
FIGURE1 = ROOT / "scenes" / "figure1.in"
PROGRAMS = Path(sys.executable).parent
RUNS, FEW_RUNS = 11, 3
RANDOM_SCENES = 200
MOST_EXPLAINED = 100
"""Pixels of a picture whose rays are compared: of glass csgs some take a second."""
POVRAY = "POV-Ray 3.7, its trace time"
NAMED = [kind for kind in CLASSES if kind != "not determined by the scene"]
"""Which pixels those are is not asked."""
LIMITS = (8, 24, 40)
"""Of adaptive sampling, in levels of 255."""
MEASURED = 1 / 16
"""The share of pixels in which its errors are measured: 256 samples take long."""
BLOCK = 16
"""They are squares of so many pixels a side: few rays would share a group elsewhere."""


def main() -> None:
    """Print what the command line names, or everything."""
    # Memory first: Linux counts what this process has held as held by those that it starts.
    parts = {
        "memory": memory,
        "agreement": agreement,
        "bytes": same_bytes,
        "classes": classes,
        "speed": speed,
        "samples": samples,
        "sampled": sampled,
        "adaptive": adaptive,
        "mixed": mixed,
    }
    for name in sys.argv[1:] or parts:
        parts[name]()
        print()


def agreement() -> None:
    """Each scene at 800 x 600: Mitsuba's methods against native double, their times, and POV-Ray's, its trace time."""
    renderers: dict[str, Renderer] = {
        "default": MitsubaRenderer(),
        "mesh": MitsubaRenderer(intersections="mesh"),
        "ulp": MitsubaRenderer(intersections="ulp"),
        "offset": MitsubaRenderer(intersections="offset"),
    }
    print(
        "800 x 600: pixels of 480,000 that differ from native double by more than 1/255, and seconds to render, warm,"
    )
    print(
        f"medians of {FEW_RUNS} runs in turn: Mitsuba's default method, Embree with exact surfaces, Embree alone with"
    )
    print("Waechter and Binder's offset, and with Mitsuba's own; POV-Ray's trace time, and that over native's")
    seconds = [f"{name} s" for name in renderers]
    heads = ["", *renderers, "native s", *seconds, "POV-Ray s", "over native", "default is"]
    print_table("agreement", heads, map(partial(_agreement, renderers), sorted((ROOT / "scenes").glob("*.in"))))


def _agreement(renderers: dict[str, Renderer], file: Path) -> list[str]:
    """A scene's row: disagreeing pixels, seconds, and what the default method does."""
    others = {"POV-Ray": PovrayRenderer()} if shutil.which("povray") else {}
    scene, settings = load_scene(file), Settings()
    native = NativeRenderer()
    truth = np.asarray(native.render(scene, settings).pixels)
    pictures = {name: renderer.render(scene, settings) for name, renderer in renderers.items()}
    wrong = [compare_pixels(truth, np.asarray(picture.pixels)).disagreeing for picture in pictures.values()]
    subjects = {name: _seconds(each, file) for name, each in {"native": native, **renderers, **others}.items()}
    medians = {name: statistics.median(values) for name, values in _interleaved(subjects, FEW_RUNS).items()}
    povray = medians.get("POV-Ray", math.nan)
    told = [f"{medians[name]:.3g}" for name in ("native", *renderers)]
    ratio = f"{povray / medians['native']:.1f}"
    return [file.stem, *map(str, wrong), *told, f"{povray:.3g}", ratio, pictures["default"].statistics["intersections"]]


def same_bytes() -> None:
    """The gallery's scenes at 400 x 300, and random ones: whether both renderers' .ppm files are the same."""
    print("400 x 300: bytes of both renderers' .ppm files that differ, by how many levels at most, and pixels whose")
    print("colours differ by more than a tenth of a level: in others a rounding has decided between two levels")
    settings = Settings(width=400, height=300)
    for file in sorted((ROOT / "scenes").glob("*.in")):
        print(f"{file.name:<18}{_bytes_told(*_unlike_bytes(load_scene(file), settings))}", flush=True)
    same = 0
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, TEXTURE).write_text(SQUARES, encoding="ascii")
        for seed in range(RANDOM_SCENES):
            scene = parse_scene(str(random_scene(seed)), Path(folder, "random.in"))
            found = _unlike_bytes(scene, Settings(width=160, height=120))
            same += found[0] == 0
            if found[0]:
                print(f"{f'random {seed}':<18}{_bytes_told(*found)}", flush=True)
    print(f"of {RANDOM_SCENES} random scenes (scenes/random_scenes.py), at 160 x 120, {same} are the same")


def _unlike_bytes(scene: Scene, settings: Settings) -> tuple[int, int, int]:
    """How many bytes of the renderers' pictures differ, by how many levels at most, and how many pixels do visibly."""
    renderers = NativeRenderer(), MitsubaRenderer()
    pictures = [np.asarray(renderer.render(scene, settings).pixels) for renderer in renderers]
    levels = [np.frombuffer(quantize(picture), np.uint8).astype(int) for picture in pictures]
    off = np.abs(levels[0] - levels[1])
    far = np.abs(pictures[0].astype(float) - pictures[1]).max(axis=2) > 0.1 / 255
    return int((off > 0).sum()), int(off.max()), int(far.sum())


def _bytes_told(unlike: int, most: int, far: int) -> str:
    return f"{unlike:>6}, {most:>3} levels, {far:>4} pixels" if unlike else "  same"


def classes() -> None:
    """Pixels of all scenes at 400 x 300 in which a method disagrees with native double, by what they are near to."""
    methods = [METHODS[name] for name in ("mitsuba", "native-float", "mitsuba-mesh", "mitsuba-ulp", "mitsuba-offset")]
    settings, native = Settings(width=400, height=300), METHODS["native"]
    counts: dict[str, Counter[Class]] = {method.name: Counter() for method in methods}
    disagreeing: Counter[str] = Counter()
    for file in sorted((ROOT / "scenes").glob("*.in")):
        scene = load_scene(file)
        truth = np.asarray(native.renderer().render(scene, settings).pixels)
        for method in methods:
            renderer = method.renderer()
            traces = tuple(partial(r.trace_pixels, scene, settings) for r in (native.renderer(), renderer))
            pictures = truth, np.asarray(renderer.render(scene, settings).pixels)
            arithmetic = less_exact(native, method)
            found = explain(scene, pictures, (settings, settings), traces, arithmetic, MOST_EXPLAINED)
            counts[method.name].update(found.counts())
            disagreeing[method.name] += found.disagreeing
    print(
        "400 x 300, all scenes: pixels that differ from native double by more than 1/255; by what they are near to, of"
    )
    print(f"up to {MOST_EXPLAINED} a scene")
    numbers = {
        name: [disagreeing[name], by_class.total(), *(by_class[kind] for kind in NAMED)]
        for name, by_class in counts.items()
    }
    rows = ([name, *map(str, row)] for name, row in numbers.items())
    print_table("classes", ["", "pixels", "of these", *NAMED], rows)


def speed() -> None:
    """Figure 1 at 800 x 600: rendering alone, warm, and whole processes."""
    print(f"Figure 1 at 800 x 600, {len(os.sched_getaffinity(0))} threads, seconds of {RUNS} runs in turn")
    with tempfile.TemporaryDirectory() as folder:
        subjects = {
            "native, double": _seconds(NativeRenderer(), FIGURE1),
            "native, float": _seconds(NativeRenderer("float"), FIGURE1),
            "Mitsuba, warm": _seconds(MitsubaRenderer(), FIGURE1),
            "Mitsuba through meshes and Embree, warm": _seconds(MitsubaRenderer(intersections="mesh"), FIGURE1),
            "Python that imports nothing, whole process": _process(sys.executable, "-c", "pass"),
            "`raytrace`, whole process": _process("raytrace", FIGURE1, Path(folder, "a.ppm")),
            "`whitted render`, whole process, warm kernel cache": _process(
                "whitted", "render", FIGURE1, Path(folder, "b.ppm"), "--quiet"
            ),
        }
        if shutil.which("povray"):
            subjects[POVRAY] = _seconds(PovrayRenderer(), FIGURE1)
        times = _interleaved(subjects)
    povray = statistics.median(times.get(POVRAY, [math.nan]))
    rows = []
    for name, values in times.items():
        median = statistics.median(values)
        faster = "" if name == POVRAY or "process" in name else f"{povray / median:.1f} x"
        rows.append([name, f"{median:.3f}", f"{min(values):.3f}", faster])
    print_table("speed", ["", "median", "least", "than POV-Ray, medians"], rows)


def samples() -> None:
    """Seconds for more and more samples a pixel, and how often Mitsuba's kernel is launched for each."""
    counts, width, height = (1, 16, 64, 256), 320, 240
    print(f"{width} x {height}, median seconds of {FEW_RUNS} runs in turn by samples a pixel, and launches a sample")
    print_table("samples", ["", *map(str, counts), "launches a sample"], _samples(counts, width, height))


def _samples(counts: Sequence[int], width: int, height: int) -> Iterator[list[str]]:
    for name in ("figure1", "whitted", "prisms"):
        scene = load_scene(ROOT / "scenes" / f"{name}.in")
        for kind, renderer in (("native", NativeRenderer()), ("Mitsuba", MitsubaRenderer())):
            draw = {n: partial(renderer.render, scene, Settings(width=width, height=height, samples=n)) for n in counts}
            times = _interleaved({str(n): partial(_render_seconds, render) for n, render in draw.items()}, FEW_RUNS)
            seconds = [f"{statistics.median(spent):.3g}" for spent in times.values()]
            launches = [f"{_launches(render) / n:.2g}" for n, render in draw.items()] if kind == "Mitsuba" else []
            yield [f"{name}, {kind}", *seconds, ", ".join(launches)]


def sampled() -> None:
    """The scenes in which something is random: pixels that disagree at equal samples, and what a sample costs."""
    print("pixels that differ by more than 1/255 from native double: Mitsuba's of 160 x 120, long double's of 80 x 60;")
    print(f"microseconds a sample, medians of {FEW_RUNS} runs in turn; 1, 16 and 256 samples")
    heads = ["", "Mitsuba", "long double", "native, us a sample", "Mitsuba, us a sample", "over native"]
    print_table("sampled", heads, map(_sampled, sorted((ROOT / "scenes" / "sampled").glob("*.in"))))


def _sampled(file: Path) -> list[str]:
    native, mitsuba, exact = NativeRenderer(), MitsubaRenderer(), NativeRenderer("long double")
    scene = load_scene(file)
    cells: list[list[str]] = []
    for count in (1, 16, 256):
        large, small = (Settings(width=w, height=h, samples=count) for w, h in ((160, 120), (80, 60)))
        wrong = [_disagreeing(scene, large, native, mitsuba), _disagreeing(scene, small, native, exact)]
        times = _interleaved(
            {
                kind: partial(_render_seconds, partial(renderer.render, scene, large))
                for kind, renderer in (("native", native), ("Mitsuba", mitsuba))
            },
            FEW_RUNS,
        )
        us, theirs = (statistics.median(spent) * 1e6 / (160 * 120 * count) for spent in times.values())
        cells.append([*map(str, wrong), f"{us:.2f}", f"{theirs:.2f}", f"{theirs / us:.1f}"])
    return [file.stem, *(", ".join(each) for each in zip(*cells, strict=True))]


def _disagreeing(scene: Scene, settings: Settings, one: Renderer, other: Renderer) -> int:
    pixels = (np.asarray(renderer.render(scene, settings).pixels) for renderer in (one, other))
    return compare_pixels(*pixels).disagreeing


def mixed() -> None:
    """Each scene at 400 x 300: what of it mixed precision draws in double, and what that costs on this machine."""
    print("400 x 300: share of the pixels that mixed precision draws once more in double, pixels that differ from")
    print(
        f"native double by more than 1/255, and CPU time over that of Mitsuba's default, medians of {RUNS} runs in turn"
    )
    heads = ["", "in double", "wrong", "time over default's"]
    print_table("mixed", heads, map(_mixed, sorted((ROOT / "scenes").glob("*.in"))))


def _mixed(file: Path) -> list[str]:
    scene, settings = load_scene(file), Settings(width=400, height=300)
    renderers = {"default": MitsubaRenderer(), "mixed": METHODS["mitsuba-mixed"].renderer()}
    picture = renderers["mixed"].render(scene, settings)
    truth = np.asarray(NativeRenderer().render(scene, settings).pixels)
    wrong = compare_pixels(truth, np.asarray(picture.pixels)).disagreeing
    times = _interleaved({name: partial(_cpu_seconds, each, scene, settings) for name, each in renderers.items()})
    default, its = (statistics.median(spent) for spent in times.values())
    return [file.stem, f"{picture.statistics['drawn_in_double']:.2%}", str(wrong), f"{its / default:.2f}"]


def _cpu_seconds(renderer: Renderer, scene: Scene, settings: Settings) -> float:
    started = time.process_time()
    renderer.render(scene, settings)
    return time.process_time() - started


def adaptive() -> None:
    """The gallery's scenes, in which nothing is random: errors of adaptive and of uniform pictures, and rays."""
    one_in = round(1 / MEASURED)
    print(f"800 x 600, native: RMS error in levels of 255 against 256 samples a pixel, in one of {one_in} pixels: one")
    print("sample, 16, and as --adaptive LIMIT has it, with the rays a pixel from the eye")
    heads = ["", "1", "16", *(head for limit in LIMITS for head in (f"--adaptive {limit}", "rays"))]
    print_table("adaptive", heads, _adaptive_rows())


def _adaptive_rows() -> Iterator[list[str]]:
    found = []
    for file in sorted((ROOT / "scenes").glob("*.in")):
        found.append(_adaptive_errors(load_scene(file)))
        yield [file.stem, *(f"{number:.2f}" for number in found[-1])]
    yield ["mean of all", *(f"{number:.2f}" for number in np.mean(found, axis=0))]


def _adaptive_errors(scene: Scene) -> list[float]:
    measured = _some_blocks(600, 800)
    truth, *uniform = (_seen(_some_pixels(scene, measured, count)[measured]) for count in (256, 1, 16))
    result = [_rms_levels(picture, truth) for picture in uniform]
    for limit in LIMITS:
        chosen = Adapting(limit, ADAPTIVE_SAMPLES)
        rendering = NativeRenderer().render_adaptively(scene, Settings(samples=ADAPTIVE_SAMPLES), chosen)
        picture = _seen(np.asarray(rendering.pixels)[measured])
        result += [_rms_levels(picture, truth), chosen.statistics()["rays_a_pixel"]]
    return result


def _some_blocks(height: int, width: int) -> np.ndarray:
    """A mask of the squares in which errors are measured, the same each time."""
    chosen = np.random.default_rng(0).random((-(-height // BLOCK), -(-width // BLOCK))) < MEASURED
    return chosen.repeat(BLOCK, axis=0).repeat(BLOCK, axis=1)[:height, :width]


def _some_pixels(scene: Scene, mask: np.ndarray, samples: int) -> np.ndarray:
    """A picture in which some pixels are drawn."""
    height, width = mask.shape
    settings = Settings(width, height, samples=samples)
    scene = simplified(scene)
    needs = scene_needs(scene, settings)
    image, sums = native_tracer.Image(width, height), native_tracer.PassSums(width, height)
    options = {"samples": samples, "cutoff": settings.cutoff, "max_depth": needs.max_depth}
    cells = [list(range(samples))]
    native_tracer.render(build_scene(scene, needs), image, passes=cells, sums=sums, mask=mask.view(np.uint8), **options)
    return np.asarray(image.pixels)


def _seen(pixels: np.ndarray) -> np.ndarray:
    return np.clip(pixels.astype(np.float64), 0, 1)


def _rms_levels(picture: np.ndarray, truth: np.ndarray) -> float:
    """Root of the mean square of differences, in levels of 255."""
    return 255 * math.sqrt(np.mean((picture - truth) ** 2))


def _render_seconds(render: Callable[[], Rendering]) -> float:
    return render().seconds["render"]


def _launches(render: Callable[[], Rendering]) -> int:
    """How often Mitsuba's kernel that traces rays, the one of the most operations, runs for a picture."""
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        render()
        kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    most = max(kernel["operation_count"] for kernel in kernels)
    return sum(kernel["operation_count"] == most for kernel in kernels)


def memory() -> None:
    """Largest resident set of both renderers at 3840 x 2160."""
    print("Figure 1 at 3840 x 2160, one sample a pixel, largest resident set")
    for method in ("native", "mitsuba"):
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder, "large.ppm")
            options = ["--quiet", "--method", method]
            command = [PROGRAMS / "whitted", "render", FIGURE1, picture, "3840", "2160", *options]
            process = subprocess.Popen(command)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode != 0:
                raise SystemExit(f"whitted render --method {method} failed")
        print(f"{method:<10}{usage.ru_maxrss / 1024:>8.0f} MiB")


def _seconds(renderer: Renderer, file: Path) -> Callable[[], float]:
    """Draws a scene, and tells the seconds that the rendering alone took."""
    scene, settings = load_scene(file), Settings()
    return lambda: renderer.render(scene, settings).seconds["render"]


def _interleaved(subjects: dict[str, Callable[[], float]], runs: int = RUNS) -> dict[str, list[float]]:
    """Seconds of each subject in rounds, after one that is not counted."""
    times: dict[str, list[float]] = {name: [] for name in subjects}
    for _ in range(runs + 1):
        for name, subject in subjects.items():
            times[name].append(subject())
    return {name: values[1:] for name, values in times.items()}


def _process(program: str, *arguments: str | Path) -> Callable[[], float]:
    def run() -> float:
        started = time.perf_counter()
        subprocess.run(
            [PROGRAMS / program, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        return time.perf_counter() - started

    return run


if __name__ == "__main__":
    main()
