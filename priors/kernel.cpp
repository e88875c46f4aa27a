#include "priors/kernel.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/flush_to_zero.h"
#include "priors/gaussian_process/exponential.h"

namespace chladni::priors {

/// A family, or a kernel composed of kernels.
class Kernel::Part {
 public:
  virtual ~Part() = default;
  virtual void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                        const Eigen::VectorXd& parameters, KernelColumn& column) const = 0;

  std::string name;
  std::vector<Hyperparameter> parameters;
  bool is_stationary = true, is_isotropic = true;
};

namespace {

class FamilyPart : public Kernel::Part {
 public:
  FamilyPart(const KernelFamily& family, Scales scales) : family_(family) {
    name = family.name;
    parameters = family.parameters(scales);
    is_stationary = family.is_stationary;
    is_isotropic = family.is_isotropic && scales == Scales::isotropic;
  }
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& values, KernelColumn& column) const override {
    family_.evaluate(points, other, values, column);
  }

 private:
  const KernelFamily& family_;
};

class PairPart : public Kernel::Part {
 public:
  PairPart(Kernel a, Kernel b, const std::string& sign) : a_(std::move(a)), b_(std::move(b)) {
    name = a_.name() + sign + b_.name();
    parameters = a_.parameters();
    parameters.insert(parameters.end(), b_.parameters().begin(), b_.parameters().end());
    is_stationary = a_.is_stationary() && b_.is_stationary();
    is_isotropic = a_.is_isotropic() && b_.is_isotropic();
  }

 protected:
  struct Both {
    KernelColumn a, b;
  };
  [[nodiscard]] Both both(const CoordinatesView& points, const Eigen::RowVector3d& other,
                          const Eigen::VectorXd& values, bool wants_gradient) const {
    Both both;
    both.a.wants_gradient = both.b.wants_gradient = wants_gradient;
    a_.evaluate(points, other, values.head(a_.parameter_count()), both.a);
    b_.evaluate(points, other, values.tail(b_.parameter_count()), both.b);
    return both;
  }
  void join(const Eigen::ArrayXXd& a, const Eigen::ArrayXXd& b, KernelColumn& column) const {
    column.gradient.resize(a.rows(), a.cols() + b.cols());
    column.gradient << a, b;
  }

 private:
  Kernel a_, b_;
};

class SumPart : public PairPart {
 public:
  using PairPart::PairPart;
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& values, KernelColumn& column) const override {
    const auto [a, b] = both(points, other, values, column.wants_gradient);
    column.value = a.value + b.value;
    if (column.wants_gradient) join(a.gradient, b.gradient, column);
  }
};

class ProductPart : public PairPart {
 public:
  using PairPart::PairPart;
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& values, KernelColumn& column) const override {
    const auto [a, b] = both(points, other, values, column.wants_gradient);
    column.value = a.value * b.value;
    if (!column.wants_gradient) return;
    join(a.gradient.colwise() * b.value, b.gradient.colwise() * a.value, column);
  }
};

class WeightedPart : public Kernel::Part {
 public:
  explicit WeightedPart(Kernel kernel) : kernel_(std::move(kernel)) {
    name = "weight * (" + kernel_.name() + ")";
    parameters = kernel_.parameters();
    parameters.push_back({"weight", "1", 1e-6, 1e6});
    is_stationary = kernel_.is_stationary();
    is_isotropic = kernel_.is_isotropic();
  }
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& values, KernelColumn& column) const override {
    const Eigen::Index last = values.size() - 1;
    kernel_.evaluate(points, other, values.head(last), column);
    column.value *= values(last);
    if (!column.wants_gradient) return;
    column.gradient *= values(last);
    column.gradient.conservativeResize(Eigen::NoChange, last + 1);
    column.gradient.col(last) = column.value;
  }

 private:
  Kernel kernel_;
};

