// Walks members over output intervals with the active-branch method of Tsitouras (see stepper.py, which
// does the same in PyTorch). Above this text stand: WIDTH, VECTORS, N_STATE, N_FIXED, N_SERIES, N_SWITCH, N_KEPT,
// the vector types and functions, the method's N_STAGE, NODES, STAGES and WEIGHTS, what crossings are searched with
// (WATCHED, REACH, MOST_SHIFT, SAME_INSTANT, ROOT_STEPS, MOST_SPLITS), and the traced functions setup, rates and
// switches. No number of the method stands here a second time: tests/simulation/test_native_kernels.py reads them.

struct Block {
  vd P[N_FIXED + 1], S[N_SERIES + 1], L[N_SWITCH + 1], Q[N_KEPT + 1], factor[N_SERIES + 1];
  long source[WIDTH];
  double index;
};

static const int TILE = 8;  // outputs that are kept until they fill a line of the cache

static inline void rates_at(vd u, const vd* y, const Block& b, const vd* L, vd* out) {
  rates(u, y, b.P, b.S, b.index, L, b.Q, out);
}

// One member vector's part in a step.
struct Task {
  const vd* y;
  const Block* block;
  const vd* L;
  vd *end, *first;
};

// A stage waits for the one before it: M vectors at once keep the processor busy meanwhile.
template <int M>
static inline void step(const Task* task, vd start, vd length) {
  vd k[M][N_STAGE][N_STATE], inner[N_STATE];
#pragma GCC unroll 6
  for (int stage = 0; stage < N_STAGE; ++stage)
#pragma GCC unroll 4
    for (int m = 0; m < M; ++m) {
      for (int i = 0; i < N_STATE; ++i) {
        vd sum = vd{};
        for (int j = 0; j < stage; ++j) sum += STAGES[stage][j] * k[m][j][i];
        inner[i] = task[m].y[i] + length * sum;
      }
      rates_at(start + NODES[stage] * length, inner, *task[m].block, task[m].L, k[m][stage]);
    }
  for (int m = 0; m < M; ++m)
    for (int i = 0; i < N_STATE; ++i) {
      vd sum = vd{};
      for (int j = 0; j < N_STAGE; ++j) sum += WEIGHTS[j] * k[m][j][i];
      task[m].end[i] = task[m].y[i] + length * sum;
      task[m].first[i] = k[m][0][i];
    }
}

#if N_SWITCH > 0
static inline void signed_switches(vd u, const vd* y, const Block& b, const vd* L, vd* out) {
  switches(u, y, b.P, b.S, b.index, L, b.Q, out);
  for (int w = 0; w < N_SWITCH; ++w) out[w] *= 2.0 * L[w] - 1.0;
}

static inline vd margin(vd u, const vd* y, const Block& b, const vd* L) {
  vd g[N_SWITCH];
  signed_switches(u, y, b, L, g);
  vd least = g[0];
  for (int w = 1; w < N_SWITCH; ++w) least = v_min(least, g[w]);
  return least;
}

struct Ends {
  vd start[N_STATE], end[N_STATE], first[N_STATE], last[N_STATE];
};

static inline vd margin_inside(vd part, vd start, vd length, const Ends& e, const Block& b, const vd* L) {
  const vd rest = 1.0 - part;
  vd inner[N_STATE];
  for (int i = 0; i < N_STATE; ++i)
    inner[i] = (1.0 + 2.0 * part) * rest * rest * e.start[i] + part * part * (3.0 - 2.0 * part) * e.end[i] +
               length * (part * rest * rest * e.first[i] - part * part * rest * e.last[i]);
  return margin(start + part * length, inner, b, L);
}

// The smallest margin met in a step that was taken.
static inline vd margin_of_step(vd start, vd length, const Block& b, const vd* L, Ends& e) {
  rates_at(start + length, e.end, b, L, e.last);
  vd least = margin(start + length, e.end, b, L);
  for (double part : WATCHED) least = v_min(least, margin_inside(vd{} + part, start, length, e, b, L));
  return least;
}

static inline vd advance(vd start, vd length, const Block& b, const vd* L, Ends& e) {
  const Task task{e.start, &b, L, e.end, e.first};
  step<1>(&task, start, length);
  return margin_of_step(start, length, b, L, e);
}

static inline vd secant(vd low, vd high, vd at_low, vd at_high) {
  const vd width = at_low - at_high;
  return low + (high - low) * at_low / (width > 0.0 ? width : vd{} + 1.0);
}

