#pragma once

// The inner loops are compiled three times, for any processor, for AVX2 and for AVX-512; which one runs is
// found out at the start. What they call is inlined (flatten), else it would stay as it is. All do the same
// operations in the same order (sums have fixed lanes, and nothing is contracted to a fused multiply-add:
// CMakeLists.txt), so that the results are the same bits. Sanitizers cannot stand the choice at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CARTVO_VECTOR_CLONES \
  __attribute__((flatten, target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
// And for AVX-512 that can shuffle bytes (VBMI) and sum products (VNNI), as Intel's have since 2019 and AMD's
// since 2022, which is none of the processors that GCC chooses by.
#define CARTVO_BYTE_SHUFFLES __attribute__((flatten, target("arch=x86-64-v4,avx512vbmi,avx512vnni")))
#else
#define CARTVO_VECTOR_CLONES
#endif
