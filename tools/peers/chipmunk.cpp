#include <carom/errors.hpp>

#include <chipmunk/chipmunk.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

constexpr int kIterations = 10;
// Its slop is 0.1, meant for lengths in pixels; this is Box2D's part of a disc of 1 m.
constexpr double kSlopOfRadius = 0.005;

/// Debian's Chipmunk is a debug build, which greets on standard output when it makes its first space: that is
/// where results go.
cpSpace* make_space() {
    std::fflush(stdout);
    const int kept = dup(STDOUT_FILENO), nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO), close(nowhere);
    cpSpace* const space = cpSpaceNew();
    std::fflush(stdout);
    if (kept >= 0) dup2(kept, STDOUT_FILENO), close(kept);
    return space;
}

double smallest_radius(const Scene& scene) {
    double smallest = INFINITY;
    for (const Body& body : scene.bodies) smallest = std::fmin(smallest, radius_of(body));
    return smallest;
}

class ChipmunkPeer : public Peer {
  public:
    ChipmunkPeer(const BenchScene& bench, const PeerSettings& settings, bool spatial_hash)
        : space_(make_space()) {
        const Scene& scene = bench.scene;
        cpSpaceSetIterations(space_, settings.iterations > 0 ? settings.iterations : kIterations);
        cpSpaceSetDamping(space_, std::exp(-scene.drag.linear));  // part of the speed left after a second
        if (settings.for_errors) cpSpaceSetCollisionSlop(space_, kSlopOfRadius * smallest_radius(scene));
        if (settings.counts) listen();
        cpSpaceSetGravity(space_, cpv(scene.gravity.x, scene.gravity.y));
        if (spatial_hash) {  // its manual's rule: cells of a body's size, ten times as many as bodies
            constexpr double kCell = 1;  // m
            cpSpaceUseSpatialHash(space_, kCell, static_cast<int>(10 * scene.bodies.size()));
        }
        if (scene.walls) add_blocks(cpSpaceGetStaticBody(space_), wall_blocks(scene), scene.walls->material);
        if (bench.container) add_container(*bench.container, scene.bodies.at(0).material);
        for (const Body& body : scene.bodies) add_disc(body);
    }
    ~ChipmunkPeer() override {
        for (cpShape* shape : shapes_) cpSpaceRemoveShape(space_, shape), cpShapeFree(shape);
        for (cpBody* body : all_bodies_) cpSpaceRemoveBody(space_, body), cpBodyFree(body);
        cpSpaceFree(space_);
    }
    ChipmunkPeer(const ChipmunkPeer&) = delete;
    ChipmunkPeer& operator=(const ChipmunkPeer&) = delete;

    void step(double dt) override { cpSpaceStep(space_, dt); }
    PeerCounts counts() const override { return counts_; }

    void read(std::vector<BodyState>& bodies) const override {
        bodies.clear();
        for (cpBody* body : discs_) {
            const cpVect position = cpBodyGetPosition(body), velocity = cpBodyGetVelocity(body);
            bodies.push_back({{position.x, position.y},
                              cpBodyGetAngle(body),
                              {velocity.x, velocity.y},
                              cpBodyGetAngularVelocity(body)});
        }
    }

  private:
    /// It multiplies the coefficients of a pair: square roots give the products that others have.
    void add_shape(cpShape* shape, const Material& material) {
        cpShapeSetFriction(shape, std::sqrt(material.friction));
        cpShapeSetElasticity(shape, std::sqrt(material.restitution));
        shapes_.push_back(cpSpaceAddShape(space_, shape));
    }
    void add_blocks(cpBody* body, const std::vector<WallBlock>& blocks, const Material& material) {
        for (const WallBlock& block : blocks) {
            const double w = block.half_extent.x, h = block.half_extent.y;
            const std::array corners{cpv(-w, -h), cpv(w, -h), cpv(w, h), cpv(-w, h)};
            add_shape(cpPolyShapeNew(body, 4, corners.data(),
                                     cpTransformTranslate(cpv(block.centre.x, block.centre.y)), 0),
                      material);
        }
    }
    void add_container(const Container& container, const Material& material) {
        cpBody* const body = cpSpaceAddBody(space_, cpBodyNewKinematic());
        all_bodies_.push_back(body);
        cpBodySetAngularVelocity(body, container.angular_velocity);
        add_blocks(body, container_tiles(container), material);
    }
    void add_disc(const Body& description) {
        const double radius = radius_of(description), mass = mass_of(description);
        const double inertia =
            description.fixed_rotation ? INFINITY : cpMomentForCircle(mass, 0, radius, cpvzero);
        cpBody* const body = cpSpaceAddBody(space_, cpBodyNew(mass, inertia));
        cpBodySetAngle(body, description.angle);
        cpBodySetAngularVelocity(body, description.angular_velocity);
        cpBodySetPosition(body, cpv(description.position.x, description.position.y));
        cpBodySetVelocity(body, cpv(description.velocity.x, description.velocity.y));
        all_bodies_.push_back(body);
        discs_.push_back(body);
        add_shape(cpCircleShapeNew(body, radius, cpvzero), description.material);
    }

