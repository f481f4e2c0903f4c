#include "report/frames/picture.hpp"

#include <cairo/cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "report/frames/quantised_frame.hpp"
#include "report/readers/result_error.hpp"

namespace carom::report {
namespace {

constexpr double kMargin = 0.03;                     // of the scene's size
constexpr double kFlattest = 1.0 / 3, kTallest = 2;  // height of a picture / width
constexpr std::size_t kMostSegments = 60'000;        // of all trails in a picture
constexpr std::size_t kFewBodies = 50;               // up to which bodies without a colour get one each
constexpr double kSmallestMark = 4;                  // pixels of radius
constexpr double kOutline = 1;                       // pixels
constexpr double kFullCircle = 2 * std::numbers::pi;
// The page's light palette (web/theme.js).
constexpr std::array<std::uint32_t, 8> kPalette{0x0072b2, 0xc2410c, 0x00815f, 0xb5568f,
                                                0xa06a00, 0x2a8fd0, 0x5b3fa0, 0x5b5b5b};

/// An even number of pixels: videos need that.
int even(double pixels) {
    return 2 * static_cast<int>(std::lround(pixels / 2));
}

}  // namespace

struct Picture::Surface {
    cairo_surface_t* image;
    cairo_t* pen;

    Surface(int width, int height)
        : image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), pen(cairo_create(image)) {}
    ~Surface() {
        cairo_destroy(pen);
        cairo_surface_destroy(image);
    }
    Surface(const Surface&) = delete;
    Surface& operator=(const Surface&) = delete;
};

Picture::Picture(const std::filesystem::path& trajectory_h5, int width)
    : trajectory_(trajectory_h5),
      time_(trajectory_.times()),
      radius_(trajectory_.body_column("radius")),
      settings_(trajectory_.json("settings")),
      edges_(edge_bodies(settings_)),
      shapes_(drawn_shapes(settings_)),
      shape_(shape_of_bodies(trajectory_)),
      joints_(joint_lines(settings_, trajectory_.json("breaks"))),
      trail_(settings_.is_object() ? settings_.value("trail", std::size_t{0}) : 0),
      width_(width) {
    if (time_.empty()) throw ResultError(trajectory_h5.string() + ": has no frames to draw");
    trail_ = std::min(trail_, kMostSegments / std::max<std::size_t>(1, trajectory_.body_count()));
    choose_colours();
    box_ = world();
    const double wide = box_.max_x - box_.min_x, tall = box_.max_y - box_.min_y;
    height_ = even(width_ * std::clamp(tall / wide, kFlattest, kTallest));
    scale_ = std::min(width_ / wide, height_ / tall) / (1 + 2 * kMargin);
    left_ = (width_ - scale_ * wide) / 2;
    top_ = (height_ - scale_ * tall) / 2;
    surface_ = std::make_unique<Surface>(width_, height_);
}

Picture::~Picture() = default;

/// The walls, or all that bodies reach in any frame.
Picture::Box Picture::world() const {
    if (settings_.is_object() && settings_.contains("walls") && settings_["walls"].is_object()) {
        const Json& walls = settings_["walls"];
        return {walls["min"][0], walls["min"][1], walls["max"][0], walls["max"][1]};
    }
    Box box{INFINITY, INFINITY, -INFINITY, -INFINITY};
    std::vector<float> position(2 * trajectory_.body_count());
    for (std::size_t frame = 0; frame < time_.size(); ++frame) {
        trajectory_.read_frame("position", frame, position);
        const Scale across = drawn_range(position, 0), up = drawn_range(position, 1);
        constexpr double kSteps = kNowhere - 1;
        box.min_x = std::min(box.min_x, across.base);
        box.max_x = std::max(box.max_x, across.base + kSteps * across.step);
        box.min_y = std::min(box.min_y, up.base);
        box.max_y = std::max(box.max_y, up.base + kSteps * up.step);
    }
    add_shapes(box);
    add_edges(box);
    return box;
}

