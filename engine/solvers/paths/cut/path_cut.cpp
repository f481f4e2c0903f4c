#include "solvers/paths/cut/path_cut.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace carom {
namespace {

/// Contacts of a body that are joined with each other; more end their paths at the body.
constexpr std::size_t kMostJoined = 12;
/// Contacts of a body that are compared with each other, loaded ones first; more only if they are loaded.
constexpr std::size_t kMostCompared = 6;
/// Two loaded contacts are joined before any other two: how well contacts face each other, minus the cosine
/// of the angle between where they push the body, is -1 ... 1.
constexpr float kLoadedFirst = 4;
constexpr float kTiny = 1e-30f;  // m², so that a contact in the centre of mass has an arm of length 0
/// Contacts of a path that is not slender, as towers are: its loads spread to others anyhow, and a long
/// bundle is solved again as a whole for one contact that changes. docs/decisions/0038-broad-paths.md.
constexpr std::uint32_t kLongestBroad = 64;
/// Such a path has no more contacts than fill the lanes of a colour, but at least so many, where there are
/// kFewestShort in all: record 0098, docs/decisions/0098-turns-around-what-is-restless.md.
constexpr std::uint32_t kShortestBroad = 16;
constexpr std::size_t kFewestShort = 1024;
constexpr std::uint32_t kMostColours = 64;  // of a round: bits of a word
/// Rounds of as many colours. What is left then goes one by one, so that the work of a cut stays in
/// proportion to the contacts, whatever a body has of them. docs/decisions/0086-steps-that-stall.md.
constexpr std::uint32_t kMostRounds = 16;
constexpr std::uint32_t kNoLink = std::numeric_limits<std::uint32_t>::max();

// For the executor: rows of a task, and ns a contact on one thread.
constexpr std::size_t kRowsPerTask = 256;
constexpr double kNanosecondsToJoin = 15;

/// Two contacts of a body and how well they go together, as a number: the larger the better, of equal ones
/// the first. The upper half is in the order of the score, the lower tells which two they are.
std::int64_t two_of(float score, std::size_t i, std::size_t j) {
    const auto bits = std::bit_cast<std::int32_t>(score + 0.0F);  // -0 becomes 0
    const std::int32_t ordered = bits ^ ((bits >> 31) & std::numeric_limits<std::int32_t>::max());
    return static_cast<std::int64_t>(ordered) * (std::int64_t{1} << 32) +
           static_cast<std::int64_t>(255 - (16 * i + j));
}
std::uint32_t first_of(std::int64_t two) {
    return (255 - (static_cast<std::uint32_t>(two) & 255)) / 16;
}
std::uint32_t second_of(std::int64_t two) {
    return (255 - (static_cast<std::uint32_t>(two) & 255)) % 16;
}
constexpr std::int64_t kNoTwo = std::numeric_limits<std::int64_t>::min();
static_assert(kMostJoined <= 16);

}  // namespace

void PathCut::cut(std::span<const ContactLink> contacts, std::size_t rows, std::size_t longest,
                  const Executor& executor) {
    list_contacts_of_bodies(contacts, rows);
    count_loads(contacts, rows);
    joined_.assign(2 * contacts.size(), -1);
    const std::size_t tasks = (rows + kRowsPerTask - 1) / kRowsPerTask;
    executor.for_each_task(tasks, kNanosecondsToJoin * static_cast<double>(contacts.size()),
                           [&](std::size_t task) {
                               for (std::size_t row = task * kRowsPerTask;
                                    row < std::min(rows, (task + 1) * kRowsPerTask); ++row)
                                   if (first_at_[row + 1] - first_at_[row] > 1)
                                       join_at(contacts, static_cast<std::int32_t>(row));
                           });
    walk(contacts, rows, longest);
    split_broad(contacts);
    colour(contacts, rows);
    assert(colours_share_no_body(contacts, rows));
    lay_out(contacts);
}

/// For assertions: whether no path names a body twice and no two paths of a colour name the same one.
bool PathCut::colours_share_no_body(std::span<const ContactLink> contacts, std::size_t rows) const {
    thread_local std::vector<std::uint32_t> seen;  // by row: the last colour, and one
    thread_local std::vector<const Piece*> pieces;
    pieces.clear();
    for (const Piece& piece : coloured_) pieces.push_back(&piece);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const Piece* p, const Piece* q) { return p->colour < q->colour; });
    seen.assign(rows, 0);
    for (const Piece* of : pieces) {
        const Piece& piece = *of;
        const auto is_new = [&](std::int32_t row) {
            return row < 0 ||
                   std::exchange(seen[static_cast<std::size_t>(row)], piece.colour + 1) != piece.colour + 1;
        };
        const Step& first = sequence_[piece.first];
        if (!is_new(first.row_before(contacts))) return false;
        for (std::uint32_t s = piece.first; s < piece.first + piece.length; ++s)
            if (!is_new(sequence_[s].row_after(contacts))) return false;
    }
    return true;
}

