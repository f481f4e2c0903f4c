#include "state/edges.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom {
namespace {

/// Ends of a chain that are nearer than this share of the shorter of their edges are one point: a circle that
/// is drawn from 0 to 2 pi ends a rounding away from where it began.
constexpr double kSamePoint = 1e-6;
/// Fewest points of a chain that comes back to its first one: fewer lead there along the same line.
constexpr std::size_t kFewestOfClosed = 4;

bool is_closed(const Chain& chain) {
    if (chain.loop || chain.points.size() < kFewestOfClosed) return chain.loop;
    const auto& points = chain.points;
    const Vec2 gap = points.back() - points.front(), first = points[1] - points.front(),
               last = points.back() - points[points.size() - 2];
    const double shorter = std::fmin(length_squared(first), length_squared(last));
    return length_squared(gap) <= kSamePoint * kSamePoint * shorter;
}

void link(EdgeStore& store, const EdgeBody& body, bool is_loop) {
    for (std::int32_t n = 0; n < body.count; ++n) {
        Edge& edge = store.edges[static_cast<std::size_t>(body.first + n)];
        edge.previous = n > 0 ? body.first + n - 1 : is_loop ? body.first + body.count - 1 : -1;
        edge.next = n + 1 < body.count ? body.first + n + 1 : is_loop ? body.first : -1;
    }
}

}  // namespace

void EdgeStore::part() {
    if (!std::exchange(is_joined, false)) return;
    for (EdgeBody& body : bodies) {
        if (body.track < 0) continue;
        Edge& edge = edges[static_cast<std::size_t>(body.first)];
        edge.a = body.own_a, edge.b = body.own_b, edge.previous = edge.next = -1;
        body.track = -1, body.reach = body.own_reach;
        body.own_a = body.own_b = {}, body.own_reach = 0;
    }
}

void EdgeStore::append(BodyId id, const Shape& shape) {
    if (!std::holds_alternative<Segment>(shape) && !std::holds_alternative<Chain>(shape)) return;
    part();
    const auto number = static_cast<std::int32_t>(bodies.size());
    EdgeBody body{.id = id, .first = static_cast<std::int32_t>(edges.size())};
    const auto add = [&](Vec2 a, Vec2 b) {
        edges.push_back({a, b, number});
        ++body.count;
        for (const Vec2 point : {a, b}) body.reach = std::fmax(body.reach, std::sqrt(length_squared(point)));
    };
    bool is_loop = false;
    if (const auto* segment = std::get_if<Segment>(&shape)) {
        add(segment->a, segment->b);
    } else {
        const auto* chain = std::get_if<Chain>(&shape);
        is_loop = is_closed(*chain);
        for (std::size_t i = 0; i + 1 < chain->points.size(); ++i)
            add(chain->points[i], chain->points[i + 1]);
        if (chain->loop) add(chain->points.back(), chain->points.front());
    }
    link(*this, body, is_loop);
    append_boxes(body);
    bodies.push_back(body);
}

void EdgeStore::append_boxes(EdgeBody& body) {
    body.first_box = static_cast<std::int32_t>(boxes.size());
    Levels levels{};
    const std::size_t count = levels_of(body, levels);
    for (std::size_t level = 0; level < count; ++level) {
        const std::int32_t below = level > 0 ? levels[level - 1].count : body.count;
        for (std::int32_t i = 0; i < levels[level].count; ++i) {
            EdgeBox box{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
            const auto include = [&box](Vec2 point) {
                box.low = {std::fmin(box.low.x, point.x), std::fmin(box.low.y, point.y)};
                box.high = {std::fmax(box.high.x, point.x), std::fmax(box.high.y, point.y)};
            };
            for (std::int32_t n = kInABox * i; n < std::min(kInABox * (i + 1), below); ++n) {
                if (level == 0) {
                    const Edge& edge = (*this)[body.first + n];
                    include(edge.a), include(edge.b);
                    continue;
                }
                const EdgeBox& part = boxes[static_cast<std::size_t>(levels[level - 1].first + n)];
                include(part.low), include(part.high);
            }
            boxes.push_back(box);
        }
    }
    body.box_count = static_cast<std::int32_t>(boxes.size()) - body.first_box;
}

Shape EdgeStore::shape_of(BodyId id) const {
    const auto body =
        std::find_if(bodies.begin(), bodies.end(), [id](const EdgeBody& other) { return other.id == id; });
    const Edge& first = (*this)[body->first];
    if (body->count == 1)
        return body->track >= 0 ? Segment{body->own_a, body->own_b} : Segment{first.a, first.b};
    Chain chain{{first.a}, first.previous >= 0};
    for (std::int32_t n = 0; n + (chain.loop ? 1 : 0) < body->count; ++n)
        chain.points.push_back((*this)[body->first + n].b);
    return chain;
}

EdgeStore::Removed EdgeStore::remove(BodyId id) {
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [id](const EdgeBody& body) { return body.id == id; });
    if (found == bodies.end()) return {};
    part();
    const Removed gone{found->first, found->count};
    edges.erase(edges.begin() + gone.first, edges.begin() + gone.first + gone.count);
    const auto first_box = boxes.begin() + found->first_box;
    const std::int32_t gone_boxes = found->box_count;
    boxes.erase(first_box, first_box + gone_boxes);
    for (auto later = bodies.erase(found); later != bodies.end(); ++later)
        later->first -= gone.count, later->first_box -= gone_boxes;
    const auto move_up = [&gone](std::int32_t& edge) {
        if (edge >= 0) edge -= gone.count;
    };
    for (std::size_t i = static_cast<std::size_t>(gone.first); i < edges.size(); ++i) {
        --edges[i].body;
        move_up(edges[i].previous), move_up(edges[i].next);
    }
    return gone;
}

}  // namespace carom
