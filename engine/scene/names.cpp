#include "scene/validation/validation.hpp"

#include <array>
#include <bit>
#include <functional>
#include <utility>

namespace carom {
namespace {

constexpr std::array<std::pair<Solver, std::string_view>, 7> kSolverNames{{
    {Solver::automatic, "auto"},
    {Solver::pairwise, "pairwise"},
    {Solver::impulse, "impulse"},
    {Solver::soft, "soft"},
    {Solver::rigid, "rigid"},
    {Solver::event, "event"},
    {Solver::rattle, "rattle"},
}};

/// Bodies by name: open addressing over body indices, because a map of a million names would take longer than
/// all other checks together.
class NameTable {
  public:
    explicit NameTable(const std::vector<Body>& bodies)
        : bodies_(bodies), slots_(std::bit_ceil(2 * bodies.size() + 1), kFree) {}

    /// The body that has this body's name already, or this body itself, which then takes the name.
    std::size_t insert(std::size_t body) {
        const std::string& name = bodies_[body].name;
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t slot = std::hash<std::string_view>{}(name)&mask;; slot = (slot + 1) & mask) {
            if (slots_[slot] == kFree) slots_[slot] = static_cast<std::uint32_t>(body);
            if (slots_[slot] == body || bodies_[slots_[slot]].name == name) return slots_[slot];
        }
    }

  private:
    static constexpr std::uint32_t kFree = UINT32_MAX;
    const std::vector<Body>& bodies_;
    std::vector<std::uint32_t> slots_;
};

Problem duplicate(const std::vector<Body>& bodies, std::size_t first, std::size_t second) {
    const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(second), ""};
    return problem(ErrorCode::duplicate_name, item, "/name", "name ", quoted(bodies[second].name),
                   ", which body ", first,
                   " has already; expected unique names. Rename one of them, or leave its name out.");
}

}  // namespace

std::string_view name_of(const Shape& shape) {
    static constexpr std::array kNames{"disc",    "segment", "chain",   "box",
                                       "capsule", "polygon", "compound"};  // in the order of the variant
    static_assert(kNames.size() == std::variant_size_v<Shape>);
    return kNames[shape.index()];
}

std::string_view name_of(Solver solver) noexcept {
    for (const auto& [known, name] : kSolverNames)
        if (known == solver) return name;
    return "unknown";
}

std::optional<Solver> solver_named(std::string_view name) noexcept {
    for (const auto& [solver, known] : kSolverNames)
        if (known == name) return solver;
    return std::nullopt;
}

std::optional<Problem> find_duplicate_name(const std::vector<Body>& bodies) {
    std::optional<NameTable> table;  // made for the first name: most large scenes have none
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        if (bodies[body].name.empty()) continue;
        if (!table) table.emplace(bodies);
        const std::size_t holder = table->insert(body);
        if (holder != body) return duplicate(bodies, holder, body);
    }
    return std::nullopt;
}

}  // namespace carom
