#include "constraints/contact_faults.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace test_contact_faults {

using namespace carom;

namespace {

/// Four bodies in a line, two a chunk: pairs 0-1, 1-2 and 2-3, each a group and a colour of its own, and
/// supports of bodies 0 and 3 by a wall.
struct Line {
    Bodies<float> bodies;
    TaskGroups groups{2, 2};
    ContactRows<float> pairs, supports;

    Line() {
        bodies.resize(4);
        // inside 0, across 0 | 1, inside 1, far
        lay_out(pairs, {{{0, 1}}, {{1, 2}}, {{2, 3}}, {}});
        // chunk 0, chunk 1, without a colour
        lay_out(supports, {{{0, Partner::wall(kLeft).stored()}}, {{3, Partner::wall(kRight).stored()}}, {}});
    }

    using Contact = std::pair<std::int32_t, std::int32_t>;
    void lay_out(ContactRows<float>& rows, const std::vector<std::vector<Contact>>& of_groups) const {
        rows.first_colour.assign(1, 0);
        rows.a.resize(kRowPadding * of_groups.size());
        rows.b.resize(rows.a.size()), rows.normal_impulse.resize(rows.a.size());
        std::size_t place = 0;
        for (const std::vector<Contact>& contacts : of_groups) {
            const std::size_t colour = rows.colours();
            if (!contacts.empty()) {
                rows.begin.push_back(0), rows.count.push_back(0);
                for (std::size_t i = 0; i < contacts.size(); ++i)
                    rows.a[place + i] = contacts[i].first, rows.b[place + i] = contacts[i].second;
                place = rows.close_colour(colour, place, contacts.size(),
                                          static_cast<std::int32_t>(bodies.count));
            }
            rows.first_colour.push_back(rows.colours());
        }
        rows.a.resize(place), rows.b.resize(place), rows.normal_impulse.resize(place);
    }

    std::string fault_of_pairs() const { return text(fault_of(pairs, groups, bodies, true)); }
    std::string fault_of_supports() const { return text(fault_of(supports, groups, bodies, false)); }
    static std::string text(const char* fault) { return fault ? fault : ""; }
};

}  // namespace

TEST_CASE("contacts as they should be have no fault") {
    const Line line;
    CHECK(line.fault_of_pairs() == "");
    CHECK(line.fault_of_supports() == "");
    CHECK(Line::text(fault_of(ContactRows<float>{}, TaskGroups{}, line.bodies, true)) == "");
}

TEST_CASE("each thing that kernels take for granted of pairs has its fault") {
    struct Case {
        const char* fault;
        std::function<void(ContactRows<float>&)> damage;
    };
    // Colour 0 is in front; with two contacts in it, its padding begins at 2.
    const Case cases[] = {
        {"columns of contacts that last differ in length", [](auto& p) { p.b.resize(p.b.size() - 1); }},
        {"contacts have no normal impulses", [](auto& p) { p.normal_impulse.resize(0); }},
        {"there are other groups than those of the rows", [](auto& p) { p.first_colour.push_back(3); }},
        {"groups do not have all colours", [](auto& p) { p.first_colour.back() = 2; }},
        {"groups are out of order", [](auto& p) { std::swap(p.first_colour[1], p.first_colour[2]); }},
        {"a colour begins within a batch", [](auto& p) { ++p.begin[1]; }},
        {"colours overlap", [](auto& p) { p.begin[1] = 0; }},
        {"colours reach beyond their columns", [](auto& p) { p.begin[2] += kRowPadding; }},
        {"a contact names no body", [](auto& p) { p.a[0] = 4; }},
        {"a contact names no body", [](auto& p) { p.a[0] = -1; }},
        {"a contact's other side is no body", [](auto& p) { p.b[0] = 4; }},
        {"a contact's other side is gone", [](auto& p) { p.b[0] = Partner::gone().stored(); }},
        {"a pair is not a < b", [](auto& p) { std::swap(p.a[0], p.b[0]); }},
        {"a pair is not a < b", [](auto& p) { p.b[0] = Partner::wall(kTop).stored(); }},
        {"a contact is in the group of other rows", [](auto& p) { p.b[0] = 2; }},
        {"a colour names a body twice", [](auto& p) { p.count[0] = 2, p.a[1] = 0, p.b[1] = 1; }},
        {"padding names a body", [](auto& p) { p.a[1] = 3; }},
        {"padding has impulses", [](auto& p) { p.normal_impulse[kRowPadding - 1] = 1; }},
    };
    for (const Case& one : cases) {
        CAPTURE(one.fault);
        Line line;
        one.damage(line.pairs);
        CHECK(line.fault_of_pairs() == one.fault);
    }
}

TEST_CASE("a support has a body of its chunk and something that holds it") {
    Line wrong_chunk;
    wrong_chunk.supports.a[0] = 2;
    CHECK(wrong_chunk.fault_of_supports() == "a contact is in the group of other rows");
    Line gone;
    gone.supports.b[0] = Partner::gone().stored();
    CHECK(gone.fault_of_supports() == "a contact's other side is gone");
}

}  // namespace test_contact_faults