/// Room for what bodies reach beyond their places: the largest radius all around, but for shapes that stay
/// where they are, as a floor, the room they need there.
void Picture::add_shapes(Box& box) const {
    std::vector<float> first(2 * trajectory_.body_count()), last(first);
    trajectory_.read_frame("position", 0, first);
    trajectory_.read_frame("position", time_.size() - 1, last);
    const std::vector<float> angle = shape_.empty() ? std::vector<float>{} : angles(0);
    double around = radius_.empty() ? 1 : 0;
    Box floors = box;
    for (std::size_t body = 0; body < radius_.size(); ++body) {
        const double px = first[2 * body], py = first[2 * body + 1];
        if (!has_shape(body) || first[2 * body] != last[2 * body] ||
            first[2 * body + 1] != last[2 * body + 1]) {
            around = std::max(around, radius_[body]);
            continue;
        }
        const double turn = angle.empty() ? 0 : static_cast<double>(angle[body]);
        const DrawnShape& shape = shape_of(body);
        for (std::size_t i = 0; i < shape.x.size(); ++i) {
            const double at_x = px + std::cos(turn) * shape.x[i] - std::sin(turn) * shape.y[i],
                         at_y = py + std::sin(turn) * shape.x[i] + std::cos(turn) * shape.y[i];
            floors = {std::min(floors.min_x, at_x), std::min(floors.min_y, at_y),
                      std::max(floors.max_x, at_x), std::max(floors.max_y, at_y)};
        }
    }
    box = {std::min(box.min_x - around, floors.min_x), std::min(box.min_y - around, floors.min_y),
           std::max(box.max_x + around, floors.max_x), std::max(box.max_y + around, floors.max_y)};
}

/// Room for segments and chains: where they are, of those that stay; of those that move, all around them.
void Picture::add_edges(Box& box) const {
    if (edges_.empty()) return;
    std::vector<float> first(2 * trajectory_.body_count()), last(first);
    trajectory_.read_frame("position", 0, first);
    trajectory_.read_frame("position", time_.size() - 1, last);
    const std::vector<float> angle = angles(0), end = angles(time_.size() - 1);
    const auto add = [&box](double at_x, double at_y) {
        box = {std::min(box.min_x, at_x), std::min(box.min_y, at_y), std::max(box.max_x, at_x),
               std::max(box.max_y, at_y)};
    };
    for (const EdgeBody& edges : edges_) {
        const std::size_t x_of = 2 * edges.body, y_of = x_of + 1;
        const double px = first[x_of], py = first[y_of];
        const bool turns = !angle.empty() && angle[edges.body] != end[edges.body];
        if (turns || first[x_of] != last[x_of] || first[y_of] != last[y_of]) {
            add(px - edges.reach, py - edges.reach);
            add(px + edges.reach, py + edges.reach);
            continue;
        }
        const double turn = angle.empty() ? 0 : static_cast<double>(angle[edges.body]);
        const double c = std::cos(turn), s = std::sin(turn);
        for (std::size_t i = 0; i < edges.x.size(); ++i)
            add(px + c * edges.x[i] - s * edges.y[i], py + s * edges.x[i] + c * edges.y[i]);
    }
}

void Picture::choose_colours() {
    std::vector<double> colours;
    if (trajectory_.has("color")) colours = trajectory_.body_column("color");
    const std::size_t bodies = trajectory_.body_count();
    for (std::size_t body = 0; body < bodies; ++body) {
        const bool own = body < colours.size() && colours[body] != kNoColour;
        const auto rgb = own ? static_cast<std::uint32_t>(colours[body])
                             : kPalette[bodies <= kFewBodies ? body % kPalette.size() : 0];
        const auto part = [rgb](int shift) { return (rgb >> shift & 255) / 255.0; };
        colour_.push_back({part(16), part(8), part(0)});
    }
}

std::size_t Picture::frame_at(double time) const {
    const auto later = std::upper_bound(time_.begin(), time_.end(), time);
    return later == time_.begin() ? 0 : static_cast<std::size_t>(later - time_.begin()) - 1;
}

const std::vector<float>& Picture::positions(std::size_t frame) {
    remembered_.resize(trail_ + 1, {.frame = SIZE_MAX, .position = {}});
    Remembered& place = remembered_[frame % remembered_.size()];
    if (place.frame != frame) {
        place.position.resize(2 * trajectory_.body_count());
        trajectory_.read_frame("position", frame, place.position);
        place.frame = frame;
    }
    return place.position;
}

void Picture::draw(std::size_t frame) {
    cairo_t* const pen = surface_->pen;
    cairo_set_source_rgb(pen, 1, 1, 1);
    cairo_paint(pen);
    draw_trails(frame);
    draw_bodies(frame);
    draw_rotation_marks(frame);
    draw_walls();
    draw_edges(frame);
    draw_joints(frame);
    draw_time(frame);
    cairo_surface_flush(surface_->image);
}

