#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

constexpr std::string_view kVertices = "/shape/polygon/vertices";

std::optional<Problem> find_point_problem(const Item& item, std::string_view pointer, Vec2 point) {
    static constexpr Quantity kPointX{"point x", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    static constexpr Quantity kPointY{"point y", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    if (auto found = check(item, join(pointer, "/0"), point.x, kPointX)) return found;
    return check(item, join(pointer, "/1"), point.y, kPointY);
}

/// Nothing of the edges' own: only what says that this body cannot have any.
std::optional<Problem> find_edge_body_problem(const Item& item, const Body& body, std::string_view shape) {
    if (body.type != BodyType::dynamic_body) return std::nullopt;
    return problem(ErrorCode::inconsistent, item, "/type", "the shape ", quoted(shape),
                   " but is dynamic; expected static or kinematic, as a line has no area and so no mass. Set "
                   "its type, or make it a disc.");
}

std::optional<Problem> find_length_problem(const Item& item, std::string_view pointer, std::string_view ends,
                                           Vec2 a, Vec2 b) {
    const double length = std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
    if (length >= kSmallestEdge) return std::nullopt;
    return problem(ErrorCode::out_of_range, item, pointer, "an edge of length ", length, " m from ", a,
                   " to ", b, ", ", ends, "; expected at least ", kSmallestEdge,
                   " m. Move one of the two points, or leave it out.");
}

std::optional<Problem> find_segment_problem(const Item& item, const Body& body, const Segment& segment) {
    if (auto found = find_edge_body_problem(item, body, "segment")) return found;
    if (auto found = find_point_problem(item, "/shape/segment/a", segment.a)) return found;
    if (auto found = find_point_problem(item, "/shape/segment/b", segment.b)) return found;
    return find_length_problem(item, "/shape/segment/b", "a and b", segment.a, segment.b);
}

std::optional<Problem> find_chain_problem(const Item& item, const Body& body, const Chain& chain) {
    constexpr std::string_view kPoints = "/shape/chain/points";
    if (auto found = find_edge_body_problem(item, body, "chain")) return found;
    const std::size_t count = chain.points.size(), fewest = chain.loop ? 3 : 2;
    if (count < fewest)
        return problem(ErrorCode::out_of_range, item, kPoints, "a chain of ", count,
                       chain.loop ? " points that is a loop" : " points", "; expected at least ", fewest,
                       chain.loop ? ". Add points, or set loop to false." : ". Add points.");
    if (count > kLargestChainPoints)
        return problem(ErrorCode::too_large, item, kPoints, "a chain of ", count,
                       " points; expected at most ", kLargestChainPoints, ". Cut it into several bodies.");
    for (std::size_t i = 0; i < count; ++i) {
        const std::string pointer = join(kPoints, "/", i);
        if (auto found = find_point_problem(item, pointer, chain.points[i])) return found;
        if (i == 0) continue;
        if (auto found = find_length_problem(item, pointer, join("points ", i - 1, " and ", i),
                                             chain.points[i - 1], chain.points[i]))
            return found;
    }
    if (!chain.loop) return std::nullopt;
    return find_length_problem(item, join(kPoints, "/", count - 1),
                               "the last point and the first, which a loop joins by itself",
                               chain.points.back(), chain.points.front());
}

/// A convex shape that reaches too far, or is too thin to be told from a line.
std::optional<Problem> find_size_problem(const Item& item, const Shape& shape) {
    const auto [extent, inradius] = [&] {
        const ConvexShape<double> convex = convex_shape_of<double>(shape);
        return std::pair{convex.extent, convex.inradius};
    }();
    const std::string pointer = join("/shape/", name_of(shape)), words = join("a ", name_of(shape));
    if (extent > kLargestRadius)
        return problem(ErrorCode::out_of_range, item, pointer, words, " that reaches ", extent,
                       " m from its centre; expected at most ", kLargestRadius, " m. ", kUseMetres);
    if (inradius < kSmallestRadius)
        return problem(ErrorCode::out_of_range, item, pointer, words, " whose surface is ", inradius,
                       " m from its centre; expected at least ", kSmallestRadius, " m. ", kUseMetres);
    if (extent <= kLargestAspect * inradius) return std::nullopt;
    return problem(ErrorCode::out_of_range, item, pointer, words, " that reaches ", extent,
                   " m from its centre and is ", 2 * inradius, " m thick there; expected a reach of at most ",
                   kLargestAspect, " times half of the thickness. Make it thicker, or shorter.");
}

std::optional<Problem> find_box_problem(const Item& item, const Box& box) {
    if (auto found = check(item, "/shape/box/width", box.width, kWidth)) return found;
    if (auto found = check(item, "/shape/box/height", box.height, kHeight)) return found;
    return find_size_problem(item, box);
}

std::optional<Problem> find_capsule_problem(const Item& item, const Capsule& capsule) {
    if (auto found = check(item, "/shape/capsule/length", capsule.length, kCapsuleLength)) return found;
    if (auto found = check(item, "/shape/capsule/radius", capsule.radius, kRadius)) return found;
    return find_size_problem(item, capsule);
}

/// Vertices in one place, to rounding.
std::optional<Problem> find_coincident_problem(const Item& item, const std::vector<Vec2>& vertices) {
    double size = 0;
    for (const Vec2 vertex : vertices)
        size = std::fmax(size, std::sqrt(length_squared(vertex - vertices[0])));
    const double least = std::fmax(kSmallestEdge, kSmallestEdgeShare * size);
    for (std::size_t b = 1; b < vertices.size(); ++b)
        for (std::size_t a = 0; a < b; ++a) {
            const double apart = std::sqrt(length_squared(vertices[b] - vertices[a]));
            if (apart >= least) continue;
            return problem(ErrorCode::out_of_range, item, join(kVertices, "/", b), "vertices ", a, " and ", b,
                           " that are ", apart, " m apart; expected at least ", least,
                           " m, which single precision tells apart at this size. Leave one of them out.");
        }
    return std::nullopt;
}

/// Corners that turn the wrong way, or hardly at all.
std::optional<Problem> find_corner_problem(const Item& item, const std::vector<Vec2>& vertices) {
    const std::size_t count = vertices.size();
    double twice_area = 0;
    for (std::size_t i = 1; i + 1 < count; ++i)
        twice_area += cross(vertices[i] - vertices[0], vertices[i + 1] - vertices[0]);
    const double direction = twice_area < 0 ? -1 : 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = (i + 1) % count;
        const Vec2 before = vertices[at] - vertices[i], after = vertices[(i + 2) % count] - vertices[at];
        const double sine =
            direction * cross(before, after) / std::sqrt(length_squared(before) * length_squared(after));
        const std::string pointer = join(kVertices, "/", at);
        if (sine < -kSmallestCornerSine)
            return problem(ErrorCode::inconsistent, item, pointer, "a dent at vertex ", at, ", ",
                           vertices[at],
                           "; expected a convex polygon, which turns one way at all "
                           "vertices. Cut it into convex bodies, or leave the vertex out.");
        if (!(sine >= kSmallestCornerSine))
            return problem(ErrorCode::inconsistent, item, pointer, "vertex ", at, ", ", vertices[at],
                           ", on one line with those beside it; expected a turn of at least ",
                           kSmallestCornerSine, " rad. Leave the vertex out.");
    }
    return std::nullopt;
}

/// A polygon that turns one way at every vertex may still go around more than once, as a star does.
std::optional<Problem> find_winding_problem(const Item& item, const std::vector<Vec2>& vertices) {
    const std::size_t count = vertices.size();
    const double direction = cross(vertices[1] - vertices[0], vertices[2] - vertices[1]) < 0 ? -1 : 1;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 2; k < count; ++k) {
            const Vec2 from = vertices[i], along = vertices[(i + 1) % count] - from;
            const std::size_t other = (i + k) % count;
            if (direction * cross(along, vertices[other] - from) > 0) continue;
            return problem(ErrorCode::inconsistent, item, join(kVertices, "/", other), "vertex ", other, ", ",
                           vertices[other], ", outside the edge that begins at vertex ", i,
                           "; expected the vertices of a convex polygon in their order around it. Sort them "
                           "by the direction from their middle.");
        }
    return std::nullopt;
}

