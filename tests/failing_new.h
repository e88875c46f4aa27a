// Allocations that fail, in one test program of its own: this file replaces its operator new.
#pragma once

#include <cstdlib>
#include <new>

namespace chladni {

/// Which allocation of this thread fails, counted from 1 and down; 0 and below: none.
inline thread_local long allocations_to_failure = 0;

/// Calls `work` so often that each of its first `most` allocations has failed once. Returns how
/// many calls threw std::bad_alloc; the last one threw nothing, or `most` was reached.
template <class Work>
long without_memory(long most, long step, Work work) {
  long failures = 0;
  for (long n = 1; n <= most; n += step) {
    allocations_to_failure = n;
    try {
      work();
      const bool all = allocations_to_failure > 0;
      allocations_to_failure = 0;
      if (all) break;
    } catch (const std::bad_alloc&) {
      ++failures;
    }
    allocations_to_failure = 0;
  }
  return failures;
}

}  // namespace chladni

// Not inlined: a compiler that sees malloc in one and free in the other takes them for strangers.
__attribute__((noinline)) void* operator new(std::size_t size) {
  if (chladni::allocations_to_failure > 0 && --chladni::allocations_to_failure == 0) {
    throw std::bad_alloc();
  }
  void* place = std::malloc(size);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}
__attribute__((noinline)) void operator delete(void* place) noexcept { std::free(place); }
__attribute__((noinline)) void operator delete(void* place, std::size_t /*size*/) noexcept {
  std::free(place);
}
