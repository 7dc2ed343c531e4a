"""What the user typed, before Hydra reads it.

Every plain override `key=value` becomes `++key=value`: an effect that is off has no keys yet, and an
unknown key shall meet our own check, which knows the nearest valid one, and not Hydra's first refusal.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.errors import HydraException

from gear_damping.at_home import at_home
from gear_damping.config.listed import takes_list
from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.many_records import PATH, all_named
from gear_damping.errors import Problem, nearest

SOURCE = "the command line"
LAUNCHER = "hydra/launcher"
NEEDED = {  # what a launcher is made of: its module, and what brings it
    "joblib": ("hydra_plugins.hydra_joblib_launcher", "joblib"),
    "slurm": ("hydra_plugins.hydra_submitit_launcher", "slurm"),
}
PLACES = ("hydra.run.dir", "hydra.sweep.dir")  # where the output of one run lies, and that of a sweep
OF_A_PATH = (PATH, "checkpoint", "resume", "sweep", "data_folder", *PLACES)
NAMES_FILES = (*OF_A_PATH, "simulator.extended", "simulator.plugins", "measurement.plugins", "model.plugins")
_AT_HOME = re.compile(r"(?<=[=,\[])~/")
MOST_PARSED = 1024  # overrides that are kept as they were parsed: more than a command line has
LONGEST_KEY = 200  # letters; a folder of configurations is looked up by them, and file systems end at 255
OFF_BY_NULL = ("experiment",)  # groups that may be left out
SHOWS = ("--cfg", "-c", "--info", "-i", "--resolve", "--version", "--hydra-help", "--shell-completion", "-sc")
MANY = ("--multirun", "-m")
COMPLETION = ("--shell-completion", "-sc")
COMPLETES = {f"{what}={shell}" for what in ("install", "uninstall", "query") for shell in ("bash", "fish", "zsh")}
FLAGS = (*SHOWS, *MANY, "--run", "-r", "--package", "-p", "--help", "-h")
_MICRO = re.compile(r"(?<=\d)(?P<space> *)[µμ](?=[A-Za-z])")  # of 80µm, which Hydra cannot read
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
TAKES = {  # the words that a flag takes after it; None: any
    **dict.fromkeys(("--cfg", "-c"), ("job", "hydra", "all")),
    **dict.fromkeys(("--info", "-i"), ("all", "config", "defaults", "defaults-tree", "plugins", "searchpath")),
    **dict.fromkeys(("--package", "-p"), None),
}


@dataclass(frozen=True)
class CommandLine:
    """The words of a command, sorted.

    Args:
        flags: What begins with a dash, each followed by its word.
        overrides: Overrides as Hydra shall see them.
        problems: What is wrong with the other words, which are left out.
        overruled: What is said of keys that were given again with another value, of which the last one is kept.
    """

    flags: tuple[str, ...]
    overrides: tuple[str, ...]
    problems: tuple[Problem, ...]
    overruled: tuple[str, ...] = ()

    @property
    def many(self) -> bool:
        """Whether it is a sweep."""
        return bool(set(MANY) & set(self.flags))

    @property
    def shows(self) -> bool:
        """Whether Hydra only shows something and no job runs."""
        return bool(set(SHOWS) & {flag.partition("=")[0] for flag in self.flags})

    @property
    def shows_what_runs(self) -> bool:
        """Whether it shows the configuration of the job as it will run, which is then to be right."""
        return self.shows and "--resolve" in self.flags

    def first_job(self) -> list[str]:
        """The overrides with the first value of each sweep."""
        return [_first(override) for override in self.overrides]


def read_command_line(arguments: Sequence[str]) -> CommandLine:
    """Sort the words; wrong are unknown flags, what is no override, and choices that a group does not have."""
    if set(COMPLETION) & set(arguments):
        return _read_completion(arguments)
    flags: list[str] = []
    overrides: list[str] = []
    problems: list[Problem] = []
    many = bool(set(MANY) & set(arguments))
    takes: tuple[str, ...] | None = ()
    for place, argument in enumerate(arguments):
        if takes is None or argument in takes:
            flags.append(argument)
            takes = ()
        elif argument.startswith("-"):
            name = argument.partition("=")[0]
            found = _unknown_flag(name)
            problems += found
            flags += [] if found else [argument]
            takes = () if "=" in argument else TAKES.get(name, ())
        else:
            found, override = _read_override(argument, many, arguments[place - 1] if place else "")
            problems += found
            overrides += override
    shown = next((flag for flag in flags if flag.partition("=")[0] in SHOWS), None)
    if many and shown:
        rule, remedy = f"runs many jobs, and {shown} shows one", "leave it out, and give each key one value"
        problems.append(Problem(MANY[0], rule, remedy=remedy, source=SOURCE))
    kept, overruled = _last_of_each(overrides)
    return CommandLine(tuple(flags), kept, tuple(problems), overruled)


def _last_of_each(overrides: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The overrides without those of a key that is given again behind them, and what is said where values differ."""
    values: dict[str, list[str]] = {}
    for override in overrides:
        values.setdefault(override.partition("=")[0], []).append(override.partition("=")[2])
    last = {override.partition("=")[0]: k for k, override in enumerate(overrides)}
    said = [
        f"{key.lstrip('+')} is given {len(given)} times: the last, {given[-1]}, counts"
        for key, given in values.items()
        if len({*given}) > 1
    ]
    return tuple(one for k, one in enumerate(overrides) if k in last.values()), tuple(said)


