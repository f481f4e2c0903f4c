#include "parallel/executor.hpp"

#include <doctest/doctest.h>
#include <vector>

namespace test_executor {

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
}

}  // namespace test_executor
