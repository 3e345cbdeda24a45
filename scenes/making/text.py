"""Scenes and shapes as a file has them."""

from collections.abc import Iterable, Sequence

from making.vectors import Color, Plane, Vector, add, scale


def number(x: float) -> str:
    """A number as short as six digits after the point let it be."""
    text = f"{x:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(values: Iterable[float]) -> str:
    """Numbers with a blank between them."""
    return " ".join(number(x) for x in values)


SKY = "1 0 0 1 0 0 0"
"""A finish that shines by itself, and takes neither light nor shadow."""


class SceneText:
    """A scene that is being written. Pigments and finishes are added before they are used, and known by their index."""

    script = "generate.py"

    def __init__(
        self,
        comment: str,
        eye: Vector,
        look_at: Vector,
        fovy: float,
        ambient: Color = (1, 1, 1),
        up: Vector = (0, 1, 0),
    ) -> None:
        self.comment = comment
        self._camera = f"{numbers(eye)}\n{numbers(look_at)}\n{numbers(up)}\n{number(fovy)}"
        self._lights = [f"0 0 0 {numbers(ambient)} 1 0 0"]
        self._pigments: list[str] = []
        self._finishes: list[str] = []
        self._objects: list[str] = []

    def light(self, position: Vector, color: Color, attenuation: Vector = (1, 0, 0)) -> None:
        """Add a point light."""
        self._lights.append(f"{numbers(position)} {numbers(color)} {numbers(attenuation)}")

    def lamp(self, center: Vector, u: Vector, v: Vector, color: Color, count: int) -> None:
        """Add a panel of count x count lights that spans -u..u and -v..v, so that shadows have soft edges."""
        for i in range(count):
            for j in range(count):
                s, t = (2 * i + 1) / count - 1, (2 * j + 1) / count - 1
                position = add(center, add(scale(u, s), scale(v, t)))
                self.light(position, scale(color, 1 / count**2))

    def pigment(self, text: str) -> int:
        """Add a pigment, written as in the file."""
        self._pigments.append(text)
        return len(self._pigments) - 1

    def solid(self, color: Color) -> int:
        """Add a pigment of one colour."""
        return self.pigment(f"solid {numbers(color)}")

    def finish(self, text: str, note: str = "") -> int:
        """Add a finish, written as in the file."""
        self._finishes.append(f"{text}  # {note}" if note else text)
        return len(self._finishes) - 1

    def sphere(self, pigment: int, finish: int, center: Vector, radius: float) -> None:
        """Add a ball."""
        self._objects.append(f"{pigment} {finish} sphere {numbers((*center, radius))}")

    def polyhedron(self, pigment: int, finish: int, planes: Sequence[Plane]) -> None:
        """Add an intersection of half-spaces."""
        faces = "\n".join(numbers(plane) for plane in planes)
        self._objects.append(f"{pigment} {finish} polyhedron {len(planes)}\n{faces}")

    def body(self, pigment: int, finish: int, text: str) -> None:
        """Add an object, its shape written as in the file."""
        self._objects.append(f"{pigment} {finish} {text}")

    def __str__(self) -> str:
        comment = "\n".join(f"# {line}".rstrip() for line in self.comment.strip().splitlines())
        parts = [f"{comment}\n# Computed by {self.script}.\n{self._camera}"]
        for entries in (self._lights, self._pigments, self._finishes, self._objects):
            parts.append("\n".join([str(len(entries)), *entries]))
        return "\n\n".join(parts) + "\n"


def ball(center: Vector, radius: float) -> str:
    """A ball."""
    return f"sphere {numbers((*center, radius))}"


def half_spaces(planes: Sequence[Plane]) -> str:
    """What half-spaces have in common."""
    return "\n".join([f"polyhedron {len(planes)}", *map(numbers, planes)])


def quadric(coefficients: Sequence[float]) -> str:
    """A surface of second degree, by its ten numbers."""
    return f"quadric {numbers(coefficients)}"


def csg(*operands: str) -> str:
    """Operands, each its sign, a blank, and a shape: `csg("+ sphere 0 0 0 1", "- sphere 1 0 0 1")`."""
    lines = [f"csg {len(operands)}"]
    for operand in operands:
        sign, shape = operand.split(" ", 1)
        first, *others = shape.splitlines()
        lines += [f"  {sign} 0 0 {first}", *(f"    {line}" for line in others)]
    return "\n".join(lines)
