#pragma once

#include <carom/errors.hpp>
#include <carom/scene.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace carom {

/// Handles <-> rows. A slot's generation grows when its body is removed, so that old handles go stale.
class Handles {
  public:
    /// A handle for a new body in `row`.
    BodyId add(std::uint32_t row) {
        if (!free_.empty()) {
            const std::uint32_t index = free_.back();
            free_.pop_back();
            slots_[index].row = row;
            return {index, slots_[index].generation};
        }
        slots_.push_back({row, 0});
        return {static_cast<std::uint32_t>(slots_.size() - 1), 0};
    }

    void remove(BodyId id) {
        slots_[id.index].row = kNoRow;
        ++slots_[id.index].generation;
        free_.push_back(id.index);
    }

    bool is_alive(BodyId id) const {
        return id.index < slots_.size() && slots_[id.index].generation == id.generation &&
               slots_[id.index].row != kNoRow;
    }

    /// @throws Error (stale_handle) naming the call.
    std::uint32_t row_of(BodyId id, std::string_view where) const {
        if (is_alive(id)) return slots_[id.index].row;
        throw Error(ErrorCode::stale_handle,
                    std::string(where) + ": handle " + std::to_string(id.index) + " (generation " +
                        std::to_string(id.generation) +
                        ") names no body of this world; it was removed, or comes " +
                        "from another world. Keep the handle that Scene::add or World::add returned.");
    }

    void set_row(BodyId id, std::uint32_t row) { slots_[id.index].row = row; }

    /// Slots ever used; handle order is slot order.
    std::size_t slot_count() const { return slots_.size(); }
    /// Row of slot `index`, or kNoRow.
    std::uint32_t row_of_slot(std::size_t index) const { return slots_[index].row; }
    std::size_t bytes() const {
        return slots_.capacity() * sizeof(Slot) + free_.capacity() * sizeof(std::uint32_t);
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.slots_, self.free_);
    }

    static constexpr std::uint32_t kNoRow = UINT32_MAX;

  private:
    struct Slot {
        std::uint32_t row;
        std::uint32_t generation;
    };
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
};

}  // namespace carom
