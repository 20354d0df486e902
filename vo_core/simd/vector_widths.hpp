#pragma once

#include <cstdint>

namespace cartvo::vo {

/// Small unsigned numbers that are processed at once, in Size bytes: the vector extensions of GCC and Clang.
/// Never passed by value, because that ABI depends on the processor. Each size is spelt out, because GCC 12
/// ignores a vector_size that depends on a template parameter.
template <int Size>
struct ByteVectors;

template <>
struct ByteVectors<8> {
  using Bytes = std::uint8_t __attribute__((vector_size(8), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(8), may_alias));
};
template <>
struct ByteVectors<16> {
  using Bytes = std::uint8_t __attribute__((vector_size(16), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(16), may_alias));
  using SignedShorts = std::int16_t __attribute__((vector_size(16), may_alias));
  using Ints = std::uint32_t __attribute__((vector_size(16), may_alias));
};
template <>
struct ByteVectors<32> {
  using Bytes = std::uint8_t __attribute__((vector_size(32), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(32), may_alias));
  using SignedShorts = std::int16_t __attribute__((vector_size(32), may_alias));
  using Ints = std::uint32_t __attribute__((vector_size(32), may_alias));
};
template <>
struct ByteVectors<64> {
  using Bytes = std::uint8_t __attribute__((vector_size(64), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(64), may_alias));
  using SignedShorts = std::int16_t __attribute__((vector_size(64), may_alias));
  using Ints = std::uint32_t __attribute__((vector_size(64), may_alias));
};

}  // namespace cartvo::vo

// Defines a function for AVX-512, for AVX2 and for any processor, each with the size of its vectors, kSize,
// in bytes: GCC compares and selects well only what fits into one register, which CARTVO_TARGET_CLONES
// (target_clones.hpp) does not provide. The results must not depend on kSize.
#define CARTVO_FOR_ANY_PROCESSOR(declaration, ...) \
  declaration {                                    \
    constexpr int kSize = 16;                      \
    __VA_ARGS__                                    \
  }
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CARTVO_WIDE_VECTORS(processor) __attribute__((flatten, target(processor)))
#define CARTVO_BY_VECTOR_WIDTH(declaration, ...)      \
  CARTVO_WIDE_VECTORS("arch=x86-64-v4") declaration { \
    constexpr int kSize = 64;                         \
    __VA_ARGS__                                       \
  }                                                   \
  CARTVO_WIDE_VECTORS("arch=x86-64-v3") declaration { \
    constexpr int kSize = 32;                         \
    __VA_ARGS__                                       \
  }                                                   \
  CARTVO_WIDE_VECTORS("default") CARTVO_FOR_ANY_PROCESSOR(declaration, __VA_ARGS__)
#else
#define CARTVO_BY_VECTOR_WIDTH(declaration, ...) CARTVO_FOR_ANY_PROCESSOR(declaration, __VA_ARGS__)
#endif
