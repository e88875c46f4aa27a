#include "placement/criteria.h"
#include "placement/criteria/for_people.h"

namespace chladni::placement {
namespace {

Eigen::MatrixXd weakest_mode_score(const PairView& view) {
  const Eigen::MatrixXd ones =
      Eigen::MatrixXd::Ones(view.present.rows() + view.site_count(), view.group_count());
  return visibility(view, ones) * view.largest.cwiseInverse().asDiagonal();
}

}  // namespace

extern const Criterion weakest_mode;
constinit const Criterion weakest_mode{
    .name = "weakest_mode",
    .summary =
        "the weakest mode's displacement, each relative to its largest on the body; modes "
        "that cannot be told apart by the norm over all of them",
    .source = "thesis (5.10)",
    .unit = "1",
    .score = weakest_mode_score,
    .for_people = unchanged,
};

}  // namespace chladni::placement
