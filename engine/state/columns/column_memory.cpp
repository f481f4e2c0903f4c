#include "state/columns/column_memory.hpp"

#include <new>

// Only Linux has huge pages to ask for, and the address sanitizer should see each column by itself.
#if defined(__SANITIZE_ADDRESS__)
#define CAROM_HAS_SLABS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CAROM_HAS_SLABS 0
#endif
#endif
#if !defined(CAROM_HAS_SLABS) && defined(__linux__)
#define CAROM_HAS_SLABS 1
#endif

#if CAROM_HAS_SLABS
#include <sys/mman.h>

#include <algorithm>
#include <bitset>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>
#endif

namespace carom {
namespace {

void* allocate_small(std::size_t bytes) {
    return ::operator new (bytes, std::align_val_t{kColumnAlignment});
}

void release_small(void* column) noexcept {
    ::operator delete (column, std::align_val_t{kColumnAlignment});
}

#if CAROM_HAS_SLABS

constexpr std::size_t kHugePage = std::size_t{2} << 20;  // bytes, of x86-64
constexpr std::size_t kUnit = std::size_t{64} << 10;     // bytes: blocks are whole numbers of these
constexpr std::size_t kUnitsOfSlab = 512;                // 32 MiB: sixteen huge pages
constexpr std::size_t kSlab = kUnitsOfSlab * kUnit;
constexpr std::size_t kSmallestLarge = kUnit;      // below, blocks come from the heap
constexpr std::size_t kLargestShared = kSlab / 2;  // above, a block has pages of its own
// A step reads many columns at the same row. If all began at the same place of a page, their lines would
// share a few sets of the first cache.
constexpr std::size_t kStagger = 5 * kColumnAlignment, kStaggers = 16;
constexpr std::size_t kMostStagger = kStagger * (kStaggers - 1);

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
    return (bytes + unit - 1) / unit * unit;
}

/// Pages of the system, at a place that huge pages can begin at.
char* map_pages(std::size_t bytes) {
    const std::size_t all = bytes + kHugePage;
    void* const mapped = mmap(nullptr, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    char* const first = static_cast<char*>(mapped);
    const auto address = reinterpret_cast<std::uintptr_t>(first);
    const std::size_t before = rounded_up(address, kHugePage) - address;
    if (before > 0) munmap(first, before);
    if (before < kHugePage) munmap(first + before + bytes, kHugePage - before);
    madvise(first + before, bytes, MADV_HUGEPAGE);  // if it is refused, pages are small
    return first + before;
}

class Slabs {
  public:
    void* allocate(std::size_t bytes) {
        const std::scoped_lock lock(mutex_);
        const std::size_t units = units_of(bytes), stagger = kStagger * (blocks_++ % kStaggers);
        for (Slab& slab : slabs_) {
            const std::size_t unit = slab.find(units);
            if (unit < kUnitsOfSlab) return slab.take(unit, units) + stagger;
        }
        slabs_.reserve(slabs_.size() + 1);  // before pages are mapped that would be lost
        slabs_.push_back({map_pages(kSlab), {}});
        return slabs_.back().take(0, units) + stagger;
    }

    void release(void* column, std::size_t bytes) noexcept {
        const std::scoped_lock lock(mutex_);
        char* const place = static_cast<char*>(column);
        const auto slab = std::find_if(slabs_.begin(), slabs_.end(), [&](const Slab& each) {
            return place >= each.first && place < each.first + kSlab;
        });
        const std::size_t unit = static_cast<std::size_t>(place - slab->first) / kUnit;
        for (std::size_t i = 0; i < units_of(bytes); ++i) slab->is_used.reset(unit + i);
        if (slab->is_used.any()) return;
        munmap(slab->first, kSlab);
        slabs_.erase(slab);
    }

  private:
    struct Slab {
        char* first;
        std::bitset<kUnitsOfSlab> is_used;

        /// The first of so many units in a row that are free; kUnitsOfSlab: there are none.
        std::size_t find(std::size_t units) const {
            std::size_t free = 0;
            for (std::size_t unit = 0; unit < kUnitsOfSlab; ++unit) {
                free = is_used[unit] ? 0 : free + 1;
                if (free == units) return unit + 1 - units;
            }
            return kUnitsOfSlab;
        }
        char* take(std::size_t unit, std::size_t units) {
            for (std::size_t i = 0; i < units; ++i) is_used.set(unit + i);
            return first + kUnit * unit;
        }
    };
    static std::size_t units_of(std::size_t bytes) { return rounded_up(bytes + kMostStagger, kUnit) / kUnit; }

    std::mutex mutex_;
    std::vector<Slab> slabs_;
    std::size_t blocks_ = 0;  // ever
};

/// Never destroyed: columns of static worlds may outlive what is.
Slabs& slabs() {
    static Slabs& all = *new Slabs;
    return all;
}

#endif

}  // namespace

void* allocate_column(std::size_t bytes) {
#if CAROM_HAS_SLABS
    if (bytes > kLargestShared) return map_pages(rounded_up(bytes, kHugePage));
    if (bytes >= kSmallestLarge) return slabs().allocate(bytes);
#endif
    return allocate_small(bytes);
}

void release_column(void* column, std::size_t bytes) noexcept {
#if CAROM_HAS_SLABS
    if (bytes > kLargestShared) {
        munmap(column, rounded_up(bytes, kHugePage));
        return;
    }
    if (bytes >= kSmallestLarge) return slabs().release(column, bytes);
#endif
    static_cast<void>(bytes);
    release_small(column);
}

}  // namespace carom
