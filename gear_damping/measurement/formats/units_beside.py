"""Units that texts beside arrays say: `Unit` beside `Data` in a structure (dSPACE), `x_unit` beside `x`."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping

from gear_damping.measurement.formats.bracket_words import is_known
from gear_damping.measurement.formats.unit_words import as_ours

_PLACE = re.compile(r"^(?P<above>.+)\.(?P<field>\w+?)(?P<element>\[\d+\])?$")  # of a field, of an element of an array
_SAID = ("unit", "units", "einheit")
_OF_SIMCENTER = "{above}.quantity.label{element}"  # beside `values`


def units_beside(vectors: Iterable[str], texts: Mapping[str, str]) -> dict[str, str]:
    """The units of arrays by their names.

    That of a structure is its vector's where it has no other one.

    Args:
        vectors: The names of all arrays of more than one number.
        texts: The single texts of the file by their names.
    """
    vectors, said = list(vectors), {name.lower(): text.strip() for name, text in texts.items()}
    places = {name: found for name in vectors if (found := _PLACE.match(name))}
    held = Counter((found["above"], found["element"]) for found in places.values())
    units = {}
    for name in vectors:
        names = [f"{name}_{word}" for word in _SAID]
        place = places.get(name)
        if place and held[place["above"], place["element"]] == 1:
            element = place["element"] or ""
            names += [f"{place['above']}.{word}{element}" for word in _SAID]
            names += [_OF_SIMCENTER.format(above=place["above"], element=element)] * (place["field"] == "values")
        units[name] = next((text for one in names if (text := said.get(one.lower())) and is_known(as_ours(text))), "")
    return {name: unit for name, unit in units.items() if unit}
