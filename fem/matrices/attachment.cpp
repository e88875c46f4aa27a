#include "fem/attachment.h"

#include <Eigen/Dense>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text_stream.h"
#include "fem/body/site_motion.h"

namespace chladni::fem {
namespace {

// A linear form on the degrees of freedom.
using Row = std::map<Eigen::Index, double>;

// Checks the quantities of one attachment; the messages name the attachment.
class Checks {
 public:
  explicit Checks(const Attachment& attachment) : of_("attachment \"" + attachment.name + "\": ") {}

  void not_negative(double value, const char* name, const char* unit) const {
    if (std::isfinite(value) && value >= 0.0) return;
    fail(value, name, unit, "zero or more");
  }
  void positive(double value, const char* name, const char* unit) const {
    if (std::isfinite(value) && value > 0.0) return;
    fail(value, name, unit, "a positive number");
  }
  void unit_vector(const Eigen::Vector3d& direction, const char* name) const {
    if (std::abs(direction.norm() - 1.0) <= 1e-6) return;
    TextWriter text;
    text << of_ << "the " << name << " is (" << direction.transpose()
         << "); expected a vector of length 1";
    throw InvalidInput(text.str());
  }
  void hold(bool condition, const std::string& message) const { require(condition, of_ + message); }

 private:
  void fail(double value, const char* name, const char* unit, const char* expected) const {
    TextWriter text;
    text << of_ << "the " << name << " is " << value << " " << unit << "; expected " << expected;
    throw InvalidInput(text.str());
  }
  std::string of_;
};

// Adds `part` · (displacement or rotation of the site) to the form `row`.
void add(Row& row, const SiteMotion& motion, const Eigen::Matrix3Xd& rows,
         const Eigen::Vector3d& part) {
  const Eigen::RowVectorXd form = part.transpose() * rows;
  for (Eigen::Index i = 0; i < form.size(); ++i) {
    if (form(i) != 0.0) row[3 * Eigen::Index{motion.nodes(i / 3)} + i % 3] += form(i);
  }
}

// Adds value · row rowᵀ, lower triangle: a spring, mass or dashpot on one linear form.
void add_square(std::vector<Eigen::Triplet<double>>& to, std::vector<AttachmentTerms::Form>& forms,
                double value, const Row& row) {
  if (value == 0.0) return;
  forms.push_back({{row.begin(), row.end()}, value});
  for (auto i = row.begin(); i != row.end(); ++i) {
    for (auto j = row.begin(); j != std::next(i); ++j) {
      to.emplace_back(static_cast<int>(i->first), static_cast<int>(j->first),
                      value * i->second * j->second);
    }
  }
}

// The tetrahedra below an attachment: at its own site and at the other end of a link.
struct Below {
  Eigen::Index here = -1, there = -1;
};

std::vector<Below> below_all(const mesh::TetMesh& body,
                             const std::vector<Attachment>& attachments) {
  std::vector<mesh::Site> sites;
  for (const auto& attachment : attachments) {
    const auto* link = std::get_if<LinkSpring>(&attachment.what);
    sites.push_back(attachment.site);
    sites.push_back(link != nullptr ? link->other : attachment.site);
  }
  const auto tets = tets_below(body, sites);
  std::vector<Below> below(attachments.size());
  for (std::size_t i = 0; i < below.size(); ++i) below[i] = {tets[2 * i], tets[2 * i + 1]};
  return below;
}

// Adds the terms of one attachment, of any kind.
class Adder {
 public:
  Adder(const mesh::TetMesh& body, const Attachment& attachment, const Below& below,
        AttachmentTerms& to)
      : body_(body), attachment_(attachment), below_(below), checks_(attachment), to_(to) {}

  void operator()(const PointMass& mass) const {
    checks_.not_negative(mass.mass, "mass", "kg");
    checks_.hold(mass.inertia.allFinite() && mass.inertia.isApprox(mass.inertia.transpose(), 1e-9),
                 "the inertia is not a finite symmetric matrix");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(mass.inertia);
    const double largest = principal.eigenvalues().cwiseAbs().maxCoeff();
    checks_.not_negative(
        principal.eigenvalues()(0) < -1e-12 * largest ? principal.eigenvalues()(0) : 0.0,
        "smallest principal moment of inertia", "kg m^2");
    const auto motion = motion_at(attachment_.site, below_.here);
    for (int axis = 0; axis < 3; ++axis) {
      Row move;
      add(move, motion, motion.displacement, Eigen::Vector3d::Unit(axis));
      add_mass(mass.mass, move);
      if (principal.eigenvalues()(axis) <= 0.0) continue;
      Row turn;
      add(turn, motion, motion.rotation, principal.eigenvectors().col(axis));
      add_mass(principal.eigenvalues()(axis), turn);
    }
  }

