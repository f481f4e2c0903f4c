#include <carom/version.hpp>

namespace carom {

std::string_view version() noexcept {
    return kVersion;
}

}  // namespace carom
