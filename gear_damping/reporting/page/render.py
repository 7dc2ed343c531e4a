"""From a template and what it shows to one HTML file that fetches nothing."""

import base64
import hashlib
import re
from collections.abc import Callable
from functools import partial
from importlib.resources import files
from itertools import count
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from gear_damping.reporting.page.table import Table

PACKAGE = "gear_damping.reporting.page"


def render_page(package: str, template: str, script: str = "", **content: Any) -> str:
    """The page: pictures, style and script are inside, text of the user is escaped.

    Args:
        package: Whose `templates` hold the template; it extends `base.html`.
        template: Name of its file.
        script: JavaScript of the page; no other runs in it.
        content: What the template shows.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader(PACKAGE)]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"words": words, "names_marked": names_marked, "breakable": breakable}
    environment.globals["Table"] = Table
    style = files(PACKAGE).joinpath("templates", "style.css").read_text(encoding="utf-8")
    given = {"style": style, "script": script, "script_source": _source(script), "new_id": _ids()}
    return environment.get_template(template).render(**given, **content).lstrip()


def words(name: str) -> str:
    """A name in words."""
    return name.replace("_", " ")


def names_marked(text: str) -> Markup:
    """Text with what stands in backticks set as code; everything else is escaped."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def breakable(text: str) -> Markup:
    """A key or the name of a figure, which may be broken after a dot or a slash, but not before its unit."""
    found = re.sub(r"(?<=[A-Za-z])([./])(?=[A-Za-z])", r"\1<wbr>", str(escape(text)))
    return Markup(found.replace(" / ", "&nbsp;/&nbsp;"))


def _source(script: str) -> str:
    """What the page's policy says of scripts: this one, by its digest, or none."""
    if not script:
        return "'none'"
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return f"'sha256-{digest}'"


def _ids() -> Callable[[], str]:
    """Names of elements, each given once a page."""
    return partial(lambda numbers: f"n{next(numbers)}", count(1))
