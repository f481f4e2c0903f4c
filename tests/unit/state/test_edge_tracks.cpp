// Segments that are joined as they come, go and are put elsewhere, against joining all of them by the
// definition of docs/decisions/0081-turns-and-segments.md.
#include "state/edge_tracks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "narrowphase/disc_edge.hpp"
#include "support/effort.hpp"

namespace test_edge_tracks {

using namespace carom;

namespace {

constexpr int kSide = 5;  // m, of the square whose whole numbers are the ends of segments

/// What joining makes of the segment of one number.
struct Expected {
    Vec2 a, b;  // m, in the world
    int previous = -1, next = -1, track = -1;
    double reach = 0;  // m
};

struct End {
    Vec2 at, other;
    double length;
    int number;
};

template <class Real>
class Ends {
  public:
    explicit Ends(const WorldState<Real>& world) : world_(world), expected_(world.edges.bodies.size()) {
        const Bodies<Real>& bodies = world.bodies;
        for (std::size_t number = 0; number < expected_.size(); ++number) {
            const EdgeBody& body = world.edges.bodies[number];
            if (body.count != 1) continue;
            const std::size_t row = world.handles.row_of_slot(body.id.index);
            const Segment own = std::get<Segment>(world.edges.shape_of(body.id));
            expected_[number].a = own.a, expected_[number].b = own.b;
            expected_[number].reach =
                std::max(std::sqrt(length_squared(own.a)), std::sqrt(length_squared(own.b)));
            if ((bodies.flags_of(row) & kKinematic) != 0) continue;
            const Rotation turn = rotation_by(static_cast<double>(bodies.angle[row]));
            const Vec2 place{bodies.position_x[row], bodies.position_y[row]};
            const Vec2 a = place + rotate(turn, own.a), b = place + rotate(turn, own.b);
            const double length = std::sqrt(length_squared(b - a));
            ends_.push_back({a, b, length, static_cast<int>(number)});
            ends_.push_back({b, a, length, static_cast<int>(number)});
        }
        joined_.resize(ends_.size(), kNone);
        join();
        for (std::size_t end = 0; end < ends_.size(); end += 2)
            if (expected(end).track < 0 && (joined_[end] != kNone || joined_[end + 1] != kNone))
                make_track(end);
    }

    const std::vector<Expected>& all() const { return expected_; }
    int most_in_a_place() const { return most_in_a_place_; }
    int joined_count() const {
        return static_cast<int>(
            std::count_if(joined_.begin(), joined_.end(), [](std::size_t end) { return end != kNone; }));
    }

  private:
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    struct Meeting {
        double cosine;
        std::size_t i, j;
    };

    Expected& expected(std::size_t end) { return expected_[static_cast<std::size_t>(ends_[end].number)]; }
    int edge_of(std::size_t end) const {
        return end == kNone ? -1 : world_.edges.bodies[static_cast<std::size_t>(ends_[end].number)].first;
    }
    bool are_alike(std::size_t i, std::size_t j) const {
        const auto row_of = [&](std::size_t end) {
            const EdgeBody& body = world_.edges.bodies[static_cast<std::size_t>(ends_[end].number)];
            return world_.handles.row_of_slot(body.id.index);
        };
        return world_.bodies.are_filtered_alike(row_of(i), row_of(j));
    }

    void join() {
        std::vector<Meeting> meetings;
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            int in_this_place = 1;
            for (std::size_t j = 0; j < ends_.size(); ++j) {
                const End &one = ends_[i], &other = ends_[j];
                const double shorter = std::min(one.length, other.length), near = 1e-6 * shorter;
                const auto is_off = [&](Vec2 p, const End& end) {
                    return distance_squared(p, end.at, end.other) > near * near;
                };
                if (one.number == other.number ||
                    length_squared(one.at - other.at) > 0.01 * 0.01 * shorter * shorter ||
                    is_off(one.at, other) || is_off(other.at, one))
                    continue;
                ++in_this_place;
                const double cosine =
                    dot(one.at - one.other, other.other - other.at) / (one.length * other.length);
                if (i < j && cosine > -0.99 && are_alike(i, j)) meetings.push_back({cosine, i, j});
            }
            most_in_a_place_ = std::max(most_in_a_place_, in_this_place);
        }
        std::stable_sort(meetings.begin(), meetings.end(),
                         [](const Meeting& l, const Meeting& r) { return l.cosine > r.cosine; });
        for (const Meeting& meeting : meetings)
            if (joined_[meeting.i] == kNone && joined_[meeting.j] == kNone)
                joined_[meeting.i] = meeting.j, joined_[meeting.j] = meeting.i;
    }

    /// From the first end of its first segment, both ways.
    void make_track(std::size_t first) {
        std::size_t begin = first;
        while (joined_[begin] != kNone && (joined_[begin] ^ 1U) != first) begin = joined_[begin] ^ 1U;
        if (joined_[begin] != kNone) begin = first;
        std::size_t in = begin;
        do {
            Expected& made = expected(in);
            const std::size_t out = in ^ 1U;
            made = {ends_[in].at,          ends_[out].at,       edge_of(joined_[in]),
                    edge_of(joined_[out]), ends_[first].number, 0};
            made.reach = std::sqrt(std::max(length_squared(made.a), length_squared(made.b)));
            in = joined_[out];
        } while (in != kNone && in != begin);
    }

