#include "bench/peers/cholmod.h"

#include <cholmod.h>

#include "base/error.h"

namespace chladni::bench {

double cholmod_entries(const SparseMatrix& stiffness, double s, const SparseMatrix& mass) {
  SparseMatrix a = stiffness + s * mass;
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_METIS;
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(a.rows());
  view.nzmax = static_cast<std::size_t>(a.nonZeros());
  view.p = a.outerIndexPtr();
  view.i = a.innerIndexPtr();
  view.x = a.valuePtr();
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = view.packed = 1;
  cholmod_factor* factor = cholmod_analyze(&view, &common);
  cholmod_factorize(&view, factor, &common);
  const bool good = common.status == CHOLMOD_OK;
  const double entries = common.lnz;
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  if (!good) throw NumericalFailure("CHOLMOD did not factorise the matrix");
  return entries;
}

}  // namespace chladni::bench
