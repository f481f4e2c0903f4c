#include "solvers/paths/cut/path_cut.hpp"
#include "solvers/paths/cut/turn_rows.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "kernels/paths/path_arguments.hpp"
#include "math/random.hpp"

namespace test_path_cut {

using namespace carom;

namespace {

std::int32_t below(Random& random, std::size_t limit) {
    return static_cast<std::int32_t>(random.next() % limit);
}

/// Contacts of random bodies; every so many of what nothing moves.
std::vector<ContactLink> random_contacts(Random& random, std::size_t bodies, std::size_t count) {
    std::vector<ContactLink> contacts;
    const auto arm = [&] { return static_cast<float>(below(random, 2001)) / 1000 - 1; };
    while (contacts.size() < count) {
        const std::int32_t a = below(random, bodies);
        const std::int32_t b = below(random, 8) == 0 ? ContactLink::kNothing : below(random, bodies);
        if (a == b) continue;
        contacts.push_back({a, b, arm(), arm(), arm(), arm(), below(random, 2) == 0});
    }
    return contacts;
}

std::int32_t head_of(const ContactLink& contact, bool is_reversed) {
    return is_reversed ? contact.b : contact.a;
}

/// Bodies of each lane of each bundle, in the order of its paths, and whether the contacts hang together:
/// each begins where the one before ends, but behind a jump, after one link that has no contact.
struct Walked {
    std::vector<std::vector<std::int32_t>> bodies;  // by bundle * kPathLanes + lane
    bool hangs_together = true;
};
Walked walk(const PathCut& cut, const std::vector<ContactLink>& contacts) {
    struct Visit {
        std::uint32_t link;
        std::size_t contact;
    };
    std::vector<std::vector<Visit>> visits(cut.bundles() * kPathLanes);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const PathCut::Place place = cut.places()[i];
        visits[place.bundle * kPathLanes + place.lane].push_back({place.link, i});
    }
    Walked walked;
    walked.bodies.resize(visits.size());
    std::map<std::pair<std::size_t, std::size_t>, std::int32_t> jumps;  // by link and lane
    for (const PathCut::Jump& jump : cut.jumps()) jumps[{jump.link, jump.lane}] = jump.contact;
    for (std::size_t lane = 0; lane < visits.size(); ++lane) {
        auto& path = visits[lane];
        std::sort(path.begin(), path.end(), [](const Visit& p, const Visit& q) { return p.link < q.link; });
        std::size_t next = cut.first_link()[lane / kPathLanes];
        for (std::size_t k = 0; k < path.size(); ++k, ++next) {
            const bool reversed = cut.places()[path[k].contact].is_reversed;
            const std::int32_t head = head_of(contacts[path[k].contact], reversed),
                               end = head_of(contacts[path[k].contact], !reversed);
            const auto jump = jumps.find({next, lane % kPathLanes});
            const bool jumps_here = k > 0 && jump != jumps.end();
            if (jumps_here) {
                ++next;
                walked.hangs_together =
                    walked.hangs_together && jump->second == static_cast<std::int32_t>(path[k].contact);
                jumps.erase(jump);
            }
            const bool begins = k == 0 || jumps_here;
            const bool follows = begins || (head == walked.bodies[lane].back() && head >= 0);
            if (begins) walked.bodies[lane].push_back(head);
            walked.hangs_together = walked.hangs_together && follows && path[k].link == next;
            walked.bodies[lane].push_back(end);
        }
    }
    walked.hangs_together = walked.hangs_together && jumps.empty();
    return walked;
}

/// Whether no body that moves is named twice by the paths of a colour.
bool colours_share_no_body(const PathCut& cut, const Walked& walked) {
    bool is_shared = false;
    for (std::size_t colour = 0; colour < cut.colours(); ++colour) {
        std::set<std::int32_t> seen;
        for (std::size_t lane = cut.first_bundle()[colour] * kPathLanes;
             lane < cut.first_bundle()[colour + 1] * kPathLanes; ++lane)
            for (const std::int32_t body : walked.bodies[lane])
                is_shared = is_shared || (body >= 0 && !seen.insert(body).second);
    }
    return !is_shared;
}

}  // namespace

