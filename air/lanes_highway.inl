// Counterpart of air/lanes_scalar.inl over Highway's vectors. Included inside a target's namespace after
// kernels/lanes_highway.inl.
HWY_INLINE real loadAt(const Scalar* p) { return {hn::LoadU(Tag(), p)}; }
HWY_INLINE void storeAt(real value, Scalar* p) { hn::StoreU(value.v, Tag(), p); }
// Interleaved access: four numbers per lane.
HWY_INLINE void loadFours(const Scalar* p, real* out) { hn::LoadInterleaved4(Tag(), p, out[0].v, out[1].v, out[2].v, out[3].v); }
HWY_INLINE void storeFours(const real* in, Scalar* p) { hn::StoreInterleaved4(in[0].v, in[1].v, in[2].v, in[3].v, Tag(), p); }
// Interleaved access: two numbers per lane.
HWY_INLINE void loadTwos(const Scalar* p, real* out) { hn::LoadInterleaved2(Tag(), p, out[0].v, out[1].v); }
HWY_INLINE void storeTwos(const real* in, Scalar* p) { hn::StoreInterleaved2(in[0].v, in[1].v, Tag(), p); }
HWY_INLINE Scalar largest(real a) { return hn::GetLane(hn::MaxOfLanes(Tag(), a.v)); }
HWY_INLINE Scalar sumOf(real a) { return hn::GetLane(hn::SumOfLanes(Tag(), a.v)); }

