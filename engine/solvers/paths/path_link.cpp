#include "solvers/paths/path_link.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

/// Two points whose rows are alike by more than this are solved as one: det K / (k11 k22).
constexpr double kLeastDeterminant = 1e-3;

}  // namespace

template <class Real>
void write_link(const LinkPlace<Real>& to, ManifoldList<Real>& list, std::size_t i, bool found,
                const Bodies<Real>& bodies, const BodyRecords<Real>& records) {
    PathLink<Real>& link = to.link;
    const std::size_t lane = to.lane;
    const auto none = static_cast<Real>(kNoPoint);
    const auto row_a = static_cast<std::size_t>(list.a[i]);
    const Real rim_a = 1 / bodies.rim(row_a);
    const bool is_body = list.b[i] >= 0;
    // What is no body has the rim of the body that touches it.
    const Real rim_b = is_body ? 1 / bodies.rim(static_cast<std::size_t>(list.b[i])) : rim_a;
    Real a1 = list.lever_a1[i] * rim_a, a2 = list.lever_a2[i] * rim_a, at = list.lever_a_t[i] * rim_a;
    Real b1 = list.lever_b1[i] * rim_b, b2 = list.lever_b2[i] * rim_b, bt = list.lever_b_t[i] * rim_b;
    ManifoldMemory<Real>& memory = list.memory[i];
    Real s1 = found ? list.separation1[i] : memory.separation1,
         s2 = found ? list.separation2[i] : memory.separation2;
    if (!(memory.normal_x * list.normal_x[i] + memory.normal_y * list.normal_y[i] >
          static_cast<Real>(kSameNormal)))
        memory.forget_impulses();
    memory.normal_x = list.normal_x[i], memory.normal_y = list.normal_y[i];
    // Two points that no impulse can tell apart are one: the deeper.
    const auto mass = [&](std::size_t row, Real& w, Real& w2) {
        const Real signed_mass = records.velocity[4 * row + 3];
        w = std::fabs(signed_mass), w2 = 2 * std::max(signed_mass, Real(0));
    };
    Real wa, wa2, wb = 0, wb2 = 0;
    mass(row_a, wa, wa2);
    if (to.far_row == list.b[i]) mass(static_cast<std::size_t>(list.b[i]), wb, wb2);
    if (s2 < none) {
        const Real w = wa + wb, k11 = w + wa2 * a1 * a1 + wb2 * b1 * b1,
                   k22 = w + wa2 * a2 * a2 + wb2 * b2 * b2, k12 = w + wa2 * a1 * a2 + wb2 * b1 * b2;
        if (k11 * k22 - k12 * k12 < static_cast<Real>(kLeastDeterminant) * (k11 * k22)) {
            if (s2 < s1) {
                s1 = s2, a1 = a2, b1 = b2;
                list.lever_a1[i] = list.lever_a2[i], list.lever_b1[i] = list.lever_b2[i];
            }
            s2 = none;
        }
    }
    if (!(s2 < none)) {
        a2 = a1, b2 = b1;
        memory.normal1 += memory.normal2, memory.normal2 = 0;
    }
    const bool back = to.is_reversed;
    to.write_body(list, i);
    link.normal_x[lane] = back ? -list.normal_x[i] : list.normal_x[i];
    link.normal_y[lane] = back ? -list.normal_y[i] : list.normal_y[i];
    link.near1[lane] = back ? -b1 : a1, link.near2[lane] = back ? -b2 : a2,
    link.near_t[lane] = back ? -bt : at;
    link.far1[lane] = back ? -a1 : b1, link.far2[lane] = back ? -a2 : b2, link.far_t[lane] = back ? -at : bt;
    link.separation1[lane] = s1, link.separation2[lane] = s2;
    link.normal1[lane] = memory.normal1, link.normal2[lane] = memory.normal2;
    link.tangent[lane] = memory.tangent;
    link.friction[lane] = list.friction[i], link.thickness[lane] = list.thickness[i];
}

template <class Real>
void give_impulses(const PathLink<Real>& link, std::size_t lane, std::size_t near, std::size_t far, Real sign,
                   Column<Real>& velocity) {
    const Real normal1 = sign * link.normal1[lane], normal2 = sign * link.normal2[lane],
               tangent = sign * link.tangent[lane], normal = normal1 + normal2;
    const Real jx = normal * link.normal_x[lane] - tangent * link.normal_y[lane],
               jy = normal * link.normal_y[lane] + tangent * link.normal_x[lane];
    const auto change = [&](std::size_t row, Real side, Real spin) {
        Real* record = &velocity[4 * row];
        const Real w = side * std::fabs(record[3]), w2 = 2 * side * std::max(record[3], Real(0));
        record[0] += w * jx, record[1] += w * jy, record[2] += w2 * spin;
    };
    change(near, -1, link.near1[lane] * normal1 + link.near2[lane] * normal2 + link.near_t[lane] * tangent);
    change(far, 1, link.far1[lane] * normal1 + link.far2[lane] * normal2 + link.far_t[lane] * tangent);
}

template void write_link(const LinkPlace<float>&, ManifoldList<float>&, std::size_t, bool,
                         const Bodies<float>&, const BodyRecords<float>&);
template void write_link(const LinkPlace<double>&, ManifoldList<double>&, std::size_t, bool,
                         const Bodies<double>&, const BodyRecords<double>&);
template void give_impulses(const PathLink<float>&, std::size_t, std::size_t, std::size_t, float,
                            Column<float>&);
template void give_impulses(const PathLink<double>&, std::size_t, std::size_t, std::size_t, double,
                            Column<double>&);

}  // namespace carom
