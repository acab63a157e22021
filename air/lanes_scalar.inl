// What grids need beyond the lane vocabulary, over one number a lane. Included inside a namespace of kernels/scalar_*.h.
inline real loadAt(const Scalar* p) { return *p; }  // from anywhere, as storeAt
inline void storeAt(real value, Scalar* p) { *p = value; }
inline real laneNumbers() { return 0; }
inline real gather(const Scalar* base, real index) { return base[static_cast<ptrdiff_t>(index)]; }
inline Scalar largest(real a) { return a; }
inline Scalar sumOf(real a) { return a; }

#include "air/quads_scalar.inl"
