#include "measure/scaling.hpp"

#include <carom/build_info.hpp>

#include <algorithm>
#include <memory>

#include "measure/all_pairs.hpp"
#include "measure/gas.hpp"
#include "measure/text.hpp"

namespace carom::measure {
namespace {

constexpr int kStepsBefore = 4;  // the first candidate pairs, sorts and allocations are behind it

/// A method at one size, ready to step, and what it has counted since the contest began.
struct Method {
    Contestant contestant;
    std::function<ScalingRow()> finish;
};

Method naive(const Scene& scene) {
    const auto engine = std::make_shared<Pairwise>(pairwise_gas(scene));
    const auto steps = std::make_shared<std::int64_t>(0);
    const auto finish = [engine, steps, n = static_cast<double>(scene.bodies.size())] {
        const auto per_body = [&](std::uint64_t count) {
            return static_cast<double>(count) / static_cast<double>(*steps) / n;
        };
        return ScalingRow{.method = "naive",
                          .pairs_per_body = per_body(engine->counts().pair_tests),
                          .contacts_per_body = per_body(engine->counts().contacts),
                          .bytes_per_body = sizeof(PairwiseBody)};
    };
    return {{"naive", [engine, steps] { engine->step(kStep), ++*steps; }}, finish};
}

Method all_pairs(const Scene& scene) {
    const auto engine = std::make_shared<AllPairs>(scene);
    const auto steps = std::make_shared<std::int64_t>(0);
    const auto finish = [engine, steps, n = static_cast<double>(scene.bodies.size())] {
        return ScalingRow{
            .method = "all pairs",
            .pairs_per_body = (n - 1) / 2,
            .contacts_per_body = static_cast<double>(engine->contacts()) / static_cast<double>(*steps) / n,
            .bytes_per_body = static_cast<double>(engine->bytes()) / n};
    };
    return {{"all pairs", [engine, steps] { engine->step(kStep), ++*steps; }}, finish};
}

Method grid(const Scene& scene, const std::string& isa, int threads) {
    WorldOptions options;
    options.isa = isa;
    options.threads = threads;
    const auto world = std::make_shared<World>(scene, options);
    for (int i = 0; i < kStepsBefore; ++i) world->step(kStep);
    const std::string name = joined("grid ", isa, threads > 1 ? format(" %d threads", threads) : "");
    const Profile before = world->profile();
    const auto finish = [world, name, before, n = static_cast<double>(scene.bodies.size())] {
        const Profile after = world->profile();
        const auto steps = static_cast<double>(after.steps - before.steps);
        return ScalingRow{
            .method = name,
            .pairs_per_body = static_cast<double>(after.candidate_pairs) / n,
            .contacts_per_body = static_cast<double>(after.impacts - before.impacts) / steps / n,
            .bytes_per_body = static_cast<double>(after.bytes) / n};
    };
    return {{name, [world] { world->step(kStep); }, threads > 1}, finish};
}

std::vector<Method> methods_at(std::int64_t bodies) {
    const Scene scene = flown_gas_scene(bodies);
    std::vector<Method> methods;
    if (bodies <= kMostNaiveBodies) methods.push_back(naive(scene));
    if (bodies <= kMostPairsBodies) methods.push_back(all_pairs(scene));
    const std::vector<std::string> isas = runnable_instruction_sets();
    for (const std::string& isa : isas) methods.push_back(grid(scene, isa, 1));
    if (build_info().threads > 1) methods.push_back(grid(scene, isas.back(), 2));
    return methods;
}

/// A step of the slow methods takes so long that one a turn is enough.
ContestOptions contest_at(std::int64_t bodies, ContestOptions options) {
    if (bodies >= kMostNaiveBodies) options.fewest_steps = std::min(options.fewest_steps, 3);
    return options;
}

}  // namespace

std::vector<std::int64_t> scaling_sizes(std::int64_t max) {
    std::vector<std::int64_t> sizes;
    for (std::int64_t decade = 10; decade <= max; decade *= 10)
        for (const std::int64_t factor : {1, 3})
            if (factor * decade <= max) sizes.push_back(factor * decade);
    if (sizes.empty() || sizes.back() != max) sizes.push_back(max);
    return sizes;
}

std::vector<ScalingRow> run_scaling(const ScalingOptions& options) {
    std::vector<ScalingRow> rows;
    for (const std::int64_t bodies : scaling_sizes(options.max_bodies)) {
        if (options.is_interrupted()) break;
        options.progress(bodies);
        const std::vector<Method> methods = methods_at(bodies);
        std::vector<Contestant> contestants;
        for (const Method& method : methods) contestants.push_back(method.contestant);
        auto seconds = run_contest(contestants, contest_at(bodies, options.contest));
        for (std::size_t i = 0; i < methods.size(); ++i) {
            ScalingRow row = methods[i].finish();
            row.bodies = bodies;
            row.seconds = std::move(seconds[i]);
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

}  // namespace carom::measure
