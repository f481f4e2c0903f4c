#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accuracy/case.hpp"
#include "peers/peer.hpp"
#include "simulation/simulation.hpp"

namespace carom::accuracy {

/// Other engines that this program was built with, one of each family.
std::span<const bench::PeerEngine> engines();

/// Why a case is not computed with another engine; empty if it is.
std::string why_left_out(const Case& asked, const bench::PeerEngine& engine);

/// A scene in another engine, behind the interface that our solvers have.
/// @throws carom::Error if it cannot do the scene
std::unique_ptr<tool::Simulation> make_engine_simulation(const Scene& scene, const Setting& setting,
                                                         bool counts);

}  // namespace carom::accuracy
