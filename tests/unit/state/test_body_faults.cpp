#include "state/body_faults.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <string>

namespace test_body_faults {

using namespace carom;

namespace {

Bodies<float> seventeen_bodies() {
    Bodies<float> bodies;
    bodies.has_rotation = true;
    bodies.resize(17);
    for (std::size_t row = 0; row < bodies.count; ++row) bodies.radius.set(row, bodies.count, 0.5f);
    bodies.mass.set(3, bodies.count, 2);  // a column, for the others have another mass
    return bodies;
}

std::string fault(const Bodies<float>& bodies) {
    const char* const found = fault_of(bodies);
    return found ? found : "";
}

}  // namespace

TEST_SUITE("state/body faults") {
    TEST_CASE("bodies as they should be have no fault") {
        CHECK(fault(Bodies<float>{}) == "");
        CHECK(fault(seventeen_bodies()) == "");
    }

    TEST_CASE("each thing that kernels take for granted of bodies has its fault") {
        struct Case {
            const char* fault;
            std::function<void(Bodies<float>&)> damage;
        };
        const Case cases[] = {
            {"more bodies stand than there are", [](auto& b) { b.standing = 18; }},
            {"columns of bodies differ in length", [](auto& b) { b.velocity_y.resize(16); }},
            {"columns of bodies differ in length", [](auto& b) { ++b.asleep; }},
            {"padding of bodies is not zero", [](auto& b) { b.position_x.data()[17] = 1; }},
            {"padding of bodies is not zero", [](auto& b) { b.angle.data()[31] = 1e-30f; }},
            {"padding of bodies is not zero",
             [](auto& b) {
                 b.id.data()[20] = BodyId{0, 1};
             }},
        };
        for (const Case& one : cases) {
            CAPTURE(one.fault);
            Bodies<float> bodies = seventeen_bodies();
            one.damage(bodies);
            CHECK(fault(bodies) == one.fault);
        }
    }
}

}  // namespace test_body_faults