static inline vd root(vd start, vd length, const Ends& e, const Block& b, const vd* L) {
  vd low = vd{}, high = vd{} + 1.0;
  vd at_low = v_max(margin_inside(low, start, length, e, b, L), vd{});
  vd at_high = margin_inside(high, start, length, e, b, L);
  for (int i = 1; i >= 0; --i) {
    const vd inside = vd{} + WATCHED[i], value = margin_inside(inside, start, length, e, b, L);
    const vm left = value < 0.0;
    high = left ? inside : high;
    at_high = left ? value : at_high;
  }
  for (double part : WATCHED) {
    const vd inside = vd{} + part, value = margin_inside(inside, start, length, e, b, L);
    const vm kept = inside < high;
    low = kept ? inside : low;
    at_low = kept ? v_max(value, vd{}) : at_low;
  }
  for (int i = 0; i < ROOT_STEPS; ++i) {
    const vd middle = secant(low, high, at_low, at_high), value = margin_inside(middle, start, length, e, b, L);
    const vm left = value < 0.0;
    at_low = left ? at_low / 2.0 : value;
    at_high = left ? value : at_high / 2.0;
    low = left ? low : middle;
    high = left ? middle : high;
  }
  return secant(low, high, at_low, at_high);
}

// The first crossing of a step: its state and position, and the branch behind it, for members in `crossed`.
static inline void cross(Ends& e, vd& start, vd length, const Block& b, vd* L, vm crossed) {
  const vd part = root(start, length, e, b, L);
  vd y[N_STATE], slope[N_STATE], ahead[N_STATE], here[N_SWITCH], there[N_SWITCH];
  const Task task{e.start, &b, L, y, slope};
  step<1>(&task, start, part * length);
  const vd position = start + part * length, reach = REACH * length;
  rates_at(position, y, b, L, slope);
  for (int i = 0; i < N_STATE; ++i) ahead[i] = y[i] + reach * slope[i];
  signed_switches(position, y, b, L, here);
  signed_switches(position + reach, ahead, b, L, there);
  vd value = here[0], change = there[0] - here[0];
  for (int w = 1; w < N_SWITCH; ++w) {
    const vm less = here[w] < value;
    value = less ? here[w] : value;
    change = less ? there[w] - here[w] : change;
  }
  vd shift = change != 0.0 ? -value / (change == 0.0 ? vd{} + 1.0 : change) * reach : vd{};
  shift = v_min(v_max(shift, -MOST_SHIFT * part * length), MOST_SHIFT * (1.0 - part) * length);
  for (int i = 0; i < N_STATE; ++i) e.start[i] = crossed ? y[i] + shift * slope[i] : e.start[i];
  start = crossed ? position + shift : start;
  for (int w = 0; w < N_SWITCH; ++w) {
    const vd turn = there[w] - here[w];
    const vm turning = crossed & (turn < 0.0) & ((here[w] <= value) | (here[w] < SAME_INSTANT * v_abs(turn)));
    L[w] = turning ? 1.0 - L[w] : L[w];
  }
}

static inline void split(vd start, vd length, Block& b, Ends& e, vm crossed) {
  const vd stop = start + length;
  const vm ours = crossed;
  Ends work = e;
  vd L[N_SWITCH];
  for (int w = 0; w < N_SWITCH; ++w) L[w] = b.L[w];
  for (int i = 0; i < MOST_SPLITS && any(crossed); ++i) {
    cross(work, start, stop - start, b, L, crossed);
    crossed = ours & (advance(start, stop - start, b, L, work) < 0.0);
  }
  for (int i = 0; i < N_STATE; ++i) e.end[i] = ours ? work.end[i] : e.end[i];
  for (int w = 0; w < N_SWITCH; ++w) b.L[w] = ours ? L[w] : b.L[w];
}
#endif

template <int M>
static inline void substep(vd (*y)[N_STATE], vd start, vd length, Block* b) {
  Task tasks[M];
#if N_SWITCH > 0
  Ends e[M];
  for (int m = 0; m < M; ++m) {
    for (int i = 0; i < N_STATE; ++i) e[m].start[i] = y[m][i];
    tasks[m] = Task{e[m].start, &b[m], b[m].L, e[m].end, e[m].first};
  }
  step<M>(tasks, start, length);
  for (int m = 0; m < M; ++m) {
    const vm crossed = margin_of_step(start, length, b[m], b[m].L, e[m]) < 0.0;
    if (any(crossed)) split(start, length, b[m], e[m], crossed);
    for (int i = 0; i < N_STATE; ++i) y[m][i] = e[m].end[i];
  }
#else
  vd end[M][N_STATE], first[N_STATE];
  for (int m = 0; m < M; ++m) tasks[m] = Task{y[m], &b[m], b[m].L, end[m], first};
  step<M>(tasks, start, length);
  for (int m = 0; m < M; ++m)
    for (int i = 0; i < N_STATE; ++i) y[m][i] = end[m][i];
#endif
}

// Members of row `row` of a (rows, batch) array; past the end the last member is repeated.
static inline vd load(const double* rows, long batch, long row, long member) {
  vd v;
  for (int l = 0; l < WIDTH; ++l) v[l] = rows[row * batch + (member + l < batch ? member + l : batch - 1)];
  return v;
}

