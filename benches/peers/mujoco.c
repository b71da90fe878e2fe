/* Times MuJoCo's C path to p, g and C dq; called by run.py.
 *
 *   peer-mujoco ROBOT.mjb STATES SECONDS DUMP      prints the least time per pass, ns
 *
 * Positions, inertia matrix, p = M dq, bias, and the bias at rest, which is g. MuJoCo offers no
 * C^T dq: what it does here is less than the other two do. States are in the order of its dofs.
 */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

__attribute__((noinline)) static void pass(
  const mjModel * m, mjData * d, const double * q, const double * dq, double * p, double * bias, double * g)
{
  memcpy(d->qpos, q, m->nq * sizeof(double));
  memset(d->qvel, 0, m->nv * sizeof(double));
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_makeM(m, d);
  mj_mulM(m, d, p, dq);
  mj_comVel(m, d);
  mj_rne(m, d, 0, g);
  memcpy(d->qvel, dq, m->nv * sizeof(double));
  mj_comVel(m, d);
  mj_rne(m, d, 0, bias);
}

int main(int argc, char ** argv)
{
  if (argc != 5) return 2;
  mjModel * m = mj_loadModel(argv[1], NULL);
  if (!m) return 3;
  mjData * d = mj_makeData(m);
  const int n = m->nv;
  FILE * in = fopen(argv[2], "r");
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
  double * out = calloc((size_t)3 * n, sizeof(double));
  FILE * dump = fopen(argv[4], "w");
  if (!dump || count == 0) return 3;
  for (int i = 0; i < count; ++i)
  {
    const double * s = states + (size_t)i * 2 * n;
    pass(m, d, s, s + n, out, out + n, out + 2 * n);
    for (int k = 0; k < 3 * n; ++k) fprintf(dump, "%.17g ", out[k]);
    fprintf(dump, "\n");
  }
  fclose(dump);

  const double end = now() + atof(argv[3]);
  const int repeats = 1; // batches well under a time slice: the least one is undisturbed
  double best = 1e300;
  while (now() < end)
  {
    const double start = now();
    for (int k = 0; k < repeats; ++k)
      for (int i = 0; i < count; ++i)
      {
        const double * s = states + (size_t)i * 2 * n;
        pass(m, d, s, s + n, out, out + n, out + 2 * n);
      }
    const double each = (now() - start) * 1e9 / ((double)repeats * count);
    if (each < best) best = each;
  }
  printf("%g\n", best);
  return 0;
}