std::optional<Problem> find_polygon_problem(const Item& item, const Polygon& polygon) {
    static constexpr Quantity kVertexX{"vertex x", "m", -kLargestRadius, kLargestRadius, kUseMetres};
    static constexpr Quantity kVertexY{"vertex y", "m", -kLargestRadius, kLargestRadius, kUseMetres};
    const std::size_t count = polygon.vertices.size();
    if (count < kFewestPolygonVertices || count > kLargestPolygonVertices)
        return problem(ErrorCode::out_of_range, item, kVertices, "a polygon of ", count,
                       " vertices; expected ", kFewestPolygonVertices, " to ", kLargestPolygonVertices,
                       count < kFewestPolygonVertices ? ". Add vertices, or use a capsule."
                                                      : ". Leave some out, or cut it into several bodies.");
    for (std::size_t i = 0; i < count; ++i) {
        const std::string pointer = join(kVertices, "/", i);
        if (auto found = check(item, pointer + "/0", polygon.vertices[i].x, kVertexX)) return found;
        if (auto found = check(item, pointer + "/1", polygon.vertices[i].y, kVertexY)) return found;
    }
    if (auto found = check(item, "/shape/polygon/radius", polygon.radius, kCornerRadius)) return found;
    if (auto found = find_coincident_problem(item, polygon.vertices)) return found;
    if (auto found = find_corner_problem(item, polygon.vertices)) return found;
    if (auto found = find_winding_problem(item, polygon.vertices)) return found;
    return find_size_problem(item, polygon);
}

