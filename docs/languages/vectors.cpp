// Compares a function with a file of test vectors. To build and run it:
//
//     graphdyn vectors ur5 --out vectors
//     c++ -O2 -o vectors_cpp vectors.cpp librnea.so -Wl,-rpath,. && ./vectors_cpp     (librnea.so: see rnea.c)

#include <cmath>
#include <fstream>
#include <iostream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

using Numbers = std::vector<double>;

// Counts the rows with a number beyond its tolerance; -1 if the file cannot be read.
int failures(const std::string &path, std::size_t arguments, std::function<Numbers(const Numbers &)> f)
{
    std::ifstream file(path);
    std::string line, cell;
    if (!std::getline(file, line)) return -1; // the header
    int failed = 0;
    while (std::getline(file, line)) {
        Numbers row;
        for (std::istringstream cells(line); std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
        const Numbers answer = f({row.begin(), row.begin() + arguments});
        bool right = 2 * answer.size() == row.size() - arguments;
        for (std::size_t k = 0; right && k < answer.size(); ++k) // written so that NaN is wrong
            right = std::abs(answer[k] - row[arguments + k]) <= row[arguments + answer.size() + k];
        failed += !right;
    }
    return failed;
}

extern "C" int rnea(int n, const double *q, const double *v, const double *a, double *tau);

int main()
{
    const int failed = failures("vectors/inverse_dynamics.csv", 18, [](const Numbers &x) {
        Numbers tau(6);
        rnea(6, &x[0], &x[6], &x[12], &tau[0]);
        return tau;
    });
    std::cout << "inverse_dynamics: " << failed << " rows fail\n";
    return failed != 0;
}
