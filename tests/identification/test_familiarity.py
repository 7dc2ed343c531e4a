"""The alarm of a network: records like those of the training pass, others do not, at any level of noise."""

import math
from pathlib import Path

import pytest
import torch

from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.familiarity import LEAST_RUNS, Components, components_for
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import Protocol
from gear_damping.identification.runs import RunSet
from gear_damping.identification.trainer import build_estimator, fit_components, fit_front_end
from gear_damping.interface.estimator import NetworkEstimator
from gear_damping.measurement.record import Channel, Measurement, Record

SAMPLES, RUNS = 400, 600


def decays(count, seed, second=0.0):
    """Decays of one frequency beside a line, and where asked for one of a second frequency of that amplitude."""
    generator = torch.Generator().manual_seed(seed)
    size, rate, phase = torch.rand(3, count, 1, generator=generator, dtype=torch.float64)
    time = torch.arange(SAMPLES, dtype=torch.float64)
    found = (0.5 + size) * torch.exp(-(0.002 + 0.008 * rate) * time) * torch.cos(0.6 * time + 2 * math.pi * phase)
    return (found + torch.cos(0.2 * time) + second * torch.cos(0.31 * time + phase)).float()


@pytest.fixture(scope="module")
def components():
    made = Components(SAMPLES, components_for(RUNS, 200))
    made.fit(decays(RUNS, 1), decays(200, 2), SensorNoise((1.0, 40.0)), seed=3)
    return made


def noisy(records, snr_db, seed):
    rms = records.std(1, correction=0)
    return SensorNoise(snr_db).add(records, rms, torch.Generator().manual_seed(seed))


@pytest.mark.parametrize("snr_db", [1.0, 20.0, 40.0, 80.0])
def test_unseen_records_of_the_family_pass(components, snr_db):
    flagged = components.strange(noisy(decays(500, 4), snr_db, 5)).double().mean()
    assert flagged < 0.065  # .04 with three deviations of 500 records


@pytest.mark.parametrize("snr_db", [20.0, 40.0])
def test_what_the_family_lacks_is_seen_at_twice_the_noise(components, snr_db):
    own = decays(300, 6)
    noise = float(own.std(1).mean()) * 10 ** (-snr_db / 20)
    size = math.sqrt(2 * 3) * noise  # with the noise beside it, a residual of twice the noise
    assert components.strange(noisy(decays(300, 6, second=size), snr_db, 7)).double().mean() > 0.95


def test_one_record_is_told_in_words(components):
    known, other = (components(one[0]) for one in (decays(1, 8), decays(1, 8, second=0.5)))
    assert not known.is_strange
    assert other.is_strange
    assert "no run of the training holds" in other.sentence
    assert components(decays(1, 8)[0, :-1]) is None


def test_too_few_runs_tell_nothing():
    assert components_for(LEAST_RUNS - 1, 500) == components_for(500, LEAST_RUNS - 1) == 0


def trained(runs):
    """A network of windows that has learnt what its records are like, and nothing else."""
    labels = torch.linspace(0.1, 0.6, runs)
    run_set = RunSet(decays(runs, 9), labels, 1e3, "decays", {}, "oscillator", "displacement", "m")
    data = WindowDataModule(Material(run_set, Protocol(validation_fraction=0.4), SensorNoise((10.0, 40.0))))
    module = build_estimator(EstimatorConfig("raw_lstm"), data, 1e-3)
    fit_front_end(module, data)
    fit_components(module, data)
    return module.eval()


def recorded(values):
    channel = Channel("displacement", values.double().numpy(), "m")
    stamps = torch.arange(len(values)).double().numpy() / 1e3
    record = Record("a", Path(), "", None, 1e3, stamps, {channel.name: channel})
    return Measurement("oscillator", {}, (record,), Path("m.yaml"))


def test_a_network_says_so_of_a_record():
    module = trained(300)
    values = noisy(decays(1, 10), 30.0, 11)[0]
    known, other, short = (
        NetworkEstimator(module).predict(recorded(one))["a"]
        for one in (values, values + decays(1, 10, second=0.2)[0] - decays(1, 10)[0], values[:-1])
    )
    assert not any("no run of the training holds" in sentence for sentence in known.outside)
    assert other.familiarity.sentence in other.outside
    assert short.familiarity is None


def test_a_network_of_few_runs_does_not_pretend_to_know():
    module = trained(100)
    assert module.components is None
    assert NetworkEstimator(module).predict(recorded(decays(1, 10)[0]))["a"].familiarity is None
