"""What long work says of itself where there is no terminal."""

import time

import pytest

from gear_damping.tasks import progress


@pytest.fixture
def often(monkeypatch):
    monkeypatch.setattr(progress, "LINE_EVERY", 0.02)


def test_a_step_that_takes_long_speaks_all_the_same_and_nothing_speaks_after_the_end(often, capsys):
    with progress.progress_bar("fitting") as report:
        report(1, 4)
        time.sleep(0.2)
    said = capsys.readouterr().err
    assert said.count("fitting: 25 %, 0 s so far\n") >= 2
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_an_interruption_ends_it_too(often, capsys):
    with pytest.raises(KeyboardInterrupt), progress.progress_bar("fitting"):
        raise KeyboardInterrupt
    capsys.readouterr()
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_who_wants_none_gets_none(often, capsys):
    with progress.progress_bar("fitting", wanted=False) as report:
        report(1, 4)
        time.sleep(0.1)
    assert capsys.readouterr().err == ""
