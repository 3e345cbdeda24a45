"""The exact tracer's csg: what is one shape by the laws of sets is one picture."""

import numpy as np
import pytest
from csgs import BALL, CUBE, CYLINDER, FAR, RIGHT, box, csg, half_space

from converter.scene.model import Checker, Csg, Finish, Light, Object, Operand, Scene
from converter.scene.settings import Settings
from converter.studies.exact.tracer import exact_picture
from converter.studies.families.scenes import camera

SETTINGS = Settings(width=20, height=16, max_depth=3)
GLASS = Finish(0.1, 0.3, 0.4, 30.0, 0.2, 0.6, 1.5)
HALF_SPACES = Csg(tuple(Operand("&" if k else "+", half_space(*plane)) for k, plane in enumerate(CUBE.planes)))


def picture(shape):
    pigment = Checker((0.9, 0.4, 0.2), (0.2, 0.5, 0.8), 0.37)
    scene = Scene(
        camera=camera((2.3, 3.1, 5.7), (0.1, 0.2, 0.1)),
        ambient=(0.4, 0.5, 0.6),
        lights=(Light((4.3, 6.1, 3.9), (0.8, 0.8, 0.7), (1.0, 0.0, 0.0)),),
        pigments=(pigment,),
        finishes=(GLASS,),
        objects=(Object(0, 0, shape), Object(0, 0, half_space(0, 1, 0, 1.3))),
    )
    return exact_picture(scene, SETTINGS)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (BALL, csg("+", BALL)),
        (BALL, csg("+", BALL, "+", BALL)),
        (BALL, csg("+", BALL, "-", FAR)),
        (CUBE, HALF_SPACES),
        (CUBE, csg("+", CUBE, "-", box((1, -1, -1), (2, 1, 1)))),
        (box((-1, -1, -1), (1, 2, 1)), csg("+", CUBE, "+", box((-1, 1, -1), (1, 2, 1)))),
        (CUBE, csg("+", box((-1, -1, -1), (1, 2, 1)), "-", box((-2, 1, -2), (2, 2, 2)))),
        (csg("+", CUBE, "-", csg("+", BALL, "+", CYLINDER)), csg("+", CUBE, "-", BALL, "-", CYLINDER)),
        (csg("+", BALL, "+", RIGHT, "-", RIGHT), csg("+", BALL, "-", RIGHT)),
    ],
)  # fmt: skip
def test_one_shape_is_one_picture(one, other):
    first = picture(one)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 40
    np.testing.assert_allclose(picture(other), first, rtol=0, atol=1e-12)


def test_nothing_is_not_seen():
    np.testing.assert_array_equal(picture(csg("+", BALL, "-", BALL)), picture(csg("+", CUBE, "-", csg("+", CUBE))))
