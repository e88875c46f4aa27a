// The text that chladni-slepc leaves, as cluster/reply.h has it.
#pragma once

#include <cstddef>
#include <cstdio>
#include <vector>

namespace chladni::cluster {

struct ReplyText {
  long long rows = 0, counted = 0;
  double bound = 0.0;  ///< [s^-2]
  double seconds = 0.0;
  std::vector<double> peak_bytes;  ///< of each rank
  std::vector<double> shifts;      ///< [s^-2]
  std::vector<long long> below;    ///< eigenvalues below each shift
  std::vector<double> lambda;      ///< [s^-2]
};

inline void print(const ReplyText& reply, std::FILE* out) {
  std::fprintf(out, "chladni-slepc 1\nrows %lld\nbound %.17g\ncounted %lld\nseconds %.3f\n",
               reply.rows, reply.bound, reply.counted, reply.seconds);
  std::fprintf(out, "ranks %zu\n", reply.peak_bytes.size());
  for (const double bytes : reply.peak_bytes) std::fprintf(out, "%.0f\n", bytes);
  std::fprintf(out, "shifts %zu\n", reply.shifts.size());
  for (std::size_t i = 0; i < reply.shifts.size(); ++i) {
    std::fprintf(out, "%.17g %lld\n", reply.shifts[i], reply.below[i]);
  }
  std::fprintf(out, "modes %zu\n", reply.lambda.size());
  for (const double lambda : reply.lambda) std::fprintf(out, "%.17g\n", lambda);
  std::fprintf(out, "end\n");
}

}  // namespace chladni::cluster
