#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace cartvo::vo {

/// Vector of at most `kCapacity` items that are stored in place, so that no pair allocates memory per
/// landmark (C++26 has std::inplace_vector). Throws std::length_error for more. Memory is written only for
/// items it holds: thousands of landmarks are created and copied per pair.
template <typename T, std::size_t kCapacity>
class FixedVector {
 public:
  FixedVector() {}  // NOLINT(modernize-use-equals-default): which the union would delete
  FixedVector(std::initializer_list<T> items) {
    for (const T& item : items)
      push_back(item);
  }
  FixedVector(const FixedVector& other) { *this = other; }
  FixedVector& operator=(const FixedVector& other) {
    if (this == &other) return *this;
    for (std::size_t i = 0; i < other.size_; ++i)
      std::construct_at(items_ + i, other.items_[i]);
    size_ = other.size_;
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T* begin() { return items_; }
  T* end() { return begin() + size_; }
  const T* begin() const { return items_; }
  const T* end() const { return begin() + size_; }
  T& front() { return items_[0]; }
  T& back() { return items_[size_ - 1]; }
  const T& front() const { return items_[0]; }
  const T& back() const { return items_[size_ - 1]; }

  void clear() { size_ = 0; }
  // NOLINTBEGIN(readability-identifier-naming): as std::vector has them
  void push_back(const T& item) {
    requireRoomFor(size_ + 1);
    std::construct_at(items_ + size_++, item);
  }
  void resize(std::size_t size) {
    requireRoomFor(size);
    for (; size_ < size; ++size_)
      std::construct_at(items_ + size_);
    size_ = size;
  }
  template <typename... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    push_back(T(std::forward<Arguments>(arguments)...));
    return back();
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  static void requireRoomFor(std::size_t size) {
    if (size > kCapacity) throw std::length_error("FixedVector: more items than its capacity");
  }

  static_assert(std::is_trivially_destructible_v<T>);  // so that removed items need no destructor
  union {
    T items_[kCapacity];  // NOLINT(readability-identifier-naming): private
  };
  std::size_t size_ = 0;
};

}  // namespace cartvo::vo
