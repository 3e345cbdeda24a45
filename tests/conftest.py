"""Shared by all tests: Mitsuba, started once, the command line, and small scenes."""

import signal

import hypothesis
import pytest
import variant
from command_scenes import SCENE

from converter.commands import main
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell has it so in what runs in the background, where tests of Ctrl-C would wait for ever.
    signal.signal(signal.SIGINT, signal.default_int_handler)


# The same examples each time, and as much time as a busy machine takes: `make fuzz` is what looks for new ones.
hypothesis.settings.register_profile(
    "same", derandomize=True, deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("same")


def pytest_addoption(parser):
    choices = ("llvm_ad_rgb", "cuda_ad_rgb")
    parser.addoption("--variant", choices=choices, default=variant.VARIANT, help="what Mitsuba runs on")


def pytest_configure(config):
    """Choose the variant before the test modules are imported, or say why it cannot be had."""
    import mitsuba_plugins

    variant.VARIANT = config.getoption("variant")
    if variant.VARIANT != "llvm_ad_rgb":
        try:
            mitsuba_plugins.set_variant(variant.VARIANT)
        except mitsuba_plugins.BackendError as error:
            raise pytest.UsageError(str(error)) from error


def pytest_report_header(config):
    return f"Mitsuba's variant: {variant.VARIANT}"


@pytest.fixture(scope="session")
def mi():
    """Mitsuba in the variant of the tests with our plugins."""
    import mitsuba_plugins

    mitsuba_plugins.set_variant(variant.VARIANT)
    import mitsuba

    return mitsuba


@pytest.fixture
def whitted(capsys):
    """Runs `whitted` with words, and returns its exit status, stdout and stderr."""

    def run(*words):
        status = main.main(list(map(str, words)))
        return status, *capsys.readouterr()

    return run


@pytest.fixture
def scene(tmp_path):
    """The file of a scene with three balls."""
    file = tmp_path / "small.in"
    file.write_text(SCENE)
    return file


@pytest.fixture
def small_scene() -> Scene:
    """A mirror ball, a glass ball and a matte block on a checkered floor under two lights."""
    return Scene(
        camera=Camera((0.0, 3.0, -9.0), (0.0, 0.9, 0.0), (0.0, 1.0, 0.0), 35.0),
        ambient=(0.7, 0.8, 1.0),
        lights=(
            Light((4.0, 8.0, -6.0), (0.8, 0.8, 0.7), (1.0, 0.0, 0.0)),
            Light((-6.0, 5.0, -3.0), (0.5, 0.4, 0.4), (0.5, 0.05, 0.003)),
        ),
        pigments=(
            Checker((0.2, 0.3, 0.6), (0.9, 0.9, 0.8), 0.7),
            Solid((0.9, 0.3, 0.2)),
            Solid((1.0, 1.0, 1.0)),
        ),
        finishes=(
            Finish(0.3, 0.6, 0.0, 1.0, 0.1, 0.0, 0.0),
            Finish(0.2, 0.6, 0.4, 60.0, 0.0, 0.0, 0.0),
            Finish(0.05, 0.05, 0.5, 400.0, 0.8, 0.0, 0.0),
            Finish(0.0, 0.05, 0.4, 200.0, 0.15, 0.8, 1.5),
        ),
        objects=(
            Object(0, 0, Polyhedron(((0.0, 1.0, 0.0, 0.01),))),
            Object(2, 2, Sphere((-1.6, 1.1, 0.6), 1.1)),
            Object(2, 3, Sphere((0.9, 0.9, -0.9), 0.85)),
            Object(
                1,
                1,
                Polyhedron(
                    (
                        (1.0, 0.0, 0.3, -2.9),
                        (-1.0, 0.0, -0.3, 1.6),
                        (0.0, 1.0, 0.0, -1.4),
                        (0.0, -2.0, 0.0, 0.04),
                        (-0.3, 0.0, 1.0, -2.0),
                        (0.3, 0.0, -1.0, 0.7),
                    )
                ),
            ),
        ),
    )
