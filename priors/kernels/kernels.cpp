#include <algorithm>
#include <string>

#include "base/error.h"
#include "priors/kernel.h"

namespace chladni::priors {

// A new kernel needs a file in priors/kernels/, its name here and its pointer in the table.
extern const KernelFamily squared_exponential_kernel;
extern const KernelFamily matern_5_2_kernel;
extern const KernelFamily matern_3_2_kernel;
extern const KernelFamily rational_quadratic_kernel;
extern const KernelFamily periodic_kernel;
extern const KernelFamily cosine_kernel;
extern const KernelFamily linear_kernel;

namespace {

constinit const KernelFamily* const kKernels[] = {
    &squared_exponential_kernel,
    &matern_5_2_kernel,
    &matern_3_2_kernel,
    &rational_quadratic_kernel,
    &periodic_kernel,
    &cosine_kernel,
    &linear_kernel,
};

}  // namespace

std::span<const KernelFamily* const> kernels() { return kKernels; }

const KernelFamily& kernel_family(std::string_view name) {
  const auto found = std::ranges::find(kKernels, name, [](auto* one) { return one->name; });
  if (found != std::ranges::end(kKernels)) return **found;
  std::string known;
  for (const auto* one : kKernels) known.append(known.empty() ? "" : ", ").append(one->name);
  throw InvalidInput("no kernel \"" + std::string(name) + "\"; there are: " + known);
}

}  // namespace chladni::priors
