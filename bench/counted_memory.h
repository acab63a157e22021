#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// What operator new gives to this program is counted, by every thread and library of it. Not counted: what
/// is taken from malloc, by oneTBB and by GPU drivers in C. Programs that link counted_memory.cc have it.

size_t heapBytes();                  ///< that are in use now, as the allocator rounds them
uint64_t allocations();              ///< since the start, of all threads
uint64_t allocationsOfThisThread();  ///< the same, of the calling one

/// Of the buffers on the GPU that this program has; 0 in a build without OpenGL.
size_t gpuBufferBytes();

}  // namespace strandcast