/// What is wrong with a piece, told where the piece stands.
std::optional<Problem> find_piece_problem(const Item& item, const Body& body, const Piece& piece,
                                          const std::string& pointer) {
    const auto in_piece = [&](std::optional<Problem> found) {
        if (found) found->pointer.insert(item.path().size(), pointer);
        return found;
    };
    static constexpr Quantity kPieceX{"x of a piece", "m", -kLargestRadius, kLargestRadius, kUseMetres};
    static constexpr Quantity kPieceY{"y of a piece", "m", -kLargestRadius, kLargestRadius, kUseMetres};
    Body alone;
    alone.type = body.type, alone.shape = shape_of(piece);
    if (auto found = find_shape_problem(item, alone)) return in_piece(found);
    if (auto found = check(item, "/position/0", piece.position.x, kPieceX)) return in_piece(found);
    if (auto found = check(item, "/position/1", piece.position.y, kPieceY)) return in_piece(found);
    if (auto found = check(item, "/angle", piece.angle, kAngle)) return in_piece(found);
    if (!piece.material) return std::nullopt;
    return in_piece(find_material_problem(item, "/material", *piece.material));
}

std::optional<Problem> find_compound_problem(const Item& item, const Body& body, const Compound& compound) {
    constexpr std::string_view kPieces = "/shape/compound/shapes";
    const std::size_t count = compound.pieces.size();
    if (count < 1 || count > kLargestPieceCount)
        return problem(ErrorCode::out_of_range, item, kPieces, "a compound of ", count,
                       " shapes; expected 1 to ", kLargestPieceCount,
                       count < 1 ? ". Add shapes." : ". Leave some out, or weld several bodies.");
    for (std::size_t i = 0; i < count; ++i)
        if (auto found = find_piece_problem(item, body, compound.pieces[i], join(kPieces, "/", i)))
            return found;
    if (auto found = find_material_problem(item, "/material", body.material)) return found;
    const CompoundSize size = compound_size_of(compound, body.material);
    if (size.extent > kLargestRadius)
        return problem(ErrorCode::out_of_range, item, kPieces, "a compound that reaches ", size.extent,
                       " m from its centre of mass; expected at most ", kLargestRadius, " m. ", kUseMetres);
    if (size.extent <= kLargestAspect * size.thinnest) return std::nullopt;
    return problem(ErrorCode::out_of_range, item, kPieces, "a compound that reaches ", size.extent,
                   " m from its centre of mass, with a piece ", 2 * size.thinnest,
                   " m thick; expected a reach of at most ", kLargestAspect,
                   " times half of the thickness. Make the piece thicker, or the compound smaller.");
}

}  // namespace

std::optional<Problem> find_shape_problem(const Item& item, const Body& body) {
    if (const auto* segment = std::get_if<Segment>(&body.shape))
        return find_segment_problem(item, body, *segment);
    if (const auto* chain = std::get_if<Chain>(&body.shape)) return find_chain_problem(item, body, *chain);
    if (const auto* box = std::get_if<Box>(&body.shape)) return find_box_problem(item, *box);
    if (const auto* capsule = std::get_if<Capsule>(&body.shape)) return find_capsule_problem(item, *capsule);
    if (const auto* polygon = std::get_if<Polygon>(&body.shape)) return find_polygon_problem(item, *polygon);
    if (const auto* compound = std::get_if<Compound>(&body.shape))
        return find_compound_problem(item, body, *compound);
    return check(item, "/shape/disc/radius", radius_of(body.shape), kRadius);
}

}  // namespace carom
