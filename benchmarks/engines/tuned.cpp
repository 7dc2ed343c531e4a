// The limit of this processor: the benchmark's one equation written out by hand, with what a program for any equation
// cannot assume. The mesh turns evenly, so that a rotation replaces every cosine; its stiffness has the same harmonics
// in all members; damping is small, so that single precision is enough for its power; only y is written.
// Above this text stand the package's vectors and the coefficients of its method, and COSINES or EXACT_POWER where its
// way of either is to be timed.
typedef float vf __attribute__((vector_size(64)));
typedef int vi __attribute__((vector_size(64)));
typedef float vh __attribute__((vector_size(32)));

static const int M = 4, LANES = 8 * M, DEGREE = 8, TILE = 8;

// a sign(v) |v|^n in single precision, sixteen lanes at once.
static inline vf power(vf v, vf log2_a, vf n) {
  const vi sign = (vi)v & (int)0x80000000, size = (vi)v & 0x7fffffff;
  const vi octave = (size - 0x3f3504f3) >> 23;
  const vf m = (vf)(size - (octave << 23)), s = (m - 1.0f) / (m + 1.0f), z = s * s;
  const vf log2 = s * (2.8853900818f + z * (0.9617966939f + z * (0.5770780164f + z * 0.43f)));
  vf y = log2_a + n * (__builtin_convertvector(octave, vf) + log2);
  y = y > -120.0f ? y : (vf{} - 120.0f);
  const vf shifted = y + 12582912.0f, f = y - (shifted - 12582912.0f);
  const vf p = 1.0f + f * (0.69314718f + f * (0.24022651f + f * (0.055504109f + f * (0.0096181291f + f * 0.0013333558f))));
  return (vf)(((vi)p + ((vi)shifted << 23)) | sign);
}

struct Batch {
  vd a[M], exponent[M], angle[M], speed[M];
  vd y[M], v[M], cosine[M], sine[M], turn_cosine[6][M], turn_sine[6][M];
  vf log2_a[M / 2], n[M / 2];
};

static inline void step(Batch& b, double h, const double* c) {
  vd k[6][M], u[6][M];  // rates of v and of y
#pragma GCC unroll 6
  for (int stage = 0; stage < 6; ++stage) {
    vd y[M], v[M];
#pragma GCC unroll 4
    for (int m = 0; m < M; ++m) {
      vd dy = vd{}, dv = vd{};
      for (int j = 0; j < stage; ++j) dy += STAGES[stage][j] * u[j][m], dv += STAGES[stage][j] * k[j][m];
      y[m] = b.y[m] + h * dy, v[m] = b.v[m] + h * dv;
    }
#pragma GCC unroll 2
    for (int pair = 0; pair < M / 2; ++pair) {
      const vh low = __builtin_convertvector(v[2 * pair], vh), high = __builtin_convertvector(v[2 * pair + 1], vh);
      const vf both = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
      const vf force = power(both, b.log2_a[pair], b.n[pair]);
      const vd first = __builtin_convertvector(__builtin_shufflevector(force, force, 0, 1, 2, 3, 4, 5, 6, 7), vd);
      const vd last = __builtin_convertvector(__builtin_shufflevector(force, force, 8, 9, 10, 11, 12, 13, 14, 15), vd);
#pragma GCC unroll 2
      for (int m = 2 * pair; m < 2 * pair + 2; ++m) {
#ifdef COSINES
        const vd x = v_cos(b.angle[m] + NODES[stage] * h * b.speed[m]);
#else
        const vd x = b.cosine[m] * b.turn_cosine[stage][m] - b.sine[m] * b.turn_sine[stage][m];
#endif
#ifdef EXACT_POWER
        const vd damping = b.a[m] * v_sign(v[m]) * v_pow(v_abs(v[m]), b.exponent[m]);
#else
        const vd damping = m % 2 ? last : first;
#endif
        vd stiffness = vd{} + c[DEGREE];
        for (int j = DEGREE - 1; j >= 0; --j) stiffness = stiffness * x + c[j];
        u[stage][m] = v[m];
        k[stage][m] = 1.0 - damping - stiffness * y[m];
      }
    }
  }
#pragma GCC unroll 4
  for (int m = 0; m < M; ++m) {
    vd dy = vd{}, dv = vd{};
    for (int j = 0; j < 6; ++j) dy += WEIGHTS[j] * u[j][m], dv += WEIGHTS[j] * k[j][m];
    b.y[m] += h * dy, b.v[m] += h * dv, b.angle[m] += h * b.speed[m];
    const vd x = b.cosine[m] * b.turn_cosine[5][m] - b.sine[m] * b.turn_sine[5][m];
    b.sine[m] = b.sine[m] * b.turn_cosine[5][m] + b.cosine[m] * b.turn_sine[5][m];
    b.cosine[m] = x;
  }
}

// rows: log2 a, n, y0, w, phase, each (lanes,), lanes a multiple of LANES; out (lanes, count + 1).
extern "C" void walk(long lanes, long count, long substeps, double interval, const double* rows, const double* c,
                     double* out) {
  const double h = interval / double(substeps);
  for (long group = 0; group < lanes; group += LANES) {
    Batch b;
    alignas(64) double tile[TILE][LANES];
    for (int l = 0; l < LANES; ++l) {
      const double* own = rows + group + l;
      const double w = own[3 * lanes], phase = own[4 * lanes];
      const int m = l / 8, i = l % 8;
      b.log2_a[m / 2][l % 16] = float(own[0]), b.n[m / 2][l % 16] = float(own[lanes]);
      b.a[m][i] = __builtin_exp2(own[0]), b.exponent[m][i] = own[lanes], b.angle[m][i] = phase, b.speed[m][i] = w;
      b.y[m][i] = own[2 * lanes], b.v[m][i] = 0.0;
      b.cosine[m][i] = __builtin_cos(phase), b.sine[m][i] = __builtin_sin(phase);
      for (int j = 0; j < 6; ++j) {
        b.turn_cosine[j][m][i] = __builtin_cos(w * NODES[j] * h), b.turn_sine[j][m][i] = __builtin_sin(w * NODES[j] * h);
      }
      out[(group + l) * (count + 1)] = own[2 * lanes];
    }
    for (long n = 0; n < count; n += TILE) {
      const long filled = count - n < TILE ? count - n : TILE;
      for (long i = 0; i < filled; ++i) {
        for (long s = 0; s < substeps; ++s) step(b, h, c);
        for (int m = 0; m < M; ++m) *(vd*)&tile[i][8 * m] = b.y[m];
      }
      for (int l = 0; l < LANES; ++l)
        for (long i = 0; i < filled; ++i) out[(group + l) * (count + 1) + 1 + n + i] = tile[i][l];
    }
  }
}
