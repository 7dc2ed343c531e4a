"""What the file states of a rig beside what its records say: a unit or a gain that is wrong shows there."""

from collections.abc import Mapping, Sequence

from gear_damping.identification.output_error.records import FreeParameter

CONTRADICTS = 5.0  # stated standard deviations: of one in two million statements that hold
FAR = 3.0  # times: a drawing's stiffness or a data sheet's gain is nearer; a wrong unit is 2 pi, 10 or 1000 times off


def far_from_stated(found: Mapping[str, tuple[float, float]], check: str) -> str | None:
    """A sentence where a figure is far from the stated one, or of the other sign; None where none is.

    Args:
        found: Fitted and stated value by the key of the file.
        check: What in the file makes such a figure.
    """
    far = {name: pair for name, pair in found.items() if pair[1] and not 1 / FAR < pair[0] / pair[1] < FAR}
    if not far:
        return None
    listed = [f"{name} comes out at {one:.4g}, and the file states {stated:.4g}" for name, (one, stated) in far.items()]
    return f"{' and '.join(listed)}: check {check}"


def contradicted(free: Sequence[FreeParameter], coordinates: Sequence[float], stated: Mapping[str, str]) -> str | None:
    """A sentence of what is stated with an uncertainty that the records contradict; None where nothing is.

    Args:
        free: What was fitted.
        coordinates: What it came to.
        stated: Key of the file by flat name.
    """
    away = {}
    for parameter, coordinate in zip(free, coordinates, strict=True):
        expected, slope = parameter.surprise
        size = abs(expected + slope * coordinate)
        if parameter.name in stated and size > CONTRADICTS:
            away[stated[parameter.name]] = size
    if not away:
        return None
    said = " and ".join(f"{name} lies {size:.3g} of its stated uncertainties away" for name, size in away.items())
    return f"{said}: correct its value or its uncertainty, which draws the other figures to it"
