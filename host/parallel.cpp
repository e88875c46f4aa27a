#include "host/parallel.h"

#include <fmt/format.h>

#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <fstream>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "host/limits/control_group.h"

namespace chladni {
namespace {

int topology_number(const std::string& file) {
  std::ifstream in(file);
  int number = -1;
  in >> number;
  return number;
}

// The number of processors that the control group grants, but at most `processors`.
int granted(int processors) {
  return static_cast<int>(std::min(static_cast<std::size_t>(processors), processors_of_group()));
}

// Counts cores, not hardware threads. Two hardware threads of one core share its arithmetic units,
// so the second one adds nothing here.
int physical_cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  std::set<std::pair<int, int>> cores;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &allowed)) continue;
    const std::string folder = "/sys/devices/system/cpu/cpu" + fmt::to_string(cpu) + "/topology/";
    const int core = topology_number(folder + "core_id");
    cores.emplace(topology_number(folder + "physical_package_id"), core < 0 ? -1 - cpu : core);
  }
  return std::max(1, static_cast<int>(cores.size()));
}

std::atomic<int>& chosen_count() {
  static std::atomic<int> count = granted(physical_cores());
  return count;
}

std::exception_ptr thrown_by(const std::function<void()>& call) {
  try {
    call();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

void rethrow_first(const std::vector<std::exception_ptr>& thrown) {
  for (const auto& one : thrown) {
    if (one) std::rethrow_exception(one);
  }
}

// Runs every call: the first one in this thread, each other one in a new thread. Where the system
// grants no thread, or no memory for one, the call runs in this thread. Then the exception of the
// lowest call that threw is rethrown.
void run_all(const std::vector<std::function<void()>>& calls) {
  std::vector<std::exception_ptr> thrown(calls.size());
  const auto run = [&](std::size_t i) { thrown[i] = thrown_by(calls[i]); };
  std::vector<std::thread> threads;
  threads.reserve(calls.size());
  std::size_t started = 1;
  try {
    for (; started < calls.size(); ++started) threads.emplace_back(run, started);
  } catch (const std::exception&) {
    for (std::size_t i = started; i < calls.size(); ++i) run(i);
  }
  run(0);
  for (auto& thread : threads) thread.join();
  rethrow_first(thrown);
}

// True in a thread that runs one of several tasks. The other threads then have tasks of their own.
thread_local bool in_task = false;

// Number of threads that wait until other threads end their tasks.
std::atomic<int> waiting{0};

// The waiting threads that a loop within a task takes over for its duration.
class Borrowed {
 public:
  explicit Borrowed(std::size_t most) {
    int there = waiting;
    do {
      count_ = static_cast<int>(std::min(most, static_cast<std::size_t>(std::max(there, 0))));
    } while (count_ > 0 && !waiting.compare_exchange_weak(there, there - count_));
  }
  ~Borrowed() { waiting += count_; }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(count_); }

 private:
  int count_ = 0;
};

// The threads for a loop of size `size`, including the caller's thread.
class Threads {
 public:
  explicit Threads(std::size_t size)
      : borrowed_(in_task && size > 0 ? size - 1 : 0),
        count_(in_task ? 1 + borrowed_.count()
                       : std::min(size, static_cast<std::size_t>(thread_count()))) {}
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  Borrowed borrowed_;
  std::size_t count_;
};

// Marks this thread as in a task, or not in a task, for the object's lifetime.
class InTask {
 public:
  explicit InTask(bool task) : before_(std::exchange(in_task, task)) {}
  ~InTask() { in_task = before_; }
  InTask(const InTask&) = delete;
  InTask& operator=(const InTask&) = delete;

 private:
  bool before_;
};

}  // namespace

int thread_count() { return chosen_count(); }

void set_thread_count(int count) {
  require(count >= 1, "thread count: found " + fmt::to_string(count) + ", expected 1 or more");
  chosen_count() = count;
}

void parallel_ranges(std::size_t size,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (size == 0) return;
  const Threads threads(size);
  const std::size_t count = threads.count();
  if (count == 1) return body(0, size);
  std::vector<std::function<void()>> calls;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = size / count * i + std::min(i, size % count);
    const std::size_t end = begin + size / count + (i < size % count ? 1 : 0);
    calls.emplace_back([&body, begin, end, task = in_task] {
      const InTask within(task);
      body(begin, end);
    });
  }
  run_all(calls);
}

void parallel_tasks(std::size_t size, const std::function<void(std::size_t i)>& body) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> thrown(size);
  const Threads threads(size);
  const auto work = [&] {
    const InTask within(true);
    for (auto i = next++; i < size; i = next++) thrown[i] = thrown_by([&] { body(i); });
    ++waiting;
  };
  const std::size_t count = std::max<std::size_t>(1, threads.count());
  run_all(std::vector<std::function<void()>>(count, work));
  waiting -= static_cast<int>(count);
  rethrow_first(thrown);
}

void in_parallel(const std::function<void()>& first, const std::function<void()>& second) {
  const std::array calls{&first, &second};
  parallel_ranges(calls.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) (*calls[i])();
  });
}

}  // namespace chladni
