// Loops over both cores whose result does not depend on how many there are.
#pragma once

#include <cstddef>
#include <functional>

namespace chladni {

/// Threads used by every parallel loop: the physical cores, or as many as the control group's quota
/// (cpu.max) pays for where that is less, until `set_thread_count` says otherwise.
[[nodiscard]] int thread_count();
/// @throws InvalidInput  count < 1
void set_thread_count(int count);

/// Calls body(begin, end) on disjoint ranges that cover [0, size), one range per thread.
/// The first exception of a body is thrown here after all have ended.
void parallel_ranges(std::size_t size,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for each i in [0, size), each as soon as a thread is free: for tasks of unequal
/// cost. Parallel loops within a task run in its thread and in those that have no task left. The
/// exception of the lowest task that threw is thrown here after all have ended.
void parallel_tasks(std::size_t size, const std::function<void(std::size_t i)>& body);

/// Runs the two calls at once (one after the other with one thread); rethrows the first exception.
void in_parallel(const std::function<void()>& first, const std::function<void()>& second);

}  // namespace chladni
