// A vector of lanes and the functions of it; glibc's vector library where it is there, else lane by lane.
// Nothing is included: reading the headers of intrinsics takes longer than compiling a kernel.

typedef double vd __attribute__((vector_size(8 * WIDTH)));
typedef long long vm __attribute__((vector_size(8 * WIDTH)));

static inline bool any(vm m) {
#if defined(__AVX512DQ__) && WIDTH == 8
  return __builtin_ia32_cvtq2mask512(m) != 0;
#else
  long long found = 0;
  for (int l = 0; l < WIDTH; ++l) found |= m[l];
  return found != 0;
#endif
}
static inline vd v_abs(vd a) { return a < 0.0 ? -a : a; }
static inline vd v_max(vd a, vd b) { return a > b ? a : b; }
static inline vd v_min(vd a, vd b) { return a < b ? a : b; }
static inline vd v_sign(vd a) { return a > 0.0 ? vd{} + 1.0 : (a < 0.0 ? vd{} - 1.0 : vd{}); }

#define LANE_BY_LANE(name, function) \
  static inline vd name(vd a) { vd r; for (int l = 0; l < WIDTH; ++l) r[l] = function(a[l]); return r; }
LANE_BY_LANE(v_sqrt, __builtin_sqrt)
LANE_BY_LANE(v_floor, __builtin_floor)

#if defined(HAVE_LIBMVEC) && defined(__AVX512F__) && WIDTH == 8
#define VECTOR(name, function) extern "C" vd _ZGVeN8v_##function(vd); static inline vd name(vd a) { return _ZGVeN8v_##function(a); }
extern "C" vd _ZGVeN8vv_pow(vd, vd);
static inline vd library_pow(vd a, vd b) { return _ZGVeN8vv_pow(a, b); }
#elif defined(HAVE_LIBMVEC) && defined(__AVX2__) && WIDTH == 4
#define VECTOR(name, function) extern "C" vd _ZGVdN4v_##function(vd); static inline vd name(vd a) { return _ZGVdN4v_##function(a); }
extern "C" vd _ZGVdN4vv_pow(vd, vd);
static inline vd library_pow(vd a, vd b) { return _ZGVdN4vv_pow(a, b); }
#else
#define VECTOR(name, function) LANE_BY_LANE(name, __builtin_##function)
static inline vd library_pow(vd a, vd b) { vd r; for (int l = 0; l < WIDTH; ++l) r[l] = __builtin_pow(a[l], b[l]); return r; }
#endif
VECTOR(library_cos, cos)
VECTOR(library_sin, sin)
VECTOR(v_exp, exp)
VECTOR(v_log, log)

// Power, cosine, sine, hyperbolic and inverse tangent without a call, so that the compiler keeps everything in registers and the processor
// works on several vectors at once. Lanes outside their range take the library's value, the others never do: what
// a lane gets does not depend on its neighbours. Errors of a few 1e-16.
static const double SHIFT = 0x1.8p52;  // added to a number it leaves the nearest whole number in the last bits

// a^b = 2^(b log2 a): log2 by the series of the area tangent about 1, 2^f by its Taylor series on |f| <= 1/2.
static inline vd v_pow(vd a, vd b) {
  static const double TWO_OVER_LN2 = 2.8853900817779268;
  static const double POWER[13] = {1.0, 0.6931471805599453, 0.2402265069591007, 0.05550410866482158,
                                   0.009618129107628477, 0.0013333558146428443, 0.0001540353039338161,
                                   1.5252733804059841e-05, 1.3215486790144307e-06, 1.0178086009239699e-07,
                                   7.054911620801123e-09, 4.4455382718708116e-10, 2.5678435993488202e-11};
  const vm octave = ((vm)a - 0x3fe6a09e667f3bcdLL) >> 52;  // a = m 2^octave, m from sqrt(1/2) to sqrt(2)
  const vd m = (vd)((vm)a - (octave << 52)), whole = (vd)(octave + 0x4338000000000000LL) - SHIFT;
  const vd s = (m - 1.0) / (m + 1.0), z = s * s;
  vd log2 = vd{} + TWO_OVER_LN2 / 19;
  for (int k = 17; k > 0; k -= 2) log2 = log2 * z + TWO_OVER_LN2 / k;
  const vd y = b * (whole + s * log2), shifted = y + SHIFT, f = y - (shifted - SHIFT);
  vd power = vd{} + POWER[12];
  for (int k = 11; k >= 0; --k) power = power * f + POWER[k];
  const vm inside = (a >= 1e-300) & (a <= 1e300) & (y < 1000.0) & (y > -1000.0);
  const vd found = (vd)((vm)power + ((vm)shifted << 52));
  return __builtin_expect(any(~inside), 0) ? (inside ? found : library_pow(a, b)) : found;
}

