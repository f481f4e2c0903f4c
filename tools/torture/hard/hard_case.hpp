#pragma once

#include <carom/scene.hpp>

#include <functional>
#include <string>
#include <vector>

#include "torture/hard/hard_run.hpp"
#include "torture/outcome.hpp"

namespace carom::torture {

using Measures = std::vector<Measure>;

/// A row of the matrix: a scene, what is done with it, and what is measured beside its marks. Tests of
/// tests/hard_cases and tests/physics run the same.
struct HardCase {
    std::string code;  ///< of docs/hard-cases.md, or docs/exact-cases.md
    std::string name;  ///< no other case has it
    std::function<Scene()> make;
    std::function<Measures(HardRun&)> run;
};

/// How much of a long case is run: all of it, or a part, in slow builds and where the command is asked for
/// a quick matrix.
struct Extent {
    bool is_short = false;

    template <class T>
    T of(T full, T part) const {
        return is_short ? part : full;
    }
};

/// The worst of several scenes of one kind: of each measure the one that takes up most of its mark.
/// @param run  of the first scene
Measures worst_of_all(HardRun& run, const std::vector<Scene>& more,
                      const std::function<Measures(HardRun&)>& measures);

using HardCases = std::vector<HardCase>;

// Each is what one test checks; those of one file are told apart by what stands or falls in them.
HardCases towers_of_20(Extent extent);
HardCases towers_of_40(Extent extent);
HardCases towers_that_sleep(Extent extent);
HardCases small_pyramids(Extent extent);
HardCases large_pyramids(Extent extent);
HardCases overhangs(Extent extent);
HardCases arches(Extent extent);
HardCases card_houses(Extent extent);
HardCases rods_on_their_tip(Extent extent);

HardCases discs_under_a_heavy_one(Extent extent);
HardCases discs_hit_by_a_heavy_one(Extent extent);
HardCases columns_under_a_heavy_disc(Extent extent);
HardCases twenty_under_a_million(Extent extent);
HardCases boxes_under_a_heavy_one(Extent extent);
HardCases five_boxes_under_a_heavy_one(Extent extent);
HardCases piles_of_uneven_masses(Extent extent);
HardCases smooth_piles_of_uneven_masses(Extent extent);

HardCases chains_with_weights(Extent extent);
HardCases light_links_between_heavy_ones(Extent extent);

HardCases small_discs_around_a_large_one(Extent extent);
HardCases rains_on_a_large_disc(Extent extent);
HardCases small_boxes_around_a_large_one(Extent extent);

HardCases shapes_under_a_plate(Extent extent);
HardCases shapes_in_a_room_that_is_left(Extent extent);
HardCases rooms_that_many_leave(Extent extent);
HardCases discs_that_a_paddle_stirs(Extent extent);
HardCases shapes_that_a_cross_stirs(Extent extent);
HardCases discs_in_closing_wedges(Extent extent);
HardCases discs_thrown_into_wedges(Extent extent);
HardCases discs_between_a_box_and_a_post(Extent extent);
HardCases shots_at_plates(Extent extent);
HardCases shapes_in_a_drum(Extent extent);
HardCases bodies_in_a_fast_drum(Extent extent);

HardCases odd_steps_of_a_pile(Extent extent);
HardCases random_steps_of_a_pile(Extent extent);
HardCases random_steps_of_eight_piles(Extent extent);  // no test: it misses its mark
HardCases changing_steps_of_many_piles(Extent extent);
HardCases random_steps_of_a_pile_that_sleeps(Extent extent);
HardCases stacks_under_tiny_steps(Extent extent);
HardCases stacks_under_one_long_step(Extent extent);
HardCases stacks_under_alternating_steps(Extent extent);
HardCases stacks_dropped_into_a_shaft(Extent extent);

HardCases far_from_the_origin(Extent extent);
HardCases rolling_far_from_the_origin(Extent extent);  // no test: it misses its mark

/// All of them, in the order of their codes.
HardCases all_hard_cases(Extent extent);

}  // namespace carom::torture
