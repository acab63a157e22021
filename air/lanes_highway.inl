// The same as air/lanes_scalar.inl over Highway's vectors. Included inside a target's namespace after
// simd/lanes_highway.inl.
HWY_INLINE real loadAt(const Scalar* p) { return {hn::LoadU(Tag(), p)}; }
HWY_INLINE void storeAt(real value, Scalar* p) { hn::StoreU(value.v, Tag(), p); }
HWY_INLINE real laneNumbers() { return {hn::Iota(Tag(), 0.0f)}; }
HWY_INLINE real gather(const Scalar* base, real index) {
  return {hn::GatherIndex(Tag(), base, hn::ConvertTo(hn::RebindToSigned<Tag>(), index.v))};
}
HWY_INLINE Scalar largest(real a) { return hn::GetLane(hn::MaxOfLanes(Tag(), a.v)); }
HWY_INLINE Scalar sumOf(real a) { return hn::GetLane(hn::SumOfLanes(Tag(), a.v)); }

#if HWY_TARGET == HWY_SCALAR
#include "air/quads_scalar.inl"
#else
namespace quads {
using Tag = hn::FixedTag<float, 4>;
using IntTag = hn::FixedTag<int32_t, 4>;
struct real {
  hn::Vec<Tag> v;
};
struct mask {
  hn::Mask<Tag> m;
};
HWY_INLINE real lit(double value) { return {hn::Set(Tag(), static_cast<float>(value))}; }
HWY_INLINE real fill(Scalar value) { return {hn::Set(Tag(), value)}; }
HWY_INLINE real load(const Scalar* p) { return {hn::LoadU(Tag(), p)}; }
HWY_INLINE real operator+(real a, real b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE real operator-(real a, real b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE real operator*(real a, real b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE real madd(real a, real b, real c) { return {hn::MulAdd(a.v, b.v, c.v)}; }
HWY_INLINE real min(real a, real b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE real max(real a, real b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE real floor(real a) { return {hn::Floor(a.v)}; }
HWY_INLINE real sqrt(real a) { return {hn::Sqrt(a.v)}; }
HWY_INLINE real threeOf(const float* p) {  // then 0
  const hn::FixedTag<float, 2> half;
  const auto four = hn::Combine(Tag(), hn::Set(half, p[2]), hn::LoadU(half, p));
  return {hn::IfThenElseZero(hn::FirstN(Tag(), 3), four)};
}
HWY_INLINE real lastOf(real a) { return {hn::Broadcast<3>(a.v)}; }
HWY_INLINE real inverse(real a) { return {hn::Div(hn::Set(Tag(), 1.0f), a.v)}; }
HWY_INLINE real select(mask m, real a, real b) { return {hn::IfThenElse(m.m, a.v, b.v)}; }
HWY_INLINE void store(real a, Scalar* p) { hn::StoreU(a.v, Tag(), p); }
#include "kernels/lanes_vector.inl"
#include "kernels/grid.h"
#include "kernels/end_lanes.inl"
}  // namespace quads

HWY_INLINE void addFixed(quads::real value, int32_t* node) {
  const quads::IntTag whole;
  hn::StoreU(hn::Add(hn::LoadU(whole, node), hn::ConvertTo(whole, value.v)), whole, node);
}
// The same of a node and the next one along x, which get the shares `low` and `high`.
HWY_INLINE void addShares(quads::real value, Scalar low, Scalar high, int32_t* node) {
#if !HWY_ARCH_X86 || HWY_MAX_BYTES < 32
  addFixed(quads::fixedPoint(value * quads::fill(low)), node);
  addFixed(quads::fixedPoint(value * quads::fill(high)), node + 4);
#else
  const hn::FixedTag<float, 8> pair;
  const hn::FixedTag<int32_t, 8> whole;
  const auto shares = hn::Combine(pair, hn::Set(quads::Tag(), high), hn::Set(quads::Tag(), low));
  const auto product = hn::Mul(hn::Combine(pair, value.v, value.v), shares);
  const auto fixed = hn::Floor(hn::Add(product, hn::Set(pair, 0.5f)));  // kernels/grid.h, fixedPoint
  hn::StoreU(hn::Add(hn::LoadU(whole, node), hn::ConvertTo(whole, fixed)), whole, node);
#endif
}
HWY_INLINE quads::real wholes(const int32_t* node) {
  return {hn::ConvertTo(quads::Tag(), hn::LoadU(quads::IntTag(), node))};
}
#endif
