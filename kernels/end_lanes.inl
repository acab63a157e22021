// Undefines the macros of the lane vocabulary, so that the next instantiation can define its own.
#undef LANE_FN
#undef LANE_IN
#undef LANE_OUT
#undef LANE_INOUT
#undef STRANDCAST_SCALAR
