#include "parallel/phases.hpp"

namespace carom {

void Phases::begin(std::size_t threads, std::span<const PhaseKind> kinds) {
    before_ += kinds_.size();
    kinds_ = kinds;
    waited_ = 0;
    if (threads <= room_) return;
    done_ = std::make_unique<Done[]>(threads);
    room_ = threads, before_ = 0;
}

}  // namespace carom
