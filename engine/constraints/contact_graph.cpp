#include "constraints/contact_graph.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "shapes/walls.hpp"

namespace carom {
namespace {

constexpr std::size_t kPieces = 32;               // of the pair list, which threads take up
constexpr std::size_t kPairsPerSample = 64;       // every so many pairs one is looked at to choose the groups
constexpr std::size_t kFewestChunks = 8;          // or one: four tasks for the threads to share
constexpr std::size_t kFewestRowsOfChunk = 1024;  // fewer: too many short colours

// ns a pair on one thread, for the executor.
constexpr double kNanosecondsToGroup = 2, kNanosecondsToColour = 3, kNanosecondsToSort = 5;

constexpr std::size_t kOverflow = 64;  // the colour of what found none

/// Whether one of the bodies that may move is a disc.
template <class Real>
bool has_disc(const Bodies<Real>& bodies) {
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        if (bodies.is_disc(row)) return true;
    return false;
}

}  // namespace

/// The contacts of the last renewal in terms of today's rows.
template <class Real>
void ContactGraph<Real>::rename_rows(const Bodies<Real>& bodies) {
    const std::vector<std::int32_t>& now = trail.new_rows();
    sort_former_places();
    lost.clear();
    for (ContactRows<Real>* contacts : {&pairs, &supports})
        contacts->for_each([&](std::size_t i) {
            std::int32_t &a = contacts->a[i], &b = contacts->b[i];
            const std::int32_t old_a = a, old_b = b;
            a = now[static_cast<std::size_t>(a)];
            if (Partner(b).is_body()) b = now[static_cast<std::size_t>(b)];
            const Partner side_a(a), side_b(b);
            if (side_a.is_gone() || side_b.is_gone()) {
                if (side_a.is_body()) lose_contact(*contacts, i, old_b, a, bodies);
                if (side_b.is_body()) lose_contact(*contacts, i, old_a, b, bodies);
                contacts->normal_impulse[i] = 0;
            }
            // The impulses of a pair do not depend on the order of its bodies, but for the rolling one:
            // spin_b - spin_a changes its sign.
            if (contacts == &pairs && a > b) {
                std::swap(a, b);
                if (!contacts->rolling_impulse.empty())
                    contacts->rolling_impulse[i] = -contacts->rolling_impulse[i];
            }
        });
}

/// Share of the pairs that would be far, by a sample.
template <class Real>
double ContactGraph<Real>::far_share(const Candidates<Real>& candidates, const TaskGroups& tried) const {
    std::size_t far = 0, samples = 0;
    for (std::size_t p = 0; p < candidates.pair_count(); p += kPairsPerSample, ++samples) {
        const std::int32_t a = candidates.pair_a()[p], b = candidates.pair_b()[p];
        far += tried.group_of(std::min(a, b), std::max(a, b)) == tried.far();
    }
    return static_cast<double>(far) / static_cast<double>(std::max<std::size_t>(samples, 1));
}

/// Chunks small enough for the nearest caches, but so large that most pairs stay in a chunk or reach the
/// next.
template <class Real>
void ContactGraph<Real>::choose_groups(const Candidates<Real>& candidates, std::size_t rows) {
    groups = {};
    double least = 1;
    for (std::size_t chunks = kFewestChunks; rows / chunks >= kFewestRowsOfChunk; chunks *= 2) {
        const std::size_t length = padded((rows + chunks - 1) / chunks);
        const TaskGroups tried(length, (rows + length - 1) / length);  // none of them empty
        const double cost = far_share(candidates, tried) + 2 / static_cast<double>(chunks);
        if (cost < least) least = cost, groups = tried;
    }
}

/// Calls pair(piece, group, a, b) for all pairs, a < b; the group of pairs with an immovable body is the one
/// beyond the last.
template <class Real>
template <class Pair>
void ContactGraph<Real>::for_each_piece(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                                        const Executor& executor, const Pair& pair) {
    if (!has_discs_) return;
    const std::size_t count = candidates.pair_count(), piece_size = (count + kPieces - 1) / kPieces;
    const double work = kNanosecondsToGroup * static_cast<double>(count);
    executor.for_each_task(kPieces, work, [&](std::size_t piece) {
        const std::int32_t *pair_a = candidates.pair_a(), *pair_b = candidates.pair_b();
        const std::size_t last = std::min(count, (piece + 1) * piece_size);
        for (std::size_t p = piece * piece_size; p < last; ++p) {
            const std::int32_t a = std::min(pair_a[p], pair_b[p]), b = std::max(pair_a[p], pair_b[p]);
            if (!bodies.are_discs(a, b)) continue;
            if (is_forbidden(a, b) || (!crowds_.empty() && crowds_.leave_out(a, b, bodies, version)))
                continue;
            if (bodies.has_flags && bodies.is_immovable(static_cast<std::size_t>(a)))
                pair(piece, groups.count(), b, a);
            else if (bodies.has_flags && bodies.is_immovable(static_cast<std::size_t>(b)))
                pair(piece, groups.count(), a, b);
            else
                pair(piece, groups.group_of(a, b), a, b);
        }
    });
}

/// Sorts the pairs by group, stable; lists those that are supports.
template <class Real>
void ContactGraph<Real>::group_pairs(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                                     const Executor& executor) {
    const std::size_t lists = groups.count() + 1;  // one a group, and behind them that of supports
    piece_counts_.assign(kPieces * lists, 0);
    for_each_piece(candidates, bodies, executor,
                   [&](std::size_t piece, std::size_t group, std::int32_t, std::int32_t) {
                       ++piece_counts_[piece * lists + group];
                   });
    std::uint32_t place = 0;
    found_pairs_.begin.resize(lists + 1);
    for (std::size_t group = 0; group < lists; ++group) {
        found_pairs_.begin[group] = place;
        for (std::size_t piece = 0; piece < kPieces; ++piece) {
            std::uint32_t& of_piece = piece_counts_[piece * lists + group];
            place += std::exchange(of_piece, place);
        }
    }
    found_pairs_.begin[lists] = place;
    found_pairs_.resize(place);
    for_each_piece(candidates, bodies, executor,
                   [&](std::size_t piece, std::size_t group, std::int32_t a, std::int32_t b) {
                       const std::uint32_t i = piece_counts_[piece * lists + group]++;
                       found_pairs_.a[i] = a, found_pairs_.b[i] = b;
                   });
    listed_a_.assign(found_pairs_.a.data() + found_pairs_.begin[groups.count()],
                     found_pairs_.a.data() + place);
    listed_b_.assign(found_pairs_.b.data() + found_pairs_.begin[groups.count()],
                     found_pairs_.b.data() + place);
    found_pairs_.begin.pop_back();
}

template <class Real>
void ContactGraph<Real>::list_walls(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                                    const Walls& walls) {
    const Enclosure<Real> enclosure(&walls);
    const auto drift = static_cast<Real>(candidates.largest_drift());
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        enclosure.for_each_side_within(bodies.position_x[row], bodies.position_y[row],
                                       candidates.first_reach(row) + drift, [&](std::int32_t side) {
                                           if (!bodies.is_moving_disc(row)) return;
                                           listed_a_.push_back(static_cast<std::int32_t>(row));
                                           listed_b_.push_back(side);
                                       });
}

/// Sorts the listed supports by the chunk of their body, stable.
template <class Real>
void ContactGraph<Real>::group_supports() {
    Found& found = found_supports_;
    const std::size_t count = listed_a_.size();
    found.begin.assign(groups.support_count() + 1, 0);
    for (const std::int32_t a : listed_a_) ++found.begin[groups.chunk_of(a) + 1];
    for (std::size_t group = 1; group < found.begin.size(); ++group)
        found.begin[group] += found.begin[group - 1];
    found.resize(count);
    next_.assign(found.begin.begin(), found.begin.end());
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = next_[groups.chunk_of(listed_a_[i])]++;
        found.a[place] = listed_a_[i], found.b[place] = listed_b_[i];
    }
}

