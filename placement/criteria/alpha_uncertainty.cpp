#include "placement/criteria.h"
#include "placement/criteria/for_people.h"

namespace chladni::placement {
namespace {

Eigen::MatrixXd alpha_uncertainty_score(const PairView& view) {
  return alpha_deviation(view).cwiseInverse();
}

}  // namespace

extern const Criterion alpha_uncertainty;
constinit const Criterion alpha_uncertainty{
    .name = "alpha_uncertainty",
    .summary =
        "how well the gain alpha between input and output shapes will be known, from the "
        "noise of both and the error of their places: standard deviation of the worst mode",
    .source = "Cramer-Rao bound of (5.5)",
    .unit = "%",
    .score = alpha_uncertainty_score,
    .for_people = deviation_percent,
};

}  // namespace chladni::placement