// Which series drive the batch of a vector, and what they are multiplied with.
static inline void choose_series(Block& b, const long* source, const double* factor, long batch, long member) {
  for (int l = 0; l < WIDTH; ++l) b.source[l] = source[member + l < batch ? member + l : batch - 1];
  for (int i = 0; i < N_SERIES; ++i) b.factor[i] = load(factor, batch, i, member);
}

// Those series in the interval whose rows (N_SERIES, sources) these are.
static inline void drive(Block& b, const double* rows, long sources) {
  for (int i = 0; i < N_SERIES; ++i) {
    vd v;
    for (int l = 0; l < WIDTH; ++l) v[l] = rows[i * sources + b.source[l]];
    b.S[i] = v * b.factor[i];
  }
}

static inline void store(double* rows, long batch, long row, long member, vd v) {
  for (int l = 0; l < WIDTH && member + l < batch; ++l) rows[row * batch + member + l] = v[l];
}

// The last `count` outputs of a vector into its rows of out (N_STATE, batch, length), from `first` on.
static inline void flush(double* out, long length, long batch, long member, long first, int count, vd (*kept)[N_STATE]) {
  for (int i = 0; i < N_STATE; ++i)
    for (int l = 0; l < WIDTH && member + l < batch; ++l) {
      double* row = out + (i * batch + member + l) * length + first;
      for (int n = 0; n < count; ++n) row[n] = kept[n][i][l];
    }
}

// The rate of the velocity at the end of an interval, natural units: row 0 of P is the interval.
__attribute__((noinline)) static vd acceleration_of(const vd* y, const Block& b) {
  vd out[N_STATE];
  rates_at(vd{} + 1.0, y, b, b.L, out);
  return out[1] / b.P[0];
}

// Walks the M vectors of members from `group` on; arguments as for `walk`.
template <int M>
static void walk_group(long batch, long group, long first, long count, long substeps, long length, long sources,
                       const double* fixed, const double* series, const long* source, const double* factor,
                       double* state, double* branch, double* out, double* acceleration) {
  const double part = 1.0 / double(substeps);
  Block b[M];
  vd y[M][N_STATE], kept[M][TILE][N_STATE];
  for (int m = 0; m < M; ++m) {
    const long member = group + m * WIDTH;
    for (int i = 0; i < N_FIXED; ++i) b[m].P[i] = load(fixed, batch, i, member);
    for (int i = 0; i < N_STATE; ++i) y[m][i] = load(state, batch, i, member);
    for (int w = 0; w < N_SWITCH; ++w) b[m].L[w] = load(branch, batch, w, member);
    setup(b[m].P, b[m].Q);
    choose_series(b[m], source, factor, batch, member);
  }
  for (long n = 0; n < count; ++n) {
    for (int m = 0; m < M; ++m) {
      b[m].index = double(first + n);
      drive(b[m], series + (first + n) * N_SERIES * sources, sources);
    }
    for (long s = 0; s < substeps; ++s) substep<M>(y, vd{} + double(s) * part, vd{} + part, b);
    const int place = n % TILE;
    for (int m = 0; m < M; ++m) {
      for (int i = 0; i < N_STATE; ++i) kept[m][place][i] = y[m][i];
      if (place == TILE - 1 || n == count - 1)
        flush(out, length, batch, group + m * WIDTH, n - place, place + 1, kept[m]);
      if (acceleration) {
        const long member = group + m * WIDTH;
        const vd now = acceleration_of(y[m], b[m]);
        for (int l = 0; l < WIDTH && member + l < batch; ++l) acceleration[(member + l) * length + n] = now[l];
      }
    }
  }
  for (int m = 0; m < M; ++m) {
    const long member = group + m * WIDTH;
    for (int i = 0; i < N_STATE; ++i) store(state, batch, i, member, y[m][i]);
    for (int w = 0; w < N_SWITCH; ++w) store(branch, batch, w, member, b[m].L[w]);
  }
}

// fixed (N_FIXED, batch); series (intervals, N_SERIES, sources), of which source (batch) drives each member times factor
// (N_SERIES, batch); state (N_STATE, batch) and branch (N_SWITCH, batch) are read and left at the last interval; out (N_STATE, batch, length) gets `count` outputs.
// acceleration (batch, length), where not null, gets the rate of the velocity at the same outputs.
// Members `from` to `to` are whole groups of VECTORS vectors, but for the last ones of all.
extern "C" void walk(long batch, long from, long to, long first, long count, long substeps, long length, long sources,
                     const double* fixed, const double* series, const long* source, const double* factor,
                     double* state, double* branch, double* out, double* acceleration) {
  for (long group = from; group < to; group += WIDTH * VECTORS) {
    // a second vector of nothing but repeated members would cost as much as the first
    const auto walked = VECTORS > 1 && batch - group <= WIDTH ? walk_group<1> : walk_group<VECTORS>;
    walked(batch, group, first, count, substeps, length, sources, fixed, series, source, factor, state, branch, out,
           acceleration);
  }
}
