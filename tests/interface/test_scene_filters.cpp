// Filters of a scene file: what is read, and what is refused, where.
#include "interface/refused_scene.hpp"

#include <doctest/doctest.h>

#include <string>

namespace test_scene_filters {

using namespace carom;
using namespace carom::test;
using namespace carom::tool;

namespace {

std::string with_filter(const std::string& filter) {
    return R"({"carom": 1, "bodies": [{"shape": {"disc": {"radius": 0.2}}, "filter": )" + filter + "}]}";
}

}  // namespace

TEST_SUITE("interface: filters") {
    TEST_CASE("a filter is read with its keys; those left out let all touch") {
        const Body all =
            parse_scene(with_filter(R"({"category": 6, "mask": 65534, "group": 3})"), "t").bodies[0];
        CHECK(all.category == 6);
        CHECK(all.mask == 65534);
        CHECK(all.group == 3);
        const Body none = parse_scene(with_filter("{}"), "t").bodies[0];
        CHECK(none.category == kDefaultCategory);
        CHECK(none.mask == kDefaultMask);
        CHECK(none.group == 0);
    }

    TEST_CASE("filters that cannot be are refused where they stand") {
        check_refused_scene(with_filter(R"({"category": 65536})"), ErrorCode::out_of_range,
                            "/bodies/0/filter/category", "65536; expected 0 to 65535");
        check_refused_scene(with_filter(R"({"mask": -1})"), ErrorCode::out_of_range, "/bodies/0/filter/mask",
                            "mask -1; expected 0 to 65535");
        check_refused_scene(with_filter(R"({"group": 2147483648})"), ErrorCode::out_of_range,
                            "/bodies/0/filter/group", "group 2147483648");
        check_refused_scene(with_filter(R"({"masks": 1})"), ErrorCode::unknown_name, "/bodies/0/filter/masks",
                            "mask");
    }
}

}  // namespace test_scene_filters