void PathCut::list_contacts_of_bodies(std::span<const ContactLink> contacts, std::size_t rows) {
    first_at_.assign(rows + 2, 0);
    const auto for_each_side = [&](const auto& fn) {
        for (std::size_t i = 0; i < contacts.size(); ++i)
            for (const std::int32_t row : {contacts[i].a, contacts[i].b})
                if (row != ContactLink::kNothing && !contacts[i].is_watched)
                    fn(static_cast<std::size_t>(row), i);
    };
    for_each_side([&](std::size_t row, std::size_t) { ++first_at_[row + 2]; });
    for (std::size_t row = 2; row < first_at_.size(); ++row) first_at_[row] += first_at_[row - 1];
    contact_at_.resize(first_at_.back());
    for_each_side([&](std::size_t row, std::size_t i) {
        contact_at_[first_at_[row + 1]++] = static_cast<std::uint32_t>(i);
    });
    first_at_.pop_back();
}

void PathCut::count_loads(std::span<const ContactLink> contacts, std::size_t rows) {
    loaded_count_.assign(rows, 0);
    for (const ContactLink& link : contacts)
        for (const std::int32_t row : {link.a, link.b})
            if (link.is_loaded && row >= 0) ++loaded_count_[static_cast<std::size_t>(row)];
}

/// Joins the contacts of a body by twos: first the two that face each other best, then the best of the rest,
/// and in their order what is left.
void PathCut::join_at(std::span<const ContactLink> contacts, std::int32_t row) {
    const auto r = static_cast<std::size_t>(row);
    const auto side = [&](std::uint32_t contact) {
        return 2 * contact + (contacts[contact].a == row ? 0 : 1);
    };
    const auto join = [&](std::uint32_t i, std::uint32_t j) {
        joined_[side(i)] = static_cast<std::int32_t>(j), joined_[side(j)] = static_cast<std::int32_t>(i);
    };
    if (first_at_[r + 1] - first_at_[r] == 2)
        return join(contact_at_[first_at_[r]], contact_at_[first_at_[r] + 1]);
    // Where contacts push the body, seen from its centre of mass; no unit. Loaded ones first.
    std::array<std::uint32_t, kMostJoined> contact;
    std::array<float, kMostJoined> x, y;
    const std::size_t loaded = loaded_count_[r];
    std::size_t next_loaded = 0, next_other = loaded;
    for (std::uint32_t at = first_at_[r]; at < first_at_[r + 1]; ++at) {
        const ContactLink& link = contacts[contact_at_[at]];
        const std::size_t place = link.is_loaded ? next_loaded++ : next_other++;
        if (place >= kMostJoined) continue;
        const bool is_a = link.a == row;
        contact[place] = contact_at_[at];
        x[place] = is_a ? link.arm_a_x : link.arm_b_x, y[place] = is_a ? link.arm_a_y : link.arm_b_y;
    }
    const std::size_t count = std::min<std::size_t>(first_at_[r + 1] - first_at_[r], kMostJoined);
    const std::size_t compared = std::min(count, std::max(loaded, kMostCompared));
    for (std::size_t i = 0; i < compared; ++i) {
        const float scale = 1 / std::sqrt(x[i] * x[i] + y[i] * y[i] + kTiny);
        x[i] *= scale, y[i] *= scale;
    }
    std::array<std::int64_t, kMostJoined*(kMostJoined - 1) / 2> twos;
    std::size_t two_count = 0;
    std::int64_t best = kNoTwo;
    for (std::size_t i = 0; i < compared; ++i)
        for (std::size_t j = i + 1; j < compared; ++j) {
            const float facing = -(x[i] * x[j] + y[i] * y[j]);
            const std::int64_t two = two_of(j < loaded ? kLoadedFirst + facing : facing, i, j);
            best = std::max(best, twos[two_count++] = two);
        }
    std::uint32_t left = (1U << count) - 1;  // a bit for each contact that is not joined yet
    while (best != kNoTwo) {
        const std::uint32_t i = first_of(best), j = second_of(best);
        join(contact[i], contact[j]), left &= ~(1U << i | 1U << j);
        const std::size_t before = two_count;
        two_count = 0, best = kNoTwo;
        for (std::size_t t = 0; t < before; ++t) {
            const std::int64_t two = twos[t];
            const std::uint32_t k = first_of(two), l = second_of(two);
            const bool is_left = (k != i) & (k != j) & (l != i) & (l != j);
            twos[two_count] = two, two_count += is_left ? 1 : 0;
            best = std::max(best, is_left ? two : kNoTwo);
        }
    }
    while (std::popcount(left) > 1) {
        const int i = std::countr_zero(left), j = std::countr_zero(left & (left - 1));
        join(contact[static_cast<std::size_t>(i)], contact[static_cast<std::size_t>(j)]);
        left &= ~(1U << i | 1U << j);
    }
}

