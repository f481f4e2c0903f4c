#include "solvers/contact_sets/tridiagonal_contacts.hpp"

namespace carom {

/// Whether a contact comes below its floor by what the runs beside it do; null: there is none.
bool TridiagonalContacts::closes(std::size_t number, const Run* before, const Run* behind) const {
    const TridiagonalContact& contact = contacts[number];
    double velocity = contact.velocity;
    if (before) velocity += contacts[number - 1].coupling * before->of_last;
    if (behind) velocity += contact.coupling * behind->of_first;
    return velocity < contact.floor;
}

/// The run of a contact that comes to push and of the runs beside it.
TridiagonalContacts::Run TridiagonalContacts::join(const Run* before, std::size_t number,
                                                   const Run* behind) const {
    const TridiagonalContact& contact = contacts[number];
    Run run{number, number, 0, 0, 0, 0, 0};
    double pivot = contact.diagonal, wanted = contact.floor - contact.velocity, on_first = 1, on_last = 1;
    if (before) {
        const double coupling = contacts[number - 1].coupling;
        pivot -= coupling * coupling * before->last_by_last, wanted -= coupling * before->of_last;
        on_first = -before->first_by_last * coupling;
        run.first = before->first, run.of_first = before->of_first;
        run.first_by_first = before->first_by_first;
    }
    if (behind) {
        const double coupling = contact.coupling;
        pivot -= coupling * coupling * behind->first_by_first, wanted -= coupling * behind->of_first;
        on_last = -behind->first_by_last * coupling;
        run.last = behind->last, run.of_last = behind->of_last, run.last_by_last = behind->last_by_last;
    }
    const double impulse = wanted / pivot;
    run.of_first += on_first * impulse, run.of_last += on_last * impulse;
    run.first_by_first += on_first * on_first / pivot, run.last_by_last += on_last * on_last / pivot;
    run.first_by_last = on_first * on_last / pivot;
    return run;
}

void TridiagonalContacts::find_runs() {
    runs_.clear();
    for (std::size_t n = 0; n < contacts.size(); ++n) {
        const Run* before = run_before(n);
        if (!closes(n, before, nullptr)) continue;
        Run run = join(before, n, nullptr);
        if (before) runs_.pop_back();
        while (run.first > 0) {
            before = run_before(run.first - 1);
            if (!closes(run.first - 1, before, &run)) break;
            run = join(before, run.first - 1, &run);
            if (before) runs_.pop_back();
        }
        runs_.push_back(run);
    }
}

/// The impulses that bring the contacts of a run to their floors, by elimination.
void TridiagonalContacts::eliminate(const Run& run) {
    double coupling = 0, upper = 0, impulse = 0;  // of the contact before
    for (std::size_t n = run.first; n <= run.last; ++n) {
        TridiagonalContact& contact = contacts[n];
        const double pivot = contact.diagonal - coupling * upper;
        impulse = (contact.floor - contact.velocity - coupling * impulse) / pivot;
        coupling = contact.coupling, upper = coupling / pivot;
        contact.impulse = impulse, upper_[n] = upper;
    }
    for (std::size_t n = run.last; n-- > run.first;)
        contacts[n].impulse -= upper_[n] * contacts[n + 1].impulse;
}

void TridiagonalContacts::solve() {
    upper_.resize(contacts.size());
    for (TridiagonalContact& contact : contacts) contact.impulse = 0;
    find_runs();
    for (const Run& run : runs_) eliminate(run);
}

}  // namespace carom
