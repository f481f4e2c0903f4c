// What stages of `soft` and `impulse` say that they read and write (step/*_step.cpp,
// docs/how-a-step-works.md), held against what they do. What a stage changes, it has to name among its
// writes. What it names in neither list must not matter to it: the world ends with the same bits if all of
// that is disturbed before the stage and put right behind it.
#include <doctest/doctest.h>
#include <carom/carom.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "solvers/impulse/impulse_simulation.hpp"
#include "solvers/soft/soft_simulation.hpp"
#include "support/effort.hpp"
#include "support/inside.hpp"
#include "support/joints.hpp"
#include "support/ragdoll.hpp"
#include "support/scenes.hpp"

namespace test_stage_claims {

using namespace carom;
using namespace carom::test;

namespace {

using Real = float;
using Sim = Simulation<Real>;
using Soft = SoftSimulation<Real>;
using Bytes = std::vector<std::byte>;

constexpr double kStep = 1.0 / 60;  // s

/// Something that stages read and write, by the name that their lists have for it.
struct Part {
    std::string name;
    std::function<Bytes(Sim&)> bytes;
    /// The numbers of it, to be disturbed; none: it is looked at alone.
    std::function<std::vector<std::span<Real>>(Sim&)> numbers = {};
};

template <class... T>
Bytes bytes_of(T&... values) {
    StateSize size;
    size(values...);
    Bytes bytes(size.bytes());
    StateWriter writer(bytes.data());
    writer(values...);
    return bytes;
}

using Numbers = std::vector<std::span<Real>>;

Part numbers(const std::string& name, const std::function<Numbers(Sim&)>& of) {
    const auto bytes = [of](Sim& sim) {
        Bytes all;
        for (const std::span<Real> column : of(sim)) {
            const auto more = std::as_bytes(column);
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    };
    return {name, bytes, of};
}
std::span<Real> all_of(Column<Real>& column) {
    return {column.data(), column.size()};
}

Soft& soft(Sim& sim) {
    return static_cast<Soft&>(sim);
}
/// The records of a solver, which is not const: to be disturbed.
BodyRecords<Real>& records(Sim& sim) {
    return const_cast<BodyRecords<Real>&>(soft(sim).soft.records());
}

/// The parts that have bytes of their own. Others in the lists of stages, such as what a stage hands to the
/// next, live inside of the solver's parts.
std::vector<Part> parts_of(const Sim& of) {
    using B = Bodies<Real>;
    std::vector<Part> parts;
    const auto of_bodies = [&](const std::string& name, auto... members) {
        parts.push_back(
            numbers(name, [members...](Sim& sim) { return Numbers{all_of(sim.world.bodies.*members)...}; }));
    };
    const auto watched = [&](const std::string& name, const std::function<Bytes(Sim&)>& bytes) {
        parts.push_back({name, bytes});
    };
    of_bodies("position", &B::position_x, &B::position_y);
    of_bodies("velocity", &B::velocity_x, &B::velocity_y);
    of_bodies("angle", &B::angle);
    of_bodies("angular velocity", &B::angular_velocity);
    watched("flags", [](Sim& sim) { return bytes_of(sim.world.bodies.flags); });
    watched("books", [](Sim& sim) { return bytes_of(sim.world.books); });
    watched("joints", [](Sim& sim) { return bytes_of(sim.world.joints); });
    watched("events", [](Sim& sim) { return bytes_of(sim.world.sensing); });
    watched("candidate pairs", [](Sim& sim) {
        const Candidates<Real>& candidates = sim.candidates;
        const std::size_t count = candidates.pair_count();
        std::vector<std::int32_t> pairs(candidates.pair_a(), candidates.pair_a() + count);
        pairs.insert(pairs.end(), candidates.pair_b(), candidates.pair_b() + count);
        for (const auto& [a, b] : candidates.new_pairs()) pairs.push_back(a), pairs.push_back(b);
        return bytes_of(pairs);
    });
    if (of.solver() == Solver::impulse) {
        parts.push_back(numbers("motion", [](Sim& sim) {
            return Numbers{static_cast<ImpulseSimulation<Real>&>(sim).impulse.flights.motion};
        }));
        return parts;
    }
    const auto of_step = [&](const std::string& name, const std::function<Column<Real>&(Sim&)>& column) {
        parts.push_back(numbers(name, [column](Sim& sim) { return Numbers{all_of(column(sim))}; }));
    };
    of_step("motion", [](Sim& sim) -> Column<Real>& { return soft(sim).motion; });
    of_step("velocity records", [](Sim& sim) -> Column<Real>& { return records(sim).velocity; });
    of_step("displacements", [](Sim& sim) -> Column<Real>& { return records(sim).displacement; });
    watched("coloured candidates", [](Sim& sim) {
        ContactGraph<Real>& graph = soft(sim).soft.graph;
        return bytes_of(graph.pairs.a, graph.pairs.b, graph.supports.a, graph.supports.b, graph.groups);
    });
    watched("contacts", [](Sim& sim) {
        ContactRows<Real>& pairs = soft(sim).soft.graph.pairs;
        return bytes_of(pairs.normal_x, pairs.normal_y, pairs.separation);
    });
    watched("impulses", [](Sim& sim) {
        ContactGraph<Real>& graph = soft(sim).soft.graph;
        Bytes all;
        for (ContactRows<Real>* rows : {&graph.pairs, &graph.supports}) {
            const Bytes more = bytes_of(rows->normal_impulse, rows->friction_impulse, rows->rolling_impulse);
            all.insert(all.end(), more.begin(), more.end());
        }
        return all;
    });
    return parts;
}

struct Claims {
    std::string name;
    std::set<std::string> reads, writes;

    bool writes_part(const std::string& part) const {
        return writes.contains(part) || writes.contains("rows of all columns");
    }
    bool names(const std::string& part) const { return reads.contains(part) || writes_part(part); }
};

std::set<std::string> words(std::string_view list) {
    std::set<std::string> parts;
    while (!list.empty()) {
        const std::size_t end = std::min(list.find(", "), list.size());
        parts.emplace(list.substr(0, end));
        list.remove_prefix(std::min(end + 2, list.size()));
    }
    return parts;
}

std::vector<Claims> claims_of(const Sim& sim) {
    std::vector<Claims> claims;
    sim.report_stages([&](const StageState& stage) {
        claims.push_back({std::string(stage.name), words(stage.reads), words(stage.writes)});
    });
    return claims;
}

/// Compares all parts before a stage with what they are behind it.
class WritesObserver final : public StageObserver {
  public:
    explicit WritesObserver(Sim& sim) : sim_(sim), claims_(claims_of(sim)), parts_(parts_of(sim)) {}
    void before(std::size_t stage) override {
        ran.insert(claims_[stage].name);
        before_.clear();
        for (const Part& part : parts_) before_.push_back(part.bytes(sim_));
    }
    void after(std::size_t stage) override {
        for (std::size_t p = 0; p < parts_.size(); ++p)
            if (parts_[p].bytes(sim_) != before_[p] && !claims_[stage].writes_part(parts_[p].name))
                faults.insert(claims_[stage].name + " writes " + parts_[p].name);
    }
    std::set<std::string> ran, faults;

  private:
    Sim& sim_;
    std::vector<Claims> claims_;
    std::vector<Part> parts_;
    std::vector<Bytes> before_;
};

/// Disturbs parts before each run of a stage, and puts them right behind it.
class Disturbance final : public StageObserver {
  public:
    Disturbance(Sim& sim, std::size_t stage, std::vector<Part> parts)
        : sim_(sim), stage_(stage), parts_(std::move(parts)) {}
    void before(std::size_t stage) override {
        if (stage != stage_) return;
        kept_.clear();
        for (const Part& part : parts_)
            for (const std::span<Real> numbers : part.numbers(sim_)) {
                kept_.emplace_back(numbers.begin(), numbers.end());
                for (std::size_t i = 0; i < numbers.size(); ++i)
                    numbers[i] = 0.75F * numbers[i] + 0.125F * static_cast<Real>(1 + i % 7);
            }
    }
    void after(std::size_t stage) override {
        if (stage != stage_) return;
        std::size_t number = 0;
        for (const Part& part : parts_)
            for (const std::span<Real> numbers : part.numbers(sim_)) {
                const std::vector<Real>& kept = kept_[number++];
                if (kept.size() == numbers.size()) std::copy(kept.begin(), kept.end(), numbers.begin());
            }
    }

  private:
    Sim& sim_;
    std::size_t stage_;
    std::vector<Part> parts_;
    std::vector<std::vector<Real>> kept_;
};

/// Discs of several sizes that fall into a box, rest and sleep; a weight among them.
Scene falling_discs(double restitution) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->min = {0, 0}, scene.walls->max = {4, 40};
    scene.walls->top = false;
    scene.walls->material.friction = 0.5;
    for (int i = 0; i < 24; ++i) {
        Body body = disc(0.2 + 0.02 * (i % 5), i == 20 ? 40 : 1, {0.5 + 0.6 * (i % 5), 0.5 + 0.6 * (i / 5)});
        body.material = {.friction = 0.4, .restitution = restitution, .rolling_resistance = 0.02};
        body.velocity = {0.5 * (i % 3), -1.0 * (i % 2)};
        scene.add(body);
    }
    scene.effects.ledger = true;
    scene.effects.sleep = restitution == 0;
    return scene;
}

/// Ragdolls, boxes and discs over a track of edges that a turning paddle stirs, in a sensor.
Scene stirred_shapes(double restitution) {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5, .restitution = restitution};
    scene.add({.type = BodyType::static_body,
               .shape = Chain{{{-4, 4}, {-3, 0}, {0, -0.2}, {3, 0}, {4, 4}}},
               .material = rough});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Box{2, 0.2},
               .position = {0, 0.8},
               .angular_velocity = 1,
               .material = rough});
    scene.add({.type = BodyType::static_body, .shape = Box{4, 2}, .position = {0, 1}, .sensor = true});
    for (int i = 0; i < 8; ++i)
        scene.add(
            {.shape = Box{0.4, 0.3}, .position = {-2 + 0.5 * i, 2.5 + 0.1 * (i % 3)}, .material = rough});
    for (int i = 0; i < 4; ++i)
        scene.add({.shape = Disc{0.2}, .position = {-1.5 + 0.9 * i, 3.4}, .material = rough});
    add_ragdoll(scene, {0, 5}, 0.5, -1, {.restitution = restitution});
    scene.effects.ledger = true;
    return scene;
}

