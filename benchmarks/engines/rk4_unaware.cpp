// Classical RK4 that takes the branch of every stage as it finds it: what a solver does that knows nothing of
// contact. The same traced equations, vectors and interleaving as the package's own driver.
struct Block {
  vd P[N_FIXED + 1], S[N_SERIES + 1], Q[N_KEPT + 1];
  double index;
};

static inline void rates_at(vd u, const vd* y, const Block& b, vd* out) {
  vd L[N_SWITCH + 1], g[N_SWITCH + 1];
  switches(u, y, b.P, b.S, b.index, L, b.Q, g);
  for (int w = 0; w < N_SWITCH; ++w) L[w] = g[w] >= 0.0 ? vd{} + 1.0 : vd{};
  rates(u, y, b.P, b.S, b.index, L, b.Q, out);
}

static inline void substep(vd (*y)[N_STATE], vd start, double length, const Block* b) {
  static const double NODE[4] = {0.0, 0.5, 0.5, 1.0}, WEIGHT[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  vd k[VECTORS][N_STATE], sum[VECTORS][N_STATE], inner[N_STATE];
#pragma GCC unroll 4
  for (int stage = 0; stage < 4; ++stage)
#pragma GCC unroll 4
    for (int m = 0; m < VECTORS; ++m) {
      for (int i = 0; i < N_STATE; ++i)
        inner[i] = stage == 0 ? y[m][i] : y[m][i] + NODE[stage] * length * k[m][i];
      rates_at(start + NODE[stage] * length, inner, b[m], k[m]);
      for (int i = 0; i < N_STATE; ++i)
        sum[m][i] = (stage == 0 ? vd{} : sum[m][i]) + WEIGHT[stage] * k[m][i];
    }
  for (int m = 0; m < VECTORS; ++m)
    for (int i = 0; i < N_STATE; ++i) y[m][i] += length * sum[m][i];
}

static inline vd load(const double* rows, long batch, long row, long member) {
  vd v;
  for (int l = 0; l < WIDTH; ++l) v[l] = rows[row * batch + (member + l < batch ? member + l : batch - 1)];
  return v;
}

// out (N_STATE, batch, length) gets `count` outputs; members that fill no group are repeated.
extern "C" void walk(long batch, long count, long substeps, long length, const double* fixed, const double* state,
                     double* out) {
  const double part = 1.0 / double(substeps);
  for (long group = 0; group < batch; group += WIDTH * VECTORS) {
    Block b[VECTORS];
    vd y[VECTORS][N_STATE];
    for (int m = 0; m < VECTORS; ++m) {
      const long member = group + m * WIDTH;
      for (int i = 0; i < N_FIXED; ++i) b[m].P[i] = load(fixed, batch, i, member);
      for (int i = 0; i < N_STATE; ++i) y[m][i] = load(state, batch, i, member);
      setup(b[m].P, b[m].Q);
    }
    for (long n = 0; n < count; ++n) {
      for (int m = 0; m < VECTORS; ++m) b[m].index = double(n);
      for (long s = 0; s < substeps; ++s) substep(y, vd{} + double(s) * part, part, b);
      for (int m = 0; m < VECTORS; ++m)
        for (int i = 0; i < N_STATE; ++i)
          for (int l = 0; l < WIDTH && group + m * WIDTH + l < batch; ++l)
            out[(i * batch + group + m * WIDTH + l) * length + n] = y[m][i][l];
    }
  }
}
