#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "collecting_reporter.hpp"
#include "kernels/roofline.hpp"
#include "measure/machine.hpp"
#include "measure/scaling.hpp"
#include "measure/text.hpp"
#include "peers/run_peers.hpp"

// carom_bench: what docs/performance.md is made of. Runs the parts it is asked for and writes a result file
// of each; with a flag of Google Benchmark (--benchmark_...) it is an ordinary benchmark program instead.

namespace carom::bench {
namespace {

namespace fs = std::filesystem;
using measure::Json;

constexpr const char* kUsage =
    R"(usage: carom_bench [PART ...] [--quick] [--scene NAME --bodies N] [--out DIR]
       carom_bench --benchmark_filter=... and other flags of Google Benchmark

parts: kernels stages scenes scaling peers (default: all)
  --quick        fewer and smaller cases: all parts in less than five minutes
  --scene NAME   peers: only this scene (gas, pile, pyramid, box-pile, ...)
  --bodies N     peers: with so many bodies
  --out DIR      folder of the result files (default: out/bench)
  --keep         the folder is bench/results/<date>-<machine>, for docs/performance.md
`)";

struct Choices {
    std::vector<std::string> parts;
    bool quick = false;
    std::string scene;
    std::int64_t bodies = 0;
    fs::path out = "out/bench";
};

class WrongUse : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

void say(const std::string& text) {
    std::fprintf(stderr, "%s\n", text.c_str());
}

/// All benchmarks of a part that Google Benchmark runs.
Json run_registered(const std::string& filter) {
    CollectingReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter, filter);
    return reporter.runs();
}

Json run_kernels(const Choices& choices) {
    // Quick: first and third cache, a tenth of hits or all.
    Json json = roofline_json(
        run_registered(choices.quick ? "^kernels/.*/items:(256|131072)(/hits:(10|100))?$" : "^kernels/"));
    std::fputs(roofline_text(json).c_str(), stdout);
    return json;
}

Json run_part_of_steps(const char* kind, const Choices& choices) {
    Json json = measure::result_header(kind);
    const std::string filter =
        measure::joined("^", kind, "/", choices.quick ? ".*float.*bodies:10{3,5}(/|$)" : "");
    json["benchmarks"] = run_registered(filter);
    for (const Json& run : json["benchmarks"])
        std::printf("%-60s %10.4g ns a body a step\n", run.at("name").get<std::string>().c_str(),
                    1e9 / run.at("items_per_second").get<double>());
    return json;
}

Json run_scaling(const Choices& choices) {
    measure::ScalingOptions options;
    options.contest.rounds = choices.quick ? 5 : 11;
    options.contest.seconds_of_a_turn = choices.quick ? 0.01 : 0.05;
    options.max_bodies = choices.quick ? 100'000 : 1'000'000;
    options.progress = [](std::int64_t bodies) {
        say(measure::joined("scaling: ", measure::grouped(bodies), " bodies"));
    };
    Json json = measure::scaling_json(measure::run_scaling(options));
    std::fputs(measure::scaling_text(json).c_str(), stdout);
    return json;
}

std::vector<PeerTask> peer_tasks(const Choices& choices) {
    if (!choices.scene.empty()) return {{choices.scene, choices.bodies > 0 ? choices.bodies : 1000}};
    if (choices.quick) return {{"gas", 1000}, {"gas", 10'000}, {"pile", 1000}, {"tumbler", 1000}};
    return {{"gas", 1000},    {"gas", 10'000},   {"gas", 100'000},    {"pile", 1000},
            {"pile", 10'000}, {"tumbler", 1000}, {"tumbler", 10'000}, {"packed", 100'000}};
}

Json run_peers_part(const Choices& choices) {
    measure::ContestOptions options;
    options.rounds = choices.quick ? 7 : 15;
    options.seconds_of_a_turn = choices.quick ? 0.003 : 0.01;
    Json json =
        run_peers(peer_tasks(choices), options, [](const std::string& what) { say("peers: " + what); });
    std::fputs(peers_text(json).c_str(), stdout);
    return json;
}

struct Part {
    std::string_view name;
    std::function<Json(const Choices&)> run;
};

const std::array<Part, 5>& parts() {
    static const std::array<Part, 5> list{
        Part{"kernels", &run_kernels},
        Part{"stages", [](const Choices& choices) { return run_part_of_steps("stages", choices); }},
        Part{"scenes", [](const Choices& choices) { return run_part_of_steps("scenes", choices); }},
        Part{"scaling", &run_scaling},
        Part{"peers", &run_peers_part},
    };
    return list;
}

void write(const fs::path& path, const Json& json) {
    const fs::path unfinished = path.string() + ".part";
    std::ofstream file(unfinished);
    file << measure::result_text(json);
    file.close();
    if (!file) throw std::runtime_error(path.string() + ": cannot be written");
    fs::rename(unfinished, path);
}

std::int64_t whole_number(const std::string& option, const std::string& text) {
    try {
        std::size_t end = 0;
        const long long value = std::stoll(text, &end);
        if (end == text.size() && value >= 1 && value <= 100'000'000) return value;
    } catch (const std::logic_error&) {
    }
    throw WrongUse(measure::joined(option, ": ", text, " is no whole number from 1 to 100000000"));
}

std::string kept_folder() {
    return measure::joined(measure::today(), "-", measure::machine_label(measure::machine_properties()));
}

Choices read_choices(const std::vector<std::string>& arguments) {
    Choices choices;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& argument = arguments[i];
        const auto value = [&]() -> const std::string& {
            if (i + 1 == arguments.size()) throw WrongUse(measure::joined(argument, ": a value is missing"));
            return arguments[++i];
        };
        const auto is_part = [&](const Part& part) { return part.name == argument; };
        if (argument == "--quick")
            choices.quick = true;
        else if (argument == "--scene")
            choices.scene = value();
        else if (argument == "--bodies")
            choices.bodies = whole_number(argument, value());
        else if (argument == "--keep")
            choices.out = fs::path("bench/results") / kept_folder();
        else if (argument == "--out")
            choices.out = value();
        else if (std::any_of(parts().begin(), parts().end(), is_part))
            choices.parts.push_back(argument);
        else
            throw WrongUse(measure::joined(argument, ": neither a part nor an option"));
    }
    return choices;
}

/// One scene of the peers has a file of its own, beside the others.
std::string file_name(std::string_view part, const Choices& choices) {
    if (part != "peers" || choices.scene.empty()) return measure::joined(part, ".json");
    const std::string bodies = std::to_string(peer_tasks(choices).front().bodies);
    return measure::joined(part, "-", choices.scene, "-", bodies, ".json");
}

int run(const Choices& choices) {
    fs::create_directories(choices.out);
    // Quick cases are repeated for a shorter time each.
    std::array<std::string, 2> words{
        "carom_bench", choices.quick ? "--benchmark_min_time=0.01" : "--benchmark_min_time=0.05"};
    std::array<char*, 3> flags{words[0].data(), words[1].data(), nullptr};
    int count = 2;
    benchmark::Initialize(&count, flags.data());
    for (const Part& part : parts()) {
        const auto wanted = std::find(choices.parts.begin(), choices.parts.end(), part.name);
        if (!choices.parts.empty() && wanted == choices.parts.end()) continue;
        say(measure::joined("== ", part.name));
        Json json = part.run(choices);
        json["quick"] = choices.quick;
        const fs::path path = choices.out / file_name(part.name, choices);
        write(path, json);
        say(measure::joined("== ", part.name, ": ", path.string()));
    }
    return 0;
}

int run_google_benchmark(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

}  // namespace
}  // namespace carom::bench

int main(int argc, char** argv) {
    using namespace carom::bench;
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    const auto is_google = [](const std::string& argument) { return argument.starts_with("--benchmark_"); };
    const auto is_help = [](const std::string& argument) { return argument == "--help" || argument == "-h"; };
    try {
        if (std::any_of(arguments.begin(), arguments.end(), is_google))
            return run_google_benchmark(argc, argv);
        if (std::any_of(arguments.begin(), arguments.end(), is_help)) return std::fputs(kUsage, stdout), 0;
        return run(read_choices(arguments));
    } catch (const WrongUse& error) {
        std::fprintf(stderr, "carom_bench: %s\n%s", error.what(), kUsage);
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "carom_bench: %s\n", error.what());
        return 3;
    }
}
