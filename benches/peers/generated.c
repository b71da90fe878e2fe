/* Times code written for one robot; called by run.py, which compiles it for each.
 *
 *   peer STATES SECONDS DUMP      prints the least time per pass, ns
 *
 * Sinew's: -DJOINTS=n -DPASS=name_momentum -include name.h. CasADi's: -DJOINTS=n -DCASADI. Both give p, C^T dq and g.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#ifdef CASADI
#ifndef CASADI_WORK
#define CASADI_WORK 1
#endif
int casadi_pass(const double ** arg, double ** res, long long int * iw, double * w, int mem);
#endif

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

__attribute__((noinline)) static void pass(const double * q, const double * dq, double * p, double * ct_dq, double * g)
{
#ifdef CASADI
  static double work[CASADI_WORK];
  const double * arg[2 + 8] = {q, dq};
  double * res[3 + 8] = {p, ct_dq, g};
  casadi_pass(arg, res, NULL, work, 0);
#else
  PASS(q, dq, p, ct_dq, g);
#endif
}

int main(int argc, char ** argv)
{
  enum { n = JOINTS };
  if (argc != 4) return 2;
  FILE * in = fopen(argv[1], "r");
  if (!in) return 3;
  int c;
  while ((c = fgetc(in)) != '\n' && c != EOF) {}
  double * states = NULL;
  int count = 0;
  for (;;)
  {
    states = realloc(states, (size_t)(count + 1) * 2 * n * sizeof(double));
    int k = 0;
    while (k < 2 * n && fscanf(in, "%lf", &states[(size_t)count * 2 * n + k]) == 1) ++k;
    if (k < 2 * n) break;
    ++count;
  }
  fclose(in);
  double out[3 * n];
  FILE * dump = fopen(argv[3], "w");
  if (!dump || count == 0) return 3;
  for (int i = 0; i < count; ++i)
  {
    const double * s = states + (size_t)i * 2 * n;
    pass(s, s + n, out, out + n, out + 2 * n);
    for (int k = 0; k < 3 * n; ++k) fprintf(dump, "%.17g ", out[k]);
    fprintf(dump, "\n");
  }
  fclose(dump);

  const double end = now() + atof(argv[2]);
  double best = 1e300;
  while (now() < end)
  {
    const double start = now();
    for (int i = 0; i < count; ++i)
    {
      const double * s = states + (size_t)i * 2 * n;
      pass(s, s + n, out, out + n, out + 2 * n);
    }
    const double each = (now() - start) * 1e9 / count;
    if (each < best) best = each;
  }
  printf("%g\n", best);
  return 0;
}
