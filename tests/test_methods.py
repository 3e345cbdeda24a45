"""The table of methods, and what is told of them."""

import json
import re

import pytest

from converter.commands import main
from converter.renderers.methods import METHODS, MOST_COMPILED, find_method
from converter.scene.model import Object, Sphere
from converter.scene.settings import Settings

GIVEN = Settings(width=40, height=30, samples=4)


def test_names_are_easy_to_type():
    for name, method in METHODS.items():
        assert name == method.name
        assert name == name.lower()
        assert not set(name) - set("abcdefghijklmnopqrstuvwxyz0123456789.-:=_/")
        assert name.startswith(method.family)
        assert len(f"  {'':22}{method.use}") <= 120


def test_options_and_changes_are_what_the_renderers_and_settings_have():
    for method in METHODS.values():
        assert method.settings(GIVEN).samples == 4
        if method.missing() is None:
            renderer = method.renderer()
            assert all(getattr(renderer, option) == value for option, value in method.options.items())


def test_no_two_methods_are_the_same_but_the_default_cutoff():
    made = [(m.family, tuple(m.options.items()), m.settings(GIVEN)) for m in METHODS.values()]
    assert [
        m.name for m in METHODS.values() if made.count((m.family, tuple(m.options.items()), m.settings(GIVEN))) > 1
    ] == [
        "native",
        "native:cutoff=1/512",
    ]


def test_settings():
    assert find_method("native:max_depth=7").settings(GIVEN) == Settings(40, 30, samples=4, max_depth=7)
    assert METHODS["native:cutoff=0"].settings(GIVEN).cutoff == 0
    assert METHODS["mitsuba:threads=1"].settings(GIVEN).threads == 1


def test_the_variant_is_mitsubas_and_not_where_the_method_has_its_own():
    assert METHODS["mitsuba"].renderer("llvm_ad_rgb").variant == "llvm_ad_rgb"
    assert METHODS["mitsuba"].renderer().variant == "auto"
    assert METHODS["mitsuba-cuda"].renderer("llvm_ad_rgb").variant == "cuda_ad_rgb"
    assert METHODS["native"].renderer("llvm_ad_rgb") == METHODS["native"].renderer()


def test_an_unknown_name():
    assert find_method("native") is METHODS["native"]
    assert find_method("native:max_depth=4") is METHODS["native:max_depth=4"]
    with pytest.raises(ValueError, match=r"^there is no method 'mitsuba-mash' \(did you mean 'mitsuba-mesh'\?\)$"):
        find_method("mitsuba-mash")


def test_what_is_missing(monkeypatch):
    monkeypatch.setattr("mitsuba_plugins.backend.has_cuda", lambda: False)
    assert METHODS["mitsuba-cuda"].missing() == "no CUDA device answers on this machine"
    assert METHODS["mitsuba"].missing() is None
    monkeypatch.setattr("mitsuba_plugins.backend.find_llvm", lambda: None)
    assert "LLVM library" in METHODS["mitsuba"].missing()
    monkeypatch.setattr("mitsuba_plugins.backend.has_cuda", lambda: True)
    assert METHODS["mitsuba"].missing() is METHODS["mitsuba-cuda"].missing() is METHODS["native"].missing() is None


def test_a_method_that_compiles_each_surface_is_not_for_many(small_scene):
    from dataclasses import replace

    analytic = METHODS["mitsuba-analytic"]
    assert analytic.unfit(small_scene) is None
    balls = tuple(Object(0, 0, Sphere((float(i), 0.0, 0.0), 0.4)) for i in range(MOST_COMPILED))
    assert analytic.unfit(replace(small_scene, objects=balls)) is None
    reason = analytic.unfit(replace(small_scene, objects=(*balls, balls[0])))
    assert reason == f"{MOST_COMPILED + 1} spheres and planes would take too long to compile"
    assert METHODS["mitsuba"].unfit(replace(small_scene, objects=(*balls, balls[0]))) is None


def test_povray(monkeypatch):
    """Its renderer is loaded only when it is made."""
    import sys
    from types import ModuleType

    made = object()
    module = ModuleType("converter.renderers.povray")
    module.PovrayRenderer = lambda: made
    monkeypatch.setitem(sys.modules, "converter.renderers.povray", module)
    assert METHODS["povray"].renderer("llvm_ad_rgb") is made
    assert not METHODS["povray"].usual


def test_whitted_methods(capsys):
    assert main.main(["methods"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "the native tracer"
    listed = {line[3:].split()[0]: line for line in lines if line[:3] in ("   ", "-  ")}
    assert list(listed) == list(METHODS)
    for name, line in listed.items():
        missing = METHODS[name].missing()
        assert METHODS[name].use in line
        assert line.startswith("-") == bool(missing)
        assert (missing or "") in line


def test_whitted_methods_as_json(capsys):
    assert main.main(["methods", "--json", "-"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [method["name"] for method in listed] == list(METHODS)
    assert listed[0] == {
        "name": "native",
        "group": "the native tracer",
        "use": METHODS["native"].use,
        "renderer": "native",
        "options": {},
        "settings": {},
        "missing": METHODS["native"].missing(),
    }


def test_a_method_with_other_settings():
    method = find_method("mitsuba-bvh:max_depth=7:cutoff=1/64:threads=2")
    assert method is find_method("mitsuba-bvh:max_depth=7:cutoff=1/64:threads=2")
    assert method.settings(GIVEN) == Settings(40, 30, samples=4, max_depth=7, cutoff=1 / 64, threads=2)
    assert (method.family, method.options) == ("mitsuba", {"intersections": "bvh"})
    assert not method.usual


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("native:depth=1", "native has no setting 'depth': expected max_depth, cutoff, threads, points"),
        ("native:", "native has no setting '': expected max_depth, cutoff, threads, points"),
        ("native:max_depth", "max_depth must be a whole number from 0 to 1000, found ''"),
        ("native:max_depth=-1", "max_depth must be a whole number from 0 to 1000, found '-1'"),
        ("native:threads=0", "threads must be a whole number from 1 to 1024, found '0'"),
        ("native:cutoff=1/0", "cutoff must be a number or a fraction from 0 on, found '1/0'"),
        ("native:points=random", "points must be stratified or independent, found 'random'"),
        ("native:cutoff=nan", "cutoff must be a number or a fraction from 0 on, found 'nan'"),
        ("nativ:cutoff=0", "there is no method 'nativ' (did you mean 'native'?)"),
    ],
)
def test_settings_that_there_are_not(name, told):
    with pytest.raises(ValueError, match=f"^{re.escape(told)}$"):
        find_method(name)