    /// Counts contacts with walls and others.
    void listen() {
        cpCollisionHandler* const handler = cpSpaceAddDefaultCollisionHandler(space_);
        handler->userData = &counts_;
        handler->beginFunc = [](cpArbiter* contact, cpSpace*, cpDataPointer data) -> cpBool {
            auto& counts = *static_cast<PeerCounts*>(data);
            ++counts.impacts;
            counts.wall_impacts += is_with_wall(contact);
            return cpTrue;
        };
        handler->postSolveFunc = [](cpArbiter* contact, cpSpace*, cpDataPointer data) {
            if (is_with_wall(contact))
                static_cast<PeerCounts*>(data)->wall_impulse +=
                    std::fabs(cpvdot(cpArbiterTotalImpulse(contact), cpArbiterGetNormal(contact)));
        };
    }
    static bool is_with_wall(const cpArbiter* contact) {
        cpBody *a = nullptr, *b = nullptr;
        cpArbiterGetBodies(contact, &a, &b);
        return cpBodyGetType(a) == CP_BODY_TYPE_STATIC || cpBodyGetType(b) == CP_BODY_TYPE_STATIC;
    }

    PeerCounts counts_;
    cpSpace* space_;
    std::vector<cpShape*> shapes_;
    std::vector<cpBody*> all_bodies_, discs_;
};

std::unique_ptr<Peer> make_with_tree(const BenchScene& scene, const PeerSettings& settings) {
    require_dynamic_discs(scene.scene);
    return std::make_unique<ChipmunkPeer>(scene, settings, false);
}
std::unique_ptr<Peer> make_with_hash(const BenchScene& scene, const PeerSettings& settings) {
    require_dynamic_discs(scene.scene);
    return std::make_unique<ChipmunkPeer>(scene, settings, true);
}

/// It multiplies the coefficients of a pair where we take the larger: the same only where all are equal.
std::string difference(const Scene& scene) {
    for (const Body& body : scene.bodies) {
        const double own = body.material.restitution;
        if (own != scene.bodies.front().material.restitution ||
            (scene.walls && own != scene.walls->material.restitution))
            return "it multiplies the restitution of the two that meet; here the larger counts";
    }
    if (scene.drag.linear != scene.drag.angular && scene.drag.angular != 0)
        return "it has one drag for speed and spin";
    return {};
}

}  // namespace

std::vector<PeerEngine> chipmunk_engines() {
    const std::string settings =
        measure::joined(cpVersionString, " as installed, double precision, 10 iterations, ");
    const PeerEngine tree{.family = "Chipmunk",
                          .name = "Chipmunk, tree",
                          .version = cpVersionString,
                          .settings = settings + "tree of bounding boxes (its default)",
                          .most_bodies = 50'000,
                          .precision = Precision::double_,
                          .substeps = {1},
                          .iterations = {kIterations, 1, 3, 100, 30},
                          .make = &make_with_tree,
                          .difference = &difference};
    PeerEngine hash = tree;
    hash.name = "Chipmunk, hash";
    hash.settings = settings + "spatial hash, cells of 1 m";
    hash.most_bodies = 200'000, hash.make = &make_with_hash;
    return {tree, hash};
}

}  // namespace carom::bench
