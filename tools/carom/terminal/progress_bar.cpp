#include "progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "format.hpp"

namespace carom::tool {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{
    100};                      // quick enough to look alive, too rare to cost time
constexpr int kBarWidth = 14;  // characters: a run of 1e9 steps still fits 80 columns

std::string clock_text(double seconds) {
    if (!(seconds < 360000)) return "over 99 h";
    const auto whole = static_cast<long>(seconds + 0.5);
    return whole >= 3600 ? format("%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60)
                         : format("%ld:%02ld", whole / 60, whole % 60);
}

}  // namespace

std::string progress_line(std::int64_t done, std::int64_t step_count, double seconds, const char* unit) {
    const double part = step_count > 0 ? static_cast<double>(done) / static_cast<double>(step_count) : 1.0;
    const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0.0;
    const double left = rate > 0 ? static_cast<double>(step_count - done) / rate : 0.0;
    const auto filled = static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * kBarWidth);

    return joined("[", std::string(filled, '#'), std::string(kBarWidth - filled, '.'), "] ",
                  format("%3d %%  %s %lld of %lld  %.*f %ss/s  %s left", static_cast<int>(part * 100), unit,
                         static_cast<long long>(done), static_cast<long long>(step_count), rate < 10 ? 1 : 0,
                         rate, unit, clock_text(left).c_str()));
}

ProgressBar::ProgressBar(std::int64_t step_count, bool wanted, const char* unit)
    : step_count_(step_count), shown_(wanted && isatty(STDERR_FILENO) == 1), unit_(unit) {}

void ProgressBar::update(std::int64_t done) {
    if (!shown_) return;
    const Clock::time_point now = Clock::now();
    if (drawn_ && now - last_drawn_ < kRedrawInterval) return;
    last_drawn_ = now;
    drawn_ = true;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    std::fprintf(stderr, "\r%s\x1b[K", progress_line(done, step_count_, seconds, unit_).c_str());
    std::fflush(stderr);
}

void ProgressBar::clear() {
    if (!drawn_) return;
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace carom::tool
