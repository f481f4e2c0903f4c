#include <cstdio>

#include <carom/carom.hpp>

int main() {
    if (carom::version() != carom::kVersion) return 1;
    std::printf("carom %s\n", carom::version().data());
}
