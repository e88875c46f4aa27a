#include "placement/criteria.h"

namespace chladni::placement {
namespace {

Eigen::MatrixXd score(const PairView& view) { return alpha_deviation(view).cwiseInverse(); }

double percent(double score) { return 100.0 / score; }

}  // namespace

extern const Criterion alpha_uncertainty;
constinit const Criterion alpha_uncertainty{
    .name = "alpha_uncertainty",
    .summary =
        "how well the gain alpha between input and output shapes will be known, from the "
        "noise of both and the error of their places: standard deviation of the worst mode",
    .source = "Cramer-Rao bound of (5.5)",
    .unit = "%",
    .score = score,
    .for_people = percent,
};

}  // namespace chladni::placement
