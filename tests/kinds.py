"""An entry for each keyword of pigments and shapes, and a scene around it."""

PIGMENTS = {
    "solid": "solid .9 .4 .2",
    "checker": "checker .9 .8 .7  .1 .2 .6  .35",
    "texmap": "texmap image.ppm  .3 .1 0 .2  0 .4 .1 .5",
    "textmap": "textmap image.ppm  .3 .1 0 .2  0 .4 .1 .5",
}
"""By its keyword: an entry that a body of size 1 at the origin shows to be what it is."""

SHAPES = {
    "sphere": "sphere 0 0 0 1",
    "polyhedron": "polyhedron 7  1 0 0 -1  -1 0 0 -1  0 1 .1 -.9  0 -1 0 -.9  0 0 1 -1  0 0 -2 -2  1 1 1 -9",
    "plane": "plane .1 1 .2 .3",
    "quadric": "quadric 1 1.5 2 .3 -.2 .1 .2 0 -.1 -1",
    "csg": "csg 3 + 0 0 sphere 0 0 0 1 - 1 2 csg 2 + 0 0 sphere .4 .5 -.6 .7 & 0 1 polyhedron 1 1 .2 0 -.5"
    " - 0 0 quadric 1 1 0 0 0 0 0 .2 0 -.1",
}
"""By its keyword: a body about the origin, about 1 in size unless it has no bounds."""

IMAGE = b"P6\n4 2\n255\n" + bytes(range(60, 180, 5))
"""`image.ppm`"""

_SCENE = """\
.5 2 -6   0 0 0   0 1 0   35
2   0 0 0 .6 .7 .8 1 0 0   4 6 -5 .8 .8 .7 1 0 0
2   {pigment}   solid .8 .8 .9
3   .3 .6 .3 20 0 0 0   .2 .5 0 1 .4 0 0   .1 .1 .3 60 .2 .7 1.4
4
0 0 {shape}
0 1 polyhedron 1 0 1 0 1.5
1 2 sphere 1.2 .4 -2 .6
0 2 {shape}
"""


def scene_of(pigment: str = PIGMENTS["checker"], shape: str = SHAPES["sphere"]) -> str:
    """A body on a mirror, behind glass, and the same body as glass; it and the mirror have the pigment."""
    return _SCENE.format(pigment=pigment, shape=shape)