void Picture::draw_trails(std::size_t frame) {
    cairo_t* const pen = surface_->pen;
    const std::size_t length = std::min(trail_, frame);
    cairo_set_line_width(pen, 2);
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
    for (std::size_t age = length; age > 0; --age) {
        const double strength = 0.85 * (1 - static_cast<double>(age - 1) / static_cast<double>(length));
        const std::vector<float>&from = positions(frame - age), &to = positions(frame - age + 1);
        for (std::size_t body = 0; body < colour_.size(); ++body) {
            const auto [red, green, blue] = colour_[body];
            cairo_set_source_rgba(pen, red, green, blue, strength);
            cairo_move_to(pen, x(from[2 * body]), y(from[2 * body + 1]));
            cairo_line_to(pen, x(to[2 * body]), y(to[2 * body + 1]));
            cairo_stroke(pen);
        }
    }
}

void Picture::draw_bodies(std::size_t frame) {
    cairo_t* const pen = surface_->pen;
    const std::vector<float>& position = positions(frame);
    const std::vector<float> angle = shape_.empty() ? std::vector<float>{} : angles(frame);
    cairo_set_line_width(pen, kOutline);
    cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
    for (std::size_t body = 0; body < colour_.size(); ++body) {
        if (radius_[body] == 0) continue;  // lines
        const double px = x(position[2 * body]), py = y(position[2 * body + 1]);
        const double r = std::max(radius_[body] * scale_, 0.5);
        if (!(px > -r && px < width_ + r && py > -r && py < height_ + r)) continue;
        cairo_set_source_rgb(pen, colour_[body].red, colour_[body].green, colour_[body].blue);
        if (!has_shape(body)) {
            cairo_arc(pen, px, py, r, 0, kFullCircle);
            cairo_fill(pen);
            continue;
        }
        trace_shape(body, px, py, angle.empty() ? 0 : static_cast<double>(angle[body]));
        cairo_fill_preserve(pen);
        if (r >= kSmallestMark) {  // an outline in the ground's colour tells those apart that touch
            cairo_set_source_rgb(pen, 1, 1, 1);
            cairo_stroke(pen);
        }
        cairo_new_path(pen);
    }
}

void Picture::trace_shape(std::size_t body, double px, double py, double angle) {
    const DrawnShape& shape = shape_of(body);
    const double cos = std::cos(angle) * scale_, sin = std::sin(angle) * scale_;
    auto start = shape.starts.begin();
    for (std::size_t i = 0; i < shape.x.size(); ++i) {
        if (start != shape.starts.end() && i == *start) {
            if (i > 0) cairo_close_path(surface_->pen);
            cairo_new_sub_path(surface_->pen), ++start;
        }
        cairo_line_to(surface_->pen, px + cos * shape.x[i] - sin * shape.y[i],
                      py - sin * shape.x[i] - cos * shape.y[i]);
    }
    cairo_close_path(surface_->pen);
}

void Picture::draw_rotation_marks(std::size_t frame) {
    const std::vector<float> angle = angles(frame);
    const std::vector<float>& position = positions(frame);
    cairo_t* const pen = surface_->pen;
    cairo_set_source_rgb(pen, 1, 1, 1);
    cairo_set_line_width(pen, 1.5);
    for (std::size_t body = 0; body < angle.size(); ++body) {
        const double reach = has_shape(body) ? shape_of(body).mark : radius_[body];
        const double r = reach * scale_, px = x(position[2 * body]), py = y(position[2 * body + 1]);
        if (r < kSmallestMark) continue;
        cairo_move_to(pen, px, py);
        cairo_line_to(pen, px + r * std::cos(angle[body]), py - r * std::sin(angle[body]));
        cairo_stroke(pen);
    }
}

/// Of all bodies; none if nothing turns.
std::vector<float> Picture::angles(std::size_t frame) const {
    if (!trajectory_.holds_data("angle")) return {};
    std::vector<float> angle(trajectory_.body_count());
    trajectory_.read_frame("angle", frame, angle);
    return angle;
}