class SymmetrisedPart : public Kernel::Part {
 public:
  SymmetrisedPart(Kernel kernel, Symmetry symmetry, double asymmetric)
      : kernel_(std::move(kernel)), symmetry_(std::move(symmetry)), asymmetric_(asymmetric) {
    name = "symmetrised (" + kernel_.name() + ")";
    parameters = kernel_.parameters();
    is_stationary = is_isotropic = false;
  }
  void evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                const Eigen::VectorXd& values, KernelColumn& column) const override {
    column.value.setZero(points.rows());
    if (column.wants_gradient) column.gradient.setZero(points.rows(), values.size());
    for (std::size_t g = 0; g < symmetry_.operations.size(); ++g) {
      const Eigen::RowVector3d image =
          symmetry_.centre + (other - symmetry_.centre) * symmetry_.operations[g].transpose();
      add((1.0 - asymmetric_) * symmetry_.characters[g], points, image, values, column);
    }
    if (asymmetric_ > 0.0) add(asymmetric_, points, other, values, column);
  }

 private:
  void add(double factor, const CoordinatesView& points, const Eigen::RowVector3d& other,
           const Eigen::VectorXd& values, KernelColumn& sum) const {
    KernelColumn one;
    one.wants_gradient = sum.wants_gradient;
    kernel_.evaluate(points, other, values, one);
    sum.value += factor * one.value;
    if (sum.wants_gradient) sum.gradient += factor * one.gradient;
  }

  Kernel kernel_;
  Symmetry symmetry_;
  double asymmetric_;
};

// Index of g h among the operations, or −1.
int product_of(const Symmetry& symmetry, std::size_t g, std::size_t h) {
  const Eigen::Matrix3d both = symmetry.operations[g] * symmetry.operations[h];
  for (std::size_t k = 0; k < symmetry.operations.size(); ++k) {
    if ((symmetry.operations[k] - both).norm() < 1e-9) return static_cast<int>(k);
  }
  return -1;
}

// A finite set of invertible maps that is closed under products is a group.
void require_group(const Symmetry& symmetry) {
  const auto count = symmetry.operations.size();
  require(count > 0 && symmetry.characters.size() == count,
          "symmetry: " + fmt::to_string(count) + " operations and " +
              fmt::to_string(symmetry.characters.size()) + " characters; expected as many");
  for (std::size_t g = 0; g < count; ++g) {
    require(symmetry.operations[g].isUnitary(1e-9),
            "symmetry: operation " + fmt::to_string(g + 1) + " is not orthogonal");
    require(std::abs(symmetry.characters[g]) == 1.0,
            "symmetry: character " + fmt::to_string(g + 1) + " is " +
                fmt::format("{:.6g}", symmetry.characters[g]) + "; expected 1 or -1");
    for (std::size_t h = 0; h < count; ++h) {
      const int k = product_of(symmetry, g, h);
      require(k >= 0 && symmetry.characters[static_cast<std::size_t>(k)] ==
                            symmetry.characters[g] * symmetry.characters[h],
              "symmetry: operation " + fmt::to_string(g + 1) + " after " + fmt::to_string(h + 1) +
                  " is none of the operations, or its character is not the product of theirs; "
                  "expected a group");
    }
  }
}

void require_parameters(const Kernel& kernel, const Eigen::VectorXd& parameters) {
  require(parameters.size() == kernel.parameter_count(),
          "kernel " + kernel.name() + ": " + fmt::to_string(parameters.size()) +
              " hyper-parameters; expected " + fmt::to_string(kernel.parameter_count()));
  require(parameters.allFinite() && (parameters.array() > 0.0).all(),
          "kernel " + kernel.name() + ": a hyper-parameter is not positive");
}

}  // namespace

Kernel::Kernel(const KernelFamily& family, Scales scales)
    : part_(std::make_shared<FamilyPart>(family, scales)) {}

const std::vector<Hyperparameter>& Kernel::parameters() const { return part_->parameters; }
Eigen::Index Kernel::parameter_count() const {
  return static_cast<Eigen::Index>(part_->parameters.size());
}
const std::string& Kernel::name() const { return part_->name; }
bool Kernel::is_stationary() const { return part_->is_stationary; }
bool Kernel::is_isotropic() const { return part_->is_isotropic; }

