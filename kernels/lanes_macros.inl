// Macros of kernel text on the C++ side; end_lanes.inl undefines them.
#define FN [[maybe_unused]] static inline
#define IN(type) const type&
#define OUT(type) type&
#define INOUT(type) type&
