#include <carom/errors.hpp>

#include <chipmunk/chipmunk.h>

#include <array>
#include <cmath>

#include "measure/text.hpp"
#include "peers/peer.hpp"

namespace carom::bench {
namespace {

class ChipmunkPeer : public Peer {
  public:
    ChipmunkPeer(const BenchScene& bench, bool spatial_hash) : space_(cpSpaceNew()) {
        const Scene& scene = bench.scene;
        cpSpaceSetIterations(space_, 10);
        cpSpaceSetGravity(space_, cpv(scene.gravity.x, scene.gravity.y));
        if (spatial_hash) {  // its manual's rule: cells of a body's size, ten times as many as bodies
            constexpr double kCell = 1;  // m
            cpSpaceUseSpatialHash(space_, kCell, static_cast<int>(10 * scene.bodies.size()));
        }
        if (scene.walls)
            add_blocks(cpSpaceGetStaticBody(space_), wall_blocks(*scene.walls), scene.walls->material);
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
        cpBody* const body =
            cpSpaceAddBody(space_, cpBodyNew(mass, cpMomentForCircle(mass, 0, radius, cpvzero)));
        cpBodySetPosition(body, cpv(description.position.x, description.position.y));
        cpBodySetVelocity(body, cpv(description.velocity.x, description.velocity.y));
        all_bodies_.push_back(body);
        discs_.push_back(body);
        add_shape(cpCircleShapeNew(body, radius, cpvzero), description.material);
    }

    cpSpace* space_;
    std::vector<cpShape*> shapes_;
    std::vector<cpBody*> all_bodies_, discs_;
};

std::unique_ptr<Peer> make_with_tree(const BenchScene& scene) {
    return std::make_unique<ChipmunkPeer>(scene, false);
}
std::unique_ptr<Peer> make_with_hash(const BenchScene& scene) {
    return std::make_unique<ChipmunkPeer>(scene, true);
}

}  // namespace

std::vector<PeerEngine> chipmunk_engines() {
    const std::string settings =
        measure::joined(cpVersionString, " as installed, double precision, 10 iterations, ");
    return {{"Chipmunk, tree", settings + "tree of bounding boxes (its default)", 50'000, &make_with_tree},
            {"Chipmunk, hash", settings + "spatial hash, cells of 1 m", 200'000, &make_with_hash}};
}

}  // namespace carom::bench