/// Smooth discs on each other: a column whose loads heave.
Scene column_of_discs() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->min = {0, 0}, scene.walls->max = {4, 200};
    scene.walls->top = false;
    for (int i = 0; i < 80; ++i) scene.add(disc(0.5, 1, {2, 0.5 + i}));
    scene.effects.ledger = true;
    return scene;
}

/// A disc that falls between two slopes that face each other, and one that flies out of the world.
Scene wedge() {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.3};
    for (const double side : {-1, 1})
        scene.add({.type = BodyType::static_body, .shape = Segment{{0, 0}, {side, 4}}, .material = rough});
    scene.add({.shape = Disc{0.3}, .position = {0, 1.4}, .material = rough});
    scene.add(
        {.shape = Disc{0.3}, .position = {kLargestPosition, 3}, .velocity = {1e3, 0}, .material = rough});
    scene.effects.ledger = true;
    return scene;
}

/// A light disc that a heavy one makes faster than the limit.
Scene too_fast() {
    Scene scene;
    scene.add(disc(0.5, 1e3, {0, 0}, {0.9 * kLargestSpeed, 0}, 1));
    scene.add(disc(0.5, 1, {1.1, 0}, {}, 1));
    scene.effects.ledger = true;
    return scene;
}

/// A crowd that falls on a heap at once, fast enough to come deep into it.
Scene crowd_that_falls(double restitution) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->min = {0, 0}, scene.walls->max = {5.5, 200};
    scene.walls->top = false;
    scene.walls->material.friction = 0.5;
    for (int i = 0; i < 200; ++i) {
        Body body = disc(0.25, 1, {0.3 + 0.54 * (i % 10), 0.3 + 0.54 * (i / 10) + (i < 50 ? 0 : 10)});
        body.material.friction = 0.4, body.material.restitution = restitution;
        body.velocity.y = i < 50 ? 0 : -20;
        scene.add(body);
    }
    return scene;
}

