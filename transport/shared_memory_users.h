#pragma once
#include <sys/types.h>

#include <filesystem>

namespace strandcast {

/// Whether a program of another user than `own` takes part in this DDS domain through shared memory. Segments
/// are accessible to their owner only: Fast DDS 2.9.1 receives nothing of the others' there, and a
/// participant that such a program sends to receives nothing more from any participant. `folder`: location of
/// the segments.
bool anotherUserSharesMemory(int domain, uid_t own, const std::filesystem::path& folder = "/dev/shm");

}  // namespace strandcast
