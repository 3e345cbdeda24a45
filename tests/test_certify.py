"""Certified pixels: functions against many digits, pixels against a tracer without rounding, and faults noticed."""

import json
import random
from dataclasses import replace
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tie_scenes import TIE_SCENES

import certified_tracer
from converter.certify.certificate import certify, levels
from converter.certify.numbers import number
from converter.commands.main import main
from converter.images.texture import TextureError
from converter.images.write import write_image
from converter.renderers.base import EffectUnavailable
from converter.renderers.native import NativeRenderer
from converter.scene.model import Light, Texmap
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.studies.exact.arithmetic import Decimals, Undecided
from converter.studies.exact.tracer import ExactTracer
from converter.studies.families.scenes import scaled

SCENES = Path(__file__).parent.parent / "scenes"
RUNGS = range(len(certified_tracer.digits))


def _truth(value: Decimal) -> tuple[list[float], float]:
    """A number of 160 digits as doubles."""
    rest, parts = Fraction(value), []
    for _ in range(10):
        parts.append(float(rest))
        rest -= Fraction(parts[-1])
    return parts, abs(float(rest)) + abs(float(value)) * 1e-150


def _check(function: str, arguments: list[float], truth: Decimal, lost: int) -> None:
    """On every rung the interval holds the truth, and is as narrow as its digits allow, but for some `lost` ones."""
    for rung in RUNGS:
        low, high = certified_tracer.miss(function, [number(x) for x in arguments], _truth(truth), rung)
        assert low <= 0 <= high, (function, arguments, rung)
        digits = min(certified_tracer.digits[rung], 430)
        assert high - low <= abs(float(truth)) * 2.0 ** (lost - digits) + 1e-300, (function, arguments, rung)


@pytest.mark.parametrize("seed", range(3))
def test_enclosures_hold_the_truth(seed: int) -> None:
    rng = random.Random(seed)
    with localcontext() as context:
        context.prec = 160
        for _ in range(8):
            x, y = (round(rng.uniform(-3, 3), 12) for _ in range(2))
            a, b = Decimal(repr(x)), Decimal(repr(y))
            size = max(abs(x), abs(y), 1e-3)
            if abs(x + y) > 0.1 and abs(x - y) > 0.1:
                _check("+", [x, y], a + b, 8 + int(size / 0.1).bit_length())
                _check("-", [x, y], a - b, 8 + int(size / 0.1).bit_length())
            _check("*", [x, y], a * b, 8)
            _check("/", [x, y], a / b, 12)
            _check("sqrt", [abs(x)], abs(a).sqrt(), 12)
            _check("exp", [-abs(x)], (-abs(a)).exp(), 16)
            share = round(rng.uniform(0.01, 0.9), 9)
            log = Decimal(repr(share)).ln()
            _check("log", [share], log, 16)
            _check("power", [share, abs(x)], (abs(a) * log).exp(), 20)
            _check("power", [share, 20.0], Decimal(repr(share)) ** 20, 12)


@pytest.mark.parametrize("seed", range(2))
def test_wide_intervals_hold_all_that_their_numbers_give(seed: int) -> None:
    """Their ends come from ends, whatever their signs."""
    rng = random.Random(seed)
    operations = {"+": Fraction.__add__, "-": Fraction.__sub__, "*": Fraction.__mul__, "/": Fraction.__truediv__}
    for _ in range(100):
        (x, a), (y, b) = [(rng.choice((-1, 1)) * rng.uniform(0, 2), rng.uniform(0, 1)) for _ in range(2)]
        for name, operation in operations.items():
            if name == "/" and abs(y) <= b:
                continue
            results = [
                operation(Fraction(x) + i * Fraction(a), Fraction(y) + j * Fraction(b))
                for i in (-1, 1)
                for j in (-1, 1)
            ]
            _holds(name, [([x], a), ([y], b)], min(results), max(results))
        ends = sorted(((Fraction(x) - Fraction(a)) ** 2, (Fraction(x) + Fraction(a)) ** 2))
        for rung in RUNGS:
            root = certified_tracer.miss("sqrt", [([abs(x)], 0.0)], ([0.0], 0.0), rung)
            assert Fraction(root[0]) ** 2 <= Fraction(abs(x)) <= Fraction(root[1]) ** 2
        _holds("square", [([x], a)], Fraction(0) if abs(x) <= a else ends[0], ends[1])


