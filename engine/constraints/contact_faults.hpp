#pragma once

#include "constraints/contact_rows.hpp"
#include "constraints/task_groups.hpp"
#include "state/bodies.hpp"

namespace carom {

/// What the kernels take for granted of contacts by group and colour, checked one by one for assertions:
///
///  - columns that last have one length, colours follow each other at multiples of kRowPadding, groups in
///    the order of their colours;
///  - a colour names no body twice that the contact may move, unless it is the overflow;
///  - contacts of pairs name two bodies a < b and are in the group of these rows, or in the last group;
///    supports name a body and, in columns of the graph, a wall, an edge or a body;
///  - padding names rows beyond the bodies and has no impulses.
///
/// Cost: about 10 ns a contact.
/// @param groups  those the contacts were sorted into
/// @param both_move  contacts of pairs, not supports
/// @return what is wrong, null if nothing is
template <class Real>
const char* fault_of(const ContactRows<Real>& contacts, const TaskGroups& groups, const Bodies<Real>& bodies,
                     bool both_move);

extern template const char* fault_of(const ContactRows<float>&, const TaskGroups&, const Bodies<float>&,
                                     bool);
extern template const char* fault_of(const ContactRows<double>&, const TaskGroups&, const Bodies<double>&,
                                     bool);

}  // namespace carom