  void operator()(const GroundSpring& spring) const {
    checks_.unit_vector(spring.direction, "direction");
    checks_.not_negative(spring.stiffness, "stiffness", "N/m");
    checks_.not_negative(spring.damping, "damping", "N s/m");
    const auto motion = motion_at(attachment_.site, below_.here);
    Row row;
    add(row, motion, motion.displacement, spring.direction);
    add_spring(row, spring.stiffness, spring.damping);
  }

  void operator()(const GroundTorsionSpring& spring) const {
    checks_.unit_vector(spring.axis, "axis");
    checks_.not_negative(spring.stiffness, "stiffness", "N m/rad");
    checks_.not_negative(spring.damping, "damping", "N m s/rad");
    const auto motion = motion_at(attachment_.site, below_.here);
    Row row;
    add(row, motion, motion.rotation, spring.axis);
    add_spring(row, spring.stiffness, spring.damping);
  }

  // The stretch is d · (u2 − u1 − θ × (x2 − x1)), where θ is the mean rotation of the two ends. A
  // rigid motion gives no stretch in any direction d. Where d is along the line between the ends,
  // the last term is zero.
  void operator()(const LinkSpring& link) const {
    checks_.not_negative(link.stiffness, "stiffness", "N/m");
    checks_.not_negative(link.damping, "damping", "N s/m");
    const Eigen::Vector3d line = link.other.position - attachment_.site.position;
    Eigen::Vector3d direction = link.direction;
    if (direction.isZero(0.0)) {
      checks_.hold(line.norm() > 0.0,
                   "the two ends are at one place and no direction is given; expected a direction");
      direction = line.normalized();
    }
    checks_.unit_vector(direction, "direction");
    const auto here = motion_at(attachment_.site, below_.here);
    const auto there = motion_at(link.other, below_.there);
    Row row;
    add(row, there, there.displacement, direction);
    add(row, here, here.displacement, -direction);
    const Eigen::Vector3d lever = line.cross(direction);  // d · (θ × r) = θ · (r × d)
    if (lever.norm() > 1e-9 * line.norm()) {
      add(row, here, here.rotation, -0.5 * lever);
      add(row, there, there.rotation, -0.5 * lever);
    }
    add_spring(row, link.stiffness, link.damping);
  }

  // Along `direction` the mass moves on the spring. Across `direction` the mass follows the body.
  void operator()(const Resonator& resonator) const {
    checks_.unit_vector(resonator.direction, "direction");
    checks_.positive(resonator.mass, "mass", "kg");
    checks_.positive(resonator.stiffness, "stiffness", "N/m");
    checks_.not_negative(resonator.damping, "damping", "N s/m");
    const auto motion = motion_at(attachment_.site, below_.here);
    const Eigen::Index own = 3 * body_.node_count() + to_.extra_count();
    to_.extras.push_back({.position = attachment_.site.position, .direction = resonator.direction});
    add_mass(resonator.mass, Row{{own, 1.0}});
    Row row;
    add(row, motion, motion.displacement, -resonator.direction);
    row[own] = 1.0;
    add_spring(row, resonator.stiffness, resonator.damping);
    const Eigen::Vector3d across = resonator.direction.unitOrthogonal();
    for (const Eigen::Vector3d& t : {across, Eigen::Vector3d(resonator.direction.cross(across))}) {
      Row carried;
      add(carried, motion, motion.displacement, t);
      add_mass(resonator.mass, carried);
    }
  }

 private:
  [[nodiscard]] SiteMotion motion_at(const mesh::Site& site, Eigen::Index tet) const {
    checks_.not_negative(attachment_.footprint, "footprint", "m");
    try {
      return attachment_.footprint > 0.0 ? footprint_motion(body_, site, attachment_.footprint)
                                         : point_motion(body_, site, tet);
    } catch (const InvalidInput& error) {
      checks_.hold(false, error.what());
      throw;
    }
  }

  void add_mass(double mass, const Row& row) const { add_square(to_.mass, to_.masses, mass, row); }
  void add_spring(const Row& row, double stiffness, double damping) const {
    add_square(to_.stiffness, to_.springs, stiffness, row);
    add_square(to_.damping, to_.dashpots, damping, row);
  }

  const mesh::TetMesh& body_;
  const Attachment& attachment_;
  const Below& below_;
  Checks checks_;
  AttachmentTerms& to_;
};

}  // namespace

AttachmentTerms terms(const mesh::TetMesh& body, const std::vector<Attachment>& attachments) {
  AttachmentTerms result;
  const auto below = below_all(body, attachments);
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    std::visit(Adder(body, attachments[i], below[i], result), attachments[i].what);
  }
  return result;
}

}  // namespace chladni::fem
