/* The experiment of benchmarks/sweep.py as a scalar C program: Eqs. 8, 11, 17, 25, 45 on the circle,
   with all metrics of iterations.csv.

   Usage: scalar L1 L2 L3 REPEATS [none|uniform|normal [SEED STATE_BOUND OUTPUT_BOUND]]

   The disturbances are those of hilc_cli/disturbance: Philox 4x32-10, and the normal cut off at two
   standard deviations, here by Wichura's AS 241. Prints nanoseconds of processor time a sample and
   the last maximum error. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 100, STEPS = 2000 };
enum { NONE, UNIFORM, NORMAL };
enum { STATE, OUTPUT };

static double xd[STEPS + 1], yd[STEPS + 1], hd[STEPS + 1];
static double left[STEPS], right[STEPS];
static double ex[STEPS + 1], ey[STEPS + 1], eh[STEPS + 1];
static uint64_t seed;
static double inside, below;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* The standard normal number; centre = probability - 1/2, tail = 1/2 - |centre|. */
static double quantile(double centre, double tail) {
  if (fabs(centre) <= 0.425) {
    double r = 0.180625 - centre * centre;
    return centre *
      (((((((2.5090809287301226727e3 * r + 3.3430575583588128105e4) * r + 6.7265770927008700853e4) * r
      + 4.5921953931549871457e4) * r + 1.3731693765509461125e4) * r + 1.9715909503065514427e3) * r
      + 1.3314166789178437745e2) * r + 3.3871328727963666080e0) /
      (((((((5.2264952788528545610e3 * r + 2.8729085735721942674e4) * r + 3.9307895800092710610e4) * r
      + 2.1213794301586595867e4) * r + 5.3941960214247511077e3) * r + 6.8718700749205790830e2) * r
      + 4.2313330701600911252e1) * r + 1.0);
  }
  double r = sqrt(-log(tail)) - 1.6;
  double z =
    (((((((7.74545014278341407640e-4 * r + 2.27238449892691845833e-2) * r
    + 2.41780725177450611770e-1) * r + 1.27045825245236838258e0) * r + 3.64784832476320460504e0) * r
    + 5.76949722146069140550e0) * r + 4.63033784615654529590e0) * r + 1.42343711074968357734e0) /
    (((((((1.05075007164441684324e-9 * r + 5.47593808499534494600e-4) * r
    + 1.51986665636164571966e-2) * r + 1.48103976427480074590e-1) * r + 6.89767334985100004550e-1) * r
    + 1.67638483018380384940e0) * r + 2.05319162663775882187e0) * r + 1.0);
  return centre < 0 ? -z : z;
}

static inline double scaled(uint32_t word, int kind, double bound) {
  double centred = (word + 0.5) * 0x1p-31 - 1;
  if (kind == UNIFORM) return bound * centred;
  double z = bound / 2 * quantile(centred * inside, below + (1 - fabs(centred)) * inside);
  return fmin(fmax(z, -bound), bound);
}

static inline void draw(int kind, int stream, int pass, int sample, double bound, double *offset) {
  uint32_t c0 = sample, c1 = pass, c2 = stream, c3 = 0, k0 = seed, k1 = seed >> 32;
  for (int i = 0; i < 10; i++) {
    uint64_t p0 = 0xD2511F53ull * c0, p1 = 0xCD9E8D57ull * c2;
    c0 = (uint32_t)(p1 >> 32) ^ c1 ^ k0, c1 = p1, c2 = (uint32_t)(p0 >> 32) ^ c3 ^ k1, c3 = p0;
    k0 += 0x9E3779B9, k1 += 0xBB67AE85;
  }
  offset[0] = scaled(c0, kind, bound);
  offset[1] = scaled(c1, kind, bound);
  offset[2] = scaled(c2, kind, bound);
}

