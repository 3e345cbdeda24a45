"""A scene with a matte, a mirror-like and a glass ball, as a file that the programs read, and gray pictures."""

from array import array

from converter.renderers.base import Rendering

SCENE = """\
0 0 -10
0 0 0
0 1 0
40
2
0 0 0 1 1 1 1 0 0
5 5 -9 .8 .8 .8 1 0 0
3
solid 1 .5 .2
checker .1 .2 .3 .9 .8 .7 1
solid 0 0 1
3
.2 .6 .3 20 .2 0 0
.3 .5 0 1 0 0 0
.1 .1 .3 100 .1 .8 1.5
3
0 0 sphere 0 0 0 1
0 2 sphere 1.5 0 -2 .7
1 1 sphere 0 -101.5 0 100
"""


def rendering_of(width, height, value=0.5):
    pixels = memoryview(array("f", [value] * (3 * width * height))).cast("B").cast("f", (height, width, 3))
    return Rendering(pixels, width, height, {"render": 0.0})
