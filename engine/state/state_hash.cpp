#include "state/state_hash.hpp"

#include <bit>

namespace carom {
namespace {

/// FNV-1a over 64-bit words (Fowler, Noll & Vo), with the two zeros made one.
class StateHash {
  public:
    template <class Real>
    void add(Real value) {
        const Real zero_is_positive = value + Real(0);
        if constexpr (sizeof(Real) == sizeof(std::uint32_t))
            add_bits(std::bit_cast<std::uint32_t>(zero_is_positive));
        else
            add_bits(std::bit_cast<std::uint64_t>(zero_is_positive));
    }
    std::uint64_t value() const { return hash_; }

  private:
    void add_bits(std::uint64_t bits) {
        for (int byte = 0; byte < 8; ++byte) {
            hash_ ^= bits & 0xFF;
            hash_ *= 0x100000001B3u;
            bits >>= 8;
        }
    }
    std::uint64_t hash_ = 0xCBF29CE484222325u;
};

}  // namespace

template <class Real>
std::uint64_t hash_of(const WorldState<Real>& world) {
    const Bodies<Real>& b = world.bodies;
    StateHash hash;
    for (std::size_t slot = 0; slot < world.handles.slot_count(); ++slot) {
        const std::uint32_t row = world.handles.row_of_slot(slot);
        if (row == Handles::kNoRow) continue;
        hash.add(b.position_x[row]), hash.add(b.position_y[row]);
        hash.add(b.velocity_x[row]), hash.add(b.velocity_y[row]);
        hash.add(b.has_rotation ? b.angle[row] : Real(0));
        hash.add(b.has_rotation ? b.angular_velocity[row] : Real(0));
    }
    return hash.value();
}

template std::uint64_t hash_of(const WorldState<float>&);
template std::uint64_t hash_of(const WorldState<double>&);

}  // namespace carom