def _read_completion(arguments: Sequence[str]) -> CommandLine:
    """The words by which a shell asks how a command goes on: they are no overrides."""
    words = [word for word in arguments if word not in COMPLETION]
    if len(words) == 1 and words[0] in COMPLETES:
        return CommandLine((COMPLETION[0],), tuple(words), ())
    rule, remedy = "takes one word: install=bash, or fish or zsh", 'eval "$(gear-damping -sc install=bash)"'
    return CommandLine((), (), (Problem(COMPLETION[-1], rule, " ".join(words) or None, remedy, SOURCE),))


def _unknown_flag(name: str) -> list[Problem]:
    return [] if name in FLAGS else [Problem(name, "no such flag", remedy=nearest(name, FLAGS), source=SOURCE)]


def _read_override(argument: str, many: bool, before: str) -> tuple[list[Problem], list[str]]:
    """What is wrong with one word, and the override that Hydra shall see; `before` is the word before it."""
    if "=" not in argument and not argument.startswith("~"):
        remedy = "write key=value, for example experiment=backlash"
        if Path(argument).is_file() and not before.startswith(f"{PATH}="):
            remedy = f"write {PATH}={argument}"
        elif before.partition("=")[2]:  # a value with a blank, which the shell has cut in two
            remedy += f'; where the blank before it is part of a value, quote the whole: "{before} {argument} …"'
        return [Problem(argument, "is not an override", remedy=remedy, source=SOURCE)], []
    if not {"'", '"'} & set(argument):  # what is quoted is read as it stands
        argument = _MICRO.sub(r"\g<space>u", argument)
    if argument.partition("=")[0] in NAMES_FILES:  # a shell leaves the home of a path as it is behind `=`
        argument = _AT_HOME.sub(f"{at_home('~')}/", argument)
    if many and argument.startswith(f"{PATH}="):
        argument = f"{PATH}={all_named(argument.partition('=')[2])}"
    try:
        parsed, argument = _parsed(argument, many)
    except HydraException as error:
        rule = f"cannot be read: {str(error).splitlines()[0]}"
        remedy = "close every bracket and quote; a value with '=' or brackets needs quotes of its own: key='\"value\"'"
        return [Problem(argument, rule, remedy=remedy, source=SOURCE)], []
    key, value = parsed.key_or_group, argument.partition("=")[2]
    if not key:
        return [Problem(argument, "has no key", remedy="write key=value", source=SOURCE)], []
    if len(key) > LONGEST_KEY:
        rule = f"a key of {len(key)} letters, which none has"
        return [Problem(f"{key[:40]}…", rule, remedy="write key=value with a key of --help", source=SOURCE)], []
    if not many and not parsed.is_delete() and parsed.is_sweep_override():
        return [Problem(key, "has several values and this is one run", value, _one_value(key, value), SOURCE)], []
    if key in PLACES and key != PLACES[many]:
        rule = f"is the place {'of one run, and this is a sweep' if many else 'of a sweep, and this is one run'}"
        return [Problem(key, rule, value, f"use {PLACES[many]}=FOLDER", SOURCE)], []
    if key == LAUNCHER and value in NEEDED:
        return _missing_launcher(value), [argument]
    if parsed.is_delete() or key.startswith("hydra"):
        return [], [argument]
    if key not in groups():
        return [], [f"++{key}={value}"]
    if value == "null" and key in OFF_BY_NULL:
        return [], []
    problems = _unknown_choices(key, value)
    return problems, [] if problems else [f"{key}={value}"]


