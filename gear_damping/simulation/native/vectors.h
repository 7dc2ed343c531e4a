// A vector of lanes and the functions of it; glibc's vector library where it is there, else lane by lane.
#include <cmath>

typedef double vd __attribute__((vector_size(8 * WIDTH)));
typedef long long vm __attribute__((vector_size(8 * WIDTH)));

static inline bool any(vm m) {
  long long found = 0;
  for (int l = 0; l < WIDTH; ++l) found |= m[l];
  return found != 0;
}
static inline vd v_abs(vd a) { return a < 0.0 ? -a : a; }
static inline vd v_max(vd a, vd b) { return a > b ? a : b; }
static inline vd v_min(vd a, vd b) { return a < b ? a : b; }
static inline vd v_sign(vd a) { return a > 0.0 ? vd{} + 1.0 : (a < 0.0 ? vd{} - 1.0 : vd{}); }

#define LANE_BY_LANE(name, function) \
  static inline vd name(vd a) { vd r; for (int l = 0; l < WIDTH; ++l) r[l] = function(a[l]); return r; }
LANE_BY_LANE(v_sqrt, __builtin_sqrt)
LANE_BY_LANE(v_floor, std::floor)

#if defined(HAVE_LIBMVEC) && defined(__AVX512F__) && WIDTH == 8
#define VECTOR(name, function) extern "C" vd _ZGVeN8v_##function(vd); static inline vd name(vd a) { return _ZGVeN8v_##function(a); }
extern "C" vd _ZGVeN8vv_pow(vd, vd);
static inline vd v_pow(vd a, vd b) { return _ZGVeN8vv_pow(a, b); }
#elif defined(HAVE_LIBMVEC) && defined(__AVX2__) && WIDTH == 4
#define VECTOR(name, function) extern "C" vd _ZGVdN4v_##function(vd); static inline vd name(vd a) { return _ZGVdN4v_##function(a); }
extern "C" vd _ZGVdN4vv_pow(vd, vd);
static inline vd v_pow(vd a, vd b) { return _ZGVdN4vv_pow(a, b); }
#else
#define VECTOR(name, function) LANE_BY_LANE(name, std::function)
static inline vd v_pow(vd a, vd b) { vd r; for (int l = 0; l < WIDTH; ++l) r[l] = std::pow(a[l], b[l]); return r; }
#endif
VECTOR(v_cos, cos)
VECTOR(v_sin, sin)
VECTOR(v_exp, exp)
VECTOR(v_log, log)
LANE_BY_LANE(v_tanh, std::tanh)
LANE_BY_LANE(v_atan, std::atan)