/// Recalls what each contact of a group carried and gives it the lowest colour that is free: first to those
/// that carry something, so that what touches fills few colours and the rest stays out of their way.
/// @param of_b  the same as of_a where both bodies count; null where only a does
template <class Real>
void ContactGraph<Real>::colour_group(Found& found, std::size_t group, std::uint64_t* of_a,
                                      std::uint64_t* of_b) {
    std::uint32_t* counts = colour_counts_.data() + group * (kColours + 1);
    // Called in two places, where compilers else decide by what the file has besides.
    const auto colour = [&](std::size_t i) __attribute__((always_inline)) {
        const auto a = static_cast<std::size_t>(found.a[i]), b = static_cast<std::size_t>(found.b[i]);
        std::uint64_t taken = of_a[a];
        if (of_b) taken |= of_b[b];
        const auto lowest = static_cast<unsigned>(std::countr_one(taken));  // kColours if all are taken
        found.colour[i] = static_cast<std::uint8_t>(lowest);
        ++counts[lowest];
        if (lowest == kColours) return;
        of_a[a] |= std::uint64_t{1} << lowest;
        if (of_b) of_b[b] |= std::uint64_t{1} << lowest;
    };
    const std::size_t first = found.begin[group], last = found.begin[group + 1];
    if (first == last) return;
    // Those that carry something from the front, the others from the back, without a branch that cannot
    // be foreseen.
    std::uint32_t* order = found.order.data();
    std::size_t front = first, back = last - 1;
    for (std::size_t i = first; i < last; ++i) {
        const auto impulses = of_b ? memory_.recall_pair(found.a[i], found.b[i])
                                   : memory_.recall_support(found.a[i], found.b[i]);
        found.normal_impulse[i] = impulses.normal, found.friction_impulse[i] = impulses.friction;
        order[front] = order[back] = static_cast<std::uint32_t>(i);
        const std::size_t carries = impulses.normal > 0;
        front += carries, back -= 1 - carries;
    }
    for (std::size_t k = first; k < front; ++k) colour(order[k]);
    for (std::size_t k = last; k-- > front;) colour(order[k]);
}

