"""The compiled tracer. Its public faces are `native_tracer` and its modules `halfspaces`, `bvh`, `incidence` and
`sampler`.
"""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any, Literal, TypedDict, overload

from typing_extensions import Buffer

_Triple = Sequence[float]
_Quadruple = Sequence[float]
_Leaf = (
    tuple[Literal["sphere"], _Quadruple]
    | tuple[Literal["polyhedron"], Sequence[_Quadruple]]
    | tuple[Literal["quadric"], Sequence[float]]
)

class _Statistics(TypedDict):
    primary: int
    reflected: int
    transmitted: int
    shadow: int
    deepest: int
    threads: int
    search: Literal["brute", "bvh"]

class Scene:
    """A scene to be built, element by element; indices count from 0."""

    def __init__(self) -> None: ...
    def set_camera(
        self, eye: _Triple, look_at: _Triple, up: _Triple, fovy: float, aperture: float = 0.0, focal: float = 1.0
    ) -> None:
        """The camera; `up` is a vector, `fovy` the full vertical angle in degrees, `aperture` the lens's radius, and
        what lies at distance `focal` along the view direction is in focus.
        """

    def set_ambient(self, color: _Triple) -> None:
        """The ambient light's colour."""

    def set_background(self, color: _Triple) -> None:
        """The colour of rays that hit nothing."""

    def add_light(self, position: _Triple, color: _Triple, attenuation: _Triple, radius: float = 0.0) -> int:
        """Add a light, a point or a disc that faces the point being lit, and return its index."""

    def add_solid(self, color: _Triple) -> int:
        """Add a pigment of one colour, and return its index."""

    def add_checker(self, first: _Triple, second: _Triple, size: float) -> int:
        """Add a checkerboard pigment, and return its index."""

    def add_texmap(self, width: int, height: int, texels: Buffer, p0: _Quadruple, p1: _Quadruple) -> int:
        """Add an image pigment, and return its index; `texels` is a buffer of height x width x 3 float32."""

    def add_finish(
        self,
        ka: float,
        kd: float,
        ks: float,
        alpha: float,
        kr: float,
        kt: float,
        eta: float,
        cone: float = 0.0,
    ) -> int:
        """Add a finish, and return its index; `eta` is n1/n2, outside over inside, `cone` the half-angle, in degrees,
        of the cone in which mirrored and transmitted rays are spread.
        """

    def add_sphere(self, pigment: int, finish: int, center: _Triple, radius: float) -> int:
        """Add a sphere, and return its index."""

    @overload
    def add_polyhedron(self, pigment: int, finish: int, planes: Sequence[_Quadruple]) -> int:
        """Add a convex polyhedron, and return its index.

        A plane is (a, b, c, d), inside where a x + b y + c z + d <= 0. `planes` may be a buffer of float64 too.
        """

    @overload
    def add_polyhedron(self, pigment: int, finish: int, planes: Buffer) -> int: ...
    def add_quadric(self, pigment: int, finish: int, coefficients: Sequence[float]) -> int:
        """Add a quadric, and return its index.

        The coefficients are A to J, inside where
        A x^2 + B y^2 + C z^2 + D x y + E x z + F y z + G x + H y + I z + J <= 0.
        """

    def add_csg(self, pigment: int, finish: int, leaves: Sequence[_Leaf], program: Sequence[int]) -> int:
        """Add constructive solid geometry, and return its index.

        The program is a Boolean expression in postfix order: k >= 0 pushes leaf k, -1 unites the last two, -2 subtracts
        them, -3 intersects them. There are 64 leaves at most.
        """

    def move_object(self, index: int, displacement: _Triple) -> None:
        """Let an object, its pigment too, move by a displacement while the picture is taken."""

    def box_of(self, index: int) -> tuple[_Triple, _Triple] | None:
        """The low and the high corner of the box around an object, or None if it is not known to have bounds."""

class Image:
    """A picture to be drawn into: linear RGB, row 0 on top, black at first."""

    def __init__(self, width: int, height: int) -> None: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def pixels(self) -> memoryview[float]:
        """A memoryview of height x width x 3 float32, not a copy."""

    @property
    def statistics(self) -> _Statistics:
        """Rays of the last rendering by kind, its deepest bounce, its threads, and how it searched."""

class PassSums:
    """Sums of the samples of whole passes over a picture: what drawing may go on from."""

    passes: int
    """How many passes are in the sums."""
    counts: dict[str, int]
    """Rays of the passes by kind, and their deepest bounce."""

    def __init__(self, width: int, height: int) -> None: ...
    @property
    def colors(self) -> memoryview[float]:
        """A memoryview of height x width x 3 float64, not a copy; a new one after each rendering."""

    @property
    def too_deep(self) -> memoryview[int]:
        """A memoryview of height x width bytes: 1 where the depth limit dropped a ray."""

