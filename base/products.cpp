#include "base/products.h"

namespace Eigen::internal {

CHLADNI_PRODUCTS()

}  // namespace Eigen::internal