template <class Real>
void ContactGraph<Real>::colour_pairs(std::size_t rows, const Executor& executor) {
    colour_counts_.assign(groups.count() * (kColours + 1), 0);
    std::uint64_t *low = colours_of_[0].data(), *high = colours_of_[1].data();
    const std::size_t far = groups.far();
    const double work = kNanosecondsToColour * static_cast<double>(found_pairs_.a.size());
    // A border's bodies are a in one chunk and b in the next, where another task has its own a.
    executor.for_each_task(groups.chunks, work, [&](std::size_t chunk) {
        const std::size_t first = chunk * groups.rows_per_chunk,
                          last = std::min(rows, first + groups.rows_per_chunk);
        std::fill(low + first, low + last, 0);
        colour_group(found_pairs_, TaskGroups::inside(chunk), low, low);
        if (!groups.has_border(chunk)) return;
        std::fill(low + first, low + last, 0);
        std::fill(high + last, high + std::min(rows, last + groups.rows_per_chunk), 0);
        colour_group(found_pairs_, TaskGroups::across(chunk), low, high);
    });
    if (found_pairs_.begin[far] == found_pairs_.begin[far + 1]) return;
    std::fill(low, low + rows, 0);
    colour_group(found_pairs_, far, low, low);
}

template <class Real>
void ContactGraph<Real>::colour_supports(std::size_t rows) {
    colour_counts_.assign(groups.support_count() * (kColours + 1), 0);
    std::uint64_t* taken = colours_of_[0].data();
    std::fill(taken, taken + rows, 0);
    for (std::size_t group = 0; group < groups.support_count(); ++group)
        colour_group(found_supports_, group, taken, nullptr);
}

/// Places of all colours, and their padding.
/// @param first_padding_row  of the first group; the others' follow
template <class Real>
void ContactGraph<Real>::lay_out_colours(const Found& found, ContactRows<Real>& sorted,
                                         std::size_t first_padding_row) {
    const std::size_t group_count = found.begin.size() - 1;
    sorted.begin.clear(), sorted.count.clear(), sorted.first_colour.clear();
    next_.clear();
    std::size_t place = 0, overflow = 0;
    const auto open = [&](std::size_t count, std::size_t stride) {
        sorted.begin.push_back(place), sorted.count.push_back(count);
        place += padded(stride * count);
    };
    for (std::size_t group = 0; group < group_count; ++group) {
        const std::uint32_t* counts = colour_counts_.data() + group * (kColours + 1);
        sorted.first_colour.push_back(sorted.begin.size());
        for (std::size_t colour = 0; colour < kColours && counts[colour] > 0; ++colour)
            open(counts[colour], 1);
        next_.push_back(overflow);
        overflow += counts[kOverflow];
    }
    sorted.has_overflow = overflow > 0;
    if (overflow > 0) open(overflow, sorted.overflow_stride);
    sorted.first_colour.push_back(sorted.begin.size());

    sorted.a.resize_for_overwrite(place), sorted.b.resize_for_overwrite(place);
    sorted.normal_impulse.resize_for_overwrite(place), sorted.friction_impulse.resize_for_overwrite(place);
    for (std::size_t group = 0; group < group_count; ++group)
        sorted.pad_colours(sorted.first_colour[group], sorted.first_colour[group + 1],
                           static_cast<std::int32_t>(first_padding_row + group));
}

