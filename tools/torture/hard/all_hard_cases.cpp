#include <iterator>

#include "torture/hard/hard_case.hpp"

namespace carom::torture {

Measures worst_of_all(HardRun& run, const std::vector<Scene>& more,
                      const std::function<Measures(HardRun&)>& measures) {
    Measures worst = measures(run);
    for (const Scene& scene : more) {
        const Measures own = measures(*run.another(scene));
        for (std::size_t i = 0; i < worst.size(); ++i) {
            const bool is_worse =
                worst[i].mark ? own[i].share() > worst[i].share() : !(own[i].value <= worst[i].value);
            if (is_worse) worst[i] = own[i];
        }
    }
    return worst;
}

HardCases all_hard_cases(Extent extent) {
    HardCases all;
    for (const auto cases : {towers_of_20,
                             towers_of_40,
                             towers_that_sleep,
                             small_pyramids,
                             large_pyramids,
                             discs_under_a_heavy_one,
                             discs_hit_by_a_heavy_one,
                             columns_under_a_heavy_disc,
                             boxes_under_a_heavy_one,
                             five_boxes_under_a_heavy_one,
                             chains_with_weights,
                             light_links_between_heavy_ones,
                             small_discs_around_a_large_one,
                             rains_on_a_large_disc,
                             small_boxes_around_a_large_one,
                             stacks_under_tiny_steps,
                             stacks_under_one_long_step,
                             stacks_under_alternating_steps,
                             stacks_dropped_into_a_shaft,
                             far_from_the_origin,
                             rolling_far_from_the_origin,
                             card_houses,
                             arches,
                             rods_on_their_tip,
                             discs_between_a_box_and_a_post,
                             odd_steps_of_a_pile,
                             random_steps_of_a_pile,
                             random_steps_of_eight_piles,
                             changing_steps_of_many_piles,
                             random_steps_of_a_pile_that_sleeps,
                             shapes_under_a_plate,
                             shapes_in_a_room_that_is_left,
                             rooms_that_many_leave,
                             discs_that_a_paddle_stirs,
                             shapes_that_a_cross_stirs,
                             discs_in_closing_wedges,
                             discs_thrown_into_wedges,
                             overhangs,
                             piles_of_uneven_masses,
                             smooth_piles_of_uneven_masses,
                             twenty_under_a_million,
                             shots_at_plates,
                             shapes_in_a_drum,
                             bodies_in_a_fast_drum}) {
        HardCases some = cases(extent);
        all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
    }
    return all;
}

}  // namespace carom::torture
