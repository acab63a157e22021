// Lane vocabulary over one Highway vector of floats of the target being compiled. Included inside the target's namespace,
// once per target, after hwy/highway.h. The kernel text that the file uses and end_lanes.inl follow it.
namespace hn = hwy::HWY_NAMESPACE;
using Scalar = float;
using Tag = hn::ScalableTag<float>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));  // on x86 the exact number of lanes

// Plain aggregates without constructors: g++ does not inline user-written ones across Highway's target pragmas.
struct real {
  hn::Vec<Tag> v;
};
struct mask {
  hn::Mask<Tag> m;
};

HWY_INLINE real lit(double value) { return {hn::Set(Tag(), static_cast<float>(value))}; }
HWY_INLINE real operator+(real a, real b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE real operator-(real a, real b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE real operator-(real a) { return {hn::Neg(a.v)}; }
HWY_INLINE real operator*(real a, real b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE real operator/(real a, real b) { return {hn::Div(a.v, b.v)}; }
HWY_INLINE real madd(real a, real b, real c) { return {hn::MulAdd(a.v, b.v, c.v)}; }
HWY_INLINE real sqrt(real a) { return {hn::Sqrt(a.v)}; }
#if HWY_TARGET <= HWY_AVX3
// Estimates to 14 bits plus one step of Newton's method, which doubles the bits: several times as fast as a division.
// The last operation adds a small correction, so that only the final sum is rounded.
HWY_INLINE real inverse(real a) {
  const auto y = hn::ApproximateReciprocal(a.v);
  return {hn::MulAdd(y, hn::NegMulAdd(a.v, y, hn::Set(Tag(), 1.0f)), y)};
}
HWY_INLINE real inverseSqrt(real a) {
  const auto y = hn::ApproximateReciprocalSqrt(a.v);
  const auto off = hn::NegMulAdd(hn::Mul(a.v, y), y, hn::Set(Tag(), 1.0f));
  return {hn::MulAdd(hn::Mul(y, hn::Set(Tag(), 0.5f)), off, y)};
}
#else
HWY_INLINE real inverse(real a) { return {hn::Div(hn::Set(Tag(), 1.0f), a.v)}; }
HWY_INLINE real inverseSqrt(real a) { return {hn::Div(hn::Set(Tag(), 1.0f), hn::Sqrt(a.v))}; }
#endif
HWY_INLINE real floor(real a) { return {hn::Floor(a.v)}; }
HWY_INLINE real abs(real a) { return {hn::Abs(a.v)}; }
HWY_INLINE real min(real a, real b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE real max(real a, real b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE mask operator<(real a, real b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE mask operator>(real a, real b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE mask operator<=(real a, real b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE mask operator>=(real a, real b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE mask operator&&(mask a, mask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE mask operator||(mask a, mask b) { return {hn::Or(a.m, b.m)}; }
HWY_INLINE mask operator!(mask a) { return {hn::Not(a.m)}; }
HWY_INLINE mask maskAll() { return lit(0) < lit(1); }
HWY_INLINE mask maskNone() { return lit(0) < lit(0); }
HWY_INLINE real select(mask m, real a, real b) { return {hn::IfThenElse(m.m, a.v, b.v)}; }

// For the backends' planes, not for kernel text. Rows of lanes are aligned to their size.
#if defined(__GNUC__) && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
// Rows hold floats only. Highway's own stores may alias any type, so that a sweep would reload all block members after
// each store. For g++, a vector type aliases only what its elements may alias.
using Row [[gnu::vector_size(sizeof(Scalar) * kLanes)]] = Scalar;
HWY_INLINE real load(const Scalar* p) { return {hn::Vec<Tag>{*reinterpret_cast<const Row*>(p)}}; }
HWY_INLINE void store(real value, Scalar* p) { *reinterpret_cast<Row*>(p) = value.v.raw; }
#else
HWY_INLINE real load(const Scalar* p) { return {hn::Load(Tag(), p)}; }
HWY_INLINE void store(real value, Scalar* p) { hn::Store(value.v, Tag(), p); }
#endif
HWY_INLINE bool anyTrue(mask m) { return !hn::AllFalse(Tag(), m.m); }
HWY_INLINE uint32_t laneBits(mask m) {
  uint64_t bits = 0;
  hn::StoreMaskBits(Tag(), m.m, reinterpret_cast<uint8_t*>(&bits));
  return static_cast<uint32_t>(bits);
}
HWY_INLINE Scalar reduceMin(real value) { return hn::GetLane(hn::MinOfLanes(Tag(), value.v)); }
using WordTag = hn::RebindToSigned<Tag>;
HWY_INLINE void storeAsInt(real value, uint32_t* p) {
  hn::Store(hn::ConvertTo(WordTag(), value.v), WordTag(), reinterpret_cast<int32_t*>(p));
}
// hn::Compress() is avoided: g++ copies its table to the stack at every call.
struct Packing {
  decltype(hn::IndicesFromVec(Tag(), hn::Zero(WordTag()))) order;
};
HWY_INLINE Packing packing(mask m) {
  alignas(64) int32_t order[kLanes] = {};
  int count = 0;
  for (uint32_t left = laneBits(m); left != 0; left &= left - 1) order[count++] = std::countr_zero(left);
  return {hn::IndicesFromVec(Tag(), hn::Load(WordTag(), order))};
}
HWY_INLINE void compressStore(real value, Packing packing, Scalar* p) {
  hn::StoreU(hn::TableLookupLanes(value.v, packing.order), Tag(), p);
}
HWY_INLINE mask firstLanes(int count) { return {hn::FirstN(Tag(), static_cast<size_t>(count))}; }
HWY_INLINE real laneNumbers() { return {hn::Iota(Tag(), 0.0f)}; }
struct word {
  hn::Vec<WordTag> v;
};
HWY_INLINE word operator+(word a, word b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE word operator*(word a, word b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE word operator&(word a, word b) { return {hn::And(a.v, b.v)}; }
HWY_INLINE word splat(int32_t value) { return {hn::Set(WordTag(), value)}; }
HWY_INLINE word toInt(real value) { return {hn::ConvertTo(WordTag(), value.v)}; }
HWY_INLINE real realOf(word value) { return {hn::ConvertTo(Tag(), value.v)}; }
HWY_INLINE real floatOf(word bits) { return {hn::BitCast(Tag(), bits.v)}; }
HWY_INLINE word select(mask m, word a, word b) { return {hn::IfThenElse(hn::RebindMask(WordTag(), m.m), a.v, b.v)}; }
HWY_INLINE word shiftedDown(word a, word bits) { return {hn::Shr(a.v, bits.v)}; }
HWY_INLINE word wordAt(const uint32_t* words, word number) {
  return {hn::GatherIndex(WordTag(), reinterpret_cast<const int32_t*>(words), number.v)};
}
HWY_INLINE word wordAtByte(const uint32_t* words, word byte) {
  return {hn::GatherOffset(WordTag(), reinterpret_cast<const int32_t*>(words), byte.v)};
}
HWY_INLINE real lowHalves(word words) { return {hn::ConvertTo(Tag(), hn::ShiftRight<16>(hn::ShiftLeft<16>(words.v)))}; }
HWY_INLINE real highHalves(word words) { return {hn::ConvertTo(Tag(), hn::ShiftRight<16>(words.v))}; }

#include "kernels/lanes_vector.inl"
