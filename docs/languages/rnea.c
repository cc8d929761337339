/* Inverse dynamics of a tree of revolute and prismatic joints by the recursive Newton-Euler algorithm.
   To build and judge it:

       graphdyn export ur5 --to model.h
       cc -O2 -fPIC -shared -o librnea.so rnea.c -lm
       graphdyn judge ur5 --library inverse_dynamics=librnea.so:rnea

   The option -DSIGN=-1 makes one sign wrong. */

#include <math.h>
#include "model.h"

#ifndef SIGN
#define SIGN 1
#endif

typedef struct { double x, y, z; } Vector;

static Vector vector(const double *x) { return (Vector){x[0], x[1], x[2]}; }
static Vector sum(Vector x, Vector y) { return (Vector){x.x + y.x, x.y + y.y, x.z + y.z}; }
static Vector times(double f, Vector x) { return (Vector){f * x.x, f * x.y, f * x.z}; }
static double dot(Vector x, Vector y) { return x.x * y.x + x.y * y.y + x.z * y.z; }
static Vector cross(Vector x, Vector y)
{
    return (Vector){x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x};
}
static Vector apply(const double m[3][3], Vector x)
{
    return (Vector){dot(vector(m[0]), x), dot(vector(m[1]), x), dot(vector(m[2]), x)};
}
static Vector apply_transposed(const double m[3][3], Vector x)
{
    return sum(sum(times(x.x, vector(m[0])), times(x.y, vector(m[1]))), times(x.z, vector(m[2])));
}
/* x rotated by an angle about a unit axis: Rodrigues' formula */
static Vector turned(Vector axis, double angle, Vector x)
{
    Vector along = times((1 - cos(angle)) * dot(axis, x), axis);
    return sum(sum(times(cos(angle), x), times(sin(angle), cross(axis, x))), along);
}

int rnea(int n, const double *q, const double *v, const double *a, double *tau)
{
    Vector zero = {0, 0, 0}, omega[N], alpha[N], acceleration[N], arm[N], force[N], moment[N];
    if (n != N) return 1;
    for (int j = 0; j < N; j++) { /* motion, from the base outwards, in link axes */
        int i = parent[j], slides = prismatic[j];
        double angle = slides ? 0 : q[j];
        Vector p = vector(axis[j]), c = vector(center_of_mass[j]), down = vector(gravity);
        Vector omega_i = i < 0 ? zero : omega[i], alpha_i = i < 0 ? zero : alpha[i];
        Vector from = i < 0 ? times(-1, apply_transposed(base_rotation, down)) : acceleration[i];
        arm[j] = sum(vector(translation[j]), apply(rotation[j], times(slides ? q[j] : 0, p)));
        from = sum(from, sum(cross(alpha_i, arm[j]), cross(omega_i, cross(omega_i, arm[j]))));
        from = turned(p, -angle, apply_transposed(rotation[j], from));
        Vector carried = turned(p, -angle, apply_transposed(rotation[j], omega_i));
        Vector rate = times(v[j], p);
        acceleration[j] = slides ? sum(from, sum(times(a[j], p), times(2, cross(carried, rate)))) : from;
        alpha[j] = turned(p, -angle, apply_transposed(rotation[j], alpha_i));
        omega[j] = carried;
        if (!slides) {
            alpha[j] = sum(alpha[j], sum(times(a[j], p), times(SIGN, cross(carried, rate))));
            omega[j] = sum(carried, rate);
        }
        Vector centripetal = cross(omega[j], cross(omega[j], c));
        force[j] = times(mass[j], sum(acceleration[j], sum(cross(alpha[j], c), centripetal)));
        Vector gyroscopic = cross(omega[j], apply(inertia[j], omega[j]));
        moment[j] = sum(sum(apply(inertia[j], alpha[j]), gyroscopic), cross(c, force[j]));
    }
    for (int j = N - 1; j >= 0; j--) { /* wrenches, back to the base */
        Vector p = vector(axis[j]);
        double angle = prismatic[j] ? 0 : q[j];
        tau[j] = dot(p, prismatic[j] ? force[j] : moment[j]);
        if (parent[j] >= 0) {
            Vector push = apply(rotation[j], turned(p, angle, force[j]));
            Vector twist = apply(rotation[j], turned(p, angle, moment[j]));
            force[parent[j]] = sum(force[parent[j]], push);
            moment[parent[j]] = sum(moment[parent[j]], sum(twist, cross(arm[j], push)));
        }
    }
    return 0;
}