def _parsed(argument: str, many: bool) -> tuple[Override, str]:
    """The override, and the word that it was read from.

    A path that Hydra does not read, `run(2).csv`, is put in quotes, and of one run one with commas, `5,5Nm.csv`.
    """
    key, _, value = argument.partition("=")
    is_path = key in OF_A_PATH and not {"'", '"'} & set(value)
    quoted = f'{key}="{value}"'
    try:
        parsed = parse(argument)
    except HydraException:
        if not is_path:
            raise
        return parse(quoted), quoted
    if is_path and not many and not parsed.is_delete() and parsed.is_sweep_override():
        return parse(quoted), quoted
    return parsed, argument


def _one_value(key: str, value: str) -> str:
    """The remedy for several values in one run: a decimal comma looks like two, and some keys take a list."""
    number = f"write {value.replace(',', '.')} for one number; " if _DECIMAL_COMMA.fullmatch(value) else ""
    listed = ", or write a list: [a,b]" if takes_list(key) else ""
    return f"{number}add --multirun (-m) for a sweep, a run for each{listed}"


def _missing_launcher(name: str) -> list[Problem]:
    module, extra = NEEDED[name]
    try:
        found = find_spec(module)
    except ModuleNotFoundError:  # no plugin of Hydra at all
        found = None
    remedy = f"pip install 'gear-damping[{extra}]'"
    return [] if found else [Problem(LAUNCHER, "needs a plugin of Hydra that is not installed", name, remedy, SOURCE)]


def _unknown_choices(group: str, value: str) -> list[Problem]:
    if "(" in value:
        return []  # choice(…) and glob(…) of a sweep
    source = f"{SOURCE}; the choices are the files of {conf_folder() / group}"
    choices = groups()[group]
    if group == "measurement" and Path(value).suffix:
        return [Problem(group, "no such choice", value, f"a file of your own is {PATH}={value}", SOURCE)]
    return [
        Problem(group, "no such choice", one, nearest(one, choices), source)
        for one in value.split(",")
        if one not in choices
    ]


@lru_cache(MOST_PARSED)
def parse(override: str) -> Override:
    """One override as Hydra understands it; nobody changes it, and the place of every key asks for it anew.

    Raises:
        HydraException: its syntax is broken.
    """
    return OverridesParser.create().parse_override(override)


def _first(override: str) -> str:
    parsed = parse(override)
    if parsed.is_delete() or not parsed.is_sweep_override():
        return override
    return f"{override.partition('=')[0]}={next(iter(parsed.sweep_string_iterator()))}"


def swept_keys(overrides: Sequence[str]) -> list[str]:
    """The keys and groups that a sweep varies."""
    parsed = [parse(override) for override in overrides]
    return [one.key_or_group for one in parsed if not one.is_delete() and one.is_sweep_override()]
