#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "state/columns/column.hpp"

// State as bytes. A class that has state lists its members once,
//
//     template <class Self, class Archive>
//     static void visit_state(Self& self, Archive& archive) { archive(self.a_, self.b_); }
//
// and an archive counts their bytes, writes them or reads them back. What is not listed is scratch: made anew
// from the state in the step that needs it.

namespace carom {

template <class T>
inline constexpr bool kIsSequence = false;
template <class T>
inline constexpr bool kIsSequence<Column<T>> = true;
template <class T>
inline constexpr bool kIsSequence<std::vector<T>> = true;
template <>
inline constexpr bool kIsSequence<std::string> = true;

template <class T>
inline constexpr bool kIsArray = false;
template <class T, std::size_t kCount>
inline constexpr bool kIsArray<std::array<T, kCount>> = true;

/// What the three archives share: how a value falls apart. `Self` has take(data, bytes) and fit(sequence,
/// count).
template <class Self>
class StateArchive {
  public:
    template <class... T>
    void operator()(T&... values) {
        (visit(values), ...);
    }

  private:
    Self& self() { return static_cast<Self&>(*this); }

    template <class T>
    void visit(T& value) {
        using Value = std::remove_const_t<T>;
        if constexpr (requires { Value::visit_state(value, self()); }) {
            Value::visit_state(value, self());
        } else if constexpr (kIsSequence<Value>) {
            auto count = static_cast<std::uint64_t>(value.size());
            self().take(&count, sizeof(count));
            self().fit(value, static_cast<std::size_t>(count));
            visit_elements(value);
        } else if constexpr (kIsArray<Value>) {
            visit_elements(value);
        } else {
            static_assert(std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>,
                          "a class with state needs visit_state");
            self().take(&value, sizeof(value));
        }
    }

    template <class T>
    void visit_elements(T& values) {
        using Element = std::remove_cvref_t<decltype(values[0])>;
        if constexpr (std::is_trivially_copyable_v<Element> && !std::is_pointer_v<Element>)
            self().take(values.data(), values.size() * sizeof(Element));
        else
            for (auto& value : values) visit(value);
    }
};

/// How many bytes a state has.
class StateSize : public StateArchive<StateSize> {
  public:
    std::size_t bytes() const { return bytes_; }
    void take(const void*, std::size_t bytes) { bytes_ += bytes; }
    template <class T>
    void fit(const T&, std::size_t) {}

  private:
    std::size_t bytes_ = 0;
};

/// Writes a state to where there is room for it.
class StateWriter : public StateArchive<StateWriter> {
  public:
    explicit StateWriter(std::byte* out) : out_(out) {}
    void take(const void* data, std::size_t bytes) {
        if (bytes == 0) return;
        std::memcpy(out_, data, bytes);
        out_ += bytes;
    }
    template <class T>
    void fit(const T&, std::size_t) {}

  private:
    std::byte* out_;
};

/// Reads back what a StateWriter wrote. Allocates only where a sequence outgrows the room it has.
class StateReader : public StateArchive<StateReader> {
  public:
    explicit StateReader(const std::byte* in) : in_(in) {}
    void take(void* data, std::size_t bytes) {
        if (bytes == 0) return;
        std::memcpy(data, in_, bytes);
        in_ += bytes;
    }
    template <class T>
    void fit(T& values, std::size_t count) {
        if constexpr (requires { values.resize_for_overwrite(count); })
            values.resize_for_overwrite(count);
        else
            values.resize(count);
    }

  private:
    const std::byte* in_;
};

}  // namespace carom
