// Proves that the thread sanitizer sees OpenMP's threads: "clean" must pass, "racy" must be reported.
#include <cstdio>
#include <cstring>
#include <vector>

int main(int count, char** arguments) {
    const bool racy = count > 1 && std::strcmp(arguments[1], "racy") == 0;
    constexpr int kRows = 1000;
    std::vector<int> from(kRows, 1), to(kRows, 0);
    int shared = 0;
    for (int repeat = 0; repeat < 100; ++repeat) {
#pragma omp parallel for schedule(static) num_threads(4)
        for (int i = 0; i < kRows; ++i) {
            to[static_cast<std::size_t>(kRows - 1 - i)] = from[static_cast<std::size_t>(i)] + 1;
            if (racy) ++shared;
        }
        from.swap(to);
    }
    std::printf("%d %d\n", from[0], shared);
}
