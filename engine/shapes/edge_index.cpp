#include "shapes/edge_index.hpp"

#include <cmath>

namespace carom {
namespace {

/// Sizes of boxes that differ by less have the same cells.
constexpr double kLeastCell = 0x1p-10;  // m
constexpr std::size_t kFewestPlaces = 64;

double size_of(const EdgeBox& box) {
    return std::fmax(box.high.x - box.low.x, box.high.y - box.low.y);
}

bool touch(const EdgeBox& a, const EdgeBox& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

/// Two cells may have the same.
std::uint32_t hash_of_cell(std::size_t level, std::int64_t x, std::int64_t y) {
    // Odd numbers that spread neighbouring cells: 2^64 over the golden ratio (Knuth), and two of MurmurHash3.
    std::uint64_t hash = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u + level;
    hash = (hash ^ (hash >> 32)) * 0xFF51AFD7ED558CCDu + static_cast<std::uint64_t>(y);
    hash = (hash ^ (hash >> 32)) * 0xC4CEB9FE1A85EC53u;
    return static_cast<std::uint32_t>(hash >> 32);
}

std::int64_t cell_of(double place, double size) {
    return static_cast<std::int64_t>(std::floor(place / size));
}

}  // namespace

std::int32_t EdgeIndex::level_of(const EdgeBox& box) {
    double size = kLeastCell;
    while (size < size_of(box)) size *= 2;
    for (std::size_t level = 0; level < levels_.size(); ++level)
        if (levels_[level].size == size) return static_cast<std::int32_t>(level);
    levels_.push_back({.size = size});
    return static_cast<std::int32_t>(levels_.size() - 1);
}

void EdgeIndex::link(std::int32_t number) {
    Member& member = at(number);
    std::int32_t& head = table_[place_of(member.cell)];
    member.previous = kNone, member.next = head;
    if (head != kNone) at(head).previous = number;
    head = number;
}

void EdgeIndex::grow() {
    table_.assign(std::max(kFewestPlaces, 2 * table_.size()), kNone);
    for (const Level& level : levels_)
        for (std::int32_t number = level.first; number != kNone; number = at(number).next_of_level)
            link(number);
}

void EdgeIndex::insert(std::int32_t number, const EdgeBox& box) {
    remove(number);
    if (members_.size() <= static_cast<std::size_t>(number))
        members_.resize(static_cast<std::size_t>(number) + 1);
    if (++count_ > table_.size()) grow();
    Member& member = at(number);
    member.box = box, member.level = level_of(box);
    const auto number_of_level = static_cast<std::size_t>(member.level);
    Level& level = levels_[number_of_level];
    member.cell =
        hash_of_cell(number_of_level, cell_of(box.low.x, level.size), cell_of(box.low.y, level.size));
    member.previous_of_level = kNone, member.next_of_level = level.first;
    if (level.first != kNone) at(level.first).previous_of_level = number;
    level.first = number, ++level.count;
    link(number);
}

void EdgeIndex::remove(std::int32_t number) {
    if (members_.size() <= static_cast<std::size_t>(number) || at(number).level == kNone) return;
    Member& member = at(number);
    (member.previous != kNone ? at(member.previous).next : table_[place_of(member.cell)]) = member.next;
    if (member.next != kNone) at(member.next).previous = member.previous;
    Level& level = levels_[static_cast<std::size_t>(member.level)];
    (member.previous_of_level != kNone ? at(member.previous_of_level).next_of_level : level.first) =
        member.next_of_level;
    if (member.next_of_level != kNone) at(member.next_of_level).previous_of_level = member.previous_of_level;
    --level.count, --count_;
    member = {};
}

void EdgeIndex::find(const EdgeBox& box, std::vector<std::int32_t>& found) const {
    found.clear();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const Level& level = levels_[i];
        if (level.count == 0) continue;
        // A box begins in the cell before, at the earliest.
        const double low_x = std::floor(box.low.x / level.size) - 1,
                     high_x = std::floor(box.high.x / level.size),
                     low_y = std::floor(box.low.y / level.size) - 1,
                     high_y = std::floor(box.high.y / level.size);
        if (!((high_x - low_x + 1) * (high_y - low_y + 1) < level.count)) {
            for (std::int32_t n = level.first; n != kNone; n = at(n).next_of_level)
                if (touch(at(n).box, box)) found.push_back(n);
            continue;
        }
        const std::int64_t begin_x = static_cast<std::int64_t>(low_x),
                           end_x = static_cast<std::int64_t>(high_x),
                           begin_y = static_cast<std::int64_t>(low_y),
                           end_y = static_cast<std::int64_t>(high_y);
        for (std::int64_t y = begin_y; y <= end_y; ++y)
            for (std::int64_t x = begin_x; x <= end_x; ++x) {
                const std::uint32_t cell = hash_of_cell(i, x, y);
                for (std::int32_t n = table_[place_of(cell)]; n != kNone; n = at(n).next)
                    if (at(n).cell == cell && touch(at(n).box, box)) found.push_back(n);
            }
    }
    std::sort(found.begin(), found.end());
    // Cells of one hash find the same boxes.
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

std::size_t EdgeIndex::bytes() const {
    return members_.capacity() * sizeof(Member) + table_.capacity() * sizeof(std::int32_t) +
           levels_.capacity() * sizeof(Level);
}

}  // namespace carom
