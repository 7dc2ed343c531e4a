"""Reading measurement.yaml: plain YAML in which 1e-6 is a number and a key may appear once."""

import re
from pathlib import Path

import yaml

from gear_damping.errors import InputError, Problem

_FLOAT = re.compile(
    r"""^(?:[-+]?(?:[0-9][0-9_]*)\.[0-9_]*(?:[eE][-+]?[0-9]+)?
        |[-+]?(?:[0-9][0-9_]*)(?:[eE][-+]?[0-9]+)
        |[-+]?\.[0-9][0-9_]*(?:[eE][-+]?[0-9]+)?
        |[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$""",
    re.VERBOSE,
)


class _Loader(yaml.SafeLoader):
    """YAML 1.1 wants 1.0e-6 and takes 1e-6 for text; people write 1e-6."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        """Refuse a key that appears twice, where YAML would silently keep the last."""
        seen = set()
        for key_node, _ in node.value:
            where = key_node.start_mark
            if not isinstance(key_node, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a key is a name, not a list or a mapping", where)
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"the key '{key_node.value}' appears twice", where)
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


def read_yaml(path: Path) -> object:
    """The content of a YAML file.

    Raises:
        InputError: no such file, not text, not YAML, or a key appears twice.
    """
    if not path.is_file():
        remedy = "give the path of a measurement.yaml"
        raise InputError(Problem("measurement.path", "no such file", str(path), remedy))
    try:
        return yaml.load(path.read_text(encoding="utf-8-sig"), Loader=_Loader)
    except UnicodeDecodeError as error:
        raise InputError(
            Problem("measurement.path", "not UTF-8 text", str(path), f"save it as UTF-8 ({error.reason})")
        ) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = getattr(error, "problem", None) or str(error)
        remedy = "mind indentation, and quote texts that hold ':' or '#'"
        raise InputError(Problem(str(path), f"not valid YAML{where}: {reason}", remedy=remedy)) from None
