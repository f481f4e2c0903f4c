#include <iterator>

#include "torture/envelopes/envelope.hpp"

namespace carom::torture {

Envelopes all_envelopes() {
    Envelopes all;
    for (const auto envelopes :
         {heights, mass_ratios, size_ratios, step_lengths, speeds, distances, densities}) {
        Envelopes some = envelopes();
        all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
    }
    return all;
}

}  // namespace carom::torture