def test_wide_intervals_of_functions() -> None:
    with localcontext() as context:
        context.prec = 160
        for far in (3, 599, 700):
            low, high = (Fraction(Decimal(-x).exp()) for x in (far + 2, far - 2))
            _holds("exp", [([float(-far)], 2.0)], low, high)


@pytest.mark.parametrize("rung", RUNGS)
@pytest.mark.parametrize(
    ("function", "arguments"),
    [("/", [([1.0], 0.0), ([0.5], 1.0)]), ("log", [([0.5], 0.49)])],
    ids=["division by what may be 0", "logarithm of nearly anything"],
)
def test_what_intervals_leave_open(function: str, arguments: list[tuple[list[float], float]], rung: int) -> None:
    with pytest.raises(ValueError, match="undecided"):
        certified_tracer.miss(function, arguments, ([0.0], 0.0), rung)


def test_sizes_beyond_those_of_doubles() -> None:
    """Squares of small ones are 0 in doubles, and numbers of more digits know them; large ones are left undecided."""
    scene, settings = load_scene(SCENES / "whitted.in"), Settings(width=16, height=12, max_depth=2)
    lights = tuple(replace(each, attenuation=(1.0, 0.0, 0.0)) for each in scene.lights)
    scene = replace(scene, lights=lights)
    small, large = (scaled(scaled(scene, factor), factor) for factor in (1e-100, 1e100))
    assert (certify(small, settings).low == certify(scene, settings).low).all()
    assert certify(large, settings).counts() == {"range": 16 * 12}


def _holds(function: str, arguments: list[tuple[list[float], float]], low: Fraction, high: Fraction) -> None:
    """The interval has both ends, and not much more."""
    for rung in RUNGS:
        found = certified_tracer.miss(function, arguments, ([0.0], 0.0), rung)
        assert Fraction(found[0]) <= low and high <= Fraction(found[1]), (function, arguments, rung)
        assert Fraction(found[1]) - Fraction(found[0]) <= (high - low) * Fraction(1001, 1000) + Fraction(1, 10**9)


@pytest.mark.parametrize("degrees", [0.5, 32.0, 45.3, 90.0, 120.7, 179.0])
def test_tangent_of_half_an_angle(degrees: float) -> None:
    numbers = Decimals()
    with numbers.context():
        truth = numbers.tangent(Decimal(repr(degrees)))
    _check("tan_half", [degrees], truth, 40)


@pytest.mark.parametrize(
    "name", ["figure1", "whitted", "tiles", "nested", "quadrics", "lens", "underwater", "room", "pawns"]
)
@pytest.mark.parametrize("changes", [{}, {"pixel": "center", "specular": "blinn"}], ids=["usual", "other"])
def test_pixels_are_those_of_a_tracer_without_rounding(name: str, changes: dict[str, str]) -> None:
    scene = load_scene(SCENES / f"{name}.in")
    settings = replace(Settings(width=40, height=30, max_depth=4), **changes)
    certificate = certify(scene, settings)
    tracer = ExactTracer(scene, settings)
    rng = random.Random(name)
    judged = 0
    for _ in range(12):
        x, y = rng.randrange(40), rng.randrange(30)
        try:
            color = tracer.pixel(x, y).color
        except Undecided:
            continue
        if certificate.certified[y, x]:
            judged += 1
            for k in range(3):
                level = 255 * min(max(color[k], 0.0), 1.0) + 0.5 + 1e-4
                assert int(certificate.low[y, x, k]) - 1e-5 <= level <= int(certificate.high[y, x, k]) + 1 + 1e-5
    assert judged > 8


