"""Native kernels do what the eager equations do, for every effect of the catalogue."""

import ctypes
import logging
import multiprocessing
import re

import numpy as np
import pytest
import torch

from gear_damping.physics.catalogue import builtin_effects, effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.known import systems_of
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import MeshStiffness, Sensor
from gear_damping.simulation import compilation
from gear_damping.simulation.kernel import Batch, Kernel
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.native import build
from gear_damping.simulation.native.expressions import Program
from gear_damping.simulation.native.source import crossings, tableau
from gear_damping.simulation.native.stepper import in_parallel
from gear_damping.simulation.native.structure import structure_of
from gear_damping.simulation.native.trace import TRACED_BATCH, UntraceableError, trace
from gear_damping.simulation.prepare import Planned, prepare_kernels
from gear_damping.simulation.series import Series
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

EFFECTS = {name: kind for name, kind in builtin_effects().items() if not issubclass(kind, Sensor)}


def model_with(name):
    kinds = builtin_effects()
    effects = [kinds[name](), *(kinds[other]() for other in kinds[name].requires)]
    if "gear_pair" not in systems_of(kinds[name]):
        return Model(Oscillator(), effects), {"stiffness": 1e8, "amplitude": 1e-5, "initial_displacement": 1e-5}
    if not issubclass(kinds[name], MeshStiffness):
        effects.append(kinds["fourier_mesh_stiffness"]())
    if name != "viscous_damping":
        effects.append(kinds["viscous_damping"]())
    return Model(GearPair(), effects), {"initial_displacement": 1.9e-5}


@pytest.mark.usefixtures("compiler")
@pytest.mark.parametrize("name", EFFECTS)
def test_native_equals_eager(name):
    model, given = model_with(name)
    values = model.values(3, **given)
    run = {"sampling_rate": 40e3, "n_samples": 40}
    native = simulate(model, values, solver=Solver(substeps=4, engine="native"), **run)
    eager = simulate(model, values, solver=Solver(substeps=4, engine="eager"), **run)
    for state in native.states:
        torch.testing.assert_close(native.states[state], eager.states[state], rtol=1e-9, atol=1e-12)


@pytest.mark.usefixtures("compiler")
def test_a_term_without_native_form_runs_eager(bench_model, monkeypatch, caplog):
    model, values = bench_model

    def refuse(*_):
        raise UntraceableError("no native form")

    monkeypatch.setattr(compilation, "kernel_source", refuse)
    monkeypatch.setattr(compilation.build, "known", lambda structure: None)
    monkeypatch.setattr(compilation, "_libraries", {})
    monkeypatch.setattr(compilation, "_said", set())
    with caplog.at_level(logging.WARNING):
        runs = simulate(model, values(2), sampling_rate=40e3, n_samples=5)
    assert runs.good.all()
    assert "no native kernel" in caplog.text
    with pytest.raises(RuntimeError, match="native"):
        simulate(model, values(2), sampling_rate=40e3, n_samples=5, solver=Solver(engine="native"))


def test_without_a_compiler_the_results_are_the_same(bench_model, monkeypatch, caplog):
    model, values = bench_model
    expected = simulate(model, values(2), sampling_rate=40e3, n_samples=30).response
    monkeypatch.setattr(build, "compiler", lambda: None)
    monkeypatch.setattr(compilation, "_libraries", {})
    monkeypatch.setattr(compilation, "_said", set())
    with caplog.at_level(logging.WARNING):
        found = simulate(model, values(2), sampling_rate=40e3, n_samples=30).response
    assert "no C++ compiler" in caplog.text
    torch.testing.assert_close(found, expected, rtol=1e-9, atol=1e-15)


def operations(a, b):
    """Every operation that the tracer knows, on (2, batch) and (batch,)."""
    mask = (a > 0.2) & ~(b <= 0.7)
    stacked = torch.stack([a[0], b, a[1] - 2])
    return torch.stack(
        [
            torch.where(mask[0], a[0] ** 2, -a[1]),
            stacked.sum(0) + stacked.amin(0) - stacked.amax(0),
            (a * b).sum(0).clamp(0.1, 0.9),
            torch.tanh(a[0]) + torch.exp(-b) + torch.log(b + 2) + torch.atan(a[1]),
            torch.sqrt(b) * torch.sign(a[0]) + a[0].abs() ** b + torch.floor(3 * a[1]),
            1 / (1 + b) + torch.maximum(a[0], b) - torch.minimum(a[1], b),
            mask[1].to(a) + (1 - a[0]).reciprocal() + torch.cos(a[0]) * torch.sin(b),
        ]
    )


