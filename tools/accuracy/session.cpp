#include "accuracy/session.hpp"

#include <carom/build_info.hpp>
#include <carom/version.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include "accuracy/engines.hpp"
#include "accuracy/measure.hpp"
#include "accuracy/solvers.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::accuracy {
namespace {

namespace fs = std::filesystem;

constexpr Effort kQuick{
    .seconds_a_point = 0.03, .longest_run = 0.25, .long_run = 0.15, .most_runs = 5, .most_members = 4};

fs::path points_file(const fs::path& folder) {
    return folder / "points.jsonl";
}

/// What points must have in common to stand in one result.
std::string header_of(bool quick) {
    Json header{{"version", kVersion},
                {"isa", build_info().chosen},
                {"compiler", build_info().compiler},
                {"quick", quick}};
    for (const bench::PeerEngine& engine : engines()) header[engine.family] = engine.version;
    return header.dump();
}

std::string key_of(const Case& of, const Setting& setting) {
    return tool::joined(of.id, " ", to_json(setting).dump());
}

/// Points as they are measured, and those of an earlier run that was interrupted.
class PointFile {
  public:
    PointFile(const fs::path& folder, bool quick) : path_(points_file(folder)) {
        read(header_of(quick));
        const bool is_new = known_.empty();
        file_.open(path_, is_new ? std::ios::trunc : std::ios::app);
        if (is_new)
            write(header_of(quick));
        else
            file_ << '\n';  // a line that the interrupted run did not finish ends here
    }

    const Point* find(const std::string& key) const {
        const auto found = known_.find(key);
        return found != known_.end() ? &found->second : nullptr;
    }
    void append(const std::string& key, const Point& point) {
        write(Json{{"key", key}, {"point", to_json(point)}}.dump());
    }

  private:
    void read(const std::string& header) {
        std::ifstream file(path_);
        std::string line;
        if (!std::getline(file, line) || line != header) return;
        while (std::getline(file, line)) try {
                const Json json = Json::parse(line);
                known_[json.at("key").get<std::string>()] = point_from(json.at("point"));
            } catch (const Json::exception&) {
                // A line that was not finished: its point is measured again.
            }
    }
    void write(const std::string& line) {
        file_ << line << std::endl;
        if (!file_) throw tool::WriteError(tool::joined(path_.string(), ": ", std::strerror(errno)));
    }

    fs::path path_;
    std::ofstream file_;
    std::map<std::string, Point> known_;
};

}  // namespace

Measured measure_all(const Request& request, const std::function<void(const Progress&)>& report,
                     const std::function<bool()>& stop) {
    std::error_code ignored;
    fs::create_directories(request.folder, ignored);
    PointFile file(request.folder, request.quick);
    Progress progress;
    for (const Case* each : request.cases)
        progress.total += static_cast<std::int64_t>(settings_of(*each, request.quick).size());
    const Effort effort = request.quick ? kQuick : Effort{};
    Measured measured;
    for (const Case* each : request.cases) {
        CaseResult& result = measured.results.emplace_back();
        result.of = each;
        for (const Setting& setting : settings_of(*each, request.quick)) {
            const std::string key = key_of(*each, setting);
            if (const Point* known = file.find(key)) {
                result.points.push_back(*known);
            } else {
                const auto point = measure(*each, setting, effort, stop);
                if (!point) return measured;
                if (point->runs > 0) file.append(key, *point);  // a refusal is found again at once
                result.points.push_back(*point);
            }
            ++progress.done;
            report(progress);
        }
    }
    measured.is_complete = true;
    return measured;
}

void forget_points(const fs::path& folder) {
    std::error_code ignored;
    fs::remove(points_file(folder), ignored);
}

}  // namespace carom::accuracy
