#pragma once

#include "solvers/soft/corrections/contact_chains.hpp"
#include "solvers/soft/corrections/deep_contacts.hpp"
#include "solvers/soft/corrections/load_correction.hpp"
#include "solvers/soft/corrections/shape_turns.hpp"
#include "solvers/soft/corrections/struck_contacts.hpp"
#include "solvers/soft/corrections/uneven_contacts.hpp"
#include "solvers/soft/corrections/wedged_bodies.hpp"

namespace carom {

/// What solves the contacts that two sweeps a substep leave unsolved, each by its own method and only where
/// there are such contacts. docs/decisions/0078-three-mechanisms.md has what each is needed for.
template <class Real>
struct ContactCorrections {
    LoadCorrection<Real> loads;    ///< long waves of large piles
    ContactChains<Real> chains;    ///< columns of discs
    WedgedBodies<Real> wedged;     ///< bodies between supports that face each other
    UnevenContacts<Real> uneven;   ///< masses that differ much
    ShapeTurns<Real> shape_turns;  ///< likewise, of shapes
    DeepContacts<Real> deep;       ///< hits
    StruckContacts<Real> struck;   ///< what impacts leave

    std::size_t bytes() const {
        return loads.bytes() + chains.bytes() + wedged.bytes() + uneven.bytes() + shape_turns.bytes() +
               deep.bytes() + struck.bytes();
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.loads, self.uneven, self.shape_turns, self.chains, self.deep);
    }
};

}  // namespace carom
