// Undefines the macros of the lane vocabulary, so that the next instantiation can define its own.
#undef FN
#undef IN
#undef OUT
#undef INOUT
#undef STRANDCAST_SCALAR
