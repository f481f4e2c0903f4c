#include "world/snapshot.hpp"

#include <carom/errors.hpp>
#include <carom/version.hpp>

#include <array>
#include <cstring>
#include <string>

#include "scene/validation/wording.hpp"
#include "state/columns/archive.hpp"

namespace carom {
namespace {

/// What a snapshot begins with. It names the build: columns and structures are bytes as they lie in memory.
struct Header {
    std::array<char, 8> magic{'c', 'a', 'r', 'o', 'm', 's', 't', 'a'};
    std::array<char, 16> version{};  // of the library
    std::uint64_t bytes = 0;         // with the header
    std::uint64_t checksum = 0;      // of this header, with a zero here, and of what follows it
    std::uint32_t real_bytes = 0;    // of a number in a column
    std::uint32_t solver = 0;
};

std::array<char, 16> version_text() {
    std::array<char, 16> text{};
    std::memcpy(text.data(), kVersion.data(), std::min(kVersion.size(), text.size()));
    return text;
}

/// Tells damaged bytes from whole ones: words multiplied and folded, so that each bit bears on all of them.
/// Each word maps sums one to one: damage within one word always shows, other damage but once in 2^64.
std::uint64_t checksum_of(std::span<const std::byte> bytes, std::uint64_t sum) {
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;  // 2^64 over the golden ratio (Knuth)
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t length = std::min(bytes.size(), sizeof(word));
        std::memcpy(&word, bytes.data(), length);
        sum = (sum ^ word) * kOdd;
        sum ^= sum >> 32;
        bytes = bytes.subspan(length);
    }
    return sum;
}

/// @param state  all of it; what stands where the header will be does not matter
std::uint64_t checksum_of(Header header, std::span<const std::byte> state) {
    header.checksum = 0;
    return checksum_of(state.subspan(sizeof(header)),
                       checksum_of(std::as_bytes(std::span(&header, 1)), state.size()));
}

/// `Settings` is const where they are counted or written.
template <class Settings, class Archive>
void visit_settings(Settings& settings, Archive& archive) {
    auto count = static_cast<std::uint64_t>(settings.called.reports.size());
    archive(count);
    if constexpr (!std::is_const_v<Settings>) settings.called.reports.resize(static_cast<std::size_t>(count));
    for (auto& report : settings.called.reports) archive(report.name, report.on, report.reason);
    archive(settings.called.effects, settings.called.solver_reason, settings.overrides,
            settings.angular_drag);
    archive(settings.asked_for, settings.facts, settings.substeps, settings.iterations);
}

template <class Sim, class Settings, class Archive>
void visit_all(Sim& sim, Settings& settings, Archive& archive) {
    archive(sim.substeps_asked_for, sim.has_asked_for_substeps);
    visit_settings(settings, archive);
    sim.visit_state(archive);
}

}  // namespace

template <class Real>
std::size_t snapshot_bytes(const Simulation<Real>& sim, const WorldSettings& settings) {
    StateSize size;
    visit_all(sim, settings, size);
    return sizeof(Header) + size.bytes();
}

template <class Real>
void save_snapshot(const Simulation<Real>& sim, const WorldSettings& settings, std::span<std::byte> out) {
    const std::size_t bytes = snapshot_bytes(sim, settings);
    if (out.size() < bytes)
        throw Error(ErrorCode::out_of_range,
                    join("World::save_state: there is room for ", out.size(), " bytes; the state has ", bytes,
                         ". Ask state_bytes() before each save: it changes as the world runs."));
    StateWriter writer(out.data() + sizeof(Header));
    visit_all(sim, settings, writer);
    Header header;
    header.version = version_text(), header.bytes = bytes;
    header.real_bytes = sizeof(Real), header.solver = static_cast<std::uint32_t>(sim.solver());
    header.checksum = checksum_of(header, out.first(bytes));
    std::memcpy(out.data(), &header, sizeof(header));
}

template <class Real>
Solver solver_of_snapshot(std::span<const std::byte> state) {
    constexpr std::string_view kWhere = "World::restore_state: ";
    Header header;
    const Header expected;
    if (state.size() < sizeof(header))
        throw Error(ErrorCode::malformed,
                    join(kWhere, "a state of ", state.size(), " bytes; expected at least ", sizeof(header),
                         ". Pass all that save_state wrote."));
    std::memcpy(&header, state.data(), sizeof(header));
    if (header.magic != expected.magic)
        throw Error(ErrorCode::malformed,
                    join(kWhere, "the bytes do not begin like a state. Pass what save_state wrote."));
    if (header.version != version_text())
        throw Error(ErrorCode::inconsistent,
                    join(kWhere, "the state was saved by version ",
                         std::string_view(header.version.data(), strnlen(header.version.data(), 16)),
                         "; this is ", kVersion, ". States are read by the version that saved them."));
    if (header.real_bytes != sizeof(Real))
        throw Error(ErrorCode::inconsistent,
                    join(kWhere, "the state has numbers of ", header.real_bytes, " bytes, this world of ",
                         sizeof(Real), ". Restore it into ", sizeof(Real) == 4 ? "World64." : "World."));
    if (header.bytes > state.size())
        throw Error(ErrorCode::malformed, join(kWhere, "the state has ", header.bytes, " bytes, of which ",
                                               state.size(), " are there. Pass all that save_state wrote."));
    if (header.bytes < sizeof(header) ||
        checksum_of(header, state.first(static_cast<std::size_t>(header.bytes))) != header.checksum)
        throw Error(ErrorCode::malformed,
                    join(kWhere, "the state is damaged: its bytes are not those that save_state wrote."));
    return static_cast<Solver>(header.solver);
}

template <class Real>
void restore_snapshot(Simulation<Real>& sim, WorldSettings& settings, std::span<const std::byte> state) {
    StateReader reader(state.data() + sizeof(Header));
    visit_all(sim, settings, reader);
    sim.set_iterations(settings.iterations);
}

template std::size_t snapshot_bytes(const Simulation<float>&, const WorldSettings&);
template std::size_t snapshot_bytes(const Simulation<double>&, const WorldSettings&);
template void save_snapshot(const Simulation<float>&, const WorldSettings&, std::span<std::byte>);
template void save_snapshot(const Simulation<double>&, const WorldSettings&, std::span<std::byte>);
template Solver solver_of_snapshot<float>(std::span<const std::byte>);
template Solver solver_of_snapshot<double>(std::span<const std::byte>);
template void restore_snapshot(Simulation<float>&, WorldSettings&, std::span<const std::byte>);
template void restore_snapshot(Simulation<double>&, WorldSettings&, std::span<const std::byte>);

}  // namespace carom