/* All iterations; a copy for each kind of disturbance, so that the compiler removes what is not. */
static inline __attribute__((always_inline)) double run(
    const int kind, double l1, double l2, double l3, double state_bound, double output_bound,
    double *sink) {
  const double dt = 0.001, R = 0.2, B = 0.518, limit = 180;
  double last = 0;
  for (int i = 0; i <= N; i++) {
    double x = 10, y = 0, h = M_PI / 2, bx = 0, by = 0, bh = 0;
    double largest = 0, sum = 0, squares = 0, lx = 0, ly = 0, lh = 0, fastest = 0, change = 0;
    double alpha[3] = {0, 0, 0}, beta[3];
    int saturated = 0;
    if (kind != NONE) draw(kind, OUTPUT, i, 0, output_bound, alpha);
    double a = xd[0] - x, b = yd[0] - y, c = hd[0] - h;
    for (int k = 0; k < STEPS; k++) {
      double cs = cos(h), sn = sin(h), demand_l = left[k], demand_r = right[k];
      double square = a * a + b * b, error = sqrt(square);
      if (error > largest) largest = error;
      sum += error, squares += square;
      lx = fmax(lx, fabs(a)), ly = fmax(ly, fabs(b)), lh = fmax(lh, fabs(c));
      double gain_cs = cs, gain_sn = sn;
      if (kind != NONE) {
        gain_cs = cos(h + alpha[2]), gain_sn = sin(h + alpha[2]);
        a -= alpha[0], b -= alpha[1], c -= alpha[2];
      }
      if (i > 0) {
        double tx = l1 * ex[k + 1] + l2 * a + l3 * bx;
        double ty = l1 * ey[k + 1] + l2 * b + l3 * by;
        double th = l1 * eh[k + 1] + l2 * c + l3 * bh;
        double along = (gain_cs * tx + gain_sn * ty) / R, turning = B * th / R;
        demand_l += along + turning, demand_r += along - turning;
      }
      bx = a, by = b, bh = c;
      ex[k] = a, ey[k] = b, eh[k] = c;
      double wl = demand_l, wr = demand_r, most = fmax(fabs(wl), fabs(wr));
      if (most > limit) wl *= limit / most, wr *= limit / most, saturated++;
      fastest = fmax(fastest, fmax(fabs(wl), fabs(wr)));
      change += (wl - left[k]) * (wl - left[k]) + (wr - right[k]) * (wr - right[k]);
      left[k] = wl, right[k] = wr;
      double distance = dt * R * (wl + wr) / 2;
      x += distance * cs, y += distance * sn, h += dt * R * (wl - wr) / (2 * B);
      if (kind != NONE) {
        draw(kind, STATE, i, k, state_bound, beta);
        x += beta[0], y += beta[1], h += beta[2];
        draw(kind, OUTPUT, i, k + 1, output_bound, alpha);
      }
      a = xd[k + 1] - x, b = yd[k + 1] - y, c = hd[k + 1] - h;
    }
    double error = sqrt(a * a + b * b);
    if (error > largest) largest = error;
    ex[STEPS] = a - alpha[0], ey[STEPS] = b - alpha[1], eh[STEPS] = c - alpha[2];
    last = largest;
    *sink += sum + squares + lx + ly + lh + fastest + change + saturated;
  }
  return last;
}

int main(int argc, char **argv) {
  const double l1 = atof(argv[1]), l2 = atof(argv[2]), l3 = atof(argv[3]);
  const int repeats = atoi(argv[4]);
  const char *name = argc > 5 ? argv[5] : "none";
  const int kind = !strcmp(name, "uniform") ? UNIFORM : !strcmp(name, "normal") ? NORMAL : NONE;
  double best = 1e9, last = 0, sink = 0, state_bound = 0, output_bound = 0;
  if (argc > 8) seed = strtoull(argv[6], 0, 10), state_bound = atof(argv[7]), output_bound = atof(argv[8]);
  inside = 0.5 * erf(sqrt(2)), below = 0.5 * erfc(sqrt(2));
  for (int k = 0; k <= STEPS; k++) {
    double angle = 2 * M_PI * k / STEPS;
    xd[k] = 10 * cos(angle), yd[k] = 10 * sin(angle), hd[k] = angle + M_PI / 2;
  }
  for (int repeat = 0; repeat < repeats; repeat++) {
    for (int k = 0; k < STEPS; k++) left[k] = right[k] = 0;
    for (int k = 0; k <= STEPS; k++) ex[k] = ey[k] = eh[k] = 0;
    double start = now();
    if (kind == UNIFORM) last = run(UNIFORM, l1, l2, l3, state_bound, output_bound, &sink);
    else if (kind == NORMAL) last = run(NORMAL, l1, l2, l3, state_bound, output_bound, &sink);
    else last = run(NONE, l1, l2, l3, 0, 0, &sink);
    double taken = now() - start;
    if (taken < best) best = taken;
  }
  printf("%.6g %.17g %g\n", best / ((N + 1.0) * STEPS) * 1e9, last, sink * 0);
  return 0;
}
