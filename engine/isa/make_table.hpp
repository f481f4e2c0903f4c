#pragma once

#include "isa/kernel_table.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// The one list of kernels, instantiated for each instruction set by its file.
template <class Real, class Isa>
constexpr KernelTable<Real> make_table(std::string_view isa) {
    return {
        .isa = isa,
    };
}

template <class Isa>
constexpr KernelTables make_tables(std::string_view isa) {
    return {make_table<float, Isa>(isa), make_table<double, Isa>(isa)};
}

}  // namespace
}  // namespace carom
