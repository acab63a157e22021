#include "bench/counted_memory.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#ifdef STRANDCAST_HAS_RENDER
#include "gl/buffer.h"
#endif

// Where g++ inlines only one of operator new and operator delete below, it reports the malloc or free inside
// as a mismatch.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
#endif

namespace {

std::atomic<size_t> heap_bytes{0};
std::atomic<uint64_t> all_allocations{0};
thread_local uint64_t own_allocations = 0;

void* counted(void* memory) {
  all_allocations.fetch_add(1, std::memory_order_relaxed);
  ++own_allocations;
  heap_bytes.fetch_add(malloc_usable_size(memory), std::memory_order_relaxed);
  return memory;
}

void* allocate(size_t bytes, size_t alignment) noexcept {
  const size_t rounded = (std::max<size_t>(bytes, 1) + alignment - 1) / alignment * alignment;
  void* memory =
      alignment <= alignof(std::max_align_t) ? std::malloc(rounded) : std::aligned_alloc(alignment, rounded);
  return memory == nullptr ? nullptr : counted(memory);
}

void* allocateOrThrow(size_t bytes, size_t alignment) {
  if (void* memory = allocate(bytes, alignment)) return memory;
  throw std::bad_alloc();
}

void deallocate(void* memory) noexcept {
  if (memory == nullptr) return;
  heap_bytes.fetch_sub(malloc_usable_size(memory), std::memory_order_relaxed);
  std::free(memory);
}

constexpr size_t kAlignment = alignof(std::max_align_t);

}  // namespace

void* operator new(size_t bytes) { return allocateOrThrow(bytes, kAlignment); }
void* operator new[](size_t bytes) { return allocateOrThrow(bytes, kAlignment); }
void* operator new(size_t bytes, std::align_val_t a) { return allocateOrThrow(bytes, size_t(a)); }
void* operator new[](size_t bytes, std::align_val_t a) { return allocateOrThrow(bytes, size_t(a)); }
void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, kAlignment); }
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, kAlignment); }
void operator delete(void* p) noexcept { deallocate(p); }
void operator delete[](void* p) noexcept { deallocate(p); }
void operator delete(void* p, size_t) noexcept { deallocate(p); }
void operator delete[](void* p, size_t) noexcept { deallocate(p); }
void operator delete(void* p, std::align_val_t) noexcept { deallocate(p); }
void operator delete[](void* p, std::align_val_t) noexcept { deallocate(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { deallocate(p); }
void operator delete[](void* p, size_t, std::align_val_t) noexcept { deallocate(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { deallocate(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { deallocate(p); }

namespace strandcast {

size_t heapBytes() { return heap_bytes.load(); }
uint64_t allocations() { return all_allocations.load(); }
uint64_t allocationsOfThisThread() { return own_allocations; }

size_t gpuBufferBytes() {
#ifdef STRANDCAST_HAS_RENDER
  return gl::Buffer::bytesOfAll();
#else
  return 0;
#endif
}

}  // namespace strandcast
