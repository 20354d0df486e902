#pragma once

// The inner loops are compiled three times, for any processor, for AVX2 and for AVX-512; the variant is
// selected at program start. The functions they call are inlined (flatten), because they would not be
// compiled for the variant otherwise. All variants do the same operations in the same order (sums have fixed
// lanes, and nothing is contracted to a fused multiply-add: CMakeLists.txt), so that the results are the same
// bits. Sanitizers do not support the selection at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CARTVO_TARGET_CLONES \
  __attribute__((flatten, target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CARTVO_TARGET_CLONES
#endif
