#pragma once

#include <carom/accuracy.hpp>
#include <carom/world.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "peers/bench_scene.hpp"

// Other engines beside ours, behind one interface. An adapter makes the scene in its engine, steps it and
// says where the bodies are; everything that is measured of them is measured by the same code
// (body_measures.hpp).

namespace carom::bench {

/// What a run may ask of an engine. The defaults are those of the benchmarks.
struct PeerSettings {
    int substeps = 0;    ///< 0: its default
    int iterations = 0;  ///< 0: its default
    bool for_errors =
        false;            ///< as its users have it: continuous collision on, tolerances of the scene's size
    bool counts = false;  ///< keeps `Peer::counts`
};

/// What an engine says of its contacts since the start.
struct PeerCounts {
    std::int64_t impacts = 0;       ///< contacts that began, walls included
    std::int64_t wall_impacts = 0;  ///< of those, with walls
    double wall_impulse =
        0;  ///< N s, sum of the sizes of the walls' normal impulses; NaN: the engine does not tell
};

class Peer {
  public:
    virtual ~Peer() = default;
    virtual void step(double dt) = 0;  ///< dt in s
    /// Position, angle, velocity and spin of every body, in the order of the scene.
    virtual void read(std::vector<BodyState>& bodies) const = 0;
    virtual PeerCounts counts() const { return {}; }
};

struct PeerEngine {
    std::string family;  ///< the engine, whatever its settings
    std::string name;    ///< with what tells it from others of its family
    std::string version;
    std::string settings;      ///< in the benchmarks: what differs from its defaults, and its version
    std::int64_t most_bodies;  ///< beyond, it is slow beyond use or wrong
    Precision precision;
    std::vector<int> substeps;    ///< that a sweep takes; the default first
    std::vector<int> iterations;  ///< likewise
    int threads = 1;
    /// @throws carom::Error, with the reason, if the engine cannot do the scene
    std::unique_ptr<Peer> (*make)(const BenchScene& scene, const PeerSettings& settings);
    /// Why its answer to a scene is another than ours by its own rules; empty if it is not.
    std::string (*difference)(const Scene& scene) = nullptr;
};

/// Those this program was built with.
std::vector<PeerEngine> other_engines();

/// Those it could have been built with, and what was not found.
struct MissingEngine {
    std::string family, why;
};
std::vector<MissingEngine> missing_engines();

PeerEngine carom_engine(bool on_two_threads = false);
std::vector<PeerEngine> chipmunk_engines();
PeerEngine box2d_2_engine();
PeerEngine box2d_3_engine();

/// One side of a box of walls as a rectangle outside of it.
struct WallBlock {
    Vec2 centre;       ///< m
    Vec2 half_extent;  ///< m
};

/// The closed sides of the scene's walls as thick blocks, for engines that have no walls. Where a side is
/// left open the blocks beside it end some way beyond the bodies.
std::vector<WallBlock> wall_blocks(const Scene& scene);

/// The tiles of a container in its own frame.
std::vector<WallBlock> container_tiles(const Container& container);

double radius_of(const Body& body);   ///< m, of a disc
double mass_of(const Body& body);     ///< kg
double inertia_of(const Body& body);  ///< kg m², about the centre of mass
double density_of(const Body& body);  ///< kg/m², that gives the body's mass

bool is_disc(const Body& body);

/// @throws carom::Error if there is a body that is no disc, or that its own rules move, or a joint
void require_dynamic_discs(const Scene& scene);

/// @throws carom::Error if there is a body without area that is no static chain, or a joint that is no rod
/// between centres of two bodies and no hinge of two bodies or of one on the world
void require_solids_and_plain_joints(const Scene& scene);

}  // namespace carom::bench
