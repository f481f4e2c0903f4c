#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carom {

/// The stages of a step, in its order.
enum class StageName : std::uint8_t {
    sort_rows,
    begin_flight,
    update_candidates,
    wake_sleepers,
    find_impacts,
    settle_contacts,
    resolve_impacts,
    keep_books,
    advance_rotation,
    end_flight,
    run_events,
    update_contacts,
    begin_substeps,
    find_contacts,
    solve_contacts,
    book_substep,
    advance_bodies,
    end_contacts,
    end_substeps,
    book_displacements,
    put_to_sleep,
};

/// What a stage touches; `carom explain` and docs/how-a-step-works.md print it.
struct StageInfo {
    std::string_view name;
    std::string_view reads;
    std::string_view writes;
};

inline constexpr std::array kStages{
    StageInfo{"sort_rows", "position", "rows of all columns"},
    StageInfo{"begin_flight", "position, velocity", "motion, rows near walls, rows out of margin"},
    StageInfo{"update_candidates", "position, velocity, radius", "candidate pairs"},
    StageInfo{"wake_sleepers", "position, velocity, candidate pairs", "rows of all columns, supports"},
    StageInfo{"find_impacts", "motion, candidate pairs", "meetings"},
    StageInfo{"settle_contacts", "meetings, motion", "motion, accelerations, impact queue"},
    StageInfo{"resolve_impacts", "impact queue, motion, candidate pairs", "motion"},
    StageInfo{"keep_books", "motion, angular velocity", "books"},
    StageInfo{"advance_rotation", "angular velocity", "angle, angular velocity"},
    StageInfo{"end_flight", "motion, accelerations", "position, velocity"},
    StageInfo{"run_events", "all columns", "position, velocity, angle, angular velocity, books"},
    StageInfo{"update_contacts", "candidate pairs", "coloured candidates, impulses"},
    StageInfo{"begin_substeps", "motion, angular velocity, mass, radius", "velocity records"},
    StageInfo{"find_contacts", "motion, coloured candidates, impulses", "contacts, velocity records"},
    StageInfo{"solve_contacts", "motion, contacts, velocity records",
              "impulses, velocity records, displacements"},
    StageInfo{"book_substep", "contacts, velocity records", "books"},
    StageInfo{"advance_bodies", "velocity records", "velocity records, displacements"},
    StageInfo{"end_contacts", "contacts, velocity records", "impulses, velocity records"},
    StageInfo{"end_substeps", "velocity records, displacements",
              "position, velocity, angle, angular velocity"},
    StageInfo{"book_displacements", "motion, position", "books"},
    StageInfo{"put_to_sleep", "velocity, angular velocity, coloured candidates, impulses",
              "rows of all columns, velocity, angular velocity, books"},
};

constexpr const StageInfo& info_of(StageName stage) {
    return kStages[static_cast<std::size_t>(stage)];
}

}  // namespace carom
