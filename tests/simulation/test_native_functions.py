"""Power, sine, cosine and the tangents of the native kernels against the C library, inside their range and outside."""

import ctypes
import math

import pytest
import torch

from gear_damping.simulation.native import build

MAIN = """
extern "C" void call(const double* a, const double* b, double* out) {
  vd x, y;
  for (int l = 0; l < WIDTH; ++l) { x[l] = a[l]; y[l] = b[l]; }
  const vd r[5] = {v_pow(x, y), v_sin(x), v_cos(x), v_tanh(x), v_atan(x)};
  for (int i = 0; i < 5; ++i) for (int l = 0; l < WIDTH; ++l) out[i * WIDTH + l] = r[i][l];
}"""


@pytest.fixture(scope="module")
def evaluate():
    """(5, n): power, sine, cosine, hyperbolic and inverse tangent of n pairs of numbers."""
    if build.compiler() is None:
        pytest.skip("no C++ compiler on this machine: native kernels cannot be built")
    width, _ = build.width_and_options()
    header = (build.HERE / "vectors.h").read_text()
    library = build.compiled(f"#define WIDTH {width}\n{header}\n{MAIN}")

    def call(a, b):
        parts = []
        for x, y in zip(a.split(width), b.split(width), strict=True):
            out = torch.empty(5, width, dtype=torch.float64)
            library.call(*(ctypes.c_void_p(t.contiguous().data_ptr()) for t in (x, y)), ctypes.c_void_p(out.data_ptr()))
            parts.append(out)
        return torch.cat(parts, dim=1)

    return call


def numbers(count, low, high):
    return torch.linspace(low, high, count, dtype=torch.float64)


def test_powers_of_every_size(evaluate):
    base, exponent = 10 ** numbers(4096, -90, 40), numbers(4096, 0.2, 5).flip(0)
    pairs = zip(base.tolist(), exponent.tolist(), strict=True)
    expected = torch.tensor([math.pow(a, b) for a, b in pairs], dtype=torch.float64)
    torch.testing.assert_close(evaluate(base, exponent)[0], expected, rtol=3e-13, atol=1e-300)


def test_powers_near_one(evaluate):
    base, exponent = numbers(4096, 0.5, 2.0), numbers(4096, 1.0, 3.0)
    torch.testing.assert_close(evaluate(base, exponent)[0], base**exponent, rtol=1e-15, atol=0)


def test_sine_and_cosine_of_long_runs(evaluate):
    angle = torch.cat([numbers(4096, -10, 10), numbers(4096, -9e5, 9e5)])
    found = evaluate(angle, angle)
    torch.testing.assert_close(found[1], angle.sin(), rtol=0, atol=3e-16)
    torch.testing.assert_close(found[2], angle.cos(), rtol=0, atol=3e-16)


def signed(low, high):
    """4096 numbers of either sign, sizes of 10^low to 10^high."""
    size = 10 ** numbers(2048, low, high)
    return torch.cat([-size.flip(0), size])


@pytest.mark.parametrize(("row", "function"), [(3, math.tanh), (4, math.atan)])
def test_tangents_of_every_size(evaluate, row, function):
    near, far = signed(-12, 1.5), torch.cat([numbers(4088, -3, 3), signed(2, 300)[::512]])
    value = torch.cat([near, far, torch.tensor([0.0, math.inf, -math.inf, 20.0, 0.66, -2.5, 5e-324, 1.0] * 2)])
    expected = torch.tensor([function(x) for x in value.tolist()], dtype=torch.float64)
    torch.testing.assert_close(evaluate(value, value)[row], expected, rtol=5e-16, atol=0)


def test_a_tangent_of_nothing_is_nothing(evaluate):
    value = torch.tensor([math.nan, 1.0] * 8, dtype=torch.float64)
    found = evaluate(value, value)[3:]
    assert found[:, ::2].isnan().all()
    assert found[:, 1::2].isfinite().all()


def test_what_lies_outside_is_the_librarys(evaluate):
    base = torch.tensor([0.0, 1e-310, 1e305, math.inf, math.nan, 1e-100, 2.0, 3.0] * 4, dtype=torch.float64)
    exponent = torch.full_like(base, 2.0)
    exponent[5::8] = 5.0  # vanishes
    found = evaluate(base, exponent)
    torch.testing.assert_close(found[0], base**exponent, rtol=1e-15, atol=0, equal_nan=True)
    far = torch.tensor([2e6, -1e12, math.nan, 1.0] * 8, dtype=torch.float64)
    turned = evaluate(far, exponent)
    torch.testing.assert_close(turned[1], far.sin(), rtol=0, atol=3e-16, equal_nan=True)
    torch.testing.assert_close(turned[2], far.cos(), rtol=0, atol=3e-16, equal_nan=True)


def test_a_member_never_sees_its_neighbours(evaluate):
    """A neighbour outside the range changes no bit."""
    base, exponent = numbers(32, 0.1, 3.0), numbers(32, 0.5, 2.5)
    alone = evaluate(base, exponent)
    base[1::2] = math.nan
    assert torch.equal(evaluate(base, exponent)[:, ::2], alone[:, ::2])
