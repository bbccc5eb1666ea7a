/* The experiment of benchmarks/batch.py as a scalar C program: Eqs. 8, 17, 25, 45 on the circle,
   with all metrics of iterations.csv. Prints nanoseconds a sample and the last maximum error. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { N = 100, STEPS = 2000 };

static double xd[STEPS + 1], yd[STEPS + 1], hd[STEPS + 1];
static double left[STEPS], right[STEPS];
static double ex[STEPS + 1], ey[STEPS + 1], eh[STEPS + 1];

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv) {
  const double dt = 0.001, R = 0.2, B = 0.518, limit = 180;
  const double l1 = atof(argv[1]), l2 = atof(argv[2]), l3 = atof(argv[3]);
  const int repeats = atoi(argv[4]);
  double best = 1e9, last = 0, sink = 0;
  for (int k = 0; k <= STEPS; k++) {
    double angle = 2 * M_PI * k / STEPS;
    xd[k] = 10 * cos(angle), yd[k] = 10 * sin(angle), hd[k] = angle + M_PI / 2;
  }
  for (int repeat = 0; repeat < repeats; repeat++) {
    for (int k = 0; k < STEPS; k++) left[k] = right[k] = 0;
    for (int k = 0; k <= STEPS; k++) ex[k] = ey[k] = eh[k] = 0;
    double start = now();
    for (int i = 0; i <= N; i++) {
      double x = 10, y = 0, h = M_PI / 2, bx = 0, by = 0, bh = 0;
      double largest = 0, sum = 0, squares = 0, lx = 0, ly = 0, lh = 0, fastest = 0, change = 0;
      int saturated = 0;
      double a = xd[0] - x, b = yd[0] - y, c = hd[0] - h;
      for (int k = 0; k < STEPS; k++) {
        double cs = cos(h), sn = sin(h), demand_l = left[k], demand_r = right[k];
        double square = a * a + b * b, error = sqrt(square);
        if (error > largest) largest = error;
        sum += error, squares += square;
        lx = fmax(lx, fabs(a)), ly = fmax(ly, fabs(b)), lh = fmax(lh, fabs(c));
        if (i > 0) {
          double tx = l1 * ex[k + 1] + l2 * a + l3 * bx;
          double ty = l1 * ey[k + 1] + l2 * b + l3 * by;
          double th = l1 * eh[k + 1] + l2 * c + l3 * bh;
          double along = (cs * tx + sn * ty) / R, turning = B * th / R;
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
        a = xd[k + 1] - x, b = yd[k + 1] - y, c = hd[k + 1] - h;
      }
      ex[STEPS] = a, ey[STEPS] = b, eh[STEPS] = c;
      double error = sqrt(a * a + b * b);
      if (error > largest) largest = error;
      last = largest;
      sink += sum + squares + lx + ly + lh + fastest + change + saturated;
    }
    double taken = now() - start;
    if (taken < best) best = taken;
  }
  printf("%.6g %.17g %g\n", best / ((N + 1.0) * STEPS) * 1e9, last, sink * 0);
  return 0;
}
