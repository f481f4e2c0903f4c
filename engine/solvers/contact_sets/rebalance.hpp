#pragma once

#include <carom/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

#include "constraints/contact_graph.hpp"
#include "constraints/contact_rows.hpp"
#include "state/bodies.hpp"

namespace carom {

/// Brings contacts back into balance where a body was removed that pressed on others, or held them up.
///
/// Contacts begin a step with the impulses of the step before. Beside a body that is gone these are far from
/// what they should be, and sweeps take long to find out: each contact of a chain is in balance with the
/// next, only the body at its end feels what is wrong, and is thrown. Two things are done about it before the
/// step. The weight of the body itself is gone: it is taken from the contacts that carried it, body by body,
/// down to the walls. The load it carried for others has to find another way: the impulse that a body gets
/// too much is shared out among its contacts, as if they were springs and its neighbours stood still; then
/// these have it, and so on, until no body has much more than one that falls. Impulses act on both bodies of
/// a contact, so momentum is kept; they push, and friction and rolling resistance stay within their limits.
/// Numbers: docs/decisions/0013-removed-loads.md. Source: relaxation where the residual is largest (Southwell
/// 1940), here in the order in which it appears.
template <class Real>
class Rebalance {
  public:
    /// @param lost  contacts that are gone with their bodies, sorted by those
    /// @param friction, rolling  coefficients where contacts have none of their own
    /// @param gain  m/s, what gravity adds in a substep
    /// Cost: O(bodies + contacts), some ns each, and what is passed on, 0.1 us a body.
    /// @return whether loads of heavy bodies were spread, so that little around them is calm
    bool balance(std::span<const LostContact> lost, ContactRows<Real>& pairs, ContactRows<Real>& supports,
                 const Bodies<Real>& bodies, double friction, double rolling, Vec2 gain);

    std::size_t bytes() const;

  private:
    /// A contact that pushes.
    struct Loaded {
        std::int32_t a, b;         // rows; b < 0: nothing moves it
        std::uint32_t contact;     // its number: supports come after the pairs
        Vec2 normal;               // from a to b
        double friction, rolling;  // coefficients
        double normal_impulse;     // N s
        double friction_impulse;   // N s, along the normal turned by a quarter counter-clockwise, on b
        double rolling_impulse;    // N s
    };
    struct Load {
        Vec2 excess;                       // N s, what contacts add up to beyond what they did before
        Vec2 weight;                       // N s, of gravity in a substep
        Vec2 flow;                         // N s, to be taken from contacts and passed on
        double allowed = 0;                // N s, of what rests, falls, slides or rolls
        std::uint32_t begin = 0, end = 0;  // in of_body_
        bool is_queued = false, is_known = false;
    };
    static constexpr std::uint32_t kNotLoaded = UINT32_MAX;

    void mark_near(std::span<const LostContact> lost);
    void list_contacts(std::size_t rows);
    std::uint32_t load_contact(std::uint32_t number);
    Load& load_of(std::int32_t row);
    Vec2 impulses_on(std::int32_t row);
    Vec2 excess_of(const Load& load) const;
    void queue_if_uneven(std::int32_t row);
    void begin_flows(std::span<const LostContact> lost);
    void flow_to(std::int32_t row, Vec2 impulse);
    void pass_load_on(std::int32_t row);
    void relax_body(std::int32_t row);
    void drain_queue(void (Rebalance::*deal_with)(std::int32_t));

    // What holds for the present call.
    const ContactRows<Real>*pairs_ = nullptr, *supports_ = nullptr;
    const Bodies<Real>* bodies_ = nullptr;
    double friction_ = 0, rolling_ = 0;
    Vec2 gain_;                   // m/s
    std::size_t most_looks_ = 0;  // at bodies

    std::vector<Loaded> loaded_;           // contacts in question
    std::vector<std::uint8_t> is_near_;    // a row, whether it may be looked at
    std::vector<std::uint32_t> place_of_;  // of a contact in loaded_, by number
    std::vector<Load> loads_;              // by row; those in question are known
    std::vector<std::uint32_t> first_of_;  // of a row in of_body_
    std::vector<std::uint32_t> of_body_;   // numbers of contacts; of known rows their places in loaded_
    std::vector<std::int32_t> queue_, touched_, known_;
};

extern template class Rebalance<float>;
extern template class Rebalance<double>;

}  // namespace carom