void Picture::draw_edges(std::size_t frame) {
    if (edges_.empty()) return;
    const std::vector<float> angle = angles(frame);
    const std::vector<float>& position = positions(frame);
    cairo_t* const pen = surface_->pen;
    cairo_set_source_rgb(pen, 0.11, 0.13, 0.15);
    cairo_set_line_width(pen, 2);
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
    for (const EdgeBody& edges : edges_) {
        const double turn = angle.empty() ? 0 : static_cast<double>(angle[edges.body]);
        const double cos = std::cos(turn), sin = std::sin(turn);
        const double at_x = position[2 * edges.body], at_y = position[2 * edges.body + 1];
        for (std::size_t i = 0; i < edges.x.size(); ++i) {
            const double px = x(at_x + cos * edges.x[i] - sin * edges.y[i]),
                         py = y(at_y + sin * edges.x[i] + cos * edges.y[i]);
            if (i == 0)
                cairo_move_to(pen, px, py);
            else
                cairo_line_to(pen, px, py);
        }
        cairo_stroke(pen);
    }
}

void Picture::draw_joints(std::size_t frame) {
    if (joints_.empty()) return;
    const std::vector<float> angle = angles(frame);
    const std::vector<float>& position = positions(frame);
    cairo_t* const pen = surface_->pen;
    cairo_set_source_rgba(pen, 0.11, 0.13, 0.15, 0.6);
    cairo_set_line_width(pen, 1.25);
    const auto place = [&](std::ptrdiff_t number, double px, double py) -> std::array<double, 2> {
        if (number < 0) return {x(px), y(py)};
        const auto body = static_cast<std::size_t>(number);
        const double turn = angle.empty() ? 0 : static_cast<double>(angle[body]);
        const double cos = std::cos(turn), sin = std::sin(turn);
        return {x(static_cast<double>(position[2 * body]) + cos * px - sin * py),
                y(static_cast<double>(position[2 * body + 1]) + sin * px + cos * py)};
    };
    for (const JointLine& line : joints_) {
        if (time_[frame] >= line.until) continue;
        const auto from = place(line.a, line.ax, line.ay), to = place(line.b, line.bx, line.by);
        cairo_move_to(pen, from[0], from[1]);
        cairo_line_to(pen, to[0], to[1]);
    }
    cairo_stroke(pen);
}

void Picture::draw_walls() {
    if (!settings_.is_object() || !settings_.contains("walls") || !settings_["walls"].is_object()) return;
    cairo_t* const pen = surface_->pen;
    cairo_set_source_rgb(pen, 0.11, 0.13, 0.15);
    cairo_set_line_width(pen, 2);
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_SQUARE);
    const double left = x(box_.min_x) - 1, right = x(box_.max_x) + 1, bottom = y(box_.min_y) + 1,
                 top = y(box_.max_y) - 1;
    for (const Json& side : settings_["walls"]["sides"]) {
        const bool upright = side == "left" || side == "right";
        const double at = side == "left" ? left : side == "right" ? right : side == "bottom" ? bottom : top;
        cairo_move_to(pen, upright ? at : left, upright ? bottom : at);
        cairo_line_to(pen, upright ? at : right, upright ? top : at);
        cairo_stroke(pen);
    }
}

void Picture::draw_time(std::size_t frame) {
    std::array<char, 40> text;
    std::snprintf(text.data(), text.size(), "%.2f s", time_[frame]);
    cairo_t* const pen = surface_->pen;
    cairo_select_font_face(pen, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(pen, 18);
    cairo_move_to(pen, left_ + 10, top_ + 24);
    cairo_text_path(pen, text.data());
    cairo_set_source_rgb(pen, 1, 1, 1);
    cairo_set_line_width(pen, 4);
    cairo_stroke_preserve(pen);
    cairo_set_source_rgb(pen, 0.11, 0.13, 0.15);
    cairo_fill(pen);
}

std::span<const unsigned char> Picture::pixels() const {
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_->image));
    return {cairo_image_surface_get_data(surface_->image), stride * static_cast<std::size_t>(height_)};
}

void Picture::write_png(const std::filesystem::path& path) const {
    const std::filesystem::path temporary = path.string() + ".part";
    const cairo_status_t status = cairo_surface_write_to_png(surface_->image, temporary.c_str());
    std::error_code error;
    if (status == CAIRO_STATUS_SUCCESS) std::filesystem::rename(temporary, path, error);
    if (status == CAIRO_STATUS_SUCCESS && !error) return;
    const std::string reason = error ? error.message() : cairo_status_to_string(status);
    std::filesystem::remove(temporary, error);
    throw ResultError(path.string() + ": cannot be written: " + reason);
}

}  // namespace carom::report