/// Stable, so that bodies near each other stay near each other within a colour.
template <class Real>
void ContactGraph<Real>::sort_by_colour(const Found& found, ContactRows<Real>& sorted,
                                        std::size_t first_padding_row, const Executor& executor) {
    lay_out_colours(found, sorted, first_padding_row);
    const double work = kNanosecondsToSort * static_cast<double>(found.a.size());
    executor.for_each_task(sorted.groups(), work, [&](std::size_t group) {
        std::size_t next[kColours + 1];
        const std::size_t first = sorted.first_colour[group], last = sorted.first_colour[group + 1];
        for (std::size_t c = first; c < std::min(last, first + kColours); ++c)
            next[c - first] = sorted.begin[c];
        if (sorted.has_overflow)
            next[kOverflow] = sorted.begin.back() + sorted.overflow_stride * next_[group];
        for (std::size_t i = found.begin[group]; i < found.begin[group + 1]; ++i) {
            const std::uint8_t colour = found.colour[i];
            const std::size_t place = next[colour];
            next[colour] += colour == kOverflow ? sorted.overflow_stride : 1;
            sorted.a[place] = found.a[i], sorted.b[place] = found.b[i];
            sorted.normal_impulse[place] = found.normal_impulse[i];
            sorted.friction_impulse[place] = found.friction_impulse[i];
        }
    });
}

template <class Real>
void ContactGraph<Real>::renew(const Candidates<Real>& candidates, const EdgeCandidates<Real>& edges,
                               const Bodies<Real>& bodies, const Walls* walls, const Executor& executor) {
    const std::size_t rows = bodies.moving(), first_padding_row = bodies.count;
    const bool is_moved = trail.has_moved();
    if (is_moved) rename_rows(bodies);
    if (keeps_rolling) rolling_of_pairs_.file(pairs, rows), rolling_of_supports_.file(supports, rows);
    memory_.file(pairs, supports, rows, is_moved || pairs.groups() == 0 ? nullptr : &groups, executor);

    has_discs_ = !bodies.has_shapes || has_disc(bodies);
    choose_groups(candidates, rows);
    crowds_.clear();
    if (has_discs_) crowds_.find(candidates, bodies);
    group_pairs(candidates, bodies, executor);
    if (walls) list_walls(candidates, bodies, *walls);
    for (const EdgePair pair : edges.pairs())
        if (bodies.are_discs(pair.row, pair.row))
            listed_a_.push_back(pair.row), listed_b_.push_back(Partner::edge(pair.edge).stored());
    for (const SleeperPair pair : sleepers)
        if (bodies.are_discs(pair.row, pair.sleeper) && !is_forbidden(pair.row, pair.sleeper) &&
            !bodies.is_immovable(static_cast<std::size_t>(pair.row)))
            listed_a_.push_back(pair.row), listed_b_.push_back(pair.sleeper);
    group_supports();

    for (Column<std::uint64_t>& colours : colours_of_) colours.resize_for_overwrite(rows);
    pairs.overflow_stride = kRowPadding;
    colour_pairs(rows, executor);
    sort_by_colour(found_pairs_, pairs, first_padding_row, executor);
    colour_supports(rows);
    sort_by_colour(found_supports_, supports, first_padding_row, executor);
    if (keeps_rolling) rolling_of_pairs_.recall(pairs), rolling_of_supports_.recall(supports);
    trail.start(bodies.count), former_places.clear();
    ++renewals, ++version;
}