    const WorldState<Real>& world_;
    std::vector<Expected> expected_;
    std::vector<End> ends_;
    std::vector<std::size_t> joined_;
    int most_in_a_place_ = 0;
};

/// @return how many segments differ in a bit from what joining all of them makes
template <class Real>
int differences(const WorldState<Real>& world, const Ends<Real>& ends) {
    int count = 0;
    for (std::size_t number = 0; number < ends.all().size(); ++number) {
        const EdgeBody& body = world.edges.bodies[number];
        if (body.count != 1) continue;
        const Edge& edge = world.edges[body.first];
        const Expected& wanted = ends.all()[number];
        count += !(edge.a == wanted.a && edge.b == wanted.b && edge.previous == wanted.previous &&
                   edge.next == wanted.next && body.track == wanted.track && body.reach == wanted.reach &&
                   edge.body == static_cast<std::int32_t>(number));
    }
    return count;
}

}  // namespace

TEST_SUITE("state/edge_tracks") {
    TEST_CASE_TEMPLATE("joining what has changed makes what joining all anew does, bit by bit", Real, float,
                       double) {
        int most = 0, joined = 0;
        for (unsigned seed = 1; seed <= test::scaled(12u, 4u); ++seed) {
            CAPTURE(seed);
            std::mt19937 random(seed);
            const auto any = [&](int count) {
                return static_cast<int>(random() % static_cast<unsigned>(count));
            };
            WorldState<Real> world;
            world.bodies.has_rotation = true;
            std::vector<BodyId> ids;
            const auto row_of = [&](BodyId id) { return world.handles.row_of_slot(id.index); };
            const auto some_place = [&] {
                return Vec2{static_cast<double>(any(kSide)), static_cast<double>(any(kSide))};
            };
            const auto some_segment = [&] {
                Vec2 a = some_place(), b = some_place();
                while (a == b) b = some_place();
                // Some overlap, and some miss by a rounding.
                if (any(8) == 0) a = a + 0.003 * (a - b);
                if (any(4) == 0) b = b + Vec2{1e-8, -1e-8};
                Body body{.type = any(9) == 0 ? BodyType::kinematic_body : BodyType::static_body,
                          .shape = Segment{a, b},
                          .category = static_cast<std::uint16_t>(any(12) == 0 ? 2 : 1)};
                if (any(3) == 0) {
                    body.position = some_place();
                    body.shape = Segment{a - body.position, b - body.position};
                }
                if (any(10) == 0) body.shape = Chain{.points = {{0, 0}, {1, 0}, {1, 1}}};
                return body;
            };
            for (int turn = 0; turn < 250; ++turn) {
                for (int i = any(4); i >= 0; --i) {
                    const bool adds = ids.empty() || any(turn < 60 ? 2 : 5) == 0;
                    const auto which = adds ? 0 : random() % ids.size();
                    const int what = any(4);
                    if (adds) {
                        ids.push_back(world.append(some_segment()));
                    } else if (what == 0) {
                        world.remove(row_of(ids[which]));
                        ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(which));
                    } else if (what == 1) {
                        world.edges.note_change(ids[which]);
                        world.bodies.set_filter(row_of(ids[which]), static_cast<std::uint16_t>(1 + any(2)),
                                                3);
                    } else {
                        world.edges.note_change(ids[which]);
                        const Vec2 by = some_place();
                        world.bodies.position_x[row_of(ids[which])] = static_cast<Real>(by.x);
                        world.bodies.position_y[row_of(ids[which])] = static_cast<Real>(by.y);
                    }
                }
                join_segments(world);
                CHECK_FALSE(world.edges.has_changes());
                CHECK_FALSE(join_segments(world));
                const Ends<Real> ends(world);
                REQUIRE(differences(world, ends) == 0);
                most = std::max(most, ends.most_in_a_place()), joined += ends.joined_count();
            }
        }
        CHECK(most >= 5);
        CHECK(joined > 5000);
    }

    TEST_CASE("a segment that comes takes the place of one that went") {
        WorldState<double> world;
        world.bodies.has_rotation = true;
        std::vector<BodyId> ids;
        for (int i = 0; i < 10; ++i)
            ids.push_back(
                world.append({.type = BodyType::static_body, .shape = Segment{{1.0 * i, 0}, {i + 1.0, 0}}}));
        const std::size_t bytes = world.edges.edges.size();
        for (int i = 0; i < 100; ++i) {
            const auto which = static_cast<std::size_t>(i % 10);
            world.remove(world.handles.row_of_slot(ids[which].index));
            ids[which] = world.append(
                {.type = BodyType::static_body, .shape = Segment{{1.0 * (i % 10), 0}, {i % 10 + 1.0, 0}}});
            join_segments(world);
        }
        CHECK(world.edges.edges.size() == bytes);
        CHECK(world.edges.bodies.size() == 10);
        CHECK(differences(world, Ends<double>(world)) == 0);
        for (const BodyId id : ids) world.remove(world.handles.row_of_slot(id.index));
        CHECK(world.edges.empty());
    }
}

}  // namespace test_edge_tracks
