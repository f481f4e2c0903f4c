#pragma once

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <memory>
#include <optional>
#include <type_traits>

#include "support/effort.hpp"
#include "support/other_order.hpp"
#include "support/report.hpp"
#include "support/trial.hpp"
#include "torture/hard/hard_case.hpp"
#include "torture/verdicts.hpp"

// The hard cases of tools/torture/hard as tests.

namespace carom::test {

/// How much of a long case a test does.
inline torture::Extent extent() {
    return {.is_short = is_effort_reduced()};
}

/// Likewise of a case that draws many worlds: in double precision it does the short one everywhere, since
/// both precisions are one text, and it is in single precision that some draws come near their marks.
template <class Real>
torture::Extent extent_of_draws() {
    return {.is_short = is_effort_reduced() || std::is_same_v<Real, double>};
}

/// A second world that steps along and has to have the same bits.
enum class Twin {
    none,
    other_order,  ///< its parallel tasks run in another order
    all_effects,  ///< effects that the scene does not call for are on; its books have to close, too
};

template <class Real>
class TestedRun final : public torture::HardRun {
  public:
    TestedRun(Scene scene, Twin twin) : scene_(std::move(scene)), kind_(twin) {
        scene_.accuracy.precision = std::is_same_v<Real, float> ? Precision::single_ : Precision::double_;
        world_.emplace(scene_, WorldOptions{.threads = 1});
        if (twin == Twin::other_order) twin_.emplace(scene_, in_other_order({}));
        if (twin == Twin::all_effects) {
            const bool is_rough = world_->plan().solver == "soft" && has_friction(scene_);
            twin_.emplace(scene_, WorldOptions{.effects = is_rough ? all_rough_effects() : all_effects()});
        }
    }
    TestedRun(const TestedRun&) = delete;
    TestedRun& operator=(const TestedRun&) = delete;
    ~TestedRun() override {
        if (!twin_) return;
        CHECK(world_->state_hash() == twin_->state_hash());
        if (kind_ == Twin::all_effects)
            check_books_close(*twin_, std::fmax(scale_, energy_scale(twin_->ledger())), dynamic_mass(scene_));
    }

    bool step(double dt) override {
        if (scale_ == 0) scale_ = energy();
        world_->step(dt);
        if (twin_) twin_->step(dt);
        return true;
    }
    const Scene& scene() const override { return scene_; }
    BodyState state(std::size_t body) const override { return world_->state(id_of(body)); }
    double energy() const override { return world_->ledger().energy.total(); }
    double unexplained() const override { return world_->ledger().energy_by_cause.unexplained; }
    double driven() const override { return world_->ledger().energy_by_cause.drive; }
    double overlap() const override { return world_->overlaps().max; }
    double joint_gap() const override { return world_->joint_errors().max; }
    std::size_t quarantined() const override { return world_->quarantined().size(); }
    std::size_t asleep() const override { return static_cast<std::size_t>(world_->profile().asleep); }
    void set_velocity(std::size_t body, Vec2 velocity) override {
        world_->set_velocity(id_of(body), velocity);
        if (twin_) twin_->set_velocity(id_of(body), velocity);
    }
    std::unique_ptr<HardRun> another(const Scene& scene) const override {
        return std::make_unique<TestedRun>(scene, kind_);
    }

  private:
    static BodyId id_of(std::size_t body) { return {static_cast<std::uint32_t>(body), 0}; }

    Scene scene_;
    Twin kind_;
    std::optional<BasicWorld<Real>> world_, twin_;
    double scale_ = 0;  // J
};

/// Holds every number of the cases against its mark.
template <class Real>
void check_cases(const torture::HardCases& cases, Twin twin = Twin::none) {
    CHECK(!cases.empty());
    for (const torture::HardCase& each : cases) {
        CAPTURE(each.name);
        TestedRun<Real> run(each.make(), twin);
        std::string figures;
        int marks = 0;
        for (const torture::Measure& measure : each.run(run)) {
            const std::string words = words_of(measure);
            CHECK_MESSAGE(measure.passes(), words);
            marks += measure.mark ? 1 : 0;
            figures += (figures.empty() ? "" : ", ") + words;
        }
        CHECK(marks > 0);
        report(each.code, " ", each.name, ": ", figures);
    }
}

}  // namespace carom::test