void PathCut::walk(std::span<const ContactLink> contacts, std::size_t rows, std::size_t longest) {
    is_seen_.resize(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) is_seen_[i] = contacts[i].is_watched;
    piece_of_row_.assign(rows, 0);
    sequence_.clear(), pieces_.clear();
    for (const bool is_loop : {false, true})
        for (std::size_t i = 0; i < contacts.size(); ++i)
            if (!is_seen_[i] && (is_loop || joined_[2 * i] < 0 || joined_[2 * i + 1] < 0))
                walk_from(contacts, i, longest);
}

/// Follows a path from its first contact; a new piece begins where it is too long or comes to a body again.
void PathCut::walk_from(std::span<const ContactLink> contacts, std::size_t contact, std::size_t longest) {
    Step step = {static_cast<std::int32_t>(contact),
                 joined_[2 * contact] >= 0 && joined_[2 * contact + 1] < 0};
    const auto begin_piece = [&](std::int32_t head) {
        pieces_.push_back({static_cast<std::uint32_t>(sequence_.size()), 0, 0});
        if (head >= 0)
            piece_of_row_[static_cast<std::size_t>(head)] = static_cast<std::uint32_t>(pieces_.size());
    };
    begin_piece(step.row_before(contacts));
    while (!is_seen_[contact]) {
        const std::int32_t end = step.row_after(contacts);
        const auto piece = static_cast<std::uint32_t>(pieces_.size());
        if (pieces_.back().length == longest ||
            (end >= 0 && pieces_.back().length > 0 && piece_of_row_[static_cast<std::size_t>(end)] == piece))
            begin_piece(step.row_before(contacts));
        is_seen_[contact] = 1;
        sequence_.push_back(step);
        ++pieces_.back().length;
        if (end < 0) return;
        piece_of_row_[static_cast<std::size_t>(end)] = static_cast<std::uint32_t>(pieces_.size());
        const std::int32_t next = joined_[2 * contact + (step.is_reversed ? 0 : 1)];
        if (next < 0) return;
        contact = static_cast<std::size_t>(next);
        step = {next, contacts[contact].a != end};
    }
}

/// Cuts paths into parts of about the same length if they are longer than what is no tower needs.
void PathCut::split_broad(std::span<const ContactLink> contacts) {
    const std::size_t count = pieces_.size(), all = contacts.size();
    const auto fill = static_cast<std::uint32_t>(all / (kColours * kPathLanes));
    const auto longest = all < kFewestShort ? kLongestBroad : std::clamp(fill, kShortestBroad, kLongestBroad);
    for (std::size_t i = 0; i < count; ++i) {
        if (pieces_[i].length <= longest || is_slender(contacts, pieces_[i])) continue;
        const std::uint32_t length = pieces_[i].length, parts = (length + longest - 1) / longest;
        const std::uint32_t first = pieces_[i].first;
        pieces_[i].length = length / parts;
        for (std::uint32_t part = 1; part < parts; ++part) {
            const std::uint32_t begin = part * length / parts, end = (part + 1) * length / parts;
            pieces_.push_back({first + begin, end - begin, 0});
        }
    }
}

