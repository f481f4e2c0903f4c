#pragma once

#include <carom/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::measure {

/// All pairs with SIMD: what the naive loop becomes without a grid but with columns. Positions are in
/// columns of floats, a body is compared with a block of others at once (the compiler vectorises that for
/// the machine it runs on), and only blocks with a near body are looked at one by one. Its contacts and its
/// physics are those of the naive loop: push apart half and half, one impulse. A baseline of the benchmarks,
/// no solver of the engine.
class AllPairs {
  public:
    /// @param scene  discs of one radius and mass, walls on all sides, restitution 1
    explicit AllPairs(const Scene& scene);

    /// Advances by dt [s]. Cost: O(bodies²).
    void step(double dt);

    std::size_t body_count() const { return count_; }
    std::int64_t contacts() const { return contacts_; }  ///< overlapping pairs since the start
    double kinetic_energy() const;                       ///< J for discs of unit mass
    std::size_t bytes() const;

  private:
    void resolve(std::size_t a, std::size_t b);
    void bounce_off_walls();

    std::size_t count_;
    float radius_, width_, height_;  // m
    std::vector<float> x_, y_;       // m, padded to whole blocks with bodies far away
    std::vector<float> vx_, vy_;     // m/s
    std::int64_t contacts_ = 0;
};

}  // namespace carom::measure
