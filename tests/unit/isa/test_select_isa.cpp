#include "isa/select_isa.hpp"

#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <doctest/doctest.h>
#include <cstdlib>
#include <string>

namespace test_select_isa {

namespace {

/// CAROM_ISA for the length of a test.
class Environment {
  public:
    explicit Environment(const char* value) {
        if (const char* before = std::getenv("CAROM_ISA")) before_ = before;
        setenv("CAROM_ISA", value, 1);
    }
    ~Environment() {
        if (before_.empty())
            unsetenv("CAROM_ISA");
        else
            setenv("CAROM_ISA", before_.c_str(), 1);
    }
    Environment(const Environment&) = delete;

  private:
    std::string before_;
};

}  // namespace

TEST_SUITE("isa/select_isa") {
    TEST_CASE("every runnable instruction set is selected by its name, in both precisions") {
        CHECK(carom::runnable_instruction_sets().front() == "scalar");
        for (const std::string& name : carom::runnable_instruction_sets()) {
            CHECK(carom::select_kernels(name).of<float>().isa == name);
            CHECK(carom::select_kernels(name).of<double>().isa == name);
        }
    }

    TEST_CASE("auto takes what CAROM_ISA says, and the last of the runnable ones without it") {
        for (const std::string& name : carom::runnable_instruction_sets()) {
            const Environment environment(name.c_str());
            CHECK(carom::select_kernels("auto").of<float>().isa == name);
            CHECK(carom::select_kernels("scalar").of<float>().isa == "scalar");
        }
        const Environment environment("");
        CHECK(carom::select_kernels("auto").of<float>().isa == carom::runnable_instruction_sets().back());
    }

    TEST_CASE("an instruction set that is missing is an error that lists those there are") {
        const auto message_for = [](const char* wish) -> std::string {
            try {
                carom::select_kernels(wish);
            } catch (const carom::Error& error) {
                CHECK(error.code() == carom::ErrorCode::unsupported_isa);
                return error.what();
            }
            return "no error";
        };
        CHECK(message_for("avx9").find("\"avx9\"; this build on this machine runs scalar") !=
              std::string::npos);
        const Environment environment("mmx");
        CHECK(message_for("auto").find("CAROM_ISA is \"mmx\"") != std::string::npos);
    }
}

}  // namespace test_select_isa