#if HWY_TARGET == HWY_SCALAR
#include "air/quads_scalar.inl"
#else
namespace quads {
using Tag = hn::FixedTag<float, 4>;
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
HWY_INLINE real operator-(real a) { return {hn::Neg(a.v)}; }
HWY_INLINE real operator*(real a, real b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE real madd(real a, real b, real c) { return {hn::MulAdd(a.v, b.v, c.v)}; }
HWY_INLINE real min(real a, real b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE real max(real a, real b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE real floor(real a) { return {hn::Floor(a.v)}; }
HWY_INLINE real sqrt(real a) { return {hn::Sqrt(a.v)}; }
HWY_INLINE real threeOf(const float* p) {  // p[0], p[1], p[2], 0
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32  // masked loads do not access masked-out elements
  return {hn::MaskedLoad(hn::FirstN(Tag(), 3), Tag(), p)};
#else
  const hn::FixedTag<float, 2> half;
  const auto four = hn::Combine(Tag(), hn::Set(half, p[2]), hn::LoadU(half, p));
  return {hn::IfThenElseZero(hn::FirstN(Tag(), 3), four)};
#endif
}
HWY_INLINE real twoAndTwo(const Scalar* p, const Scalar* q) {
  const hn::FixedTag<float, 2> half;
  return {hn::Combine(Tag(), hn::LoadU(half, q), hn::LoadU(half, p))};
}
HWY_INLINE real lastOf(real a) { return {hn::Broadcast<3>(a.v)}; }
HWY_INLINE real inverse(real a) { return {hn::Div(hn::Set(Tag(), 1.0f), a.v)}; }
HWY_INLINE real select(mask m, real a, real b) { return {hn::IfThenElse(m.m, a.v, b.v)}; }
HWY_INLINE void store(real a, Scalar* p) { hn::StoreU(a.v, Tag(), p); }
#include "kernels/lanes_vector.inl"
#include "kernels/grid.h"
#include "kernels/end_lanes.inl"
}  // namespace quads

// Four numbers of a sample, `numbers` x mass x scales, to be splatted to nodes of four fixed-point numbers. Repeated for as many
// corners as one vector updates.
#if !HWY_ARCH_X86 || HWY_MAX_BYTES < 32
using SharedTag = quads::Tag;
#else
using SharedTag = hn::FixedTag<float, HWY_MAX_BYTES / 4>;
#endif
using Shared = hn::Vec<SharedTag>;
HWY_INLINE Shared sharedOut(const Scalar* numbers, Scalar mass, const Scalar* scales) {
  const SharedTag tag;
  return hn::Mul(hn::Mul(hn::LoadDup128(tag, numbers), hn::Set(tag, mass)), hn::LoadDup128(tag, scales));
}
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32
// Each share in four lanes.
HWY_INLINE Shared sharesFrom(const Scalar* shares, const int32_t* which) {
  const SharedTag tag;
  return hn::TableLookupLanes(hn::LoadDup128(tag, shares), hn::SetTableIndices(tag, which));
}
template <class Numbers>
HWY_INLINE void addTwoNodes(Numbers numbers, int32_t* node) {
  const hn::FixedTag<int32_t, 8> whole;
  hn::StoreU(hn::Add(hn::LoadU(whole, node), numbers), whole, node);
}
#endif
// Adds the four shares of a splat to the node, its neighbour along x and the same two of the next row, rounded as fixedPoint() in
// kernels/grid.h. x86 uses conversion intrinsics: hn::ConvertTo also checks for values above 2^31, which takes as long as the rest.
HWY_INLINE void addShares(Shared splatted, const Scalar* shares, int32_t* node, size_t row) {
#if !HWY_ARCH_X86 || HWY_MAX_BYTES < 32
  const hn::FixedTag<int32_t, 4> whole;
  int32_t* const corners[4] = {node, node + 4, node + row, node + row + 4};
  for (int c = 0; c < 4; ++c) {
    const quads::real fixed = quads::fixedPoint(quads::real{splatted} * quads::fill(shares[c]));
    hn::StoreU(hn::Add(hn::LoadU(whole, corners[c]), hn::ConvertTo(whole, fixed.v)), whole, corners[c]);
  }
#else
  alignas(64) static constexpr int32_t kWhich[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  const SharedTag tag;
  const auto half = hn::Set(tag, 0.5f);
#if HWY_MAX_BYTES >= 64
  const auto sum = hn::Add(hn::Mul(splatted, sharesFrom(shares, kWhich)), half);
  const __m512i numbers = _mm512_cvt_roundps_epi32(sum.raw, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
  addTwoNodes(hn::Vec256<int32_t>{_mm512_castsi512_si256(numbers)}, node);
  addTwoNodes(hn::Vec256<int32_t>{_mm512_extracti64x4_epi64(numbers, 1)}, node + row);
#else
  for (size_t y = 0; y < 2; ++y) {
    const auto fixed = hn::Floor(hn::Add(hn::Mul(splatted, sharesFrom(shares, kWhich + 8 * y)), half));
    addTwoNodes(hn::Vec256<int32_t>{_mm256_cvtps_epi32(fixed.raw)}, node + y * row);
  }
#endif
#endif
}
// Transposes of(lane), four numbers per lane, into four vectors of one number of all lanes. Works in registers: wide loads after
// narrow stores would stall on store forwarding.
template <class Of>
HWY_INLINE void transposed(const Of& of, real* out) {
  const Tag tag;
  auto every_fourth = [&](int lane) {
#if HWY_MAX_BYTES >= 64
    const hn::FixedTag<float, 8> half;
    return hn::Combine(tag, hn::Combine(half, of(lane + 12).v, of(lane + 8).v), hn::Combine(half, of(lane + 4).v, of(lane).v));
#elif HWY_MAX_BYTES >= 32
    return hn::Combine(tag, of(lane + 4).v, of(lane).v);
#else
    return of(lane).v;
#endif
  };
  const auto a = every_fourth(0), b = every_fourth(1), c = every_fourth(2), d = every_fourth(3);
  const auto ac = hn::InterleaveLower(tag, a, c), bd = hn::InterleaveLower(tag, b, d);
  const auto ac_last = hn::InterleaveUpper(tag, a, c), bd_last = hn::InterleaveUpper(tag, b, d);
  out[0] = {hn::InterleaveLower(tag, ac, bd)};
  out[1] = {hn::InterleaveUpper(tag, ac, bd)};
  out[2] = {hn::InterleaveLower(tag, ac_last, bd_last)};
  out[3] = {hn::InterleaveUpper(tag, ac_last, bd_last)};
}
#endif
