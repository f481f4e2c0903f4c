#include "parallel/executor.hpp"

#if defined(__linux__) && defined(_OPENMP) && defined(__GNUC__) && !defined(__clang__)
#define CAROM_TEST_ONE_PROCESSOR
#include <sched.h>
#endif

#include <doctest/doctest.h>

#include <chrono>
#include <vector>

namespace {

struct Chunk {
    std::size_t first, last;
    bool operator==(const Chunk&) const = default;
};

std::vector<Chunk> chunks_of(const carom::Executor& executor, std::size_t rows, std::size_t rows_per_chunk) {
    std::vector<Chunk> chunks((rows + rows_per_chunk - 1) / rows_per_chunk);
    executor.for_each_chunk(rows, rows_per_chunk,
                            [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                chunks[chunk] = {first, last};
                            });
    return chunks;
}

}  // namespace

TEST_SUITE("parallel/executor") {
    TEST_CASE("chunks do not depend on the number of threads") {
        for (const std::size_t rows : {0ul, 1ul, 2047ul, 2048ul, 2049ul, 100'000ul}) {
            CAPTURE(rows);
            const std::vector<Chunk> expected = chunks_of(carom::Executor(1), rows, 2048);
            std::size_t covered = 0;
            for (const Chunk& chunk : expected) {
                CHECK(chunk.first == covered);
                covered = chunk.last;
            }
            CHECK(covered == rows);
            for (const int threads : {0, 2, 5})
                CHECK(chunks_of(carom::Executor(threads), rows, 2048) == expected);
        }
    }

    TEST_CASE("an embedding program's threads are used for many rows and left alone for few") {
        std::size_t calls = 0;
        const carom::ParallelFor backwards = [&](std::size_t count,
                                                 const std::function<void(std::size_t)>& task) {
            ++calls;
            for (std::size_t i = count; i-- > 0;) task(i);
        };
        const carom::Executor executor(0, backwards);
        CHECK(chunks_of(executor, 100'000, 1000) == chunks_of(carom::Executor(1), 100'000, 1000));
        CHECK(calls == 1);
        chunks_of(executor, 1000, 100);
        CHECK(calls == 1);
    }

#ifdef CAROM_TEST_ONE_PROCESSOR
    // As in a container that may use a part of one processor: OpenMP does not know, and its threads wait by
    // looking again and again. It does so only where no more threads than processors were started, so this
    // runs in a program of its own (tests/CMakeLists.txt).
    TEST_CASE("two threads on one processor do not wait for each other in each loop" * doctest::skip()) {
        cpu_set_t all, one;
        REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
        CPU_ZERO(&one);
        for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i)
            if (CPU_ISSET(i, &all)) CPU_SET(i, &one);
        REQUIRE(sched_setaffinity(0, sizeof one, &one) == 0);
        // A loop takes microseconds, unless it waits for a thread that the processor does not run: then it
        // takes time slices of milliseconds. Few may, which tell that the machine is busy.
        constexpr int kLoops = 1000;
        constexpr std::chrono::milliseconds kStall{1};
        int stalled = 0;
        const carom::Executor executor(2);
        for (int loop = 0; loop < kLoops; ++loop) {
            const auto start = std::chrono::steady_clock::now();
            executor.for_each_task(2, 10 * carom::kShortestParallelLoop, [](std::size_t) {});
            stalled += std::chrono::steady_clock::now() - start > kStall;
        }
        CHECK(stalled < kLoops / 4);
    }
#endif
}
