#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// Counts allocations by operator new of all threads and libraries of this program. Not counted: direct calls
/// of malloc, oneTBB and GPU drivers in C. Active in programs that link counted_memory.cc.

size_t heapBytes();                  ///< bytes in use now, as the allocator rounds them
uint64_t allocations();              ///< number of allocations since the start, all threads
uint64_t allocationsOfThisThread();  ///< number of allocations since the start, calling thread

/// Bytes of this program's GPU buffers; 0 in a build without OpenGL.
size_t gpuBufferBytes();

}  // namespace strandcast
