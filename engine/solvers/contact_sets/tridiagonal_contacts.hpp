#pragma once

#include <cstddef>
#include <vector>

namespace carom {

/// A contact in a row of contacts, each of which shares a body with the next.
struct TridiagonalContact {
    double velocity;  ///< m/s, relative along the normal, without the impulses of the row
    double floor;     ///< m/s, the least that it may be
    double diagonal;  ///< 1/kg, what its impulse changes its own velocity by
    double coupling;  ///< 1/kg, and that of the next contact, and the other way round; <= 0
    double impulse;   ///< out: N s, >= 0
};

/// Normal impulses of contacts in a row, exactly: each pushes or is above its floor, 0 <= impulse ⟂ velocity
/// + what impulses change >= floor.
///
/// As couplings are not positive, what pushes closes the contacts beside it. So those that push are found
/// from one end to the other: a contact that would close pushes, and joins the runs of pushing ones beside
/// it; then the one before its run may close; none is ever let go again. Of a run only its ends are kept, so
/// each join costs the same. Source: complementarity problems of M-matrices (Chandrasekaran 1970); for bodies
/// on a line it is pooling of adjacent violators (Ayer et al. 1955).
class TridiagonalContacts {
  public:
    /// Contacts in their order, to be filled before `solve`.
    std::vector<TridiagonalContact> contacts;

    /// Finds the impulses. Cost: O(contacts), 20 ns each.
    void solve();

    std::size_t bytes() const {
        return contacts.capacity() * sizeof(TridiagonalContact) + runs_.capacity() * sizeof(Run) +
               upper_.capacity() * sizeof(double);
    }

  private:
    /// Contacts first ... last that all push: impulses of the first and the last one [N s], and by how much
    /// a speed that is wanted of the one changes the impulse of the other [kg].
    struct Run {
        std::size_t first, last;
        double of_first, of_last;
        double first_by_first, first_by_last, last_by_last;
    };

    const Run* run_before(std::size_t number) const {
        return !runs_.empty() && runs_.back().last + 1 == number ? &runs_.back() : nullptr;
    }
    bool closes(std::size_t number, const Run* before, const Run* behind) const;
    Run join(const Run* before, std::size_t number, const Run* behind) const;
    void find_runs();
    void eliminate(const Run& run);

    std::vector<Run> runs_;      // of contacts that push, in their order
    std::vector<double> upper_;  // of the eliminated system
};

}  // namespace carom
