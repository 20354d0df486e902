#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <utility>

namespace cartvo {

/// A vector of at most `kMost` items that holds them inside itself, so that no pair allocates one for each
/// landmark (C++26 has std::inplace_vector). More are refused: std::length_error. Assigning copies no more
/// than it holds.
template <typename T, std::size_t kMost>
class FixedVector {
 public:
  FixedVector() = default;
  FixedVector(std::initializer_list<T> items) {
    for (const T& item : items)
      push_back(item);
  }
  FixedVector(const FixedVector& other) { *this = other; }
  FixedVector& operator=(const FixedVector& other) {
    for (std::size_t i = 0; i < other.size_; ++i)
      items_[i] = other.items_[i];
    size_ = other.size_;
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T* begin() { return items_.data(); }
  T* end() { return begin() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return begin() + size_; }
  T& front() { return items_[0]; }
  T& back() { return items_[size_ - 1]; }
  const T& front() const { return items_[0]; }
  const T& back() const { return items_[size_ - 1]; }

  void clear() { size_ = 0; }
  // NOLINTBEGIN(readability-identifier-naming): as std::vector has them
  void push_back(const T& item) {
    requireRoomFor(size_ + 1);
    items_[size_++] = item;
  }
  void resize(std::size_t size) {
    requireRoomFor(size);
    for (; size_ < size; ++size_)
      items_[size_] = T{};
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
    if (size > kMost) throw std::length_error("a FixedVector cannot hold so many items");
  }

  std::array<T, kMost> items_{};
  std::size_t size_ = 0;
};

}  // namespace cartvo