struct Case {
    std::string name;
    Scene scene;
    int steps;
    std::uint32_t removed = 0;  ///< slot of the body that is taken out half way; 0: none
};

std::vector<Case> cases() {
    std::vector<Case> cases{{"discs that rest", falling_discs(0), 150, 3},
                            {"discs that bounce", falling_discs(0.5), 60, 3},
                            {"shapes that rest", stirred_shapes(0), 60, 11},
                            {"shapes that bounce", stirred_shapes(0.4), 60, 11},
                            {"joints of every kind", every_joint(), 40},
                            {"a column", column_of_discs(), 40},
                            {"a wedge", wedge(), 40},
                            {"too fast", too_fast(), 5},
                            {"a crowd that falls", crowd_that_falls(0), 60},
                            {"a crowd that bounces", crowd_that_falls(0.6), 60}};
    for (Case& c : cases) c.scene.accuracy.solver = Solver::soft;
    Case flights{"flights", falling_discs(0.9), 60, 3};
    flights.scene.accuracy.solver = Solver::impulse;
    cases.push_back(flights);
    return cases;
}

std::unique_ptr<Sim> inside_of(const Case& c) {
    return test::inside_of<Real>(c.scene, c.scene.accuracy.solver);
}

void run(Sim& sim, const Case& c, StageObserver& observer) {
    for (int i = 0; i < c.steps; ++i) {
        if (i == c.steps / 2 && c.removed > 0) sim.remove(sim.world.handles.row_of_slot(c.removed));
        sim.step_observed(kStep, observer);
    }
}

