#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

#include "solvers/impulse/impacts/impact_resolver.hpp"

namespace carom {

/// Resolvers that tasks side by side take and give back: as many as there are tasks at the same time, so that
/// on one thread a single one stays in the cache. What a resolver was used for before must not matter.
template <class Real>
class ResolverPool {
  public:
    /// Calls fn(resolver) with one that no other task uses; waits for one if all are in use.
    template <class Fn>
    void with_resolver(const Fn& fn) {
        for (std::size_t i = 0;; i = (i + 1) % kResolvers) {
            if (is_used_[i].exchange(true, std::memory_order_acquire)) continue;
            if (!resolvers_[i]) resolvers_[i] = std::make_unique<ImpactResolver<Real>>();
            fn(*resolvers_[i]);
            is_used_[i].store(false, std::memory_order_release);
            return;
        }
    }
    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const auto& resolver : resolvers_)
            if (resolver) bytes += sizeof(*resolver) + resolver->bytes();
        return bytes;
    }

  private:
    static constexpr std::size_t kResolvers = 64;  // more tasks at a time wait for each other
    std::array<std::unique_ptr<ImpactResolver<Real>>, kResolvers> resolvers_;
    std::array<std::atomic<bool>, kResolvers> is_used_{};
};

}  // namespace carom
