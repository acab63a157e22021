// `quads`: the kernel text with the four numbers of one node as lanes. Included inside a namespace that has Scalar.
namespace quads {
struct real {
  Scalar v[4];
};
struct mask {
  bool v[4];
};
#define STRANDCAST_EACH(expression)                  \
  real out;                                          \
  for (int c = 0; c < 4; ++c) out.v[c] = expression; \
  return out;
inline real lit(double value) { STRANDCAST_EACH(static_cast<Scalar>(value)) }
inline real fill(Scalar value) { STRANDCAST_EACH(value) }
inline real load(const Scalar* p) { STRANDCAST_EACH(p[c]) }
inline real threeOf(const float* p) { STRANDCAST_EACH(c < 3 ? static_cast<Scalar>(p[c]) : 0) }  // p[0], p[1], p[2], 0
inline real twoAndTwo(const Scalar* p, const Scalar* q) { STRANDCAST_EACH(c < 2 ? p[c] : q[c - 2]) }
inline real lastOf(const real& a) { STRANDCAST_EACH(a.v[3]) }
inline real operator+(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] + b.v[c]) }
inline real operator-(const real& a, const real& b) { STRANDCAST_EACH(a.v[c] - b.v[c]) }
inline real operator-(const real& a) { STRANDCAST_EACH(-a.v[c]) }
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

// Four numbers of a sample, `numbers` x mass x scales, to be splatted to nodes of four fixed-point numbers.
using Shared = quads::real;
inline Shared sharedOut(const Scalar* numbers, Scalar mass, const Scalar* scales) {
  return quads::load(numbers) * quads::fill(mass) * quads::load(scales);
}
// Adds the four shares of a splat to the node, its neighbour along x and the same two of the next row.
inline void addShares(const Shared& splatted, const Scalar* shares, int32_t* node, size_t row) {
  int32_t* const corners[4] = {node, node + 4, node + row, node + row + 4};
  for (int corner = 0; corner < 4; ++corner) {
    const quads::real fixed = quads::fixedPoint(splatted * quads::fill(shares[corner]));
    for (int c = 0; c < 4; ++c) corners[corner][c] += static_cast<int32_t>(fixed.v[c]);
  }
}
// Transposes of(lane), four numbers per lane, into four vectors of one number of all lanes.
template <class Of>
inline void transposed(const Of& of, real* out) {
  const quads::real numbers = of(0);
  for (int c = 0; c < 4; ++c) out[c] = loadAt(numbers.v + c);
}
