#pragma once

#include "state/books.hpp"

namespace carom {

/// Adds what was written into books of its own, beside others, to those of the world.
inline void add_books(Books& books, const Books& more) {
    books.drag += more.drag, books.restitution += more.restitution, books.friction += more.friction;
    books.correction += more.correction, books.joints += more.joints, books.drive += more.drive;
    books.sleep += more.sleep, books.overlap_worth += more.overlap_worth;
    books.gravity_momentum += more.gravity_momentum, books.drag_momentum += more.drag_momentum;
    books.wall_momentum += more.wall_momentum, books.immovable_momentum += more.immovable_momentum;
    books.sleep_momentum += more.sleep_momentum;
    books.wall_impulse += more.wall_impulse;
}

}  // namespace carom
