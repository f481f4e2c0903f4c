#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "state/columns/column_memory.hpp"

namespace carom {

inline constexpr std::size_t kRowPadding = 16;  // floats in the widest batch we build (AVX-512)

/// Rows a column holds memory for, so that a kernel over `rows` rows needs no tail.
constexpr std::size_t padded(std::size_t rows) {
    return (rows + kRowPadding - 1) / kRowPadding * kRowPadding;
}

/// Rows a column holds memory for: its padding, and always one row after the last, which padded lists may
/// name.
constexpr std::size_t held(std::size_t rows) {
    return padded(rows + 1);
}

/// One contiguous array, aligned to a cache line. Rows [size(), held(size())) exist and are zero. Memory
/// only grows, by doubling, so that a world which has reached its largest size allocates no more.
template <class T>
class Column {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  public:
    Column() = default;
    explicit Column(std::size_t rows) { resize(rows); }
    ~Column() { release(); }
    Column(const Column& other) {
        resize_for_overwrite(other.size_);
        std::copy_n(other.rows_, other.size_, rows_);
    }
    Column(Column&& other) noexcept { swap(other); }
    /// In the memory that is there, if it suffices.
    Column& operator=(const Column& other) {
        if (this == &other) return *this;
        resize_for_overwrite(other.size_);
        std::copy_n(other.rows_, other.size_, rows_);
        return *this;
    }
    Column& operator=(Column&& other) noexcept {
        swap(other);
        return *this;
    }

    void swap(Column& other) noexcept {
        std::swap(rows_, other.rows_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
    }

    /// Rows that stay keep their value, new ones are zero.
    void resize(std::size_t rows) {
        const std::size_t kept = std::min(size_, rows);
        grow(rows, kept);
        std::fill(rows_ + kept, rows_ + held(rows), T{});
        size_ = rows;
    }

    /// Does what `resize` does, but keeps nothing: rows [0, rows) are indeterminate; the padding is zero.
    void resize_for_overwrite(std::size_t rows) {
        grow(rows, 0);
        std::fill(rows_ + rows, rows_ + held(rows), T{});
        size_ = rows;
    }

    void reserve(std::size_t rows) { grow(rows, size_); }
    void clear() { resize(0); }
    void push_back(T value) {
        if (rows_ && held(size_ + 1) == held(size_))
            ++size_;  // the row is there
        else
            resize(size_ + 1);
        rows_[size_ - 1] = value;
    }

    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    std::size_t capacity() const noexcept { return capacity_; }
    std::size_t bytes() const noexcept { return capacity_ * sizeof(T); }
    T* data() noexcept { return rows_; }
    const T* data() const noexcept { return rows_; }
    T& operator[](std::size_t row) {
        assert(row < padded(size_));
        return rows_[row];
    }
    const T& operator[](std::size_t row) const {
        assert(row < padded(size_));
        return rows_[row];
    }
    T* begin() noexcept { return rows_; }
    T* end() noexcept { return rows_ + size_; }
    const T* begin() const noexcept { return rows_; }
    const T* end() const noexcept { return rows_ + size_; }
    std::span<const T> span() const noexcept { return {rows_, size_}; }

  private:
    void grow(std::size_t rows, std::size_t kept) {
        if (held(rows) <= capacity_) return;
        const std::size_t capacity = std::max(held(rows), 2 * capacity_);
        T* larger = static_cast<T*>(allocate_column(capacity * sizeof(T)));
        std::copy_n(rows_, kept, larger);
        release();
        rows_ = larger;
        capacity_ = capacity;
    }
    void release() noexcept {
        if (rows_) release_column(rows_, bytes());
    }

    T* rows_ = nullptr;
    std::size_t size_ = 0;
    std::size_t capacity_ = 0;
};

}  // namespace carom
