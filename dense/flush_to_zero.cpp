#include "dense/flush_to_zero.h"

#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

namespace chladni::dense {

#if defined(__SSE2__)
FlushToZero::FlushToZero() : before_(_mm_getcsr()) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}
FlushToZero::~FlushToZero() { _mm_setcsr(before_); }
#else
FlushToZero::FlushToZero() = default;
FlushToZero::~FlushToZero() = default;
#endif

}  // namespace chladni::dense