TEST_SUITE("solvers/paths/path_cut") {
    TEST_CASE("every contact has one place, paths hang together and colours share no body that moves") {
        Random random(7);
        for (int trial = 0; trial < 60; ++trial) {
            const auto bodies = static_cast<std::size_t>(2 + below(random, 200));
            const auto contacts =
                random_contacts(random, bodies, static_cast<std::size_t>(below(random, 500)));
            const auto longest = static_cast<std::size_t>(1 + below(random, 20));
            PathCut cut;
            cut.cut(contacts, bodies, longest, Executor());
            REQUIRE(cut.places().size() == contacts.size());
            std::set<std::pair<std::uint32_t, std::uint8_t>> places;
            for (const PathCut::Place& place : cut.places()) places.insert({place.link, place.lane});
            CHECK(places.size() == contacts.size());
            CHECK(cut.longest() <= longest);
            const Walked walked = walk(cut, contacts);
            CHECK(walked.hangs_together);
            CHECK(colours_share_no_body(cut, walked));
            for (std::size_t bundle = 0; bundle < cut.bundles(); ++bundle)
                for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
                    const auto& path = walked.bodies[bundle * kPathLanes + lane];
                    const std::int32_t first = cut.first_contacts()[bundle * kPathLanes + lane];
                    REQUIRE(path.empty() == (first < 0));
                    if (first >= 0)
                        CHECK(cut.places()[static_cast<std::size_t>(first)].link == cut.first_link()[bundle]);
                }
        }
    }
    TEST_CASE("contacts beside the paths have places of their own, and no path leads over them") {
        Random random(11);
        for (int trial = 0; trial < 40; ++trial) {
            const auto bodies = static_cast<std::size_t>(2 + below(random, 100));
            auto contacts = random_contacts(random, bodies, static_cast<std::size_t>(below(random, 300)));
            std::vector<ContactLink> on_paths;
            for (ContactLink& contact : contacts) {
                contact.is_watched = !contact.is_loaded && below(random, 3) > 0;
                if (!contact.is_watched) on_paths.push_back(contact);
            }
            PathCut cut, without;
            cut.cut(contacts, bodies, 16, Executor()), without.cut(on_paths, bodies, 16, Executor());
            // The paths are those of the others alone.
            CHECK(cut.first_watched() == without.bundles());
            std::set<std::pair<std::uint32_t, std::uint8_t>> places;
            for (std::size_t i = 0, other = 0; i < contacts.size(); ++i) {
                const PathCut::Place place = cut.places()[i];
                places.insert({place.link, place.lane});
                CHECK((place.bundle >= cut.first_watched()) == contacts[i].is_watched);
                if (contacts[i].is_watched) continue;
                CHECK(place.link == without.places()[other].link);
                CHECK(place.lane == without.places()[other++].lane);
            }
            CHECK(places.size() == contacts.size());
            CHECK(walk(cut, contacts).hangs_together);
        }
    }
    TEST_CASE("contacts in turns are in the first bundles of each colour, and the paths are the same") {
        Random random(17);
        for (int trial = 0; trial < 40; ++trial) {
            const auto bodies = static_cast<std::size_t>(2 + below(random, 200));
            auto contacts = random_contacts(random, bodies, static_cast<std::size_t>(1 + below(random, 400)));
            for (ContactLink& contact : contacts)
                contact.is_watched = !contact.is_loaded && below(random, 4) == 0;
            PathCut without, cut;
            without.cut(contacts, bodies, 16, Executor());
            CHECK(without.end_of_watched_turns() == without.first_watched());
            for (ContactLink& contact : contacts) contact.is_in_turns = below(random, 8) == 0;
            cut.cut(contacts, bodies, 16, Executor());
            CHECK(walk(cut, contacts).hangs_together);
            CHECK(cut.paths() == without.paths());
            REQUIRE(cut.end_of_turns().size() == cut.colours());
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                const std::size_t bundle = cut.places()[i].bundle;
                if (!contacts[i].is_in_turns) continue;
                const auto colour =
                    std::upper_bound(cut.first_bundle().begin(), cut.first_bundle().end(), bundle) -
                    cut.first_bundle().begin() - 1;
                CHECK(bundle < (contacts[i].is_watched
                                    ? cut.end_of_watched_turns()
                                    : cut.end_of_turns()[static_cast<std::size_t>(colour)]));
            }
        }
    }
    TEST_CASE("contacts near a body in turns are those that few contacts part from it") {
        std::vector<ContactLink> row;  // body i touches body i + 1
        for (std::int32_t i = 0; i < 40; ++i) row.push_back({i, i + 1, 0, 0, 0, 0, true});
        TurnRows turns;
        turns.mark(row);
        CHECK(std::none_of(row.begin(), row.end(), [](const ContactLink& c) { return c.is_in_turns; }));
        turns.begin();
        CHECK_FALSE(turns.are_known());
        turns.ask(20);
        CHECK_FALSE(turns.are_known());
        turns.mark(row);
        turns.begin(), turns.ask(20);
        CHECK(turns.are_known());
        for (std::int32_t i = 0; i < 40; ++i)
            CHECK(row[static_cast<std::size_t>(i)].is_in_turns == (i >= 15 && i <= 24));
        CHECK(turns.is_near(16));
        CHECK_FALSE(turns.is_near(15));
        turns.ask(3);
        CHECK_FALSE(turns.are_known());
    }
    TEST_CASE("a cut is kept while contacts come, go and change their order") {
        Random random(13);
        for (int trial = 0; trial < 40; ++trial) {
            const auto bodies = static_cast<std::size_t>(2 + below(random, 100));
            const auto before =
                random_contacts(random, bodies, static_cast<std::size_t>(1 + below(random, 300)));
            PathCut cut;
            cut.cut(before, bodies, 16, Executor());
            const auto places_before = std::vector(cut.places().begin(), cut.places().end());
            std::vector<ContactLink> now;
            std::vector<PathCut::Slot> slots;
            std::vector<std::size_t> was;  // number before, or before.size()
            for (std::size_t i = before.size(); i-- > 0;) {
                if (below(random, 4) == 0) continue;
                now.push_back(before[i]), slots.push_back(cut.slot_of(i)), was.push_back(i);
                if (below(random, 8) > 0) continue;
                now.push_back({0, 1, 1, 0, -1, 0, false}), slots.push_back({-1, false});
                was.push_back(before.size());
            }
            const std::size_t on_paths = cut.first_watched();
            cut.keep(slots);
            CHECK(cut.first_watched() == on_paths);
            std::set<std::pair<std::uint32_t, std::uint8_t>> places;
            for (std::size_t i = 0; i < now.size(); ++i) {
                const PathCut::Place place = cut.places()[i];
                places.insert({place.link, place.lane});
                CHECK((place.bundle >= on_paths) == (was[i] == before.size()));
                if (was[i] == before.size()) continue;
                CHECK(place.link == places_before[was[i]].link);
                CHECK(place.lane == places_before[was[i]].lane);
                CHECK(place.bundle == places_before[was[i]].bundle);
                CHECK(place.is_reversed == places_before[was[i]].is_reversed);
            }
            CHECK(places.size() == now.size());
            // Each contact begins where the link before it ends: at the same body or by a jump.
            std::map<std::pair<std::size_t, std::size_t>, std::size_t> contact_at, jumps;
            for (std::size_t i = 0; i < now.size(); ++i)
                contact_at[{cut.places()[i].link, cut.places()[i].lane}] = i;
            for (const PathCut::Jump& jump : cut.jumps())
                jumps[{jump.link, jump.lane}] = static_cast<std::size_t>(jump.contact);
            for (std::size_t i = 0; i < now.size(); ++i) {
                const PathCut::Place place = cut.places()[i];
                const std::int32_t head = head_of(now[i], place.is_reversed);
                if (place.link == cut.first_link()[place.bundle]) {
                    CHECK(cut.first_contacts()[place.bundle * kPathLanes + place.lane] ==
                          static_cast<std::int32_t>(i));
                    continue;
                }
                const std::pair<std::size_t, std::size_t> at{place.link - 1, place.lane};
                const auto previous = contact_at.find(at);
                if (previous != contact_at.end())
                    CHECK(head_of(now[previous->second], !cut.places()[previous->second].is_reversed) ==
                          head);
                else
                    CHECK(jumps.at(at) == i);
            }
        }
    }
    TEST_CASE("short paths stand behind each other where a long one goes on") {
        // A column of 21 contacts, and 60 pairs of bodies apart: all have the first colour.
        std::vector<ContactLink> contacts;
        std::int32_t body = 0;
        for (; body < 21; ++body) contacts.push_back({body, body + 1, 0, 1, 0, -1, true});
        for (++body; contacts.size() < 81; body += 2) contacts.push_back({body, body + 1, 0, 1, 0, -1, true});
        PathCut cut;
        cut.cut(contacts, static_cast<std::size_t>(body), 128, Executor());
        CHECK(cut.bundles() == 1);
        CHECK(cut.links() == 21);
        CHECK(cut.paths() == 61);
        CHECK(walk(cut, contacts).hangs_together);
    }
    TEST_CASE("a column of bodies is one path from the ground to the top") {
        std::vector<ContactLink> contacts{{0, ContactLink::kNothing, 0, -1, 0, 1, true}};
        for (std::int32_t body = 1; body < 12; ++body)
            contacts.push_back({body - 1, body, 0, 1, 0, -1, true});
        PathCut cut;
        cut.cut(contacts, 12, 16, Executor());
        CHECK(cut.bundles() == 1);
        CHECK(cut.links() == 12);
        CHECK(cut.longest() == 12);
    }
    TEST_CASE(
        "a tower is slender, until a load leads to its bodies from aside, and where nothing is loaded yet") {
        const auto is_slender = [](int high, bool is_loaded, bool has_neighbours) {
            std::vector<ContactLink> contacts{{0, ContactLink::kNothing, 0, -1, 0, 1, is_loaded}};
            for (std::int32_t body = 1; body < high; ++body)
                contacts.push_back({body - 1, body, 0, 1, 0, -1, is_loaded});
            if (has_neighbours)
                for (std::int32_t body = 0; body < high; ++body)
                    contacts.push_back({body, high + body, 1, 0, -1, 0, is_loaded});
            PathCut cut;
            cut.cut(contacts, static_cast<std::size_t>(2 * high), 128, Executor());
            return std::ranges::any_of(cut.is_slender(), [](std::uint8_t slender) { return slender != 0; });
        };
        CHECK(is_slender(12, true, false));
        CHECK_FALSE(is_slender(12, true, true));
        CHECK_FALSE(is_slender(12, false, false));
        CHECK_FALSE(is_slender(PathCut::kSlender, true, false));
    }
    TEST_CASE("a tower of a hundred is one path, and in parts as long as each other once loads lead aside") {
        const auto cut_tower = [](bool has_neighbours) {
            std::vector<ContactLink> contacts{{0, ContactLink::kNothing, 0, -1, 0, 1, true}};
            for (std::int32_t body = 1; body < 100; ++body)
                contacts.push_back({body - 1, body, 0, 1, 0, -1, true});
            if (has_neighbours)
                for (std::int32_t body = 0; body < 100; ++body)
                    contacts.push_back({body, 100 + body, 1, 0, -1, 0, true});
            PathCut cut;
            cut.cut(contacts, 200, 128, Executor());
            CHECK(walk(cut, contacts).hangs_together);
            return cut.longest();
        };
        CHECK(cut_tower(false) == 100);
        CHECK(cut_tower(true) == 51);  // the last body leads on to its neighbour: 101 contacts in two parts
    }
    TEST_CASE("paths of a wall of a thousand bricks fill the lanes of their bundles") {
        // Courses of 40 bricks that touch side by side, each brick on two of the course below.
        constexpr std::int32_t kCourses = 25, kBricks = 40;
        std::vector<ContactLink> contacts;
        for (std::int32_t course = 0; course < kCourses; ++course)
            for (std::int32_t k = 0; k < kBricks; ++k) {
                const std::int32_t brick = course * kBricks + k;
                if (k + 1 < kBricks) contacts.push_back({brick, brick + 1, 0.5F, 0, -0.5F, 0, false});
                if (course == 0) {
                    contacts.push_back({brick, ContactLink::kNothing, 0, -0.5F, 0, 0, true});
                    continue;
                }
                const std::int32_t aside = course % 2 == 0 ? k - 1 : k + 1;
                contacts.push_back({brick - kBricks, brick, 0.25F, 0.5F, -0.25F, -0.5F, true});
                if (aside >= 0 && aside < kBricks)
                    contacts.push_back(
                        {(course - 1) * kBricks + aside, brick, -0.25F, 0.5F, 0.25F, -0.5F, true});
            }
        PathCut cut;
        cut.cut(contacts, kCourses * kBricks, 128, Executor());
        const Walked walked = walk(cut, contacts);
        CHECK(walked.hangs_together);
        CHECK(colours_share_no_body(cut, walked));
        CHECK(3 * contacts.size() > 2 * kPathLanes * cut.links());  // no more than a third of them are free
    }
    TEST_CASE("up to twelve contacts of a body are joined by twos, those without load, too") {
        for (const bool is_loaded : {true, false})
            for (std::int32_t count = 2; count <= 20; ++count) {
                std::vector<ContactLink> contacts;
                for (std::int32_t body = 1; body <= count; ++body)
                    contacts.push_back({0, body, static_cast<float>(body), 1, 0, -1, is_loaded});
                PathCut cut;
                cut.cut(contacts, static_cast<std::size_t>(count) + 1, 16, Executor());
                const int joined = std::min(count, 12);
                CHECK(cut.paths() == static_cast<std::size_t>((joined + 1) / 2 + count - joined));
            }
    }
    TEST_CASE("a load goes straight through: contacts that face each other are joined") {
        // One body between four: left, right, below and above it.
        const std::vector<ContactLink> contacts{{0, 1, -1, 0, 1, 0, true},
                                                {0, 2, 0, -1, 0, 1, true},
                                                {0, 3, 1, 0, -1, 0, true},
                                                {0, 4, 0, 1, 0, -1, true}};
        PathCut cut;
        cut.cut(contacts, 5, 16, Executor());
        const auto same_path = [&](std::size_t i, std::size_t j) {
            return cut.places()[i].bundle == cut.places()[j].bundle &&
                   cut.places()[i].lane == cut.places()[j].lane;
        };
        CHECK(same_path(0, 2));
        CHECK(same_path(1, 3));
        CHECK_FALSE(same_path(0, 1));
    }
    TEST_CASE("a body with a thousand contacts gets its colours, and the rest go one by one") {
        std::vector<ContactLink> contacts;
        for (std::int32_t body = 1; body <= 1000; ++body) contacts.push_back({0, body, 0, 1, 0, -1, true});
        PathCut cut;
        cut.cut(contacts, 1001, 16, Executor());
        CHECK(cut.places().size() == 1000);
        CHECK(cut.bundles() == cut.colours());  // all of them share body 0
    }
    TEST_CASE(
        "bodies that all touch each other at many places take no more bundles than a body has contacts") {
        // Compounds that are squeezed: 25 contacts of each two of 20 bodies, 475 of each body. A greedy
        // colouring of links has fewer colours than twice the links of a body, and a colour of ten links at
        // most is one bundle.
        constexpr std::int32_t kBodies = 20, kOfTwo = 25;
        std::vector<ContactLink> contacts;
        for (std::int32_t k = 0; k < kOfTwo; ++k)
            for (std::int32_t b = 1; b < kBodies; ++b)
                for (std::int32_t a = 0; a < b; ++a) {
                    const auto arm = static_cast<float>(k) / kOfTwo;
                    contacts.push_back({a, b, arm, 1, -arm, -1, (a + b + k) % 3 == 0});
                }
        PathCut cut;
        cut.cut(contacts, kBodies, 16, Executor());
        CHECK(cut.bundles() < 2 * kOfTwo * (kBodies - 1));
        CHECK(walk(cut, contacts).hangs_together);
        CHECK(colours_share_no_body(cut, walk(cut, contacts)));
    }
    TEST_CASE("without contacts there is nothing") {
        PathCut cut;
        cut.cut({}, 10, 16, Executor());
        CHECK(cut.bundles() == 0);
        CHECK(cut.links() == 0);
        CHECK(cut.colours() == 0);
    }
}

}  // namespace test_path_cut
