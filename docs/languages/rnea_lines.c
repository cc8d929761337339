/* Answers every line of numbers with a line of numbers, by rnea.c. To build and judge it:

       cc -O2 -o rnea_lines rnea_lines.c rnea.c -lm
       graphdyn judge ur5 --command inverse_dynamics=./rnea_lines */

#include <stdio.h>
#include "model.h"

int rnea(int n, const double *q, const double *v, const double *a, double *tau);

int main(void)
{
    double x[3 * N], tau[N]; /* q, v, a */
    for (;;) {
        for (int k = 0; k < 3 * N; k++)
            if (scanf("%lf", &x[k]) != 1) return 0;
        rnea(N, x, x + N, x + 2 * N, tau);
        for (int k = 0; k < N; k++) printf("%.17g ", tau[k]);
        printf("\n");
#ifndef HOLD_BACK
        fflush(stdout); /* otherwise the answers stay in a buffer */
#endif
    }
}
