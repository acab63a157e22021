#pragma once
// Include this before hwy/foreach_target.h. Excluded targets: SSSE3, which only machines from before 2008 would choose,
// and vectors of unknown size, which cannot be members of the lane structs.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | STRANDCAST_UNSANITIZED_TARGETS)

// GCC's sanitizers compile two widths only, SSE2 and AVX2: code that is compiled per target takes them longest.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define STRANDCAST_UNSANITIZED_TARGETS (HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#else
#define STRANDCAST_UNSANITIZED_TARGETS 0
#endif
