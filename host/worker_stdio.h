// The worker's side of run_worker: one request on stdin, one reply on stdout. This file needs only
// the standard library, so that a worker links nothing else.
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

namespace chladni {

/// All bytes up to the end of stdin.
[[nodiscard]] inline std::string all_of_stdin() {
  std::string bytes;
  char chunk[1U << 16U];
  while (const std::size_t count = std::fread(chunk, 1, sizeof chunk, stdin)) {
    bytes.append(chunk, count);
  }
  return bytes;
}

/// @throws std::runtime_error  not all bytes could be written
inline void write_to_stdout(const std::string& bytes) {
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size() &&
                       std::fflush(stdout) == 0;
  if (!written) throw std::runtime_error("cannot write the reply");
}

}  // namespace chladni
