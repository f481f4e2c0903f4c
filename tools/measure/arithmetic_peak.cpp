#include "measure/arithmetic_peak.hpp"

#include <algorithm>
#include <cstddef>

#include "measure/clocks.hpp"

namespace carom::measure {
namespace {

constexpr int kPeakTries = 5;
constexpr int kChains = 14;  // with two constants they fill the sixteen registers
constexpr int kRepeats = 20'000;

#if defined(__x86_64__)
#define CAROM_VECTOR_REGISTER "+x"
#else
#define CAROM_VECTOR_REGISTER "+w"
#endif

/// clang checks an operand's size where this template stands, not where it is inlined, so it takes 16 bytes
/// at most; wider chains it cannot fuse into yet wider ones, and needs no barrier.
#if defined(__clang__)
template <class Vector>
constexpr bool kTakesBarrier = sizeof(Vector) <= 16;
#else
template <class Vector>
constexpr bool kTakesBarrier = true;
#endif

/// Seven chains of sums and seven of products. They are variables of their own, not arrays: they must stay in
/// registers. The barrier keeps the compiler from foreseeing them.
template <class Vector>
[[gnu::always_inline]] inline void run_chains(Vector& start, const Vector& step, const Vector& factor) {
    Vector a = start, b = start, c = start, d = start, e = start, f = start, g = start;
    Vector p = start, q = start, r = start, s = start, t = start, u = start, v = start;
    const Vector added = step, times = factor;
    for (int i = 0; i < kRepeats; ++i) {
        a += added, b += added, c += added, d += added, e += added, f += added, g += added;
        p *= times, q *= times, r *= times, s *= times, t *= times, u *= times, v *= times;
        if constexpr (kTakesBarrier<Vector>)
            asm volatile(""
                         : CAROM_VECTOR_REGISTER(a), CAROM_VECTOR_REGISTER(b), CAROM_VECTOR_REGISTER(c),
                           CAROM_VECTOR_REGISTER(d), CAROM_VECTOR_REGISTER(e), CAROM_VECTOR_REGISTER(f),
                           CAROM_VECTOR_REGISTER(g), CAROM_VECTOR_REGISTER(p), CAROM_VECTOR_REGISTER(q),
                           CAROM_VECTOR_REGISTER(r), CAROM_VECTOR_REGISTER(s), CAROM_VECTOR_REGISTER(t),
                           CAROM_VECTOR_REGISTER(u), CAROM_VECTOR_REGISTER(v));
    }
    start += a + b + c + d + e + f + g + p + q + r + s + t + u + v;
}

template <class Real, std::size_t kBytes>
struct VectorOf {
    typedef Real Type __attribute__((vector_size(kBytes)));
};

template <class Vector>
[[gnu::always_inline]] inline void chains() {
    Vector start{}, step{}, factor{};
    asm volatile("" : "+m"(start), "+m"(step), "+m"(factor));
    run_chains(start, step, factor);
    asm volatile("" : "+m"(start));
}

template <class Real>
[[gnu::noinline]] void chains_scalar() {
    chains<Real>();
}
#if defined(__x86_64__)
template <class Real>
[[gnu::noinline]] void chains_sse2() {
    chains<typename VectorOf<Real, 16>::Type>();
}
template <class Real>
[[gnu::noinline, gnu::target("avx2")]] void chains_avx2() {
    chains<typename VectorOf<Real, 32>::Type>();
}
template <class Real>
[[gnu::noinline, gnu::target("avx512f")]] void chains_avx512() {
    chains<typename VectorOf<Real, 64>::Type>();
}
#endif

template <class Real>
double rate(const std::string& isa, double seconds) {
    void (*run)() = &chains_scalar<Real>;
    std::size_t lanes = 1;
#if defined(__x86_64__)
    if (isa == "sse2") run = &chains_sse2<Real>, lanes = 16 / sizeof(Real);
    if (isa == "avx2") run = &chains_avx2<Real>, lanes = 32 / sizeof(Real);
    if (isa == "avx512") run = &chains_avx512<Real>, lanes = 64 / sizeof(Real);
#endif
    const double operations = static_cast<double>(lanes) * kChains * kRepeats;
    double best = 0;
    for (int attempt = 0; attempt < kPeakTries; ++attempt) {
        const double start = thread_seconds();
        double spent = 0, done = 0;
        do {
            run();
            done += operations;
            spent = thread_seconds() - start;
        } while (spent < seconds / kPeakTries);
        best = std::max(best, done / spent);
    }
    return best;
}

}  // namespace

double best_arithmetic_rate(const std::string& isa, bool is_double, double seconds) {
    return is_double ? rate<double>(isa, seconds) : rate<float>(isa, seconds);
}

}  // namespace carom::measure
