#pragma once

#include <carom/pairwise.hpp>
#include <carom/scene.hpp>

namespace carom::tool {

/// The scene as the naive pairwise engine takes it.
/// @throws carom::Error naming what that engine cannot do: bodies that are not dynamic, one restitution for
/// some pairs and another for others, friction, sleeping, continuous collision, more than one iteration.
PairwiseScene to_pairwise(const Scene& scene);

}  // namespace carom::tool