@pytest.mark.usefixtures("compiler")
def test_every_operation_against_pytorch(tmp_path):
    from gear_damping.simulation.native.emit import Written

    generator = torch.Generator().manual_seed(3)
    a = 0.05 + 0.9 * torch.rand(2, TRACED_BATCH, generator=generator, dtype=torch.float64)
    b = 0.05 + 0.9 * torch.rand(TRACED_BATCH, generator=generator, dtype=torch.float64)
    program = Program()
    rows = np.array([[program.input("y[0]", True)], [program.input("y[1]", True)]], dtype=object)
    last = np.array([program.input("y[2]", True)], dtype=object)
    (found,) = trace(operations, [a, b], [rows, last], program)
    written = Written(program)
    body = written.function("stage", list(np.ravel(found)))
    width, _ = build.width_and_options()
    main = """
extern "C" void call(const double* in, double* out) {
  vd y[3], r[7];
  for (int i = 0; i < 3; ++i) for (int l = 0; l < WIDTH; ++l) y[i][l] = in[i * WIDTH + l];
  stage(vd{}, y, y, y, 0.0, y, y, r);
  for (int i = 0; i < 7; ++i) for (int l = 0; l < WIDTH; ++l) out[i * WIDTH + l] = r[i][l];
}"""
    header = (build.HERE / "vectors.h").read_text()
    library = build.compiled(f"#define WIDTH {width}\n{header}\n{body}\n{main}")
    given = torch.cat([a, b.unsqueeze(0)])[:, :width].contiguous()
    result = torch.empty(7, width, dtype=torch.float64)
    library.call(ctypes.c_void_p(given.data_ptr()), ctypes.c_void_p(result.data_ptr()))
    torch.testing.assert_close(result, operations(a, b)[:, :width], rtol=1e-13, atol=1e-14)


def test_an_unknown_operation_is_refused_by_name():
    with pytest.raises(UntraceableError, match="erfinv"):
        trace(torch.erfinv, [torch.zeros(TRACED_BATCH)], [np.array([0.0], dtype=object)], Program())


@pytest.mark.usefixtures("compiler")
def test_kernels_are_kept_between_processes_and_the_first_is_said(bench_model, monkeypatch, tmp_path, caplog):
    model, values = bench_model
    monkeypatch.setattr(build, "_said", [])
    for number, (folder, said) in enumerate((("one", True), ("one", False), ("two", False))):
        monkeypatch.setenv("GEAR_DAMPING_CACHE", str(tmp_path / folder))
        caplog.clear()
        monkeypatch.setattr(compilation, "_libraries", {})
        with caplog.at_level(logging.INFO):
            simulate(model, values(2), sampling_rate=40e3, n_samples=3)
        assert ("compiling" in caplog.text) is said, number
    for folder in ("one", "two"):
        assert len(list(tmp_path.glob(f"{folder}/kernels/*.so"))) == 1


@pytest.mark.usefixtures("compiler")
def test_a_kernel_is_found_again_without_tracing(bench_model, monkeypatch):
    model, values = bench_model
    run = {"sampling_rate": 40e3, "n_samples": 5}
    first = simulate(model, values(2), **run).response
    monkeypatch.setattr(compilation, "kernel_source", None)
    monkeypatch.setattr(compilation, "_libraries", {})
    torch.testing.assert_close(simulate(model, values(2), **run).response, first, rtol=0, atol=0)


def test_what_decides_a_kernel_is_in_its_key(bench_model):
    model, values = bench_model
    other = Model(model.system, [*model.effects, effect_class("cubic_stiffness")()])
    keys = set()
    for kind in (model, other):
        prepared = kind.prepare({**kind.values(2), **values(2)})
        fixed = Layout(prepared).pack(prepared, prepared.scales.time)
        batch = Batch(fixed, fixed[:0], fixed.new_zeros(()))
        keys.add(structure_of(Kernel(kind, Layout(prepared), Series(()), batch, fixed[:2])))
    assert len(keys) == 2
    assert None not in keys


def test_a_forked_process_does_not_wait_for_the_threads_of_its_parent():
    def walk():
        in_parallel(lambda share: None, [(0, 1), (1, 2)])

    walk()
    child = multiprocessing.get_context("fork").Process(target=walk, daemon=True)
    child.start()
    child.join(20)
    code = child.exitcode
    child.kill()
    assert code == 0


@pytest.mark.usefixtures("compiler")
def test_models_with_nearly_as_many_harmonics_share_a_kernel(bench_model, monkeypatch):
    model, values = bench_model
    shaped = Model(model.system, [*model.effects, effect_class("mesh_stiffness_shape")()])
    run = {"sampling_rate": 40e3, "n_samples": 5, "solver": Solver(engine="native")}

    def response(*sizes):
        lists = {f"mesh_stiffness_shape.{part}": sizes for part in ("in_phase", "quadrature")}
        return simulate(shaped, shaped.values(2, **lists) | values(2), **run).response

    first = response(0.02, 0.01, 0.01)
    monkeypatch.setattr(compilation, "kernel_source", None)
    monkeypatch.setattr(build, "known", None)
    assert torch.equal(response(0.02, 0.01, 0.01, 0.0), first)
    assert not torch.equal(response(0.02, 0.01, 0.01, 0.01), first)


