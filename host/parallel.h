// Loops on all cores whose result does not depend on the number of cores.
#pragma once

#include <cstddef>
#include <functional>

namespace chladni {

/// The number of threads of every parallel loop: the number of physical cores, or the control
/// group's quota (cpu.max) where that is less. `set_thread_count` changes it.
[[nodiscard]] int thread_count();
/// @throws InvalidInput  count < 1
void set_thread_count(int count);

/// Calls body(begin, end) on disjoint ranges that cover [0, size), one range per thread.
/// After all ranges have ended, the exception of the lowest range that threw is thrown here.
void parallel_ranges(std::size_t size,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for each i in [0, size), each as soon as a thread is free. This is for tasks of
/// unequal cost. A parallel loop within a task runs in the task's thread, and in one new thread for
/// each that has no task left when the loop begins. After all tasks have ended, the exception of
/// the lowest task that threw is thrown here.
void parallel_tasks(std::size_t size, const std::function<void(std::size_t i)>& body);

/// Runs the two calls at the same time (one after the other with one thread). The exception of
/// `first`, else of `second`, is rethrown.
void in_parallel(const std::function<void()>& first, const std::function<void()>& second);

}  // namespace chladni
