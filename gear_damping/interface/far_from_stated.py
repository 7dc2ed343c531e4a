"""What the file states of a rig beside what its records say: a unit or a gain that is wrong shows there."""

from collections.abc import Mapping

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