/// Lays the last group of `sorted` out anew, with what is in late_ besides.
template <class Real>
void ContactGraph<Real>::add_late(ContactRows<Real>& sorted, std::int32_t padding_row, bool both_move) {
    const std::size_t group = sorted.groups() - 1, first = sorted.first_colour[group];
    std::size_t place = first < sorted.colours() ? sorted.begin[first] : sorted.a.size();
    sorted.for_each(group, group + 1, [&](std::size_t i) {
        late_.push_back({sorted.a[i], sorted.b[i], sorted.normal_impulse[i], sorted.friction_impulse[i],
                         sorted.rolling_impulse_of(i), 0});
    });
    for (const Late& late : late_) {  // rows as they were when pairs were renewed, or in a restored state
        const auto last = static_cast<std::size_t>(both_move ? std::max(late.a, late.b) : late.a);
        if (colours_of_[0].size() <= last) colours_of_[0].resize(last + 1);
    }
    std::uint64_t* taken = colours_of_[0].data();
    for (const Late& late : late_) taken[late.a] = taken[both_move ? late.b : late.a] = 0;
    std::size_t counts[kColours + 1] = {};
    for (Late& late : late_) {
        const std::uint64_t both = both_move ? taken[late.a] | taken[late.b] : taken[late.a];
        late.colour = static_cast<unsigned>(std::countr_one(both));
        ++counts[late.colour];
        if (late.colour == kOverflow) continue;
        taken[late.a] |= std::uint64_t{1} << late.colour;
        if (both_move) taken[late.b] |= std::uint64_t{1} << late.colour;
    }
    sorted.begin.resize(first), sorted.count.resize(first);
    for (std::size_t colour = 0; colour <= kColours; ++colour) {
        const std::size_t count = counts[colour];
        if (count == 0) continue;
        sorted.begin.push_back(place), sorted.count.push_back(count);
        place += padded(count * (colour == kOverflow ? sorted.overflow_stride : 1));
    }
    sorted.has_overflow = counts[kOverflow] > 0;
    sorted.first_colour.back() = sorted.colours();
    for (Column<std::int32_t>* rows : {&sorted.a, &sorted.b}) rows->resize(place);
    for (Column<Real>* impulses : {&sorted.normal_impulse, &sorted.friction_impulse}) impulses->resize(place);
    if (keeps_rolling) sorted.rolling_impulse.resize(place);
    std::size_t next[kColours + 1] = {};
    for (std::size_t colour = 0, c = first; colour <= kColours; ++colour)
        if (counts[colour] > 0) next[colour] = sorted.begin[c++];
    for (const Late& late : late_) {
        const std::size_t i = next[late.colour];
        next[late.colour] += late.colour == kOverflow ? sorted.overflow_stride : 1;
        sorted.a[i] = late.a, sorted.b[i] = late.b;
        sorted.normal_impulse[i] = late.normal_impulse, sorted.friction_impulse[i] = late.friction_impulse;
        if (keeps_rolling) sorted.rolling_impulse[i] = late.rolling_impulse;
    }
    sorted.pad_colours(first, sorted.colours(), padding_row);
}

template <class Real>
void ContactGraph<Real>::add(const Candidates<Real>& candidates, const EdgeCandidates<Real>& edges,
                             const Bodies<Real>& bodies, const Walls* walls) {
    new_pairs_.clear(), new_supports_.clear();
    const Enclosure<Real> enclosure(walls);
    for (const auto& [a, b] : candidates.new_pairs()) {
        if (!bodies.are_discs(a, b) || is_forbidden(a, b)) continue;
        if (bodies.is_immovable(static_cast<std::size_t>(a)))
            new_supports_.push_back({b, a, 0, 0, 0, 0});
        else if (bodies.is_immovable(static_cast<std::size_t>(b)))
            new_supports_.push_back({a, b, 0, 0, 0, 0});
        else
            new_pairs_.push_back({a, b, 0, 0, 0, 0});
    }
    const auto is_known = [&](std::int32_t row, std::int32_t side) {
        bool found = false;
        const std::size_t groups_of_supports = supports.groups();
        supports.for_each(groups_of_supports - 1, groups_of_supports,
                          [&](std::size_t i) { found |= supports.a[i] == row && supports.b[i] == side; });
        const auto row_index = static_cast<std::size_t>(row);
        if (candidates.is_loose(row_index)) return found;
        enclosure.for_each_side_within(
            candidates.first_x(row_index), candidates.first_y(row_index),
            candidates.first_reach(row_index) + static_cast<Real>(candidates.largest_drift()),
            [&](std::int32_t first) { found |= first == side; });
        return found;
    };
    for (const std::int32_t stray : candidates.strays()) {
        const auto row = static_cast<std::size_t>(stray);
        if (!walls || !bodies.is_moving_disc(row)) continue;
        enclosure.for_each_side_within(
            bodies.position_x[row], bodies.position_y[row],
            candidates.reach()[row] + static_cast<Real>(candidates.largest_drift()), [&](std::int32_t side) {
                if (!is_known(stray, side)) new_supports_.push_back({stray, side, 0, 0, 0, 0});
            });
    }
    for (const EdgePair pair : edges.new_pairs())
        if (bodies.are_discs(pair.row, pair.row))
            new_supports_.push_back({pair.row, Partner::edge(pair.edge).stored(), 0, 0, 0, 0});
    const auto add_to = [&](ContactRows<Real>& contacts, const std::vector<Late>& added,
                            std::size_t padding_row) {
        if (added.empty()) return;
        late_ = added;
        add_late(contacts, static_cast<std::int32_t>(padding_row), &contacts == &pairs);
        ++version;
    };
    add_to(pairs, new_pairs_, bodies.count + groups.far());
    add_to(supports, new_supports_, bodies.count);
}

