"""Natural units change nothing, and every term can be traced, differentiated and batched."""

import pytest
import torch
from effect_bench import BATCH, Bench, is_sensor, label, variants
from torch.fx.experimental.proxy_tensor import make_fx

TERMS = [v for v in variants() if not is_sensor(v[0])]
# forward derivatives load a module of PyTorch that still uses its deprecated script compiler
pytestmark = pytest.mark.filterwarnings("ignore:`torch.jit.script` is deprecated:DeprecationWarning")
WIDTHS = ("coulomb_friction", "asymmetric_friction")  # relative to the natural velocity, by definition


@pytest.mark.parametrize("variant", TERMS, ids=label)
def test_natural_units_give_the_same_acceleration_as_si(variant):
    name, options = variant
    natural = Bench(name, options)
    given = {}
    if name in WIDTHS:
        given[f"{name}.width"] = natural.own["width"] * natural.prepared.scales.velocity
    plain = Bench(name, options, given, plain=True)
    state = (*natural.random(1), *natural.rest_of_state())
    found = [bench.acceleration(bench.kinematics(bench.times(), state)) for bench in (natural, plain)]
    assert torch.isfinite(found[0]).all()
    size = found[1].abs().max()
    assert ((found[0] - found[1]).abs().max() / size).item() < 1e-11


def _rates(bench: Bench, values: dict, state: tuple, active_branch: dict) -> torch.Tensor:
    bench.use(values)
    at = bench.kinematics(bench.times(), state)
    at.active_branch = active_branch
    return torch.stack(bench.equation.rates(at, bench.prepared.base, bench.prepared.terms))


@pytest.mark.parametrize("variant", TERMS, ids=label)
def test_forward_derivatives_equal_finite_differences(variant):
    bench = Bench(*variant, others=("viscous_damping",) if variant[0] != "viscous_damping" else ())
    state = (*bench.random(2), *bench.rest_of_state())
    active_branch = bench.kinematics(bench.times(), state).active_branch
    values = bench.values
    own = [f"{bench.name}.{p.name}" for p in bench.effect.parameters]
    source = torch.Generator().manual_seed(3)

    def direction(x: torch.Tensor, least: float) -> torch.Tensor:
        return (x.abs() + least) * (1 + torch.rand(x.shape, generator=source, dtype=torch.float64))

    steps = [direction(values[k], 0.0) for k in own]
    moves = [direction(s, 0.0) for s in state]

    def along(size: torch.Tensor) -> torch.Tensor:
        changed = values | {k: values[k] + size * s for k, s in zip(own, steps, strict=True)}
        return _rates(bench, changed, tuple(s + size * m for s, m in zip(state, moves, strict=True)), active_branch)

    zero, one = torch.zeros((), dtype=torch.float64), torch.ones((), dtype=torch.float64)
    _, exact = torch.func.jvp(along, (zero,), (one,))
    width = 1e-6
    rough = (along(zero + width) - along(zero - width)) / (2 * width)
    assert torch.isfinite(exact).all()
    assert ((exact - rough).abs().max() / rough.abs().max()).item() < 1e-6


@pytest.mark.parametrize("variant", TERMS, ids=label)
def test_derivatives_are_finite_at_rest(variant):
    bench = Bench(*variant)
    zero = torch.zeros(BATCH, dtype=torch.float64)
    rest = tuple(0 * s for s in bench.rest_of_state())

    def along(x: torch.Tensor, v: torch.Tensor) -> torch.Tensor:
        return bench.acceleration(bench.kinematics(zero, (x, v, *rest)))

    _, slope = torch.func.jvp(along, (zero, zero), (zero + 1e-6, zero + 1e-2))
    assert torch.isfinite(slope).all()


@pytest.mark.parametrize("variant", TERMS, ids=label)
def test_a_term_traces_to_a_graph_that_holds_for_other_numbers(variant):
    bench = Bench(*variant)
    names = list(bench.p)

    def program(time: torch.Tensor, x: torch.Tensor, v: torch.Tensor, *rest: torch.Tensor) -> tuple:
        count = len(bench.rest_of_state())
        own = dict(zip(names, rest[count:], strict=True))
        terms = bench.prepared.terms | {bench.name: own}
        at = bench.equation.kinematics(time, (x, v, *rest[:count]), {}, bench.prepared.base)
        found = bench.equation.switches(at, terms)
        at.active_branch = {k: (s >= 0).to(s) for k, s in found.items()}
        return bench.equation.rates(at, bench.prepared.base, terms)

    def arguments(seed: int) -> list[torch.Tensor]:
        state = [s / bench.unit(u) for s, u in zip(bench.random(seed), ("m", "m/s"), strict=True)]
        extra = [s + 0.1 * seed for s in bench.rest_of_state()]
        return [bench.times() * (1 + seed), *state, *extra, *(bench.p[k] * (1 + 0.01 * seed) for k in names)]

    graph = make_fx(program)(*arguments(1))
    for found, wanted in zip(graph(*arguments(2)), program(*arguments(2)), strict=True):
        assert torch.equal(found, wanted)


@pytest.mark.parametrize("variant", TERMS, ids=label)
def test_members_do_not_know_of_each_other(variant):
    bench = Bench(*variant)
    state = (*bench.random(4), *bench.rest_of_state())
    everyone = bench.acceleration(bench.kinematics(bench.times(), state))
    order = torch.randperm(BATCH, generator=torch.Generator().manual_seed(5))
    bench.use({k: v[..., order] for k, v in bench.values.items()})
    shuffled = bench.acceleration(bench.kinematics(bench.times()[order], tuple(s[order] for s in state)))
    assert torch.allclose(shuffled, everyone[order], rtol=1e-12, atol=0)


def test_a_term_goes_through_vmap():
    bench = Bench("power_law_damping", others=("backlash",))
    state = bench.random(7)

    def force(coefficient: torch.Tensor) -> torch.Tensor:
        bench.use(bench.values | {"power_law_damping.coefficient": coefficient.expand(BATCH)})
        at = bench.kinematics(bench.times(), state)
        bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
        return bench.effect.damping_force(at, bench.p)

    found = torch.func.vmap(force)(torch.tensor([1.0, 2.0], dtype=torch.float64))
    assert torch.allclose(found[1], 2 * found[0], rtol=1e-12)
