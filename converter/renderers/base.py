"""The interface between a renderer and everything that uses one."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeGuard

from converter.frozen import dataclass, field
from converter.scene.effects import Effect
from converter.scene.model import Scene
from converter.scene.needs import SceneNeeds
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Buffer  # type: ignore[attr-defined]  # Python 3.12; a memoryview or a NumPy array here

    from converter.renderers.records import PixelRecord

Progress = Callable[[float], None]
"""Called now and then, from the calling thread, with the finished share of the picture (0..1)."""


@dataclass(frozen=True, slots=True)
class Passes:
    """The samples of a picture that are drawn, in whole passes over it: what drawing may go on from.

    Attributes:
        done: how many passes are whole. total: how many there are.
        colors: (height, width, 3) float64 buffer, the sums of the samples' colours, linear RGB.
        too_deep: (height, width) buffer of bytes, 1 where the depth limit has dropped a ray.
        notes: what else a renderer remembers, such as counters, as JSON has it.

    """

    done: int
    total: int
    colors: "Buffer"
    too_deep: "Buffer"
    notes: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Rendering:
    """A finished picture.

    Attributes:
        pixels: (height, width, 3) float32 buffer, linear RGB, row 0 on top, not clamped; `numpy.asarray` makes it an
        array. seconds: wall-clock seconds by stage, e.g. {"build": 0.01, "render": 0.04}, in the order they ran.
        statistics: the renderer's own counters, e.g. {"rays": 1862000, "threads": 2}.
        passes: those that are whole, of a picture that is drawn in passes.

    """

    pixels: "Buffer"
    width: int
    height: int
    seconds: Mapping[str, float]
    statistics: Mapping[str, Any] = field(default_factory=dict)
    passes: Passes | None = None


class Interrupted(KeyboardInterrupt):
    """The user stopped a rendering; `partial` holds it, black where nothing is drawn."""

    def __init__(self, partial: Rendering) -> None:
        super().__init__("interrupted")
        self.partial = partial


class RendererUnavailable(Exception):  # noqa: N818 - what it says
    """A renderer cannot run on this machine; the message says what is missing and what to install."""


class ResumeError(Exception):
    """Drawing cannot go on from what was drawn; the message says why."""


class EffectUnavailable(RendererUnavailable):
    """A renderer cannot draw an effect that a scene has; the message says which, and what has it."""


def refuse_effects(needs: SceneNeeds, renderer: str, drawn: Collection[Effect] = (), others: str = "") -> None:
    """See that a scene has no effects but those `drawn`; `renderer` is its name in a sentence, `others` says which do.

    Raises:
        EffectUnavailable: it has.

    """
    for effect, cause in needs.effects.items():
        if effect not in drawn:
            message = f"{cause}, and {renderer} does not draw {effect}"
            raise EffectUnavailable(f"{message}: {others}" if others else message)


class Renderer(Protocol):
    """Draws scenes."""

    def render(self, scene: Scene, settings: Settings, progress: Progress | None = None) -> Rendering:
        """Draw `scene`.

        Raises:
            RendererUnavailable: it cannot run here, or not draw an effect that the scene has.
            Interrupted: Ctrl-C while it was drawing.

        """
        ...


class PassRenderer(Renderer, Protocol):
    """A renderer that draws long pictures in passes."""

    in_passes: ClassVar[bool]

    def render(
        self, scene: Scene, settings: Settings, progress: Progress | None = None, start: Passes | None = None
    ) -> Rendering:
        """Draw `scene`, and go on from the passes `start`, if given: the picture is the same.

        Raises:
            ResumeError: the renderer does not go on from these.

        """
        ...


def draws_in_passes(renderer: Renderer) -> TypeGuard[PassRenderer]:
    """Whether a renderer draws in passes."""
    return getattr(renderer, "in_passes", False)


class Refinement(Protocol):
    """Says which pixels of one picture need more samples. Arrays are NumPy's, and masks (height, width) bool.

    Attributes:
        least_weight: of the rays whose decisions are in signatures.

    """

    least_weight: float

    def halves(self, signatures: Any, colors: Any) -> Any:
        """In a scene in which nothing is random, how many halves of a pass each pixel needs, when each has one sample.

        Args:
            signatures: (height, width) uint32, a word for what is decided along the rays of each pixel that weigh at
                least `least_weight`.
            colors: (height, width, 3) float32, linear RGB.

        Returns:
            (height, width), 0 to 2.

        """
        ...

    def unsure(self, sums: Any, size: int, drawn: Any) -> Any:
        """In a scene that is sampled, the pixels that need another pass.

        Args:
            sums: (height, width, 3) float64, of the colours of all samples.
            size: samples in the last pass.
            drawn: mask of the pixels that had it.

        """
        ...


class AdaptiveRenderer(Renderer, Protocol):
    """A renderer that draws some pixels with more samples than others."""

    def unfit_to_adapt(self) -> str | None:
        """Why it cannot, as it is set; None if it can."""
        ...

    def render_adaptively(
        self, scene: Scene, settings: Settings, refinement: Refinement, progress: Progress | None = None
    ) -> Rendering:
        """Draw `scene` with few samples a pixel, and with more, up to as many as `settings` tell, where `refinement`
        asks for them.

        Raises:
            Interrupted: Ctrl-C while it was drawing.

        """
        ...


def draws_adaptively(renderer: Renderer) -> TypeGuard[AdaptiveRenderer]:
    """Whether a renderer may draw some pixels with more samples than others."""
    return hasattr(renderer, "render_adaptively")


def share_of_first(samples: int) -> float:
    """What share of the time one sample a pixel takes, about, where a tenth of the pixels is refined then."""
    return 1 / (1 + samples / 10)


def part_of(progress: Progress | None, begin: float, end: float) -> Progress | None:
    """A `Progress` for the part of a picture from one share to another."""
    return None if progress is None else lambda share: progress(begin + (end - begin) * share)


class RayTeller(Renderer, Protocol):
    """A renderer that tells its rays."""

    def trace_pixel(self, scene: Scene, settings: Settings, x: int, y: int) -> "PixelRecord":
        """Trace one pixel, column `x` and row `y` from the top left corner.

        Raises:
            RendererUnavailable: it cannot run here.
            ValueError: a texture cannot be read, `settings` make no sense, or there are more than `MOST_RAYS` rays.
            IndexError: the pixel lies outside the picture.

        """
        ...

    def trace_pixels(self, scene: Scene, settings: Settings, pixels: Sequence[tuple[int, int]]) -> "list[PixelRecord]":
        """Trace pixels (column, row); a record for each."""
        ...


def tells_rays(renderer: Renderer) -> TypeGuard[RayTeller]:
    """Whether a renderer tells its rays."""
    return hasattr(renderer, "trace_pixel")
