#pragma once

#include <cstdint>
#include <vector>

#include "solvers/contact_sets/project_positions.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the sweeps of a step cannot see: bodies that are deflected within it, and then move by their own
/// size, and many that are deep in each other. At the step's end they are looked at where they are by then
/// and moved apart (solvers/contact_sets/project_positions.hpp), by displacement alone.
template <class Real>
class EndProjection {
  public:
    /// Moves bodies apart that end the step deep in others, in walls or in edges.
    /// @param has_deep_pairs  whether some pair started the step deep in each other
    /// Cost: nothing unless the fastest moves by four radii of the smallest disc, or a pair started deep in
    /// each other; O(bodies + pairs), to look for discs that are small enough, unless one of them was
    /// deflected.
    void project(const StepView<Real>& step, const WorldState<Real>& world, const StepFlight<Real>& flight,
                 bool has_deep_pairs);

    std::size_t bytes() const {
        return projection_.bytes() + thrown_.capacity() * sizeof(std::int32_t) + near_rows_.bytes();
    }

  private:
    /// What `project` is called with.
    struct Inputs {
        const StepView<Real>& step;
        const WorldState<Real>& world;
        const StepFlight<Real>& flight;
    };
    bool mark_deflected(const Inputs& in, double largest);
    bool mark_stuck(const Inputs& in, double largest);
    void mark_deep(const Inputs& in);
    void find_thrown(const Inputs& in);
    void list_pair(const Inputs& in, std::int32_t row_a, std::int32_t row_b, bool is_loaded);
    void list_pairs_of_marked(const Inputs& in);
    void list_pairs_of_thrown(const Inputs& in);
    void list_supports(const Inputs& in);
    void list_support(const Inputs& in, std::int32_t disc, Partner support);
    void list_wall(const Inputs& in, std::int32_t disc, std::int32_t side);
    void push_in_rounds(const Inputs& in, bool any_deflected);
    double free_share(const Inputs& in, std::int32_t row, Vec2 way);
    void put_back_thrown(const Inputs& in);

    PositionProjection projection_;
    std::vector<std::int32_t> thrown_;  // rows, by x
    Column<std::int32_t> near_rows_;
};

extern template class EndProjection<float>;
extern template class EndProjection<double>;

}  // namespace carom
