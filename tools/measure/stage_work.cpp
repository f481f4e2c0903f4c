#include "measure/stage_work.hpp"

#include <array>

namespace carom::measure {
namespace {

/// @param calls  of the stage in a step: one a substep
using Count = double (*)(const ProfiledSteps&, double calls);
using Bytes = double (*)(double real);

struct StageModel {
    std::string_view stage;
    std::string_view item;
    Count items;  // a step
    Bytes bytes;  // an item, for numbers of so many bytes
    double operations;
};

double all_bodies(const ProfiledSteps& s, double calls) {
    return s.bodies * calls;
}
double rebuilt_bodies(const ProfiledSteps& s, double) {
    return s.bodies * static_cast<double>(s.after.rebuilds - s.before.rebuilds) / s.steps();
}
double candidate_pairs(const ProfiledSteps& s, double calls) {
    return static_cast<double>(s.after.candidate_pairs) * calls;
}
double contacts(const ProfiledSteps& s, double calls) {
    return static_cast<double>(s.after.contacts) * calls;
}
/// Contacts are swept twice a substep.
double swept_contacts(const ProfiledSteps& s, double calls) {
    return 2 * contacts(s, calls);
}
double impacts(const ProfiledSteps& s, double) {
    return static_cast<double>(s.after.impacts - s.before.impacts) / s.steps();
}

constexpr std::array kModels{
    // x, y, vx, vy, where pairs were found, reach; a record of four
    StageModel{"begin_flight", "body", &all_bodies, [](double real) { return 11 * real; }, 43},
    // positions kept, cells, counting and placing, search with about two pairs a body
    StageModel{"update_candidates", "body whose pairs were found", &rebuilt_bodies,
               [](double real) { return 15 * real + 52; }, 40},
    // two rows, and one record that the pair before did not have
    StageModel{"find_impacts", "candidate pair", &candidate_pairs, [](double real) { return 4 * real + 8; },
               29},
    // the records of both, and of about nine neighbours of each with their rows; each is tested in 28
    // operations
    StageModel{"resolve_impacts", "impact", &impacts,
               [](double real) { return 2 * (4 * real + 9 * (4 * real + 4)); }, 2 * 9 * 28 + 60},
    StageModel{"keep_books", "body", &all_bodies, [](double real) { return 5 * real; }, 20},
    StageModel{"advance_rotation", "body", &all_bodies, [](double real) { return 4 * real; }, 3},
    // a record in, two of velocity and one of displacement out
    StageModel{"begin_substeps", "body", &all_bodies, [](double real) { return 16 * real; }, 7},
    // two rows, impulses, and one record that the pair before did not have
    StageModel{"find_contacts", "candidate pair", &candidate_pairs, [](double real) { return 6 * real + 8; },
               30},
    // two rows; normal, mass, floor; both impulses in and out; a record in and out that the contact before
    // did not have, and in every other sweep a displacement and the separation
    StageModel{"solve_contacts", "contact and sweep", &swept_contacts,
               [](double real) { return 8 + (4 + 4 + 8 + 2.5) * real; }, 46},
    // number, impulses in and out
    StageModel{"end_contacts", "contact", &contacts, [](double real) { return 4 * real + 4; }, 0},
    // two records of velocity and one of displacement in and out, the turn
    StageModel{"advance_bodies", "body and substep", &all_bodies, [](double real) { return 22 * real; }, 38},
    StageModel{"end_substeps", "body", &all_bodies, [](double real) { return 17 * real; }, 13},
    StageModel{"end_flight", "body", &all_bodies, [](double real) { return 8 * real; }, 16},
};

}  // namespace

std::optional<StageWork> work_of_stage(std::string_view stage, const ProfiledSteps& steps, double calls) {
    for (const StageModel& model : kModels)
        if (model.stage == stage)
            return StageWork{
                model.item, model.items(steps, calls), {model.bytes(steps.real_bytes), model.operations}};
    return std::nullopt;
}

}  // namespace carom::measure