def render(
    scene: Scene,
    image: Image,
    *,
    cutoff: float,
    max_depth: int,
    samples: int = 1,
    seed: int = 0,
    independent: bool = False,
    corner: bool = True,
    blinn: bool = False,
    precision: Literal["float", "double", "long double"] = "double",
    search: Literal["auto", "brute", "bvh"] = "auto",
    threads: int = 0,
    progress: Callable[[float], object] | None = None,
    instructions: Literal["", "baseline", "avx2", "avx512"] = "",
    passes: Sequence[Sequence[int]] = (),
    sums: PassSums | None = None,
    mask: Buffer | None = None,
    signatures: Buffer | None = None,
    least_weight: float = 0.0,
    picture: tuple[int, int] | None = None,
    first: tuple[int, int] = (0, 0),
) -> None:
    """Draw `scene` into `image`.

    Objects are searched one by one ("brute") or by a tree over their boxes ("bvh"), by default whichever is faster for
    so many; the picture's bytes are the same, and the image's statistics say which it was.
    `progress` is called about 20 times a second with the finished share; what it raises, and Ctrl-C, stop the
    rendering, and what is finished stays in the image. `instructions` forces an instruction set, "" takes the best.
    With `sums`, of the image's size, it is drawn in `passes`, which name each sample once at most, see
    `native_tracer.passes`: those that are in the sums are not drawn again, and those that become whole are added.
    With a `mask` of bytes, too, height x width, only the pixels are drawn that are not 0 there. `signatures`, of height
    x width uint32, get a word each for what is decided along the pixel's rays that weigh at least `least_weight`.
    The image may be a part of a `picture` of that width and height, from the pixel `first`, its column and row, on.
    """

def trace_pixel(
    scene: Scene,
    width: int,
    height: int,
    x: int,
    y: int,
    *,
    cutoff: float,
    max_depth: int,
    samples: int = 1,
    seed: int = 0,
    independent: bool = False,
    corner: bool = True,
    blinn: bool = False,
    precision: Literal["float", "double", "long double"] = "double",
    search: Literal["auto", "brute", "bvh"] = "auto",
) -> dict[str, Any]:
    """The rays of one pixel as nested dictionaries; `converter.renderers.native` describes them.

    Raises:
        ValueError: there are more than 2^20 of them.

    """

def count_nan_pixels(pixels: Buffer) -> int:
    """How many pixels of a float32 buffer, three numbers each, have a NaN among them."""

def keep_reserve() -> None:
    """Keep some memory for the time when there is no more."""

def quantize(pixels: Buffer) -> bytes:
    """8-bit RGB of a float32 buffer: the nearest of 255 levels to c, halves up, c clamped to 0..1, a NaN black."""

def scan_scene(text: bytes, model: ModuleType) -> tuple[Any, ...] | None:
    """Read a scene file, if it holds nothing unusual; None where a closer look is needed, be it wrong or not.

    `model` has the classes of what is read, the module `converter.scene.model`.

    Gives the camera, lights, pigments, finishes, objects, and the lines of lights, pigments and finishes. For a texmap
    there is (name, p0, p1, line of the name).
    """

def threaded_bvh(low: Buffer, high: Buffer) -> tuple[memoryview[float], memoryview[int], memoryview[int]]:
    """The arrays of a threaded tree over boxes; see `native_tracer.bvh`."""

def surfaces_at(point: _Triple, rows: Buffer, round: Buffer) -> list[int]:
    """Which surfaces a point lies on; see `native_tracer.incidence`."""

def within(point: _Triple, planes: Buffer) -> bool:
    """Whether a point lies in a body or on its surface; see `native_tracer.incidence`."""

def sample_points(
    seed: int, column: Buffer, row: Buffer, k: Buffer, path: Buffer, use: Buffer, independent: bool = False
) -> memoryview[int]:
    """The points of samples; see `native_tracer.sampler`."""

def disc_points(points: Buffer) -> memoryview[float]:
    """Points of the unit disc; see `native_tracer.sampler`."""

def cone_directions(axes: Buffer, versines: Buffer, points: Buffer) -> memoryview[float]:
    """Directions in cones; see `native_tracer.sampler`."""

def halfspace_bodies(coefficients: Buffer, offsets: Buffer) -> list[tuple[Any, ...]]:
    """What is known of each intersection of half-spaces; see `native_tracer.halfspaces`."""

def halfspace_faces(coefficients: Buffer) -> list[tuple[list[int], list[float], float]]:
    """The face polygons of one bounded intersection; see `native_tracer.halfspaces`."""

def halfspace_polygons(coefficients: Buffer, far: float, leaf_size: int) -> list[tuple[list[int], list[float], float]]:
    """The face polygons of any intersection as far as `far`; a `leaf_size` not below the number of planes has all of
    them tried, and none searched for.
    """
