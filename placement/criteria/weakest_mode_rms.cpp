#include "placement/criteria.h"

namespace chladni::placement {
namespace {

Eigen::MatrixXd score(const PairView& view) {
  const Eigen::MatrixXd ones =
      Eigen::MatrixXd::Ones(view.present.rows() + view.site_count(), view.group_count());
  return visibility(view, ones) * view.rms.cwiseInverse().asDiagonal();
}

double itself(double score) { return score; }

}  // namespace

extern const Criterion weakest_mode_rms;
constinit const Criterion weakest_mode_rms{
    .name = "weakest_mode_rms",
    .summary =
        "the same relative to the root mean square on the body: a peak in a corner does not "
        "make a mode look weak elsewhere",
    .source = "(5.10) with another norm",
    .unit = "1",
    .score = score,
    .for_people = itself,
};

}  // namespace chladni::placement
