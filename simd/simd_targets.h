#pragma once
// To be included before hwy/foreach_target.h. Left out: SSSE3, which only machines from before 2008 would
// choose, and vectors of unknown size, which cannot be members of the lane structs.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
