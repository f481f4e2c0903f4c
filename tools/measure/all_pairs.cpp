#include "measure/all_pairs.hpp"

#include <cmath>
#include <variant>

// gcc's own vector code for each instruction set, chosen when the program starts.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    defined(__GNUC__) && !defined(__clang__)
#define CAROM_FOR_EVERY_ISA __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define CAROM_FOR_EVERY_ISA
#endif

namespace carom::measure {
namespace {

constexpr std::size_t kBlock = 64;  // bodies
constexpr float kFarAway = 1e18f;   // m; its square is finite

/// Whether one of the block's bodies is nearer than the root of `reach_squared` to (x, y).
CAROM_FOR_EVERY_ISA
bool has_near(const float* block_x, const float* block_y, float x, float y, float reach_squared) {
    int near = 0;
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float dx = block_x[i] - x, dy = block_y[i] - y;
        near |= dx * dx + dy * dy < reach_squared ? 1 : 0;
    }
    return near != 0;
}

}  // namespace

AllPairs::AllPairs(const Scene& scene)
    : count_(scene.bodies.size()),
      radius_(static_cast<float>(std::get<Disc>(scene.bodies.at(0).shape).radius)),
      width_(static_cast<float>(scene.walls->max.x)),
      height_(static_cast<float>(scene.walls->max.y)) {
    const std::size_t padded = (count_ + kBlock - 1) / kBlock * kBlock;
    x_.assign(padded, kFarAway), y_.assign(padded, kFarAway);
    vx_.assign(count_, 0), vy_.assign(count_, 0);
    for (std::size_t i = 0; i < count_; ++i) {
        x_[i] = static_cast<float>(scene.bodies[i].position.x);
        y_[i] = static_cast<float>(scene.bodies[i].position.y);
        vx_[i] = static_cast<float>(scene.bodies[i].velocity.x);
        vy_[i] = static_cast<float>(scene.bodies[i].velocity.y);
    }
}

void AllPairs::resolve(std::size_t a, std::size_t b) {
    const float dx = x_[b] - x_[a], dy = y_[b] - y_[a];
    const float squared = dx * dx + dy * dy, reach = 2 * radius_;
    if (!(squared < reach * reach) || squared == 0) return;
    ++contacts_;
    const float distance = std::sqrt(squared), nx = dx / distance, ny = dy / distance;
    const float push = (reach - distance) / 2;
    x_[a] -= push * nx, y_[a] -= push * ny;
    x_[b] += push * nx, y_[b] += push * ny;
    const float approach = (vx_[b] - vx_[a]) * nx + (vy_[b] - vy_[a]) * ny;
    if (approach >= 0) return;
    vx_[a] += approach * nx, vy_[a] += approach * ny;  // equal masses swap what is along the normal
    vx_[b] -= approach * nx, vy_[b] -= approach * ny;
}

void AllPairs::bounce_off_walls() {
    const auto bounce = [this](float& position, float& velocity, float end) {
        if (position < radius_) {
            position = radius_;
            if (velocity < 0) velocity = -velocity;
        } else if (position > end - radius_) {
            position = end - radius_;
            if (velocity > 0) velocity = -velocity;
        }
    };
    for (std::size_t i = 0; i < count_; ++i) {
        bounce(x_[i], vx_[i], width_);
        bounce(y_[i], vy_[i], height_);
    }
}

void AllPairs::step(double dt) {
    const float reach_squared = 4 * radius_ * radius_;
    for (std::size_t a = 0; a < count_; ++a)
        for (std::size_t block = a / kBlock * kBlock; block < count_; block += kBlock) {
            if (block > a && !has_near(&x_[block], &y_[block], x_[a], y_[a], reach_squared)) continue;
            const std::size_t last = block + kBlock < count_ ? block + kBlock : count_;
            for (std::size_t b = block > a ? block : a + 1; b < last; ++b) resolve(a, b);
        }
    bounce_off_walls();
    const auto h = static_cast<float>(dt);
    for (std::size_t i = 0; i < count_; ++i) {
        x_[i] += vx_[i] * h;
        y_[i] += vy_[i] * h;
    }
}

double AllPairs::kinetic_energy() const {
    double energy = 0;
    for (std::size_t i = 0; i < count_; ++i)
        energy += 0.5 * (static_cast<double>(vx_[i]) * static_cast<double>(vx_[i]) +
                         static_cast<double>(vy_[i]) * static_cast<double>(vy_[i]));
    return energy;
}

std::size_t AllPairs::bytes() const {
    return sizeof(float) * (x_.size() + y_.size() + vx_.size() + vy_.size());
}

}  // namespace carom::measure