/// Gives paths colours, long ones first. A path that fits into none as a whole is cut where it must be. What
/// finds no colour is coloured by itself, with as many others: each round has at least one path of its own.
void PathCut::colour(std::span<const ContactLink> contacts, std::size_t rows) {
    coloured_.clear();
    std::uint32_t first_colour = 0;
    for (; first_colour < kMostRounds * kMostColours && !pieces_.empty(); first_colour += kMostColours) {
        if (first_colour == 0)
            used_.assign(rows, 0);
        else
            for_each_row_of_pieces(contacts, [&](std::size_t row) { used_[row] = 0; });
        colour_round(contacts, first_colour);
        pieces_.swap(left_);
    }
    for (const Piece& piece : pieces_)
        for (std::uint32_t s = piece.first; s < piece.first + piece.length; ++s)
            coloured_.push_back({s, 1, first_colour++, is_in_turns(contacts, s, s + 1)});
}

template <class Fn>
void PathCut::for_each_row_of_pieces(std::span<const ContactLink> contacts, const Fn& fn) const {
    for (const Piece& piece : pieces_)
        for (std::uint32_t s = piece.first; s < piece.first + piece.length; ++s)
            for (const std::int32_t row :
                 {sequence_[s].row_before(contacts), sequence_[s].row_after(contacts)})
                if (row >= 0) fn(static_cast<std::size_t>(row));
}

bool PathCut::is_in_turns(std::span<const ContactLink> contacts, std::uint32_t first,
                          std::uint32_t last) const {
    return std::any_of(&sequence_[first], &sequence_[first] + (last - first), [&](const Step& step) {
        return contacts[static_cast<std::size_t>(step.contact)].is_in_turns;
    });
}

/// Colours first_colour ... first_colour + kMostColours - 1. What finds none is in left_.
void PathCut::colour_round(std::span<const ContactLink> contacts, std::uint32_t first_colour) {
    std::uint32_t longest = 0;
    for (const Piece& piece : pieces_) longest = std::max(longest, piece.length);
    count_.assign(longest + 2, 0);
    for (const Piece& piece : pieces_) ++count_[longest - piece.length + 1];
    for (std::size_t k = 1; k < count_.size(); ++k) count_[k] += count_[k - 1];
    order_.resize(pieces_.size());
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) order_[count_[longest - pieces_[i].length]++] = i;

    left_.clear();
    const auto mask_of = [&](std::int32_t row) { return row < 0 ? 0 : used_[static_cast<std::size_t>(row)]; };
    for (const std::uint32_t number : order_) {
        std::uint32_t first = pieces_[number].first;
        const std::uint32_t last = first + pieces_[number].length;
        bool goes_on = false;  // what is left of the path
        while (first < last) {
            // free: colours that the path can have as far as `reached`
            std::uint64_t free = ~mask_of(sequence_[first].row_before(contacts));
            constexpr std::uint64_t kPreferred = (std::uint64_t{1} << kColours) - 1;
            std::uint32_t reached = first;
            std::uint64_t limit = kPreferred;
            if ((free & ~mask_of(sequence_[first].row_after(contacts)) & kPreferred) == 0)
                limit = ~std::uint64_t{0};
            while (reached < last) {
                const std::uint64_t still_free = free & ~mask_of(sequence_[reached].row_after(contacts));
                if ((still_free & limit) == 0) break;
                free = still_free, ++reached;
            }
            if (reached == first) {
                if (goes_on)
                    ++left_.back().length;
                else
                    left_.push_back({first, 1, 0});
                goes_on = true, ++first;
                continue;
            }
            goes_on = false;
            const auto colour = static_cast<std::uint32_t>(std::countr_zero(free & limit));
            coloured_.push_back(
                {first, reached - first, first_colour + colour, is_in_turns(contacts, first, reached)});
            const std::uint64_t bit = std::uint64_t{1} << colour;
            const auto mark = [&](std::int32_t row) {
                if (row >= 0) used_[static_cast<std::size_t>(row)] |= bit;
            };
            mark(sequence_[first].row_before(contacts));
            for (std::uint32_t s = first; s < reached; ++s) mark(sequence_[s].row_after(contacts));
            first = reached;
        }
    }
}

