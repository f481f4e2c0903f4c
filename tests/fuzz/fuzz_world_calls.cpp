// Whatever calls bytes make on a world: each does what it says or throws `Error` and leaves the world as it
// was. No call crashes, hangs, or leaves a number that is not finite.

#include "world_script.hpp"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace carom::fuzz;
    ByteSource bytes({data, size});
    if (bytes.flag())
        WorldScript<double>(bytes).run();
    else
        WorldScript<float>(bytes).run();
    return 0;
}
