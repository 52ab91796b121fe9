#pragma once

// What functions are compiled for AVX2 by, in a program that runs without it as well: called only where
// has_wide_lanes() says so.

#if defined(__x86_64__)
#include <immintrin.h>
#define STILLPOINT_AVX2 __attribute__((target("avx2")))
#define STILLPOINT_AVX2_FMA __attribute__((target("avx2,fma")))
#endif
