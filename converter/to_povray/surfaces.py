"""Objects, whose shapes `converter.shapes` writes."""

from converter.to_povray.interiors import Interior
from converter.to_povray.text import number


def object_(name: str, shape: str, texture: str, interior: Interior | None, shadows: bool) -> str:
    """A whole object.

    In our format a transparent body throws a shadow as every other does. In POV-Ray light passes through it: it gets no
    shadow, and a twin that nothing but shadow rays can see.

    Args:
        name: what to call its shape.
        shape: its shape's block.
        texture: name of its texture.
        interior: of a transparent body.
        shadows: whether it matters what shadow it throws.

    """
    if interior is None:
        return f"{_open(shape)}\n  texture {{ {texture} }}\n}}\n"
    inverse = " inverse" if interior.inverse else ""
    body = f"object {{ {name} texture {{ {texture} }} interior {{ ior {number(interior.ior)} }} no_shadow{inverse} }}\n"
    twin = f"object {{ {name} no_image no_reflection }}\n" if shadows else ""
    return f"#declare {name} = {shape}\n{body}{twin}"


def _open(shape: str) -> str:
    """A block without its end."""
    return shape[: shape.rindex("}")].rstrip()
