#include "placement/criteria.h"
#include "placement/criteria/for_people.h"

namespace chladni::placement {
namespace {

Eigen::MatrixXd weakest_mode_rms_score(const PairView& view) {
  const Eigen::MatrixXd ones =
      Eigen::MatrixXd::Ones(view.present.rows() + view.site_count(), view.group_count());
  return visibility(view, ones) * view.rms.cwiseInverse().asDiagonal();
}

}  // namespace

extern const Criterion weakest_mode_rms;
constinit const Criterion weakest_mode_rms{
    .name = "weakest_mode_rms",
    .summary =
        "the same relative to the root mean square on the body: a peak in a corner does not "
        "make a mode look weak elsewhere",
    .source = "(5.10) with another norm",
    .unit = "1",
    .score = weakest_mode_rms_score,
    .for_people = unchanged,
};

}  // namespace chladni::placement
