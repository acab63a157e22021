// Macros of kernel text on the C++ side; end_lanes.inl undefines them. Unprefixed, IN and OUT collide with Windows headers.
#define LANE_FN [[maybe_unused]] static inline
#define LANE_IN(type) const type&
#define LANE_OUT(type) type&
#define LANE_INOUT(type) type&
