// `quads`: the kernel text with four numbers of one node in the place of lanes. Included inside a namespace that has Scalar.
namespace quads {
struct real {
  Scalar v[4];
};
struct mask {
  bool v[4];
};
#define STRANDCAST_EACH(expression) \
  real out;                         \
  for (int c = 0; c < 4; ++c) out.v[c] = expression; \
  return out;
inline real lit(double value) { STRANDCAST_EACH(static_cast<Scalar>(value)) }
inline real fill(Scalar value) { STRANDCAST_EACH(value) }
inline real load(const Scalar* p) { STRANDCAST_EACH(p[c]) }
inline real threeOf(const float* p) { STRANDCAST_EACH(c < 3 ? static_cast<Scalar>(p[c]) : 0) }  // then 0
inline real lastOf(const real& a) { STRANDCAST_EACH(a.v[3]) }
inline real operator+(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] + b.v[c]) }
inline real operator-(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] - b.v[c]) }
inline real operator*(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] * b.v[c]) }
inline real madd(const real& a, const real& b, const real& d) { STRANDCAST_EACH(std::fma(a.v[c], b.v[c], d.v[c])) }
inline real min(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] < b.v[c] ? a.v[c] : b.v[c]) }
inline real max(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] > b.v[c] ? a.v[c] : b.v[c]) }
inline real floor(const real& a) { STRANDCAST_EACH(std::floor(a.v[c])) }
inline real sqrt(const real& a) { STRANDCAST_EACH(std::sqrt(a.v[c])) }
inline real inverse(const real& a) { STRANDCAST_EACH(1 / a.v[c]) }
inline real select(const mask& m, const real& a, const real& b) { STRANDCAST_EACH(m.v[c] ? a.v[c] : b.v[c]) }
#undef STRANDCAST_EACH
inline void store(const real& a, Scalar* p) {
  for (int c = 0; c < 4; ++c) p[c] = a.v[c];
}
#include "kernels/lanes_vector.inl"
#include "kernels/grid.h"
#include "kernels/end_lanes.inl"
}  // namespace quads

// Adds four numbers, made whole, to a node's.
inline void addFixed(const quads::real& value, int32_t* node) {
  for (int c = 0; c < 4; ++c) node[c] += static_cast<int32_t>(value.v[c]);
}
// The same of a node and the next one along x, which get the shares `low` and `high`.
inline void addShares(const quads::real& value, Scalar low, Scalar high, int32_t* node) {
  addFixed(quads::fixedPoint(value * quads::fill(low)), node);
  addFixed(quads::fixedPoint(value * quads::fill(high)), node + 4);
}
inline quads::real wholes(const int32_t* node) {
  quads::real out;
  for (int c = 0; c < 4; ++c) out.v[c] = static_cast<Scalar>(node[c]);
  return out;
}
