"""A number or a switch that a part of one's own choosing is built by."""

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True)
class Setting:
    """A key of a part: of an estimator under `model`, of a wavelet under `wavelet`.

    Args:
        name: The key.
        default: Its value where none is given; its type is that of the key: a number, a whole number, a switch.
        meaning: For the reader.
        lower: Smallest value.
        upper: Largest value.
    """

    name: str
    default: float | int | bool
    meaning: str
    lower: float = -inf
    upper: float = inf

    @property
    def kind(self) -> str:
        """`bool`, `int` or `float`."""
        return type(self.default).__name__

    def problem(self, value: float | int | bool) -> str:
        """What is wrong with a value; "" where nothing is."""
        is_number = isinstance(value, (int, float)) and (self.kind == "bool" or not isinstance(value, bool))
        if not is_number or (self.kind == "int" and value != round(value)):
            wanted = {"int": "a whole number", "float": "a number", "bool": "true or false"}[self.kind]
            return f"{self.name} must be {wanted}, got {value!r}"
        if self.lower <= value <= self.upper:
            return ""
        return f"{self.name} must lie within {self.lower:g} and {self.upper:g}, got {value!r}"
