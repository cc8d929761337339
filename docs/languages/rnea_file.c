/* Reads questions from a file and writes the answers of rnea.c. To build, run and judge it:

       graphdyn questions ur5 --for inverse_dynamics --out questions.csv
       cc -O2 -o rnea_file rnea_file.c rnea.c -lm
       ./rnea_file < questions.csv > answers.csv
       graphdyn judge ur5 --answers answers.csv */

#include <stdio.h>
#include "model.h"

int rnea(int n, const double *q, const double *v, const double *a, double *tau);

int main(void)
{
    long long id;
    double x[3 * N], tau[N]; /* q, v, a */
    if (scanf("%*[^\n]") == EOF) return 1; /* the header */
    while (scanf("%lld,%*[^,]", &id) == 1) { /* id and name of the function */
        for (int k = 0; k < 3 * N; k++)
            if (scanf(",%lf", &x[k]) != 1) return 1;
        rnea(N, x, x + N, x + 2 * N, tau);
        printf("%lld", id);
        for (int k = 0; k < N; k++) printf(",%.17g", tau[k]);
        printf("\n");
    }
    return 0;
}
