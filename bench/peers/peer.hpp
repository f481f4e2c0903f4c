#pragma once

#include <carom/world.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scenes/scenes.hpp"

// Other engines beside ours, behind one interface. An adapter makes the scene in its engine, steps it and
// says where the bodies are; everything that is measured of them is measured by the same code
// (body_measures.hpp).

namespace carom::bench {

class Peer {
  public:
    virtual ~Peer() = default;
    virtual void step(double dt) = 0;  ///< dt in s
    /// Position, angle, velocity and spin of every body, in the order of the scene.
    virtual void read(std::vector<BodyState>& bodies) const = 0;
};

struct PeerEngine {
    std::string name;
    std::string settings;      ///< what differs from its defaults, and its version
    std::int64_t most_bodies;  ///< beyond, it is slow beyond use or wrong
    /// @throws carom::Error, with the reason, if the engine cannot do the scene
    std::unique_ptr<Peer> (*make)(const BenchScene& scene);
};

/// Ours first, then those this program was built with.
std::vector<PeerEngine> peer_engines();

PeerEngine carom_engine();
std::vector<PeerEngine> chipmunk_engines();
PeerEngine box2d_2_engine();
PeerEngine box2d_3_engine();

/// One side of a box of walls as a rectangle outside of it.
struct WallBlock {
    Vec2 centre;       ///< m
    Vec2 half_extent;  ///< m
};

/// The closed sides of the scene's walls as thick blocks, for engines that have no walls.
std::vector<WallBlock> wall_blocks(const Walls& walls);

/// The tiles of a container in its own frame.
std::vector<WallBlock> container_tiles(const Container& container);

double radius_of(const Body& body);  ///< m
double mass_of(const Body& body);    ///< kg

}  // namespace carom::bench
