#include "constraints/impulse_memory.hpp"

#include <algorithm>

namespace carom {
namespace {

constexpr double kNanosecondsToFile = 8;  // a contact

}  // namespace

template <class Real>
template <class Each>
void ImpulseMemory<Real>::file_rows(File& file, std::size_t first, std::size_t last, std::uint32_t place,
                                    const Each& each) {
    Range* of_row = file.of_row.data();
    std::fill(of_row + first, of_row + last, Range{0, 0});
    each([&](const ContactRows<Real>& contacts, std::size_t i) {
        if (contacts.normal_impulse[i] > 0) ++of_row[static_cast<std::size_t>(contacts.a[i])].end;
    });
    for (std::size_t row = first; row < last; ++row) {
        const std::uint32_t count = of_row[row].end;
        of_row[row] = {place, place};
        place += count;
    }
    each([&](const ContactRows<Real>& contacts, std::size_t i) {
        if (!(contacts.normal_impulse[i] > 0)) return;
        Range& range = of_row[static_cast<std::size_t>(contacts.a[i])];
        const Real friction = contacts.friction_impulse.empty() ? Real(0) : contacts.friction_impulse[i];
        file.filed[range.end++] = {contacts.b[i], {contacts.normal_impulse[i], friction}};
    });
}

template <class Real>
void ImpulseMemory<Real>::file(const ContactRows<Real>& pairs, const ContactRows<Real>& supports,
                               std::size_t rows, const TaskGroups* groups, const Executor& executor) {
    grouped_.is_empty = groups == nullptr;
    if (groups) {
        grouped_.of_row.resize_for_overwrite(rows);
        grouped_.filed.resize_for_overwrite(pairs.a.size());
        const auto work = kNanosecondsToFile * static_cast<double>(pairs.a.size());
        executor.for_each_task(groups->chunks, work, [&](std::size_t chunk) {
            const std::size_t first = TaskGroups::inside(chunk), last = first + 1 + groups->has_border(chunk);
            const std::size_t colour = pairs.first_colour[first];
            const auto place = static_cast<std::uint32_t>(colour < pairs.colours() ? pairs.begin[colour] : 0);
            const std::size_t row = chunk * groups->rows_per_chunk;
            file_rows(
                grouped_, row, std::min(rows, row + groups->rows_per_chunk), place,
                [&](const auto& fn) { pairs.for_each(first, last, [&](std::size_t i) { fn(pairs, i); }); });
        });
        for (std::size_t row = groups->chunks * groups->rows_per_chunk; row < rows; ++row)
            grouped_.of_row[row] = {0, 0};  // appended since
    }
    const std::size_t first_other = groups ? groups->far() : 0;
    std::size_t others = 0, other_pairs = 0;
    const auto each_other = [&](const auto& fn) {
        if (pairs.groups() > 0)
            pairs.for_each(first_other, pairs.groups(), [&](std::size_t i) { fn(pairs, i); });
        supports.for_each([&](std::size_t i) { fn(supports, i); });
    };
    each_other([&](const auto& contacts, std::size_t) { ++others, other_pairs += &contacts == &pairs; });
    others_have_pairs_ = other_pairs > 0;
    others_.is_empty = others == 0;
    if (others == 0) return;
    others_.of_row.resize_for_overwrite(rows);
    others_.filed.resize_for_overwrite(others);
    file_rows(others_, 0, rows, 0, each_other);
}

template class ImpulseMemory<float>;
template class ImpulseMemory<double>;

}  // namespace carom