@pytest.mark.usefixtures("compiler")
def test_kernels_prepared_together_serve_their_simulations(bench_model, monkeypatch, tmp_path):
    model, values = bench_model
    others = [Model(model.system, [*model.effects, effect_class(name)()]) for name in ("cubic_stiffness", "load_noise")]
    monkeypatch.setenv("GEAR_DAMPING_CACHE", str(tmp_path))
    monkeypatch.setattr(compilation, "_libraries", {})
    given = [other.values(2) | values(2) for other in others]
    inputs = {"pinion_torque": torch.full((2, 5), 150.0, dtype=torch.float64)}
    plans = [Planned(*both, tuple(inputs)) for both in zip(others, given, strict=True)]
    prepare_kernels([*plans, plans[0]])
    assert len(list(tmp_path.glob("kernels/*.so"))) == 2
    monkeypatch.setattr(compilation, "_build", None)
    for other, own in zip(others, given, strict=True):
        simulate(other, own, sampling_rate=40e3, n_samples=5, inputs=inputs)


def test_an_engine_without_kernels_prepares_none(bench_model, monkeypatch):
    model, values = bench_model
    monkeypatch.setattr(compilation, "_build", None)
    monkeypatch.setattr(compilation, "_libraries", {})
    prepare_kernels([Planned(model, values(2))], Solver(engine="eager"))


SHARED = ("REACH", "MOST_SHIFT", "SAME_INSTANT", "ROOT_STEPS", "MOST_SPLITS", "WATCHED", "NODES", "STAGES", "WEIGHTS")
OF_FORMULAS = {"0", "1", "0.0", "1.0", "2.0", "3.0"}  # indices, and the coefficients of Hermite's cubic
OF_THE_MACHINE = {"4", "6", "8"}  # vectors and stages that the compiler unrolls, outputs in a line of the cache


def test_the_driver_copies_no_number_of_the_method():
    """What the eager steps and the kernel have in common is declared once, in Python, and written into the source."""
    code = re.sub(r"//.*", "", (build.HERE / "driver.cpp").read_text())
    numbers = set(re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?", code))
    assert numbers <= OF_FORMULAS | OF_THE_MACHINE
    generated = tableau() + crossings()
    for name in SHARED:
        assert name in code
        assert re.search(rf"\b{name}\b", generated)


def test_an_engine_that_is_not_there_is_refused(bench_model):
    model, values = bench_model
    with pytest.raises(ValueError, match="auto, native, eager"):
        simulate(model, values(2), sampling_rate=40e3, n_samples=5, solver=Solver(engine="fused"))


@pytest.fixture
def anew(bench_model, monkeypatch, tmp_path):
    """Simulate as a new process would, in a machine that the environment describes; what it said is in the log."""
    model, values = bench_model
    for name in ("GEAR_DAMPING_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(compilation, "_libraries", {})
    monkeypatch.setattr(compilation, "_said", set())
    everything = (build.compiler, build._machine, build.width_and_options)
    for one in everything:
        one.cache_clear()
    yield lambda: simulate(model, values(2), sampling_rate=40e3, n_samples=5).response
    monkeypatch.undo()
    for one in everything:
        one.cache_clear()


@pytest.mark.usefixtures("compiler")
def test_a_cache_that_cannot_be_written_to_is_done_without(anew, monkeypatch, tmp_path, caplog):
    monkeypatch.setenv("GEAR_DAMPING_CACHE", str(tmp_path / "kept"))
    expected = anew()
    (tmp_path / "file").touch()  # no folder can be made below it, whoever runs the test
    monkeypatch.setattr(compilation, "_libraries", {})
    monkeypatch.setenv("GEAR_DAMPING_CACHE", str(tmp_path / "file"))
    assert torch.equal(anew(), expected)
    assert "compiled simulations cannot be kept" in caplog.text
    assert "GEAR_DAMPING_CACHE=FOLDER names another place" in caplog.text
    assert "slower" not in caplog.text  # compiled all the same


@pytest.mark.usefixtures("compiler")
def test_a_user_without_a_home_simulates(anew, monkeypatch, caplog):
    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.setattr(build.Path, "home", lambda: (_ for _ in ()).throw(RuntimeError("no home directory")))
    anew()
    assert "cannot be kept (no home directory)" in caplog.text


@pytest.mark.parametrize("script", [None, "#!/bin/sh\nexit 1\n"], ids=["absent", "broken"])
def test_a_machine_without_a_compiler_that_works_simulates_and_says_so(script, anew, monkeypatch, tmp_path, caplog):
    monkeypatch.setenv("GEAR_DAMPING_CACHE", str(tmp_path / "kept"))
    monkeypatch.setenv("PATH", str(tmp_path))
    if script:
        (tmp_path / "g++").write_text(script)
        (tmp_path / "g++").chmod(0o755)
    anew()
    said = "no native kernel for this model" if script else "no C++ compiler found"
    assert said in caplog.text
    assert "slower" in caplog.text