void Kernel::evaluate(const CoordinatesView& points, const Eigen::RowVector3d& other,
                      const Eigen::VectorXd& values, KernelColumn& column) const {
  part_->evaluate(points, other, values, column);
}

Kernel operator+(const Kernel& a, const Kernel& b) {
  return Kernel(std::make_shared<SumPart>(a, b, " + "));
}

Kernel operator*(const Kernel& a, const Kernel& b) {
  return Kernel(std::make_shared<ProductPart>(a, b, " * "));
}

Kernel weighted(const Kernel& kernel) { return Kernel(std::make_shared<WeightedPart>(kernel)); }

Kernel symmetrised(const Kernel& kernel, const Symmetry& symmetry, double asymmetric) {
  require(kernel.is_isotropic(), "kernel " + kernel.name() +
                                     " is not isotropic; a symmetrised one must be, so that an "
                                     "operation leaves it as it is");
  require(asymmetric >= 0.0 && asymmetric <= 1.0, "symmetrised kernel: the asymmetric part is " +
                                                      fmt::format("{:.6g}", asymmetric) +
                                                      "; expected 0 to 1");
  require_group(symmetry);
  return Kernel(std::make_shared<SymmetrisedPart>(kernel, symmetry, asymmetric));
}

Eigen::MatrixXd covariance(const Kernel& kernel, const Eigen::VectorXd& parameters,
                           const Points& points) {
  require_parameters(kernel, parameters);
  const dense::FlushToZero flush;
  const Eigen::Index n = points.rows();
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n);
  const Coordinates at = points;
  KernelColumn column;
  for (Eigen::Index j = 0; j < n; ++j) {
    throw_if_interrupted();
    kernel.evaluate(at.bottomRows(n - j), at.row(j), parameters, column);
    lower.col(j).tail(n - j) = column.value;
  }
  return lower;
}

Eigen::MatrixXd covariance(const Kernel& kernel, const Eigen::VectorXd& parameters,
                           const Points& points, const Points& others) {
  require_parameters(kernel, parameters);
  const dense::FlushToZero flush;
  Eigen::MatrixXd whole(points.rows(), others.rows());
  const Coordinates at = points;
  KernelColumn column;
  for (Eigen::Index j = 0; j < others.rows(); ++j) {
    throw_if_interrupted();
    kernel.evaluate(at, others.row(j), parameters, column);
    whole.col(j) = column.value;
  }
  return whole;
}

Eigen::VectorXd variances(const Kernel& kernel, const Eigen::VectorXd& parameters,
                          const Points& points) {
  require_parameters(kernel, parameters);
  Eigen::VectorXd diagonal(points.rows());
  KernelColumn column;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    kernel.evaluate(points.row(i), points.row(i), parameters, column);
    diagonal(i) = column.value(0);
  }
  return diagonal;
}

Contractions contractions(const Kernel& kernel, const Eigen::VectorXd& parameters,
                          const Points& points, const Eigen::MatrixXd& weights,
                          const Eigen::MatrixXd& vectors) {
  require_parameters(kernel, parameters);
  const dense::FlushToZero flush;
  const Eigen::Index n = points.rows();
  Contractions result;
  result.weighted = Eigen::VectorXd::Zero(parameters.size());
  result.forms = Eigen::MatrixXd::Zero(parameters.size(), vectors.cols());
  const Coordinates at = points;
  KernelColumn column;
  column.wants_gradient = true;
  for (Eigen::Index j = 0; j < n; ++j) {
    throw_if_interrupted();
    kernel.evaluate(at.bottomRows(n - j), at.row(j), parameters, column);
    column.gradient.bottomRows(n - j - 1) *= 2.0;  // an entry below the diagonal counts twice
    const auto slope = column.gradient.matrix().transpose();
    result.weighted += slope * weights.col(j).tail(n - j);
    if (vectors.cols() == 0) continue;
    result.forms += (slope * vectors.bottomRows(n - j)) * vectors.row(j).asDiagonal();
  }
  return result;
}

}  // namespace chladni::priors
