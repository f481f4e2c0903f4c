#include "report/frames/player.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string_view>
#include <unordered_map>

#include "report/frames/edges.hpp"
#include "report/frames/frame_choice.hpp"
#include "report/frames/quantised_frame.hpp"
#include "report/frames/shapes.hpp"
#include "report/page/assets.hpp"
#include "report/page/base64.hpp"
#include "report/readers/csv_reader.hpp"
#include "report/readers/h5_reader.hpp"
#include "report/readers/result_error.hpp"

namespace carom::report {
namespace {

constexpr std::size_t kBytesABlock = 256 * 1024;  // frames are decoded by blocks, when they are first shown
constexpr std::size_t kRestOfPage = 1'500'000;    // bytes: scripts, charts and tables
constexpr std::size_t kMostColours = 4096;        // the others are drawn as if they had none

/// Only the chosen bodies' values, `components` each.
template <class Value>
std::vector<Value> chosen(const std::vector<Value>& values, const std::vector<std::size_t>& bodies,
                          std::size_t components = 1) {
    if (bodies.size() * components == values.size()) return values;
    std::vector<Value> part;
    part.reserve(bodies.size() * components);
    for (const std::size_t body : bodies)
        for (std::size_t c = 0; c < components; ++c) part.push_back(values[body * components + c]);
    return part;
}

std::vector<float> as_float(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

/// Writes frames one by one and remembers what the player must know of them.
class FrameWriter {
  public:
    FrameWriter(H5Reader& trajectory, const FrameChoice& choice) : trajectory_(trajectory), choice_(choice) {
        for (const char* key : {"time", "x_base", "x_step", "y_base", "y_step", "speed_step"})
            notes_[key] = Json::array();
    }

    void write(std::ostream& out) {
        const std::size_t numbers = 2 + (choice_.velocity ? 2 : 0) + (choice_.angle ? 1 : 0);
        const std::size_t frame_bytes = std::max<std::size_t>(1, numbers * 2 * choice_.bodies.size());
        const std::size_t frames_a_block = std::max<std::size_t>(1, kBytesABlock / frame_bytes);
        const std::vector<double> time = trajectory_.times();
        std::vector<std::uint16_t> block;
        std::string text;
        for (std::size_t i = 0; i < choice_.frames.size(); ++i) {
            const QuantisedFrame frame = read(choice_.frames[i]);
            note(frame, time.at(choice_.frames[i]));
            block.insert(block.end(), frame.bits.begin(), frame.bits.end());
            if ((i + 1) % frames_a_block != 0 && i + 1 < choice_.frames.size()) continue;
            text.clear();
            append_base64(text, std::as_bytes(std::span<const std::uint16_t>(block)));
            out << "<script type=\"text/plain\" class=\"frames\">" << text << "</script>\n";
            block.clear();
        }
        notes_["frames_a_block"] = frames_a_block;
        notes_["speed_rms"] = speed_rms_;
        notes_["view"] = {low_[0], low_[1], high_[0], high_[1]};
        notes_["lost"] = lost_;
    }

    const Json& notes() const { return notes_; }

  private:
    QuantisedFrame read(std::size_t frame) {
        const auto column = [&](const char* name, std::size_t components, std::vector<float>& whole) {
            whole.resize(trajectory_.body_count() * components);
            trajectory_.read_frame(name, frame, whole);
            return chosen(whole, choice_.bodies, components);
        };
        const std::vector<float> position = column("position", 2, position_);
        std::vector<float> velocity, angle;
        if (choice_.velocity) velocity = column("velocity", 2, velocity_);
        if (choice_.angle) angle = column("angle", 1, angle_);
        return quantise(position, velocity, angle);
    }

    void note(const QuantisedFrame& frame, double time) {
        notes_["time"].push_back(time);
        notes_["x_base"].push_back(frame.x.base);
        notes_["x_step"].push_back(frame.x.step);
        notes_["y_base"].push_back(frame.y.base);
        notes_["y_step"].push_back(frame.y.step);
        notes_["speed_step"].push_back(frame.speed_step);
        speed_rms_ = std::max(speed_rms_, frame.speed_rms);
        lost_ = std::max(lost_, frame.lost);
        const Scale scales[] = {frame.x, frame.y};
        for (int axis = 0; axis < 2; ++axis) {
            low_[axis] = std::min(low_[axis], scales[axis].base);
            high_[axis] = std::max(high_[axis], scales[axis].base + scales[axis].step * (kNowhere - 1));
        }
    }

    H5Reader& trajectory_;
    const FrameChoice& choice_;
    std::vector<float> position_, velocity_, angle_;  // of all bodies
    Json notes_;
    double low_[2] = {INFINITY, INFINITY}, high_[2] = {-INFINITY, -INFINITY};  // m
    double speed_rms_ = 0;  // m/s, the largest of any frame
    std::size_t lost_ = 0;
};

/// Colours of bodies: those there are, and which of them each body has, 0 for none.
Json colours(const H5Reader& trajectory, const FrameChoice& choice) {
    if (!trajectory.has("color")) return nullptr;
    std::vector<std::uint32_t> palette;
    std::unordered_map<std::uint32_t, std::uint16_t> number{{kNoColour, 0}};
    std::vector<std::uint16_t> index;
    for (const double value : chosen(trajectory.body_column("color"), choice.bodies)) {
        const auto colour = value >= 0 && value <= UINT32_MAX ? static_cast<std::uint32_t>(value) : kNoColour;
        if (palette.size() < kMostColours && number.try_emplace(colour, palette.size() + 1).second)
            palette.push_back(colour);
        const auto found = number.find(colour);
        index.push_back(found == number.end() ? std::uint16_t{0} : found->second);
    }
    return {{"palette", palette}, {"index", base64_of<std::uint16_t>(index)}};
}

/// Names of the chosen bodies that have one, by their place among the chosen.
Json names(const RunFiles& files, const FrameChoice& choice) {
    Json names = Json::object();
    if (files.final_csv.empty()) return names;
    std::size_t lines = 0, place = 0;
    read_csv(files.final_csv, [&](const CsvRow& row) {
        if (lines++ != choice.bodies[place] + 1) return true;  // the headings come first
        if (row.size() > 1 && !row[1].empty()) names[std::to_string(place)] = row[1];
        return ++place < choice.bodies.size();
    });
    return names;
}

/// The lines among the chosen bodies: [body's place among the chosen, its points [m]].
Json edges(const Json& settings, const FrameChoice& choice) {
    Json list = Json::array();
    for (const EdgeBody& edges : edge_bodies(settings)) {
        const auto found = std::lower_bound(choice.bodies.begin(), choice.bodies.end(), edges.body);
        if (found == choice.bodies.end() || *found != edges.body) continue;
        list.push_back({{"body", found - choice.bodies.begin()},
                        {"x", edges.x},
                        {"y", edges.y},
                        {"reach", edges.reach}});
    }
    return list;
}

/// Outlines of boxes, capsules and polygons, and which of them each chosen body has: its number plus one, 0
/// for none. Null if there are none.
Json shapes(const H5Reader& trajectory, const Json& settings, const FrameChoice& choice) {
    const std::vector<double> of_bodies = shape_of_bodies(trajectory);
    if (of_bodies.empty()) return nullptr;
    Json outlines = Json::array();
    for (const DrawnShape& shape : drawn_shapes(settings))
        outlines.push_back({{"x", shape.x}, {"y", shape.y}, {"starts", shape.starts}, {"mark", shape.mark}});
    std::vector<std::uint32_t> index;
    for (const double number : chosen(of_bodies, choice.bodies))
        index.push_back(number >= 0 && number < static_cast<double>(outlines.size())
                            ? static_cast<std::uint32_t>(number + 1)
                            : 0);
    return {{"outlines", outlines}, {"index", base64_of<std::uint32_t>(index)}};
}

/// Joints whose bodies are both among the chosen: [a, x, y, b, x, y], bodies by their place among the chosen;
/// of those that break, then the time at which they do [s].
Json joints(const Json& settings, const Json& breaks, const FrameChoice& choice) {
    Json list = Json::array();
    const auto place_of = [&](std::ptrdiff_t body) -> std::ptrdiff_t {
        if (body < 0) return -1;
        const auto wanted = static_cast<std::size_t>(body);
        const auto found = std::lower_bound(choice.bodies.begin(), choice.bodies.end(), wanted);
        return found == choice.bodies.end() || *found != wanted ? -2 : found - choice.bodies.begin();
    };
    for (const JointLine& line : joint_lines(settings, breaks)) {
        const std::ptrdiff_t a = place_of(line.a), b = place_of(line.b);
        if (a == -2 || b == -2) continue;
        list.push_back({a, line.ax, line.ay, b, line.bx, line.by});
        if (std::isfinite(line.until)) list.back().push_back(line.until);
    }
    return list;
}

Json description(const H5Reader& trajectory, const RunFiles& files, const FrameChoice& choice) {
    Json json{{"bodies", choice.bodies.size()},
              {"all_bodies", trajectory.body_count()},
              {"velocity", choice.velocity},
              {"angle", choice.angle},
              {"radius", base64_of<float>(as_float(chosen(trajectory.body_column("radius"), choice.bodies)))},
              {"mass", base64_of<float>(as_float(chosen(trajectory.body_column("mass"), choice.bodies)))},
              {"colour", colours(trajectory, choice)},
              {"names", names(files, choice)}};
    if (choice.bodies.size() < trajectory.body_count()) json["body"] = choice.bodies;
    const Json settings = trajectory.json("settings");
    for (const char* key : {"walls", "gravity", "drag", "trail"})
        json[key] = settings.is_object() && settings.contains(key) ? settings[key] : Json();
    json["edges"] = edges(settings, choice);
    json["shapes"] = shapes(trajectory, settings, choice);
    json["joints"] = joints(settings, trajectory.json("breaks"), choice);
    return json;
}

Json described(const H5Reader& trajectory, const RunFiles& files, const FrameChoice& choice) {
    try {
        return description(trajectory, files, choice);
    } catch (const Json::exception& error) {
        throw ResultError(files.trajectory_h5.string() + ": is not as a run writes it: " + error.what());
    }
}

void write_html(std::ostream& out) {
    for (const Asset& asset : assets())
        if (asset.name == "player.html")
            for (const std::string_view piece : asset.pieces) out << piece;
}

}  // namespace

void add_player(const RunFiles& files, Page& page) {
    const auto trajectory = std::make_shared<H5Reader>(files.trajectory_h5);
    if (trajectory->frame_count() == 0 || trajectory->body_count() == 0) {
        page.paragraph("The trajectory is empty: there is nothing to play.");
        return;
    }
    const std::size_t room = files.page_bytes > kRestOfPage ? files.page_bytes - kRestOfPage : 0;
    const FrameChoice choice = choose_frames(trajectory->frame_count(), trajectory->body_count(),
                                             trajectory->holds_data("angle"), room);
    page.block([trajectory, choice, files](std::ostream& out) {
        write_html(out);
        FrameWriter frames(*trajectory, choice);
        frames.write(out);
        Json json = described(*trajectory, files, choice);
        json.update(frames.notes());
        out << "<script type=\"application/json\" id=\"player-data\">" << as_script_data(json)
            << "</script>\n";
    });
    for (const std::string& words : choice.words) page.paragraph(words);
}

}  // namespace carom::report