/// What a run comes to: bodies and books.
Bytes end_of(Sim& sim) {
    Books& books = sim.world.books;
    return bytes_of(sim.world.bodies, books.drag, books.restitution, books.friction, books.correction,
                    books.joints, books.drive, books.sleep, books.gravity_momentum, books.wall_momentum);
}

}  // namespace

TEST_CASE("a stage writes what it says") {
    std::set<std::string> all, ran, faults;
    for (const Case& c : cases()) {
        const auto sim = inside_of(c);
        WritesObserver observer(*sim);
        run(*sim, c, observer);
        ran.merge(observer.ran), faults.merge(observer.faults);
        for (const Claims& stage : claims_of(*sim)) all.insert(stage.name);
    }
    for (const std::string& fault : faults) FAIL_CHECK(fault);
    CHECK(ran == all);  // every stage had a scene that called for it
}

TEST_CASE("what a stage does not name does not matter to it") {
    struct Ran final : StageObserver {
        void before(std::size_t stage) override { stages.insert(stage); }
        void after(std::size_t) override {}
        std::set<std::size_t> stages;
    };
    for (const Case& c : cases()) {
        const auto undisturbed = inside_of(c);
        Ran ran;
        run(*undisturbed, c, ran);
        const Bytes expected = end_of(*undisturbed);
        const std::vector<Claims> claims = claims_of(*undisturbed);
        const auto matters = [&](std::size_t stage, const std::vector<Part>& parts) {
            const auto sim = inside_of(c);
            Disturbance disturbance(*sim, stage, parts);
            run(*sim, c, disturbance);
            return end_of(*sim) != expected;
        };
        for (const std::size_t stage : ran.stages) {
            if (is_effort_reduced() && stage % 3 > 0) continue;
            std::vector<Part> parts = parts_of(*undisturbed);
            std::erase_if(parts,
                          [&](const Part& part) { return !part.numbers || claims[stage].names(part.name); });
            if (parts.empty() || !matters(stage, parts)) continue;  // all in one run; one by one to say which
            FAIL_CHECK(c.name << ": " << claims[stage].name << " reads what it does not name");
            for (const Part& part : parts)
                if (matters(stage, {part})) FAIL_CHECK(c.name << ": it reads " << part.name);
        }
    }
}

}  // namespace test_stage_claims
