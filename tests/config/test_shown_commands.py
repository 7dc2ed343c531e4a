"""A command that is shown runs where it is copied into a shell."""

import shlex
from pathlib import Path

import pytest

from gear_damping.config.shown import going_on, shown

WORDS = ["task=inspect", "measurement.path=/a b/Messung (neu) 'x'.csv", "model.names=[raw_lstm]", "a={value:1,unit:mm}"]


def test_a_shell_reads_the_words_that_were_given():
    text = shown(WORDS)
    assert shlex.split(text) == ["python", "-m", "gear_damping", *WORDS]
    assert " task=inspect " in text  # nothing is quoted that need not be


def test_a_command_that_was_written_without_quotes_is_shown_as_it_is():
    again = going_on("python -m gear_damping task=train name=it's", Path("tr"))
    assert shlex.split(again)[3:] == ["task=train", "name=it's", "resume=tr"]


@pytest.mark.parametrize("earlier", ["hydra.run.dir=/tmp/old", "hydra.sweep.dir=/tmp/old", "resume=/tmp/older"])
def test_what_goes_on_keeps_every_key_but_its_folders(earlier):
    again = going_on(shown(["experiment=backlash", earlier, *WORDS]), Path("/tmp/tr 1"))
    assert shlex.split(again)[3:] == ["experiment=backlash", *WORDS, "resume=/tmp/tr 1"]