/// Bundles of each colour, the longest paths first.
void PathCut::lay_out(std::span<const ContactLink> contacts) {
    order_.resize(coloured_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
        const Piece &p = coloured_[i], &q = coloured_[j];
        if (p.colour != q.colour) return p.colour < q.colour;
        return p.is_in_turns != q.is_in_turns ? p.is_in_turns : p.length > q.length;
    });
    places_.resize(contacts.size());
    first_link_.assign(1, 0), first_bundle_.assign(1, 0), end_of_turns_.clear();
    first_contacts_.clear(), jumps_.clear(), is_slender_.clear();
    longest_ = 0, paths_ = coloured_.size();
    for (std::size_t first = 0, last = 0; first < order_.size(); first = last) {
        const std::uint32_t colour = coloured_[order_[first]].colour;
        const auto lay_out_while = [&](const auto& belongs) {
            while (last < order_.size() && coloured_[order_[last]].colour == colour &&
                   belongs(coloured_[order_[last]]))
                ++last;
            if (first < last) lay_out_pieces(contacts, first, last);
            first = last;
        };
        lay_out_while([](const Piece& piece) { return piece.is_in_turns; });
        end_of_turns_.push_back(bundles());
        lay_out_while([](const Piece&) { return true; });
        first_bundle_.push_back(bundles());
    }
    list_watched(
        contacts.size(), [&](std::size_t i) { return contacts[i].is_watched; },
        [&](std::size_t i) { return contacts[i].is_in_turns; });
    lay_out_watched();
}

/// Lists the contacts beside the paths, those in turns first.
template <class IsWatched, class IsInTurns>
void PathCut::list_watched(std::size_t contacts, const IsWatched& is_watched, const IsInTurns& is_in_turns) {
    watched_.clear(), others_.clear();
    for (std::uint32_t i = 0; i < contacts; ++i)
        if (is_watched(i)) (is_in_turns(i) ? watched_ : others_).push_back(i);
    watched_turns_ = watched_.size();
    watched_.insert(watched_.end(), others_.begin(), others_.end());
}

/// Bundles of one link for the contacts beside the paths, in their order; those not in turns begin a new one.
void PathCut::lay_out_watched() {
    end_of_watched_turns_ = bundles() + (watched_turns_ + kPathLanes - 1) / kPathLanes;
    for (std::size_t k = 0; k < watched_.size(); ++k) {
        const auto lane =
            static_cast<std::uint8_t>((k < watched_turns_ ? k : k - watched_turns_) % kPathLanes);
        if (lane == 0) {
            first_contacts_.resize(first_contacts_.size() + kPathLanes, -1), is_slender_.push_back(0);
            first_link_.push_back(first_link_.back() + 1);
        }
        const std::size_t bundle = is_slender_.size() - 1;
        places_[watched_[k]] = {static_cast<std::uint32_t>(first_link_[bundle]),
                                static_cast<std::uint32_t>(bundle), lane, false};
        first_contacts_[kPathLanes * bundle + lane] = static_cast<std::int32_t>(watched_[k]);
    }
    if (!watched_.empty()) longest_ = std::max<std::size_t>(longest_, 1);
}

void PathCut::keep(std::span<const Slot> slots) {
    const std::size_t kept = first_watched();
    first_link_.resize(kept + 1), is_slender_.resize(kept), first_contacts_.resize(kPathLanes * kept);
    bundle_of_link_.resize(links());
    for (std::uint32_t bundle = 0; bundle < kept; ++bundle)
        for (std::size_t link = first_link_[bundle]; link < first_link_[bundle + 1]; ++link)
            bundle_of_link_[link] = bundle;
    contact_of_slot_.assign(kPathLanes * links(), -1);
    places_.resize(slots.size());
    for (std::uint32_t i = 0; i < slots.size(); ++i) {
        const auto slot = static_cast<std::uint32_t>(slots[i].number);
        places_[i].link = kNoLink;
        if (slots[i].number < 0 || contact_of_slot_[slot] >= 0) continue;  // none, or another's
        const std::uint32_t link = slot / kPathLanes;
        places_[i] = {link, bundle_of_link_[link], static_cast<std::uint8_t>(slot % kPathLanes),
                      slots[i].is_reversed};
        contact_of_slot_[slot] = static_cast<std::int32_t>(i);
    }
    jumps_.clear();
    for (std::size_t bundle = 0; bundle < kept; ++bundle) {
        const std::size_t first = kPathLanes * first_link_[bundle],
                          last = kPathLanes * first_link_[bundle + 1];
        std::copy_n(&contact_of_slot_[first], kPathLanes, &first_contacts_[kPathLanes * bundle]);
        for (std::size_t slot = first; slot + kPathLanes < last; ++slot) {
            const std::int32_t next = contact_of_slot_[slot + kPathLanes];
            if (contact_of_slot_[slot] < 0 && next >= 0)
                jumps_.push_back({static_cast<std::uint32_t>(slot / kPathLanes),
                                  static_cast<std::uint8_t>(slot % kPathLanes), next});
        }
    }
    list_watched(
        slots.size(), [&](std::size_t i) { return places_[i].link == kNoLink; },
        [&](std::size_t i) { return slots[i].is_in_turns; });
    lay_out_watched();
}