// sin(x + quarters pi/2): the quarter turns in x are taken off in three parts (Cody and Waite), the rest is
// within pi/4 of zero; polynomials of the kernels of fdlibm.
static inline vd turned_sin(vd x, long long quarters) {
  const vd shifted = x * 0.6366197723675814 + SHIFT, n = shifted - SHIFT;
  const vd r = ((x - n * 1.57079632673412561417e+00) - n * 6.07710050630396597660e-11) - n * 2.02226624879595063154e-21;
  const vd z = r * r;
  const vd sine = r + r * z * (((((1.58969099521155010221e-10 * z - 2.50507602534068634195e-08) * z +
      2.75573137070700676789e-06) * z - 1.98412698298579493134e-04) * z + 8.33333333332248946124e-03) * z -
      1.66666666666666324348e-01);
  const vd cosine = 1.0 - 0.5 * z + z * z * (((((-1.13596475577881948265e-11 * z + 2.08757232129817482790e-09) * z -
      2.75573143513906633035e-07) * z + 2.48015872894767294178e-05) * z - 1.38888888888741095749e-03) * z +
      4.16666666666666019037e-02);
  const vm turn = (vm)shifted + quarters;
  return (vd)((vm)((turn & 1) != 0 ? cosine : sine) ^ ((turn & 2) << 62));
}
static inline vd v_sin(vd x) {
  const vm near = v_abs(x) < 1e6;
  const vd found = turned_sin(x, 0);
  return __builtin_expect(any(~near), 0) ? (near ? found : library_sin(x)) : found;
}
static inline vd v_cos(vd x) {
  const vm near = v_abs(x) < 1e6;
  const vd found = turned_sin(x, 1);
  return __builtin_expect(any(~near), 0) ? (near ? found : library_cos(x)) : found;
}

// tanh |x| = e / (e + 2), e = exp(2 |x|) - 1 = 2^n (exp(r) - 1) + 2^n - 1 with |r| <= ln(2) / 2, by Taylor's series;
// from 20 on it is 1 to the last bit.
static inline vd v_tanh(vd x) {
  static const double ONE_OVER_FACTORIAL[12] = {0.5, 0.16666666666666667, 0.041666666666666667, 0.0083333333333333333,
                                                0.0013888888888888889, 0.00019841269841269841, 2.4801587301587302e-05,
                                                2.7557319223985891e-06, 2.7557319223985891e-07, 2.5052108385441719e-08,
                                                2.0876756987868099e-09, 1.6059043836821615e-10};
  const vd size = v_abs(x), y = 2.0 * (size > 20.0 ? vd{} + 20.0 : size);
  const vd shifted = y * 1.4426950408889634 + SHIFT, n = shifted - SHIFT;
  const vd r = (y - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  vd sum = vd{} + ONE_OVER_FACTORIAL[11];
  for (int k = 10; k >= 0; --k) sum = sum * r + ONE_OVER_FACTORIAL[k];
  const vd power = (vd)(((vm)shifted + 1023) << 52), e = power * (r + r * r * sum) + (power - 1.0);
  const vd found = e / (e + 2.0);
  return x < 0.0 ? -found : found;
}

// Beyond tan(3 pi / 8) by the reciprocal, beyond .66 from 1 on; a rational function (Cephes) of what is left.
static inline vd v_atan(vd x) {
  const vd size = v_abs(x);
  const vm far = size > 2.414213562373095, middle = (size > 0.66) & ~far;
  const vd over = far ? vd{} - 1.0 : (middle ? size - 1.0 : size), under = far ? size : (middle ? size + 1.0 : vd{} + 1.0);
  const vd base = far ? vd{} + 1.5707963267948966 : (middle ? vd{} + 0.78539816339744831 : vd{});
  const vd rest = far ? vd{} + 6.123233995736765886130e-17 : (middle ? vd{} + 3.061616997868382943065e-17 : vd{});
  const vd r = over / under, z = r * r;
  const vd p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
      1.228866684490136173410e2) * z - 6.485021904942025371773e1;
  const vd q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
      4.853903996359136964868e2) * z + 1.945506571482613964425e2;
  const vd found = base + (r + (r * z * p / q + rest));
  return x < 0.0 ? -found : found;
}
