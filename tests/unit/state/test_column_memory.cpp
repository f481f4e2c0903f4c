#include "state/columns/column_memory.hpp"

#include <cstdint>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace test_column_memory {

using namespace carom;

namespace {

/// Blocks of all kinds of sizes, each filled with a byte of its own.
class Blocks {
  public:
    explicit Blocks(unsigned seed) : random_(seed) {}
    ~Blocks() {
        while (!blocks_.empty()) drop(0);
    }

    void add() {
        // From a few bytes to more than half a slab, and sizes next to where the kinds of blocks begin.
        const std::size_t kinds[] = {1, 100, 64 << 10, (64 << 10) - 1, 65 << 10, 1 << 20, 3 << 20, 17 << 20};
        const std::size_t bytes = kinds[random_() % 8] + random_() % 3;
        auto* const place = static_cast<unsigned char*>(allocate_column(bytes));
        const auto value = static_cast<unsigned char>(random_() % 255 + 1);
        std::memset(place, value, bytes);
        blocks_.push_back({place, bytes, value});
    }
    void drop_one() { drop(random_() % blocks_.size()); }
    std::size_t count() const { return blocks_.size(); }

    bool all_aligned() const {
        bool aligned = true;
        for (const Block& block : blocks_)
            aligned = aligned && reinterpret_cast<std::uintptr_t>(block.place) % kColumnAlignment == 0;
        return aligned;
    }
    /// Whether each block has its own byte from end to end: no other block writes there.
    bool all_whole() const {
        bool whole = true;
        for (const Block& block : blocks_)
            whole = whole && block.place[0] == block.value && block.place[block.bytes - 1] == block.value &&
                    std::memcmp(block.place, block.place + 1, block.bytes - 1) == 0;
        return whole;
    }

  private:
    struct Block {
        unsigned char* place;
        std::size_t bytes;
        unsigned char value;
    };
    void drop(std::size_t i) {
        release_column(blocks_[i].place, blocks_[i].bytes);
        blocks_[i] = blocks_.back();
        blocks_.pop_back();
    }

    std::mt19937 random_;
    std::vector<Block> blocks_;
};

}  // namespace

TEST_SUITE("state/column memory") {
    TEST_CASE("blocks that come and go never share a byte") {
        Blocks blocks(1);
        for (int i = 0; i < 400; ++i) {
            blocks.add();
            if (blocks.count() > 25) blocks.drop_one();
            if (i % 20 == 0) CHECK(blocks.all_whole());
        }
        CHECK(blocks.all_whole());
        CHECK(blocks.all_aligned());
    }

    TEST_CASE("several threads may ask for memory") {
        std::vector<std::thread> threads;
        std::vector<int> whole(4);
        for (unsigned thread = 0; thread < 4; ++thread)
            threads.emplace_back([&whole, thread] {
                Blocks blocks(thread + 2);
                for (int i = 0; i < 60; ++i) {
                    blocks.add();
                    if (blocks.count() > 6) blocks.drop_one();
                }
                whole[thread] = blocks.all_whole();
            });
        for (std::thread& thread : threads) thread.join();
        CHECK(whole == std::vector<int>{1, 1, 1, 1});
    }
}

}  // namespace test_column_memory