@pytest.mark.parametrize("name", sorted(file.stem for file in SCENES.glob("*.in") if file.stem != "dice"))
def test_native_gets_no_certified_pixel_wrong(name: str) -> None:
    scene, settings = load_scene(SCENES / f"{name}.in"), Settings(width=24, height=18)
    certificate = certify(scene, settings)
    found = levels(NativeRenderer().render(scene, settings))
    assert not certificate.misses(found).any()
    assert certificate.certified.mean() > 0.99
    assert (certificate.misses(found ^ 1) > 0).mean() > 0.95  # a level beside is noticed


def test_what_numbers_of_some_digits_do_not_determine() -> None:
    scene, settings = load_scene(SCENES / "whitted.in"), Settings(width=40, height=30)
    known, little = certify(scene, settings, 1), certify(scene, settings, 2.0**40)
    assert known.certified.mean() > 0.9
    assert little.certified.sum() < known.certified.sum()


def test_a_sampled_scene_is_refused() -> None:
    with pytest.raises(EffectUnavailable, match="does not draw"):
        certify(load_scene(next((SCENES / "sampled").glob("*.in"))), Settings(width=4, height=3))


def test_colours_that_are_no_levels_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.exr"
    write_image(file, np.full((2, 2, 3), 0.3001234, np.float32), 2, 2)
    scene = load_scene(SCENES / "figure1.in")
    textured = replace(scene, pigments=tuple(Texmap(file, (1, 0, 0, 0), (0, 1, 0, 0)) for _ in scene.pigments))
    with pytest.raises(TextureError, match=r"a\.exr: its colours are no whole numbers of levels"):
        certify(textured, Settings(width=4, height=3))


@pytest.mark.parametrize("name", ["figure1", "tiles"])
def test_several_rays_a_pixel(name: str) -> None:
    """They are those of a finer picture through the centres of its pixels."""
    scene = load_scene(SCENES / f"{name}.in")
    several = certify(scene, Settings(width=16, height=12, samples=4, pixel="center"))
    fine = certify(scene, Settings(width=32, height=24, pixel="center"))
    mean = fine.colors.reshape(12, 2, 16, 2, 3).mean(axis=(1, 3))
    known = several.certified & np.isfinite(mean).all(axis=2)
    assert known.mean() > 0.9
    assert np.abs(several.colors - mean)[known].max() < 1e-9


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, png, out = str(SCENES / "figure1.in"), tmp_path / "c.png", tmp_path / "c.json"
    arguments = ["certify", scene, "40", "30", "--method", "native", "-q", "--png", str(png), "--json", str(out)]
    assert main(arguments) == 0
    assert "certified: 1200 of 1200 pixels" in capsys.readouterr().out
    figures = json.loads(out.read_text())
    assert figures["certified"] == 1200 and figures["methods"]["native"]["wrong"] == 0
    assert png.stat().st_size > 0
    assert main(["certify", scene, "40", "30", "--method", "native:max_depth=0", "-q"]) == 1
    assert "are wrong" in capsys.readouterr().out


def test_what_no_number_of_digits_decides() -> None:
    """A light at a distance for which nothing tells what is 0 leaves all ties open, and nothing else."""
    _, make, settings = TIE_SCENES["tiles of 0.3"]
    scene = make()
    far = Light((0.0, 2e16, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    known, unknown = certify(scene, settings), certify(replace(scene, lights=(*scene.lights, far)), settings)
    assert known.certified.all()
    assert unknown.counts() == {"degenerate": known.tied.sum()}
    assert (known.low == unknown.low)[~known.tied].all()
    assert np.isnan(unknown.colors).all(axis=2).sum() == known.tied.sum()
