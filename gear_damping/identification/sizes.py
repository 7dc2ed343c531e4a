"""How large a network may be: a file that somebody shared states sizes, which are looked at before memory is taken."""

from collections.abc import Mapping

from torch import Tensor

MOST_CELLS = 2**28  # numbers of single precision, 1 GiB: what one window, or one bank of wavelets, may take


def refuse_cells(count: int, what: str) -> None:
    """Raise ValueError where something would take more numbers than there may be.

    Args:
        count: Numbers of single precision.
        what: What takes them.
    """
    if not 0 < count <= MOST_CELLS:
        rule = f"{what} would take {count * 4 / 2**30:.3g} GiB, and {MOST_CELLS * 4 / 2**30:g} are allowed"
        raise ValueError(f"{rule}: make it smaller")


def refuse_window(window: object, n_features: int) -> None:
    """Raise ValueError where a window is no count of samples, or its features take more memory than there may be."""
    if type(window) is not int or window < 1:
        raise ValueError(f"window must be a whole number of samples, got {window!r}")
    refuse_cells(window * n_features, f"a window of {window} samples with {n_features} features")


def refuse_other_shapes(stated: Mapping[str, Tensor], held: Mapping[str, Tensor]) -> None:
    """Raise ValueError where tensors differ in name or shape, the ones that are described from the ones in the file.

    Args:
        stated: Tensors that take no memory (of the device `meta`).
        held: Those of the file.
    """
    for name in sorted(stated.keys() | held.keys()):
        one, other = (tuple(side[name].shape) if name in side else None for side in (stated, held))
        if one != other:
            raise ValueError(f"{name} is described as {one or 'absent'}, and is {other or 'absent'} among the weights")
