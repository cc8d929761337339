/* Compares a function with a file of test vectors. To build and run it:

       graphdyn vectors ur5 --out vectors
       graphdyn export ur5 --to model.h
       cc -O2 -o vectors_c vectors.c rnea.c -lm && ./vectors_c

   It reads vectors/inverse_dynamics_exact.csv of graphdyn vectors --digits alike, as the nearest doubles: ./vectors_c
   vectors/inverse_dynamics_exact.csv */

#include <math.h>
#include <stdio.h>

typedef int Function(const double *arguments, double *answer);

/* Counts the rows with a number beyond its tolerance; -1 if the file cannot be read. */
int failures(const char *path, int arguments, int numbers, Function *f)
{
    double row[arguments + 2 * numbers], answer[numbers];
    int failed = 0, k;
    FILE *file = fopen(path, "r");
    if (!file || fscanf(file, "%*[^\n]") == EOF) return -1; /* the header */
    for (;;) {
        for (k = 0; k < arguments + 2 * numbers && fscanf(file, "%lf%*[,]", &row[k]) == 1; k++) {}
        if (k < arguments + 2 * numbers) break;
        int wrong = f(row, answer) != 0;
        for (k = 0; k < numbers; k++) /* written so that NaN is wrong */
            if (!(fabs(answer[k] - row[arguments + k]) <= row[arguments + numbers + k])) wrong = 1;
        failed += wrong;
    }
    fclose(file);
    return failed;
}

int rnea(int n, const double *q, const double *v, const double *a, double *tau);
static int ur5(const double *x, double *tau) { return rnea(6, x, x + 6, x + 12, tau); }

int main(int argc, char **argv)
{
    int failed = failures(argc > 1 ? argv[1] : "vectors/inverse_dynamics.csv", 18, 6, ur5);
    printf("inverse_dynamics: %d rows fail\n", failed);
    return failed != 0;
}
