#include "shapes/edges.hpp"

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

std::int32_t EdgeStore::number_of(BodyId id) const {
    return id.index < numbers_.size() ? numbers_[id.index] : -1;
}

/// Lists what may have met the ends of a segment.
void EdgeStore::touch_around(std::int32_t number) {
    const StandingSegment& segment = segments[static_cast<std::size_t>(number)];
    const double near = kMostOverlap * std::sqrt(length_squared(segment.b - segment.a));
    std::vector<std::int32_t> found;
    for (const Vec2 end : {segment.a, segment.b}) {
        standing.find(box_around(end, near), found);
        for (const std::int32_t other : found)
            if (other != number) touched.push_back(other);
    }
}

void EdgeStore::part(std::int32_t number) {
    if (bodies[static_cast<std::size_t>(number)].track < 0) return;
    StandingSegment& segment = segments[static_cast<std::size_t>(number)];
    EdgeBody& body = bodies[static_cast<std::size_t>(number)];
    Edge& edge = edges[static_cast<std::size_t>(body.first)];
    for (std::int32_t& end : segment.joined) {
        if (end != StandingSegment::kAlone)
            segments[static_cast<std::size_t>(end / 2)].joined[static_cast<std::size_t>(end % 2)] =
                StandingSegment::kAlone;
        end = StandingSegment::kAlone;
    }
    for (const std::int32_t neighbour : {edge.previous, edge.next}) {
        if (neighbour < 0) continue;
        Edge& other = edges[static_cast<std::size_t>(neighbour)];
        if (other.previous == body.first) other.previous = -1;
        if (other.next == body.first) other.next = -1;
    }
    edge.a = segment.own_a, edge.b = segment.own_b, edge.previous = edge.next = -1;
    body.track = -1, body.reach = segment.own_reach;
    segment.own_a = segment.own_b = {}, segment.own_reach = 0;
}

void EdgeStore::note_change(BodyId id) {
    const std::int32_t number = number_of(id);
    StandingSegment& segment = segments[static_cast<std::size_t>(number)];
    if (segment.marks != 0 || std::binary_search(movers.begin(), movers.end(), number)) return;
    standing.remove(number);
    if (segment.may_join != 0) touch_around(number);
    part(number);
    segment.marks = 1, changed.push_back(number);
}

/// A number for a body that comes, with room for it.
std::int32_t EdgeStore::take_number(BodyId id, bool is_segment) {
    const auto take = [](std::vector<std::int32_t>& numbers) {
        const std::int32_t number = numbers.back();
        numbers.pop_back();
        return number;
    };
    if (numbers_.size() <= id.index) numbers_.resize(id.index + std::size_t{1}, -1);
    auto number = static_cast<std::int32_t>(bodies.size());
    if (is_segment && !free_with_edge_.empty()) {
        number = take(free_with_edge_);
    } else {
        if (!free_.empty())
            number = take(free_);
        else
            bodies.push_back({}), segments.push_back({});
        bodies[static_cast<std::size_t>(number)].first = static_cast<std::int32_t>(edges.size());
        if (is_segment) edges.push_back({});
    }
    return numbers_[id.index] = number;
}

void EdgeStore::append(BodyId id, const Shape& shape, bool moves) {
    const auto* segment = std::get_if<Segment>(&shape);
    const auto* chain = std::get_if<Chain>(&shape);
    if (!segment && !chain) return;
    const std::int32_t number = take_number(id, segment != nullptr);
    EdgeBody body{.id = id, .first = bodies[static_cast<std::size_t>(number)].first};
    const auto add = [&](Vec2 a, Vec2 b) {
        const Edge edge{a, b, number};
        const std::int32_t place = body.first + body.count++;
        if (segment)
            edges[static_cast<std::size_t>(place)] = edge;
        else
            edges.push_back(edge);
        for (const Vec2 point : {a, b}) body.reach = std::fmax(body.reach, std::sqrt(length_squared(point)));
    };
    bool is_loop = false;
    if (segment) {
        add(segment->a, segment->b);
    } else {
        is_loop = is_closed(*chain);
        for (std::size_t i = 0; i + 1 < chain->points.size(); ++i)
            add(chain->points[i], chain->points[i + 1]);
        if (chain->loop) add(chain->points.back(), chain->points.front());
    }
    link(*this, body, is_loop);
    append_boxes(body);
    bodies[static_cast<std::size_t>(number)] = body;
    if (moves) {
        movers.insert(std::lower_bound(movers.begin(), movers.end(), number), number);
        return;
    }
    segments[static_cast<std::size_t>(number)].marks = 1, changed.push_back(number);
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
    const auto number = static_cast<std::size_t>(number_of(id));
    const EdgeBody& body = bodies[number];
    const Edge& first = (*this)[body.first];
    if (body.count == 1)
        return body.track >= 0 ? Segment{segments[number].own_a, segments[number].own_b}
                               : Segment{first.a, first.b};
    Chain chain{{first.a}, first.previous >= 0};
    for (std::int32_t n = 0; n + (chain.loop ? 1 : 0) < body.count; ++n)
        chain.points.push_back((*this)[body.first + n].b);
    return chain;
}

EdgeStore::Removed EdgeStore::remove(BodyId id) {
    const std::int32_t number = number_of(id);
    if (number < 0) return {};
    note_change(id);
    for (std::vector<std::int32_t>* const list : {&movers, &changed, &touched}) std::erase(*list, number);
    numbers_[id.index] = -1;
    segments[static_cast<std::size_t>(number)] = {};
    const EdgeBody gone = std::exchange(bodies[static_cast<std::size_t>(number)],
                                        {.id = {}, .first = bodies[static_cast<std::size_t>(number)].first});
    if (gone.count == 1 && gone.box_count == 0) {
        free_with_edge_.push_back(number);
        return {gone.first, 1, 0};
    }
    free_.push_back(number);
    edges.erase(edges.begin() + gone.first, edges.begin() + gone.first + gone.count);
    const auto first_box = boxes.begin() + gone.first_box;
    boxes.erase(first_box, first_box + gone.box_count);
    const auto move_up = [&gone](std::int32_t& edge) {
        if (edge > gone.first) edge -= gone.count;
    };
    for (EdgeBody& body : bodies) {
        move_up(body.first);
        if (body.first_box > gone.first_box) body.first_box -= gone.box_count;
    }
    for (Edge& edge : edges) move_up(edge.previous), move_up(edge.next);
    return {gone.first, gone.count, gone.count};
}

std::size_t EdgeStore::bytes() const {
    return bodies.capacity() * sizeof(EdgeBody) + edges.capacity() * sizeof(Edge) +
           boxes.capacity() * sizeof(EdgeBox) + segments.capacity() * sizeof(StandingSegment) +
           standing.bytes() +
           (movers.capacity() + changed.capacity() + touched.capacity() + placed.capacity() +
            numbers_.capacity() + free_.capacity() + free_with_edge_.capacity()) *
               sizeof(std::int32_t);
}

}  // namespace carom
