#include "solvers/manifolds/list/manifold_list.hpp"

#include <algorithm>

namespace carom {

// A snapshot has contacts that sleep as bytes: padding would differ from run to run.
static_assert(sizeof(KeptManifold<float>) ==
              sizeof(ManifoldName) + sizeof(std::int32_t) + sizeof(ManifoldMemory<float>) + sizeof(float));
static_assert(sizeof(KeptManifold<double>) ==
              sizeof(ManifoldName) + sizeof(std::int32_t) + sizeof(ManifoldMemory<double>) + sizeof(double));

template <class Real>
void ManifoldList<Real>::clear() {
    a.clear(), b.clear(), item_a.clear(), item_b.clear();
    names.clear(), memory.clear();
}

template <class Real>
void ManifoldList<Real>::add(std::int32_t row_a, std::int32_t partner, const ManifoldName& name) {
    a.push_back(row_a), b.push_back(partner), names.push_back(name), memory.push_back({});
}

template <class Real>
void ManifoldList<Real>::remove(std::size_t i) {
    const std::size_t last = count() - 1;
    const auto remove_from = [&](auto& column) {
        if (column.size() <= last) return;
        column[i] = column[last];
        column.resize(last);
    };
    for (Column<std::int32_t>* column : {&a, &b, &item_a, &item_b}) remove_from(*column);
    for (Column<Real>* column : {&margin, &thickness, &friction, &restitution}) remove_from(*column);
    for_each_found_column(*this, remove_from);
    remove_from(names), remove_from(memory);
}

template <class Real>
void ManifoldList<Real>::add_kept(const KeptManifold<Real>& kept) {
    add(0, 0, kept.name);
    memory.back() = kept.memory, memory.back().slot = -1;
    friction.resize(count()), friction[count() - 1] = kept.friction;
}

template <class Real>
void ManifoldList<Real>::fit() {
    for (Column<Real>* column : {&margin, &thickness, &friction, &restitution}) column->resize(count());
    for_each_found_column(*this, [&](Column<Real>& column) { column.resize(count()); });
    if (names.empty()) return;
    for (Column<std::int32_t>* rows : {&a, &b}) std::fill(rows->end(), rows->data() + padded(count()), a[0]);
    for (Column<std::int32_t>* items : {&item_a, &item_b})
        if (!items->empty()) std::fill(items->end(), items->data() + padded(count()), item_a[0]);
}

template <class Real>
ManifoldColumns<Real> ManifoldList<Real>::columns() {
    return {normal_x.data(), normal_y.data(),  lever_a1.data(),  lever_a2.data(),    lever_b1.data(),
            lever_b2.data(), lever_a_t.data(), lever_b_t.data(), separation1.data(), separation2.data()};
}

template <class Real>
void ManifoldList<Real>::set_manifold(std::size_t i, const Manifold<double>& found) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    normal_x[i] = real(found.normal_x), normal_y[i] = real(found.normal_y);
    lever_a1[i] = real(found.lever_a1), lever_a2[i] = real(found.lever_a2);
    lever_b1[i] = real(found.lever_b1), lever_b2[i] = real(found.lever_b2);
    lever_a_t[i] = real(found.lever_a_t), lever_b_t[i] = real(found.lever_b_t);
    separation1[i] = real(found.separation1), separation2[i] = real(found.separation2);
}

template <class Real>
Manifold<double> ManifoldList<Real>::manifold(std::size_t i) const {
    return {normal_x[i], normal_y[i],  lever_a1[i],  lever_a2[i],    lever_b1[i],
            lever_b2[i], lever_a_t[i], lever_b_t[i], separation1[i], separation2[i]};
}

template <class Real>
std::size_t ManifoldList<Real>::bytes() const {
    std::size_t bytes = a.bytes() + b.bytes() + item_a.bytes() + item_b.bytes() + margin.bytes() +
                        thickness.bytes() + friction.bytes() + restitution.bytes() +
                        names.capacity() * sizeof(ManifoldName) +
                        memory.capacity() * sizeof(ManifoldMemory<Real>);
    for_each_found_column(*this, [&](const Column<Real>& column) { bytes += column.bytes(); });
    return bytes;
}

template struct ManifoldList<float>;
template struct ManifoldList<double>;

}  // namespace carom