/// Bundles of the pieces order_[first] ... order_[last], which are in order of their length. Each begins with
/// the kPathLanes longest that are left, and goes on in each lane with the longest that ends before it does.
void PathCut::lay_out_pieces(std::span<const ContactLink> contacts, std::size_t first, std::size_t last) {
    const auto length_of = [&](std::size_t i) { return std::size_t{coloured_[order_[i]].length}; };
    next_of_length_.assign(length_of(first) + 1, 0), end_of_length_.assign(length_of(first) + 1, 0);
    for (std::size_t i = last; i-- > first;) {
        if (next_of_length_[length_of(i)] == end_of_length_[length_of(i)])
            end_of_length_[length_of(i)] = i + 1;
        next_of_length_[length_of(i)] = i;
    }
    std::size_t left = last - first;
    // The longest piece that is left, of at most so many links; null: there is none.
    const auto take = [&](std::size_t most) -> const Piece* {
        for (std::size_t length = std::min(most, end_of_length_.size() - 1); length > 0; --length)
            if (next_of_length_[length] < end_of_length_[length])
                return --left, &coloured_[order_[next_of_length_[length]++]];
        return nullptr;
    };
    while (left > 0) {
        const std::size_t begin = first_link_.back();
        first_contacts_.resize(first_contacts_.size() + kPathLanes, -1), is_slender_.push_back(0);
        std::array<std::size_t, kPathLanes> used{};
        std::size_t length = end_of_length_.size();  // of the bundle
        for (std::uint8_t lane = 0; lane < kPathLanes && left > 0; ++lane) {
            const Piece& piece = *take(length);
            if (lane == 0) length = piece.length;
            used[lane] = piece.length;
            first_contacts_[(is_slender_.size() - 1) * kPathLanes + lane] = sequence_[piece.first].contact;
            put(contacts, piece, lane, begin);
        }
        for (std::uint8_t lane = 0; lane < kPathLanes; ++lane)
            while (left > 0 && length - used[lane] > 1) {
                const Piece* piece = take(length - used[lane] - 1);
                if (!piece) break;
                jumps_.push_back(
                    {static_cast<std::uint32_t>(begin + used[lane]), lane, sequence_[piece->first].contact});
                put(contacts, *piece, lane, begin + used[lane] + 1);
                used[lane] += piece->length + 1;
            }
        longest_ = std::max(longest_, length);
        first_link_.push_back(begin + length);
    }
}

/// Gives the contacts of a piece their places in the last bundle, from `link` on.
void PathCut::put(std::span<const ContactLink> contacts, const Piece& piece, std::uint8_t lane,
                  std::size_t link) {
    if (is_slender(contacts, piece)) is_slender_.back() = 1;
    for (std::uint32_t k = 0; k < piece.length; ++k) {
        const Step& s = sequence_[piece.first + k];
        places_[static_cast<std::size_t>(s.contact)] = {static_cast<std::uint32_t>(link + k),
                                                        static_cast<std::uint32_t>(is_slender_.size() - 1),
                                                        lane, s.is_reversed};
    }
}

bool PathCut::is_slender(std::span<const ContactLink> contacts, const Piece& piece) const {
    int alone = 0;  // bodies between two links of the path that no other load leads to
    for (std::uint32_t s = piece.first; s + 1 < piece.first + piece.length; ++s) {
        const ContactLink& link = contacts[static_cast<std::size_t>(sequence_[s].contact)];
        const std::int32_t row = sequence_[s].row_after(contacts);
        if (link.is_loaded && loaded_count_[static_cast<std::size_t>(row)] <= 2) ++alone;
    }
    return alone > kSlender;
}

std::size_t PathCut::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(first_at_) + of(contact_at_) + of(joined_) + of(is_seen_) + of(piece_of_row_) + of(sequence_) +
           of(pieces_) + of(coloured_) + of(left_) + of(used_) + of(loaded_count_) + of(order_) + of(count_) +
           of(places_) + of(first_link_) + of(first_bundle_) + of(end_of_turns_) + of(first_contacts_) +
           of(jumps_) + of(is_slender_) + of(watched_) + of(others_) + of(contact_of_slot_) +
           of(bundle_of_link_) + of(next_of_length_) + of(end_of_length_);
}

}  // namespace carom
