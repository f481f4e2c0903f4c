#include "isa/select_isa.hpp"

#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <cstdlib>

namespace carom {

extern const KernelTables kScalarKernels;
#if defined(CAROM_BUILT_SSE2)
extern const KernelTables kSse2Kernels;
#endif
#if defined(CAROM_BUILT_AVX2)
extern const KernelTables kAvx2Kernels;
#endif
#if defined(CAROM_BUILT_AVX512)
extern const KernelTables kAvx512Kernels;
#endif

namespace {

std::string runnable_names() {
    std::string names;
    for (const std::string& name : runnable_instruction_sets()) names += (names.empty() ? "" : ", ") + name;
    return names;
}

}  // namespace

std::vector<std::string> built_instruction_sets() {
    std::vector<std::string> names{"scalar"};
#if defined(CAROM_BUILT_SSE2)
    names.emplace_back("sse2");
#endif
#if defined(CAROM_BUILT_AVX2)
    names.emplace_back("avx2");
#endif
#if defined(CAROM_BUILT_AVX512)
    names.emplace_back("avx512");
#endif
    return names;
}

std::vector<const KernelTables*> runnable_kernel_tables() {
    std::vector<const KernelTables*> tables{&kScalarKernels};
#if defined(CAROM_BUILT_SSE2)
    tables.push_back(&kSse2Kernels);  // every x86-64 processor
#endif
#if defined(CAROM_BUILT_AVX2) || defined(CAROM_BUILT_AVX512)
    const bool has_bmi = __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
#endif
#if defined(CAROM_BUILT_AVX2)
    if (has_bmi && __builtin_cpu_supports("avx2")) tables.push_back(&kAvx2Kernels);
#endif
#if defined(CAROM_BUILT_AVX512)
    if (has_bmi && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd") &&
        __builtin_cpu_supports("avx512vl"))
        tables.push_back(&kAvx512Kernels);
#endif
    return tables;
}

std::vector<std::string> runnable_instruction_sets() {
    std::vector<std::string> names;
    for (const KernelTables* tables : runnable_kernel_tables())
        names.emplace_back(tables->single_precision.isa);
    return names;
}

const KernelTables& select_kernels(std::string_view isa) {
    std::string_view wish = isa;
    const char* variable = std::getenv("CAROM_ISA");
    const bool from_environment = wish == "auto" && variable && *variable;
    if (from_environment) wish = variable;

    const std::vector<const KernelTables*> runnable = runnable_kernel_tables();
    if (wish == "auto") return *runnable.back();
    for (const KernelTables* tables : runnable)
        if (tables->single_precision.isa == wish) return *tables;
    throw Error(ErrorCode::unsupported_isa,
                std::string(from_environment ? "CAROM_ISA" : "World: option isa") + " is \"" +
                    std::string(wish) + "\"; this build on this machine runs " + runnable_names() +
                    ". Use one of these, or \"auto\" for the best.");
}

}  // namespace carom
