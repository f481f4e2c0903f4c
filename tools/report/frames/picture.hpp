#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "report/frames/edges.hpp"
#include "report/frames/shapes.hpp"
#include "report/page/markup.hpp"
#include "report/readers/h5_reader.hpp"

namespace carom::report {

inline constexpr int kPictureWidth = 960;  // pixels

/// Draws frames of a trajectory as pictures: walls, bodies in their colours, marks of rotation, fading
/// trails, the time. The scene fills the width; the height follows, even, between a third of the width and
/// its double.
class Picture {
  public:
    /// @throws ResultError if the file is no trajectory, or has no frame.
    explicit Picture(const std::filesystem::path& trajectory_h5, int width = kPictureWidth);
    ~Picture();

    int width() const { return width_; }
    int height() const { return height_; }
    std::size_t frame_count() const { return time_.size(); }
    double time(std::size_t frame) const { return time_[frame]; }  ///< s
    /// The last frame that is not later.
    std::size_t frame_at(double time) const;

    /// Cost: O(bodies), and O(bodies * trail) the first time and after a jump.
    void draw(std::size_t frame);
    /// What was drawn last: rows of pixels from the top, four bytes each: blue, green, red, unused.
    std::span<const unsigned char> pixels() const;
    /// Under a temporary name first. @throws ResultError with the system's reason.
    void write_png(const std::filesystem::path& path) const;

  private:
    struct Surface;
    struct Box {
        double min_x, min_y, max_x, max_y;  // m
    };
    struct Colour {
        double red, green, blue;
    };

    Box world() const;
    void add_shapes(Box& box) const;
    void add_edges(Box& box) const;
    void choose_colours();
    const std::vector<float>& positions(std::size_t frame);
    double x(double world_x) const { return (world_x - box_.min_x) * scale_ + left_; }
    double y(double world_y) const { return (box_.max_y - world_y) * scale_ + top_; }
    void draw_trails(std::size_t frame);
    void draw_bodies(std::size_t frame);
    bool has_shape(std::size_t body) const { return !shape_.empty() && shape_[body] >= 0; }
    const DrawnShape& shape_of(std::size_t body) const {
        return shapes_[static_cast<std::size_t>(shape_[body])];
    }
    void trace_shape(std::size_t body, double px, double py, double angle);
    void draw_rotation_marks(std::size_t frame);
    void draw_walls();
    void draw_edges(std::size_t frame);
    void draw_joints(std::size_t frame);
    std::vector<float> angles(std::size_t frame) const;
    void draw_time(std::size_t frame);

    mutable H5Reader trajectory_;
    std::vector<double> time_, radius_;
    std::vector<Colour> colour_;
    Json settings_;
    std::vector<EdgeBody> edges_;
    std::vector<DrawnShape> shapes_;
    std::vector<double> shape_;  // of each body: number in shapes_, or -1; empty if there are none
    std::vector<JointLine> joints_;
    std::size_t trail_;
    Box box_;
    int width_, height_;
    double scale_, left_ = 0, top_ = 0;  // pixels a metre, pixels

    struct Remembered {
        std::size_t frame;
        std::vector<float> position;
    };
    std::vector<Remembered> remembered_;  // of the frames drawn last, a ring
    std::unique_ptr<Surface> surface_;
};

}  // namespace carom::report