template <class Real>
void ContactGraph<Real>::follow_rows(const Bodies<Real>& bodies, std::span<const std::uint8_t> is_elsewhere) {
    const std::vector<std::int32_t>& now = trail.new_rows();
    sort_former_places();
    lost.clear();
    const auto row_now = [&](std::int32_t row) {
        const std::int32_t present = now[static_cast<std::size_t>(row)];
        const bool is_gone = present < 0 || is_elsewhere[static_cast<std::size_t>(present)];
        return is_gone ? Partner::gone().stored() : present;
    };
    for (ContactRows<Real>* contacts : {&pairs, &supports}) {
        late_.clear();
        const auto drop = [&](std::size_t i, std::size_t last) {
            ContactRows<Real>::for_each_column(*contacts, [&](auto& column, const ColumnUse& use) {
                if (last >= column.size() || use.holds == ColumnUse::Holds::in_a_step) return;
                column[i] = column[last], column[last] = {};
            });
        };
        for (std::size_t c = 0; c < contacts->colours(); ++c) {
            const std::size_t stride = contacts->stride(c), begin = contacts->begin[c];
            for (std::size_t n = 0; n < contacts->count[c];) {
                const std::size_t i = begin + n * stride;
                const std::int32_t a = contacts->a[i], b = contacts->b[i];
                const bool is_body = Partner(b).is_body();
                const std::int32_t new_a = row_now(a), new_b = is_body ? row_now(b) : b;
                if (new_a == a && new_b == b) {
                    ++n;
                    continue;
                }
                const Partner side_a(new_a), side_b(new_b);
                if (side_a.is_gone() || side_b.is_gone()) {
                    if (side_a.is_body()) lose_contact(*contacts, i, b, new_a, bodies);
                    if (side_b.is_body()) lose_contact(*contacts, i, a, new_b, bodies);
                } else {
                    const bool turns = contacts == &pairs && new_a > new_b;
                    const Real rolling = contacts->rolling_impulse_of(i);
                    late_.push_back({turns ? new_b : new_a, turns ? new_a : new_b,
                                     contacts->normal_impulse[i], contacts->friction_impulse[i],
                                     turns ? -rolling : rolling, 0});
                }
                drop(i, begin + --contacts->count[c] * stride);
            }
        }
        contacts->pad_groups(bodies.count);
        if (!late_.empty())
            add_late(*contacts,
                     static_cast<std::int32_t>(bodies.count + (contacts == &pairs ? groups.far() : 0)),
                     contacts == &pairs);
    }
    trail.start(bodies.count), former_places.clear();
    ++version;
}

template <class Real>
std::size_t ContactGraph<Real>::bytes() const {
    return pairs.bytes() + supports.bytes() + found_pairs_.bytes() + found_supports_.bytes() +
           memory_.bytes() + rolling_of_pairs_.bytes() + rolling_of_supports_.bytes() +
           colours_of_[0].bytes() + colours_of_[1].bytes() + trail.bytes() +
           (listed_a_.capacity() + listed_b_.capacity()) * sizeof(std::int32_t) + crowds_.bytes() +
           (piece_counts_.capacity() + colour_counts_.capacity()) * sizeof(std::uint32_t);
}

template class ContactGraph<float>;
template class ContactGraph<double>;

}  // namespace carom
