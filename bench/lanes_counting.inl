// Lane vocabulary over one float that counts operations: additions, multiplications, divisions and roots count one
// each, a fused multiply-add two. Comparisons, selections, rounding and moves are not counted. Included inside a
// namespace.
using Scalar = float;
constexpr int kLanes = 1;
using mask = bool;
struct real {
  float v;
};
inline uint64_t operations = 0, operations_of[kStepParts] = {};
inline StepPart part_now = StepPart::kOther;

// Shadows the StepScope of core/strand_block.h, which does nothing.
class StepScope {
 public:
  explicit StepScope(StepPart part) : around_(part_now) { part_now = part; }
  ~StepScope() { part_now = around_; }
  StepScope(const StepScope&) = delete;
  StepScope& operator=(const StepScope&) = delete;

 private:
  StepPart around_;
};

inline real counted(float value, int count = 1) {
  operations += count;
  operations_of[static_cast<int>(part_now)] += count;
  return {value};
}
inline real lit(double value) { return {static_cast<float>(value)}; }
inline real operator+(real a, real b) { return counted(a.v + b.v); }
inline real operator-(real a, real b) { return counted(a.v - b.v); }
inline real operator*(real a, real b) { return counted(a.v * b.v); }
inline real operator/(real a, real b) { return counted(a.v / b.v); }
inline real madd(real a, real b, real c) { return counted(std::fma(a.v, b.v, c.v), 2); }
inline real sqrt(real a) { return counted(std::sqrt(a.v)); }
inline real inverse(real a) { return counted(1 / a.v); }
inline real inverseSqrt(real a) { return counted(1 / std::sqrt(a.v)); }
inline real floor(real a) { return {std::floor(a.v)}; }
inline real abs(real a) { return {std::fabs(a.v)}; }
inline real min(real a, real b) { return a.v < b.v ? a : b; }
inline real max(real a, real b) { return a.v > b.v ? a : b; }
inline mask operator<(real a, real b) { return a.v < b.v; }
inline mask operator>(real a, real b) { return a.v > b.v; }
inline mask operator<=(real a, real b) { return a.v <= b.v; }
inline mask operator>=(real a, real b) { return a.v >= b.v; }
inline real select(mask m, real a, real b) { return m ? a : b; }
inline real load(const Scalar* p) { return {*p}; }
inline void store(real value, Scalar* p) { *p = value.v; }
inline bool anyTrue(mask m) { return m; }
inline uint32_t laneBits(mask m) { return m ? 1 : 0; }
inline Scalar reduceMin(real value) { return value.v; }
inline void storeAsInt(real value, uint32_t* p) { *p = static_cast<uint32_t>(value.v); }
struct Packing {
  mask lanes;
};
inline Packing packing(mask m) { return {m}; }
inline void compressStore(real value, Packing packing, Scalar* p) {
  if (packing.lanes) *p = value.v;
}
inline mask firstLanes(int count) { return count > 0; }
inline real laneNumbers() { return {0}; }
using word = int32_t;
inline word splat(int32_t value) { return value; }
inline word toInt(real value) { return static_cast<word>(value.v); }
inline real realOf(word value) { return {static_cast<float>(value)}; }
inline real floatOf(word bits) { return {std::bit_cast<float>(bits)}; }
inline word select(mask m, word a, word b) { return m ? a : b; }
inline word shiftedDown(word a, word bits) { return a >> bits; }
inline word wordAt(const uint32_t* words, word number) { return static_cast<word>(words[number]); }
inline word wordAtByte(const uint32_t* words, word byte) {
  word found;
  std::memcpy(&found, reinterpret_cast<const char*>(words) + byte, sizeof found);
  return found;
}
inline real lowHalves(word words) { return {static_cast<float>(static_cast<int16_t>(words))}; }
inline real highHalves(word words) { return {static_cast<float>(words >> 16)}; }

#include "kernels/lanes_vector.inl"
