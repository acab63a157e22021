// Additions of the grid passes to the lane vocabulary, with one lane. Included inside a namespace of kernels/scalar_*.h.
inline real loadAt(const Scalar* p) { return *p; }  // no alignment needed, as of storeAt
inline void storeAt(real value, Scalar* p) { *p = value; }
// Interleaved access: four numbers per lane.
inline void loadFours(const Scalar* p, real* out) {
  for (int c = 0; c < 4; ++c) out[c] = p[c];
}
inline void storeFours(const real* in, Scalar* p) {
  for (int c = 0; c < 4; ++c) p[c] = in[c];
}
// Interleaved access: two numbers per lane.
inline void loadTwos(const Scalar* p, real* out) {
  out[0] = p[0];
  out[1] = p[1];
}
inline void storeTwos(const real* in, Scalar* p) {
  p[0] = in[0];
  p[1] = in[1];
}
inline Scalar largest(real a) { return a; }
inline Scalar sumOf(real a) { return a; }

#include "air/quads_scalar.inl"
