// Lane vocabulary over one number of type STRANDCAST_SCALAR. Included inside a namespace.
using Scalar = STRANDCAST_SCALAR;
using real = Scalar;
using mask = bool;
constexpr int kLanes = 1;

inline real lit(double value) { return static_cast<real>(value); }
inline mask maskAll() { return true; }
inline mask maskNone() { return false; }
inline real madd(real a, real b, real c) { return std::fma(a, b, c); }
inline real sqrt(real a) { return std::sqrt(a); }
inline real inverse(real a) { return 1 / a; }
inline real inverseSqrt(real a) { return 1 / std::sqrt(a); }
inline real sin(real a) { return std::sin(a); }
inline real cos(real a) { return std::cos(a); }
inline real exp(real a) { return std::exp(a); }
inline real log(real a) { return std::log(a); }
inline real blend(real a, real b, real t) { return a * (1 - t) + b * t; }
inline real fadeBetween(real low, real high, real at) {
  real t = (at - low) / (high - low);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}
inline real floor(real a) { return std::floor(a); }
inline real abs(real a) { return std::fabs(a); }
inline real min(real a, real b) { return a < b ? a : b; }
inline real max(real a, real b) { return a > b ? a : b; }
inline real select(mask m, real a, real b) { return m ? a : b; }

// For the backends' planes, not for kernel text.
inline real load(const Scalar* p) { return *p; }
inline void store(real value, Scalar* p) { *p = value; }
inline bool anyTrue(mask m) { return m; }
inline uint32_t laneBits(mask m) { return m ? 1 : 0; }                                  // bit 0: the first lane
inline Scalar reduceMin(real value) { return value; }                                   // over all lanes
inline void storeAsInt(real value, uint32_t* p) { *p = static_cast<uint32_t>(value); }  // of non-negative integers
// Permutation that moves the lanes of a mask to the front. The entries after them, up to kLanes, are undefined.
struct Packing {
  mask lanes;
};
inline Packing packing(mask m) { return {m}; }
inline void compressStore(real value, Packing packing, Scalar* p) {
  if (packing.lanes) *p = value;
}
inline mask firstLanes(int count) { return count > 0; }
inline real laneNumbers() { return 0; }

// Signed integers, and reads of 32-bit words from memory.
using word = int32_t;
inline word splat(int32_t value) { return value; }
inline word toInt(real value) { return static_cast<word>(value); }  // of an integer
inline real realOf(word value) { return static_cast<real>(value); }
inline real floatOf(word bits) { return std::bit_cast<float>(bits); }
inline word select(mask m, word a, word b) { return m ? a : b; }
inline word shiftedDown(word a, word bits) { return a >> bits; }
inline word wordAt(const uint32_t* words, word number) { return static_cast<word>(words[number]); }
inline word wordAtByte(const uint32_t* words, word byte) {  // unaligned
  word found;
  std::memcpy(&found, reinterpret_cast<const char*>(words) + byte, sizeof found);
  return found;
}
// The signed 16-bit numbers in the low and in the high halves of words.
inline real lowHalves(word words) { return static_cast<real>(static_cast<int16_t>(words)); }
inline real highHalves(word words) { return static_cast<real>(words >> 16); }

#include "kernels/lanes_vector.inl"
