#pragma once

namespace carom {

/// Separation that the sweeps see in place of that of an impact [m]: too far for them to do anything.
template <class Real>
inline constexpr Real kHiddenSeparation = Real(1e20);

/// Whether a contact of a separation is an impact, which the sweeps do not see.
template <class Real>
bool is_hidden(Real separation) {
    return separation == kHiddenSeparation<Real>;
}

}  // namespace carom
